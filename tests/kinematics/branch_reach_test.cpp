// SPDX-License-Identifier: BSD-3-Clause
// What became of a target of which all branches were sought: met, beyond limits, out of reach, not found, no pose.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "branch_helpers.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::branch_reach_test {
namespace {

using vernier_test::as_made;
using vernier_test::joint_difference;
using vernier_test::random_joints;
using vernier_test::UnevenJoints;

constexpr double pi = std::numbers::pi;
const double rotation_length = BranchOptions<6>{}.rotation_length;

TEST(Reach, OfTargetsThatAreNoPose) {
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  const Isometry3 good = irb.pose({0.3, 0.4, -0.5, 0.6, 0.9, 0.8});
  std::vector<Isometry3> bad(6, good);
  bad[0](1, 3) = std::nan("");
  bad[1](1, 2) = std::nan("");
  bad[2](0, 3) = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) bad[3](i, 0) *= -1;  // a reflection
  bad[4] = rigid_motion(rotation(good) * (1 + 1e-6), translation(good));
  bad[5] = rigid_motion(Matrix3::Zero(), translation(good));
  for (const Isometry3& target : bad) {
    const auto branches = all_branches(form, irb, target);
    EXPECT_EQ(branches.reach, Reach::invalid_target);
    EXPECT_EQ(branches.count, 0);
    EXPECT_EQ(branches.begin(), branches.end());
  }
}

// Rows of unit length at right angles, to 1e-9 in their products.
TEST(Reach, OfPosesToABillionth) {
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  const Isometry3 good = irb.pose({0.3, 0.4, -0.5, 0.6, 0.9, 0.8});
  for (const double off : {0.8e-9, -0.8e-9, 1.2e-9, -1.2e-9})
    for (int r = 0; r < 3; ++r) {
      Matrix3 longer = Matrix3::Identity(), sheared = longer;
      longer(r, r) += 0.5 * off;      // the square of the length by `off`
      sheared(r, (r + 1) % 3) = off;  // the product with the next row
      for (const Matrix3& by : {longer, sheared}) {
        const Reach reach = all_branches(form, irb, rigid_motion(by * rotation(good), translation(good))).reach;
        EXPECT_EQ(reach == Reach::invalid_target, std::abs(off) > 1e-9) << r << ' ' << off;
      }
    }
}

TEST(Reach, ProvenOutWhereTheArmIsTooShort) {
  Rng rng(8);
  const auto expect_out = [&](const auto& nominal) {
    const ClosedForm form(nominal);
    const auto arm = as_made(nominal, rng);
    const Matrix3 orientation = rotation(nominal.pose(random_joints<6>(rng)));
    const Isometry3 target = rigid_motion(orientation, 10 * vernier_test::random_direction(rng));
    const auto branches = all_branches(form, arm, target);
    EXPECT_EQ(branches.reach, Reach::proven_out);
    EXPECT_EQ(branches.count, 0);
    EXPECT_GT(branches.margin, 8);  // m: none is longer than 2
    EXPECT_LT(branches.margin, 10);
    EXPECT_NE(branches.describe().find("mm farther away"), std::string::npos) << branches.describe();
    // what is no chain proves nothing
    EXPECT_EQ(all_branches(form, UnevenJoints<6>{arm}, target).reach, Reach::not_found);
  };
  expect_out(robots::ur10().chain);
  expect_out(robots::abb_irb120().chain);
  expect_out(robots::puma560().chain);
}

/// A pose with the arm straight out, and the direction in which it is at the end of its reach.
struct StraightOut {
  JointVector<6> joints;
  Isometry3 pose;
  Vector3 outward;
};

/// @param wrist the link whose origin is farthest from axis 2
StraightOut straight_out(const DhChain<6>& arm, const JointVector<6>& joints, int wrist) {
  const auto links = arm.links(joints);
  const Vector3 axis(links.axis(0, 1), links.axis(1, 1), links.axis(2, 1));
  Vector3 outward;
  for (int i = 0; i < 3; ++i) outward(i) = links.origin(i, wrist) - links.point(i, 1);
  outward -= axis.dot(outward) * axis;
  return {joints, arm.pose(joints), outward.normalized()};
}

TEST(Reach, AMicrometreInsideAndOutsideTheReach) {
  const auto expect_boundary = [&](const auto& chain, const StraightOut& at, bool all_out, const char* name) {
    const ClosedForm form(chain);
    EXPECT_LT(std::abs(form.distances(at.joints).elbow), 1e-12) << name;
    const auto branches_at = [&](double beyond) {
      const Isometry3 target = rigid_motion(rotation(at.pose), translation(at.pose) + beyond * at.outward);
      const auto branches = all_branches(form, chain, target);
      for (const auto& branch : branches)
        EXPECT_LT(pose_difference(target, chain.pose(branch.joints)).norm(), 1e-9) << name;
      return branches;
    };
    // two branches there, which differ by an angle whose cosine lacks the micrometre; or none
    const auto inside = branches_at(-1e-6), outside = branches_at(1e-6);
    const auto near_boundary = [&](const Branches<6>& branches) {
      return std::count_if(branches.begin(), branches.end(), [&](const Branch<6>& branch) {
        return std::abs(form.distances(branch.joints).elbow) < 0.02;
      });
    };
    EXPECT_EQ(inside.reach, Reach::met) << name;
    EXPECT_GE(near_boundary(inside), 2) << name;
    EXPECT_EQ(near_boundary(inside) % 2, 0) << name;
    EXPECT_EQ(near_boundary(outside), 0) << name;
    double nearest = 9;
    for (const auto& branch : inside) nearest = std::min(nearest, joint_difference<6>(at.joints, branch.joints));
    EXPECT_GT(nearest, 1e-4) << name;
    EXPECT_LT(nearest, 0.05) << name;
    if (all_out) {
      EXPECT_TRUE(outside.reach == Reach::not_found || outside.reach == Reach::proven_out) << name;
      EXPECT_EQ(outside.count, 0) << name;
      EXPECT_GT(outside.margin, 0) << name;
      EXPECT_LT(outside.margin, 1e-5) << name;
    }
  };
  const auto irb = robots::abb_irb120().chain, ur10 = robots::ur10().chain;
  const double straight = -std::atan2(0.302, 0.07);
  for (const double q2 : {0.4, -0.7, 1.1}) {
    expect_boundary(irb, straight_out(irb, {0.3, q2, straight, 0.6, 0.9, 0.8}, 3), true, "irb120");
    // with its wrist on the other side, it is not straight
    expect_boundary(ur10, straight_out(ur10, {0.3, q2, 0, 0.6, 0.9, 0.8}, 2), false, "ur10");
  }
}

// Six joints, each second derivative at most as long as the arm and the weight of rotations together, twice for the
// logarithm of rotations.
TEST(LipschitzBoundWhiteBox, GrowsWithArmAndWeightOfRotations) {
  EXPECT_NEAR(detail::lipschitz_bound(3, 4), 2 * 6 * 5, 1e-12);
}

// A seed whose tool is at the target, but half a turn off about its axis, is no solution.
TEST(BranchSetWhiteBox, HalfATurnIsNotMet) {
  const auto irb = robots::abb_irb120().chain;
  const JointVector<6> q{0.3, 0.4, -0.5, 0.6, 0.9, 0.8};
  const Isometry3 target = irb.pose(q);
  const auto model = [&](const double* at, Isometry3& pose, double* jacobian) {
    const auto here = irb.pose_and_jacobian(JointVector<6>(at));
    pose = here.pose;
    std::copy_n(here.jacobian.data(), 36, jacobian);
  };
  const JointLimits<6> limits;
  const detail::BranchProblem problem{6,        {0, 1, 2, 3, 4, 5},  model,
                                      target,   limits.lower.data(), limits.upper.data(),
                                      q.data(), rotation_length,     detail::lipschitz_bound(2, rotation_length)};
  JointVector<6> turned = q;
  turned(5) += pi;
  detail::BranchSet set;
  set.refine(problem, turned.data(), 0, false);
  for (int k = 0; k < set.count; ++k) {
    const auto& branch = set.branches[static_cast<std::size_t>(k)];
    EXPECT_LT(pose_difference(target, irb.pose(JointVector<6>(branch.q))).norm(), 1e-9);
  }
}

TEST(ReachWhiteBox, SentencesCountBranchesAndMargins) {
  using detail::describe_reach;
  constexpr double unknown = std::numeric_limits<double>::infinity();
  EXPECT_EQ(describe_reach(Reach::met, 1, 0), "1 branch");
  EXPECT_EQ(describe_reach(Reach::met, 6, 0), "6 branches");
  EXPECT_EQ(describe_reach(Reach::beyond_limits, 3, 0), "joint limits exclude all 3 branches");
  EXPECT_EQ(describe_reach(Reach::proven_out, 0, 0.01234), "out of reach: 12.3 mm farther away than the arm is long");
  EXPECT_EQ(describe_reach(Reach::invalid_target, 0, unknown), "the target is no pose: not finite, or no rotation");
  EXPECT_EQ(describe_reach(Reach::not_found, 0, 0.0567),
            "no branch found: the target lies 5.67 % beyond a boundary of the nominal arm");
  EXPECT_EQ(describe_reach(Reach::not_found, 0, unknown), "no branch found");
}

}  // namespace
}  // namespace vernier::branch_reach_test
