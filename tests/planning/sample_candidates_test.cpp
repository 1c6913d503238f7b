// SPDX-License-Identifier: BSD-3-Clause
// Configurations that can be measured: within limits, box and range, evenly spread.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "complaint.hpp"
#include "planned_candidates.hpp"
#include "real_matrix.hpp"

namespace vernier::sample_candidates_test {
namespace {

using vernier_test::difference;

TEST(SampleCandidates, ObeyTheirConstraints) {
  const auto robot = robots::abb_irb120();
  MeasurementConstraints constraints{.tool_box = ToolBox{{0, -0.4, 0.1}, {0.8, 0.4, 0.9}},
                                     .tracker = Tracker{.position = {3, 0, 0.5}, .acceptance = 1}};
  const auto found = sample_candidates(robot.chain, robot.limits, constraints, 200, 3);
  EXPECT_EQ(difference(found.joints, sample_candidates(robot.chain, robot.limits, constraints, 200, 3).joints), 0);
  for (Index i = 0; i < 200; ++i) {
    const JointVector<6> q = configuration(found.joints, i);
    const Isometry3 pose = robot.chain.pose(q);
    const Vector3 position = translation(pose), axis(pose(0, 2), pose(1, 2), pose(2, 2));
    for (Index j = 0; j < 6; ++j) {
      EXPECT_GE(q(j), robot.limits.lower(j) + 0.05 - 1e-12);
      EXPECT_LE(q(j), robot.limits.upper(j) - 0.05 + 1e-12);
    }
    for (Index c = 0; c < 3; ++c) {
      EXPECT_GE(position(c), constraints.tool_box->lower(c));
      EXPECT_LE(position(c), constraints.tool_box->upper(c));
    }
    const Vector3 beam = (constraints.tracker->position - position).normalized();
    EXPECT_GE(beam.dot(axis), std::cos(1.0) - 1e-12);
  }
  EXPECT_GT(difference(found.joints, sample_candidates(robot.chain, robot.limits, constraints, 200, 4).joints), 0);
  for (Index i = 0; i < 200; ++i)  // each approached from the one before, the first from where it is
    EXPECT_EQ(configuration(found.previous, i), configuration(found.joints, std::max<Index>(i - 1, 0)));
  EXPECT_EQ(found.rejected[static_cast<std::size_t>(Rejection::none)], 0);
  for (const Rejection r : {Rejection::joint_limits, Rejection::tool_box, Rejection::acceptance})
    EXPECT_GT(found.rejected[static_cast<std::size_t>(r)], 0) << name_of(r);
  EXPECT_EQ(found.rejected[static_cast<std::size_t>(Rejection::self_collision)], 0);

  const auto until = [](const Progress& progress) { return progress.evaluations < 50; };
  const auto first = sample_candidates(robot.chain, robot.limits, constraints, 200, 3, until);
  EXPECT_EQ(difference(first.joints, JointRows<6>(found.joints.topRows(50))), 0);

  constraints.tool_box = ToolBox{{10, 10, 10}, {11, 11, 11}};
  const std::string said =
      vernier_test::complaint([&] { (void)sample_candidates(robot.chain, robot.limits, constraints, 200, 3); });
  EXPECT_NE(said.find("of 1000 configurations 0 can be measured; of the others"), std::string::npos) << said;
  EXPECT_NE(said.find("tool out of its box"), std::string::npos) << said;
  constraints.joint_margin = 10;
  const std::string narrow =
      vernier_test::complaint([&] { (void)sample_candidates(robot.chain, robot.limits, constraints, 200, 3); });
  EXPECT_NE(narrow.find("of the others 1000 are near or beyond the joint limits"), std::string::npos) << narrow;
}

// Where nothing is rejected, each joint is uniform between its limits.
TEST(SampleCandidates, FillTheLimitsOfAllJoints) {
  const auto robot = robots::abb_irb120();
  const auto found = sample_candidates(robot.chain, robot.limits, {.joint_margin = 0}, 400, 3);
  for (const Index rejected : found.rejected) EXPECT_EQ(rejected, 0);
  for (Index j = 0; j < 6; ++j) {
    double sum = 0, squares = 0;
    for (Index i = 0; i < 400; ++i) {
      const double share =
          (found.joints(i, j) - robot.limits.lower(j)) / (robot.limits.upper(j) - robot.limits.lower(j));
      EXPECT_TRUE(share >= 0 && share <= 1) << share;
      sum += share / 400;
      squares += share * share / 400;
    }
    EXPECT_NEAR(sum, 0.5, 0.05) << j;  // three deviations of a mean of 400
    EXPECT_NEAR(squares - sum * sum, 1.0 / 12, 0.01) << j;
  }
}

TEST(SampleCandidates, NeedLimits) {
  const auto robot = robots::abb_irb120();
  const auto complaint = [&](const JointLimits<6>& limits, Index n) {
    return vernier_test::complaint([&] { (void)sample_candidates(robot.chain, limits, {}, n, 1); });
  };
  EXPECT_EQ(complaint(robot.limits, 1), "");
  EXPECT_EQ(complaint(robot.limits, 0), "sample_candidates: 0 candidates requested");
  const double infinity = std::numeric_limits<double>::infinity();
  for (const int fault : {0, 1, 2, 3}) {
    JointLimits<6> limits = robot.limits;
    if (fault == 0) limits.lower(2) = -infinity;
    if (fault == 1) limits.upper(2) = infinity;
    if (fault == 2) limits.upper(0) = limits.lower(0);
    if (fault == 3) limits.upper(5) = limits.lower(5) - 1;
    EXPECT_EQ(complaint(limits, 1), "sample_candidates: the joint limits are not finite, or empty") << fault;
  }
}

}  // namespace
}  // namespace vernier::sample_candidates_test
