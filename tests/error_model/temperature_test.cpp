// SPDX-License-Identifier: BSD-3-Clause
// A geometry that changes with temperature: found where it was measured, and where it is none nothing is found.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "irb120_fits.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::temperature_test {
namespace {

using namespace vernier_test::irb120_fits;
using vernier_test::RealMatrix;
using Model = ErrorModel<Chain>;

/// An arm whose links get longer by 20 ppm/K, whose joint zeros move by up to 10 urad/K and whose base by 15 um/K.
Model actual_arm() {
  const Model model(robot.chain, Model::Arm(with_geometric_errors(robot.chain, {}, 4), base, tool));
  const VectorX p = ArmGeometry(model.identified().around(model.identified().chain())).parameters();
  VectorX rates = VectorX::Zero(p.size());
  for (int j = 0; j < 6; ++j) {
    rates(6 + 5 * j) = 20e-6 * p(6 + 5 * j);
    rates(6 + 5 * j + 2) = 20e-6 * p(6 + 5 * j + 2);
    rates(6 + 5 * j + 3) = 5e-6 * (j % 3 - 1);
  }
  rates(0) = 15e-6;
  rates(1) = -5e-6;
  rates(2) = 10e-6;
  return model.with_thermal({22, 10, 40, rates});
}

Dataset<6> measured(const Model& actual, Index poses, double spread, std::uint64_t seed, double mean = 22) {
  const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, poses, seed);
  Rng rng(seed);
  VectorX celsius(poses);
  PointRows positions(poses, 3), orientations(poses, 3);
  for (Index i = 0; i < poses; ++i) {
    celsius(i) = rng.uniform(mean - spread, mean + spread);
    const Isometry3 pose = actual.at_temperature(celsius(i)).pose(configuration(joints, i));
    set_point(positions, i, translation(pose));
    set_point(orientations, i, log_so3(rotation(pose)));
    for (int k = 0; k < 3; ++k) {
      positions(i, k) += 0.02e-3 * rng.normal();
      orientations(i, k) += 0.05e-3 * rng.normal();
    }
  }
  return Dataset<6>(joints, positions, orientations).without_approach().at_temperatures(celsius);
}

FittedErrorModel<Chain> fitted(const Dataset<6>& data,
                               ErrorModelOptions options = {.harmonics = 2, .num_validation_poses = 60}) {
  options.drift = false;
  return fit_error_model(identified(data), data, options, squared);
}

const BlockChoice* block_of(const FittedErrorModel<Chain>& found) {
  return choice_of(found, traits_of(Block::temperature).key);
}

double mean_error(const Model& a, const Model& b, std::uint64_t seed) {
  const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, 200, seed);
  double sum = 0;
  for (Index i = 0; i < 200; ++i) {
    const JointVector<6> q = configuration(joints, i);
    sum += (a.position(q) - b.position(q)).norm() / 200;
  }
  return sum;
}

/// Thermal unknowns, each beside that of its parameter, in steps of the expected expansion: of lengths, counted as 0.3
/// m at least, and of angles.
void expect_thermal_unknowns(const ErrorModelEstimate& found, double expansion) {
  std::vector<std::pair<Index, int>> thermal, others;
  for (const GeometricUnknown& u : found.arm.geometric()) {
    (u.thermal ? thermal : others).emplace_back(u.parameter, u.station);
    if (u.thermal) {
      const Index in_row = (u.parameter - 6) % 5;  // a alpha d theta beta
      const bool length = u.parameter < 3 || (u.parameter >= 36 && u.parameter < 39) ||
                          (u.parameter >= 6 && u.parameter < 36 && (in_row == 0 || in_row == 2));
      const double metres = found.arm.geometry(std::max(0, u.station)).parameters()(u.parameter);
      EXPECT_NEAR(u.scale, expansion * (length ? std::max(0.3, std::abs(metres)) : 1), 1e-3 * u.scale) << u.parameter;
    }
  }
  EXPECT_EQ(thermal, others);
}

TEST(Temperature, IsFoundAndServesAtEveryMeasuredOne) {
  const Model actual = actual_arm();
  const auto found = fitted(measured(actual, 250, 4, 1));
  ASSERT_TRUE(found.converged);
  ASSERT_NE(block_of(found), nullptr);
  EXPECT_TRUE(block_of(found)->used);
  EXPECT_NEAR(found.mean_temperature, 22, 0.5);
  EXPECT_NEAR(found.temperature_std, 4 / std::sqrt(3), 0.3);
  expect_thermal_unknowns(found, 2e-5);
  for (const double celsius : {18.5, 22.0, 25.5}) {
    const Model now = found.model().at_temperature(celsius), truth = actual.at_temperature(celsius);
    EXPECT_LT(mean_error(now, truth, 7), 0.02e-3) << celsius;
    EXPECT_GT(mean_error(found.model(), truth, 7), celsius == 22 ? 0 : 0.05e-3) << celsius;
  }
  // beyond what was measured it stays
  EXPECT_EQ(mean_error(found.model().at_temperature(100), found.model().at_temperature(27), 3), 0);
  // the spread of an unknown temperature is in the covariance
  const JointVector<6> q = JointVector<6>::Constant(0.3);
  const auto of_position = [](const RealMatrix& covariance) { return covariance.block(0, 0, 3, 3).trace(); };
  const double known = of_position(found.visit_covariance(q, 1, 0, VectorX(), found.mean_temperature)),
               unknown = of_position(found.visit_covariance(q, 1));
  EXPECT_GT(unknown, known + 0.5 * std::pow(mean_error(found.model(), found.model().at_temperature(22 + 2.3), 3), 2));
}

// Two places at which different things move: each frame changes in its own way.
TEST(Temperature, FramesOfTwoStationsChangeEachInItsOwnWay) {
  const Model actual = actual_arm();
  VectorX rates = actual.thermal()->parameters;
  rates(0) = -40e-6;
  rates(1) = rates(2) = 0;
  const Model other = actual.with_thermal({22, 10, 40, rates});
  const Dataset<6> first = measured(actual, 100, 4, 1), second = measured(other, 100, 4, 2);
  ErrorModelOptions options{.harmonics = 0, .hysteresis = false, .tilt = false, .drift = false};
  options.thermal_prior_std = 3e-5;
  const auto found = fit_error_model(identified(first), Measurements<6>(first).add(second), options, squared);
  ASSERT_TRUE(block_of(found)->used);
  expect_thermal_unknowns(found, 3e-5);
  for (const double celsius : {18.5, 25.5}) {
    EXPECT_LT(mean_error(found.models()[0].at_temperature(celsius), actual.at_temperature(celsius), 7), 0.03e-3);
    EXPECT_LT(mean_error(found.models()[1].at_temperature(celsius), other.at_temperature(celsius), 7), 0.03e-3);
  }
}

// A change of a few hundredths of a kelvin is one, less is the noise of a thermometer.
TEST(Temperature, IsLookedForWhereItVaried) {
  const Dataset<6> data = measured(actual_arm(), 60, 0, 2);
  for (const auto& [deviation, looked_for] : {std::pair{0.019, false}, {0.021, true}}) {
    VectorX celsius(60);
    for (Index i = 0; i < 60; ++i) celsius(i) = 22 + (i % 2 == 0 ? deviation : -deviation);
    const auto found = fitted(data.at_temperatures(celsius), {.harmonics = 0, .hysteresis = false, .tilt = false});
    EXPECT_EQ(block_of(found) != nullptr, looked_for) << deviation;
  }
}

// An earlier calibration at 18 to 26 degrees knows how the arm changes. Few poses at 31 degrees, or at none that was
// measured, inherit that; a temperature means the same as before.
TEST(Temperature, IsInherited) {
  VectorX rates = actual_arm().thermal()->parameters;
  for (Index k = 0; k < 6; ++k) rates(k) = 0;  // how a base changes is not handed on
  const Model actual = actual_arm().with_thermal({22, 10, 40, rates});
  const auto before = fitted(measured(actual, 250, 4, 1));
  const ArmPrior prior = arm_prior("before", before.model(), before.first_station());
  EXPECT_NEAR(prior.temperatures[0], 18, 0.2);
  EXPECT_NEAR(prior.temperatures[1], 26, 0.2);
  ErrorModelOptions options{.harmonics = 2, .num_validation_poses = 60};
  options.prior = &prior;
  const Dataset<6> warm = measured(actual, 12, 1, 5, 31), mild = measured(actual, 12, 0.5, 6, before.mean_temperature);
  for (const bool measured_too : {true, false}) {
    const auto found = fitted(measured_too ? warm : mild.at_temperatures({}), options);
    ASSERT_TRUE(found.prior && found.prior->used);
    EXPECT_EQ(found.mean_temperature, before.mean_temperature);
    EXPECT_EQ(found.temperature_std, before.temperature_std);
    ASSERT_NE(found.model().thermal(), nullptr);
    EXPECT_EQ(found.model().thermal()->reference, before.mean_temperature);
    EXPECT_EQ(found.model().thermal()->lower, prior.temperatures[0]);
    if (measured_too) {
      EXPECT_EQ(found.model().thermal()->upper,
                *std::max_element(warm.temperatures().begin(), warm.temperatures().end()));
    } else {
      EXPECT_EQ(found.model().thermal()->upper, prior.temperatures[1]);
    }
    for (const double celsius : {19.0, measured_too ? 31.0 : 25.0})
      EXPECT_LT(mean_error(found.model().at_temperature(celsius), actual.at_temperature(celsius), 7), 0.1e-3);
    const auto block = std::find_if(found.blocks.begin(), found.blocks.end(),
                                    [](const BlockChoice& b) { return b.block == Block::prior; });
    ASSERT_NE(block, found.blocks.end());
    EXPECT_LT(block->with, block->without);
    EXPECT_NEAR(block->precision, std::pow(found.prior->joints, -2), 1e-9);
    EXPECT_EQ(found.fallback_error, block->without);  // nothing else was found
  }
}

TEST(Temperature, NothingIsFoundWhereThereIsNothing) {
  const Model actual = actual_arm();
  const Dataset<6> varied = measured(actual, 250, 4, 2);
  EXPECT_EQ(block_of(fitted(varied.at_temperatures({}))), nullptr);
  EXPECT_EQ(block_of(fitted(varied.at_temperatures(VectorX::Constant(250, 21)))), nullptr);
  VectorX shuffled = varied.temperatures();
  std::reverse(shuffled.begin(), shuffled.end());
  const auto found = fitted(varied.at_temperatures(shuffled));
  ASSERT_NE(block_of(found), nullptr);
  EXPECT_FALSE(block_of(found)->used);
  EXPECT_EQ(found.model().thermal(), nullptr);
}

TEST(Temperature, MovesAlongWithTheArm) {
  const Model actual = actual_arm();
  const Isometry3 by = FrameParameters(Vector6{2, -1, 0.3, 0.5, -0.9, 1.4}).isometry(),
                  grip = FrameParameters(Vector6{0.01, 0.02, 0.1, 1, 0.2, -0.4}).isometry();
  const JointVector<6> zeros = JointVector<6>::Constant(0.01);
  const Model moved = actual.moved(by, zeros, grip);
  EXPECT_EQ(moved.thermal()->reference, 22);
  for (const double celsius : {15.0, 22.0, 30.0})
    EXPECT_LT(mean_error(moved.at_temperature(celsius), actual.at_temperature(celsius).moved(by, zeros, grip), 5),
              1e-8);
  EXPECT_EQ(actual.at_temperature(30).thermal()->reference, 30);
  EXPECT_LT(mean_error(actual.at_temperature(30).at_temperature(20), actual.at_temperature(20), 5), 1e-14);
}

}  // namespace
}  // namespace vernier::temperature_test
