#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/frame_parameters.hpp"
#include "vernier/registration/frame_update.hpp"

namespace vernier::detail {

VERNIER_IMPL Rows6 FrameUpdate::columns(const Isometry3& pose, const double* jacobian) const {
  Rows6 out = Rows6::Zero(6, size());
  if (base) {
    out.block<3, 3>(0, 0).setIdentity();
    out.block<3, 3>(0, 3) = -skew(pose.translation());
    out.block<3, 3>(3, 3).setIdentity();
  }
  if (offsets) out.middleCols(offsets_begin(), joints) = Eigen::Map<const Rows6>(jacobian, 6, joints);
  if (tool) {
    out.block<3, 3>(0, tool_begin()) = pose.linear();
    out.block<3, 3>(3, tool_begin() + 3) = pose.linear();
  }
  if (probe) out.block<3, 3>(3, probe_begin()) = pose.linear();
  return out;
}

VERNIER_IMPL FrameMotion FrameUpdate::motion(const VectorX& change) const {
  FrameMotion out;
  out.offsets = VectorX::Zero(joints);
  if (base) out.base = FrameParameters::isometry<double>(change.head<6>());
  if (offsets) out.offsets = change.segment(offsets_begin(), joints);
  if (tool) out.tool = FrameParameters::isometry<double>(change.segment<6>(tool_begin()));
  if (probe) out.probe = change.segment<3>(probe_begin());
  return out;
}

VERNIER_IMPL FrameMotion FrameUpdate::apply(const FrameMotion& before, const VectorX& change) const {
  FrameMotion out = motion(change);
  out.base = out.base * before.base;
  out.offsets += before.offsets;
  out.tool = before.tool * out.tool;
  out.probe = log_so3(exp_so3(before.probe) * exp_so3(out.probe));
  return out;
}

}  // namespace vernier::detail
