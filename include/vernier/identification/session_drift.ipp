// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/twists.hpp"
#include "vernier/identification/session_drift.hpp"

namespace vernier {

VERNIER_IMPL SessionDrift::Position SessionDrift::position(double time) const {
  const double at = std::clamp((time - begin) / spacing, 0.0, static_cast<double>(knots.cols() - 1));
  const double first = std::floor(at);
  return {static_cast<Index>(first), at - first};
}

namespace detail {

/// Some rows of the knots at a time.
VERNIER_LOCAL VectorX interpolated_knots(const SessionDrift& drift, Index first_row, Index rows, double time) {
  const auto [first, share] = drift.position(time);
  VectorX out(rows);
  for (Index r = 0; r < rows; ++r) {
    out(r) = (1 - share) * drift.knots(first_row + r, first);
    if (share > 0) out(r) += share * drift.knots(first_row + r, first + 1);
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL Vector6 SessionDrift::twist(double time) const {
  return empty() ? Vector6(Vector6::Zero()) : Vector6(detail::interpolated_knots(*this, 0, 6, time));
}

VERNIER_IMPL VectorX SessionDrift::joint_zeros(double time) const {
  return knots.rows() > 6 ? detail::interpolated_knots(*this, 6, knots.rows() - 6, time) : VectorX();
}

VERNIER_IMPL Isometry3 SessionDrift::motion(double time) const {
  const Vector6 by = twist(time);
  const Vector3 shift = VERNIER_LATER(by).template head<3>(), turn = VERNIER_LATER(by).template tail<3>();
  const Matrix3 turned = exp_so3(turn);
  const Vector3 origin = centre - turned * centre;
  return rigid_motion(turned, origin + shift);
}

VERNIER_IMPL Matrix6 SessionDrift::covariance_beyond(double time, const Vector3& point,
                                                     const ConstMatrixRef& jacobian) const {
  Matrix6 out = Matrix6::Zero();
  if (step_variance.size() == 0) return out;
  const double knot = (time - begin) / spacing;
  const double steps = (std::max)({0.0, -knot, knot - static_cast<double>(knots.cols() - 1)});
  const Matrix6 of_base = detail::effect_of_twist(point - centre);
  const auto entry = [&](Index r, Index j) { return j < 6 ? of_base(r, j) : jacobian(r, j - 6); };
  for (Index j = 0; j < step_variance.size(); ++j)
    for (Index c = 0; c < 6; ++c)
      for (Index r = 0; r < 6; ++r) out(r, c) += steps * step_variance(j) * entry(r, j) * entry(c, j);
  return out;
}

}  // namespace vernier
