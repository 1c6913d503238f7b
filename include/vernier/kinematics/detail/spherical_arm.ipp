#pragma once

#include "vernier/core/check.hpp"
#include "vernier/kinematics/detail/spherical_arm.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

VERNIER_IMPL SphericalArm::SphericalArm(const ArmAxes& axes, double tolerance) : axes_(axes) {
  // the point nearest to three lines, and how far they miss it
  const auto meeting_point = [&](int first, Vector3& point) {
    Matrix3 normal = Matrix3::Zero();
    Vector3 right = Vector3::Zero();
    for (int k = first; k < first + 3; ++k) {
      const Vector3 h = axes.direction.col(k), o = axes.point.col(k);
      const Matrix3 off = Matrix3::Identity() - h * h.transpose();
      normal += off;
      right += off * o;
    }
    point = normal.inverse() * right;
    double largest = 0;
    for (int k = first; k < first + 3; ++k)
      largest = std::max(largest, Vector3(axes.direction.col(k)).cross(point - Vector3(axes.point.col(k))).norm());
    require(std::isfinite(largest) && largest <= tolerance, "ArmAngleForm: the axes of joints ", first + 1, " to ",
            first + 3, " miss a common point by ", largest * 1e3, " mm");
  };
  const auto h = [&](int k) { return Vector3(axes.direction.col(k)); };
  constexpr double apart = 0.05, lever = 1e-3;  // rad, m
  for (const int k : {0, 1, 4, 5})
    require(h(k).cross(h(k + 1)).norm() > apart, "ArmAngleForm: the axes of joints ", k + 1, " and ", k + 2,
            " are parallel");
  meeting_point(0, shoulder_);
  meeting_point(4, wrist_);
  axis4_ = h(3);
  const Vector3 elbow = Vector3(axes.point.col(3)) + axis4_ * axis4_.dot(shoulder_ - Vector3(axes.point.col(3)));
  upper_ = elbow - shoulder_;
  fore_ = wrist_ - elbow;
  require(upper_.norm() > lever && axis4_.cross(fore_).norm() > lever,
          "ArmAngleForm: the axis of joint 4 passes through the centre of shoulder or wrist");
  require(std::abs(axis4_.dot(fore_)) <= tolerance, "ArmAngleForm: the wrist lies ", std::abs(axis4_.dot(fore_)) * 1e3,
          " mm beside the plane through the shoulder at right angles to the axis of joint 4");
  first_ = wrist_of(h(0), h(1), h(2));
  last_ = wrist_of(h(4), h(5), h(6));
}

VERNIER_IMPL Vector3 SphericalArm::reference(const Vector3& to_wrist) const noexcept {
  const Vector3 across = first_.k4.cross(to_wrist);
  if (across.norm() > 1e-9 * to_wrist.norm()) return across.normalized();
  return (first_.k5 - to_wrist * (to_wrist.dot(first_.k5) / to_wrist.squaredNorm())).normalized();
}

VERNIER_IMPL SphericalArmRoots SphericalArm::solve(const Isometry3& target, double angle, const JointVector<7>& near,
                                                   double width) const noexcept {
  SphericalArmRoots out;
  const Matrix3 rotation = target.linear() * axes_.tool.linear().transpose();
  const Vector3 to_wrist = target.translation() + rotation * (wrist_ - axes_.tool.translation()) - shoulder_;
  const auto missed = [&](double margin) {
    if (margin > most_margin) out.nearest_margin = std::min(out.nearest_margin, margin);
  };
  const Candidates elbows(angles_to_distance(axis4_, fore_, -upper_, to_wrist.norm(), negligible_length), near(3));
  missed(elbows.margin);
  if (!(to_wrist.norm() > negligible_length)) return out;  // the wrist in the shoulder: no arm angle
  const Vector3 along = to_wrist.normalized();
  const Vector3 normal = rotation_about(along, angle) * reference(to_wrist);
  for (int i = 0; i < elbows.count; ++i) {
    const double q4 = elbows.angles[i];
    const Matrix3 r4 = rotation_about(axis4_, q4);
    const Vector3 from = (upper_ + r4 * fore_).normalized();
    // the rotation of the upper arm brings the wrist and axis 4 where they have to be
    Matrix3 now, then;
    now << from, axis4_, from.cross(axis4_);
    then << along, normal, along.cross(normal);
    const Matrix3 upper_arm = then * now.transpose();
    const WristAngles begin = solve_wrist(first_, upper_arm, near(0), 0);
    const WristAngles end = solve_wrist(last_, (upper_arm * r4).transpose() * rotation, near(4), width);
    missed(begin.margin);
    missed(end.margin);
    for (int k = 0; k < begin.count; ++k)
      for (int m = 0; m < end.count && out.count < SphericalArmRoots::capacity; ++m) {
        const double q[] = {begin.q4[k], begin.q5[k], begin.q6[k], q4, end.q4[m], end.q5[m], end.q6[m]};
        SphericalArmRoot& root = out.roots[static_cast<std::size_t>(out.count++)];
        for (int j = 0; j < 7; ++j) root.joints(j) = wrapped_angle(q[j]);
        root.margin = std::max({elbows.margin, begin.margin, end.margin_of(m)});
        root.sampled = m >= end.exact;
        root.free = (begin.any ? 1u : 0u) | (elbows.any ? 8u : 0u) | (end.any ? 16u : 0u);
      }
  }
  return out;
}

VERNIER_IMPL double SphericalArm::arm_angle(const JointVector<7>& q) const noexcept {
  const Matrix3 upper_arm =
      rotation_about(first_.k4, q(0)) * rotation_about(first_.k5, q(1)) * rotation_about(first_.k6, q(2));
  const Vector3 to_wrist = upper_arm * (upper_ + rotation_about(axis4_, q(3)) * fore_);
  const Vector3 normal = upper_arm * axis4_, zero = reference(to_wrist);
  return std::atan2(to_wrist.normalized().dot(zero.cross(normal)), zero.dot(normal));
}

VERNIER_IMPL SingularityDistances SphericalArm::distances(const JointVector<7>& q) const noexcept {
  const auto bend = [](const Wrist& wrist, double angle) {
    return wrist.k4.dot(wrist.k5.cross(rotation_about(wrist.k5, angle) * wrist.k6)) /
           (std::sin(wrist.alpha) * std::sin(wrist.beta));
  };
  SingularityDistances out;
  out.shoulder = bend(first_, q(1));
  out.elbow =
      axis4_.dot(upper_.cross(rotation_about(axis4_, q(3)) * fore_)) / (upper_.norm() * axis4_.cross(fore_).norm());
  out.wrist = bend(last_, q(5));
  return out;
}

}  // namespace vernier::detail
