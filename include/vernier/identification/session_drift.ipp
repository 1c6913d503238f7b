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

VERNIER_IMPL Matrix6 SessionDrift::covariance_beyond(double time, const Vector3& point,
                                                     const ConstMatrixRef& jacobian) const {
  Matrix6 out = Matrix6::Zero();
  if (step_variance.size() == 0) return out;
  const double knot = (time - begin) / spacing;
  const double steps = std::max({0.0, -knot, knot - static_cast<double>(knots.cols() - 1)});
  Matrix6 of_base = Matrix6::Identity();
  of_base.topRightCorner<3, 3>() = -skew(Vector3(point - centre));
  out = steps * of_base * step_variance.head<6>().asDiagonal() * of_base.transpose();
  for (Index j = 6; j < step_variance.size(); ++j)
    out += steps * step_variance(j) * jacobian.col(j - 6) * jacobian.col(j - 6).transpose();
  return out;
}

}  // namespace vernier
