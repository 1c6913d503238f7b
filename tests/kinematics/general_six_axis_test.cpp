// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics of six revolute joints whose axes lie anyhow: generating joints found again, all roots correct.

#include "vernier/kinematics/detail/general_six_axis.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "allocation_counter.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/general_six_axis.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"

using vernier_test::random_joints;
using vernier_test::RealMatrix;

namespace vernier::general_six_axis_test {
namespace {

constexpr double pi = std::numbers::pi;

/// An arm of any table by the lines of its axes.
detail::SixAxes axes_of(const DhChain<6>& chain) {
  const JointVector<6> zero = JointVector<6>::Zero();
  const auto links = chain.links(zero);
  return {links.axis, links.point, chain.pose(zero)};
}

/// Axes within half a metre, in any directions.
detail::SixAxes random_arm(Rng& rng) {
  detail::SixAxes arm;
  for (int i = 0; i < 6; ++i) {
    arm.direction.col(i) = vernier_test::random_direction(rng);
    for (int k = 0; k < 3; ++k) arm.point(k, i) = rng.uniform(-0.5, 0.5);
  }
  arm.tool = Eigen::Translation3d(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)) *
             Eigen::AngleAxisd(rng.uniform(-pi, pi), vernier_test::random_direction(rng));
  return arm;
}

/// The same table with errors as a calibration finds them: 0.5 mm, 1 mrad.
DhChain<6> with_errors(const DhChain<6>& chain, Rng& rng) {
  DhChain<6>::Parameters p = chain.parameters();
  for (int i = 0; i < p.size(); ++i) p(i) += (i % 5 == 0 || i % 5 == 2 ? 0.5e-3 : 1e-3) * rng.normal();  // a and d
  return chain.with_parameters(p);
}

double difference(const JointVector<6>& a, const JointVector<6>& b) {
  double out = 0;
  for (int i = 0; i < 6; ++i) out = vernier_test::larger(out, std::abs(std::remainder(a(i) - b(i), 2 * pi)));
  return out;
}

/// What holds for roots of any target.
void expect_distinct_roots(const detail::SixAxes& arm, const Isometry3& target, const detail::SixAxisRoots& roots) {
  ASSERT_LE(roots.count, detail::SixAxisRoots::capacity);
  for (const detail::SixAxisRoot& root : roots) {
    EXPECT_LE(pose_difference(target, pose_of(arm, root.joints)).norm(), 1e-9);
    EXPECT_EQ(root.margin, 0);
    for (int i = 0; i < 6; ++i) EXPECT_TRUE(root.joints(i) > -pi && root.joints(i) <= pi);
    for (const detail::SixAxisRoot* other = roots.begin(); other != &root; ++other)
      EXPECT_GE(difference(other->joints, root.joints), 1e-5);
  }
}

struct Tally {
  int found = 0;             ///< generating joints among the roots
  int roots = 0;             ///< all of them
  int most = 0;              ///< of one target
  int well_conditioned = 0;  ///< targets with an elimination below 1e6
};

/// Solves for poses of arms at random joints.
template <class MakeArm>
Tally solve_many(int n, MakeArm&& make_arm) {
  Rng rng(7);
  Tally out;
  for (int i = 0; i < n; ++i) {
    const detail::SixAxes arm = make_arm(rng);
    const JointVector<6> q = random_joints<6>(rng);
    const Isometry3 target = pose_of(arm, q);
    const detail::SixAxisRoots roots = solve_six_axes(arm, target);
    expect_distinct_roots(arm, target, roots);
    bool found = false;
    for (const detail::SixAxisRoot& root : roots) found |= difference(root.joints, q) < 1e-6;
    out.found += found;
    out.roots += roots.count;
    out.most = std::max(out.most, roots.count);
    out.well_conditioned += roots.condition < 1e6;
  }
  return out;
}

TEST(GeneralSixAxis, FindsTheGeneratingJointsOfArmsOfAnyGeometry) {
  const Tally tally = solve_many(300, random_arm);
  EXPECT_EQ(tally.found, 300);
  EXPECT_GE(tally.roots, 4 * 300);
  EXPECT_EQ(tally.well_conditioned, 300);
}

// Closed forms serve these arms better; their parallel and intersecting axes make most eliminations singular.
TEST(GeneralSixAxis, FindsAllJointsOfArmsOfSpecialGeometry) {
  const Tally ur10 = solve_many(200, [](Rng&) { return axes_of(robots::ur10().chain); });
  EXPECT_EQ(ur10.found, 200);
  EXPECT_GE(ur10.roots, 7 * 200);  // 7.2 on average
  const Tally irb120 = solve_many(200, [](Rng&) { return axes_of(robots::abb_irb120().chain); });
  EXPECT_EQ(irb120.found, 200);
  EXPECT_EQ(irb120.roots, 8 * 200);
  // A root at a singularity of the wrist counts as missed: rounding of the target moves it by more than 1e-6 rad.
  const Tally puma560 = solve_many(200, [](Rng&) { return axes_of(robots::puma560().chain); });
  EXPECT_GE(puma560.found, 199);
}

TEST(GeneralSixAxis, FindsTheGeneratingJointsOfCalibratedArms) {
  const Tally ur10 = solve_many(200, [](Rng& rng) { return axes_of(with_errors(robots::ur10().chain, rng)); });
  EXPECT_EQ(ur10.found, 200);
  const Tally irb120 = solve_many(200, [](Rng& rng) { return axes_of(with_errors(robots::abb_irb120().chain, rng)); });
  EXPECT_EQ(irb120.found, 200);
}

// What an iterative search from many starts finds is among the roots.
TEST(GeneralSixAxis, MissesNothingThatASearchFinds) {
  Rng rng(8);
  for (int i = 0; i < 30; ++i) {
    const DhChain<6> chain = i % 3 == 0   ? vernier_test::random_chain<6>(rng, {.prismatic = 0})
                             : i % 3 == 1 ? with_errors(robots::ur10().chain, rng)
                                          : robots::abb_irb120().chain;
    const Isometry3 target = chain.pose(random_joints<6>(rng));
    const detail::SixAxisRoots roots = solve_six_axes(axes_of(chain), target);
    for (int start = 0; start < 50; ++start) {
      const IkResult<6> result = inverse_kinematics(chain, target, random_joints<6>(rng));
      if (result.status != IkStatus::converged) continue;
      double nearest = pi;
      for (const detail::SixAxisRoot& root : roots) nearest = std::min(nearest, difference(root.joints, result.joints));
      EXPECT_LT(nearest, 1e-5) << i;
    }
  }
}

// @cite Manseur and Doty 1989: as many solutions as a six-axis arm may have.
TEST(GeneralSixAxis, FindsSixteenRootsWhereThereAreSo) {
  constexpr DhChain<6> chain{{{
      {.a = 0.3, .alpha = pi / 2, .d = 0},
      {.a = 1, .alpha = pi / 180, .d = 0},
      {.a = 0, .alpha = pi / 2, .d = 0.2},
      {.a = 1.5, .alpha = pi / 180, .d = 0},
      {.a = 0, .alpha = pi / 2, .d = 0},
      {.a = 0, .alpha = pi / 180, .d = 0},
  }}};
  const Tally tally = solve_many(200, [&](Rng&) { return axes_of(chain); });
  EXPECT_EQ(tally.found, 200);
  EXPECT_EQ(tally.most, 16);
}

// A nearly stretched elbow: two roots about to merge.
TEST(GeneralSixAxis, FindsBothRootsNearAFold) {
  const detail::SixAxes arm = axes_of(robots::ur10().chain);
  for (const double elbow : {1e-1, 1e-2, 3e-3}) {
    const JointVector<6> q{0.4, -1.1, elbow, 0.7, 1.2, -0.3};
    const Isometry3 target = pose_of(arm, q);
    const detail::SixAxisRoots roots = solve_six_axes(arm, target);
    expect_distinct_roots(arm, target, roots);
    int near = 0;
    for (const detail::SixAxisRoot& root : roots) near += difference(root.joints, q) < 4 * elbow;
    EXPECT_EQ(near, 2) << elbow;
  }
}

TEST(GeneralSixAxis, UnitsAndPlacementOfTheArmDoNotMatter) {
  Rng rng(3);
  for (int i = 0; i < 20; ++i) {
    const detail::SixAxes arm = random_arm(rng);
    const Isometry3 target = pose_of(arm, random_joints<6>(rng));
    const Isometry3 base = Eigen::Translation3d(3, -4, 2) * Eigen::AngleAxisd(1.3, Vector3(0.6, 0, 0.8));
    detail::SixAxes other = arm;
    const auto placed = [&](Isometry3 pose) {
      pose = base * pose;
      pose.translation() *= 1000;
      return pose;
    };
    other.direction = base.linear() * arm.direction;
    other.point = 1000 * (base * arm.point);
    other.tool = placed(arm.tool);
    EXPECT_EQ(solve_six_axes(arm, target).count, solve_six_axes(other, placed(target)).count);
  }
}

// The determinant of columns of moment over the arm's length, and direction, over the product of their lengths; by the
// axes of the moved chain.
TEST(GeneralSixAxis, DistanceIsTheDeterminantOfUnitColumns) {
  Rng rng(4);
  for (int i = 0; i < 20; ++i) {
    const auto chain = vernier_test::random_chain<6>(rng, {.prismatic = 0});
    const GeneralSixAxis<6> form(chain);
    const JointVector<6> q = random_joints<6>(rng);
    const auto links = chain.links(q);
    RealMatrix columns(6, 6);
    for (int j = 0; j < 6; ++j) {
      const Vector3 axis(links.axis(0, j), links.axis(1, j), links.axis(2, j)),
          point(links.point(0, j), links.point(1, j), links.point(2, j));
      const Vector3 moment = point.cross(axis) / form.arm_length();
      for (int k = 0; k < 3; ++k) {
        columns(k, j) = moment(k) / std::hypot(moment.norm(), 1);
        columns(3 + k, j) = axis(k) / std::hypot(moment.norm(), 1);
      }
    }
    const SingularityDistances at = form.distances(q);
    EXPECT_NEAR(at.wrist, columns.determinant(), 1e-13);
    EXPECT_FALSE(at.factored);
    EXPECT_EQ(at.shoulder, 1);
    EXPECT_EQ(at.elbow, 1);
    EXPECT_GT(std::abs(at.wrist), 1e-7);
  }
}

TEST(GeneralSixAxis, FindsNoRootsOutOfReachNorOfTargetsThatAreNone) {
  Rng rng(5);
  const detail::SixAxes arm = random_arm(rng);
  Isometry3 target = pose_of(arm, random_joints<6>(rng));
  target.translation().x() += 100;
  EXPECT_EQ(solve_six_axes(arm, target).count, 0);
  target.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve_six_axes(arm, target).count, 0);
  target.translation().x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(solve_six_axes(arm, target).count, 0);
}

TEST(GeneralSixAxis, YieldsTheSameBitsAgainWithoutAllocation) {
  Rng rng(6);
  for (const detail::SixAxes& arm : {random_arm(rng), axes_of(robots::abb_irb120().chain)}) {
    const Isometry3 target = pose_of(arm, random_joints<6>(rng));
    const detail::SixAxisRoots once = solve_six_axes(arm, target);
    detail::SixAxisRoots again;
    EXPECT_EQ(vernier_test::allocations([&] { again = solve_six_axes(arm, target); }), 0);
    ASSERT_EQ(once.count, again.count);
    EXPECT_EQ(once.condition, again.condition);
    for (int i = 0; i < once.count; ++i) EXPECT_EQ(once.begin()[i].joints, again.begin()[i].joints);
  }
}

}  // namespace
}  // namespace vernier::general_six_axis_test
