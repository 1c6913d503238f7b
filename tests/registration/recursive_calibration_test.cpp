// SPDX-License-Identifier: BSD-3-Clause
// An arm that drifts, followed pose by pose.

#include "vernier/registration/recursive_calibration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "complaint.hpp"
#include "irb120_models.hpp"
#include "larger.hpp"
#include "real_matrix.hpp"
#include "registrations.hpp"

namespace vernier::recursive_calibration_test {
namespace {

using namespace vernier_test::irb120_models;
using vernier_test::complaint;
using vernier_test::mentions;
using vernier_test::RealMatrix;
using vernier_test::vector;

TEST(RecursiveCalibration, FollowsADriftingBase) {
  // Forgetting f weighs a pose that is k old by f^k: their mean age is f / (1 - f) = 19 poses, so a base that drifts by
  // 1 um a pose is believed to stand 19 um behind. Poses differ in what they tell, so ages differ by direction: by
  // less than a third.
  constexpr double drift = 1e-6, forgetting = 0.95, lag = drift * forgetting / (1 - forgetting);
  const Model model = fitted();
  RecursiveCalibration<Chain> poses(model, {}, {}, forgetting), positions(model, {}, {}, forgetting);
  const JointRows<6> joints = samples(400, 20);
  double mean = 0, worst_pose = 0, worst_position = 0;
  for (Index i = 0; i < 400; ++i) {
    const Joints q = configuration(joints, i);
    const Vector3 drifted = drift * static_cast<double>(i) / 3 * Vector3(2, -1, 2);
    const Isometry3 seen = composed(rigid_motion(rotation(still), drifted), model.pose(q));
    const Vector3 position = translation(seen);
    poses.update(q, seen);
    positions.update(q, position);
    if (i < 200) continue;
    const double behind = (poses.model().position(q) - position).norm();
    mean += behind / 200;
    worst_pose = vernier_test::larger(worst_pose, behind);
    worst_position = vernier_test::larger(worst_position, (positions.model().position(q) - position).norm());
  }
  EXPECT_NEAR(mean, lag, 0.1 * lag);
  EXPECT_LT(worst_pose, 1.3 * lag);
  EXPECT_LT(worst_position, 1.3 * lag);
}

TEST(RecursiveCalibration, WithoutForgettingIsLeastSquares) {
  // changes so small that the arm is linear in them, sensors as good
  constexpr double size = 2e-8;
  const ReregisterOptions options{.tool = true, .offsets = true, .offset_prior_std = size};
  const SensorModel precise{.position_sigma = 0.1 * size, .orientation_sigma = 0.3 * size};
  const Model model = rigid();
  Rng rng(21);
  RealMatrix injected(18, 1);
  for (Index k = 0; k < 18; ++k) injected(k) = size * rng.normal();
  const Model truth = changed(model, injected);
  const MeasurementNoise noise{.position = precise.position_sigma, .orientation = precise.orientation_sigma};
  const auto data = measure(truth, samples(30, 22), noise, 23);

  RealMatrix information(18, 18), gradient(18, 1);
  for (Index k = 0; k < 18; ++k) {
    const bool zero = 6 <= k && k < 12, position = k % 6 < 3;
    const double deviation = zero ? size : position ? 4 * size : 2 * size;
    information(k, k) = 1 / (deviation * deviation);
  }
  RecursiveCalibration<Chain> online(model, options, precise, 1, {4 * size, 2 * size});
  const double p = 1 / precise.position_sigma, o = 1 / precise.orientation_sigma;
  const RealMatrix weights = RealMatrix::diagonal(vector({p, p, p, o, o, o}));
  for (Index i = 0; i < data.size(); ++i) {
    const bool oriented = i % 3 != 0;  // both kinds of update
    const Index rows = oriented ? 6 : 3;
    const Vector6 error = pose_difference(data.pose(i), model.pose(data.joints(i)));
    const RealMatrix effect = (weights * effect_of_changes(model, data.joints(i))).block(0, 0, rows, 18),
                     residual = (weights * error).block(0, 0, rows, 1);
    information += effect.transpose() * effect;
    gradient += effect.transpose() * residual;
    if (oriented)
      online.update(data.joints(i), data.pose(i));
    else
      online.update(data.joints(i), data.position(i));
  }
  const RealMatrix batch = information.solve_by_cholesky(gradient);
  EXPECT_LT((change(model, online.model()) - batch).norm(), 1e-6 * batch.norm());
  EXPECT_GT((batch - injected).norm(), 1e-3 * batch.norm());  // noise is in it
  const RealMatrix covariance = information.solve_by_cholesky(RealMatrix::identity(18));
  EXPECT_LT((online.covariance() - covariance).norm(), 1e-6 * covariance.norm());
}

TEST(RecursiveCalibration, ForgetsNoMoreThanItKnewAtTheStart) {
  const Model model = fitted();
  const Joints q = configuration(samples(1, 24), 0);
  RecursiveCalibration<Chain> online(model, {.tool = true, .offsets = true}, {}, 0.98);
  const RealMatrix start = RealMatrix(online.covariance()).diagonal();
  const Vector3 position = model.position(q);
  Rng rng(25);
  for (int i = 0; i < 2000; ++i) {
    Vector3 noise;
    for (double& x : noise) x = 0.03e-3 * rng.normal();
    online.update(q, Vector3(position + noise));
    const RealMatrix p = online.covariance();
    for (Index k = 0; k < 18; ++k) ASSERT_LE(p(k, k), start(k) * (1 + 1e-12)) << i;
    ASSERT_EQ(p, p.transpose());
    if (i % 100 != 99) continue;
    ASSERT_GT(p.symmetric_eigenvalues()(0), 0) << i;
  }
  // what a single position does not tell is as little known as before
  EXPECT_GT(RealMatrix(online.covariance()).diagonal().over(start).largest(), 0.5);
}

TEST(RecursiveCalibration, DoesNotWanderWhereNothingIsExcited) {
  const Model model = rigid();
  RecursiveCalibration<Chain> online(model, {.base = true, .tool = true, .offsets = true}, {}, 0.98);
  const JointRows<6> joints = samples(50, 3);
  const Joints q = configuration(joints, 0);
  Rng rng(4);
  for (int i = 0; i < 2000; ++i) {  // an arm that stands still, seen with noise
    const Vector3 noise = 0.03e-3 * Vector3(rng.normal(), rng.normal(), rng.normal());
    online.update(q, Vector3(model.position(q) + noise));
  }
  double worst = 0;
  for (Index i = 0; i < joints.rows(); ++i) {
    const Joints other = configuration(joints, i);
    worst = vernier_test::larger(worst, (online.model().position(other) - model.position(other)).norm());
  }
  EXPECT_LT(worst, 0.3e-3);
  EXPECT_THROW(online.update(q, Vector3(0, std::numeric_limits<double>::quiet_NaN(), 0)), std::invalid_argument);
}

TEST(RecursiveCalibration, MisuseThrows) {
  const Model model = rigid();
  const auto with = [&](const ReregisterOptions& o, double forgetting, std::array<double, 2> sizes) {
    return complaint([&] { RecursiveCalibration<Chain>(model, o, {}, forgetting, sizes); });
  };
  EXPECT_TRUE(mentions(with({}, 0, {1, 1}), "forgetting is 0,"));
  EXPECT_TRUE(mentions(with({}, 1.5, {1, 1}), "forgetting is 1.5"));
  EXPECT_TRUE(mentions(with({}, std::numeric_limits<double>::quiet_NaN(), {1, 1}), "forgetting is nan"));
  EXPECT_TRUE(mentions(with({}, 1, {0, 1}), "initial standard deviations"));
  EXPECT_TRUE(mentions(with({}, 1, {1, -1}), "initial standard deviations"));
  EXPECT_TRUE(mentions(with({}, 1, {1, 0}), "initial standard deviations"));
  EXPECT_TRUE(mentions(with({.base = false}, 1, {1, 1}), "nothing is to be estimated"));
  EXPECT_EQ(with({}, 1, {1, 1}), "");
}

}  // namespace
}  // namespace vernier::recursive_calibration_test
