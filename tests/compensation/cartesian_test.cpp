// SPDX-License-Identifier: BSD-3-Clause
// Cartesian compensation on simulated arms: how much better, and what stays exact.

#include <gtest/gtest.h>

#include <concepts>
#include <limits>
#include <string>
#include <vernier/compensation/cartesian.hpp>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/identification/calibrated.hpp>
#include <vernier/regression/ridge_elm.hpp>
#include <vernier/search/pso.hpp>
#include <vernier/search/tuned.hpp>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "irb120.hpp"
#include "real_matrix.hpp"

namespace cartesian_test {
namespace {

using namespace vernier;
using namespace vernier_test;

const double infinity = std::numeric_limits<double>::infinity();

Dataset<6> training(const DhChain<6>& actual, Index n = 600) {
  return measure(actual, operating_targets(n, 10), {.position = 0.02e-3, .with_orientations = false}, 1);
}

// The recipe is deduced from what it is made of, with clang 14 too.
static_assert(std::same_as<decltype(CartesianCompensation{Elm{}}), CartesianCompensation<Elm>>);
static_assert(
    std::same_as<decltype(CartesianCompensation{RidgeElm{}, CorrectionOptions{}}), CartesianCompensation<RidgeElm>>);
static_assert(
    std::same_as<decltype(CartesianCompensation{Tuned{Elm{}, Pso{}}}), CartesianCompensation<Tuned<Elm, Pso>>>);
using Fitted = decltype(CartesianCompensation{Elm{}}.fit(nominal, Dataset<6>{}));
static_assert(Compensator<Fitted> && KinematicModel<Fitted>);

TEST(CartesianCompensation, ImprovesFreshPoses) {
  const auto fresh = operating_targets(300, 99);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto actual = actual_arm(seed);
    const auto fitted = CartesianCompensation{small_elm}.fit(nominal, training(actual), {.seed = seed});
    const auto test = measure(actual, fresh);
    EXPECT_LT(prediction_error(fitted, test).mean, 0.3 * prediction_error(nominal, test).mean);
    const auto before = positioning_errors(actual, nominal, fresh, fresh);
    const auto after = positioning_errors(actual, nominal, corrected_commands(fitted, fresh), fresh);
    EXPECT_LT(after.position.mean(), 0.3 * before.position.mean());
    EXPECT_LT(after.position.maxCoeff(), 0.75 * before.position.maxCoeff());
    // orientations are the model's: neither learned nor spoiled
    EXPECT_NEAR(after.rotation.mean(), before.rotation.mean(), 0.02 * before.rotation.mean());
  }
}

TEST(CartesianCompensation, ThePapersModeMovesThreeJoints) {
  const auto actual = actual_arm();
  const auto fresh = operating_targets(200, 99);
  const auto fitted = CartesianCompensation{small_elm, {.target = CorrectionTarget::position, .moving_joints = 3}}.fit(
      nominal, training(actual), {.seed = 1});
  const auto commands = corrected_commands(fitted, fresh);
  EXPECT_TRUE(commands.rightCols<3>() == fresh.rightCols<3>());  // bit for bit
  const auto before = positioning_errors(actual, nominal, fresh, fresh);
  const auto after = positioning_errors(actual, nominal, commands, fresh);
  EXPECT_LT(after.position.mean(), 0.3 * before.position.mean());
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(fitted, fresh, {.rotation_tolerance = infinity})));
}

TEST(CartesianCompensation, SameSeedSameBits) {
  const auto data = training(actual_arm(), 100);
  const JointVector<6> q = configuration(operating_targets(1, 5), 0);
  const CartesianCompensation recipe{Elm{.hidden_nodes = 20}};
  const auto command = [&](std::uint64_t seed) {
    return RealMatrix(recipe.fit(nominal, data, {.seed = seed}).correct(q).command);
  };
  EXPECT_EQ(command(3), command(3));
  EXPECT_NE(command(3), command(4));
}

TEST(CartesianCompensation, ObeysTheLawsOfModelsAndCompensators) {
  const auto data = training(actual_arm());
  expect_laws_around_the_gate(CartesianCompensation{small_elm}.fit(nominal, data, {.seed = 1}));
  expect_laws_around_the_gate(CartesianCompensation{RidgeElm{.hidden_nodes = 40}}.fit(nominal, data, {.seed = 1}));
}

TEST(CartesianCompensation, FarOutsideTheMeasuredRangesNothingIsLearned) {
  const auto fitted = CartesianCompensation{Elm{.hidden_nodes = 20}}.fit(nominal, training(actual_arm(), 100));
  JointVector<6> q = configuration(operating_targets(1, 5), 0);
  q(0) = 2.5;  // measured: within 1.57
  EXPECT_EQ(fitted.identified().gate(q), 0);
  EXPECT_EQ(RealMatrix(fitted.pose(q)), RealMatrix(nominal.pose(q)));
  EXPECT_EQ(RealMatrix(fitted.jacobian(q)), RealMatrix(nominal.jacobian(q)));
  const auto correction = fitted.correct(q);
  EXPECT_EQ(correction.gate, 0);
  EXPECT_EQ(RealMatrix(correction.command), RealMatrix(q));
}

TEST(CartesianCompensation, AHybridKeepsTheOriginalReference) {
  const auto actual = actual_arm();
  // what an identification might have found: two thirds of every error
  const auto p = nominal.parameters(), r = actual.parameters();
  const auto known = nominal.with_parameters(p + (r - p) * (2.0 / 3));
  const Compensated geometry(known, nominal);
  const auto hybrid = CartesianCompensation{small_elm}.fit(geometry, training(actual), {.seed = 1});
  static_assert(std::same_as<std::remove_cvref_t<decltype(hybrid.nominal())>, DhChain<6>>);
  EXPECT_TRUE(hybrid.nominal() == nominal);
  const auto again = CartesianCompensation{small_elm}.fit(hybrid, training(actual), {.seed = 2});
  EXPECT_TRUE(again.nominal() == nominal);

  const auto fresh = operating_targets(200, 99);
  EXPECT_LT(mean_error(actual, hybrid, fresh), 0.35 * mean_error(actual, geometry, fresh));
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(hybrid, fresh)));

  // and in identified frames: the nominal arm there
  const Isometry3 base = rigid_motion(Matrix3::Identity(), Vector3(0.5, -0.25, 0.125));
  const Calibrated<DhChain<6>> calibrated(Framed<DhChain<6>>(known, base), nominal);
  const auto data = measure(Framed<DhChain<6>>(actual, base), operating_targets(300, 4));
  const auto framed = CartesianCompensation{small_elm}.fit(calibrated, data);
  const JointVector<6> q = configuration(fresh, 0);
  EXPECT_EQ(RealMatrix(framed.nominal().pose(q)), RealMatrix(base) * nominal.pose(q));
}

TEST(CartesianCompensation, DoesNotAllocateOrThrow) {
  const auto fitted = CartesianCompensation{small_elm}.fit(nominal, training(actual_arm()), {.seed = 1});
  const JointVector<6> inside = configuration(operating_targets(1, 5), 0);
  JointVector<6> edge = inside;
  edge(0) = abb_irb120_operating_region().limits.upper(0) + 0.1;  // the gate falls
  static_assert(
      noexcept(fitted.correct(inside))&& noexcept(fitted.pose(inside))&& noexcept(fitted.pose_and_jacobian(inside)));
  for (const JointVector<6>& q : {inside, edge})
    EXPECT_EQ(vernier_test::allocations([&] {
                vernier_test::keep(fitted.correct(q));
                vernier_test::keep(fitted.predict(q));
                vernier_test::keep(fitted.position(q));
                vernier_test::keep(fitted.pose_and_jacobian(q));
              }),
              0);
}

TEST(CartesianCompensation, DataInAnotherFrameAreRefused) {
  const auto data = training(actual_arm(), 50);
  const auto shifted = [&](double by) {
    PointRows p = data.positions();
    for (Index i = 0; i < p.rows(); ++i) p(i, 0) += by;
    return Dataset<6>(data.joints(), p);
  };
  const CartesianCompensation recipe{Elm{.hidden_nodes = 5}};
  const auto said = complaint([&] { (void)recipe.fit(nominal, shifted(0.06)); });
  EXPECT_NE(said.find("register"), std::string::npos) << said;
  EXPECT_NE(said.find("61.1"), std::string::npos) << said;  // mm apart
  EXPECT_EQ(complaint([&] { (void)recipe.fit(nominal, shifted(0.04)); }), "");
}

TEST(CartesianCompensation, OneSampleIsEnough) {
  EXPECT_EQ(complaint([] { (void)CartesianCompensation{Elm{.hidden_nodes = 5}}.fit(nominal, training(nominal, 1)); }),
            "");
}

TEST(CartesianCompensation, MisuseIsNamed) {
  EXPECT_NE(complaint([] { (void)CartesianCompensation{Elm{}}.fit(nominal, Dataset<6>{}); }).find("no samples"),
            std::string::npos);
  const auto data = training(actual_arm(), 10);
  EXPECT_NE(complaint([&] {
              (void)CartesianCompensation{Elm{.hidden_nodes = 0}}.fit(nominal, data);
            }).find("hidden_nodes is 0"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              (void)CartesianCompensation{Elm{.hidden_nodes = 5}, {.moving_joints = 9}}.fit(nominal, data);
            }).find("moving_joints is 9"),
            std::string::npos);
}

}  // namespace
}  // namespace cartesian_test
