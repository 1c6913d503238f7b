// SPDX-License-Identifier: BSD-3-Clause
// The laws of solvers that return all branches: ours obeys them, and each planted fault is named.

#include "vernier/testing/branch_laws.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "branch_helpers.hpp"
#include "laws.hpp"
#include "random_chains.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::branch_laws_test {
namespace {

using vernier::testing::branch_violations;
using vernier::testing::BranchLawOptions;
using vernier_test::mentions;
using vernier_test::no_violations;

template <int N>
JointRows<N> samples(int n = 100) {
  Rng rng(1);
  return vernier_test::random_joint_rows<N>(rng, n);
}

TEST(BranchLaws, HoldForAllBranches) {
  Rng rng(2);
  const auto expect_laws = [&](const auto& nominal, const char* name) {
    const ClosedForm form(nominal);
    const auto made = vernier_test::as_made(nominal, rng);
    EXPECT_TRUE(no_violations(branch_violations(
        [&](const Isometry3& target) { return all_branches(form, made, target); }, made, samples<6>())))
        << name;
    EXPECT_TRUE(no_violations(branch_violations(
        [&](const Isometry3& target) { return all_branches(form, nominal, target); }, nominal, samples<6>())))
        << name;
  };
  expect_laws(robots::ur10().chain, "ur10");
  expect_laws(robots::ur5().chain, "ur5");
  expect_laws(robots::abb_irb120().chain, "irb120");
  expect_laws(robots::puma560().chain, "puma560");
}

TEST(BranchLaws, HoldWithLimits) {
  Rng rng(3);
  const auto robot = robots::abb_irb120();
  const ClosedForm form(robot.chain);
  const auto made = vernier_test::as_made(robot.chain, rng);
  const auto solver = [&](const Isometry3& target) {
    return all_branches(form, made, target, {.limits = robot.limits});
  };
  BranchLawOptions<6> options;
  options.limits = robot.limits;
  EXPECT_TRUE(no_violations(branch_violations(solver, made, samples<6>(), options)));
}

TEST(BranchLaws, HoldWithAJointHeld) {
  Rng rng(4);
  const auto wam = robots::barrett_wam().chain;
  const ClosedForm form(wam, HeldJoint{2, 0.3});
  const auto made = vernier_test::as_made(wam, rng);
  JointRows<7> held = samples<7>();
  held.col(2).setConstant(0.3);
  BranchLawOptions<7> options;
  options.held_joint = 2;
  const auto solver = [&](const Isometry3& target) { return all_branches(form, made, target); };
  EXPECT_TRUE(no_violations(branch_violations(solver, made, held, options)));
  options.held_joint = 7;
  EXPECT_THROW(branch_violations(solver, made, held, options), std::invalid_argument);
}

/// A solver of the UR10 with a fault.
std::vector<std::string> violations_with(const std::function<void(Branches<6>&, const Isometry3&)>& fault,
                                         const JointLimits<6>& limits = {}) {
  static const auto arm = [] {
    Rng rng(5);
    return vernier_test::as_made(robots::ur10().chain, rng);
  }();
  static const ClosedForm form(robots::ur10().chain);
  BranchLawOptions<6> options;
  options.limits = limits;
  return branch_violations(
      [&](const Isometry3& target) {
        Branches<6> branches = all_branches(form, arm, target, {.limits = limits});
        fault(branches, target);
        return branches;
      },
      arm, samples<6>(20), options);
}

/// The branch nearest to the sample that made a target: that one.
int generating_branch(const Branches<6>& branches) {
  int best = 0;
  double least = 9;
  const JointRows<6> rows = samples<6>(20);
  for (int k = 0; k < branches.count; ++k)
    for (Index s = 0; s < rows.rows(); ++s) {
      const double apart = vernier_test::joint_difference<6>(branches.branches[static_cast<std::size_t>(k)].joints,
                                                             rows.row(s).transpose());
      if (apart >= least) continue;
      least = apart;
      best = k;
    }
  return best;
}

TEST(BranchLaws, FindADroppedBranch) {
  const auto violations = violations_with([](Branches<6>& branches, const Isometry3&) {
    if (branches.count == 0) return;
    branches.branches[static_cast<std::size_t>(generating_branch(branches))] =
        branches.branches[static_cast<std::size_t>(branches.count - 1)];
    --branches.count;
  });
  EXPECT_TRUE(mentions(violations, "the joint values that made the target are among the branches: broken"));
}

TEST(BranchLaws, FindARepeatedBranch) {
  for (const double turn : {0.0, 2 * std::numbers::pi}) {
    const auto violations = violations_with([&](Branches<6>& branches, const Isometry3&) {
      if (branches.count == 0 || branches.count == Branches<6>::capacity) return;
      Branch<6>& copy = branches.branches[static_cast<std::size_t>(branches.count++)];
      copy = branches.branches[0];
      copy.joints(3) += turn;
    });
    ASSERT_EQ(violations.size(), 1u);
    EXPECT_TRUE(mentions(violations, "no branch is there twice"));
  }
}

TEST(BranchLaws, FindABranchThatMissesItsTarget) {
  EXPECT_TRUE(mentions(violations_with([](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0) branches.branches[0].joints(0) += 1e-6;
                       }),
                       "tool at the target's position"));
  EXPECT_TRUE(mentions(violations_with([](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0) branches.branches[0].joints(5) += 1e-6;
                       }),
                       "tool in the target's orientation"));
  EXPECT_TRUE(mentions(violations_with([](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0) branches.branches[0].joints(2) = std::nan("");
                       }),
                       "tool at the target's position: broken"));
}

TEST(BranchLaws, FindALieAboutLimits) {
  const auto limits = robots::ur10().limits;
  EXPECT_TRUE(no_violations(violations_with([](Branches<6>&, const Isometry3&) {}, limits)));
  JointLimits<6> narrow;
  narrow.lower.setConstant(-1.5);
  narrow.upper.setConstant(1.5);
  const auto all_within = violations_with(
      [](Branches<6>& branches, const Isometry3&) {
        for (int k = 0; k < branches.count; ++k) branches.branches[static_cast<std::size_t>(k)].within_limits = true;
      },
      narrow);
  ASSERT_EQ(all_within.size(), 1u);
  EXPECT_TRUE(mentions(all_within, "within_limits says whether a branch is within the limits"));
  const auto none_within = violations_with([](Branches<6>& branches, const Isometry3&) {
    for (int k = 0; k < branches.count; ++k) branches.branches[static_cast<std::size_t>(k)].within_limits = false;
  });
  EXPECT_TRUE(mentions(none_within, "within_limits says"));
  const auto met =
      violations_with([](Branches<6>& branches, const Isometry3&) { branches.reach = Reach::met; }, narrow);
  EXPECT_TRUE(mentions(met, "reach says"));
}

TEST(BranchLaws, FindNumbersThatAreNone) {
  const char* sentence = "finite and not negative";
  EXPECT_TRUE(mentions(violations_with([](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0) branches.branches[0].sigma_min = -1e-3;
                       }),
                       sentence));
  EXPECT_TRUE(mentions(violations_with([](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0) branches.branches[0].radius = std::nan("");
                       }),
                       sentence));
  EXPECT_TRUE(mentions(violations_with([](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0)
                           branches.branches[0].position_error = std::numeric_limits<double>::infinity();
                       }),
                       sentence));
}

TEST(BranchLaws, FindARadiusThatHoldsAnotherBranch) {
  EXPECT_TRUE(mentions(violations_with([](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0) branches.branches[0].radius = 6 * std::numbers::pi;
                       }),
                       "no other branch lies within the radius"));
}

TEST(BranchLaws, FindWhatDependsOnTheCall) {
  int calls = 0;
  EXPECT_TRUE(mentions(violations_with([&](Branches<6>& branches, const Isometry3&) {
                         if (branches.count > 0) branches.branches[0].radius *= 1 + 1e-15 * ++calls;
                       }),
                       "a repeated call gives the same bits"));
}

TEST(BranchLaws, ASentenceSaysHowOftenAndWhere) {
  const auto violations = violations_with([](Branches<6>& branches, const Isometry3&) {
    if (branches.count > 0) branches.branches[0].joints(5) += 1e-7;  // moves a tool on its axis only round
  });
  ASSERT_EQ(violations.size(), 1u);
  for (const char* part : {"broken 20 times", "at sample ", ", by ", "the tolerance is 1e-09"})
    EXPECT_NE(violations[0].find(part), std::string::npos) << violations[0];
}

TEST(BranchLaws, NoSamplesIsMisuse) {
  const auto ur10 = robots::ur10().chain;
  const ClosedForm form(ur10);
  EXPECT_THROW(branch_violations([&](const Isometry3& target) { return all_branches(form, ur10, target); }, ur10,
                                 JointRows<6>(0, 6)),
               std::invalid_argument);
}

}  // namespace
}  // namespace vernier::branch_laws_test
