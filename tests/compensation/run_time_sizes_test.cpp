// SPDX-License-Identifier: BSD-3-Clause
// Joint values in matrices whose size is known at run time only, given to arms with learned corrections and to what is
// done with them: those that fit are taken, others are refused in every build.

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/joint_space.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace compensation_run_time_sizes_test {
using namespace vernier;
using vernier_test::complaint;

const DhChain<6> arm = robots::abb_irb120().chain;
const VectorX six = VectorX::LinSpaced(6, 0.1, 0.6), two = VectorX::Constant(2, 0.1);
const JointVector<6> fixed = six;
const std::string refusal = "2 joint values for an arm of 6 joints", columns = "5 joint values for an arm of 6 joints";

MatrixX some_rows(Index cols) {
  MatrixX out(40, cols);
  for (Index i = 0; i < out.rows(); ++i)
    for (Index j = 0; j < cols; ++j)
      out(i, j) = 0.1 * static_cast<double>(j + 1) + 0.01 * static_cast<double>(i % (j + 3));
  return out;
}

TEST(RunTimeSizes, OfCompensatedArms) {
  const auto data = measure(arm, some_rows(6));
  const auto cartesian = CartesianCompensation{Elm{.hidden_nodes = 5}}.fit(arm, data);
  EXPECT_EQ(cartesian.correct(six).command, cartesian.correct(fixed).command);
  EXPECT_EQ(cartesian.identified().position(six), cartesian.position(fixed));
  EXPECT_EQ(corrected_commands(cartesian, some_rows(6)), corrected_commands(cartesian, data.joints()));
  EXPECT_EQ(complaint([&] { static_cast<void>(cartesian.correct(two)); }), refusal);
  EXPECT_EQ(complaint([&] { static_cast<void>(cartesian.correct(arm.pose(fixed), two)); }), refusal);
  EXPECT_EQ(complaint([&] { cartesian.predict(two); }), refusal);
  EXPECT_EQ(complaint([&] { cartesian.identified().pose(two); }), refusal);
  EXPECT_EQ(complaint([&] { corrected_commands(cartesian, some_rows(5)); }), columns);

  const auto joint_space = JointCompensation{Elm{.hidden_nodes = 5}}.fit(arm, data);
  EXPECT_EQ(complaint([&] { joint_space.identified().pose(two); }), refusal);
  const auto direct = JointCompensation{Elm{.hidden_nodes = 5}}.fit(arm, joint_error_labels(arm, data));
  EXPECT_EQ(complaint([&] { static_cast<void>(direct.correct(two)); }), refusal);
}

TEST(RunTimeSizes, OfArmsWithJointErrors) {
  const WithJointErrors<DhChain<6>> elastic(arm);
  EXPECT_EQ(elastic.position(six), elastic.position(fixed));
  EXPECT_EQ(complaint([&] { elastic.pose(two); }), refusal);
  EXPECT_EQ(complaint([&] { elastic.positions(some_rows(5)); }), columns);
  EXPECT_EQ(complaint([&] { ApproachedArm<DhChain<6>>(elastic, fixed).jacobian(two); }), refusal);
  EXPECT_EQ(complaint([&] { measure(elastic, some_rows(5)); }), columns);
}

}  // namespace compensation_run_time_sizes_test
