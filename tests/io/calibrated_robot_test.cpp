// SPDX-License-Identifier: BSD-3-Clause
// Calibrated arms as values: in other frames, at other temperatures, with what was learned on top, and made of what a
// calibration found.
#include "vernier/io/calibrated_robot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/io/identified_robot.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::calibrated_robot_test {
namespace {

using Arm = CalibratedRobot<6>;
using Model = Arm::Model;
using Chain = Arm::Chain;

const Robot<6> irb120 = robots::abb_irb120();

/// An arm in a frame of its own, whose geometry changes with temperature.
Model model_in_frames() {
  const FrameParameters base(Vector6{1.2, -0.4, 0.05, 0.1, -0.7, 2.0}), tool(Vector6{0, 0.01, 0.109, 0, 0.02, 0});
  const Chain actual = with_geometric_errors(irb120.chain, {}, 3);
  return Model(irb120.chain, Model::Arm(actual, base.isometry(), tool.isometry()))
      .with_thermal({22, 18, 26, VectorX::Constant(42, 1e-5)});
}

JointRows<6> measured_joints() { return sample_joints(irb120.limits, 30, 6); }

/// Errors of about a tenth of a millimetre over the joints, everywhere.
LearnedError<6> kernels_of(double size) {
  const JointRows<6> joints = measured_joints();
  return KernelPredictor<6, 3>(Kernel::squared_exponential, InputMap::raw,
                               {VectorX::Constant(6, 0.01), VectorX::Constant(6, 0.9)}, joints,
                               size * joints.leftCols<3>(), Vector3(size, 0, -2 * size));
}
JointCoverage<6> gate_of_all() { return JointCoverage<6>::covering(measured_joints()); }

Arm learned_arm() {
  return Arm("an arm", model_in_frames(), irb120.limits, {}).with_learned(kernels_of(1e-4), gate_of_all());
}

// What was learned is a vector in the base frame: an arm that is carried elsewhere is off in the carried direction.
TEST(CalibratedRobots, WhatWasLearnedTurnsWithTheBase) {
  const Arm arm = learned_arm();
  const Isometry3 motion = rigid_motion(exp_so3(Vector3(0.3, -0.5, 0.9)), Vector3(1, -2, 0.5));
  const Arm moved = arm.with_model(arm.model().moved(motion, JointVector<6>::Zero(), Isometry3::Identity()), {});
  const JointRows<6> samples = measured_joints();
  for (Index i = 0; i < 5; ++i) {
    const JointVector<6> q = configuration(samples, i);
    ASSERT_GT((arm.position(q) - arm.model().position(q)).norm(), 3e-5);
    EXPECT_LT((moved.position(q) - motion * arm.position(q)).norm(), 1e-12);
    EXPECT_LT((moved.pose(q).matrix() - (motion * arm.pose(q)).matrix()).norm(), 1e-12);
    EXPECT_EQ(moved.gate(q), arm.gate(q));
  }
}

TEST(CalibratedRobots, WhatWasLearnedStaysAtOtherTemperatures) {
  const Arm arm = learned_arm(), warm = arm.at_temperature(25);
  const JointRows<6> samples = measured_joints();
  for (Index i = 0; i < 5; ++i) {
    const JointVector<6> q = configuration(samples, i);
    const Vector3 learned = arm.position(q) - arm.model().position(q);
    const Vector3 expected = arm.model().at_temperature(25).position(q) + learned;
    ASSERT_GT((warm.position(q) - arm.position(q)).norm(), 1e-6);
    EXPECT_LT((warm.position(q) - expected).norm(), 1e-14);
    EXPECT_LT((warm.approached_from(q).position(q) - expected).norm(), 1e-14);
  }
}

TEST(CalibratedRobots, TheirReachIsUnknownWhereSomethingWasLearned) {
  const Arm plain("an arm", model_in_frames(), irb120.limits, {});
  EXPECT_EQ(plain.reach_sphere().radius, plain.model().reach_sphere().radius);
  EXPECT_LT(plain.reach_sphere().radius, 2);
  EXPECT_EQ(learned_arm().reach_sphere().radius, std::numeric_limits<double>::infinity());
}

// The share is that of both gates: outside either range a part of the prediction is left out.
TEST(CalibratedRobots, TheGateIsTheSmallerOne) {
  JointCoverage<6> narrow = gate_of_all();
  for (auto& ranges : narrow.ranges) ranges = {{-0.1, 0.1}};
  narrow.margin.setConstant(0.2);
  const Model::Arm arm(irb120.chain);
  const Arm blended("an arm", Model(irb120.chain, arm, arm, narrow), irb120.limits, {});
  const JointVector<6> near = 0.2 * JointVector<6>::Unit(2), zero = JointVector<6>::Zero();
  const double share = blended.gate(near);
  ASSERT_GT(share, 0.05);
  ASSERT_LT(share, 0.95);
  JointCoverage<6> wide = narrow, none = narrow;
  for (auto& ranges : wide.ranges) ranges = {{-1, 1}};
  for (auto& ranges : none.ranges) ranges = {{2, 3}};
  EXPECT_EQ(blended.with_learned(kernels_of(1e-4), wide).gate(near), share);
  EXPECT_EQ(blended.with_learned(kernels_of(1e-4), none).gate(near), 0);
  EXPECT_EQ(blended.with_learned(kernels_of(1e-4), wide).gate(zero), 1);
}

TEST(CalibratedRobots, JointsOfOtherTypesAreRefused) {
  const DhChain<3> turning{{{{.a = 0.3}, {.a = 0.25}, {.a = 0.1}}}};
  const DhChain<3> sliding{{{{.a = 0.3}, {.a = 0.25}, {.a = 0.1, .joint = JointType::prismatic}}}};
  using Three = CalibratedRobot<3>;
  EXPECT_EQ(vernier_test::complaint([&] {
              (void)Three("three", {turning, Three::Model::Arm(sliding)}, JointLimits<3>{}, {});
            }),
            "CalibratedRobot: joint 3 is of another type in the identified chain than in the nominal one");
}

/// What a calibration may have found: an error model with gear ratios, and errors learned on it and on geometry alone.
Calibration<Chain> found_by_hand() {
  JointTerms terms(6);
  terms.gear_ratio = true;
  const Model::Arm jointwise({with_geometric_errors(irb120.chain, {}, 3), JointErrors(terms, VectorX::Ones(6) * 1e-3)});
  const Model::Arm geometry(with_geometric_errors(irb120.chain, {}, 4));
  ErrorModelEstimate estimate{.arm = detail::parameterised(FittedArm::of(jointwise), {{7, -1, 1e-3, 1}},
                                                           VectorX::Ones(6), VectorX::Ones(6), VectorX())};
  estimate.covariance = 1e-2 * MatrixX::Identity(7, 7);
  estimate.position_sigma = 2e-5;
  estimate.left_out_errors = Eigen::Vector4d(1e-4, 3e-4, 5e-4, 1e-4);  // squares: 1, 9, 25, 1 of 1e-8
  FittedErrorModel<Chain> errors(std::move(estimate));
  errors.stages = {{Stage::geometry, true, {Model(irb120.chain, geometry)}},
                   {Stage::jointwise, true, {Model(irb120.chain, jointwise)}}};
  const Calibrated<Chain> frames(Framed<Chain>(irb120.chain), irb120.chain);
  Calibration<Chain> out{.geometry = {IdentificationReport{}, frames}, .errors = std::move(errors)};
  out.remainders.push_back({true, Learner::kernel_elm, kernels_of(1e-4), gate_of_all()});
  out.remainders.push_back({false, Learner::kernel_elm, kernels_of(3e-4), gate_of_all()});
  out.poses = 120;
  out.oriented = true;
  return out;
}

const RobotInfo<6> info{"ours", irb120.limits, "poses.csv", "2024-05-01", "encoder", 4e-5};

TEST(CalibratedRobots, OfACalibrationSayWhereTheyAreFrom) {
  Calibration<Chain> calibration = found_by_hand();
  const Arm arm = calibrated_robot(calibration, info);
  EXPECT_EQ(arm.name(), "ours");
  EXPECT_EQ(arm.limits().lower, irb120.limits.lower);
  const Provenance& from = arm.provenance();
  EXPECT_NEAR(from.left_out_error, 3e-4, 1e-18);  // the root of 36 / 4
  EXPECT_EQ(from, (Provenance{"poses.csv", 120, "2024-05-01", "encoder", "poses", 2e-5, from.left_out_error, 4e-5}));

  calibration.oriented = false;
  calibration.errors.left_out_errors = VectorX(0);
  const Provenance unknown = calibrated_robot(calibration).provenance();
  EXPECT_EQ(unknown.measured, "positions");
  EXPECT_EQ(unknown.left_out_error, 0);
  EXPECT_EQ(unknown.held_out_error, 0);
}

// The covariance is that of the error model: what is deployed on geometry alone has none.
TEST(CalibratedRobots, OfACalibrationAreWhatIsDeployed) {
  Calibration<Chain> calibration = found_by_hand();
  const JointVector<6> q = configuration(measured_joints(), 3);
  const auto error = [&](double size) { return Vector3(gate_of_all()(q) * kernels_of(size).predict(q)); };

  const Arm plain = calibrated_robot(calibration, info);
  EXPECT_EQ(plain.learned(), nullptr);
  ASSERT_NE(plain.estimate(), nullptr);
  EXPECT_EQ(plain.estimate()->position_sigma, 2e-5);
  EXPECT_LT((plain.position(q) - calibration.errors.models()[0].position(q)).norm(), 1e-14);

  calibration.deployed_remainder = 1;
  const Arm on_errors = calibrated_robot(calibration, info);
  ASSERT_NE(on_errors.learned(), nullptr);
  EXPECT_NE(on_errors.estimate(), nullptr);
  EXPECT_LT((on_errors.position(q) - (calibration.errors.models()[0].position(q) - error(3e-4))).norm(), 1e-14);

  calibration.deployed_remainder = 0;
  const Arm on_geometry = calibrated_robot(calibration, info);
  ASSERT_NE(on_geometry.learned(), nullptr);
  EXPECT_EQ(on_geometry.estimate(), nullptr);
  EXPECT_LT(
      (on_geometry.position(q) - (calibration.errors.models(Stage::geometry)[0].position(q) - error(1e-4))).norm(),
      1e-14);
}

TEST(CalibratedRobots, OfACalibrationAreSavedAtOnce) {
  const vernier_test::TemporaryFolder folder("calibrated_robot");
  const Calibration<Chain> calibration = found_by_hand();
  save((folder / "at_once.json").string(), calibration, info);
  save((folder / "in_two.json").string(), calibrated_robot(calibration, info));
  EXPECT_EQ(read_file(folder / "at_once.json"), read_file(folder / "in_two.json"));
}

// An arm identified in code keeps its covariance, in the units of its report, also in a file.
TEST(CalibratedRobots, OfAnIdentificationHaveItsCovariance) {
  const Framed<Chain> nominal(irb120.chain);
  const auto seen = measure(with_geometric_errors(irb120.chain, {}, 3), measured_joints(),
                            {.position = 0.03e-3, .orientation = 0.1e-3}, 7);
  const auto found = identify(nominal, seen, {}, {.loss = Loss::squared}, own_solver);
  ASSERT_GT(found.covariance.rows(), 20);
  const Arm arm = calibrated_robot(found, seen.size(), info);
  const vernier_test::TemporaryFolder folder("identified_robot");
  save((folder / "model.json").string(), arm);
  for (const Arm& robot : {arm, load<6>((folder / "model.json").string())}) {
    ASSERT_NE(robot.estimate(), nullptr);
    EXPECT_EQ(robot.provenance().measured, "poses");
    EXPECT_EQ(robot.provenance().rows, 30);
    const VectorX scales = robot.estimate()->arm.scales();
    for (Index k = 0; k < found.covariance.rows(); ++k) {
      EXPECT_EQ(robot.estimate()->arm.geometric()[static_cast<std::size_t>(k)].parameter,
                found.free[static_cast<std::size_t>(k)]);
      EXPECT_NEAR(robot.estimate()->covariance(k, k) * scales(k) * scales(k), found.covariance(k, k),
                  1e-6 * found.covariance(k, k));
    }
    EXPECT_NEAR(robot.estimate()->position_sigma, found.rms_after / std::sqrt(3.0), 1e-15);
    EXPECT_TRUE(std::isfinite(robot.radii_95(measured_joints()).front()));
  }
  const auto fitted = calibrated_robot(found_by_hand().errors, 120, info);
  ASSERT_NE(fitted.estimate(), nullptr);
  EXPECT_EQ(fitted.estimate()->covariance, found_by_hand().errors.covariance);
  EXPECT_EQ(fitted.provenance().measured, "positions");
}

TEST(CalibratedRobots, ArePriorsWhereTheirCovarianceWasKept) {
  const Arm arm = calibrated_robot(found_by_hand(), info);
  const ArmPrior prior = arm_prior(arm);
  EXPECT_EQ(prior.name, "ours");
  EXPECT_EQ(prior.estimate.covariance, arm.estimate()->covariance);
  EXPECT_TRUE(prior.nominal.rows() == detail::ChainTable(irb120.chain.view()).rows());
  const Arm without("ours", model_in_frames(), irb120.limits, {});
  EXPECT_EQ(vernier_test::complaint([&] { (void)arm_prior(without); }),
            "ours: its model has no covariance; calibrate it again");
}

}  // namespace
}  // namespace vernier::calibrated_robot_test
