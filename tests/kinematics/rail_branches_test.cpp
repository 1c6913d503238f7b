// SPDX-License-Identifier: BSD-3-Clause
// Branches of a six-axis arm on a rail that is held.
#include <gtest/gtest.h>

#include <numbers>

#include "vernier/compensation/correct_path.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::rail_branches_test {
namespace {

constexpr double quarter = std::numbers::pi / 2;

/// An IRB 120 on a rail along the y axis of the base.
Framed<DhChain<7>> arm_on_rail() {
  std::array<DhRow, 7> rows;
  rows[0] = {.alpha = quarter, .joint = JointType::prismatic};
  const auto arm = robots::abb_irb120().chain;
  for (int i = 0; i < 6; ++i) rows[static_cast<std::size_t>(i) + 1] = arm.row(i);
  return Framed<DhChain<7>>(DhChain<7>::from_rows(rows), FrameParameters(Vector6{0, 0, 0, -quarter, 0, 0}), {});
}

TEST(RailBranches, AreThoseOfTheArmBesideIt) {
  const auto arm = arm_on_rail();
  const auto alone = robots::abb_irb120();
  Rng rng(4);
  for (int k = 0; k < 50; ++k) {
    JointVector<7> q;
    q(0) = rng.uniform(0, 9);
    for (int j = 1; j < 7; ++j) q(j) = rng.uniform(-1.5, 1.5);
    const ClosedForm closed_form(arm, HeldJoint{0, q(0)});
    BranchOptions<7> options{.close_to = q};
    options.close_to(0) = 0;  // the rail stays, however far it is from here
    const Branches<7> found = all_branches(closed_form, arm, arm.pose(q), options);
    Isometry3 moved = arm.pose(q);
    moved.translation().y() -= q(0);
    const Branches<6> expected = all_branches(ClosedForm<6>(alone.chain), alone.chain, moved);
    EXPECT_EQ(found.count, expected.count);
    bool there = false;
    for (const Branch<7>& branch : found) {
      EXPECT_EQ(branch.joints(0), q(0));
      EXPECT_LT((arm.pose(branch.joints).matrix() - arm.pose(q).matrix()).norm(), 1e-9);
      EXPECT_FALSE(branch.proven);
      there = there || (branch.joints - q).norm() < 1e-7;
    }
    EXPECT_TRUE(there);
  }
}

TEST(RailBranches, AHeldRailStaysOnAWholePath) {
  const auto arm = arm_on_rail();
  JointVector<7> q{2.2, 0.3, -0.2, 0.4, 0.5, 0.8, 0.1};
  PathOptions<7> options;
  options.limits.lower(0) = options.limits.upper(0) = q(0);
  Isometry3 further = arm.pose(q);
  further.translation() += Vector3(0.05, 0.1, -0.05);
  const auto path = correct_path(arm, ClosedForm(arm, HeldJoint{0, q(0)}),
                                 {{arm.pose(q), q}, {.pose = further, .motion = Motion::linear}}, options);
  EXPECT_EQ(path.first_failure(), nullptr);
  for (const auto& point : path.points) EXPECT_EQ(point.command(0), q(0));
  EXPECT_LT((arm.position(path.points.back().command) - Vector3(further.translation())).norm(), 1e-6);
}

TEST(RailBranches, ARailThatMovesHasNoClosedForm) {
  EXPECT_THROW(ClosedForm(arm_on_rail(), HeldJoint{3, 0.1}), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::rail_branches_test
