// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Linear regression on all products of sines and cosines of different inputs: the terms of the position of an arm with
/// revolute joints.

#include <limits>
#include <optional>

#include "vernier/regression/trigonometric_predictor.hpp"

namespace vernier {

/// Linear least squares on the 3^N products of one of (1, sin q_j, cos q_j) of every input q_j. The position of a chain
/// of revolute joints is exactly linear in them, and so are the effects of geometric errors. The ridge
/// of a feature grows with its degree, the number of angles in it: with few samples, low degrees are preferred. The
/// mean has none. Inputs are angles [rad].
/// @complexity with f features and k = min(n, f): n f k + 9 k^3; six inputs and 5,000 samples take seconds, seven with
/// all features minutes
/// @cite Hoerl and Kennard 1970; Allen 1974
struct TrigonometricRegression {
  /// Largest number of angles in a feature, at least 0; all features by default.
  int max_degree = (std::numeric_limits<int>::max)();
  /// Of the coefficient of a feature of one angle, per sample, divided by `growth`; at least 1e-15. By default chosen
  /// by the closed-form leave-one-out error, the mean alone being a candidate.
  std::optional<double> ridge = std::nullopt;
  double growth = 2;  ///< a feature of d angles has the ridge `ridge growth^d`; in [1e-3, 1e3]

  /// Samples of weight q count as q samples. Neither seed nor executor matter.
  /// @param inputs  n x inputs, angles [rad]
  /// @param targets n x outputs
  /// @param options weights
  template <class X, class Y>
  TrigonometricPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                                         const Eigen::MatrixBase<Y>& targets,
                                                                         const FitOptions& options = {}) const {
    validate();
    detail::require_samples("TrigonometricRegression", inputs, targets, options);
    return TrigonometricPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime>(
        solve(inputs.derived(), targets.derived(), options.weights));
  }

 private:
  VERNIER_API void validate() const;
  VERNIER_API detail::TrigonometricSum solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                             const VectorX* weights) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/trigonometric_regression.ipp"
#endif
