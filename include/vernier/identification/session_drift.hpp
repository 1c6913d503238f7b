// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Drift of a measuring session: motion of the arm's base with respect to the sensor.

#include "vernier/core/types.hpp"

namespace vernier {

/// Motion of a base frame over time, and of the zeros of the joints where those move, linear between knots, constant
/// beyond them. An empty one is no motion.
/// @cite ISO 9283; Heisel, Richter and Wurst 1997
struct SessionDrift {
  double begin = 0;                  ///< time of the first knot, in the unit of `Dataset::times`
  double spacing = 1;                ///< from one knot to the next
  Vector3 centre = Vector3::Zero();  ///< point about which the rotations turn [m]
  /// A column a knot: translation of the centre [m], rotation vector [rad], in the sensor's frame; then, where the
  /// joints' zeros move, too, their changes [rad, m].
  MatrixX knots{};
  /// Variance of the change from knot to knot, one value a row of the knots; empty: none beyond the session.
  VectorX step_variance{};

  /// Whether there is none.
  bool empty() const { return knots.cols() == 0; }

  /// The knots on which a time depends: `first` with `1 - share`, the next with `share`.
  struct Position {
    Index first;   ///< a knot
    double share;  ///< of the next knot, in [0, 1)
  };
  /// Where a time lies between two knots.
  VERNIER_API Position position(double time) const;
  /// Changes of the joints' zeros at a time [rad, m]; empty where they rest.
  VERNIER_API VectorX joint_zeros(double time) const;
  /// Translation and rotation at a time.
  VERNIER_API Vector6 twist(double time) const;
  /// The drift as a motion, to be applied in front of a modelled pose.
  VERNIER_API Isometry3 motion(double time) const;
  /// Covariance by which drift has moved a pose before the first knot or after the last: of a random walk from there.
  /// Position [m^2], then orientation [rad^2], sensor's frame. Zero between the knots.
  /// @param time     in the unit of `Dataset::times`
  /// @param point    the tool point [m]
  /// @param jacobian of the pose by the joints, in the sensor's frame: 6 x joints
  VERNIER_API Matrix6 covariance_beyond(double time, const Vector3& point, const ConstMatrixRef& jacobian) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/session_drift.ipp"
#endif
