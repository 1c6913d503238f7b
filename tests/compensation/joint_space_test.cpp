// SPDX-License-Identifier: BSD-3-Clause
// Joint-space compensation: labels and their signs, the paper's command, and the same as a kinematic model.

#include <gtest/gtest.h>

#include <cmath>
#include <concepts>
#include <numbers>
#include <string>
#include <vernier/compensation/cartesian.hpp>
#include <vernier/compensation/joint_space.hpp>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/regression/ridge_elm.hpp>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "irb120.hpp"
#include "real_matrix.hpp"

namespace joint_space_test {
namespace {

using namespace vernier;
using namespace vernier_test;

Dataset<6> training(const DhChain<6>& actual, Index n = 600) {
  return measure(actual, operating_targets(n, 10), {.position = 0.02e-3, .orientation = 0.05e-3}, 1);
}

static_assert(std::same_as<decltype(JointCompensation{Elm{}}), JointCompensation<Elm>>);
static_assert(std::same_as<decltype(JointCompensation{RidgeElm{}, CorrectionOptions{}}), JointCompensation<RidgeElm>>);
using FromData = decltype(JointCompensation{Elm{}}.fit(nominal, Dataset<6>{}));
using FromLabels = decltype(JointCompensation{Elm{}}.fit(nominal, JointErrorLabels<6>{}));
static_assert(Compensator<FromData> && KinematicModel<FromData>);
static_assert(Compensator<FromLabels> && !KinematicModel<FromLabels>);

TEST(JointErrorLabels, ThePapersLabelsAreTargetMinusCommand) {
  const auto actual = actual_arm();
  const auto targets = operating_targets(100, 3);
  const auto labels = joint_error_labels(nominal, actual, targets);
  EXPECT_EQ(labels.failed, 0);
  ASSERT_TRUE(labels.joints == targets);
  for (Index i = 0; i < 100; ++i) {
    const JointVector<6> q = configuration(targets, i), command = q - configuration(labels.errors, i);
    EXPECT_LT(pose_difference(nominal.pose(q), actual.pose(command)).norm(), 2e-9);
  }
}

TEST(JointErrorLabels, FromDataAreEffectiveMinusCommanded) {
  const auto data = measure(actual_arm(), operating_targets(100, 3));
  const auto labels = joint_error_labels(nominal, data);
  EXPECT_EQ(labels.failed, 0);
  for (Index i = 0; i < 100; ++i) {
    const JointVector<6> effective = data.joints(i) + configuration(labels.errors, i);
    EXPECT_LT(pose_difference(data.pose(i), nominal.pose(effective)).norm(), 2e-9);
  }
}

TEST(JointErrorLabels, WhatCannotBeReachedIsLeftOut) {
  const auto whole = measure(actual_arm(), operating_targets(10, 3));
  PointRows p = whole.positions();
  set_point(p, 4, Vector3(5, 0, 0));
  set_point(p, 7, Vector3(0, 0, -9));
  const auto labels = joint_error_labels(nominal, Dataset<6>(whole.joints(), p, whole.orientations()));
  EXPECT_EQ(labels.failed, 2);
  ASSERT_EQ(labels.joints.rows(), 8);
  ASSERT_EQ(labels.errors.rows(), 8);
  const RealMatrix kept = labels.joints, all = whole.joints();
  EXPECT_EQ(kept.row(4), all.row(5));
  EXPECT_EQ(kept.row(7), all.row(9));
  EXPECT_TRUE(labels.errors.allFinite());
}

TEST(JointCompensation, ImprovesFreshPoses) {
  const auto fresh = operating_targets(300, 99);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto actual = actual_arm(seed);
    const auto before = positioning_errors(actual, nominal, fresh, fresh);
    const auto check = [&](const auto& compensator) {
      const auto after = positioning_errors(actual, nominal, corrected_commands(compensator, fresh), fresh);
      EXPECT_LT(after.position.mean(), 0.45 * before.position.mean());
      EXPECT_LT(after.rotation.mean(), 0.65 * before.rotation.mean());  // learned too, unlike in Cartesian space
    };
    check(JointCompensation{small_elm}.fit(nominal, joint_error_labels(nominal, actual, operating_targets(600, 10)),
                                           {.seed = seed}));
    const auto from_data = JointCompensation{small_elm}.fit(nominal, training(actual), {.seed = seed});
    check(from_data);
    const auto test = measure(actual, fresh);
    EXPECT_LT(prediction_error(from_data, test).mean, 0.45 * prediction_error(nominal, test).mean);
  }
}

TEST(JointCompensation, ObeysTheLawsOfModelsAndCompensators) {
  expect_laws_around_the_gate(JointCompensation{small_elm}.fit(nominal, training(actual_arm()), {.seed = 1}));
}

TEST(JointCompensation, AHybridKeepsTheOriginalReference) {
  const auto actual = actual_arm();
  const auto p = nominal.parameters(), r = actual.parameters();
  const Compensated geometry(nominal.with_parameters(p + (r - p) * (2.0 / 3)), nominal);
  const auto hybrid = JointCompensation{small_elm}.fit(geometry, training(actual), {.seed = 1});
  static_assert(std::same_as<std::remove_cvref_t<decltype(hybrid.nominal())>, DhChain<6>>);
  EXPECT_TRUE(hybrid.nominal() == nominal);
  const auto fresh = operating_targets(200, 99);
  EXPECT_LT(mean_error(actual, hybrid, fresh), 0.5 * mean_error(actual, geometry, fresh));
}

TEST(DirectJointCompensator, TheCommandIsTargetMinusLearned) {
  const auto actual = actual_arm();
  const auto fitted = JointCompensation{Elm{.hidden_nodes = 30}}.fit(
      nominal, joint_error_labels(nominal, actual, operating_targets(300, 10)), {.seed = 1});
  const auto targets = operating_targets(100, 11);
  int inside = 0;
  for (Index i = 0; i < targets.rows(); ++i) {
    const JointVector<6> q = configuration(targets, i);
    const auto correction = fitted.correct(q);
    EXPECT_EQ(correction.status, IkStatus::converged);
    if (correction.gate != 1) continue;
    ++inside;
    const JointVector<6> command = q - fitted.learned().predict(q);
    EXPECT_EQ(RealMatrix(correction.command), RealMatrix(command));  // bit for bit
  }
  EXPECT_GT(inside, 80);
  // far outside the measured ranges nothing is learned
  JointVector<6> far = configuration(targets, 0);
  far(0) = 2.5;
  EXPECT_EQ(RealMatrix(fitted.correct(far).command), RealMatrix(far));
  EXPECT_EQ(fitted.correct(far).gate, 0);
  EXPECT_EQ(RealMatrix(fitted.predict(far)), RealMatrix(nominal.pose(far)));
}

TEST(DirectJointCompensator, ObeysTheLaws) {
  const auto fitted = JointCompensation{small_elm}.fit(
      nominal, joint_error_labels(nominal, actual_arm(), operating_targets(600, 10)), {.seed = 1});
  // one step, to first order in an error of millimetres and milliradians: what is left is of second order
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(
      fitted, nominal, operating_targets(100, 7), {.position_tolerance = 0.2e-3, .rotation_tolerance = 0.5e-3})));
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(fitted, operating_targets(100, 7))));
}

TEST(JointCompensation, DoesNotAllocateOrThrow) {
  const auto from_data = JointCompensation{small_elm}.fit(nominal, training(actual_arm()), {.seed = 1});
  const auto direct = JointCompensation{small_elm}.fit(
      nominal, joint_error_labels(nominal, actual_arm(), operating_targets(200, 10)), {.seed = 1});
  const JointVector<6> inside = configuration(operating_targets(1, 5), 0);
  JointVector<6> edge = inside;
  edge(0) = abb_irb120_operating_region().limits.upper(0) + 0.1;  // the gate falls
  static_assert(
      noexcept(from_data.correct(inside))&& noexcept(direct.correct(inside))&& noexcept(direct.predict(inside)));
  for (const JointVector<6>& q : {inside, edge})
    EXPECT_EQ(vernier_test::allocations([&] {
                vernier_test::keep(from_data.correct(q));
                vernier_test::keep(from_data.pose_and_jacobian(q));
                vernier_test::keep(direct.correct(q));
                vernier_test::keep(direct.predict(q));
              }),
              0);
}

TEST(JointCompensation, NeedsOrientations) {
  const auto whole = training(actual_arm(), 20);
  const Dataset<6> positions_only(whole.joints(), whole.positions());
  const JointCompensation recipe{Elm{.hidden_nodes = 5}};
  const auto said = complaint([&] { (void)recipe.fit(nominal, positions_only); });
  EXPECT_NE(said.find("positions only"), std::string::npos) << said;
  EXPECT_EQ(complaint([&] { (void)recipe.fit(nominal, whole); }), "");
}

TEST(JointCompensation, DataInAnotherFrameAreRefused) {
  const auto whole = training(actual_arm(), 20);
  PointRows p = whole.positions();
  for (Index i = 0; i < p.rows(); ++i) p(i, 2) -= 0.07;
  const auto said = complaint([&] {
    (void)JointCompensation{Elm{.hidden_nodes = 5}}.fit(nominal, Dataset<6>(whole.joints(), p, whole.orientations()));
  });
  EXPECT_NE(said.find("register"), std::string::npos) << said;
}

TEST(JointCompensation, OneLabelIsEnough) {
  const JointCompensation recipe{Elm{.hidden_nodes = 5}};
  EXPECT_EQ(complaint([&] { (void)recipe.fit(nominal, training(nominal, 1)); }), "");
  const auto label = joint_error_labels(nominal, actual_arm(), operating_targets(1, 3));
  EXPECT_EQ(complaint([&] { (void)recipe.fit(nominal, label); }), "");
}

TEST(JointCompensation, NothingToLearnFromIsNamed) {
  const JointCompensation recipe{Elm{.hidden_nodes = 5}};
  EXPECT_NE(complaint([&] { (void)recipe.fit(nominal, Dataset<6>{}); }).find("no samples"), std::string::npos);
  EXPECT_NE(complaint([&] {
              (void)recipe.fit(nominal, JointErrorLabels<6>{JointRows<6>(0, 6), JointRows<6>(0, 6)});
            }).find("no labels"),
            std::string::npos);
  // the stretched arm, measured 20 mm further out than it can reach
  JointVector<6> stretched = JointVector<6>::Zero();
  stretched(1) = 1.2;
  stretched(2) = -std::numbers::pi / 2 + std::atan2(70.0, 302.0);
  const Isometry3 pose = nominal.pose(stretched);
  const Vector3 shoulder(0, 0, 0.29);
  const Vector3 out = (translation(pose) - shoulder).normalized();
  JointRows<6> joints(1, 6);
  PointRows position(1, 3), orientation(1, 3);
  set_configuration(joints, 0, stretched);
  set_point(position, 0, translation(pose) + 0.02 * out);
  set_point(orientation, 0, log_so3(rotation(pose)));
  const Dataset<6> beyond(joints, position, orientation);
  EXPECT_NE(complaint([&] { (void)recipe.fit(nominal, beyond); }).find("failed for all 1 poses"), std::string::npos);
}

}  // namespace
}  // namespace joint_space_test
