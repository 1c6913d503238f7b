// SPDX-License-Identifier: BSD-3-Clause
// Poses that would determine a weak parameter: within limits, and what they gain.

#include "vernier/calibration/pose_advice.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::pose_advice_test {
namespace {

// Base x in units of 2 mm, known to half a unit; measured by 1 mm, a pose adds 4 to an information of 4.
TEST(PoseAdviceWhiteBox, OfOneUnknownByHand) {
  const ArmGeometry arm(in_frames(robots::abb_irb120().chain));
  ErrorModelEstimate estimate{.arm = ArmParameterisation({arm}, {{0, -1, 2e-3, 0}})};
  estimate.covariance = MatrixX::Constant(1, 1, 0.25);
  IdentificationReport identification;
  identification.parameters.push_back(
      {estimate.arm.names()[0], ParameterKind::length, 0, 0, 1e-3, ParameterState::weak, ""});
  VectorX lower = VectorX::Constant(6, -0.3), upper = VectorX::Constant(6, 0.2);
  lower(5) = -std::numeric_limits<double>::infinity();
  const auto advice =
      detail::pose_advice(estimate, identification, lower, upper, {.position_sigma = 1e-3}, false, 3, 3);
  ASSERT_EQ(advice.size(), 1u);
  EXPECT_EQ(advice[0].parameter, "base_x");
  EXPECT_NEAR(advice[0].std_now, 1e-3, 1e-15);
  EXPECT_NEAR(advice[0].std_then, 0.5e-3, 1e-12);
  ASSERT_EQ(advice[0].poses.size(), 3u);
  for (const VectorX& pose : advice[0].poses)
    for (Index j = 0; j < 6; ++j) {
      EXPECT_GE(pose(j), j == 5 ? -3.1416 : -0.3) << j;
      EXPECT_LE(pose(j), 0.2) << j;
    }
}

// The same of the base's rotation about x, measured by orientations alone: positions are hardly measured.
TEST(PoseAdviceWhiteBox, OrientationsCountByTheirOwnDeviation) {
  const ArmGeometry arm(in_frames(robots::abb_irb120().chain));
  ErrorModelEstimate estimate{.arm = ArmParameterisation({arm}, {{3, -1, 2e-3, 0}})};
  estimate.covariance = MatrixX::Constant(1, 1, 0.25);
  IdentificationReport identification;
  identification.parameters.resize(
      4, {estimate.arm.names()[0], ParameterKind::angle, 0, 0, 1e-3, ParameterState::fixed, ""});
  identification.parameters[3].state = ParameterState::weak;
  const VectorX limit = VectorX::Ones(6);
  for (const bool oriented : {true, false}) {
    const auto advice = detail::pose_advice(estimate, identification, -limit, limit,
                                            {.position_sigma = 1e3, .orientation_sigma = 1e-3}, oriented, 3, 3);
    ASSERT_EQ(advice.size(), 1u);
    EXPECT_NEAR(advice[0].std_now, 1e-3, 1e-15);
    EXPECT_NEAR(advice[0].std_then, oriented ? 0.5e-3 : 1e-3, 1e-9);  // positions alone tell nothing
  }
}

// Each weak parameter by its own unknown, up to a number; joints that slide within half a metre where nothing bounds
// them.
TEST(PoseAdviceWhiteBox, OfSeveralUnknownsAndJointsThatSlide) {
  std::array<DhRow, 6> rows;
  for (int i = 0; i < 6; ++i) rows[static_cast<std::size_t>(i)] = robots::abb_irb120().chain.row(i);
  rows[2] = {.a = 0.1, .alpha = 1.5, .d = 0.2, .theta = 0.3, .joint = JointType::prismatic};
  const ArmGeometry arm(in_frames(DhChain<6>::from_rows(rows)));
  ErrorModelEstimate estimate{.arm =
                                  ArmParameterisation({arm}, {{0, -1, 2e-3, 0}, {1, -1, 4e-3, 0}, {2, -1, 8e-3, 0}})};
  estimate.covariance = MatrixX::Zero(3, 3);
  for (Index k = 0; k < 3; ++k) estimate.covariance(k, k) = 0.25;
  IdentificationReport identification;
  for (const char* name : {"base_x", "base_y", "base_z"})
    identification.parameters.push_back({name, ParameterKind::length, 0, 0, 1e-3, ParameterState::weak, ""});
  identification.parameters[0].state = ParameterState::identified;
  VectorX free = VectorX::Constant(6, std::numeric_limits<double>::infinity());
  for (const std::size_t most : {2u, 1u}) {
    const auto advice =
        detail::pose_advice(estimate, identification, -free, free, {.position_sigma = 4e-3}, false, most, 2);
    ASSERT_EQ(advice.size(), most);
    EXPECT_EQ(advice[0].parameter, "base_y");
    EXPECT_NEAR(advice[0].std_now, 2e-3, 1e-15);
    EXPECT_NEAR(advice[0].std_then, 4e-3 / std::sqrt(6), 1e-12);  // information of 4, and 1 by each of two poses
    ASSERT_EQ(advice[0].poses.size(), 2u);
    for (const VectorX& pose : advice[0].poses)
      for (Index j = 0; j < 6; ++j) EXPECT_LE(std::abs(pose(j)), j == 2 ? 0.5 : 3.1416) << j;
    if (most == 1) continue;
    EXPECT_EQ(advice[1].parameter, "base_z");
    EXPECT_NEAR(advice[1].std_now, 4e-3, 1e-15);
    EXPECT_NEAR(advice[1].std_then, 8e-3 / std::sqrt(12), 1e-12);  // 4 by each
  }
}

// Poses in whole degrees and millimetres, or what else to do where they would not help.
TEST(CalibrationReport, WhatToMeasureNextByHand) {
  CalibrationReport report;
  report.joints.resize(3);
  for (JointReport& joint : report.joints) joint.revolute = true;
  report.joints[1].revolute = false;
  report.oriented = true;
  PoseAdvice advice;
  advice.parameter = "beta2";
  advice.kind = ParameterKind::angle;
  advice.std_now = 2e-3;
  advice.std_then = 0.5e-3;
  advice.poses = {Vector3(0.5, -0.25, 1), Vector3(-1, 0.125, 0)};
  report.advice = {advice};
  const auto said = [&] { return report.next().front(); };
  EXPECT_NE(said().find("beta2 is weakly determined (standard deviation 2 mrad)"), std::string::npos) << said();
  EXPECT_NE(said().find(": add poses like (29, -250, 57), (-57, 125, 0)"), std::string::npos) << said();
  report.advice[0].std_then = 1.79e-3;  // nine tenths are 1.8
  EXPECT_NE(said().find("add poses like"), std::string::npos) << said();
  report.advice[0].std_then = 1.81e-3;
  EXPECT_NE(said().find("; more poses would not determine it: fix it, or measure with another tool"), std::string::npos)
      << said();
  report.oriented = false;
  EXPECT_NE(said().find("; more positions would not determine it: measure orientations"), std::string::npos) << said();
  report.advice[0].kind = ParameterKind::length;
  EXPECT_NE(said().find("(standard deviation 2 mm)"), std::string::npos) << said();
}

}  // namespace
}  // namespace vernier::pose_advice_test
