// SPDX-License-Identifier: BSD-3-Clause
// Several sessions, in each of which the temperature follows the time and the base drifts along: a change of the
// geometry is found if there is one, and drift is not taken for it.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "irb120_fits.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::temperature_sessions_test {
namespace {

using namespace vernier_test::irb120_fits;
using Model = ErrorModel<Chain>;

/// Links get longer by some share a kelvin.
Model actual_arm(double expansion) {
  const Model model(robot.chain, Model::Arm(with_geometric_errors(robot.chain, {}, 4), base, tool));
  const VectorX p = ArmGeometry(model.identified().around(model.identified().chain())).parameters();
  VectorX rates = VectorX::Zero(p.size());
  for (int j = 0; j < 6; ++j)
    for (const int parameter : {6 + 5 * j, 6 + 5 * j + 2}) rates(parameter) = expansion * p(parameter);
  return model.with_thermal({22, 10, 40, rates});
}

/// A session that warms up from `begin` by 2 K. Its base moves by 0.06 mm, and turns by 60 urad.
Dataset<6> session(const Model& actual, double begin, std::uint64_t seed, Index poses = 120) {
  const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, poses, seed);
  Rng rng(seed);
  const Vector3 moves{0.06e-3 * rng.sign(), 0.03e-3 * rng.sign(), 0}, turns{0, 0, 60e-6 * rng.sign()};
  VectorX celsius(poses), times(poses);
  PointRows positions(poses, 3), orientations(poses, 3);
  for (Index i = 0; i < poses; ++i) {
    times(i) = static_cast<double>(i) / static_cast<double>(poses - 1);
    celsius(i) = begin + 2 * times(i);
    const Isometry3 pose = rigid_motion(exp_so3(times(i) * turns), times(i) * moves) *
                           actual.at_temperature(celsius(i)).pose(configuration(joints, i));
    set_point(positions, i, translation(pose));
    set_point(orientations, i, log_so3(rotation(pose)));
    for (int k = 0; k < 3; ++k) {
      positions(i, k) += 0.02e-3 * rng.normal();
      orientations(i, k) += 0.05e-3 * rng.normal();
    }
  }
  return Dataset<6>(joints, positions, orientations).without_approach().measured_at(times).at_temperatures(celsius);
}

FittedErrorModel<Chain> fitted(const std::vector<Dataset<6>>& sessions) {
  Measurements<6> all;
  for (const Dataset<6>& one : sessions) all.add(one);
  return fit_error_model(identified(sessions.front()), all,
                         {.harmonics = 0, .hysteresis = false, .tilt = false, .num_validation_poses = 100}, squared);
}

TEST(TemperatureOfSessions, DriftIsNotTakenForIt) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    std::vector<Dataset<6>> sessions;
    for (std::uint64_t s = 0; s < 3; ++s)
      sessions.push_back(session(actual_arm(0), 20 + static_cast<double>(s), 10 * seed + s));
    const auto found = fitted(sessions);
    const BlockChoice* choice = choice_of(found, "temperature");
    ASSERT_NE(choice, nullptr);
    EXPECT_FALSE(choice->used) << seed;
  }
}

TEST(TemperatureOfSessions, AnExpansionIsFoundAndHelpsOnAnotherDay) {
  const Model actual = actual_arm(20e-6);
  std::vector<Dataset<6>> sessions;
  for (std::uint64_t s = 0; s < 3; ++s) sessions.push_back(session(actual, 20 + 3 * static_cast<double>(s), 20 + s));
  const auto found = fitted(sessions);
  const BlockChoice* choice = choice_of(found, "temperature");
  ASSERT_NE(choice, nullptr);
  EXPECT_EQ(choice->existence.answer, Answer::found);
  EXPECT_TRUE(choice->used);
  const Model cold = actual.at_temperature(18);
  ASSERT_NE(found.model().thermal(), nullptr);
  const auto error = [&](const Model& model) {
    double sum = 0;
    const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, 100, 9);
    const JointVector<6> home = configuration(joints, 0);
    // from a pose to another one: the base of that day does not matter
    for (Index i = 1; i < 100; ++i) {
      const JointVector<6> q = configuration(joints, i);
      sum +=
          std::abs((model.position(q) - model.position(home)).norm() - (cold.position(q) - cold.position(home)).norm());
    }
    return sum / 99;
  };
  EXPECT_LT(error(found.model().at_temperature(20)), 0.9 * error(found.model()));
}

// One session alone cannot tell.
TEST(TemperatureOfSessions, OneSessionIsNotTested) {
  const auto found = fitted({session(actual_arm(20e-6), 20, 5)});
  const BlockChoice* choice = choice_of(found, "temperature");
  ASSERT_NE(choice, nullptr);
  EXPECT_EQ(choice->existence.answer, Answer::untested);
  EXPECT_FALSE(choice->used);
}

}  // namespace
}  // namespace vernier::temperature_sessions_test
