// SPDX-License-Identifier: BSD-3-Clause
// All branches of arms that differ from a nominal one: none lost, none twice, and what is said of each is true.

#include "vernier/kinematics/all_branches.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "allocation_counter.hpp"
#include "branch_helpers.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::all_branches_test {
namespace {

using vernier_test::as_made;
using vernier_test::joint_difference;
using vernier_test::joint_distance;
using vernier_test::random_joints;
using vernier_test::RealMatrix;
using vernier_test::UnevenJoints;

constexpr double pi = std::numbers::pi;
constexpr double held_value = 0.3;
const double rotation_length = BranchOptions<6>{}.rotation_length;

static_assert(KinematicModel<UnevenJoints<6>> && !NominalArm<UnevenJoints<6>>);

template <int N>
JointVector<N> random_configuration(Rng& rng, int held) {
  JointVector<N> q = random_joints<N>(rng);
  if (held >= 0) q(held) = held_value;
  return q;
}

/// Jacobian of the moving joints, rotations weighted as lengths.
template <class M>
RealMatrix weighted_jacobian(const M& model, const JointVector<M::dof>& q, int held) {
  const RealMatrix all = RealMatrix::of(model.jacobian(q));
  RealMatrix out(6, 6);
  for (int j = 0, k = 0; j < M::dof; ++j)
    if (j != held) out.set_block(0, k++, all.col(j));
  out.set_block(3, 0, rotation_length * out.block(3, 0, 3, 6));
  return out;
}

template <class M>
double smallest_singular_value(const M& model, const JointVector<M::dof>& q, int held) {
  return weighted_jacobian(model, q, held).singular_values()(5);
}

template <int N>
bool contains(const Branches<N>& branches, const JointVector<N>& q, double tolerance) {
  for (const Branch<N>& branch : branches)
    if (joint_difference<N>(branch.joints, q) < tolerance) return true;
  return false;
}

// ---------------------------------------------------------------------------------------------------------------------
// random poses

/// Poses of arms as made: every branch meets its target, no two alike, and the joints that made the target among them,
/// but for one in a thousand poses, next to folds.
template <int N, class Roots, class Make>
void expect_branches(const Roots& nominal, const Make& make, const std::string& name, int poses,
                     double most_lost = 0.001) {
  Rng rng(1);
  const int held = nominal.held_joint();
  double position = 0, rotation = 0, understated = 0, sigma = 0;
  int lost = 0, alike = 0, inside = 0, moved = 0, not_met = 0;
  for (int i = 0; i < poses; ++i) {
    const auto arm = make(rng);
    const JointVector<N> q = random_configuration<N>(rng, held);
    const Isometry3 target = arm.pose(q);
    const Branches<N> branches = all_branches(nominal, arm, target);
    not_met += branches.reach != Reach::met;
    if (!contains<N>(branches, q, 1e-6)) {
      ++lost;
      EXPECT_LT(smallest_singular_value(arm, q, held), 0.02) << name;
    }
    for (const Branch<N>& branch : branches) {
      const Vector6 left = pose_difference(target, arm.pose(branch.joints));
      const double shifted = Vector3(left(0), left(1), left(2)).norm();
      const double turned = Vector3(left(3), left(4), left(5)).norm();
      position = std::max(position, shifted);
      rotation = std::max(rotation, turned);
      understated = std::max({understated, shifted - branch.position_error, turned - branch.rotation_error});
      EXPECT_TRUE(branch.within_limits);
      EXPECT_GE(branch.radius, 0);
      if (held >= 0) moved += branch.joints(held) != held_value;
      if (i < 500) {
        // an estimate without a decomposition; at 0 the inverse, of which it is made, has no digits
        const double exact = smallest_singular_value(arm, branch.joints, held);
        if (exact > 1e-6) sigma = std::max(sigma, std::abs(branch.sigma_min / exact - 1));
      }
      for (const Branch<N>& other : branches) {
        if (&other == &branch) continue;
        alike += joint_difference<N>(branch.joints, other.joints) < 1e-6;
        inside += joint_distance<N>(branch.joints, other.joints) < branch.radius;
      }
    }
  }
  EXPECT_LT(position, 1e-9) << name;
  EXPECT_LT(rotation, 1e-9) << name;
  EXPECT_LT(understated, 1e-13) << name << ": errors are larger than stated";
  EXPECT_LT(sigma, 0.01) << name;
  EXPECT_LE(lost, most_lost * poses) << name;
  EXPECT_LE(not_met, 0.001 * poses) << name;
  EXPECT_EQ(alike, 0) << name;
  EXPECT_EQ(inside, 0) << name << ": branches within the radius of another";
  EXPECT_EQ(moved, 0) << name;
}

template <int N, class Convention>
auto made_from(const DhChain<N, Convention>& nominal) {
  return [nominal](Rng& rng) { return as_made(nominal, rng); };
}

TEST(AllBranches, OfArmsAsMade) {
  expect_branches<6>(ClosedForm(robots::ur10().chain), made_from(robots::ur10().chain), "ur10", 5000);
  expect_branches<6>(ClosedForm(robots::abb_irb120().chain), made_from(robots::abb_irb120().chain), "irb120", 2000);
  expect_branches<6>(ClosedForm(robots::puma560().chain), made_from(robots::puma560().chain), "puma560", 2000, 0.004);
  expect_branches<6>(ClosedForm(robots::puma560_modified().chain), made_from(robots::puma560_modified().chain),
                     "puma560_modified", 2000, 0.004);
}

TEST(AllBranches, OfSevenJointsWithOneHeld) {
  const auto wam = robots::barrett_wam().chain;
  for (const int joint : {2, 4})
    expect_branches<7>(ClosedForm(wam, HeldJoint{joint, held_value}), made_from(wam),
                       "wam, joint " + std::to_string(joint + 1), 2000);
}

TEST(AllBranches, OfArmsBetweenFramesAndWithUnevenJoints) {
  const auto ur10 = robots::ur10().chain;
  const Vector6 base{1, -2, 0.5, 0.3, -0.2, 1.1}, tool{0.02, -0.03, 0.15, 0.1, 0.4, -0.7};
  const Framed framed(ur10, FrameParameters(base), FrameParameters(tool));
  expect_branches<6>(
      ClosedForm(framed), [&](Rng& rng) { return framed.around(as_made(ur10, rng)); }, "ur10 between frames", 3000,
      0.002);
  expect_branches<6>(
      ClosedForm(ur10), [&](Rng& rng) { return UnevenJoints<6>{as_made(ur10, rng)}; }, "ur10 with uneven joints",
      12000);
}

/// How many branches are found, and how many there are with those that a search from many starts finds.
struct Completeness {
  int found = 0, all = 0;
};

/// Against a search from many starts. What is lost is about to merge with another branch.
template <int N, class Convention, class Roots>
Completeness completeness(const DhChain<N, Convention>& nominal, const Roots& roots, double errors, const char* name) {
  constexpr int poses = 200, starts = 150;
  Rng rng(2);
  const int held = roots.held_joint();
  IkOptions<N> options;
  options.position_tolerance = options.rotation_tolerance = 1e-11;
  options.max_iterations = 60;
  if (held >= 0) options.limits.lower(held) = options.limits.upper(held) = held_value;
  Completeness out;
  for (int i = 0; i < poses; ++i) {
    const auto arm = as_made(nominal, rng, errors);
    const Isometry3 target = arm.pose(random_configuration<N>(rng, held));
    std::vector<JointVector<N>> all;
    for (const Branch<N>& branch : all_branches(roots, arm, target)) all.push_back(branch.joints);
    out.found += static_cast<int>(all.size());
    for (int s = 0; s < starts; ++s) {
      const auto result = inverse_kinematics(arm, target, random_configuration<N>(rng, held), options);
      if (result.status != IkStatus::converged) continue;
      const bool known = std::any_of(all.begin(), all.end(), [&](const JointVector<N>& q) {
        return joint_difference<N>(q, result.joints) < 2e-5;
      });
      if (known) continue;
      all.push_back(result.joints);
      EXPECT_LT(smallest_singular_value(arm, result.joints, held), errors * 0.02) << name << ", pose " << i;
    }
    out.all += static_cast<int>(all.size());
  }
  EXPECT_GE(out.found, (errors > 1 ? 0.995 : 0.998) * out.all) << name;
  EXPECT_GT(out.all, 5 * poses) << name;
  return out;
}

TEST(AllBranches, NoFewerThanASearchFromManyStarts) {
  const auto wam = robots::barrett_wam().chain;
  for (const double errors : {1.0, 3.0}) {
    Completeness sum;
    for (const Completeness& of_arm :
         {completeness(robots::ur10().chain, ClosedForm(robots::ur10().chain), errors, "ur10"),
          completeness(robots::abb_irb120().chain, ClosedForm(robots::abb_irb120().chain), errors, "irb120"),
          completeness(robots::puma560().chain, ClosedForm(robots::puma560().chain), errors, "puma560"),
          completeness(wam, ClosedForm(wam, HeldJoint{2, held_value}), errors, "wam")}) {
      sum.found += of_arm.found;
      sum.all += of_arm.all;
    }
    EXPECT_GE(sum.found, (errors > 1 ? 0.995 : 0.999) * sum.all) << sum.found << " of " << sum.all;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// what is said of a branch

TEST(AllBranches, RadiusIsProvenForGeometricModels) {
  Rng rng(3);
  const auto ur10 = robots::ur10().chain;
  const ClosedForm form(ur10);
  const auto made = as_made(ur10, rng);
  const JointVector<6> q{0.3, -1.1, 0.8, 0.4, 0.9, 1};
  const auto all_proven = [&](const auto& arm) {
    const auto branches = all_branches(form, arm, arm.pose(q));
    EXPECT_EQ(branches.count, 8);
    int proven = 0;
    for (const auto& branch : branches) {
      EXPECT_GT(branch.radius, 0);
      proven += branch.proven;
    }
    return proven;
  };
  EXPECT_EQ(all_proven(made), 8);
  EXPECT_EQ(all_proven(Framed(made)), 8);
  EXPECT_EQ(all_proven(UnevenJoints<6>{made}), 0);
}

/// A chain that counts how often it is evaluated.
struct Counted {
  static constexpr int dof = 6;
  DhChain<6> chain;
  int* evaluations;
  Isometry3 pose(const JointVector<6>& q) const noexcept { return chain.pose(q); }
  Vector3 position(const JointVector<6>& q) const noexcept { return chain.position(q); }
  Jacobian<6> jacobian(const JointVector<6>& q) const noexcept { return chain.jacobian(q); }
  PoseAndJacobian<6> pose_and_jacobian(const JointVector<6>& q) const noexcept {
    ++*evaluations;
    return chain.pose_and_jacobian(q);
  }
};

// Away from singularities every evaluation is one of a branch that was found: two or three each.
TEST(AllBranches, IterationsAreEvaluations) {
  Rng rng(12);
  const auto ur10 = robots::ur10().chain;
  const ClosedForm form(ur10);
  int evaluations = 0, sum = 0;
  const Counted arm{as_made(ur10, rng), &evaluations};
  const auto branches = all_branches(form, arm, arm.pose({0.3, -1.1, 0.8, 0.4, 0.9, 1}));
  ASSERT_EQ(branches.count, 8);
  for (const auto& branch : branches) {
    EXPECT_GE(branch.iterations, 2);
    EXPECT_LE(branch.iterations, 3);
    sum += branch.iterations;
  }
  EXPECT_EQ(sum, evaluations);
}

TEST(AllBranches, NewtonsMethodConvergesToABranchFromWithinItsRadius) {
  Rng rng(4);
  const auto expect_converges = [&](const auto& nominal, const char* name) {
    const ClosedForm form(nominal);
    for (int i = 0; i < 20; ++i) {
      const auto arm = as_made(nominal, rng);
      const Isometry3 target = arm.pose(random_joints<6>(rng));
      for (const auto& branch : all_branches(form, arm, target)) {
        for (int k = 0; k < 20; ++k) {
          Vector6 direction;
          for (int j = 0; j < 6; ++j) direction(j) = rng.normal();
          const double size = 0.999 * branch.radius / direction.norm();
          JointVector<6> q;
          for (int j = 0; j < 6; ++j) q(j) = branch.joints(j) + size * direction(j);
          for (int iteration = 0; iteration < 8; ++iteration) {
            Vector6 error = pose_difference(target, arm.pose(q));
            for (int j = 3; j < 6; ++j) error(j) *= rotation_length;
            const RealMatrix step = weighted_jacobian(arm, q, -1).solve(error);
            for (int j = 0; j < 6; ++j) q(j) += step(j);
          }
          // at a fold, half of the digits
          EXPECT_LT((RealMatrix(q) - branch.joints).norm(), std::max(1e-9, std::min(1e-12 / branch.sigma_min, 1e-4)))
              << name;
        }
      }
    }
  };
  expect_converges(robots::ur10().chain, "ur10");
  expect_converges(robots::abb_irb120().chain, "irb120");
}

TEST(AllBranches, SingularitiesAreThoseOfTheNominalArm) {
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  const auto branches = all_branches(form, irb, irb.pose({0.3, 0.4, -0.5, 0.6, 0.9, 0.8}));
  std::set<int> names;
  for (const auto& branch : branches) {
    EXPECT_EQ(branch.singularities.values(), form.distances(branch.joints).values());
    names.insert(branch.singularities.branch());
  }
  EXPECT_EQ(branches.count, 8);
  EXPECT_EQ(names.size(), 8u);
}

// ---------------------------------------------------------------------------------------------------------------------
// whole turns and limits

TEST(NearestTurn, StaysWithinLimits) {
  using detail::nearest_turn;
  const double inf = std::numeric_limits<double>::infinity(), turn = 2 * pi;
  EXPECT_EQ(nearest_turn(0.5, 0, -inf, inf), 0.5);
  EXPECT_NEAR(nearest_turn(0.5, 7, -inf, inf), 0.5 + turn, 1e-15);
  EXPECT_NEAR(nearest_turn(0.5, -20, -inf, inf), 0.5 - 3 * turn, 1e-14);
  EXPECT_NEAR(nearest_turn(0.5, 20, -turn, turn), 0.5, 1e-15);  // 0.5 + turn is beyond
  EXPECT_NEAR(nearest_turn(-0.5, 20, -turn, turn), turn - 0.5, 1e-15);
  EXPECT_NEAR(nearest_turn(3, 0, -4, 0), 3 - turn, 1e-15);   // the only one
  EXPECT_NEAR(nearest_turn(3, 0, 3, 3), 3, 1e-15);           // bounds included
  EXPECT_NEAR(nearest_turn(3, 0, 9, 9.2), 3 + turn, 1e-15);  // none: the nearest to the bounds
  EXPECT_NEAR(nearest_turn(3, -100, 2, 2.5), 3, 1e-15);
  // a nanoradian beyond a bound counts as within, no more than that
  EXPECT_NEAR(nearest_turn(1 + 0.8e-9, 1, -7, 1), 1, 1e-8);
  EXPECT_NEAR(nearest_turn(1 + 1.2e-9, 1, -7, 1), 1 - turn, 1e-8);
  EXPECT_NEAR(nearest_turn(-1 - 0.8e-9, -1, -1, 7), -1, 1e-8);
  EXPECT_NEAR(nearest_turn(-1 - 1.2e-9, -1, -1, 7), turn - 1, 1e-8);
  const JointVector<6> joints = JointVector<6>::Constant(0.5), near = JointVector<6>::Constant(7);
  const JointVector<6> turned = JointVector<6>::Constant(0.5 + turn);
  EXPECT_LT((RealMatrix(nearest_turns<6>(joints, near, {})) - turned).norm(), 1e-14);
}

TEST(AllBranches, TakeTheTurnNearestToTheGivenJoints) {
  Rng rng(5);
  const auto robot = robots::ur10();
  const ClosedForm form(robot.chain);
  for (int i = 0; i < 200; ++i) {
    const auto arm = as_made(robot.chain, rng);
    const JointVector<6> q = random_joints<6>(rng);
    BranchOptions<6> options;
    options.limits = robot.limits;
    options.close_to = random_joints<6>(rng, 2 * pi);
    const auto branches = all_branches(form, arm, arm.pose(q), options);
    EXPECT_EQ(branches.reach, Reach::met);
    for (const auto& branch : branches) {
      EXPECT_TRUE(branch.within_limits);
      EXPECT_TRUE(options.limits.contains(branch.joints));
      for (int j = 0; j < 6; ++j)
        for (const double other : {branch.joints(j) - 2 * pi, branch.joints(j) + 2 * pi})
          if (std::abs(other) < 2 * pi - 1e-3) {
            EXPECT_LE(std::abs(branch.joints(j) - options.close_to(j)), std::abs(other - options.close_to(j)) + 1e-2);
          }
    }
    // no turn: the joints themselves
    const auto same = all_branches(form, arm, arm.pose(q), {.limits = robot.limits, .close_to = q});
    const auto* nearest = same.nearest(q);
    ASSERT_NE(nearest, nullptr);
    EXPECT_LT(vernier_test::difference(nearest->joints, q), 1e-5);
  }
}

TEST(AllBranches, SayWhichAreWithinLimits) {
  Rng rng(6);
  const auto robot = robots::abb_irb120();
  const ClosedForm form(robot.chain);
  int within = 0, beyond = 0;
  for (int i = 0; i < 200; ++i) {
    const auto arm = as_made(robot.chain, rng);
    const auto branches =
        all_branches(form, arm, arm.pose(random_joints<6>(rng, robot.limits)), {.limits = robot.limits});
    EXPECT_EQ(branches.reach, Reach::met);
    for (const auto& branch : branches) {
      EXPECT_EQ(branch.within_limits, robot.limits.contains(branch.joints));
      ++(branch.within_limits ? within : beyond);
      if (branch.within_limits) continue;
      // no turn would bring it within
      bool possible = true;
      for (int j = 0; j < 6; ++j) {
        bool any = false;
        for (int k = -3; k <= 3; ++k) {
          const double value = branch.joints(j) + 2 * pi * k;
          any = any || (value > robot.limits.lower(j) + 1e-6 && value < robot.limits.upper(j) - 1e-6);
        }
        possible = possible && any;
      }
      EXPECT_FALSE(possible);
    }
    // the nearest is within limits
    const auto* nearest = branches.nearest(JointVector<6>::Zero());
    ASSERT_NE(nearest, nullptr);
    EXPECT_TRUE(nearest->within_limits);
  }
  EXPECT_GT(within, 200);
  EXPECT_GT(beyond, 200);
}

TEST(AllBranches, KeepTheHeldJointWhateverNearAndLimits) {
  Rng rng(7);
  const auto wam = robots::barrett_wam().chain;
  const ClosedForm form(wam, HeldJoint{2, held_value});
  BranchOptions<7> options;
  options.close_to = JointVector<7>::Constant(6);
  options.limits.lower(2) = 5;
  const auto arm = as_made(wam, rng);
  const auto branches = all_branches(form, arm, arm.pose({0.4, 0.7, held_value, 1.2, 0.3, -0.6, 0.2}), options);
  EXPECT_GT(branches.count, 0);
  EXPECT_EQ(branches.reach, Reach::beyond_limits);
  EXPECT_NE(branches.describe().find(message("limits exclude all ", branches.count)), std::string::npos);
  for (const auto& branch : branches) {
    EXPECT_EQ(branch.joints(2), held_value);
    EXPECT_FALSE(branch.within_limits);
  }
  EXPECT_EQ(branches.nearest(JointVector<7>::Zero()), nullptr);
}

// ---------------------------------------------------------------------------------------------------------------------
// singular targets, determinism

TEST(AllBranches, MeetTargetsNextToSingularities) {
  Rng rng(9);
  const auto expect_met = [&](const auto& nominal, int joint, double at, const std::string& name) {
    const ClosedForm form(nominal);
    int lost = 0, targets = 0;
    for (const double offset : {0.0, 1e-9, 1e-6, 1e-4, 1e-3}) {
      for (int i = 0; i < 20; ++i) {
        const auto arm = as_made(nominal, rng);
        JointVector<6> q = random_joints<6>(rng);
        q(joint) = at + offset;
        const auto branches = all_branches(form, arm, arm.pose(q), {.close_to = q});
        ++targets;
        lost += branches.count == 0;
        for (const auto& branch : branches)
          EXPECT_LT(pose_difference(arm.pose(q), arm.pose(branch.joints)).norm(), 1e-9) << name;
      }
    }
    EXPECT_LE(lost, targets / 20) << name;
  };
  expect_met(robots::ur10().chain, 4, 0, "ur10, wrist");
  expect_met(robots::abb_irb120().chain, 4, 0, "irb120, wrist");
  expect_met(robots::ur10().chain, 2, 0, "ur10, elbow");
  expect_met(robots::abb_irb120().chain, 2, -std::atan2(0.302, 0.07), "irb120, elbow");
}

// Next to the stretched elbow of an arm whose third joint is off by as little, Newton's method comes from seeds on both
// sides of the fold, with steps too long and too short. The branches are known: the nominal roots, less what joint 3 is
// off.
TEST(AllBranches, AreFoundAcrossAFoldFromEverySide) {
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  JointVector<6> q{0.3, 0.4, -std::atan2(0.302, 0.07), 0.6, 0.9, 0.8};
  constexpr double bent = 3e-4;  // rad, of the elbow
  q(2) += bent;
  const Isometry3 target = irb.pose(q);
  auto rows = irb.rows();
  for (int k = -40; k <= 40; ++k) {
    const double off = 0.1 * k * bent;
    rows[2].theta = irb.row(2).theta + off;
    const auto arm = DhChain<6>::from_rows(rows);
    const auto branches = all_branches(form, arm, target);
    EXPECT_EQ(branches.count, 8) << off;
    for (const auto& branch : branches) {
      const Vector6 left = pose_difference(target, arm.pose(branch.joints));
      EXPECT_LT(left.norm(), 1e-10) << off;
      EXPECT_GE(branch.position_error, 0) << off;
      EXPECT_GE(branch.rotation_error, 0) << off;
      EXPECT_LT(Vector3(left(0), left(1), left(2)).norm(), branch.position_error + 1e-14) << off;
      EXPECT_LT(Vector3(left(3), left(4), left(5)).norm(), branch.rotation_error + 1e-14) << off;
    }
    for (const auto& root : form.roots(target)) {
      JointVector<6> expected = root.joints;
      expected(2) -= off;
      EXPECT_TRUE(contains<6>(branches, expected, 1e-6)) << off;
    }
  }
}

template <int N>
bool same_bits(const Branches<N>& a, const Branches<N>& b) {
  bool same = a.count == b.count && a.reach == b.reach && a.seeds_lost == b.seeds_lost && a.margin == b.margin;
  for (int k = 0; same && k < a.count; ++k) {
    const Branch<N>&x = a.branches[static_cast<std::size_t>(k)], &y = b.branches[static_cast<std::size_t>(k)];
    const auto numbers = [](const Branch<N>& of) {
      return vernier_test::vector({of.position_error, of.rotation_error, of.sigma_min, of.radius});
    };
    same = testing::same_bits(x.joints, y.joints) && testing::same_bits(numbers(x), numbers(y)) &&
           x.singularities.values() == y.singularities.values() && x.proven == y.proven &&
           x.iterations == y.iterations && x.within_limits == y.within_limits;
  }
  return same;
}

TEST(AllBranches, SameBitsOnTwoCallsAndNoAllocation) {
  Rng rng(10);
  const auto expect_pure = [&]<int N>(const auto& form, const auto& arm, const JointVector<N>& q) {
    const Isometry3 target = arm.pose(q);
    Isometry3 away = target;
    away(0, 3) += 10;
    for (const Isometry3& at : {target, away}) {
      EXPECT_TRUE(same_bits<N>(all_branches(form, arm, at), all_branches(form, arm, at)));
      EXPECT_EQ(vernier_test::allocations([&] { vernier_test::keep(all_branches(form, arm, at)); }), 0);
      EXPECT_EQ(vernier_test::allocations([&] { vernier_test::keep(form.roots(at)); }), 0);
    }
  };
  const auto irb = robots::abb_irb120().chain, ur10 = robots::ur10().chain;
  const auto wam = robots::barrett_wam().chain;
  for (int i = 0; i < 50; ++i) {
    // every second one is next to a fold, where more is tried
    JointVector<6> q = random_joints<6>(rng);
    if (i % 2 == 1) q(2) = 1e-4;
    if (i % 4 == 1) q(4) = 1e-4;
    expect_pure(ClosedForm(ur10), as_made(ur10, rng), q);
    expect_pure(ClosedForm(irb), as_made(irb, rng), q);
    expect_pure(ClosedForm(ur10), UnevenJoints<6>{as_made(ur10, rng)}, q);
    expect_pure(ClosedForm(wam, HeldJoint{2, held_value}), as_made(wam, rng), random_configuration<7>(rng, 2));
  }
}

}  // namespace
}  // namespace vernier::all_branches_test
