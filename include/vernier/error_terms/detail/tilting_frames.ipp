// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/error_terms/detail/tilting_frames.hpp"

namespace vernier::detail {

/// Walks along the chain and fills in its tilting frames; a frame is the one behind the joint, whose z axis is the
/// joint's.
template <class Convention>
void walk_tilting_frames(const ChainView& c, const double* q, TiltingFrames& out) noexcept {
  MovingFrame<double, 3> frame;
  frame.set_identity();
  const auto vector = [](const double* v) { return Vector3(v[0], v[1], v[2]); };
  for (int i = 0; i < c.joints; ++i) {
    const DhRow& row = c.rows[i];
    const double angle = c.theta[i] + c.turning[i] * q[i];
    const auto store = [&] {
      out.x[i] = vector(frame.x);
      out.y[i] = vector(frame.y);
      out.z[i] = vector(frame.z);
      out.origin[i] = vector(frame.p);
    };
    walk_row<Convention>(row, c.twist[i], c.hayati[i], std::sin(angle), std::cos(angle),
                         row.joint == JointType::revolute ? row.d : row.d + q[i], frame,
                         [&](DhParameter parameter, const auto&) {  // before each motion
                           if (parameter == DhParameter::theta) {
                             out.axis[i] = vector(frame.z);
                             out.point[i] = vector(frame.p);
                           }
                           if (parameter == DhParameter::a && !Convention::modified) store();
                         });
    if (Convention::modified) store();
  }
}

VERNIER_IMPL void find_tilting_frames(const ChainView& c, const double* q, TiltingFrames& out) noexcept {
  c.modified ? walk_tilting_frames<ModifiedDh>(c, q, out) : walk_tilting_frames<StandardDh>(c, q, out);
}

}  // namespace vernier::detail
