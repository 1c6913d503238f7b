// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A fitted multilinear polynomial of (1, sin q_j, cos q_j).

#include <memory>
#include <utility>
#include <vector>

#include "vernier/regression/detail/predictor_interface.hpp"

namespace vernier {

namespace detail {

/// 3^n.
constexpr Index power_of_three(int n) { return n == 0 ? 1 : 3 * power_of_three(n - 1); }

/// Number of angles in a feature: digits of its number to base 3 that are not 0.
constexpr int trigonometric_degree(Index feature) {
  return feature == 0 ? 0 : trigonometric_degree(feature / 3) + (feature % 3 != 0 ? 1 : 0);
}

/// All features of one sample, 3^n. Feature f has the factor 1, sin or cos of input j where digit j of f to base 3, the
/// first input's being the most significant one, is 0, 1 or 2.
VERNIER_API void trigonometric_features(const double* x, Index n, double* out) noexcept;

/// The uncertainty of a trigonometric predictor: the posterior of a Bayesian linear model with the ridge as
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

/// A fitted polynomial.
class TrigonometricSum {
 public:
  /// Coefficients by rows.
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// Numbers that `evaluate` and `standard_deviation` need as memory to work in.
  static constexpr Index workspace(int inputs, int outputs) {
    // After the first input a value and a derivative of a third each are left, and never more than that later.
    return 2 * (2 * power_of_three(inputs - 1) * outputs + outputs * (inputs + 1));
  }

  /// @param inputs       their number
  /// @param coefficients 3^inputs x outputs
  /// @param spread       their uncertainty
  VERNIER_API TrigonometricSum(int inputs, const ConstMatrixRef& coefficients, TrigonometricSpread spread);

  /// Value, and where `slope` is not null the derivative, outputs x inputs, column-major. Does not allocate.
  VERNIER_API void evaluate(const double* x, double* y, double* slope, double* workspace) const noexcept;

  /// Standard deviation of each output. Does not allocate.
  VERNIER_API void standard_deviation(const double* x, double* out, double* workspace) const noexcept;

  /// One row a feature.
  const Coefficients& coefficients() const { return coefficients_; }
  /// Uncertainty of the coefficients.
  const TrigonometricSpread& spread() const { return *spread_; }

 private:
  Index inputs_;
  Coefficients coefficients_;
  std::shared_ptr<const TrigonometricSpread> spread_;  // never changed: copies may share it
};

}  // namespace detail

/// The fit of a `TrigonometricRegression`: a polynomial of (1, sin q_j, cos q_j), linear in those of each input.
template <int Inputs, int Outputs>
class TrigonometricPredictor
    : public detail::PredictorInterface<TrigonometricPredictor<Inputs, Outputs>, Inputs, Outputs> {
  static_assert(Inputs <= max_arm_joints,
                "the 3^N coefficients of more than nine inputs need too much memory and time");
  using Base = detail::PredictorInterface<TrigonometricPredictor<Inputs, Outputs>, Inputs, Outputs>;

 public:
  using typename Base::Input;
  using typename Base::Output;
  using typename Base::Slope;
  /// Number of features.
  static constexpr int features = static_cast<int>(detail::power_of_three(Inputs));
  /// One row a feature. Feature f has the factor 1, sin q_j or cos q_j where digit j of f to base 3, the first input's
  /// being the most significant one, is 0, 1 or 2.
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, Outputs, Outputs == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

  /// @param coefficients features x outputs
  /// @param spread       their uncertainty
  TrigonometricPredictor(const Coefficients& coefficients, detail::TrigonometricSpread spread)
      : sum_(Inputs, MatrixX(coefficients), std::move(spread)) {}

  /// The polynomial of `Inputs` inputs and `Outputs` outputs.
  explicit TrigonometricPredictor(detail::TrigonometricSum sum) : sum_(std::move(sum)) {}

  /// The prediction, and where `slope` is not null the derivative.
  void evaluate(const Input& x, Output& y, Slope* slope) const noexcept {
    double workspace[detail::TrigonometricSum::workspace(Inputs, Outputs)];
    sum_.evaluate(x.data(), y.data(), slope != nullptr ? slope->data() : nullptr, workspace);
  }

  /// Standard deviation of each output by the Bayesian linear model whose prior is the ridge, without the noise
  /// of a new measurement and without errors that the features cannot express.
  /// @complexity as many multiply-adds as features times the smaller of features and samples
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Input at = x;
    Output out;
    double workspace[detail::TrigonometricSum::workspace(Inputs, Outputs)];
    sum_.standard_deviation(at.data(), out.data(), workspace);
    return out;
  }

  /// One row a feature.
  Coefficients coefficients() const { return sum_.coefficients(); }
  /// Standard deviation of a measurement, from the residuals of the fit.
  Output noise() const { return sum_.spread().noise; }

 private:
  detail::TrigonometricSum sum_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/trigonometric_predictor.ipp"
#endif
