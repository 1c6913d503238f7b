// SPDX-License-Identifier: BSD-3-Clause
// Assessment on held-out poses, and data that support no calibration.

#include "vernier/calibration/evaluate.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "ur10_measured.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::evaluate_test {
namespace {

using namespace vernier_test::ur10_measured;
using vernier_test::complaint;

/// A small search: what is learned matters little here.
const CalibrateOptions quick{
    .errors = {.harmonics = 5},
    .remainder = {.on_geometry = true, .hidden_nodes = 5, .particles = 4, .iterations = 3},
};

TEST(Evaluate, FiguresAreThoseOfTheModels) {
  const auto actual = actual_arm();
  const JointRows<6> taught = joints(200, 1);
  const auto found = calibrate(robot.chain, measure(actual, taught, noise, 2), quick);
  // joint 1 reaches farther than it was measured in some of the held-out poses
  const auto fresh = measure(actual, joints(100, 3, 1.15), noise, 4);
  const CalibrationReport report = evaluate(found, fresh, robot.limits);

  std::vector<std::string> keys;
  for (const StageErrors& stage : report.stages) keys.push_back(stage.key());
  EXPECT_EQ(keys, (std::vector<std::string>{"frames", "geometry", "geometry_pso_elm", "elastic", "jointwise",
                                            "jointwise_pso_elm"}));
  EXPECT_EQ(report.stage(Stage::frames).position, position_errors(found.errors.models(Stage::frames)[0], fresh));
  EXPECT_EQ(report.stage(Stage::geometry).position, position_errors(found.errors.models(Stage::geometry)[0], fresh));
  EXPECT_EQ(report.stage(Stage::jointwise).position, position_errors(found.model(), fresh));
  EXPECT_EQ(report.stage(Stage::jointwise).rotation, rotation_errors(found.model(), fresh));
  EXPECT_LT(report.stage(Stage::geometry).position.mean(), 0.5 * report.stage(Stage::frames).position.mean());
  EXPECT_LT(report.stage(Stage::jointwise).position.mean(), 0.5 * report.stage(Stage::geometry).position.mean());
  EXPECT_NE(complaint([&] { (void)report.stage(Stage::tilt); }).find("there is no stage 'tilt'"), std::string::npos);

  EXPECT_EQ(report.train_poses, 200);
  EXPECT_EQ(report.test_poses(), 100);
  EXPECT_TRUE(report.oriented);
  Index outside = 0, within = 0;
  double degradation = 0;
  for (Index i = 0; i < 100; ++i) {
    const double gate = found.coverage(fresh.joints(i));
    EXPECT_EQ(report.gates(i), gate);
    outside += gate < 1;
    if (gate == 1)
      degradation =
          std::max(degradation, report.stage(Stage::jointwise).position(i) - report.stage(Stage::geometry).position(i));
    const PredictedPose predicted = found.errors.predicted(fresh.joints(i));
    const Vector3 error = predicted.pose.translation() - fresh.position(i);
    within += error.dot(Matrix3(predicted.covariance.topLeftCorner<3, 3>()).inverse() * error) <= 7.8147;
  }
  EXPECT_EQ(report.extrapolated(), outside);
  EXPECT_GT(outside, 0);
  EXPECT_LT(outside, 50);
  EXPECT_EQ(report.max_degradation, degradation);
  EXPECT_DOUBLE_EQ(report.ellipsoid_coverage, static_cast<double>(within) / 100);
  EXPECT_GT(report.ellipsoid_coverage, 0.85);

  ASSERT_EQ(report.joints.size(), 6u);
  EXPECT_EQ(report.joints[2].held_out.size(), 100u);
  for (int j = 0; j < 6; ++j) {  // at equal distances over each range: 200 a radian, 361 or more
    const JointReport& joint = report.joints[static_cast<std::size_t>(j)];
    ASSERT_FALSE(joint.measured_ranges.empty());
    EXPECT_EQ(joint.measured_ranges.front().first, taught.col(j).minCoeff());
    EXPECT_EQ(joint.measured_ranges.back().second, taught.col(j).maxCoeff());
    EXPECT_EQ(joint.valid_ranges.front().first,
              std::max(found.coverage.ranges[static_cast<std::size_t>(j)].front().lower, robot.limits.lower(j)));
    EXPECT_LT(joint.valid_ranges.front().first, joint.measured_ranges.front().first);
    EXPECT_GT(joint.valid_ranges.back().second, joint.measured_ranges.back().second);
    std::size_t at = 0;
    for (const auto& [lower, upper] : joint.measured_ranges) {
      const int steps = std::max(360, static_cast<int>(200 * (upper - lower)));
      ASSERT_LE(at + static_cast<std::size_t>(steps) + 1, joint.angle.size());
      for (int k = 0; k <= steps; ++k, ++at) {
        ASSERT_NEAR(joint.angle[at], lower + (upper - lower) * k / steps, 1e-12) << j << ' ' << k;
      }
    }
    EXPECT_EQ(at, joint.angle.size());
    const JointFunction transmission = found.errors.transmission(j, joint.angle);
    EXPECT_EQ(joint.transmission, transmission.value);
    EXPECT_EQ(joint.transmission_std, transmission.std);
  }
}

// A joint is valid beyond its limits only as far as it was measured there.
TEST(EvaluateWhiteBox, RangesOfValidityEndAtTheLimits) {
  using Ranges = std::vector<std::pair<double, double>>;
  const Ranges measured{{-2.9, -1.1}, {1.1, 2.8}};
  EXPECT_EQ(detail::within_limits({{-3, -1}, {1, 3}}, measured, -2.95, 2.5), (Ranges{{-2.95, -1}, {1, 2.8}}));
  EXPECT_EQ(detail::within_limits({{-3, -1}, {1, 3}}, measured, -10, 10), (Ranges{{-3, -1}, {1, 3}}));
  EXPECT_TRUE(detail::within_limits({}, {}, -1, 1).empty());
}

// A base that drifts goes on to do so: the ellipsoid of a pose long before the session, or after it, is wider.
TEST(Evaluate, EllipsoidsWidenBeyondADriftingSession) {
  const auto still = measure(actual_arm(), joints(400, 1), noise, 2);
  PointRows positions = still.positions();
  for (Index i = 0; i < still.size(); ++i)
    positions(i, 2) += 0.2e-3 * std::sin(2 * std::numbers::pi * static_cast<double>(i) / 400);
  CalibrateOptions options = quick;
  options.remainder.learners.clear();
  const auto found = calibrate(robot.chain, Dataset<6>(still.joints(), positions, still.orientations()), options);
  ASSERT_EQ(found.errors.drift.size(), 1u);
  const SessionDrift& drift = found.errors.drift.front();
  ASSERT_FALSE(drift.empty());

  const auto fresh = measure(actual_arm(), joints(50, 3), noise, 4);
  const auto at = [&](double time) {
    return evaluate(found, fresh.measured_at(VectorX::Constant(fresh.size(), time)), robot.limits).normalised_errors;
  };
  const VectorX within = at(200);
  for (const double time : {-80.0, 399 + 80.0}) {
    const VectorX beyond = at(time);
    for (Index i = 0; i < fresh.size(); ++i) {
      const PredictedPose predicted = found.errors.predicted(fresh.joints(i));
      const Vector3 point = predicted.pose.translation(), error = point - fresh.position(i);
      const Matrix3 then =
          (predicted.covariance +
           drift.covariance_beyond(time, point, found.model().pose_and_jacobian(fresh.joints(i)).jacobian))
              .topLeftCorner<3, 3>();
      EXPECT_LT(beyond(i), within(i));
      EXPECT_NEAR(beyond(i), std::sqrt(error.dot(then.inverse() * error)), 1e-9);
    }
  }
  // two knots beyond, each a step of 0.03 mm / sqrt(5) or more
  EXPECT_LT(at(-80).mean(), 0.95 * within.mean());
}

TEST(Calibrate, KernelsAreTriedOnFewPosesAlone) {
  const auto poses = measure(actual_arm(), joints(60, 1), noise, 2);
  CalibrateOptions options = quick;
  for (const Index most : {60, 59}) {
    options.remainder.max_kernel_poses = most;
    const auto found = calibrate(robot.chain, poses, options);
    Index kernels = 0;
    for (const RemainderTrial& trial : found.trials) kernels += trial.learner == Learner::kernel_elm;
    EXPECT_EQ(kernels, most == 60 ? 2 : 0);
    EXPECT_EQ(found.trials.size(), most == 60 ? 6u : 4u);
    EXPECT_GT(found.errors.leave_one_out_seconds, 0);
    EXPECT_LT(found.errors.leave_one_out_seconds, found.fit_seconds);
  }
  options.remainder.learners = {Learner::kernel_elm};
  EXPECT_TRUE(calibrate(robot.chain, poses, options).trials.empty());
}

// Thirty unknowns of geometry and more of the joints, estimated from 24 poses, fit those better than others.
TEST(Calibrate, LearnersAreJudgedByErrorsOfPosesThatTheirModelHasNotSeen) {
  const auto poses = measure(actual_arm(), joints(24, 1), noise, 2);
  const auto found = calibrate(robot.chain, poses, quick);
  ASSERT_EQ(found.trials.size(), 6u);
  for (const RemainderTrial& trial : found.trials) {
    const auto& model =
        trial.on_geometry ? found.errors.models(Stage::geometry).front() : found.errors.models().front();
    const VectorX& unseen = trial.on_geometry ? found.errors.geometry_left_out_errors : found.errors.left_out_errors;
    const double fitted = position_errors(model, poses).mean();
    EXPECT_DOUBLE_EQ(trial.without, unseen.mean());
    EXPECT_GT(trial.without, 1.2 * fitted);
    const VectorX folds = detail::fold_errors(trial.learner, model, poses, quick.remainder, {});
    EXPECT_NEAR(trial.with - trial.without, folds.mean() - fitted, 1e-9);
  }
}

/// Poses with an error of position that depends on two joints together, as no joint error does.
Dataset<6> poses_with_interaction(Index n, std::uint64_t seed) {
  const auto poses = measure(actual_arm(), joints(n, seed), noise, seed + 1);
  PointRows positions = poses.positions();
  for (Index i = 0; i < n; ++i)
    positions(i, 2) += 1e-3 * std::sin(2 * poses.joints(i)(3)) * std::sin(2 * poses.joints(i)(4));
  return Dataset<6>(poses.joints(), positions, poses.orientations());
}

// A learner is learned from all poses once: the first in any case, another where cross-validation supports it.
TEST(Calibrate, TheLearnerThatHelpsIsDeployed) {
  const auto poses = poses_with_interaction(300, 1), fresh = poses_with_interaction(100, 3);
  CalibrateOptions options{.errors = {.harmonics = 5}, .remainder = {.hidden_nodes = 100}};
  for (const std::size_t others : {0u, 1u}) {
    options.remainder.learners = {Learner::kernel_elm};
    options.remainder.learners.insert(options.remainder.learners.begin(), others, Learner::ridge_elm);
    const auto found = calibrate(robot.chain, poses, options);
    ASSERT_EQ(found.trials.size(), others + 1);
    for (const RemainderTrial& trial : found.trials)
      EXPECT_EQ(trial.supported, trial.learner == Learner::kernel_elm) << learner_key(trial.learner);
    EXPECT_LT(found.trials.back().with, found.trials.back().without);
    ASSERT_EQ(found.remainders.size(), others + 1);
    EXPECT_EQ(found.deployed_remainder, others);
    EXPECT_EQ(found.remainders.back().learner, Learner::kernel_elm);
    EXPECT_FALSE(found.remainders.back().on_geometry);
    EXPECT_EQ(found.chosen(), learned_stage(false, Learner::kernel_elm));

    const CalibrationReport report = evaluate(found, fresh, robot.limits);
    EXPECT_EQ(report.stages.back().key(), "jointwise_kernel_elm");
    EXPECT_EQ(report.stages.size(), others + 5);  // frames, geometry, elastic, joint-wise before
    EXPECT_LT(report.stages.back().position.mean(), 0.95 * report.stage(Stage::jointwise).position.mean());
  }
}

TEST(Evaluate, EveryStationNeedsItsHeldOutPoses) {
  const auto actual = actual_arm();
  CalibrateOptions options = quick;
  options.errors.harmonics = 0;
  options.remainder = {.on_error_model = false};
  const auto found = calibrate(robot.chain, measure(actual, joints(60, 1), noise, 2), options);
  const auto fresh = measure(actual, joints(10, 3), noise, 4);
  EXPECT_NE(complaint([&] {
              (void)evaluate(found, std::vector<Dataset<6>>{fresh, fresh});
            }).find("2 sets of held-out poses for 1 stations"),
            std::string::npos);
  EXPECT_THROW((void)evaluate(found, std::vector<Dataset<6>>{}), std::invalid_argument);
  const Measurements<6> lengths =
      Measurements<6>(fresh).add(fresh.joints(), DistanceSensor(VectorX::Ones(fresh.size())));
  EXPECT_EQ(complaint([&] { (void)evaluate(found, lengths); }),
            "evaluate: 1 of 2 sets of measurements are no data sets of poses; errors are those of poses");
}

/// What a calibration is refused with; empty where it is not.
std::string refusal(const Dataset<6>& data, const CalibrateOptions& options) {
  try {
    (void)calibrate(robot.chain, Measurements<6>().add(data, "poses.csv"), options);
  } catch (const CalibrationFailure& e) {
    return e.what();
  }
  return {};
}

TEST(CalibrationFailure, SaysWhatIsWrongWithTheData) {
  CalibrateOptions options{.errors = {.harmonics = 0}, .remainder = {.on_error_model = false}, .arm_name = "UR10"};
  const auto data = measure(actual_arm(), joints(60, 1), noise, 2);
  EXPECT_EQ(refusal(data, options), "");
  const auto expect = [&](const Dataset<6>& wrong, const std::string& reason) {
    const std::string line = refusal(wrong, options);
    EXPECT_EQ(line.find("poses.csv: with registered frames the model of UR10 is off by"), 0u) << line;
    EXPECT_NE(line.find(reason), std::string::npos) << line;
  };
  expect({data.joints() * 180 / std::numbers::pi, data.positions()}, "looks like degrees in a _rad column");
  expect({data.joints() * std::numbers::pi / 180, data.positions()}, "radians in a _deg column?");
  expect({data.joints(), data.positions() * 1e3}, "x, y, z in mm called _m?");
  expect({data.joints(), data.positions() * 1e-3}, "x, y, z in m called _mm?");
  const auto other = robots::ur5().chain;
  expect(measure(other, joints(60, 1), {.with_orientations = false}), "wrong robot, units or columns?");
  EXPECT_NE(refusal(data.rows(std::array<Index, 2>{0, 1}), options).find("underdetermined"), std::string::npos);

  options.refuse_implausible = false;
  EXPECT_EQ(refusal(measure(other, joints(60, 1), {.with_orientations = false}), options), "");
}

}  // namespace
}  // namespace vernier::evaluate_test
