// SPDX-License-Identifier: BSD-3-Clause
// All joint values that bring a calibrated arm to a pose: closed form of the nominal arm, then Newton's method.

#include <cstdio>
#include <numbers>
#include <vernier/kinematics/all_branches.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/virtual_robot.hpp>

namespace vn = vernier;

int main() {
  const vn::Robot<6> robot = vn::robots::ur10();
  const auto actual = vn::with_geometric_errors(robot.chain, {}, /*seed=*/1);  // what an identification would find
  const vn::JointVector<6> q{0.3, -1.2, 1.4, -0.9, 1.0, 0.2};
  const vn::Isometry3 target = robot.chain.pose(q);

  // Classified once, from the nominal arm: no closed form accepts the actual one, whose axes are not quite parallel.
  const vn::ClosedForm closed_form(robot.chain);
  std::printf("nominal arm: %d joint values\n", closed_form.roots(target).count);

  // From each root to the actual arm; all of them, or a status that says why there is none.
  const vn::Branches<6> found = vn::all_branches(closed_form, actual, target, {.limits = robot.limits, .close_to = q});
  std::printf("actual arm: %s\n", found.describe().c_str());
  for (const vn::Branch<6>& branch : found) {
    const vn::JointVector<6> deg = branch.joints * 180 / std::numbers::pi;
    std::printf(
        "  branch %d [%7.2f %7.2f %7.2f %7.2f %7.2f %7.2f] deg, alone within %.1f mrad%s; %s singularity %.0f deg "
        "away\n",
        branch.singularities.branch(), deg(0), deg(1), deg(2), deg(3), deg(4), deg(5), branch.radius * 1e3,
        branch.proven ? " (proven)" : "", std::string(branch.singularities.nearest()).c_str(),
        branch.singularities.nearest_angle() * 180 / std::numbers::pi);
  }
  std::printf("nearest to where the arm is: the joints move by %.1f mrad\n",
              (found.nearest(q)->joints - q).cwiseAbs().maxCoeff() * 1e3);

  vn::Isometry3 far = target;
  far.translation().x() += 5;
  std::printf("5 m away: %s\n", vn::all_branches(closed_form, actual, far).describe().c_str());
}
