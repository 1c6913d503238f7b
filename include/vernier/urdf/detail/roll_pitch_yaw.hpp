// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// URDF's angles of a rotation.

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Rz(yaw) Ry(pitch) Rx(roll), of roll, pitch, yaw [rad].
VERNIER_API Matrix3 from_roll_pitch_yaw(const Vector3& rpy);

/// Its inverse, exact to rounding for any rotation; yaw is 0 where pitch is +-pi/2, as roll and yaw are then one angle.
VERNIER_API Vector3 roll_pitch_yaw(const Matrix3& rotation);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/detail/roll_pitch_yaw.ipp"
#endif
