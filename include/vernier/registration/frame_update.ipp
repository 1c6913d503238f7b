#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/frame_parameters.hpp"
#include "vernier/registration/frame_update.hpp"

namespace vernier::detail {

VERNIER_IMPL Rows6 FrameUpdate::columns(const Isometry3& pose, const double* jacobian) const {
  Rows6 out = Rows6::Zero(6, size());
  Index column = 0;
  if (base) {
    out.block<3, 3>(0, 0).setIdentity();
    out.block<3, 3>(0, 3) = -skew(pose.translation());
    out.block<3, 3>(3, 3).setIdentity();
    column = 6;
  }
  if (offsets) {
    out.middleCols(column, joints) = Eigen::Map<const Rows6>(jacobian, 6, joints);
    column += joints;
  }
  if (tool) {
    out.block<3, 3>(0, column) = pose.linear();
    out.block<3, 3>(3, column + 3) = pose.linear();
  }
  return out;
}

VERNIER_IMPL FrameMotion FrameUpdate::motion(const VectorX& change) const {
  FrameMotion out;
  out.offsets = VectorX::Zero(joints);
  if (base) out.base = FrameParameters::isometry<double>(change.head<6>());
  if (offsets) out.offsets = change.segment(offsets_begin(), joints);
  if (tool) out.tool = FrameParameters::isometry<double>(change.tail<6>());
  return out;
}

VERNIER_IMPL FrameMotion FrameUpdate::apply(const FrameMotion& before, const VectorX& change) const {
  FrameMotion out = motion(change);
  out.base = out.base * before.base;
  out.offsets += before.offsets;
  out.tool = before.tool * out.tool;
  return out;
}

}  // namespace vernier::detail
