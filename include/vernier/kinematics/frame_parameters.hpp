// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A frame as six parameters beside its matrix.

#include "vernier/core/so3.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A frame as six parameters beside its matrix: x, y, z [m], rotation vector rx, ry, rz [rad].
class FrameParameters {
 public:
  /// Identity.
  VERNIER_API FrameParameters()
      : values_(Vector6::Zero()), frame_(Isometry3::Identity()), rotation_vector_jacobian_(Matrix3::Identity()) {}
  /// From a matrix.
  VERNIER_API FrameParameters(const Isometry3& frame);  // NOLINT(google-explicit-constructor)
  /// From its six values.
  VERNIER_API explicit FrameParameters(const Vector6& values);

  /// x, y, z [m], rx, ry, rz [rad].
  const Vector6& values() const { return values_; }
  /// As a matrix.
  const Isometry3& isometry() const { return frame_; }
  /// Angular velocity, in the outer frame, per rate of the rotation vector.
  const Matrix3& rotation_vector_jacobian() const { return rotation_vector_jacobian_; }

  /// The frame of six values, in any scalar.
  template <class S>
  static IsometryOf<S> isometry(const Eigen::Matrix<S, 6, 1>& values) {
    IsometryOf<S> frame = IsometryOf<S>::Identity();
    frame.translation() = values.template head<3>();
    frame.linear() = exp_so3(values.template tail<3>());
    return frame;
  }

 private:
  Vector6 values_;
  Isometry3 frame_;
  Matrix3 rotation_vector_jacobian_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/frame_parameters.ipp"
#endif
