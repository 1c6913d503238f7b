// SPDX-License-Identifier: BSD-3-Clause
// A robot that is no table: write the four functions of a KinematicModel, and everything else works with it.

#include <cmath>
#include <cstdio>
#include <vernier/compensation/cartesian.hpp>
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/regression/ridge_elm.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>
#include <vernier/testing/kinematic_laws.hpp>

namespace vn = vernier;

// A SCARA, by hand: two parallel links, a vertical slide [m] and a turning tool.
struct Scara {
  static constexpr int dof = 4;
  double l1 = 0.325, l2 = 0.275, height = 0.4;  // [m]
  double zero2 = 0;                             // error of the second joint's zero [rad]

  vn::PoseAndJacobian<4> pose_and_jacobian(const vn::JointVector<4>& q) const noexcept {
    const double a = q(0), b = q(0) + q(1) + zero2, turn = b + q(3);
    const double x2 = l2 * std::cos(b), y2 = l2 * std::sin(b), x = l1 * std::cos(a) + x2, y = l1 * std::sin(a) + y2;
    vn::PoseAndJacobian<4> out{vn::Isometry3::Identity(), vn::Jacobian<4>::Zero()};
    out.pose.translation() << x, y, height - q(2);
    out.pose.linear() = vn::exp_so3(vn::Vector3(0, 0, turn));
    out.jacobian.col(0) << -y, x, 0, 0, 0, 1;  // linear rows first, then angular, in the base frame
    out.jacobian.col(1) << -y2, x2, 0, 0, 0, 1;
    out.jacobian.col(2) << 0, 0, -1, 0, 0, 0;
    out.jacobian.col(3) << 0, 0, 0, 0, 0, 1;
    return out;
  }
  vn::Isometry3 pose(const vn::JointVector<4>& q) const noexcept { return pose_and_jacobian(q).pose; }
  vn::Vector3 position(const vn::JointVector<4>& q) const noexcept { return pose(q).translation(); }
  vn::Jacobian<4> jacobian(const vn::JointVector<4>& q) const noexcept { return pose_and_jacobian(q).jacobian; }
};
static_assert(vn::KinematicModel<Scara>);

int main() {
  const Scara nominal, actual{.l1 = 0.3256, .l2 = 0.2744, .zero2 = 2e-3};  // as built: 0.6 mm and 2 mrad off
  vn::JointLimits<4> limits;
  limits.lower << -2, 0.3, 0, -3;
  limits.upper << 2, 2.3, 0.2, 3;

  // The laws check what types cannot express, such as that the Jacobian is the derivative of the pose.
  const auto violations = vn::testing::kinematic_model_violations(nominal, vn::sample_joints(limits, 100, 1));
  for (const auto& violation : violations) std::printf("broken law: %s\n", violation.c_str());
  if (!violations.empty()) return 1;
  std::printf("the SCARA obeys the laws of kinematic models\n");

  const vn::JointVector<4> q(0.3, 1.0, 0.05, 0.5);
  const auto found = vn::inverse_kinematics(nominal, nominal.pose(q), vn::JointVector<4>(q.array() + 0.2));
  std::printf("inverse kinematics: %d evaluations, joints found again to %.1e rad\n", found.iterations,
              (found.joints - q).norm());

  const auto data = vn::measure(actual, vn::sample_joints(limits, 200, 2), {.position = 0.01e-3});
  const auto fitted = vn::CartesianCompensation{vn::RidgeElm{.hidden_nodes = 60}}.fit(nominal, data);
  const auto targets = vn::sample_joints(limits, 300, 3);
  const auto mean = [&](const vn::JointRows<4>& commands) {
    return vn::positioning_errors(actual, nominal, commands, targets).position.mean() * 1e3;
  };
  std::printf("300 fresh targets: mean error %.3f mm as commanded, %.3f mm corrected\n", mean(targets),
              mean(vn::corrected_commands(fitted, targets)));
}
