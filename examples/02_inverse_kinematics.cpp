// SPDX-License-Identifier: BSD-3-Clause
// Which joints bring the tool to a pose? Inverse kinematics of any model, from a seed, within limits.

#include <cstdio>
#include <numbers>
#include <vernier/kinematics/inverse_kinematics.hpp>
#include <vernier/kinematics/robots.hpp>

namespace vn = vernier;
using namespace vernier::literals;

void show(const char* what, const vn::IkResult<6>& found) {
  const char* status[] = {"converged", "stalled", "unreachable"};
  const vn::JointVector<6> deg = found.joints * 180 / std::numbers::pi;
  std::printf("%-22s %-11s in %3d evaluations, misses by %.2e mm and %.2e mrad\n", what,
              status[static_cast<int>(found.status)], found.iterations, found.position_error * 1e3,
              found.rotation_error * 1e3);
  std::printf("%22s [%.2f %.2f %.2f %.2f %.2f %.2f] deg\n", "", deg(0), deg(1), deg(2), deg(3), deg(4), deg(5));
}

int main() {
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const vn::JointVector<6> q{30_deg, 15_deg, -20_deg, 10_deg, 60_deg, -45_deg};
  const vn::Isometry3 target = robot.chain.pose(q);

  // The answer stays on the branch of the seed (elbow up or down, wrist flipped or not) and within the limits.
  const vn::JointVector<6> seed = q + vn::JointVector<6>::Constant(10_deg);
  show("full pose", vn::inverse_kinematics(robot.chain, target, seed, {.limits = robot.limits}));

  // A position alone leaves the orientation free; so it can be reached with the first three joints.
  const vn::Vector3 point = target.translation();
  show("position, 3 joints", vn::inverse_kinematics(robot.chain, point, seed, {.moving_joints = 3}));

  // Out of reach is an answer, not an exception: the joints that come nearest, and how far they miss.
  vn::Isometry3 far = target;
  far.translation() << 2_m, 0, 300_mm;
  show("2 m away", vn::inverse_kinematics(robot.chain, far, seed, {.limits = robot.limits}));

  // At the wrist singularity (joint 5 at zero) undamped steps explode; these do not.
  vn::JointVector<6> straight = q;
  straight(4) = 0;
  vn::Isometry3 near = robot.chain.pose(straight);
  near.translation().z() += 1_mm;
  show("1 mm from a singularity", vn::inverse_kinematics(robot.chain, near, straight, {.limits = robot.limits}));
}
