// SPDX-License-Identifier: BSD-3-Clause
// Joint configurations: within their limits, evenly spread, clear of what was to be avoided.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/sampling.hpp>

#include "complaint.hpp"
#include "real_matrix.hpp"

namespace sampling_test {
namespace {

using namespace vernier;
using vernier_test::RealMatrix;

TEST(SampleJoints, UniformWithinLimits) {
  JointLimits<3> limits;
  limits.lower << -1, 0, 5;
  limits.upper << 2, 0, 5.5;  // the second joint is held
  const Index n = 3000;
  const auto q = sample_joints(limits, n, 1);
  ASSERT_EQ(q.rows(), n);
  for (Index i = 0; i < n; ++i) ASSERT_TRUE(limits.contains(configuration(q, i)));
  const RealMatrix columns(q);
  EXPECT_EQ(columns.col(1), RealMatrix(n, 1));
  for (const int j : {0, 2}) {
    const VectorX values = columns.col(j);
    const double width = limits.upper(j) - limits.lower(j), middle = (limits.upper(j) + limits.lower(j)) / 2;
    double squares = 0;
    for (const double value : values) squares += (value - middle) * (value - middle);
    // mean and variance of a uniform distribution, to five deviations of the estimate
    EXPECT_NEAR(values.mean(), middle, 5 * width / std::sqrt(12.0 * n));
    EXPECT_NEAR(squares / static_cast<double>(n), width * width / 12, 5 * width * width / std::sqrt(180.0 * n));
    EXPECT_LT(values.minCoeff(), limits.lower(j) + width / 100);
    EXPECT_GT(values.maxCoeff(), limits.upper(j) - width / 100);
  }
}

TEST(SampleJoints, SeedsDecideAlone) {
  const auto limits = robots::abb_irb120().limits;
  const RealMatrix once = sample_joints(limits, 20, 5), again = sample_joints(limits, 20, 5);
  EXPECT_TRUE(once == again);
  EXPECT_FALSE(once == sample_joints(limits, 20, 6));
  EXPECT_EQ(sample_joints(limits, 0, 5).rows(), 0);
}

TEST(SampleJoints, KeepsWhatIsAcceptedOnly) {
  JointLimits<2> limits;
  limits.lower << -1, -1;
  limits.upper << 1, 1;
  const auto q = sample_joints(limits, 500, 2, [](const JointVector<2>& x) { return x.norm() < 0.5; });
  EXPECT_EQ(q.rows(), 500);
  for (Index i = 0; i < q.rows(); ++i) EXPECT_LT(configuration(q, i).norm(), 0.5);
}

template <class F>
void expect_complaint(F&& f, const char* part) {
  const std::string said = vernier_test::complaint(f);
  EXPECT_NE(said.find(part), std::string::npos) << said;
}

TEST(SampleJoints, ImpossibleWishesThrow) {
  JointLimits<2> limits;
  limits.lower << -1, -1;
  limits.upper << 1, 1;
  int tries = 0;  // a thousand for each configuration, and ten more for luck
  const auto never = [&](const JointVector<2>&) {
    ++tries;
    return false;
  };
  expect_complaint([&] { (void)sample_joints(limits, 3, 1, never); }, "fewer than one configuration in a thousand");
  EXPECT_EQ(tries, 13000);
  expect_complaint([&] { (void)sample_joints(limits, -1, 1); }, "-1 configurations");
  expect_complaint([&] { (void)sample_joints(JointLimits<2>{}, 10, 1); }, "finite");
  JointLimits<2> upside_down = limits;
  upside_down.lower(1) = 1.5;
  expect_complaint([&] { (void)sample_joints(upside_down, 10, 1); }, "lower below upper");
  JointLimits<2> half_open = limits;
  half_open.upper(0) = std::numeric_limits<double>::infinity();
  expect_complaint([&] { (void)sample_joints(half_open, 10, 1); }, "finite");
}

/// Distance of the origin of frame 5 from the first axis, by another way than the region's: the chain without its last
/// link and joint.
double wrist_distance(const DhChain<6>& chain, const JointVector<6>& q) {
  auto p = chain.parameters();
  for (Index k = p.size() - 5; k < p.size(); ++k) p(k) = 0;
  JointVector<6> held = q;
  held(5) = 0;
  const Vector3 wrist = chain.with_parameters(p).position(held);
  return std::hypot(wrist.x(), wrist.y());
}

TEST(OperatingRegion, KeepsTheWristClearOfTheFirstAxis) {
  const auto robot = robots::abb_irb120();
  const auto region = abb_irb120_operating_region();
  const auto q = region.sample(robot.chain, 2000, 3);
  double nearest = 1;
  for (Index i = 0; i < q.rows(); ++i) {
    const JointVector<6> joints = configuration(q, i);
    ASSERT_TRUE(region.limits.contains(joints));
    ASSERT_TRUE(robot.limits.contains(joints));
    nearest = std::min(nearest, wrist_distance(robot.chain, joints));
  }
  EXPECT_GE(nearest, 0.12 - 1e-12);
  EXPECT_LT(nearest, 0.15);  // the clearance is what limits it
  // without the clearance some configurations come nearer
  OperatingRegion<6> free = region;
  free.wrist_clearance = 0;
  const auto anywhere = free.sample(robot.chain, 2000, 3);
  for (Index i = 0; i < anywhere.rows(); ++i)
    nearest = std::min(nearest, wrist_distance(robot.chain, configuration(anywhere, i)));
  EXPECT_LT(nearest, 0.1);
}

TEST(OperatingRegion, HasNoSingularity) {
  const auto robot = robots::abb_irb120();
  const auto q = abb_irb120_operating_region().sample(robot.chain, 1000, 4);
  double worst = 1;
  for (Index i = 0; i < q.rows(); ++i) {
    RealMatrix j = robot.chain.jacobian(configuration(q, i));
    j.set_block(3, 0, 0.3 * j.block(3, 0, 3, 6));  // m a rad
    const RealMatrix s = j.singular_values();
    worst = std::min(worst, s(5) / s(0));
  }
  EXPECT_GT(worst, 0.01);
}

}  // namespace
}  // namespace sampling_test
