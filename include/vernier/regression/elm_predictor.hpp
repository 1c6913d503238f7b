#pragma once

/// @file
/// What fitting a member of the ELM family gives.

#include <cmath>
#include <utility>

#include "vernier/core/simd.hpp"
#include "vernier/regression/mapped_sample.hpp"

namespace vernier {

namespace detail {

/// z becomes the value of sigmoid, tanh or sine nodes, `slope` their derivative.
template <int W>
VERNIER_INLINE void activate(Activation activation, typename Simd<W>::Double& z, typename Simd<W>::Double& slope) {
  using Double = typename Simd<W>::Double;
  if (activation == Activation::sine) {
    Double angle[1] = {z}, sine[1], cosine[1];
    sincos<W>(angle, sine, cosine);
    z = sine[0];
    slope = cosine[0];
  } else if (activation == Activation::tanh) {
    z += z;
    sigmoid<W>(z);
    z = 2.0 * z - 1.0;
    slope = 1.0 - z * z;
  } else {
    sigmoid<W>(z);
    slope = z * (1.0 - z);
  }
}

}  // namespace detail

/// A fitted member of the ELM family: `y = offset + sum_k beta_k g(w_k, b_k, x)`, scalings folded in where possible.
/// Nodes are evaluated as many at a time as the machine's vectors hold; another instruction set gives other last bits.
template <int Inputs, int Outputs>
class ElmPredictor {
 public:
  /// Number of inputs.
  static constexpr int inputs = Inputs;
  /// Number of outputs.
  static constexpr int outputs = Outputs;
  /// One sample.
  using Input = Eigen::Matrix<double, Inputs, 1>;
  /// One prediction.
  using Output = Eigen::Matrix<double, Outputs, 1>;

  /// @param layer   how the hidden layer is built
  /// @param scaling of the mapped features, as fitted
  /// @param theta   weights and biases, node by node
  /// @param beta    nodes x outputs, in units of the outputs
  /// @param offset  added to every prediction
  /// @throws std::invalid_argument when the sizes do not fit together
  ElmPredictor(const HiddenLayer& layer, ColumnScaling scaling, const VectorX& theta,
               const Eigen::Matrix<double, Eigen::Dynamic, Outputs>& beta, const Output& offset)
      : layer_(layer), scaling_(std::move(scaling)), offset_(offset) {
    const Index f = features();
    require(theta.size() == layer.dimension(Inputs) && beta.rows() == layer.nodes && scaling_.offset.size() == f &&
                scaling_.factor.size() == f,
            "ElmPredictor: ", layer.nodes, " nodes of ", f, " features need ", layer.dimension(Inputs), " weights and ",
            layer.nodes, " rows of output weights, got ", theta.size(), " and ", beta.rows());
    packed_ = Packed::Zero(f + 1 + Outputs, (layer.nodes + lanes - 1) / lanes * lanes);
    packed_.topLeftCorner(f + 1, layer.nodes) = Eigen::Map<const MatrixX>(theta.data(), f + 1, layer.nodes);
    packed_.bottomLeftCorner(Outputs, layer.nodes) = beta.transpose();
  }

  /// One sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output predict(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Sample at(layer_.input_map, scaling_, x);
    Sums sums{};
    evaluate<false>(at, sums);
    return sums.total(offset_);
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
    const Sample at(layer_.input_map, scaling_, x);
    Sums sums{};
    evaluate<true>(at, sums);
    return {sums.total(offset_), sums.slope(layer_.input_map, scaling_, at)};
  }

  /// The hidden layer.
  const HiddenLayer& layer() const { return layer_; }
  /// Scaling of the mapped features.
  const ColumnScaling& scaling() const { return scaling_; }
  /// Weights and biases, node by node.
  VectorX theta() const { return MatrixX(packed_.topLeftCorner(features() + 1, layer_.nodes)).reshaped(); }
  /// Output weights, nodes x outputs.
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> beta() const {
    return packed_.bottomLeftCorner(Outputs, layer_.nodes).transpose();
  }
  /// Added to every prediction.
  const Output& offset() const { return offset_; }

 private:
  using Sample = detail::MappedSample<Inputs>;
  using Sums = detail::LaneSums<Inputs, Outputs>;
  static constexpr int lanes = Sums::lanes;

  template <bool WithDerivative>
  void evaluate(const Sample& at, Sums& sums) const noexcept {
    const Index f = features();
    if (layer_.activation == Activation::radial_basis) {
      for (Index k = 0; k < layer_.nodes; ++k) {
        const double width = packed_(f, k), value = radial_basis(k, at);
        for (int o = 0; o < Outputs; ++o) sums.output[o][0] += beta(o, k) * value;
        for (Index j = 0; WithDerivative && j < f; ++j)
          for (int o = 0; o < Outputs; ++o)
            sums.by_feature[j][o][0] += beta(o, k) * -2 * width * width * value * (at.value[j] - packed_(j, k));
      }
      return;
    }
    detail::run_widest([&]<int W>() VERNIER_INLINED {
      typename detail::Simd<W>::Double z, slope, weight, effect[Outputs];
      for (Index k = 0; k < packed_.cols(); k += W) {
        detail::load<W>(z, row(f) + k);
        for (Index j = 0; j < f; ++j) {
          detail::load<W>(weight, row(j) + k);
          z += at.value[j] * weight;
        }
        detail::activate<W>(layer_.activation, z, slope);
        VERNIER_UNROLL
        for (int o = 0; o < Outputs; ++o) {
          detail::load<W>(weight, row(f + 1 + o) + k);
          Sums::template add<W>(sums.output[o] + k % lanes, weight * z);
          effect[o] = weight * slope;
        }
        for (Index j = 0; WithDerivative && j < f; ++j) {
          detail::load<W>(weight, row(j) + k);
          VERNIER_UNROLL
          for (int o = 0; o < Outputs; ++o)
            Sums::template add<W>(sums.by_feature[j][o] + k % lanes, effect[o] * weight);
        }
      }
    });
  }

  using Packed = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Index features() const noexcept { return layer_.features(Inputs); }
  const double* row(Index i) const noexcept { return packed_.data() + i * packed_.cols(); }
  double beta(int output, Index node) const noexcept { return packed_(features() + 1 + output, node); }

  double radial_basis(Index k, const Sample& at) const noexcept {
    double square = 0;
    for (Index j = 0; j < features(); ++j) square += std::pow(at.value[j] - packed_(j, k), 2);
    const double width = packed_(features(), k);
    return std::exp(-width * width * square);
  }

  HiddenLayer layer_;
  ColumnScaling scaling_;
  Packed packed_;  // rows: weights of each feature, biases, output weights; a column a node, padded with zeros
  Output offset_;
};

}  // namespace vernier
