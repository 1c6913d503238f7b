// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/kinematics/frame_parameters.hpp"

namespace vernier {

VERNIER_IMPL FrameParameters::FrameParameters(const Isometry3& frame) : frame_(frame) {
  const Vector3 turn = log_so3(rotation(frame));
  for (Index k = 0; k < 3; ++k) {
    values_(k) = frame(k, 3);
    values_(3 + k) = turn(k);
  }
  rotation_vector_jacobian_ = left_jacobian_so3(turn);
}

VERNIER_IMPL FrameParameters::FrameParameters(const Vector6& values)
    : values_(values),
      frame_(isometry<double>(values)),
      rotation_vector_jacobian_(left_jacobian_so3(VERNIER_LATER(values).template tail<3>())) {}

}  // namespace vernier
