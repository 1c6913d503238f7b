// SPDX-License-Identifier: BSD-3-Clause
// An arm that hangs askew: the direction of gravity is found where joints deflect, and nowhere else.

#include <gtest/gtest.h>

#include "irb120_fits.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::gravity_direction_test {
namespace {

using namespace vernier_test::irb120_fits;

const Vector3 actual_down = Vector3(0.5, -0.3, -0.8).normalized();

/// @param sag product of compliance and weight of each joint and link [rad/m]
Dataset<6> measured(double sag) {
  JointTerms terms(6);
  terms.gravity.emplace(robot.chain, actual_down);
  const Framed<WithJointErrors<Chain>> arm(
      {with_geometric_errors(robot.chain, {}, 4), JointErrors(terms, VectorX::Constant(terms.size(), sag))}, base,
      tool);
  return measure(arm, abb_irb120_operating_region().sample(robot.chain, 80, 1),
                 {.position = 0.02e-3, .orientation = 0.05e-3, .with_orientations = true}, 1)
      .without_approach();
}

FittedErrorModel<Chain> fitted(double sag, const Vector3& start) {
  const Dataset<6> data = measured(sag);
  const ErrorModelOptions options{.harmonics = 0,
                                  .down = start,
                                  .estimate_down = true,
                                  .hysteresis = false,
                                  .tilt = false,
                                  .drift = false,
                                  .num_validation_poses = 60};
  return fit_error_model(identified(data), data, options, squared);
}

TEST(GravityDirection, IsFoundFromAnother) {
  const auto found = fitted(5e-4, Vector3(0, 0, -1));
  ASSERT_TRUE(found.arm.terms().gravity);
  const double off = (found.arm.terms().gravity->down() - actual_down).norm();
  EXPECT_GT(found.down_std, 1e-3);
  EXPECT_LT(found.down_std, 0.2);
  EXPECT_LT(off, 3 * found.down_std);
  EXPECT_NEAR(found.arm.terms().gravity->down().norm(), 1, 1e-12);
  EXPECT_EQ(found.model().identified().model().joint_errors().terms().gravity->down(),
            found.arm.terms().gravity->down());
}

TEST(GravityDirection, OfAStiffArmStaysAsGiven) {
  const auto found = fitted(0, Vector3(0, 0, -1));
  EXPECT_EQ(found.down_std, 0);
  EXPECT_FALSE(found.arm.terms().gravity && found.arm.terms().gravity->down() != Vector3(0, 0, -1));
}

}  // namespace
}  // namespace vernier::gravity_direction_test
