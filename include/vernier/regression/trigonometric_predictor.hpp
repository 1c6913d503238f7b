#pragma once

/// @file
/// A fitted multilinear polynomial of (1, sin q_j, cos q_j).

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "vernier/core/simd.hpp"
#include "vernier/regression/concepts.hpp"

namespace vernier {

namespace detail {

/// 3^n.
constexpr Index power_of_three(int n) { return n == 0 ? 1 : 3 * power_of_three(n - 1); }

/// Number of angles in a feature: digits of its number to base 3 that are not 0.
constexpr int trigonometric_degree(Index feature) {
  return feature == 0 ? 0 : trigonometric_degree(feature / 3) + (feature % 3 != 0 ? 1 : 0);
}

/// All features of one sample, 3^N. Feature f has the factor 1, sin or cos of input j where digit j of f to base 3, the
/// first input's being the most significant one, is 0, 1 or 2.
template <int N>
void trigonometric_features(const Eigen::Matrix<double, N, 1>& x, double* out) noexcept {
  double sine[N], cosine[N];
  sines_and_cosines<N>(x.data(), sine, cosine);
  out[0] = 1;
  Index size = 1;
  for (int j = N - 1; j >= 0; --j, size *= 3)
    for (Index f = 0; f < size; ++f) {
      out[size + f] = sine[j] * out[f];
      out[2 * size + f] = cosine[j] * out[f];
    }
}

/// What a trigonometric predictor knows of its own spread: the posterior of a Bayesian linear model with the ridge as
/// prior. Features are taken in the units of the fit, z = scale phi.
struct TrigonometricSpread {
  std::vector<Index> features;  ///< those that were fitted
  VectorX scale;                ///< of each
  VectorX mean;                 ///< of each, scaled
  MatrixX directions{};         ///< fitted features x k, orthonormal
  VectorX gain{};               ///< variance of each direction, k, in units of the noise
  double rest = 0;              ///< variance of all other directions: that of the prior
  double mean_share = 0;        ///< variance of the mean
  VectorX noise;                ///< standard deviation of a measurement, one an output
};

}  // namespace detail

/// What `TrigonometricRegression` gives: a polynomial of (1, sin q_j, cos q_j), linear in those of each input.
template <int Inputs, int Outputs>
class TrigonometricPredictor {
  static_assert(Inputs <= 9, "the 3^N coefficients of more than nine inputs fit neither stack nor patience");

 public:
  /// Number of inputs.
  static constexpr int inputs = Inputs;
  /// Number of outputs.
  static constexpr int outputs = Outputs;
  /// Number of features.
  static constexpr int features = static_cast<int>(detail::power_of_three(Inputs));
  /// One sample.
  using Input = Eigen::Matrix<double, Inputs, 1>;
  /// One prediction.
  using Output = Eigen::Matrix<double, Outputs, 1>;
  /// Of derivatives.
  using Slope = Eigen::Matrix<double, Outputs, Inputs>;
  /// One row a feature. Feature f has the factor 1, sin q_j or cos q_j where digit j of f to base 3, the first input's
  /// being the most significant one, is 0, 1 or 2.
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, Outputs, Outputs == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

  /// @param coefficients features x outputs
  /// @param spread       how uncertain they are
  TrigonometricPredictor(Coefficients coefficients, detail::TrigonometricSpread spread)
      : coefficients_(std::move(coefficients)),
        spread_(std::make_shared<const detail::TrigonometricSpread>(std::move(spread))) {
    require(coefficients_.rows() == features, "TrigonometricPredictor: ", coefficients_.rows(),
            " rows of coefficients, expected ", features);
  }

  /// One sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output predict(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    Output y;
    Slope none;
    contract<false>(x, y, none);
    return y;
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
    requires detail::SampleOf<Derived, Inputs> Slope derivative(const Eigen::MatrixBase<Derived>& x)
  const noexcept { return predict_and_derivative(x).second; }

  /// Both in one pass.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> std::pair<Output, Slope> predict_and_derivative(
        const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    std::pair<Output, Slope> out;
    contract<true>(x, out.first, out.second);
    return out;
  }

  /// Standard deviation of each output, as a Bayesian linear model has it whose prior is the ridge, without the noise
  /// of a new measurement. It knows of no error that the features cannot express.
  /// @complexity as many multiply-adds as features times the smaller of features and samples
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const detail::TrigonometricSpread& s = *spread_;
    double all[features];
    detail::trigonometric_features<Inputs>(Input(x), all);
    Eigen::Map<Eigen::VectorXd> z(all, s.scale.size());
    for (Index f = 0; f < z.size(); ++f)  // in place: a feature's number is never below its place
      z(f) = all[s.features[static_cast<std::size_t>(f)]] * s.scale(f) - s.mean(f);
    double variance = s.mean_share, left = z.squaredNorm();
    for (Index k = 0; k < s.gain.size(); ++k) {
      const double along = s.directions.col(k).dot(z);
      variance += s.gain(k) * along * along;
      left -= along * along;
    }
    return s.noise * std::sqrt(variance + s.rest * std::max(left, 0.0));
  }

  /// One row a feature.
  const Coefficients& coefficients() const { return coefficients_; }
  /// Standard deviation of a measurement, as the residuals of the fit have it.
  Output noise() const { return spread_->noise; }

 private:
  using Part = Eigen::Map<Eigen::Array<double, Eigen::Dynamic, 1>>;
  using ConstPart = Eigen::Map<const Eigen::Array<double, Eigen::Dynamic, 1>>;

  /// Sums out one input after the other, the first first: `T_0 + sin q T_1 + cos q T_2` of the thirds of what is left,
  /// and with `cos q T_1 - sin q T_2` the derivative with respect to it, which then goes the same way.
  template <bool WithDerivative>
  void contract(const Input& x, Output& y, Slope& slope) const noexcept {
    double sine[Inputs], cosine[Inputs];
    detail::sines_and_cosines<Inputs>(x.data(), sine, cosine);
    // After the first input a value and a derivative of a third each are left, and never more than that later.
    constexpr Index size = (WithDerivative ? 2 : 1) * (features / 3) * Outputs + Outputs * (Inputs + 1);
    double even[size], odd[size];
    const double* from = coefficients_.data();
    Index rest = features * Outputs;
    for (int j = 0; j < Inputs; ++j) {
      const Index third = rest / 3;
      double* to = j % 2 == 0 ? even : odd;
      const int parts = WithDerivative ? j + 1 : 1;  // the value, and derivatives with respect to the inputs before
      for (int p = 0; p < parts; ++p) {
        const ConstPart one(from + p * rest, third), s(one.data() + third, third), c(s.data() + third, third);
        Part(to + p * third, third) = one + sine[j] * s + cosine[j] * c;
      }
      if constexpr (WithDerivative) {
        const ConstPart s(from + third, third), c(s.data() + third, third);
        Part(to + parts * third, third) = cosine[j] * s - sine[j] * c;
      }
      from = to;
      rest = third;
    }
    y = Eigen::Map<const Output>(from);
    if constexpr (WithDerivative) slope = Eigen::Map<const Slope>(from + Outputs);
  }

  Coefficients coefficients_;
  std::shared_ptr<const detail::TrigonometricSpread> spread_;  // never changed: copies may share it
};

}  // namespace vernier
