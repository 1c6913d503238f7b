// SPDX-License-Identifier: BSD-3-Clause
// Closed-form inverse kinematics at and next to singular poses: roots are exact, and joints that are free are marked.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "closed_form_arms.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace vernier::closed_form_singular_test {
namespace {

using namespace vernier_test::closed_forms;
using vernier_test::difference;
using vernier_test::random_joints;
using vernier_test::RealMatrix;

enum Factor { shoulder, elbow, wrist };

/// Turns one joint until a factor of the determinant is zero. @return whether there is such a value
template <int N>
bool make_singular(const ClosedForm<N>& form, Factor factor, JointVector<N>& q) {
  constexpr int steps = 90;
  for (int joint = N - 1; joint >= 0; --joint) {
    if (joint == form.held_joint()) continue;
    const auto value = [&](double x) {
      JointVector<N> at = q;
      at(joint) = x;
      return form.distances(at).values()[static_cast<std::size_t>(factor)];
    };
    for (int k = 0; k < steps; ++k) {
      double low = q(joint) + 2 * pi * k / steps, high = q(joint) + 2 * pi * (k + 1) / steps;
      const double start = value(low);
      if (std::abs(start - value(high)) < 1e-9 || start * value(high) > 0) continue;
      for (int i = 0; i < 80; ++i) {
        const double middle = 0.5 * (low + high);
        (start * value(middle) > 0 ? low : high) = middle;
      }
      q(joint) = vernier_test::without_turns(low);
      return true;
    }
  }
  return false;
}

/// Roots at singular joint values that are also `near`: exact, and the generating ones among them. Where two roots
/// meet, joints keep half of their digits.
template <int N, class Convention>
void expect_roots_at(const DhChain<N, Convention>& arm, const ClosedForm<N>& form, const JointVector<N>& q,
                     const std::string& name, double generating) {
  const Isometry3 target = arm.pose(q);
  const auto roots = form.roots(target, q);
  const Quality at = quality(arm, roots, target, q);
  EXPECT_GE(at.roots, 1) << name;
  EXPECT_LT(at.residual, exact) << name << " at " << ::testing::PrintToString(RealMatrix::of(q));
  EXPECT_LT(at.generating, generating) << name << " at " << ::testing::PrintToString(RealMatrix::of(q));
}

constexpr double offsets[] = {0, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4, 1e-3};

TEST(SingularPoses, StraightWrists) {
  Rng rng(9);
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (int i = 0; i < 20; ++i) {
      JointVector<6> q = random_joints<6>(rng);
      ASSERT_TRUE(make_singular(form, wrist, q)) << name;
      for (const double offset : offsets)
        for (const double side : {-1.0, 1.0}) {
          JointVector<6> off = q;
          off(form.mirrored() ? 1 : 4) += side * offset;
          // joints 4 and 6 are known to the rounding errors of a pose over the offset
          expect_roots_at(chain, form, off, name + ", wrist off by " + std::to_string(side * offset * 1e9) + " nrad",
                          offset > 1e-11 ? std::max(1e-6, 1e-12 / offset) : 1e-6);
        }
    }
  });
}

/// Stretched elbows, or wrist centres on shoulder surfaces, and poses next to them.
/// @param joint whose value is off
void expect_roots_next_to(Factor factor, int joint, std::uint64_t seed) {
  Rng rng(seed);
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (int i = 0; i < 20; ++i) {
      JointVector<6> q = random_joints<6>(rng);
      if (!make_singular(form, factor, q) || std::abs(form.distances(q).wrist) < 0.01) continue;
      for (const double offset : offsets) {
        JointVector<6> off = q;
        off(form.mirrored() ? 5 - joint : joint) += offset;
        expect_roots_at(chain, form, off, message(name, ", factor ", static_cast<int>(factor)), 1e-3);
      }
    }
  });
}

TEST(SingularPoses, StretchedElbows) { expect_roots_next_to(elbow, 2, 10); }

TEST(SingularPoses, WristCentresOnShoulderSurfaces) { expect_roots_next_to(shoulder, 1, 11); }

TEST(SingularPoses, Crossings) {
  Rng rng(12);
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (int i = 0; i < 20; ++i) {
      JointVector<6> q = random_joints<6>(rng);
      // the wrist's distance depends on no other joint, that of the shoulder on those of the elbow
      ASSERT_TRUE(make_singular(form, wrist, q));
      if (i % 2 == 0 && !make_singular(form, elbow, q)) continue;
      if (i % 4 != 0 && !make_singular(form, shoulder, q)) continue;
      // elbow and shoulder keep half of their digits, so joint 4 is any value or noise: all are exact
      expect_roots_at(chain, form, q, name + ", crossing " + std::to_string(i % 4), 10);
    }
  });
}

TEST(SingularPoses, CommonAngles) {
  const double common[] = {0, pi / 2, -pi / 2, pi};
  const auto expect_met = [&](const auto& chain, const char* name) {
    const ClosedForm form(chain);
    int none = 0;
    double residual = 0;
    for (int code = 0; code < 4096; ++code) {
      JointVector<6> q;
      for (int j = 0; j < 6; ++j) q(j) = common[code >> (2 * j) & 3];
      // near matters: with the wrist of a UR arm straight, q2 + q3 + q4 is arbitrary, but not every value is in reach
      const Quality at = quality(chain, form.roots(chain.pose(q), q), chain.pose(q), q);
      none += at.roots == 0;
      residual = std::max(residual, at.residual);
    }
    EXPECT_EQ(none, 0) << name;
    EXPECT_LT(residual, exact) << name;
  };
  expect_met(robots::ur10().chain, "ur10");
  expect_met(robots::ur5().chain, "ur5");
  expect_met(robots::abb_irb120().chain, "irb120");
  expect_met(robots::puma560().chain, "puma560");
  expect_met(robots::puma560_modified().chain, "puma560_modified");
  for (const Case& arm : cases()) expect_met(arm.chain, arm.name.c_str());
}

TEST(SingularPoses, StretchedIsNotOutOfReach) {
  // margins are 0 or say that the target is out of reach: rounding errors do not
  const auto ur10 = robots::ur10().chain;
  const ClosedForm form(ur10);
  Rng rng(14);
  int outside = 0;
  for (int i = 0; i < 1000; ++i) {
    JointVector<6> q = random_joints<6>(rng);
    q(2) = 0;
    for (const auto& root : form.roots(ur10.pose(q))) outside += root.margin > 0 && root.margin < rounding;
  }
  EXPECT_EQ(outside, 0);
}

TEST(SingularPoses, WristCentresOnAxisOne) {
  // where axes 2 and 3 meet, joint 1 is arbitrary there
  const auto found = std::find_if(cases().begin(), cases().end(),
                                  [](const Case& arm) { return arm.kind == ArmKind::second_meets_third; });
  const DhChain<6>& chain = found->chain;
  const ClosedForm form(chain);
  Rng rng(16);
  const auto off_axis = [&](const JointVector<6>& q) {
    const auto origins = chain.links(q).origin;
    return vernier_test::vector({origins(0, 3), origins(1, 3)});
  };
  int targets = 0;
  for (int i = 0; i < 50; ++i) {
    JointVector<6> q = random_joints<6>(rng);
    for (int k = 0; k < 60; ++k) {  // Newton's method on joints 2 and 3
      RealMatrix derivative(2, 2);
      for (int j = 0; j < 2; ++j) {
        JointVector<6> ahead = q;
        ahead(1 + j) += 1e-6;
        derivative.set_block(0, j, (off_axis(ahead) - off_axis(q)) / 1e-6);
      }
      const RealMatrix step = derivative.solve(off_axis(q));
      for (int j = 0; j < 2; ++j) q(1 + j) -= step(j) * std::min(1.0, 0.3 / step.norm());
    }
    if (!(off_axis(q).norm() < 1e-15)) continue;
    ++targets;
    expect_roots_at(chain, form, q, found->name, 1e-6);
    for (const auto& root : form.roots(chain.pose(q), q)) EXPECT_EQ(root.free & 1u, 1u);
  }
  EXPECT_GT(targets, 20);
}

/// A joint that is free at some joint values has the value that is near.
/// @return of how many roots it is free
template <class Arm>
int count_free(const Arm& arm, const JointVector<6>& q, int joint, double value) {
  JointVector<6> near = JointVector<6>::Zero();
  near(joint) = value;
  int count = 0;
  for (const auto& root : ClosedForm(arm).roots(arm.pose(q), near)) {
    EXPECT_LT(difference(arm.pose(root.joints), arm.pose(q)), exact);
    if (root.free == 0) continue;
    ++count;
    EXPECT_EQ(root.free, 1u << joint);
    EXPECT_EQ(root.joints(joint), value);
  }
  return count;
}

TEST(SingularPoses, NearDecidesTheJointThatIsFree) {
  const auto irb = robots::abb_irb120().chain;
  const auto mirror = mirror_image(irb);
  JointVector<6> on_axis_1{0.3, 0.4, -0.5, 0.6, 0.9, 0.8};
  ASSERT_TRUE(make_singular(ClosedForm(irb), shoulder, on_axis_1));
  for (const double value : {-2.0, 0.0, 1.25}) {
    // straight wrist: joints 4 and 6 turn about one axis, joints 3 and 1 where the arm is held by its tool
    EXPECT_EQ(count_free(irb, {0.3, 0.4, -0.5, 0.6, 0, 0.8}, 3, value), 1);
    EXPECT_EQ(count_free(mirror, {-0.8, 0, -0.6, 0.5, -0.4, -0.3}, 2, value), 1);
    EXPECT_EQ(count_free(irb, on_axis_1, 0, value), ClosedForm(irb).roots(irb.pose(on_axis_1)).count);
  }
}

// With the wrist of a UR arm straight, the sum of joints 2 to 4 is arbitrary, but near the end of the reach few values
// bring the arm there: not the one that is near, but one is found.
TEST(SingularPoses, AStraightWristTakesASumThatTheArmReaches) {
  const auto ur10 = robots::ur10().chain;
  const ClosedForm form(ur10);
  int away = 0;
  for (const auto& [bent, turned] : {std::pair{0.3, 0.5},
                                     {0.6, 0.5},
                                     {0.1, 0.0},
                                     {0.1, 0.8},
                                     {0.1, 1.6},
                                     {0.1, 2.4},
                                     {0.1, 3.2},
                                     {0.1, 4.0},
                                     {0.1, 4.8},
                                     {0.1, 5.6}}) {
    const JointVector<6> q{0.4, -0.8, bent, turned, 0, 0.7};
    const Isometry3 target = ur10.pose(q);
    for (int k = 0; k < 16; ++k) {
      JointVector<6> near = q;
      near(3) += k * pi / 8 + 0.03;
      int straight = 0;
      for (const auto& root : form.roots(target, near)) {
        if (root.margin > 0 || std::abs(std::sin(root.joints(4))) > 1e-6) continue;
        ++straight;
        EXPECT_LT(difference(ur10.pose(root.joints), target), exact);
        const double sum = root.joints(1) + root.joints(2) + root.joints(3);
        away += std::abs(vernier_test::without_turns(sum - near(1) - near(2) - near(3))) > 0.1;
      }
      EXPECT_GT(straight, 0) << bent << ' ' << turned << ' ' << k;
    }
  }
  EXPECT_GT(away, 5);
}

// Axes 1 and 2 parallel, and forearm and upper arm of the same length: folded, the wrist centre is on axis 2, and
// joint 2 is any value; here that of `near`.
TEST(SingularPoses, NearDecidesTheSecondJointOfAFoldedArm) {
  const DhChain<6> arm{{{{.a = 400_mm, .alpha = 0_deg, .d = 200_mm},
                         {.a = 300_mm, .alpha = 90_deg, .d = 50_mm},
                         {.a = 300_mm, .alpha = -90_deg, .d = 0_mm},
                         {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
                         wrist_5,
                         wrist_6}}};
  ASSERT_EQ(internals(arm).kind(), ArmKind::first_parallel_to_second);
  const JointVector<6> q{0.3, 0.4, pi, 0.5, 0.6, 0.7};
  const Isometry3 target = arm.pose(q);
  JointVector<6> near = JointVector<6>::Constant(9);
  for (const double value : {-2.0, 0.25, 1.25}) {
    near(1) = value;
    int folded = 0;
    for (const auto& root : ClosedForm(arm).roots(target, near)) {
      EXPECT_LT(difference(arm.pose(root.joints), target), exact);
      if ((root.free & 2u) == 0) continue;
      ++folded;
      EXPECT_EQ(root.joints(1), value);
      EXPECT_NEAR(vernier_test::without_turns(root.joints(0) - q(0)), 0, 1e-9);  // the wrist is where axis 2 is
    }
    EXPECT_EQ(folded, 2);  // two wrists
  }
}

TEST(SingularPoses, SamplesOnRequest) {
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  const JointVector<6> q{0.3, 0.4, -0.5, 0.6, 0.003, 0.8};
  const auto plain = form.roots(irb.pose(q)), sampled = form.roots(irb.pose(q), q, 0.01);
  EXPECT_GT(sampled.count, plain.count);
  EXPECT_LE(sampled.count, detail::SixAxisRoots::capacity);
  for (const auto& root : sampled) {
    // a sample has joint 4 at some value and misses by no more than the width
    EXPECT_LT(difference(irb.pose(root.joints), irb.pose(q)), root.margin > 0 ? 0.01 : exact);
  }
  const JointVector<6> regular{0.3, 0.4, -0.5, 0.6, 0.5, 0.8};
  EXPECT_EQ(form.roots(irb.pose(regular)).count, form.roots(irb.pose(regular), q, 0.01).count);
}

// Sampled roots are marked as such; without them the roots are those of a call that asks for no samples.
TEST(SingularPoses, SamplesAreMarked) {
  Rng rng(22);
  int samples = 0;
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (const Factor factor : {shoulder, elbow, wrist}) {
      JointVector<6> q = random_joints<6>(rng);
      if (!make_singular(form, factor, q)) continue;
      for (double& value : q) value += 1e-4;
      const auto plain = form.roots(chain.pose(q), q), sampled = form.roots(chain.pose(q), q, 0.01);
      int met = 0, met_of_plain = 0, unmarked = 0;
      for (const auto& root : plain) met_of_plain += root.margin == 0;
      for (const auto& root : sampled) {
        met += root.margin == 0 && !root.sampled;
        samples += root.sampled;
        unmarked += !root.sampled;
      }
      // behind three parallel axes those of a straight wrist are always to be tried
      if (factor != wrist || internals(chain).kind() != ArmKind::three_parallel) {
        EXPECT_LE(unmarked, 8) << name << ' ' << factor;
      }
      EXPECT_EQ(met, met_of_plain) << name << ' ' << factor;
    }
  });
  EXPECT_GT(samples, 100);
}

}  // namespace
}  // namespace vernier::closed_form_singular_test
