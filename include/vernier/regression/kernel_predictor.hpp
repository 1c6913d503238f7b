#pragma once

/// @file
/// What fitting a kernel method gives: a constant and a sum of kernels around the samples.

#include <cmath>
#include <utility>

#include "vernier/core/simd.hpp"
#include "vernier/regression/mapped_sample.hpp"

namespace vernier {

/// How alike two samples are, by their distance r in length scales.
/// @cite Rasmussen and Williams 2006
enum class Kernel {
  squared_exponential,  ///< exp(-r^2 / 2), the Gaussian: infinitely smooth
  matern_5_2,           ///< (1 + s + s^2 / 3) exp(-s), s = sqrt(5) r: twice differentiable
};

namespace detail {

/// `square`, of the distance, becomes the kernel's value; `slope` its derivative with respect to a coordinate, divided
/// by the distance along that coordinate.
template <int W>
VERNIER_INLINE void kernel_value(Kernel kernel, typename Simd<W>::Double& square, typename Simd<W>::Double& slope) {
  using Double = typename Simd<W>::Double;
  if (kernel == Kernel::squared_exponential) {
    square *= -0.5;
    exponential<W>(square);
    slope = -square;
  } else {
    Double s = 5.0 * square;
    VERNIER_UNROLL
    for (int lane = 0; lane < W; ++lane) s[lane] = std::sqrt(s[lane]);
    Double e = -s;
    exponential<W>(e);
    slope = (1.0 + s) * e;
    square = slope + (5.0 / 3) * square * e;
    slope *= -5.0 / 3;
  }
}

/// Kernels of n samples around themselves, features in length scales, n x features; the lower triangle is filled.
template <class Features>
MatrixX kernel_matrix(Kernel kernel, const Eigen::MatrixBase<Features>& features) {
  const Index n = features.rows();
  MatrixX out(n, n);
  VectorX square, s;
  for (Index j = 0; j < n; ++j) {
    const Index rest = n - j;
    square = (features.bottomRows(rest).rowwise() - features.row(j)).rowwise().squaredNorm();
    if (kernel == Kernel::squared_exponential) {
      out.col(j).tail(rest) = (-0.5 * square.array()).exp().matrix();
    } else {
      s = (5.0 * square).cwiseSqrt();
      out.col(j).tail(rest) = ((1 + s.array() + s.array().square() / 3) * (-s.array()).exp()).matrix();
    }
  }
  return out;
}

}  // namespace detail

/// A fitted kernel method: `y = mean + sum_i alpha_i k(x, x_i)`. As many kernels at a time as the machine's vectors
/// hold; another instruction set gives other last bits. A prediction costs n exponentials.
template <int Inputs, int Outputs>
class KernelPredictor {
 public:
  /// Number of inputs.
  static constexpr int inputs = Inputs;
  /// Number of outputs.
  static constexpr int outputs = Outputs;
  /// One sample.
  using Input = Eigen::Matrix<double, Inputs, 1>;
  /// One prediction.
  using Output = Eigen::Matrix<double, Outputs, 1>;
  /// Coefficients, samples x outputs.
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, Outputs>;

  /// @param kernel    between samples
  /// @param input_map what the kernel sees of each input
  /// @param scaling   of the mapped features, length scales included
  /// @param centres   n x features, scaled
  /// @param alpha     n x outputs
  /// @param mean      added to every prediction
  /// @throws std::invalid_argument when the sizes do not fit together
  KernelPredictor(Kernel kernel, InputMap input_map, ColumnScaling scaling, const MatrixX& centres,
                  const Coefficients& alpha, const Output& mean)
      : kernel_(kernel), input_map_(input_map), scaling_(std::move(scaling)), samples_(centres.rows()), mean_(mean) {
    const Index f = features();
    require(
        centres.cols() == f && alpha.rows() == samples_ && scaling_.offset.size() == f && scaling_.factor.size() == f,
        "KernelPredictor: ", samples_, " centres of ", centres.cols(), " features (expected ", f, ") and ",
        alpha.rows(), " coefficients");
    packed_ = Packed::Zero(f + Outputs, (samples_ + lanes - 1) / lanes * lanes);
    packed_.topLeftCorner(f, samples_) = centres.transpose();
    packed_.bottomLeftCorner(Outputs, samples_) = alpha.transpose();
  }

  /// One sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output predict(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Sample at = sample(x);
    Sums sums{};
    evaluate<false>(at, sums);
    return sums.total(mean_);
  }

  /// Samples as rows, n x inputs to n x outputs.
  template <class Derived>
    requires detail::SampleRowsOf<Derived, Inputs> Eigen::Matrix<double, Eigen::Dynamic, Outputs> predict(
        const Eigen::MatrixBase<Derived>& x)
  const {
    Eigen::Matrix<double, Eigen::Dynamic, Outputs> y(x.rows(), Outputs);
    for (Index i = 0; i < x.rows(); ++i) y.row(i) = predict(Input(x.row(i).transpose())).transpose();
    return y;
  }

  /// d predict / d x at one sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Eigen::Matrix<double, Outputs, Inputs> derivative(
        const Eigen::MatrixBase<Derived>& x)
  const noexcept { return predict_and_derivative(x).second; }

  /// Both in one pass.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> std::pair<Output, Eigen::Matrix<double, Outputs, Inputs>>
    predict_and_derivative(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Sample at = sample(x);
    Sums sums{};
    evaluate<true>(at, sums);
    return {sums.total(mean_), sums.slope(input_map_, scaling_, at)};
  }

  /// The kernel.
  Kernel kernel() const { return kernel_; }
  /// What the kernel sees of each input.
  InputMap input_map() const { return input_map_; }
  /// Scaling of the mapped features, length scales included.
  const ColumnScaling& scaling() const { return scaling_; }
  /// Number of samples it was fitted on.
  Index samples() const { return samples_; }
  /// The scaled samples, n x features.
  MatrixX centres() const { return packed_.topLeftCorner(features(), samples_).transpose(); }
  /// Coefficients of the kernels, n x outputs.
  Coefficients alpha() const { return packed_.bottomLeftCorner(Outputs, samples_).transpose(); }
  /// Added to every prediction.
  const Output& mean() const { return mean_; }

  /// What the kernel sees of a sample.
  using Sample = detail::MappedSample<Inputs>;
  /// Maps and scales.
  template <class Derived>
  Sample sample(const Eigen::MatrixBase<Derived>& x) const noexcept {
    return {input_map_, scaling_, x};
  }

  /// Kernels between a sample and centres first .. first + count, a multiple of 8 each; centres beyond the last lie at
  /// zero.
  void kernels(const Sample& at, Index first, Index count, double* out) const noexcept {
    detail::run_widest([&]<int W>() VERNIER_INLINED {
      typename detail::Simd<W>::Double value, slope;
      for (Index k = first; k < first + count; k += W) {
        square_distance<W>(at, k, value);
        detail::kernel_value<W>(kernel_, value, slope);
        detail::store<W>(out + (k - first), value);
      }
    });
  }

 private:
  using Sums = detail::LaneSums<Inputs, Outputs>;
  static constexpr int lanes = Sums::lanes;
  using Packed = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Index features() const noexcept { return input_map_ == InputMap::raw ? Inputs : 2 * Inputs; }
  const double* row(Index i) const noexcept { return packed_.data() + i * packed_.cols(); }

  template <int W>
  VERNIER_INLINE void square_distance(const Sample& at, Index k, typename detail::Simd<W>::Double& square) const {
    typename detail::Simd<W>::Double along;
    square = typename detail::Simd<W>::Double{};
    for (Index j = 0; j < features(); ++j) {
      detail::load<W>(along, row(j) + k);
      along = at.value[j] - along;
      square += along * along;
    }
  }

  template <bool WithDerivative>
  void evaluate(const Sample& at, Sums& sums) const noexcept {
    detail::run_widest([&]<int W>() VERNIER_INLINED {
      typename detail::Simd<W>::Double value, slope, weight, along, effect[Outputs];
      const Index f = features();
      for (Index k = 0; k < packed_.cols(); k += W) {
        square_distance<W>(at, k, value);
        detail::kernel_value<W>(kernel_, value, slope);
        VERNIER_UNROLL
        for (int o = 0; o < Outputs; ++o) {
          detail::load<W>(weight, row(f + o) + k);
          Sums::template add<W>(sums.output[o] + k % lanes, weight * value);
          effect[o] = weight * slope;
        }
        for (Index j = 0; WithDerivative && j < f; ++j) {
          detail::load<W>(along, row(j) + k);
          along = at.value[j] - along;
          VERNIER_UNROLL
          for (int o = 0; o < Outputs; ++o) Sums::template add<W>(sums.by_feature[j][o] + k % lanes, effect[o] * along);
        }
      }
    });
  }

  Kernel kernel_;
  InputMap input_map_;
  ColumnScaling scaling_;
  Index samples_;
  Packed packed_;  // rows: each feature, each output's coefficients; a column a sample, padded with zeros
  Output mean_;
};

}  // namespace vernier
