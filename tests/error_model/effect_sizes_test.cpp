// SPDX-License-Identifier: BSD-3-Clause
// Sizes of effects that a fit states: their intervals hold what geometry leaves of the effects of simulated arms.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::effect_sizes_test {
namespace {

using Chain = DhChain<6>;

struct SimulatedArm {
  FittedErrorModel<Chain> found;
  double size = 0;  // what geometry and frames leave of the joint errors [m]
};

/// An arm with errors of links and of joints, fitted to some poses.
/// @param options an effect as large as that of the arm matters, whatever they say
SimulatedArm fitted(const Robot<6>& robot, const JointErrorSizes& sizes, ErrorModelOptions options, std::uint64_t seed,
                    Index poses = 60) {
  const JointLimits<6> limits{robot.limits.lower.cwiseMax(-3), robot.limits.upper.cwiseMin(3)};
  const WithJointErrors<Chain> actual(with_geometric_errors(robot.chain, {}, seed),
                                      draw_joint_errors(robot.chain, sizes, seed + 1));
  const auto joints = sample_joints(limits, poses, seed + 2);
  const Measurements<6> exact(measure(actual, joints)),
      measured(measure(actual, joints, {.position = 0.03e-3, .orientation = 0.05e-3}, seed + 3));
  const auto geometry = [&](const Measurements<6>& of) { return identify(robot.chain, of, {}, {}, own_solver); };
  const double size = geometry(exact).rms_after;
  options.relevant_size = size;
  return {fit_error_model(geometry(measured), measured, options), size};
}

const BlockChoice* choice_of(const FittedErrorModel<Chain>& found, Block block) {
  const auto at = std::find_if(found.blocks.begin(), found.blocks.end(),
                               [&](const BlockChoice& one) { return one.block == block; });
  return at == found.blocks.end() ? nullptr : &*at;
}

const ErrorModelOptions compliance_alone{
    .gear_ratio = false, .coupling = false, .harmonics = 0, .hysteresis = false, .tilt = false, .drift = false};

const JointErrorSizes no_errors{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0};

// Of 20 intervals of 95 %, 16 or more hold the size with a probability of 99.7 %.
TEST(EffectSizes, IntervalsOfADeflectionHoldIt) {
  JointErrorSizes sizes = no_errors;
  sizes.compliance = 0.1e-3;
  int held = 0;
  for (std::uint64_t arm = 0; arm < 20; ++arm) {
    const SimulatedArm one = fitted(robots::ur10(), sizes, compliance_alone, 10 * arm);
    const BlockChoice* elastic = choice_of(one.found, Block::elastic);
    ASSERT_NE(elastic, nullptr);
    EXPECT_EQ(elastic->existence.answer, Answer::found);
    EXPECT_LT(elastic->existence.interval[1] - elastic->existence.interval[0], 0.3 * one.size);
    held += elastic->existence.interval[0] <= one.size && one.size <= elastic->existence.interval[1];
  }
  EXPECT_GE(held, 16);
}

// An effect that has no look-alike among the options is none, however weak its evidence: on some of these arms the test
// finds it, and a comparison with nothing does not.
TEST(EffectSizes, OneKindAloneHasNoLookAlike) {
  JointErrorSizes sizes = no_errors;
  sizes.compliance = 2e-6;
  int found = 0;
  for (std::uint64_t arm = 30; arm < 40; ++arm) {
    const SimulatedArm one = fitted(robots::ur10(), sizes, compliance_alone, 10 * arm);
    const BlockChoice* elastic = choice_of(one.found, Block::elastic);
    ASSERT_NE(elastic, nullptr);
    EXPECT_FALSE(elastic->existence.look_alike) << "arm " << arm;
    found += elastic->existence.answer == Answer::found;
  }
  EXPECT_GE(found, 1);
}

// A number of poses that would decide finds an effect of that size with 80 %: on 17 to 29 of 30 arms in 99.6 % of
// cases.
TEST(EffectSizes, AreFoundWithTheStatedNumberOfPoses) {
  JointErrorSizes sizes = no_errors;
  sizes.compliance = 4e-6;
  int arms = 0, found = 0;
  for (std::uint64_t seed = 0; arms < 30; seed += 10) {
    ASSERT_LT(seed, 1000U);
    const SimulatedArm now = fitted(robots::ur10(), sizes, compliance_alone, seed);
    const BlockChoice* before = choice_of(now.found, Block::elastic);
    ASSERT_NE(before, nullptr);
    const Index poses = before->existence.poses;
    if (before->existence.answer == Answer::found) continue;
    ++arms;
    EXPECT_LT(poses, 1000) << "seed " << seed;  // what is suppressed as no evidence speaks for it would need as many
    const SimulatedArm then = fitted(robots::ur10(), sizes, compliance_alone, seed, poses);
    const BlockChoice* decided = choice_of(then.found, Block::elastic);
    ASSERT_NE(decided, nullptr);
    found += decided->existence.answer == Answer::found;
  }
  EXPECT_GE(found, 17);
  EXPECT_LE(found, 29);
}

// Deflection is tested first, and takes a part of what gears do. Where it is gone in the end, gears have all of it.
TEST(EffectSizes, OfGearsHaveWhatADeflectionStoodInFor) {
  JointErrorSizes sizes = no_errors;
  sizes.gear_ratio = 1e-4;
  int stood_in = 0;
  for (std::uint64_t arm = 0; arm < 4; ++arm) {
    const SimulatedArm one = fitted(robots::abb_irb120(), sizes, {.drift = false}, 10 * arm);
    const BlockChoice *elastic = choice_of(one.found, Block::elastic),
                      *again = choice_of(one.found, Block::elastic_again), *gears = choice_of(one.found, Block::gears);
    ASSERT_TRUE(elastic != nullptr && gears != nullptr);
    if (!elastic->used || again == nullptr || again->used || !gears->used) continue;
    ++stood_in;
    EXPECT_NEAR(gears->existence.size, one.size, 0.15 * one.size) << "arm " << arm;
  }
  EXPECT_GE(stood_in, 2);
}

// Priors pull low orders of harmonics towards zero, and that leaves what looks like gears: it did so on four of these
// arms, where p was below 0.05.
TEST(EffectSizes, OfHarmonicsAreNoneOfGears) {
  JointErrorSizes sizes = no_errors;
  sizes.harmonic = 0.02e-3;
  int doubtful = 0;
  for (std::uint64_t arm = 6; arm < 12; ++arm) {
    const SimulatedArm one = fitted(robots::ur10(), sizes, {.drift = false}, 10 * arm, 120);
    const BlockChoice *harmonics = choice_of(one.found, Block::jointwise), *gears = choice_of(one.found, Block::gears);
    ASSERT_TRUE(harmonics != nullptr && gears != nullptr);
    EXPECT_TRUE(harmonics->used) << "arm " << arm;
    EXPECT_FALSE(gears->used) << "arm " << arm;
    doubtful += gears->existence.p < 0.05;
  }
  EXPECT_LE(doubtful, 1);
}

/// How often a kind of joint errors is claimed, and how often it is left open which of them an arm has.
struct Claims {
  int own = 0, other = 0, open = 0;
};

Claims claims_of(const JointErrorSizes& sizes, Block own) {
  Claims out;
  for (std::uint64_t arm = 0; arm < 12; ++arm) {
    const SimulatedArm one = fitted(robots::ur10(), sizes, {.drift = false}, 120000360 + 10 * arm, 120);
    bool is_own = false, other = false, open = false;
    const bool again = choice_of(one.found, Block::elastic_again) != nullptr;
    for (const BlockChoice& choice : one.found.blocks) {
      if (again && choice.block == Block::elastic) continue;
      const Block block = choice.block == Block::elastic_again ? Block::elastic : choice.block;
      if (block != Block::elastic && block != Block::jointwise && block != Block::gears) continue;
      const bool claimed = choice.existence.answer == Answer::found;
      is_own = is_own || (claimed && block == own);
      other = other || (claimed && block != own);
      open = open || choice.existence.look_alike;
      if (choice.existence.look_alike) {
        EXPECT_EQ(choice.existence.answer, Answer::undecided);
        EXPECT_EQ(choice.existence.interval[0], 0);
      }
    }
    out.own += is_own;
    out.other += other;
    out.open += open;
  }
  return out;
}

// Harmonics of which the poses do not show all look like gears or deflection. Without a comparison three of these arms
// have claims of them.
TEST(EffectSizes, LookAlikesOfHarmonicsAreNotClaimed) {
  JointErrorSizes sizes = no_errors;
  sizes.harmonic = 0.02e-3;
  const Claims claims = claims_of(sizes, Block::jointwise);
  EXPECT_GE(claims.own, 8);
  EXPECT_LE(claims.other, 1);
  EXPECT_GE(claims.open, 2);
}

TEST(EffectSizes, ADeflectionIsToldFromGearsAndHarmonics) {
  JointErrorSizes sizes = no_errors;
  sizes.compliance = 0.02e-3;
  const Claims claims = claims_of(sizes, Block::elastic);
  EXPECT_GE(claims.own, 10);
  EXPECT_LE(claims.other, 2);
}

}  // namespace
}  // namespace vernier::effect_sizes_test
