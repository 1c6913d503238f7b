#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/so3.hpp"
#include "vernier/identification/session_drift.hpp"

namespace vernier {

VERNIER_IMPL SessionDrift::Position SessionDrift::position(double time) const {
  const double at = std::clamp((time - begin) / spacing, 0.0, static_cast<double>(twists.cols() - 1));
  const double first = std::floor(at);
  return {static_cast<Index>(first), at - first};
}

VERNIER_IMPL Vector6 SessionDrift::twist(double time) const {
  if (empty()) return Vector6::Zero();
  const auto [first, share] = position(time);
  Vector6 out = (1 - share) * twists.col(first);
  if (share > 0) out += share * twists.col(first + 1);
  return out;
}

VERNIER_IMPL Isometry3 SessionDrift::motion(double time) const {
  const Vector6 by = twist(time);
  Isometry3 out = Isometry3::Identity();
  out.linear() = exp_so3(Vector3(by.tail<3>()));
  out.translation() = centre + by.head<3>() - out.linear() * centre;
  return out;
}

}  // namespace vernier
