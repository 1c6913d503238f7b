#pragma once

#include "vernier/kinematics/frame_parameters.hpp"

namespace vernier {

VERNIER_IMPL FrameParameters::FrameParameters(const Isometry3& frame) : frame_(frame) {
  values_ << frame.translation(), log_so3(frame.linear());
  rotation_vector_jacobian_ = left_jacobian_so3(values_.tail<3>());
}

VERNIER_IMPL FrameParameters::FrameParameters(const Vector6& values)
    : values_(values),
      frame_(isometry<double>(values)),
      rotation_vector_jacobian_(left_jacobian_so3(values.tail<3>())) {}

}  // namespace vernier
