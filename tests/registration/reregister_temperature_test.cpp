// SPDX-License-Identifier: BSD-3-Clause
// An arm that changes with temperature is registered again by warm poses.

#include <gtest/gtest.h>

#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/registration/reregister.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::reregister_temperature_test {
namespace {

using vernier_test::difference;
using Model = ErrorModel<DhChain<6>>;

const Robot<6> robot = robots::abb_irb120();

/// Longer by 20 ppm/K, fitted at 22 deg C from data of 10 to 40 deg C.
Model model() {
  const Model cold(robot.chain, Model::Arm(with_geometric_errors(robot.chain, {}, 4), FrameParameters(),
                                           FrameParameters(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5})));
  VectorX rates = VectorX::Zero(42);
  for (int j = 0; j < 6; ++j) {
    rates(6 + 5 * j) = 20e-6 * cold.identified().chain().row(j).a;
    rates(6 + 5 * j + 2) = 20e-6 * cold.identified().chain().row(j).d;
  }
  return cold.with_thermal({22, 10, 40, rates});
}

TEST(Reregister, AtTheTemperaturesOfThePoses) {
  const Model before = model();
  const Isometry3 motion = FrameParameters(Vector6{0.3, -0.2, 0.1, 0.02, -0.03, 0.5}).isometry();
  const Model after = before.moved(motion, JointVector<6>::Zero(), Isometry3::Identity());
  const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, 12, 3);
  PointRows positions(12, 3);
  VectorX celsius(12);
  for (Index i = 0; i < 12; ++i) {
    celsius(i) = 24 + static_cast<double>(i);
    set_point(positions, i, after.at_temperature(celsius(i)).position(configuration(joints, i)));
  }
  const Dataset<6> cold = Dataset<6>(joints, positions).without_approach(), warm = cold.at_temperatures(celsius);
  const auto found = reregister(before, warm), ignorant = reregister(before, cold);
  ASSERT_TRUE(found.converged);
  EXPECT_LT(found.rms_after, 1e-9);
  EXPECT_LT(difference(found.motion.base, motion), 1e-8);
  EXPECT_GT(ignorant.rms_after, 0.03e-3);
  // what comes back is at the temperature of the model, and changes with it as before
  for (const double t : {22.0, 35.0}) {
    const JointVector<6> q = configuration(joints, 5);
    EXPECT_LT((found.model.at_temperature(t).position(q) - after.at_temperature(t).position(q)).norm(), 1e-8);
  }
}

TEST(Reregister, AtTheTemperatureOfOnePose) {
  const Model before = model();
  const Isometry3 motion = FrameParameters(Vector6{0.3, -0.2, 0.1, 0.02, -0.03, 0.5}).isometry();
  const Model after = before.moved(motion, JointVector<6>::Zero(), Isometry3::Identity());
  const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, 1, 3);
  const Isometry3 pose = after.at_temperature(37).pose(configuration(joints, 0));
  PointRows position(1, 3), orientation(1, 3);
  set_point(position, 0, translation(pose));
  set_point(orientation, 0, log_so3(rotation(pose)));
  const Dataset<6> cold = Dataset<6>(joints, position, orientation).without_approach();
  EXPECT_LT(difference(reregister(before, cold.at_temperatures(VectorX{{37}})).motion.base, motion), 1e-8);
  EXPECT_GT(difference(reregister(before, cold).motion.base, motion), 0.03e-3);
}

}  // namespace
}  // namespace vernier::reregister_temperature_test
