// SPDX-License-Identifier: BSD-3-Clause
// Which rows are one pose, readings of a visit joined, and splits that keep poses together.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>
#include <vernier/core/rng.hpp>
#include <vernier/core/so3.hpp>
#include <vernier/data/same_pose.hpp>
#include <vernier/data/split.hpp>

#include "complaint.hpp"

namespace same_pose_test {
namespace {

using vernier::Dataset;
using vernier::Index;
using vernier::JointRows;
using vernier::JointType;
using vernier::MatrixX;
using vernier::PointRows;
using vernier::pose_numbers;
using vernier::Vector3;
using vernier::VectorX;

using Numbers = std::vector<Index>;

TEST(PoseNumbers, RowsAgreeWithTheFirstOfTheirPose) {
  MatrixX q(5, 2);
  q << 0.1, 0.2, 0.5, 0.2, 0.1 + 0.9e-4, 0.2 - 0.9e-4, 0.5, 0.2 + 1.1e-4, 0.1, 0.2;
  EXPECT_EQ(pose_numbers(q), (Numbers{0, 1, 0, 2, 0}));
  EXPECT_EQ(pose_numbers(q, {.angle = 1e-3}), (Numbers{0, 1, 0, 1, 0}));
  EXPECT_EQ(pose_numbers(MatrixX(0, 3)), Numbers{});
}

TEST(PoseNumbers, ChainsOfSmallDifferencesAreNoPose) {
  MatrixX q(30, 1);
  for (Index i = 0; i < 30; ++i) q(i, 0) = 0.6e-4 * static_cast<double>(i);
  const Numbers poses = pose_numbers(q);
  EXPECT_EQ(poses[1], 0);
  EXPECT_EQ(poses[2], 1);
  EXPECT_EQ(poses[29], 14);
}

TEST(PoseNumbers, LengthsHaveALimitOfTheirOwn) {
  MatrixX q(2, 2);
  q << 0.3, 0.1, 0.3, 0.1 + 0.8e-4;
  const std::vector<JointType> types{JointType::revolute, JointType::prismatic};
  EXPECT_EQ(pose_numbers(q), (Numbers{0, 0}));
  EXPECT_EQ(pose_numbers(q, {.joint_types = types}), (Numbers{0, 1}));
  EXPECT_NE(vernier_test::complaint([&] { pose_numbers(MatrixX(2, 3), {.joint_types = types}); }).find("2 types"),
            std::string::npos);
}

// Rows whose weighted sums agree although their joints do not.
TEST(PoseNumbers, AreThoseOfComparingAllRows) {
  vernier::Rng rng(4);
  MatrixX q(400, 3);
  for (double& value : q.reshaped()) value = 1e-4 * std::floor(rng.uniform(0, 4)) + 0.3e-4 * rng.uniform(0, 1);
  Numbers wanted, firsts;
  for (Index i = 0; i < q.rows(); ++i) {
    Index pose = -1;
    for (std::size_t k = 0; k < firsts.size() && pose < 0; ++k)
      if ((q.row(i) - q.row(firsts[k])).cwiseAbs().maxCoeff() <= 1e-4) pose = static_cast<Index>(k);
    if (pose < 0) {
      pose = static_cast<Index>(firsts.size());
      firsts.push_back(i);
    }
    wanted.push_back(pose);
  }
  EXPECT_EQ(pose_numbers(q), wanted);
}

/// Three poses, read some times each; x is the number of the reading.
Dataset<1> readings(const std::vector<double>& joints) {
  const auto n = static_cast<Index>(joints.size());
  JointRows<1> q(n, 1);
  PointRows p = PointRows::Zero(n, 3), r = PointRows::Zero(n, 3);
  for (Index i = 0; i < n; ++i) {
    q(i, 0) = joints[static_cast<std::size_t>(i)];
    p(i, 0) = static_cast<double>(i);
    r(i, 2) = 0.1 * static_cast<double>(i);
  }
  return {q, p, r};
}

TEST(ReadingsJoined, AreMeansOfVisits) {
  const Dataset<1> data = readings({0.1, 0.1, 0.1, 0.5, 0.1, 0.1}).at_temperatures(VectorX::LinSpaced(6, 20, 25));
  const Dataset<1> joined = readings_joined(data);
  ASSERT_EQ(joined.size(), 3);  // the first pose again, later, is another visit
  EXPECT_DOUBLE_EQ(joined.position(0).x(), 1);
  EXPECT_DOUBLE_EQ(joined.position(1).x(), 3);
  EXPECT_DOUBLE_EQ(joined.position(2).x(), 4.5);
  EXPECT_NEAR(vernier::point(joined.orientations(), 0).z(), 0.1, 1e-15);
  EXPECT_NEAR(vernier::point(joined.orientations(), 2).z(), 0.45, 1e-15);
  EXPECT_DOUBLE_EQ(joined.times()(2), 4.5);
  EXPECT_DOUBLE_EQ(joined.temperatures()(0), 21);
  EXPECT_TRUE(std::isnan(joined.previous()(0, 0)));
  EXPECT_DOUBLE_EQ(joined.previous()(1, 0), 0.1);
  EXPECT_DOUBLE_EQ(joined.previous()(2, 0), 0.5);
}

TEST(ReadingsJoined, AMotionInBetweenMakesAnotherVisit) {
  JointRows<1> previous(4, 1);
  previous << -0.4, -0.4, 0.9, std::numeric_limits<double>::quiet_NaN();
  const Dataset<1> joined = readings_joined(readings({0.1, 0.1, 0.1, 0.1}).approached_from(previous));
  ASSERT_EQ(joined.size(), 2);  // from -0.4 twice read; from 0.9, and read again
  EXPECT_DOUBLE_EQ(joined.position(0).x(), 0.5);
  EXPECT_DOUBLE_EQ(joined.position(1).x(), 2.5);
}

TEST(ReadingsJoined, AnotherPayloadMakesAnotherVisit) {
  MatrixX payloads = MatrixX::Constant(4, 4, std::numeric_limits<double>::quiet_NaN());
  payloads.col(0) << 0, 0, 5, 5;
  const Dataset<1> joined = readings_joined(readings({0.1, 0.1, 0.1, 0.1}).carrying(payloads));
  ASSERT_EQ(joined.size(), 2);
  EXPECT_DOUBLE_EQ(joined.position(0).x(), 0.5);
  EXPECT_DOUBLE_EQ(joined.position(1).x(), 2.5);
  EXPECT_EQ(joined.payloads().col(0), Eigen::Vector2d(0, 5));
}

TEST(ReadingsJoined, RowsOfDifferentPosesStayAsTheyAre) {
  const Dataset<1> data = readings({0.1, 0.2, 0.1, 0.2});
  EXPECT_EQ(readings_joined(data).positions(), data.positions());
}

/// 60 rows that visit 20 poses: three rounds, or three readings each.
Dataset<1> repeated(bool rounds) {
  std::vector<double> joints;
  for (int i = 0; i < 60; ++i) joints.push_back(0.1 * (rounds ? i % 20 : i / 3));
  return readings(joints);
}

TEST(Splits, KeepPosesTogether) {
  for (const bool rounds : {true, false}) {
    const Dataset<1> data = repeated(rounds);
    const std::vector<vernier::Split<1>> splits{split(data, {.seed = 3}), split_every(data, 5), split_block(data, 1, 4),
                                                split_region(data), split_time(data)};
    for (std::size_t k = 0; k < splits.size(); ++k) {
      const auto of = [](const Dataset<1>& side) {
        return std::set<double>(side.joints().col(0).begin(), side.joints().col(0).end());
      };
      const std::set<double> train = of(splits[k].train), test = of(splits[k].test);
      for (const double pose : test) EXPECT_EQ(train.count(pose), 0u) << rounds << ", " << k;
      EXPECT_EQ(train.size() + test.size(), 20u);
      EXPECT_EQ(splits[k].train.size() + splits[k].test.size(), 60);
    }
  }
}

TEST(Splits, TooFewPosesAreRefused) {
  const Dataset<1> data = readings({0.1, 0.1, 0.1});
  EXPECT_NE(vernier_test::complaint([&] { split_every(data, 2); }).find("too few poses"), std::string::npos);
}

}  // namespace
}  // namespace same_pose_test
