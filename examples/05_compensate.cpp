// SPDX-License-Identifier: BSD-3-Clause
// Learn the position errors of a robot, then correct its commands.

#include <cstdio>
#include <vernier/compensation/cartesian.hpp>
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/regression/ridge_elm.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>

namespace vn = vernier;

int main() {
  // The nominal arm is what the controller believes; the actual one is what stands there (simulated).
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const auto& nominal = robot.chain;
  const auto actual = vn::with_geometric_errors(nominal, {}, /*seed=*/1);
  const auto region = vn::abb_irb120_operating_region();

  // Measure 1000 poses, learn on top of the nominal model, keep the corrected commands within the joint limits.
  const auto data = vn::measure(actual, region.sample(nominal, 1000, 1), {.position = 0.03e-3});
  const vn::RidgeElm regressor{.hidden_nodes = 200};
  const auto compensated = vn::CartesianCompensation{regressor}.fit(nominal, data, {.seed = 1}).within(robot.limits);

  // One command, in microseconds, without allocation: fit for a control loop.
  const vn::JointRows<6> targets = region.sample(nominal, 500, 2);
  const vn::JointVector<6> target = targets.row(0).transpose();
  const vn::Correction<6> correction = compensated.correct(target);
  std::printf("one target: the command moves the joints by up to %.2f mrad\n",
              (correction.command - target).cwiseAbs().maxCoeff() * 1e3);

  // Evaluated on the actual arm, sent to the corrected commands.
  const auto report = [&](const char* what, const vn::JointRows<6>& commands) {
    const auto errors = vn::positioning_errors(actual, nominal, commands, targets);
    const auto mm = vn::ErrorStatistics::of(errors.position * 1e3),
               mrad = vn::ErrorStatistics::of(errors.rotation * 1e3);
    std::printf("%-28s mean %.3f mm, max %.3f mm; orientation mean %.2f mrad\n", what, mm.mean, mm.max, mrad.mean);
  };
  std::printf("\n500 fresh targets:\n");
  report("uncorrected", targets);
  report("Cartesian compensation", vn::corrected_commands(compensated, targets));

  // The paper's own mode moves joints 1 to 3 only and pays with orientation.
  const auto paper =
      vn::CartesianCompensation{regressor, {.target = vn::CorrectionTarget::position, .moving_joints = 3}}.fit(
          nominal, data, {.seed = 1});
  report("the same, joints 1 to 3", vn::corrected_commands(paper, targets));

  // Outside the joint ranges that were measured nothing is trusted: the gate closes and the command is the nominal one.
  vn::JointVector<6> outside = target;
  outside(0) = 2.6;
  std::printf("\nfar outside the measured ranges: gate %.0f, command changed by %.0f mrad\n",
              compensated.correct(outside).gate, (compensated.correct(outside).command - outside).norm() * 1e3);
}
