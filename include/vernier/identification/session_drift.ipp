#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/so3.hpp"
#include "vernier/identification/session_drift.hpp"

namespace vernier {

VERNIER_IMPL SessionDrift::Position SessionDrift::position(double time) const {
  const double at = std::clamp((time - begin) / spacing, 0.0, static_cast<double>(knots.cols() - 1));
  const double first = std::floor(at);
  return {static_cast<Index>(first), at - first};
}

namespace detail {

/// Some rows of the knots at a time.
VERNIER_API VectorX interpolated(const SessionDrift& drift, Index first_row, Index rows, double time) {
  const auto [first, share] = drift.position(time);
  VectorX out = (1 - share) * drift.knots.block(first_row, first, rows, 1);
  if (share > 0) out += share * drift.knots.block(first_row, first + 1, rows, 1);
  return out;
}

}  // namespace detail

VERNIER_IMPL Vector6 SessionDrift::twist(double time) const {
  return empty() ? Vector6(Vector6::Zero()) : Vector6(detail::interpolated(*this, 0, 6, time));
}

VERNIER_IMPL VectorX SessionDrift::joint_zeros(double time) const {
  return knots.rows() > 6 ? detail::interpolated(*this, 6, knots.rows() - 6, time) : VectorX();
}

VERNIER_IMPL Isometry3 SessionDrift::motion(double time) const {
  const Vector6 by = twist(time);
  Isometry3 out = Isometry3::Identity();
  out.linear() = exp_so3(Vector3(by.tail<3>()));
  out.translation() = centre + by.head<3>() - out.linear() * centre;
  return out;
}

}  // namespace vernier
