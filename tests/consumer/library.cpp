// SPDX-License-Identifier: BSD-3-Clause
// A translation unit that uses the compiled library, beside one that is header-only.

#include <vernier/core/register_points.hpp>
#include <vernier/identification/frames.hpp>
#include <vernier/kinematics/dh_chain.hpp>

double reach_by_library() {
  constexpr vernier::DhChain<2> arm{{{{.a = 0.3}, {.a = 0.2}}}};
  vernier::JointVector<2> q;
  q.setZero();
  const vernier::PointRows points = vernier::PointRows::Identity(3, 3);
  return arm.position(q).norm() + vernier::register_points(points, points).translation().norm() * 0;
}
