#pragma once

/// @file
/// How far a learned correction may be trusted: fully inside the measured joint ranges, not at all beyond a margin.

#include <algorithm>

#include "vernier/core/types.hpp"

namespace vernier {

/// A factor in [0, 1], product over joints: 1 within [lower, upper], falling smoothly (cubic) to 0 at `margin` outside.
template <int N>
struct JointRangeGate {
  JointVector<N> lower = JointVector<N>::Zero();        ///< least measured joint values [rad, m]
  JointVector<N> upper = JointVector<N>::Zero();        ///< greatest measured joint values [rad, m]
  JointVector<N> margin = JointVector<N>::Constant(1);  ///< width of the fall, > 0

  /// The ranges of measured joints; the margin is a tenth of the range, at least 0.02.
  static JointRangeGate covering(const JointRows<N>& joints) {
    JointRangeGate gate;
    gate.lower = joints.colwise().minCoeff().transpose();
    gate.upper = joints.colwise().maxCoeff().transpose();
    gate.margin = (0.1 * (gate.upper - gate.lower)).cwiseMax(0.02);
    return gate;
  }

  /// The factor at q.
  double operator()(const JointVector<N>& q) const noexcept {
    double product = 1;
    for (int i = 0; i < N; ++i) product *= factor(i, q(i)).value;
    return product;
  }

  /// Its derivative with respect to q.
  Eigen::Matrix<double, 1, N> derivative(const JointVector<N>& q) const noexcept {
    Eigen::Matrix<double, 1, N> out;
    for (int j = 0; j < N; ++j) {
      out(j) = factor(j, q(j)).slope;
      for (int i = 0; i < N && out(j) != 0; ++i)
        if (i != j) out(j) *= factor(i, q(i)).value;
    }
    return out;
  }

 private:
  struct Factor {
    double value, slope;
  };
  Factor factor(int i, double q) const noexcept {
    const double outside = std::max({0.0, lower(i) - q, q - upper(i)}) / margin(i);
    if (outside <= 0) return {1, 0};
    if (!(outside < 1)) return {0, 0};
    const double sign = q > upper(i) ? 1 : -1;
    return {1 - outside * outside * (3 - 2 * outside), -6 * outside * (1 - outside) * sign / margin(i)};
  }
};

}  // namespace vernier
