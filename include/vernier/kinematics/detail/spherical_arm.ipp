// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/check.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/detail/spherical_arm.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

VERNIER_IMPL SphericalArm::SphericalArm(const ArmAxes& axes, double tolerance) : axes_(axes) {
  const Vector3* const h = axes.direction;
  constexpr double apart = 0.05, lever = 1e-3;  // rad, m
  for (const int k : {0, 1, 4, 5})
    demand(h[k].cross(h[k + 1]).norm() > apart, "ArmAngleForm: the axes of joints ", k + 1, " and ", k + 2,
           " are parallel");
  const auto meeting = [&](int first) {
    const MeetingPoint found = meeting_point(h + first, axes.point + first, 3);
    demand(found.miss <= tolerance, "ArmAngleForm: the axes of joints ", first + 1, " to ", first + 3,
           " miss a common point by ", found.miss * 1e3, " mm");
    return found.point;
  };
  shoulder_ = meeting(0);
  wrist_ = meeting(4);
  axis4_ = h[3];
  const Vector3 to_shoulder = shoulder_ - axes.point[3];
  const Vector3 elbow = axes.point[3] + axis4_.dot(to_shoulder) * axis4_;
  upper_ = elbow - shoulder_;
  fore_ = wrist_ - elbow;
  demand(upper_.norm() > lever && axis4_.cross(fore_).norm() > lever,
         "ArmAngleForm: the axis of joint 4 passes through the centre of shoulder or wrist");
  demand(std::abs(axis4_.dot(fore_)) <= tolerance, "ArmAngleForm: the wrist lies ", std::abs(axis4_.dot(fore_)) * 1e3,
         " mm beside the plane through the shoulder at right angles to the axis of joint 4");
  first_ = wrist_of(h[0], h[1], h[2]);
  last_ = wrist_of(h[4], h[5], h[6]);
}

VERNIER_IMPL Vector3 SphericalArm::reference(const Vector3& to_wrist) const noexcept {
  const Vector3 across = first_.k4.cross(to_wrist);
  if (across.norm() > 1e-9 * to_wrist.norm()) return VERNIER_LATER(across).normalized();
  const double along = to_wrist.dot(first_.k5) / to_wrist.squaredNorm();
  return Vector3(first_.k5 - along * to_wrist).normalized();
}

/// The matrix of columns `a`, `b` and `a x b`.
VERNIER_LOCAL inline Matrix3 frame_of_two(const Vector3& a, const Vector3& b) noexcept {
  const Vector3 c = a.cross(b);
  Matrix3 out;
  for (int r = 0; r < 3; ++r) {
    out(r, 0) = a(r);
    out(r, 1) = b(r);
    out(r, 2) = c(r);
  }
  return out;
}

VERNIER_IMPL SphericalArmRoots SphericalArm::solve(const Isometry3& target, double angle,
                                                   const JointVector<7>& close_to, double width) const noexcept {
  SphericalArmRoots out;
  const Matrix3 back_at_zero = VERNIER_LATER(rotation(axes_.tool)).transpose(),
                turn = times3(rotation(target), back_at_zero);
  const Vector3 lever = wrist_ - translation(axes_.tool);
  const Vector3 wrist_centre = translation(target) + rotated(turn, lever), to_wrist = wrist_centre - shoulder_;
  const auto missed = [&](double margin) {
    if (margin > most_margin) out.nearest_margin = (std::min)(out.nearest_margin, margin);
  };
  const Candidates elbows(angles_to_distance(axis4_, fore_, -upper_, to_wrist.norm(), negligible_length), close_to(3));
  missed(elbows.margin);
  if (!(to_wrist.norm() > negligible_length)) return out;  // the wrist in the shoulder: no arm angle
  const Vector3 along = VERNIER_LATER(to_wrist).normalized();
  const Vector3 normal = rotated(rotation_about(along, angle), reference(to_wrist));
  const Matrix3 then = frame_of_two(along, normal);
  for (int i = 0; i < elbows.count; ++i) {
    const double q4 = elbows.angles[i];
    const Matrix3 r4 = rotation_about(axis4_, q4);
    const Vector3 from = upper_ + rotated(r4, fore_);
    // the rotation of the upper arm brings the wrist and axis 4 where they have to be
    const Matrix3 now = frame_of_two(from / from.norm(), axis4_), back = VERNIER_LATER(now).transpose();
    const Matrix3 upper_arm = times3(then, back), forearm = times3(upper_arm, r4);
    const WristAngles begin = solve_wrist(first_, upper_arm, close_to(0), 0);
    const WristAngles end = solve_wrist(last_, transposed_times3(forearm, turn), close_to(4), width);
    missed(begin.margin);
    missed(end.margin);
    for (int k = 0; k < begin.count; ++k)
      for (int m = 0; m < end.count && out.count < SphericalArmRoots::capacity; ++m) {
        const double q[] = {begin.q4[k], begin.q5[k], begin.q6[k], q4, end.q4[m], end.q5[m], end.q6[m]};
        SphericalArmRoot& root = out.roots[static_cast<std::size_t>(out.count++)];
        for (int j = 0; j < 7; ++j) root.joints(j) = wrapped_angle(q[j]);
        root.margin = (std::max)({elbows.margin, begin.margin, end.margin_of(m)});
        root.sampled = m >= end.exact;
        root.free = (begin.any ? 1u : 0u) | (elbows.any ? 8u : 0u) | (end.any ? 16u : 0u);
      }
  }
  return out;
}

VERNIER_IMPL double SphericalArm::arm_angle(const JointVector<7>& q) const noexcept {
  const Matrix3 first_two = times3(rotation_about(first_.k4, q(0)), rotation_about(first_.k5, q(1)));
  const Matrix3 upper_arm = times3(first_two, rotation_about(first_.k6, q(2)));
  const Vector3 bent = upper_ + rotated(rotation_about(axis4_, q(3)), fore_), to_wrist = rotated(upper_arm, bent);
  const Vector3 normal = rotated(upper_arm, axis4_), zero = reference(to_wrist);
  return std::atan2(VERNIER_LATER(to_wrist).normalized().dot(zero.cross(normal)), zero.dot(normal));
}

VERNIER_IMPL SingularityDistances SphericalArm::distances(const JointVector<7>& q) const noexcept {
  const auto bend = [](const Wrist& wrist, double angle) {
    const Vector3 turned = rotated(rotation_about(wrist.k5, angle), wrist.k6);
    return wrist.k4.dot(wrist.k5.cross(turned)) / (std::sin(wrist.alpha) * std::sin(wrist.beta));
  };
  SingularityDistances out;
  out.shoulder = bend(first_, q(1));
  const Vector3 bent = rotated(rotation_about(axis4_, q(3)), fore_);
  out.elbow = axis4_.dot(upper_.cross(bent)) / (upper_.norm() * axis4_.cross(fore_).norm());
  out.wrist = bend(last_, q(5));
  return out;
}

}  // namespace vernier::detail
