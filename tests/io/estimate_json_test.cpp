// SPDX-License-Identifier: BSD-3-Clause
// What a calibration estimated, in a model file.

#include "vernier/io/detail/estimate_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "real_matrix.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::estimate_json_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

const Robot<6> robot = robots::abb_irb120();
using Model = CalibratedRobot<6>::Model;

/// A robot with an estimate of some orders at each joint; its covariance has correlations everywhere.
CalibratedRobot<6> example(int orders) {
  JointTerms terms(6);
  terms.gravity.emplace(robot.chain);
  for (Fourier& of_joint : terms.transmission) of_joint = Fourier::up_to(orders);
  Rng rng(3);
  VectorX coefficients(terms.size());
  for (double& c : coefficients) c = 1e-4 * rng.normal();
  const Model::Arm arm({robot.chain, JointErrors(terms, coefficients)});
  const Model model = Model(robot.chain, arm).with_thermal({21, 19, 23, VectorX::LinSpaced(42, -1e-5, 1e-5)});
  std::vector<GeometricUnknown> unknowns{{0, -1, 1e-2, 0}, {9, -1, 1e-3, 1. / 900}, {13, -1, 2e-3, 4}};
  unknowns.push_back({13, -1, 1e-4, 1, true});
  ErrorModelEstimate estimate{
      .arm = detail::parameterised(FittedArm::of(model.identified()), unknowns, VectorX::Constant(terms.size(), 2e-4),
                                   VectorX::Constant(terms.size(), 0.25), model.thermal()->parameters)};
  const Index n = estimate.arm.size();
  RealMatrix few(n, 5);
  for (Index j = 0; j < 5; ++j)
    for (Index i = 0; i < n; ++i) few(i, j) = rng.normal();
  estimate.covariance = few * few.transpose();
  for (Index k = 0; k < n; ++k) estimate.covariance(k, k) += 0.1 + rng.uniform();
  estimate.position_sigma = 2e-5;
  estimate.joint_sigma = 3e-5;
  estimate.orientation_sigma = 5e-5;
  estimate.fallback_error = 1e-4;
  estimate.mean_temperature = 21;
  estimate.temperature_std = 1.5;
  estimate.variance_factor = 3;
  estimate.residual_variance = 2.5;
  return CalibratedRobot<6>("an arm", model, robot.limits, {}).with_estimate(estimate);
}

TEST(EstimateJson, KeepsTheCovarianceInSinglePrecision) {
  const vernier_test::TemporaryFolder folder("estimate");
  const auto saved = example(5);
  save(folder / "m.json", saved);
  const auto loaded = load<6>(folder / "m.json");
  ASSERT_NE(loaded.estimate(), nullptr);
  const ErrorModelEstimate &a = *saved.estimate(), &b = *loaded.estimate();
  ASSERT_EQ(b.arm.names(), a.arm.names());
  EXPECT_LT((b.arm.scales() - a.arm.scales()).norm(), 1e-15);
  EXPECT_LT((b.arm.precisions() - a.arm.precisions()).norm(), 1e-12);
  EXPECT_LT(difference(b.covariance, a.covariance), 1e-5 * RealMatrix(a.covariance).diagonal().largest());
  const auto last_70 = [](const RealMatrix& column) { return column.block(column.rows() - 70, 0, 70, 1); };
  EXPECT_LT((last_70(b.arm.steps()) - last_70(a.arm.steps())).norm(), 1e-12);
  EXPECT_EQ(b.arm.thermal_rates(0)(13), saved.model().thermal()->parameters(13));
  EXPECT_EQ(b.position_sigma, a.position_sigma);
  EXPECT_EQ(b.joint_sigma, a.joint_sigma);
  EXPECT_EQ(b.orientation_sigma, a.orientation_sigma);
  EXPECT_EQ(b.fallback_error, a.fallback_error);
  EXPECT_EQ(b.mean_temperature, a.mean_temperature);
  EXPECT_EQ(b.temperature_std, a.temperature_std);
  EXPECT_EQ(b.variance_factor, a.variance_factor);
  EXPECT_EQ(b.residual_variance, a.residual_variance);
  const JointRows<6> samples = sample_joints(robot.limits, 20, 9);
  for (Index i = 0; i < samples.rows(); ++i) {
    const VectorX q = configuration(samples, i);
    const RealMatrix now = b.visit_covariance(q, 0.5), then = a.visit_covariance(q, 0.5);
    EXPECT_LT((now - then).norm(), 1e-5 * then.norm());
  }
}

// Each command comes from the one before it; a row that is not finite has no radius, and the next one no known
// approach.
TEST(EstimateJson, RadiiOfCommandsFollowFromTheCovariance) {
  const auto arm = example(5);
  JointRows<6> commands = sample_joints(robot.limits, 140, 9);
  commands(70, 3) = std::nan("");
  const std::vector<double> radii = arm.radii_95(commands);
  ASSERT_EQ(radii.size(), 140u);
  for (const Index i : {0, 1, 63, 64, 69, 71, 139}) {
    const bool follows = i != 0 && i != 71;
    const JointVector<6> q = configuration(commands, i),
                         previous = follows ? configuration(commands, i - 1) : JointVector<6>::Constant(std::nan(""));
    const Matrix6 covariance = arm.estimate()->visit_covariance(q, arm.gate(q), 0, previous, 21);
    const double expected = radius_95(covariance.topLeftCorner<3, 3>());
    EXPECT_NEAR(radii[static_cast<std::size_t>(i)], expected, 1e-12 * expected) << i;
  }
  EXPECT_TRUE(std::isnan(radii[70]));

  const CalibratedRobot<6> without("an arm", arm.model(), robot.limits, {});
  EXPECT_THROW((void)without.radii_95(commands), std::invalid_argument);
}

// The files of arms with thousands of unknowns are below 10 MB; what is left out are correlations of the highest
// orders.
TEST(EstimateJson, LargeOnesAreThinned) {
  const vernier_test::TemporaryFolder folder("estimate");
  const auto saved = example(180);
  save(folder / "m.json", saved);
  EXPECT_LT(std::filesystem::file_size(folder / "m.json"), 10'000'000u);
  const auto loaded = load<6>(folder / "m.json");
  const ErrorModelEstimate &a = *saved.estimate(), &b = *loaded.estimate();
  const RealMatrix variances = RealMatrix(a.covariance).diagonal();
  const double largest = variances.largest();
  EXPECT_LT(difference(RealMatrix(b.covariance).diagonal(), variances), 1e-5 * largest);
  const std::vector<std::string> names = a.arm.names();
  const auto index = [&](const char* name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
  EXPECT_NEAR(b.covariance(index("cos1_2"), index("sin6_130")), a.covariance(index("cos1_2"), index("sin6_130")),
              1e-5 * largest);
  EXPECT_EQ(b.covariance(index("cos1_2"), index("sin6_180")), 0);
  EXPECT_NE(a.covariance(index("cos1_2"), index("sin6_180")), 0);
}

// RFC 4648; 1.0f is 00 00 80 3f in little endian.
TEST(Base64WhiteBox, ByHand) {
  EXPECT_EQ(detail::base64_of({1.0f}), "AACAPw==");
  EXPECT_EQ(detail::base64_of({1.0f, -2.0f}), "AACAPwAAAMA=");
  EXPECT_EQ(detail::base64_of({1.0f, -2.0f, 0.0f}), "AACAPwAAAMAAAAAA");
  EXPECT_EQ(detail::floats_of("AACAPwAAAMA="), (std::vector<float>{1.0f, -2.0f}));
  EXPECT_EQ(detail::floats_of("AACAPwAAAMAAAAAA"), (std::vector<float>{1.0f, -2.0f, 0.0f}));
  for (const char* bad : {"AACAPw=", "AACAPw", "AACA", "AAC*Pw==", "AACAPw==AACA", "===="})
    EXPECT_TRUE(detail::floats_of(bad).empty()) << bad;
}

// An arm in other frames and with other joint zeros is as certain as before.
TEST(ErrorModelEstimate, StaysWithAnArmThatMoves) {
  const auto robot_before = example(3);
  const Isometry3 motion = rigid_motion(exp_so3(0.8 / std::sqrt(14) * Vector3(1, 2, 3)), Vector3(1, -2, 0.5));
  const auto moved = robot_before.with_model(
      robot_before.model().moved(motion, JointVector<6>::Zero(), Isometry3::Identity()), robot_before.provenance());
  ASSERT_NE(moved.estimate(), nullptr);
  const JointVector<6> q = JointVector<6>::Constant(0.3);
  const auto of_position = [&](const auto& arm) -> Matrix3 {
    return arm.estimate()->visit_covariance(q, 1).template topLeftCorner<3, 3>();
  };
  const RealMatrix before = of_position(robot_before), after = of_position(moved);
  // the base's unknown is along x of the measurements, before and after
  EXPECT_NEAR(after.trace(), before.trace(), 0.2 * before.trace());
  EXPECT_GT((after - before).norm(), 1e-3 * before.norm());
}

}  // namespace
}  // namespace vernier::estimate_json_test
