// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vernier/core/same_value.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"
#include "vernier/kinematics/detail/wrist.hpp"

namespace vernier::detail {

VERNIER_IMPL Wrist wrist_of(const Vector3& k4, const Vector3& k5, const Vector3& k6) {
  Wrist out{k4, k5, k6, 0, 0, 0, {}, {}};
  out.alpha = std::atan2(k4.cross(k5).norm(), k4.dot(k5));
  out.beta = std::atan2(k5.cross(k6).norm(), k5.dot(k6));
  out.centre = std::atan2(k4.dot(k5.cross(k6)), k4.dot(k6) - k4.dot(k5) * k5.dot(k6));
  out.e6 = unit_orthogonal(k6);
  out.f6 = k6.cross(out.e6);
  return out;
}

VERNIER_IMPL MeetingPoint meeting_point(const Vector3* directions, const Vector3* points, int lines) noexcept {
  Matrix3 normal = Matrix3::Zero();
  Vector3 right = Vector3::Zero();
  for (int k = 0; k < lines; ++k) {
    const Vector3& h = directions[k];
    Matrix3 off;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) off(r, c) = (r == c ? 1 : 0) - h(r) * h(c);
    normal += off;
    right += rotated(off, points[k]);
  }
  const Matrix3 inverse = VERNIER_LATER(normal).inverse();
  MeetingPoint out{rotated(inverse, right), 0};
  for (int k = 0; k < lines; ++k) {
    const Vector3 lever = out.point - points[k];
    out.miss = (std::max)(out.miss, directions[k].cross(lever).norm());
  }
  if (!std::isfinite(out.point.sum())) out.miss = 1e300;
  return out;
}

VERNIER_IMPL Candidates::Candidates(const AnglePair& pair, double close_to, double widest)
    : angles{close_to, close_to}, count(1), margin(pair.margin), any(pair.any) {
  if (margin > most_margin && !(margin * pair.radius < widest))
    count = 0;
  else
    margin = (std::min)(margin, most_margin);
  if (!any) {
    angles[0] = pair.centre + pair.half;
    angles[1] = pair.centre - pair.half;
    if (same_value(margin, 0) && pair.half > 1e-9 && pair.half < std::numbers::pi - 1e-9) count = 2;
  }
  exact = count;
  if (pair.radius >= widest) return;
  for (int k = 0; k < angle_samples; ++k)
    angles[count++] = pair.centre + (k + 0.5) * 2 * std::numbers::pi / angle_samples;
}

// Joint 5 by the half-angle formula of spherical triangles, which keeps its digits where the wrist is nearly straight.
VERNIER_IMPL WristAngles solve_wrist(const Wrist& wrist, const Matrix3& rotation, double near4,
                                     double widest) noexcept {
  const Vector3 axis = rotated(rotation, wrist.k6);
  const double gamma = std::atan2(wrist.k4.cross(axis).norm(), wrist.k4.dot(axis));
  const double a = wrist.alpha, b = wrist.beta;
  const double numerator = std::sin(0.5 * (gamma - a + b)) * std::sin(0.5 * (gamma + a - b));
  const double denominator = std::sin(0.5 * (a + b + gamma)) * std::sin(0.5 * (a + b - gamma));
  const double half = 2 * std::atan2(std::sqrt((std::max)(numerator, 0.0)), std::sqrt((std::max)(denominator, 0.0)));
  WristAngles out;
  out.any = false;
  out.margin = (std::max)({-numerator, -denominator, 0.0});
  if (out.margin < 1e-15) out.margin = 0;
  out.count = 0;
  const Vector3 turned = rotated(rotation, wrist.e6);
  const auto add = [&](double q4, double q5, const Matrix3& r5) {
    const Vector3 e = rotated_back(r5, rotated(rotation_about(wrist.k4, -q4), turned));
    out.q4[out.count] = q4;
    out.q5[out.count] = q5;
    out.q6[out.count++] = std::atan2(wrist.f6.dot(e), wrist.e6.dot(e));
  };
  const int roots = out.margin > most_margin ? 0 : half > 1e-12 && half < std::numbers::pi - 1e-12 ? 2 : 1;
  for (int k = 0; k < roots; ++k) {
    const double q5 = wrist.centre + (k == 0 ? half : -half);
    const Matrix3 r5 = rotation_about(wrist.k5, q5);
    const AngleAbout q4 = angle_between(wrist.k4, rotated(r5, wrist.k6), axis, 1e-11);
    out.any = out.any || q4.any;
    add(q4.any ? near4 : q4.angle, q5, r5);
  }
  out.exact = out.count;
  if (roots > 0 && (std::min)(half, std::numbers::pi - half) < widest) {
    const double q5 = wrist.centre + (half < 1 ? 0 : std::numbers::pi), q4 = out.q4[0];
    const Matrix3 r5 = rotation_about(wrist.k5, q5);
    for (int k = 0; k < angle_samples; ++k) add(q4 + (k + 0.5) * 2 * std::numbers::pi / angle_samples, q5, r5);
  }
  return out;
}

VERNIER_IMPL double wrapped_angle(double angle) noexcept {
  const double out = angle - 2 * std::numbers::pi * std::nearbyint(angle / (2 * std::numbers::pi));
  return out <= -std::numbers::pi ? std::numbers::pi : out;
}

}  // namespace vernier::detail
