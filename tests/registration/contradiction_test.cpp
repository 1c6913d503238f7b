// SPDX-License-Identifier: BSD-3-Clause
// Re-registration where positions, orientations and the model contradict each other: a remounted probe, a model with
// errors of its own, poses that cannot tell base from tool.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "real_matrix.hpp"
#include "registrations.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/registration/reregister.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::contradiction_test {
namespace {

using vernier_test::another_tool;
using vernier_test::difference;
using vernier_test::frame;
using vernier_test::mentions;
using vernier_test::RealMatrix;
using Chain = DhChain<6>;
using Model = ErrorModel<Chain>;
using Joints = JointVector<6>;

const Robot<6> robot = robots::ur10();
const MeasurementNoise noise{.position = 0.02e-3, .orientation = 0.05e-3};
const SensorModel sensors{.position_sigma = 0.02e-3, .orientation_sigma = 0.05e-3};

Isometry3 turned(const Vector3& by) { return rigid_motion(exp_so3(by), Vector3::Zero()); }
Isometry3 shifted(const Isometry3& pose, const Vector3& by) {
  return rigid_motion(rotation(pose), translation(pose) + by);
}
Vector3 direction(Rng& rng) {
  Vector3 out;
  for (double& x : out) x = rng.normal();
  return out.normalized();
}

/// Joints within a cell.
JointLimits<6> cell() {
  JointLimits<6> out;
  out.lower = Joints(-2, -2.4, 0.4, -2, -1.8, -2);
  out.upper = Joints(2, -0.6, 2.2, 2, 1.8, 2);
  return out;
}

/// Joints 1, 4 and 6 a turn further, towards where the limits are.
JointRows<6> a_turn_further(JointRows<6> joints) {
  for (Index i = 0; i < joints.rows(); ++i)
    for (const Index j : {0, 3, 5}) joints(i, j) += (joints(i, j) < 0 ? 2 : -2) * std::numbers::pi;
  return joints;
}

/// An arm whose joints have more harmonics than its model knows: 0.08 mm and 0.13 mrad. Both are periodic, so that they
/// hold a turn further.
struct Case {
  Model model, truth;
  Rng rng;

  explicit Case(std::uint64_t case_seed)
      : model(arm(case_seed, 3)), truth(arm(case_seed, 30)), rng(case_seed), seed_(case_seed) {
    truth = truth.moved(elsewhere(), Joints::Zero(), Isometry3::Identity());
  }

  static Model arm(std::uint64_t seed, int harmonics) {
    const JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .harmonic = 0.12e-3, .harmonics = harmonics};
    const WithJointErrors<Chain> chain(with_geometric_errors(robot.chain, {}, seed),
                                       draw_joint_errors(robot.chain, sizes, seed));
    return {robot.chain,
            Model::Arm(chain, frame({0.4, -0.2, 0.1, 0.1, -0.3, 0.8}), frame({0.03, 0.01, 0.12, 0.2, 0.4, 0}))};
  }
  /// Where the base is now, against where it was: metres away.
  Isometry3 elsewhere() const {
    Rng drawn(1000 + seed_);
    const Vector3 moved = 3 * direction(drawn), turn = 2 * direction(drawn);
    return rigid_motion(exp_so3(turn), moved);
  }

  /// What a sensor sees of it, whose probe is turned.
  Dataset<6> seen(Index poses, std::uint64_t seed, const Vector3& probe) const {
    const Model held_by_it = truth.moved(Isometry3::Identity(), Joints::Zero(), turned(probe));
    return measure(held_by_it, a_turn_further(sample_joints(cell(), poses, seed)), noise, seed);
  }

  /// Mean position error at fresh poses [m].
  double error(const Model& found) const {
    const JointRows<6> joints = a_turn_further(sample_joints(cell(), 200, 77));
    double sum = 0;
    for (Index i = 0; i < joints.rows(); ++i) {
      const Joints q = configuration(joints, i);
      sum += (found.position(q) - truth.position(q)).norm();
    }
    return sum / static_cast<double>(joints.rows());
  }
  /// The same of the model in its true frames: its own error.
  double own_error() const { return error(model.moved(elsewhere(), Joints::Zero(), Isometry3::Identity())); }

 private:
  std::uint64_t seed_;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

constexpr std::uint64_t cases = 50;

TEST(Contradiction, ARemountedProbeDoesNotMoveTheArm) {
  std::vector<double> ratios;
  int noticed = 0;
  for (std::uint64_t seed = 0; seed < cases; ++seed) {
    Case c(seed);
    const Vector3 probe = 1.5e-3 * direction(c.rng);
    const auto found = reregister(c.model, c.seen(17, seed, probe), {}, sensors);
    ratios.push_back(c.error(found.model) / c.own_error());
    if (!found.probe_turned) continue;
    ++noticed;
    EXPECT_LT((found.motion.probe - probe).norm(), 0.2e-3) << seed;
    EXPECT_GT((found.motion.probe - probe).norm(), 0.1 * found.probe_std.norm()) << seed;
    EXPECT_EQ(difference(found.model.identified().tool(), c.model.identified().tool()), 0) << seed;
  }
  EXPECT_EQ(noticed, cases);
  EXPECT_LT(median(ratios), 1.3);
  EXPECT_GT(median(ratios), 1);
}

TEST(Contradiction, NothingIsFreedWithoutOne) {
  std::vector<double> ratios;
  int noticed = 0;
  const Vector3 none = Vector3::Zero();
  for (std::uint64_t seed = 0; seed < cases; ++seed) {
    const Case c(seed);
    const auto found = reregister(c.model, c.seen(17, seed, none), {}, sensors);
    noticed += found.probe_turned;
    ratios.push_back(c.error(found.model) / c.own_error());
    if (found.probe_turned) continue;
    EXPECT_EQ(difference(found.motion.probe, none), 0) << seed;
    EXPECT_EQ(difference(found.probe_std, none), 0) << seed;
    EXPECT_TRUE(found.remarks().empty()) << found.summary();
  }
  EXPECT_LE(noticed, 2);
  EXPECT_LT(median(ratios), 1.3);
}

// A rotation too small to be told from errors of the model may not turn the arm either.
TEST(Contradiction, ARotationBelowTheThresholdDoesNoHarm) {
  std::vector<double> ratios;
  for (std::uint64_t seed = 0; seed < cases; ++seed) {
    Case c(seed);
    const auto found = reregister(c.model, c.seen(17, seed, 0.25e-3 * direction(c.rng)), {}, sensors);
    ratios.push_back(c.error(found.model) / c.own_error());
  }
  EXPECT_LT(median(ratios), 1.3);
}

// Mounted another way round altogether: the prior is no bound.
TEST(Contradiction, AProbeMayBeTurnedByAnyAngle) {
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const double angle : {0.03, 0.3, std::numbers::pi / 2, 3.0}) {
      Case c(seed);
      const Vector3 probe = angle * direction(c.rng);
      const auto found = reregister(c.model, c.seen(17, seed, probe), {}, sensors);
      EXPECT_TRUE(found.converged && found.probe_turned) << seed << ", " << angle;
      EXPECT_LT((found.motion.probe - probe).norm(), 1e-3) << seed << ", " << angle;
      EXPECT_LT(c.error(found.model), 2 * c.own_error()) << seed << ", " << angle;
    }
}

TEST(Contradiction, IsSaid) {
  Case c(3);
  const auto data = c.seen(17, 3, Vector3(1.2e-3, 0, -0.9e-3));
  const auto found = reregister(c.model, data, {}, sensors);
  ASSERT_TRUE(found.probe_turned);
  ASSERT_EQ(found.remarks().size(), 1U);
  EXPECT_TRUE(mentions(found.summary(), "orientations are turned by 1.")) << found.summary();
  EXPECT_TRUE(mentions(found.summary(), "was the probe remounted?")) << found.summary();
  EXPECT_GT(found.contradiction, found.estimated.contradiction_threshold);

  // on demand it is never taken for one; then it is an error of the orientations, which says so by its size
  const auto never =
      reregister(c.model, data, {.contradiction_threshold = std::numeric_limits<double>::infinity()}, sensors);
  EXPECT_FALSE(never.probe_turned);
  EXPECT_EQ(never.contradiction, found.contradiction);

  // a tool that is freed follows the orientations
  const auto tool = reregister(c.model, data, {.tool = true}, sensors);
  EXPECT_FALSE(tool.probe_turned);
  EXPECT_EQ(tool.contradiction, 0);
  EXPECT_NEAR(log_so3(rotation(tool.motion.tool)).norm(), 1.5e-3, 0.15e-3);
  EXPECT_LT(translation(tool.motion.tool).norm(), 0.2e-3);
  EXPECT_TRUE(tool.remarks().empty()) << tool.summary();
}

TEST(Contradiction, WeightsAreThoseOfTheResiduals) {
  const Case c(5);
  const auto found = reregister(c.model, c.seen(200, 5, Vector3::Zero()), {}, sensors);
  EXPECT_NEAR(found.position_sigma, found.rms_after / std::sqrt(3), 0.02 * found.position_sigma);
  EXPECT_GT(found.position_sigma, 2 * sensors.position_sigma);  // the model's own error is in it
  EXPECT_GT(found.orientation_sigma, 1.5 * sensors.orientation_sigma);
  EXPECT_TRUE(mentions(found.summary(), "Weighted for residuals of 0.0")) << found.summary();
  SensorModel positions = sensors;
  positions.use_orientations = false;
  EXPECT_EQ(reregister(c.model, c.seen(17, 5, Vector3::Zero()), {}, positions).orientation_sigma, 0);
  // a sensor that is worse than the model
  const SensorModel worse{.position_sigma = 1e-3, .orientation_sigma = 1e-3};
  const auto floor = reregister(c.model, c.seen(17, 5, Vector3::Zero()), {}, worse);
  EXPECT_EQ(floor.position_sigma, worse.position_sigma);
  EXPECT_EQ(floor.orientation_sigma, worse.orientation_sigma);
}

/// Covariance of base and probe at a solution, with a prior on the probe.
RealMatrix covariance(const Reregistered<Chain>& found, const Dataset<6>& data, double probe_std) {
  const detail::FrameUpdate update{true, false, false, 6, true};
  RealMatrix information(9, 9);
  for (Index i = 0; i < data.size(); ++i) {
    RealMatrix rows = update.columns(found.model.pose(data.joints(i)), nullptr);
    for (Index r = 0; r < 6; ++r)
      for (Index c = 0; c < 9; ++c) rows(r, c) /= r < 3 ? found.position_sigma : found.orientation_sigma;
    information += rows.transpose() * rows;
  }
  for (Index k = 6; k < 9; ++k) information(k, k) += 1 / (probe_std * probe_std);
  return information.inverse();
}

/// Standard deviation of the model's own orientations: what their scatter has beyond the sensor's.
double own_deviation(const ReregistrationReport& found) {
  return std::sqrt(std::pow(found.orientation_sigma, 2) - std::pow(sensors.orientation_sigma, 2));
}

TEST(Contradiction, IsWaldsStatistic) {
  const Case c(5);
  const Dataset<6> data = c.seen(17, 5, Vector3(0.5e-3, -0.4e-3, 0.3e-3));
  const auto found = reregister(c.model, data, {}, sensors);
  ASSERT_TRUE(found.probe_turned);
  RealMatrix by_chance = covariance(found, data, 1).block(6, 6, 3, 3);
  for (Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.probe_std(k), std::sqrt(by_chance(k, k)), 1e-6 * found.probe_std(k));
    by_chance(k, k) += std::pow(own_deviation(found), 2);
  }
  const RealMatrix probe = found.motion.probe;
  const double square = probe.dot(by_chance.inverse() * probe);
  constexpr double redundancy = 6 * 17 - 9;  // values that the unknowns leave free
  EXPECT_NEAR(found.contradiction, redundancy * std::log1p(square / redundancy), 1e-5 * found.contradiction);
  // as much as the threshold is no more than it
  const auto equal = reregister(c.model, data, {.contradiction_threshold = found.contradiction}, sensors);
  EXPECT_EQ(equal.contradiction, found.contradiction);
  EXPECT_FALSE(equal.probe_turned);
}

// Two poses hardly tell base from probe: what they leave open is as uncertain as the prior of the probe, 1 rad, which
// takes the place of values that are left over.
TEST(Contradiction, TwoPosesLeaveTheProbeToItsPrior) {
  const Case c(5);
  const Dataset<6> data = c.seen(2, 5, Vector3(0.2, -0.1, 0.15));
  const auto found = reregister(c.model, data, {.contradiction_threshold = 1e-3}, sensors);
  ASSERT_TRUE(found.probe_turned);
  RealMatrix by_chance = covariance(found, data, 1).block(6, 6, 3, 3);
  const double redundancy = 6 * 2 - 9 + by_chance.trace();
  for (Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.probe_std(k), std::sqrt(by_chance(k, k)), 0.01 * found.probe_std(k)) << k;
    by_chance(k, k) += std::pow(own_deviation(found), 2);
  }
  const RealMatrix probe = found.motion.probe;
  const double square = probe.dot(by_chance.inverse() * probe);
  EXPECT_NEAR(found.contradiction, redundancy * std::log1p(square / redundancy), 0.01 * found.contradiction);
}

// Orientations of a model that errs tell about the base no more than their mean error allows.
TEST(Contradiction, TheModelsOwnErrorWidensTheBase) {
  const Case c(5);
  const Dataset<6> data = c.seen(17, 5, Vector3::Zero());
  const auto found = reregister(c.model, data, {}, sensors);
  ASSERT_FALSE(found.probe_turned);
  ASSERT_GT(found.orientation_sigma, 1.2 * sensors.orientation_sigma);
  const RealMatrix expected = covariance(found, data, own_deviation(found));
  for (Index k = 0; k < 6; ++k)
    EXPECT_NEAR(found.change_std(k), std::sqrt(expected(k, k)), 1e-5 * found.change_std(k)) << k;
}

TEST(HeldTool, WhereAllPosesFaceOneWay) {
  const Case c(1);
  const Joints first(0.3, -1.4, 1.2, 0.4, -0.7, 0.2);
  for (const Index poses : {1, 3, 4, 17}) {
    JointRows<6> joints(poses, 6);
    for (Index i = 0; i < poses; ++i) {  // the flange is moved, not turned
      const Vector3 by(static_cast<double>(i % 3), static_cast<double>(i % 2), static_cast<double>(i % 5));
      const Isometry3 target = shifted(c.model.pose(first), 0.05 * by);
      const auto there = inverse_kinematics(c.model, target, first);
      ASSERT_EQ(there.status, IkStatus::converged) << i;
      set_configuration(joints, i, there.joints);
    }
    const Model moved = c.model.moved(c.elsewhere(), Joints::Zero(), frame({0.5e-3, 0, 0, 0, 0, 0}));
    const auto found = reregister(c.model, measure(moved, joints, noise, 1), {.tool = true}, sensors);
    EXPECT_TRUE(found.determined) << poses;
    ASSERT_FALSE(found.held.empty()) << poses;
    EXPECT_EQ(found.held[0], "the position of the tool") << poses;
    EXPECT_EQ(found.held.size() == 2, poses == 1) << poses;  // positions do tell how it is turned
    EXPECT_LT(translation(found.motion.tool).norm(), 1e-7) << poses;
    EXPECT_GT(found.change_std(found.change_std.size() - 6), 2.9e-3) << poses;
    EXPECT_TRUE(mentions(found.summary(), "The poses do not determine the position of the tool: held where it was."));
  }
}

// Poses that face almost one way would move the tool by a centimetre, for errors of the model alone.
TEST(HeldTool, WherePosesFaceAlmostOneWay) {
  double farthest = 0;
  int all_held = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Case c(seed);
    JointRows<6> joints(17, 6);
    const Joints first(0.3, -1.4, 1.2, 0.4, -0.7, 0.2);
    for (Index i = 0; i < 17; ++i) {
      const Vector3 by = 0.15 * direction(c.rng), turn = 2e-3 * direction(c.rng);
      const Isometry3 target = shifted(composed(c.model.pose(first), turned(turn)), by);
      const auto there = inverse_kinematics(c.model, target, first);
      ASSERT_EQ(there.status, IkStatus::converged) << i;
      set_configuration(joints, i, there.joints);
    }
    const auto data = measure(c.truth, joints, noise, seed);
    const auto found = reregister(c.model, data, {.tool = true}, sensors);
    ASSERT_FALSE(found.held.empty()) << seed;
    EXPECT_TRUE(mentions(found.held[0], "the position of the tool")) << seed;
    EXPECT_LT(translation(found.motion.tool).norm(), 3e-3) << seed;
    if (found.held[0] == "the position of the tool") {
      EXPECT_LT(translation(found.motion.tool).norm(), 5e-6) << seed;
      ++all_held;
    }
    // of another tool nothing is known, and that is said, too
    const auto free = reregister(c.model, data, another_tool(), sensors);
    farthest = std::max(farthest, translation(free.motion.tool).norm());
    ASSERT_FALSE(free.remarks().empty()) << seed;
    EXPECT_TRUE(mentions(free.remarks()[0], "The poses determine the position of the tool to ")) << free.summary();
  }
  EXPECT_GT(farthest, 0.01);
  EXPECT_GT(all_held, 0);
}

TEST(HeldTool, AlongAnAxisThatDoesNotTilt) {
  // joints 1 and 6 alone turn the flange: about vertical axes of an arm that hangs down, but for its errors
  const Case c(2);
  JointRows<6> joints = sample_joints(cell(), 17, 2);
  for (Index i = 0; i < joints.rows(); ++i) {
    joints(i, 3) = -joints(i, 1) - joints(i, 2) - std::numbers::pi / 2;
    joints(i, 4) = -std::numbers::pi / 2;
  }
  const Model model{robot.chain, Model::Arm(WithJointErrors<Chain>(robot.chain), FrameParameters(),
                                            FrameParameters(Vector6{0.03, 0.01, 0.12, 0, 0, 0}))};
  const Model moved = model.moved(c.elsewhere(), Joints::Zero(), frame({1e-3, -1e-3, 0.5e-3, 0, 0, 0}));
  const auto found = reregister(model, measure(moved, joints, noise, 2), {.tool = true}, sensors);
  ASSERT_EQ(found.held.size(), 1U) << found.summary();
  EXPECT_EQ(found.held[0], "the position of the tool along (0.00, 0.00, 1.00) of its frame");
  EXPECT_LT((translation(found.motion.tool) - Vector3(1e-3, -1e-3, 0)).norm(), 0.05e-3);
  EXPECT_LT(std::abs(found.motion.tool(2, 3)), 1e-7);
}

// The last joint alone moves, and the tool point is on its axis: along that axis, and about it, the tool may move as
// the base does. The axis is named with its larger component positive, however the tool's frame is turned.
TEST(HeldTool, AlongAndAboutTheOnlyAxisThatTurns) {
  const Case c(3);
  JointRows<6> joints = sample_joints(cell(), 17, 2);
  for (Index i = 0; i < joints.rows(); ++i)
    for (Index j = 0; j < 5; ++j) joints(i, j) = joints(0, j);
  const double quarter = std::numbers::pi / 2;
  const std::pair<Vector3, const char*> tools[] = {
      {{0, 0, 0}, "(0.00, 0.00, 1.00)"},       {{2 * quarter, 0, 0}, "(0.00, 0.00, 1.00)"},
      {{0, quarter, 0}, "(1.00, 0.00, 0.00)"}, {{0, -quarter, 0}, "(1.00, 0.00, 0.00)"},
      {{quarter, 0, 0}, "(0.00, 1.00, 0.00)"}, {{-quarter, 0, 0}, "(0.00, 1.00, 0.00)"},
      {{0, 0.12, 0}, "(-0.12, 0.00, 0.99)"},   {{0.02, 0, 0}, "(0.00, 0.02, 1.00)"}};
  for (const auto& [turn, axis] : tools) {
    const Isometry3 tool = rigid_motion(exp_so3(turn), Vector3(0, 0, 0.12));
    const Model model{robot.chain,
                      Model::Arm(WithJointErrors<Chain>(robot.chain), FrameParameters(), FrameParameters(tool))};
    const auto found = reregister(model, measure(model, joints, noise, 2), {.tool = true}, sensors);
    ASSERT_EQ(found.held.size(), 2U) << found.summary();
    EXPECT_EQ(found.held[0], std::string("the position of the tool along ") + axis + " of its frame");
    EXPECT_EQ(found.held[1], std::string("the rotation of the tool about ") + axis + " of its frame");
  }
}

TEST(HeldTool, FewPositionsSayLittle) {
  for (const Index poses : {3, 4})
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Case c(seed);
      SensorModel positions = sensors;
      positions.use_orientations = false;
      const auto found = reregister(c.model, c.seen(poses, seed, Vector3::Zero()), {.tool = true}, positions);
      EXPECT_TRUE(found.determined);
      ASSERT_FALSE(found.held.empty());
      EXPECT_EQ(found.held.back(), "the rotation of the tool");  // which no position shows
      EXPECT_LT(log_so3(rotation(found.motion.tool)).norm(), 1e-8);
      EXPECT_LT(translation(found.motion.tool).norm(), 5e-3);
    }
}

TEST(HeldTool, ZerosThatThePosesDoNotTell) {
  const Case c(6);  // joint 1 turns as the base does
  const auto found = reregister(c.model, c.seen(17, 6, Vector3::Zero()), {.offsets = true}, sensors);
  ASSERT_EQ(found.remarks().size(), 1U) << found.summary();
  EXPECT_EQ(found.remarks()[0], "The poses tell little about the zeros of joints 1: held near where they were.");
}

}  // namespace
}  // namespace vernier::contradiction_test
