// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/twists.hpp"
#include "vernier/kinematics/frame_parameters.hpp"
#include "vernier/registration/frame_update.hpp"

namespace vernier::detail {

VERNIER_IMPL Rows6 FrameUpdate::columns(const Isometry3& pose, const double* jacobian) const {
  Rows6 out = Rows6::Zero(6, size());
  const Matrix6 of_base = effect_of_twist(translation(pose));
  for (Index c = 0; base && c < 6; ++c)
    for (Index r = 0; r < 6; ++r) out(r, c) = of_base(r, c);
  if (offsets) std::copy_n(jacobian, 6 * joints, out.data() + 6 * offsets_begin());
  for (Index c = 0; c < 3; ++c)
    for (Index r = 0; r < 3; ++r) {
      if (tool) out(r, tool_begin() + c) = out(r + 3, tool_begin() + c + 3) = pose(r, c);
      if (probe) out(r + 3, probe_begin() + c) = pose(r, c);
    }
  return out;
}

VERNIER_IMPL FrameMotion FrameUpdate::motion(const VectorX& change) const {
  FrameMotion out;
  out.offsets = VectorX::Zero(joints);
  const auto twist = [&](Index begin) {
    Vector6 values;
    for (Index k = 0; k < 6; ++k) values(k) = change(begin + k);
    return FrameParameters::isometry<double>(values);
  };
  if (base) out.base = twist(0);
  if (offsets) out.offsets = VERNIER_LATER(change).segment(offsets_begin(), joints);
  if (tool) out.tool = twist(tool_begin());
  for (Index k = 0; probe && k < 3; ++k) out.probe(k) = change(probe_begin() + k);
  return out;
}

VERNIER_IMPL FrameMotion FrameUpdate::apply(const FrameMotion& before, const VectorX& change) const {
  FrameMotion out = motion(change);
  out.base = composed(out.base, before.base);
  out.offsets += before.offsets;
  out.tool = composed(before.tool, out.tool);
  out.probe = log_so3(exp_so3(before.probe) * exp_so3(out.probe));
  return out;
}

}  // namespace vernier::detail
