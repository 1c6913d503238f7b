// SPDX-License-Identifier: BSD-3-Clause
// The gate: 1 inside the measured ranges, 0 beyond the margin, smooth between.

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vernier/core/rng.hpp>
#include <vernier/data/joint_coverage.hpp>

namespace joint_coverage_test {
namespace {

using vernier::JointCoverage;
using vernier::JointRows;
using vernier::JointVector;

/// Joint 1 in [-1, 1], margin 0.5; joint 2 in [2, 4], margin 0.25.
JointCoverage<2> example() {
  JointCoverage<2> gate;
  gate.ranges = {{{{-1, 1}}, {{2, 4}}}};
  gate.margin << 0.5, 0.25;
  return gate;
}

TEST(JointCoverage, OneInsideUpToTheEdge) {
  const auto gate = example();
  for (const double q1 : {-1.0, -0.3, 0.0, 1.0})
    for (const double q2 : {2.0, 3.0, 4.0}) {
      EXPECT_EQ(gate({q1, q2}), 1);
      EXPECT_EQ(gate.derivative({q1, q2}).norm(), 0);
    }
}

// What was measured is known beside the wider ranges of the gate, also where others' ranges are added.
TEST(JointCoverage, KeepsTheMeasuredValues) {
  JointRows<2> joints(6, 2);
  joints << 0, 5, 0.1, 5, 0.3, 5, 4, 5, 4.25, 5, 0.2, 5;
  const auto gate = JointCoverage<2>::covering(joints);
  using Ranges = std::vector<vernier::JointRange>;
  EXPECT_EQ(gate.measured[0], (Ranges{{0, 0.3}, {4, 4.25}}));
  EXPECT_EQ(gate.measured[1], (Ranges{{5, 5}}));
  ASSERT_EQ(gate.ranges[0].size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_LT(gate.ranges[0][k].lower, gate.measured[0][k].lower);
    EXPECT_GT(gate.ranges[0][k].upper, gate.measured[0][k].upper);
  }
  const auto joined = gate.joined({{{-9, 9}}, {{-9, 9}}}, vernier::VectorX::Ones(2));
  EXPECT_EQ(joined.measured, gate.measured);
  EXPECT_EQ(joined.ranges[0], (Ranges{{-9, 9}}));
}

TEST(JointCoverage, ZeroFromTheMarginOn) {
  const auto gate = example();
  for (const JointVector<2>& q : {JointVector<2>(1.5, 3), {-1.5, 3}, {0, 1.75}, {0, 4.25}, {100, 3}, {0, -1e6}}) {
    EXPECT_EQ(gate(q), 0);
    EXPECT_EQ(gate.derivative(q).norm(), 0);
  }
}

TEST(JointCoverage, FallsAsACubicAndMultiplies) {
  const auto gate = example();
  EXPECT_DOUBLE_EQ(gate({1.25, 3}), 0.5);                 // half way
  EXPECT_DOUBLE_EQ(gate({-1.125, 3}), 1 - 0.15625);       // a quarter: 1 - (3/16 - 2/64)
  EXPECT_DOUBLE_EQ(gate({1.25, 4.0625}), 0.5 * 0.84375);  // both joints
}

TEST(JointCoverage, DerivativeIsTheCentralDifference) {
  const auto gate = example();
  vernier::Rng rng(1);
  int falling = 0;
  for (int i = 0; i < 300; ++i) {
    const JointVector<2> q(rng.uniform(-1.7, 1.7), rng.uniform(1.7, 4.3));
    const auto derivative = gate.derivative(q);
    const double h = 1e-6;
    for (int j = 0; j < 2; ++j) {
      const JointVector<2> step = h * JointVector<2>::Unit(j);
      // within h of an edge of the fall the second derivative jumps: 12 h / margin^2 at most
      EXPECT_NEAR(derivative(j), (gate(q + step) - gate(q - step)) / (2 * h), 2e-4);
      falling += derivative(j) != 0;
    }
  }
  EXPECT_GT(falling, 50);
}

TEST(JointCoverage, CoversWhatWasMeasured) {
  JointRows<3> q(3, 3);
  q << 0, 5, 1,  //
      1, 5, -1,  //
      0.5, 5, 0;
  const auto gate = JointCoverage<3>::covering(q);
  using Ranges = std::vector<vernier::JointRange>;
  // half a range apart: not known between; widened by half a margin, for three values say little of extremes
  EXPECT_EQ(gate.ranges[0], (Ranges{{-0.05, 0.05}, {0.45, 0.55}, {0.95, 1.05}}));
  EXPECT_EQ(gate.ranges[1], (Ranges{{5, 5}}));
  EXPECT_EQ(gate.ranges[2], (Ranges{{-1.1, -0.9}, {-0.1, 0.1}, {0.9, 1.1}}));
  EXPECT_TRUE(gate.margin.isApprox(JointVector<3>(0.1, 0.02, 0.2), 1e-15));  // a joint held still keeps a margin
  for (int i = 0; i < 3; ++i) EXPECT_EQ(gate(q.row(i).transpose()), 1);
}

TEST(JointCoverage, ValuesWithinTwoMarginsAreOneRange) {
  JointRows<1> q(5, 1);
  q << 0, 0.15, 0.34, 0.8, 1;  // margin 0.1, widened by 0.05
  const auto gate = JointCoverage<1>::covering(q);
  ASSERT_EQ(gate.ranges[0].size(), 2u);
  EXPECT_DOUBLE_EQ(gate.ranges[0][0].lower, -0.05);
  EXPECT_DOUBLE_EQ(gate.ranges[0][0].upper, 0.39);
  EXPECT_DOUBLE_EQ(gate.ranges[0][1].lower, 0.75);
  EXPECT_DOUBLE_EQ(gate.ranges[0][1].upper, 1.05);
  const auto at = [&](double x) { return gate(JointVector<1>(x)); };
  EXPECT_EQ(at(0.25), 1);
  EXPECT_NEAR(at(0.44), 0.5, 1e-12);
  EXPECT_EQ(at(0.57), 0);
  EXPECT_NEAR(at(0.70), 0.5, 1e-12);
  EXPECT_LT(gate.derivative(JointVector<1>(0.44))(0), 0);
  EXPECT_GT(gate.derivative(JointVector<1>(0.70))(0), 0);
}

TEST(JointCoverage, RangesAreTwoMarginsApartAlsoWhenWidened) {
  vernier::Rng rng(3);
  for (int trial = 0; trial < 200; ++trial) {
    JointRows<1> q(3 + trial % 9, 1);
    for (double& value : q.reshaped()) value = rng.uniform(-2, 3);
    const auto gate = JointCoverage<1>::covering(q);
    const auto& ranges = gate.ranges[0];
    for (std::size_t k = 1; k < ranges.size(); ++k)
      EXPECT_GT(ranges[k].lower - ranges[k - 1].upper, 2 * gate.margin(0));
    for (const double value : q.reshaped()) EXPECT_EQ(gate(JointVector<1>(value)), 1);
  }
}

TEST(JointCoverage, OnACircleATurnAwayIsTheSame) {
  constexpr double turn = 2 * std::numbers::pi;
  JointCoverage<2> gate;
  gate.ranges = {{{{-5.2, -4.8}, {-1, 0.7}}, {{2, 4}}}};
  gate.margin << 0.3, 0.25;
  gate.periodic = {true, false};
  vernier::Rng rng(7);
  int falling = 0;
  for (int i = 0; i < 1000; ++i) {
    const JointVector<2> q(rng.uniform(-4, 4), rng.uniform(1.7, 4.3));
    for (const int turns : {-2, 1, 3}) {
      const JointVector<2> further = q + JointVector<2>(turns * turn, 0);
      EXPECT_NEAR(gate(further), gate(q), 1e-12);
      EXPECT_LT((gate.derivative(further) - gate.derivative(q)).norm(), 1e-11);
    }
    const JointVector<2> h(1e-6, 0);
    EXPECT_NEAR(gate.derivative(q)(0), (gate(q + h) - gate(q - h)) / 2e-6, 2e-4);
    falling += gate.derivative(q)(0) != 0;
    EXPECT_TRUE(gate(q) == 1 || q(0) <= -1 || q(0) >= 0.7 || q(1) <= 2 || q(1) >= 4);
    EXPECT_EQ(gate({q(0), q(1) + turn}), 0);  // the other joint stands on a line
  }
  EXPECT_GT(falling, 50);
  EXPECT_EQ(gate({turn - 5, 3}), 1);  // the range of another turn
  EXPECT_EQ(gate({0.9, 3}), 1);       // 0.7 .. 1.083 is a gap of less than two margins
  gate.ranges[0] = {{-10, -1}};       // more than a turn
  for (int i = 0; i < 100; ++i) EXPECT_EQ(gate({rng.uniform(-20, 20), 3}), 1);
}

TEST(JointCoverage, NoGapWithinTwoMargins) {
  JointCoverage<1> gate;
  gate.ranges[0] = {{-3, 3}};  // leaves 0.283 of a turn
  gate.margin << 0.15;
  gate.periodic[0] = true;
  EXPECT_EQ(gate(JointVector<1>(3.1)), 1);
  gate.periodic[0] = false;
  EXPECT_LT(gate(JointVector<1>(3.1)), 1);
  gate.margin << 0.14;
  gate.periodic[0] = true;
  EXPECT_LT(gate(JointVector<1>(3.1)), 0.3);
}

// Joint 1 is measured in [-1, 1] and [5, 6], and elsewhere.
TEST(JointCoverage, JoinedRangesAreTheUnion) {
  using Ranges = std::vector<vernier::JointRange>;
  JointCoverage<2> gate = example();
  gate.ranges[0].push_back({5, 6});
  const auto joined = [&](const Ranges& others, double margin = 0.1) {
    return gate.joined({others, {{2, 4}}}, vernier::VectorX::Constant(2, margin));
  };
  EXPECT_EQ(joined({{-4, -3}, {8, 9}}).ranges[0], (Ranges{{-4, -3}, {-1, 1}, {5, 6}, {8, 9}}));
  EXPECT_EQ(joined({{-3, -1.9}, {7, 8}}).ranges[0], (Ranges{{-3, 1}, {5, 8}}));  // within two margins of 0.5
  EXPECT_EQ(joined({{-0.5, 0.5}, {5.5, 5.7}}).ranges[0], gate.ranges[0]);        // nothing new
  EXPECT_EQ(joined({{0, 5}}).ranges[0], (Ranges{{-1, 6}}));
  EXPECT_EQ(joined({{-2.2, -2.1}}).ranges[0], (Ranges{{-2.2, -2.1}, {-1, 1}, {5, 6}}));
  EXPECT_EQ(joined({{-2.2, -2.1}}, 0.6).ranges[0], (Ranges{{-2.2, 1}, {5, 6}}));  // the larger margin counts
  EXPECT_EQ(joined({{0, 5}}).margin, JointVector<2>(0.5, 0.25));
  EXPECT_EQ(joined({{0, 5}}, 0.3).margin, JointVector<2>(0.5, 0.3));
  EXPECT_EQ(joined({{0, 5}}).ranges[1], (Ranges{{2, 4}}));
  // without ranges a joint was everywhere
  EXPECT_TRUE(joined({}).ranges[0].empty());
  const JointCoverage<2> everywhere = gate.joined({}, vernier::VectorX());
  EXPECT_TRUE(everywhere.ranges[0].empty() && everywhere.ranges[1].empty());
}

TEST(JointCoverage, AJointWithoutRangesIsNotLookedAt) { EXPECT_EQ(JointCoverage<2>{}({1e6, -1e6}), 1); }

TEST(JointCoverage, InfinitelyFarIsZero) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(example()({inf, 3}), 0);
  EXPECT_EQ(example()({0, -inf}), 0);
}

}  // namespace
}  // namespace joint_coverage_test
