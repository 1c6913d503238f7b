// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// An IRB 120 and arms that differ from it, for tests of compensators.

#include "laws.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"
#include "vernier/testing/compensator_laws.hpp"
#include "vernier/testing/kinematic_laws.hpp"

namespace vernier_test {

inline const vernier::Robot<6> robot = vernier::robots::abb_irb120();
inline const vernier::DhChain<6> nominal = robot.chain;
inline const vernier::Elm small_elm{.hidden_nodes = 120, .input_map = vernier::InputMap::sines_and_cosines};

/// With geometric errors.
inline vernier::DhChain<6> actual_arm(std::uint64_t seed = 1) {
  return vernier::with_geometric_errors(nominal, {}, seed);
}
inline vernier::JointRows<6> operating_targets(vernier::Index n, std::uint64_t seed = 2) {
  return vernier::abb_irb120_operating_region().sample(nominal, n, seed);
}

/// Mean position error of an arm at the commands of a compensator.
template <class C>
double mean_error(const vernier::DhChain<6>& actual, const C& compensator, const vernier::JointRows<6>& targets) {
  return vernier::positioning_errors(actual, nominal, vernier::corrected_commands(compensator, targets), targets)
      .position.mean();
}

/// Laws of models and compensators of a fitted arm: where it was measured, where its gate falls, and beyond.
template <class F>
void expect_laws_around_the_gate(const F& fitted) {
  using namespace vernier;
  const auto check = [&](const JointRows<6>& at) {
    EXPECT_TRUE(no_violations(vernier::testing::kinematic_model_violations(fitted, at)));
    EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(fitted, at)));
  };
  check(operating_targets(50, 7));
  JointLimits<6> wider = abb_irb120_operating_region().limits;
  const JointVector<6> range = wider.upper - wider.lower;
  wider.lower -= 0.12 * range;
  wider.upper += 0.12 * range;
  const auto around = sample_joints(wider, 300, 9);
  int falling = 0, closed = 0;
  for (Index i = 0; i < around.rows(); ++i) {
    const double gate = fitted.identified().gate(configuration(around, i));
    falling += gate > 0 && gate < 1;
    closed += gate == 0;
  }
  EXPECT_GT(falling, 100);
  EXPECT_GT(closed, 20);
  check(around);
}

}  // namespace vernier_test
