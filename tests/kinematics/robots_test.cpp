// SPDX-License-Identifier: BSD-3-Clause
// The catalogue.

#include "vernier/kinematics/robots.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "laws.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/testing/kinematic_laws.hpp"

namespace vn = vernier;
using namespace vernier::literals;

namespace robots_test {
namespace {

constexpr vn::DhChain<6> contract_arm{{{
    {.a = 0_mm, .alpha = -90_deg, .d = 290_mm, .theta = 0_deg},
    {.a = 270_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
    {.a = 70_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = 90_deg, .d = 302_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = -90_deg, .d = 0_mm, .theta = 0_deg},
    {.a = 0_mm, .alpha = 0_deg, .d = 72_mm, .theta = 180_deg},
}}};

TEST(Robots, AbbIrb120IsTheTableOfTheContract) { EXPECT_EQ(vn::robots::abb_irb120().chain, contract_arm); }

TEST(Robots, AbbIrb120StandsAsTheMakerDrawsIt) {
  // At zero: upper arm upright, forearm level; the flange 302 + 72 mm ahead of axis 1, 290 + 270 + 70 mm up, facing
  // forward.
  const vn::Isometry3 pose = vn::robots::abb_irb120().chain.pose(vn::JointVector<6>::Zero());
  EXPECT_LE((pose.translation() - vn::Vector3(0.374, 0, 0.630)).norm(), 1e-15);
  EXPECT_LE((pose.linear().col(2) - vn::Vector3::UnitX()).norm(), 1e-15);
}

TEST(Robots, UniversalRobotsAtZeroLieStretchedAlongMinusX) {
  // Sums of the makers' link lengths: x = a2 + a3, y = -(d4 + d6), z = d1 - d5.
  const vn::Vector3 ur10 = vn::robots::ur10().chain.position(vn::JointVector<6>::Zero());
  EXPECT_LE((ur10 - vn::Vector3(-1.1843, -0.256141, 0.0116)).norm(), 1e-15);
  const vn::Vector3 ur5 = vn::robots::ur5().chain.position(vn::JointVector<6>::Zero());
  EXPECT_LE((ur5 - vn::Vector3(-0.81725, -0.19145, -0.005491)).norm(), 1e-15);
}

TEST(Robots, BarrettWamAtZeroPointsUp) {
  // 550 + 300 + 60 mm, the elbow's offset of 45 mm there and back.
  const vn::Isometry3 pose = vn::robots::barrett_wam().chain.pose(vn::JointVector<7>::Zero());
  EXPECT_LE((pose.translation() - vn::Vector3(0, 0, 0.91)).norm(), 1e-15);
  EXPECT_LE((pose.linear() - vn::Matrix3::Identity()).norm(), 1e-15);
}

TEST(Robots, Puma560IsTheSameInBothConventions) {
  const auto standard = vn::robots::puma560();
  const auto modified = vn::robots::puma560_modified();
  EXPECT_EQ(standard.limits.lower, modified.limits.lower);
  EXPECT_EQ(standard.limits.upper, modified.limits.upper);
  vn::Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const vn::JointVector<6> q = vernier_test::random_joints<6>(rng);
    const auto [pose, jacobian] = standard.chain.pose_and_jacobian(q);
    const auto [other_pose, other_jacobian] = modified.chain.pose_and_jacobian(q);
    ASSERT_LE(vernier_test::difference(pose, other_pose), 1e-14);
    ASSERT_LE((jacobian - other_jacobian).cwiseAbs().maxCoeff(), 1e-14);
  }
}

template <int N, class Convention>
void check(const vn::Robot<N, Convention>& robot, const char* name) {
  SCOPED_TRACE(name);
  EXPECT_EQ(robot.name, name);
  EXPECT_TRUE((robot.limits.lower.array() < robot.limits.upper.array()).all());
  EXPECT_LE(robot.limits.upper.maxCoeff(), 7.0);  // radians: 400 deg at most
  EXPECT_TRUE(robot.limits.contains(vn::JointVector<N>::Zero()));
  vn::Rng rng(2);
  vn::JointRows<N> samples(50, N);
  for (vn::Index i = 0; i < samples.rows(); ++i)
    samples.row(i) = vernier_test::random_joints<N>(rng, robot.limits).transpose();
  EXPECT_TRUE(vernier_test::no_violations(vn::testing::kinematic_model_violations(robot.chain, samples)));
  EXPECT_TRUE(vernier_test::no_violations(vn::testing::parametric_model_violations(robot.chain, samples)));
}

TEST(Robots, NamesLimitsAndLaws) {
  check(vn::robots::abb_irb120(), "abb_irb120");
  check(vn::robots::ur10(), "ur10");
  check(vn::robots::ur5(), "ur5");
  check(vn::robots::barrett_wam(), "barrett_wam");
  check(vn::robots::puma560(), "puma560");
  check(vn::robots::puma560_modified(), "puma560_modified");
}

/// Limits are those of the makers, in degrees.
template <int N>
void expect_limits(const vn::JointLimits<N>& limits, const std::array<double, N>& lower,
                   const std::array<double, N>& upper) {
  for (int j = 0; j < N; ++j) {
    EXPECT_NEAR(limits.lower(j) * 180 / std::numbers::pi, lower[static_cast<std::size_t>(j)], 1e-12) << j;
    EXPECT_NEAR(limits.upper(j) * 180 / std::numbers::pi, upper[static_cast<std::size_t>(j)], 1e-12) << j;
  }
}

TEST(Robots, JointsTurnAsFarAsTheMakersSay) {
  const std::array<double, 6> turn{360, 360, 360, 360, 360, 360}, back{-360, -360, -360, -360, -360, -360};
  expect_limits<6>(vn::robots::ur5().limits, back, turn);
  expect_limits<6>(vn::robots::ur10().limits, back, turn);
  expect_limits<6>(vn::robots::abb_irb120().limits, {-165, -110, -110, -160, -120, -400},
                   {165, 110, 70, 160, 120, 400});
  expect_limits<6>(vn::robots::puma560().limits, {-160, -45, -225, -110, -100, -266}, {160, 225, 45, 170, 100, 266});
  // the maker of the WAM gives radians
  const auto wam = vn::robots::barrett_wam().limits;
  const std::array<double, 7> lower{-2.6, -2.0, -2.8, -0.9, -4.76, -1.6, -3.0}, upper{2.6, 2.0, 2.8, 3.1, 1.24, 1.6, 3};
  for (int j = 0; j < 7; ++j) {
    EXPECT_EQ(wam.lower(j), lower[static_cast<std::size_t>(j)]) << j;
    EXPECT_EQ(wam.upper(j), upper[static_cast<std::size_t>(j)]) << j;
  }
}

TEST(JointLimits, ContainAndClamp) {
  const vn::JointLimits<2> limits{{-1, 0}, {1, 2}};
  EXPECT_TRUE(limits.contains({-1, 2}));
  EXPECT_FALSE(limits.contains({-1.0000001, 1}));
  EXPECT_FALSE(limits.contains({0, std::nan("")}));
  EXPECT_EQ(limits.clamp({-3, 3}), vn::JointVector<2>(-1, 2));
  EXPECT_EQ(limits.clamp({0.5, 0.25}), vn::JointVector<2>(0.5, 0.25));
  EXPECT_TRUE(vn::JointLimits<2>{}.contains({-1e300, 1e300}));
}

}  // namespace
}  // namespace robots_test
