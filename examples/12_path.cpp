// SPDX-License-Identifier: BSD-3-Clause
// A rectangle in the air: correcting its corners is not correcting its sides.

#include <cstdio>
#include <vernier/compensation/correct_path.hpp>
#include <vernier/core/rng.hpp>
#include <vernier/error_model/error_model.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/virtual_robot.hpp>

namespace vn = vernier;

int main() {
  const vn::Robot<6> robot = vn::robots::ur10();
  // a calibrated arm: its own geometry, joint errors of a few periods a turn (here drawn, else of fit_error_model)
  vn::JointTerms terms(6);
  for (vn::Fourier& of_joint : terms.transmission) of_joint = vn::Fourier::up_to(12);
  vn::VectorX coefficients(terms.size());
  vn::Rng rng(4);
  for (double& c : coefficients) c = 6e-5 * rng.normal();
  using Model = vn::ErrorModel<vn::DhChain<6>>;
  const Model arm(robot.chain,
                  Model::Arm({vn::with_geometric_errors(robot.chain, {}, 4), vn::JointErrors(terms, coefficients)}));

  const vn::JointVector<6> home{0.3, -1.2, 1.4, -0.9, 1.0, 0.2};
  vn::Isometry3 corner = arm.nominal().pose(home);
  std::vector<vn::PathTarget<6>> targets{{.pose = corner}};
  for (const vn::Vector3& by :
       {vn::Vector3(0.3, 0, 0), vn::Vector3(0, 0.3, 0), vn::Vector3(-0.3, 0, 0), vn::Vector3(0, -0.3, 0)}) {
    corner.translation() += by;
    targets.push_back({.pose = corner, .motion = vn::Motion::linear});
  }
  vn::PathOptions<6> options{.limits = robot.limits, .tolerance = 0.05e-3};
  options.start = home;
  const vn::CorrectedPath<6> path = vn::correct_path(arm, vn::ClosedForm(arm.nominal()), targets, options);

  std::printf("%ld targets, %ld met, %ld points inserted\n", static_cast<long>(targets.size()),
              static_cast<long>(path.count(vn::PointStatus::met)), static_cast<long>(path.inserted()));
  std::printf("largest distance from the sides: %.3f mm with the corners alone, %.3f mm with the inserted points\n",
              path.before * 1e3, path.after * 1e3);
  for (const vn::PathPoint<6>& point : path.points)
    if (!point.inserted)
      std::printf("  target %ld: misses by %.1e mm, side left by %.3f mm; %s singularity %.2f rad away\n",
                  static_cast<long>(point.target), point.position_error * 1e3, point.deviation * 1e3,
                  std::string(point.singularities.nearest()).c_str(), point.singularities.nearest_angle());
}
