// SPDX-License-Identifier: BSD-3-Clause
// What a fit does with its input and its options: stations in their places, blocks that are allowed, directions, sizes,
// priors that a search chooses.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "irb120_fits.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::fit_choices_test {
namespace {

using namespace vernier_test::irb120_fits;
using vernier_test::RealMatrix;
using Actual = Framed<WithJointErrors<Chain>>;

const SensorModel sensors{.position_sigma = 0.02e-3, .orientation_sigma = 0.1e-3, .loss = Loss::squared};
const ErrorModelOptions geometry_alone{
    .compliance = false, .harmonics = 0, .hysteresis = false, .tilt = false, .drift = false};

Dataset<6> measured(const Actual& actual, Index poses, std::uint64_t seed) {
  return measure(actual, sample_joints(robot.limits, poses, seed),
                 {.position = sensors.position_sigma, .orientation = sensors.orientation_sigma}, seed)
      .without_approach();
}

FittedErrorModel<Chain> fitted(const Dataset<6>& data, const ErrorModelOptions& options, PriorSearch search = {}) {
  return fit_error_model(identified(data, sensors), data, options, sensors, search);
}

std::vector<std::string> block_names(const FittedErrorModel<Chain>& found) {
  std::vector<std::string> out;
  for (const BlockChoice& block : found.blocks) out.push_back(traits_of(block.block).key);
  return out;
}

const BlockChoice& block_of(const FittedErrorModel<Chain>& found, const std::string& name) {
  if (const BlockChoice* choice = choice_of(found, name)) return *choice;
  static const BlockChoice none;
  ADD_FAILURE() << "no block " << name;
  return none;
}

double mean_error(const ErrorModel<Chain>& model, const Actual& actual) {
  const JointRows<6> joints = sample_joints(robot.limits, 100, 77);
  double sum = 0;
  for (Index i = 0; i < 100; ++i) {
    const JointVector<6> q = configuration(joints, i);
    sum += (model.position(q) - actual.position(q)).norm() / 100;
  }
  return sum;
}

// Each station sees the same arm from a place of its own, far from what the identification of the first knows; a wire's
// end is anywhere. A tool is shared, unless it may not be.
TEST(FitStations, SeeOneArmFromTheirPlaces) {
  const Chain chain = with_geometric_errors(robot.chain, {}, 4);
  const FrameParameters there(Vector6{-3, 2, 0.7, 1.2, 0.4, -2});
  const Actual first(WithJointErrors<Chain>(chain), base, tool), second(WithJointErrors<Chain>(chain), there, tool),
      regripped(WithJointErrors<Chain>(chain), there, FrameParameters(Vector6{0.05, -0.05, 0.09, 0.2, -0.1, 0.5}));
  const Dataset<6> data = measured(first, 40, 1);
  const Actual in_its_base(WithJointErrors<Chain>(chain), {}, tool);
  const Distances<6> wire =
      measure_distances(in_its_base, Vector3(0.9, -1.2, 0.3), sample_joints(robot.limits, 40, 3), 0.02e-3, 3);
  const auto start = identified(data, sensors);
  const auto fit = [&](const Actual& other, bool tools) {
    ErrorModelOptions options = geometry_alone;
    options.tool_per_station = tools;
    return fit_error_model(start, Measurements<6>(data).add(measured(other, 40, 2)).add(wire), options, sensors);
  };
  const auto parameters = [](const FittedErrorModel<Chain>& found, int station) {
    std::vector<Index> out;
    for (const GeometricUnknown& u : found.arm.geometric())
      if (u.station == station) out.push_back(u.parameter);
    return out;
  };
  const auto shared = fit(second, false), apart = fit(regripped, true), wrong = fit(regripped, false);
  ASSERT_TRUE(shared.converged && apart.converged);
  EXPECT_LT(mean_error(shared.models()[0], first), 0.03e-3);
  EXPECT_LT(mean_error(shared.models()[1], second), 0.03e-3);
  EXPECT_LT(mean_error(apart.models()[0], first), 0.03e-3);
  EXPECT_LT(mean_error(apart.models()[1], regripped), 0.03e-3);
  EXPECT_GT(mean_error(wrong.models()[1], regripped), 1e-3);
  const std::vector<Index> frame{0, 1, 2, 3, 4, 5}, both{0, 1, 2, 3, 4, 5, 36, 37, 38, 39, 40, 41};
  EXPECT_EQ(parameters(shared, 0), frame);
  EXPECT_EQ(parameters(shared, 1), frame);
  EXPECT_EQ(parameters(shared, 2), (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(parameters(apart, 1), both);
  EXPECT_EQ(parameters(apart, 2).size(), 9u);  // a tool and a position
  // of the wire the length is predicted, whatever its frame is turned by
  const JointRows<6> elsewhere = sample_joints(robot.limits, 20, 9);
  for (Index i = 0; i < 20; ++i) {
    const JointVector<6> q = configuration(elsewhere, i);
    EXPECT_NEAR(shared.models()[2].position(q).norm(), (in_its_base.position(q) - Vector3(0.9, -1.2, 0.3)).norm(),
                0.06e-3);
  }
}

// A chain's unknown that the identification held by a prior keeps its width, relative to the residuals; others are held
// at thirty expected sizes, frames not at all.
TEST(FitStations, ChainsHavePriorsOfTheIdentification) {
  const Actual actual(WithJointErrors<Chain>(with_geometric_errors(robot.chain, {}, 4)), base, tool);
  const Dataset<6> data = measured(actual, 30, 5);
  auto start = identified(data, sensors);
  std::vector<Index> of_chain;
  for (const Index k : start.free)
    if (k >= 6 && k < 36) of_chain.push_back(k);
  ASSERT_GE(of_chain.size(), 2u);
  const Index held = of_chain[0], free = of_chain[1];
  start.parameters[static_cast<std::size_t>(held)].prior_std =
      2.5 * start.parameters[static_cast<std::size_t>(held)].scale;
  start.parameters[static_cast<std::size_t>(free)].prior_std = std::numeric_limits<double>::infinity();
  const auto found = fit_error_model(start, data, geometry_alone, sensors);
  const VectorX precisions = found.arm.precisions();
  for (std::size_t k = 0; k < found.arm.geometric().size(); ++k) {
    const GeometricUnknown& u = found.arm.geometric()[k];
    const ParameterEstimate& p = start.parameters[static_cast<std::size_t>(u.parameter)];
    EXPECT_EQ(u.scale, p.scale);
    const double precision = precisions(static_cast<Index>(k));
    if (u.parameter < 6 || u.parameter >= 36) {
      EXPECT_EQ(precision, 0) << p.name;
    } else {
      const double width = std::isfinite(p.prior_std) ? p.prior_std / p.scale : 30;
      EXPECT_NEAR(precision, start.residual_variance / (width * width), 1e-12) << p.name;
    }
    if (u.parameter == held) {
      EXPECT_NEAR(precision, 0.16 * start.residual_variance, 1e-12);
    }
  }
}

TEST(FitOptions, OnlyWhatIsAllowedIsTried) {
  const Actual actual({with_geometric_errors(robot.chain, {}, 4),
                       draw_joint_errors(robot.chain, {.compliance = 0, .harmonic = 1e-3, .harmonics = 2}, 5)},
                      base, tool);
  const Dataset<6> data = measured(actual, 60, 1);
  ErrorModelOptions options = geometry_alone;
  const auto names = [&] { return block_names(fitted(data, options)); };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(), Names{});
  options.compliance = true;
  EXPECT_EQ(names(), Names{"elastic"});
  options.compliance = false;
  options.tilt = true;
  EXPECT_EQ(names(), Names{"tilt"});
  options.tilt = false;
  options.hysteresis = true;
  EXPECT_EQ(names(), Names{"approach"});
  options.hysteresis = false;
  options.harmonics = 2;
  options.gear_ratio = options.coupling = false;
  EXPECT_EQ(names(), Names{"jointwise"});
  for (const bool gears : {true, false}) {
    options.gear_ratio = gears;
    options.coupling = !gears;
    const auto found = fitted(data, options);
    EXPECT_EQ(block_names(found), (Names{"jointwise", "gears"}));
    if (!block_of(found, "gears").used) continue;
    EXPECT_EQ(found.arm.terms().gear_ratio, gears);
    EXPECT_EQ(found.arm.terms().coupling, !gears);
  }
}

// An arm on a wall, whose joints and frames give way in the direction of gravity there, and whose gears err.
TEST(FitOptions, GravityHasItsDirection) {
  const Vector3 down(0, -0.6, 0.8);
  JointTerms terms(6);
  terms.gravity.emplace(robot.chain, down);
  terms.tilt.emplace(robot.chain, down);
  terms.transmission.assign(6, Fourier::up_to(1));
  Rng rng(6);
  VectorX coefficients(terms.size());
  for (Index k = 0; k < terms.size(); ++k)
    coefficients(k) = (k < terms.gravity->size() ? 3e-3 : k < terms.num_dense_terms() ? 1e-3 : 0.4e-3) * rng.normal();
  const Actual actual({with_geometric_errors(robot.chain, {}, 4), JointErrors(terms, coefficients)}, base, tool);
  ErrorModelOptions options = geometry_alone;
  options.compliance = options.tilt = true;
  options.gear_ratio = options.coupling = false;
  options.harmonics = 1;
  options.down = down;
  const auto found = fitted(measured(actual, 150, 3), options);
  EXPECT_TRUE(block_of(found, "elastic").used);
  EXPECT_TRUE(block_of(found, "jointwise").used);
  EXPECT_TRUE(block_of(found, "tilt").used);
  EXPECT_EQ(RealMatrix(found.arm.terms().gravity->down()), RealMatrix(down));
  EXPECT_EQ(RealMatrix(found.arm.terms().tilt->down()), RealMatrix(down));
  EXPECT_LT(mean_error(found.model(), actual), 0.05e-3);
  EXPECT_EQ(found.fallback_error, block_of(found, "jointwise").without);  // that without transmissions and tilts
}

/// Joint errors of two orders, and few of them to be fast.
Dataset<6> rippled(Index poses) {
  const Actual actual(
      {with_geometric_errors(robot.chain, {}, 4),
       draw_joint_errors(
           robot.chain,
           {.gear_ratio = 0, .coupling = 0, .compliance = 0.5e-3, .harmonic = 0.4e-3, .harmonics = 3, .decay = 2}, 5)},
      base, tool);
  return measured(actual, poses, 1);
}

/// The same seen from a base that moves by half a millimetre.
Dataset<6> in_moving_base(const Dataset<6>& data) {
  PointRows positions = data.positions();
  for (Index i = 0; i < data.size(); ++i) positions(i, 0) += 0.5e-3 * static_cast<double>(i) / 80;
  return Dataset<6>(data.joints(), positions, data.orientations()).without_approach();
}

const ErrorModelOptions three_orders{.gear_ratio = false,
                                     .coupling = false,
                                     .harmonics = 3,
                                     .spectrum = {{1, 1, 400e-6}, {2, 3, 100e-6}},
                                     .hysteresis = false,
                                     .tilt = false,
                                     .drift = false};

// A search is told the error of poses left out, and its priors are used where that is smaller: those of the elastic
// terms, of each joint, and the exponent of the expected amplitudes.
TEST(FitOptions, ASearchTunesThePriors) {
  const Dataset<6> data = rippled(80);
  ErrorModelOptions options = three_orders;
  options.drives.resize(6);
  options.drives[2].encoder_periods = 3;  // whose lines are at the orders up to 8
  for (const bool good : {true, false}) {
    VectorX at(8);
    double error = 0;
    const auto search = [&](const PriorObjective& objective, const Box& box) {
      EXPECT_EQ(box.dimension(), 8);
      at.setConstant(good ? 0 : 4);  // the expected sizes; or hardly anything
      at(7) = 1.5;
      // the best of some, so that it is better than what evidence found
      if (good) {
        double least = objective.error(objective.precisions(at));
        for (Index k = 0; k < 7; ++k)
          for (const double value : {-0.5, 0.5, 1.0, 1.5, 2.0}) {
            const double before = at(k);
            at(k) = value;
            const double now = objective.error(objective.precisions(at));
            if (now < least)
              least = now;
            else
              at(k) = before;
          }
      }
      error = objective.error(objective.precisions(at));
      return at;
    };
    options.drift = good;  // found later, it does not change what was tuned
    const auto found = fitted(good ? in_moving_base(data) : data, options, search), without = fitted(data, options);
    EXPECT_TRUE(!good || block_of(found, "drift").used);
    const BlockChoice& tuned = block_of(found, "tuned_priors");
    EXPECT_EQ(tuned.with, error);
    EXPECT_EQ(tuned.used, good);
    EXPECT_EQ(tuned.with < tuned.without, good);
    EXPECT_EQ(tuned.precision, 1);
    const JointTerms& terms = found.arm.terms();
    ASSERT_TRUE(terms.gravity);
    const Index geometric = static_cast<Index>(found.arm.geometric().size());
    const VectorX precisions = found.arm.precisions(), scales = found.arm.scales();
    ASSERT_EQ(precisions.size(), without.arm.precisions().size());
    if (!good) {
      EXPECT_LT((RealMatrix(precisions) - without.arm.precisions()).block(0, 0, geometric, 1).largest(), 1e-12);
      for (Index k = geometric; k < precisions.size(); ++k)
        EXPECT_NEAR(precisions(k) / without.arm.precisions()(k), 1, 1e-6);
      continue;
    }
    for (Index k = 0; k < terms.gravity->size(); ++k)
      EXPECT_NEAR(precisions(geometric + k) / std::pow(10, at(0)), 1, 1e-9) << k;
    for (int j = 0; j < 6; ++j)
      for (Index k = 0; k < 6; ++k) {
        const Index unknown = geometric + terms.transmission_begin(j) + k;
        const double size = j == 2 ? 10e-6 : k < 2 ? 400e-6 : 100e-6;
        EXPECT_EQ(scales(unknown), size);
        // relative to the first order: a quarter, and the exponent of 1.5 takes half of that off the amplitude again
        EXPECT_NEAR(precisions(unknown) / std::pow(10, at(1 + j)), size == 100e-6 ? 4 : 1, 1e-9) << j << ' ' << k;
      }
  }
}

// Where errors of few poses left out decide, the block's errors are those of the priors that were tried, and priors are
// reported relative to the expected sizes.
TEST(FitOptions, DrivesAndFallbackErrorsAreReported) {
  ErrorModelOptions options = three_orders;
  options.drives.assign(6, {.gear_ratio = 101});
  options.drives[2].encoder_periods = 7;
  const auto found = fitted(rippled(80), options);
  EXPECT_EQ(found.drives, options.drives);
  const BlockChoice& jointwise = block_of(found, "jointwise");
  ASSERT_TRUE(jointwise.used);
  EXPECT_EQ(found.fallback_error, jointwise.without);
  EXPECT_LT(jointwise.with, 0.8 * jointwise.without);
  for (int j = 0; j < 6; ++j)  // few poses determine no lines of drives
    EXPECT_EQ(found.arm.terms().transmission[static_cast<std::size_t>(j)].orders, (std::vector<int>{1, 2, 3}));
}

TEST(FitOptions, WhatCannotBeUsedIsNamed) {
  const Actual actual(WithJointErrors<Chain>(robot.chain), base, tool);
  const Dataset<6> data = measured(actual, 20, 1);
  const auto start = identified(data, sensors);
  const auto complaint = [&](const std::vector<Dataset<6>>& stations, const ErrorModelOptions& options,
                             const SensorModel& accuracy) {
    return vernier_test::complaint([&] { (void)fit_error_model(start, stations, options, accuracy); });
  };
  ErrorModelOptions options = geometry_alone;
  EXPECT_EQ(complaint(std::vector<Dataset<6>>(), options, sensors), "fit_error_model: no measurements");
  EXPECT_EQ(complaint({data, Dataset<6>()}, options, sensors), "fit_error_model: station 2 has no measurements");
  SensorModel none = sensors;
  none.position_sigma = 0;
  EXPECT_NE(complaint({data}, options, none), "");
  options.tilt_prior_std = 0;
  EXPECT_EQ(complaint({data}, options, sensors), "ErrorModelOptions: tilt_prior_std is 0, must be positive");
}

}  // namespace
}  // namespace vernier::fit_choices_test
