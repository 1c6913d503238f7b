// SPDX-License-Identifier: BSD-3-Clause
// A fit of an error model: priors on the right coefficients, and the covariance that it reports, without Ceres.

#include "vernier/error_model/fit_error_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "gauss_newton.hpp"
#include "irb120_fits.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_model/detail/visit_noise.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/least_squares/leave_one_out.hpp"
#include "vernier/least_squares/prior_choice.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::fit_error_model_test {
namespace {

using namespace vernier_test::irb120_fits;
using vernier_test::difference;
using vernier_test::identify_by_gauss_newton;
using vernier_test::RealMatrix;
using vernier_test::vector;
using Actual = Framed<WithJointErrors<Chain>>;

const ErrorModelOptions few_harmonics{.harmonics = 2, .num_validation_poses = 60};

Actual actual_arm(const JointErrorSizes& sizes) {
  return Actual({with_geometric_errors(robot.chain, {}, 4), draw_joint_errors(robot.chain, sizes, 5)}, base, tool);
}

Dataset<6> measured(const Actual& actual, Index poses, std::uint64_t seed) {
  return measure(actual, abb_irb120_operating_region().sample(robot.chain, poses, seed),
                 {.position = 0.03e-3, .orientation = 0.1e-3}, seed);
}

FittedErrorModel<Chain> fitted(const Dataset<6>& data, const ErrorModelOptions& options = few_harmonics) {
  return fit_error_model(identified(data), data, options, squared);
}

/// What a coefficient belongs to, by its name.
std::string kind_of(const std::string& name) {
  for (const char* kind : {"gear", "coupling", "sag", "cos", "sin"})
    if (name.starts_with(kind)) return kind;
  return "geometry";
}

// Gears come in front of the coefficients that are there already: every prior must stay with its own.
TEST(FitErrorModel, PriorsStayWithTheirCoefficientsWhenGearsAreAdded) {
  const Dataset<6> data = measured(
      actual_arm({.gear_ratio = 1e-3, .coupling = 1e-3, .compliance = 0, .harmonic = 3e-3, .harmonics = 2}), 120, 1);
  const auto found = fitted(data);
  std::map<std::string, BlockChoice> blocks;
  for (const BlockChoice& block : found.blocks) blocks[traits_of(block.block).key] = block;
  ASSERT_TRUE(blocks.contains("jointwise") && blocks["jointwise"].used);
  ASSERT_TRUE(blocks.contains("gears") && blocks["gears"].used);
  ASSERT_EQ(found.arm.terms().linear_ranges.size(), 6u);  // from the smallest measured value to the largest
  for (Index j = 0; j < 6; ++j) {
    const auto [least, most] = std::minmax_element(data.joints().col(j).begin(), data.joints().col(j).end());
    EXPECT_EQ(found.arm.terms().linear_ranges[static_cast<std::size_t>(j)], (JointRange{*least, *most}));
  }
  ASSERT_TRUE(blocks.contains("elastic_with_jointwise"));
  std::map<std::string, double> wanted{{"gear", blocks["gears"].precision},
                                       {"coupling", blocks["gears"].precision},
                                       {"sag", blocks["elastic_with_jointwise"].precision},
                                       {"cos", blocks["jointwise"].precision},
                                       {"sin", blocks["jointwise"].precision}};
  ASSERT_NE(wanted["sag"], wanted["gear"]);
  ASSERT_NE(wanted["sag"], wanted["cos"]);
  const std::vector<std::string> names = found.arm.names();
  const VectorX precisions = found.arm.precisions();
  ASSERT_EQ(static_cast<Index>(names.size()), precisions.size());
  std::map<std::string, int> count;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string kind = kind_of(names[k]);
    ++count[kind];
    if (wanted.contains(kind)) {
      EXPECT_EQ(precisions(static_cast<Index>(k)), wanted[kind]) << names[k];
    }
  }
  EXPECT_EQ(count["gear"], 6);
  EXPECT_EQ(count["coupling"], 5);
  EXPECT_EQ(count["sag"], 21);
  EXPECT_EQ(count["cos"] + count["sin"], 24);
}

/// Estimates against the truth, in reported standard deviations; each of those must be below `largest_std`.
void expect_found(const FittedErrorModel<Chain>& found, const Actual& actual, const std::vector<std::string>& which,
                  double largest_std) {
  const JointErrors& truth = actual.model().joint_errors();
  const std::vector<std::string> names = found.arm.names(), true_names = truth.terms().names();
  const VectorX steps = found.arm.steps(), scales = found.arm.scales();
  for (const std::string& name : which) {
    const Index k = std::find(names.begin(), names.end(), name) - names.begin();
    ASSERT_LT(k, steps.size()) << name;
    const double wanted =
        truth.coefficients()(std::find(true_names.begin(), true_names.end(), name) - true_names.begin());
    const double std = std::sqrt(found.covariance(k, k)) * scales(k);
    EXPECT_LT(std::abs(steps(k) * scales(k) - wanted), 4 * std) << name;
    EXPECT_LT(std, largest_std) << name;
    EXPECT_GT(std::abs(wanted), 4 * largest_std) << name;  // else zero would do
  }
}

// Coefficients are in units of their own expected sizes. Second harmonics of joints that turn widely act like nothing
// else; joint 2 follows joint 1 by 0.6 mrad/rad, and joint 6 has a gear error of 0.2.
TEST(FitErrorModel, FindsTheCoefficientsWithinTheirDeviations) {
  const auto measured_widely = [](const Actual& actual) {
    return measure(actual, sample_joints(robot.limits, 150, 2), {.position = 0.03e-3, .orientation = 0.1e-3}, 2);
  };
  const Actual rippled =
      actual_arm({.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0.5e-3, .harmonics = 2});
  ErrorModelOptions transmissions = few_harmonics;
  transmissions.compliance = transmissions.gear_ratio = transmissions.coupling = false;
  const auto found = fitted(measured_widely(rippled), transmissions);
  expect_found(found, rippled, {"cos2_2", "cos3_2", "sin3_2", "sin4_2"}, 0.04e-3);
  EXPECT_NEAR(found.orientation_sigma / 0.1e-3, 1, 0.1);
  const Actual geared =
      actual_arm({.gear_ratio = 0.2e-3, .coupling = 0.2e-3, .compliance = 0, .harmonic = 0.5e-3, .harmonics = 2});
  expect_found(fitted(measured_widely(geared)), geared, {"coupling2", "gear6"}, 0.01e-3);
}

/// An arm whose frames tilt by some, one coefficient of gravity's direction [rad].
Actual tilting_arm(double size) {
  JointTerms terms(6);
  terms.tilt.emplace(robot.chain);
  VectorX coefficients(terms.size());
  Rng rng(6);
  for (double& c : coefficients) c = size * rng.normal();
  return Actual({with_geometric_errors(robot.chain, {}, 4), JointErrors(terms, coefficients)}, base, tool);
}

// Some coefficients act as others and the geometry do, so what is found is judged by its predictions.
TEST(FitErrorModel, FindsFramesThatTiltAndNoneWhereTheyDoNot) {
  const ErrorModelOptions no_harmonics{.harmonics = 0, .num_validation_poses = 60};
  for (const double size : {0.5e-3, 0.0}) {
    const Actual actual = tilting_arm(size);
    const auto found = fitted(measured(actual, 150, 3), no_harmonics);
    const BlockChoice* choice = choice_of(found, "tilt");
    ASSERT_NE(choice, nullptr);
    EXPECT_EQ(choice->used, size > 0);
    EXPECT_EQ(found.model().identified().model().joint_errors().tilts(), size > 0);
    EXPECT_EQ(
        std::any_of(found.stages.begin(), found.stages.end(), [](const auto& s) { return s.stage == Stage::tilt; }),
        size > 0);
    EXPECT_EQ(found.model().coverage() != nullptr, size > 0);  // known where the joints were measured
    if (size > 0) {
      EXPECT_FALSE(found.model().fallback()->model().joint_errors().tilts());
      EXPECT_EQ(found.fallback_error, choice->without);
    }
    const JointRows<6> elsewhere = abb_irb120_operating_region().sample(robot.chain, 100, 9);
    double error = 0, before = 0;
    for (Index i = 0; i < elsewhere.rows(); ++i) {
      const JointVector<6> q = configuration(elsewhere, i);
      error += (found.model().position(q) - actual.position(q)).norm() / 100;
      before += (found.models(Stage::jointwise).front().position(q) - actual.position(q)).norm() / 100;
    }
    EXPECT_LT(error, 0.03e-3);
    if (size > 0) {
      EXPECT_GT(before, 3 * error);
    }
  }
}

// Joint errors as small as the noise, and none: the answers, and the precision of what is not used.
TEST(FitErrorModel, AnswersWhetherEffectsExist) {
  const JointErrorSizes small{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 1e-4, .harmonics = 2};
  const auto found = fitted(measured(actual_arm(small), 120, 2));
  EXPECT_EQ(choice_of(found, "jointwise")->existence.answer, Answer::found);
  for (const BlockChoice& block : found.blocks) {
    EXPECT_EQ(block.used, block.existence.answer == Answer::found) << traits_of(block.block).key;
    if (!block.used) {
      EXPECT_EQ(block.precision, suppressing_precision) << traits_of(block.block).key;
    }
  }
}

// Whatever a fit finds, an observer is told of as many steps, in order.
TEST(FitErrorModel, TellsHowFarItIs) {
  std::vector<Index> all(fit_steps);
  std::iota(all.begin(), all.end(), Index{1});
  for (const double harmonic : {0.0, 1e-4}) {
    const JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = harmonic};
    std::vector<Index> told;
    const auto observer = [&](const Progress& progress) { told.push_back(progress.generation); };
    (void)fitted(measured(actual_arm(sizes), 40, 2), {.harmonics = 2, .drift = false, .observer = observer});
    EXPECT_EQ(told, all);
  }
}

// A block that is used has the precision that is reported of it.
TEST(FitErrorModel, ABlockThatIsUsedHasItsPrecision) {
  const Dataset<6> data =
      measured(actual_arm({.gear_ratio = 0, .coupling = 0, .compliance = 4e-4, .harmonic = 0}), 40, 3);
  const auto found = fitted(data, {.harmonics = 0, .hysteresis = false, .tilt = false, .drift = false});
  const BlockChoice* elastic = choice_of(found, "elastic");
  ASSERT_NE(elastic, nullptr);
  ASSERT_TRUE(elastic->used);
  EXPECT_NE(elastic->precision, 1);  // that of the expected sizes, from which it starts
  const auto names = found.arm.names();
  const VectorX precisions = found.arm.precisions();
  int count = 0;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (kind_of(names[k]) == "sag") {
      EXPECT_EQ(precisions(static_cast<Index>(k)), elastic->precision) << names[k];
      ++count;
    }
  EXPECT_GE(count, 2);
}

/// Joint errors whose first order and whose next two have given sizes; signs are up to chance.
Dataset<6> with_sizes(double first, double next, Index poses) {
  JointTerms terms(6);
  terms.transmission.assign(6, Fourier::up_to(3));
  Rng rng(9);
  VectorX coefficients(36);
  for (Index k = 0; k < 36; ++k) coefficients(k) = rng.sign() * (k % 6 < 2 ? first : next);
  const Actual actual({with_geometric_errors(robot.chain, {}, 4), JointErrors(terms, coefficients)}, base, tool);
  return measure(actual, sample_joints(robot.limits, poses, 2), {.position = 0.03e-3, .orientation = 0.1e-3}, 2);
}

// Few poses size all orders by one factor, unless evidence speaks clearly against the expected spectrum; many size each
// band of orders. Precisions are those of the sizes that there are.
TEST(FitErrorModel, BandsOfOrdersAreSizedApartWhereThatIsClear) {
  const ErrorModelOptions options{.compliance = false,
                                  .gear_ratio = false,
                                  .coupling = false,
                                  .harmonics = 3,
                                  .spectrum = {{1, 1, 200e-6}, {2, 3, 100e-6}},
                                  .hysteresis = false,
                                  .tilt = false,
                                  .drift = false,
                                  .num_validation_poses = 60};
  struct Case {
    double first, next;
    Index poses;
    bool apart;
  };
  for (const Case& c : {Case{400e-6, 200e-6, 100, false}, Case{400e-6, 280e-6, 100, false},
                        Case{200e-6, 1000e-6, 100, true}, Case{400e-6, 280e-6, 500, true}}) {
    const auto found = fitted(with_sizes(c.first, c.next, c.poses), options);
    const BlockChoice* jointwise = choice_of(found, "jointwise");
    ASSERT_TRUE(jointwise != nullptr && jointwise->used);
    const Index begin = found.arm.num_dense();
    const RealMatrix precisions = RealMatrix(found.arm.precisions()).block(begin, 0, 36, 1);
    EXPECT_EQ(jointwise->precision, precisions(0));
    for (Index k = 0; k < 36; ++k) EXPECT_EQ(precisions(k), precisions(k % 6 < 2 ? 0 : 2)) << k;
    EXPECT_EQ(precisions(0) != precisions(2), c.apart) << c.next << ' ' << c.poses;
    if (!c.apart) continue;
    EXPECT_NEAR(std::sqrt(precisions(0)), 200e-6 / c.first, 0.15 * 200e-6 / c.first);
    EXPECT_NEAR(std::sqrt(precisions(2)), 100e-6 / c.next, 0.1 * 100e-6 / c.next);
  }
}

/// The covariance at the solution, before the noise of visits is known: (J'J + priors)^-1 times the weighted squares
/// over the values that the unknowns leave free.
RealMatrix expected_covariance(const ErrorModelEstimate& estimate, std::vector<MeasuredSet> stations) {
  const detail::CalibrationProblem problem(estimate.arm, std::move(stations), Loss::squared);
  const detail::StackedRows rows = problem.stacked(true);
  const RealMatrix jacobian = rows.jacobian, information = jacobian.transpose() * jacobian;
  const RealMatrix inverse = (information + RealMatrix::diagonal(estimate.arm.precisions())).inverse();
  const double explained = (inverse * information).trace();  // effective number of parameters
  return inverse * (rows.residuals.squaredNorm() / (static_cast<double>(rows.residuals.size()) - explained));
}

/// Largest difference relative to the deviations.
double difference_in_deviations(const RealMatrix& a, const RealMatrix& b) {
  const RealMatrix std = b.diagonal().sqrt();
  return (a - b).over(std * std.transpose()).largest();
}

/// The factor on the covariance that leave-one-pose-out errors support.
double supported_factor(const ErrorModelEstimate& estimate, const RealMatrix& covariance, const Dataset<6>& data) {
  const detail::CalibrationProblem problem(estimate.arm, {vernier_test::set_of(data, squared)}, Loss::squared);
  const BlockSystem system = problem.system();
  const NormalEquations normal(system);
  const FactorisedEquations solved(normal, estimate.arm.precisions(), estimate.arm.steps());
  const Eigen::Matrix3Xd errors = leave_one_out_errors(system, solved, 1);
  std::vector<detail::LeftOutVisit> visits;
  std::vector<RowBlock> blocks(static_cast<std::size_t>(data.size()));
  estimate.arm.linearise(0, data.joints(), data.previous(), blocks.data());
  Rows6 all(6, estimate.arm.size());
  for (Index b = 0; b < data.size(); ++b) {
    const RowBlock& rows = blocks[static_cast<std::size_t>(b)];
    rows.expand(estimate.arm.group_sizes(), all);
    const RealMatrix position = RealMatrix(all).block(0, 0, 3, all.cols());
    const RealMatrix joint = RealMatrix(rows.factor).block(0, 0, 3, rows.factor.cols());
    visits.push_back({errors.col(b), position * covariance * position.transpose(), joint * joint.transpose()});
  }
  return detail::visit_noise(visits).model;
}

/// The variance of the residuals, of orientations alone their deviation, and the factor of the covariance.
void expect_noise_of_residuals(const FittedErrorModel<Chain>& found, const Dataset<6>& data, double factor) {
  const detail::CalibrationProblem problem(found.arm, {vernier_test::set_of(data, squared)}, Loss::squared);
  const detail::StackedRows rows = problem.stacked(true);
  const RealMatrix jacobian = rows.jacobian, information = jacobian.transpose() * jacobian;
  const RealMatrix inverse = (information + RealMatrix::diagonal(found.arm.precisions())).inverse();
  const auto values = static_cast<double>(rows.residuals.size());
  const double freedom = values - (inverse * information).trace();
  double angular = 0;
  for (Index k = 0; k < rows.residuals.size(); ++k)
    if (rows.of_orientation[static_cast<std::size_t>(k)]) angular += rows.residuals(k) * rows.residuals(k);
  EXPECT_NEAR(found.orientation_sigma / (squared.orientation_sigma * std::sqrt(2 * angular / freedom)), 1, 1e-6);
  EXPECT_NEAR(found.residual_variance / (rows.residuals.squaredNorm() / freedom), 1, 1e-6);
  EXPECT_NEAR(found.variance_factor / (factor * found.residual_variance), 1, 1e-6);
}

// Few poses: of 90 values about 60 are left free. Then the noise of visits scales what remains.
TEST(FitErrorModel, CovarianceIsThatOfTheNormalEquations) {
  bool scaled = false;
  for (const std::uint64_t seed : {3, 4, 5, 6, 7, 8}) {
    const Dataset<6> data =
        measured(actual_arm({.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0}), 15, seed);
    const auto found = fitted(data, {.compliance = false, .harmonics = 0});
    const RealMatrix plain = expected_covariance(found, {vernier_test::set_of(data, squared)});
    ASSERT_EQ(found.covariance.rows(), plain.rows());
    const double factor = supported_factor(found, plain, data);
    scaled = scaled || factor < 1;
    EXPECT_LT(difference_in_deviations(found.covariance, factor * plain), 1e-6) << seed;
    expect_noise_of_residuals(found, data, factor);
  }
  EXPECT_TRUE(scaled);
}

// The errors of geometry alone are those of a fit that has nothing else.
TEST(FitErrorModel, GeometryAloneHasLeaveOnePoseOutErrorsOfItsOwn) {
  const Dataset<6> data = measured(actual_arm({}), 130, 3);
  const ErrorModelOptions geometry{.compliance = false,
                                   .harmonics = 0,
                                   .hysteresis = false,
                                   .tilt = false,
                                   .drift = false,
                                   .num_validation_poses = 60};
  const auto all = fitted(data), alone = fitted(data, geometry);
  EXPECT_GT(all.leave_one_out_seconds, 0);
  ASSERT_EQ(all.left_out_rows.size(), 65u);
  ASSERT_EQ(all.left_out_rows, alone.left_out_rows);
  for (std::size_t k = 0; k < 65; ++k) EXPECT_EQ(all.left_out_rows[k], static_cast<Index>(2 * k));
  ASSERT_EQ(all.geometry_left_out_errors.size(), 65);
  EXPECT_LT(difference(all.geometry_left_out_errors, alone.left_out_errors), 1e-12);
  EXPECT_EQ(RealMatrix(alone.geometry_left_out_errors), RealMatrix(alone.left_out_errors));
  EXPECT_LT(all.left_out_errors.mean(), 0.7 * all.geometry_left_out_errors.mean());
}

TEST(FitErrorModel, CovarianceFromDistancesAloneHasNoVisits) {
  const Actual actual = actual_arm({.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0});
  const Actual in_its_base(actual.model(), {}, tool);
  const auto data = measure_distances(in_its_base, Vector3(0.9, -1.2, 0.3),
                                      abb_irb120_operating_region().sample(robot.chain, 60, 4), 0.03e-3, 4);
  const auto start =
      identify_by_gauss_newton(Framed<Chain>(robot.chain, {}, tool), data, {.frames = Frames::base_and_tool}, squared);
  const auto found = fit_error_model(start, data, {.compliance = false, .harmonics = 0}, squared);
  ASSERT_TRUE(found.converged);
  EXPECT_LT(
      difference_in_deviations(found.covariance, expected_covariance(found, {vernier_test::set_of(data, squared)})),
      1e-6);
  EXPECT_GT(found.position_sigma, 0.02e-3);
  EXPECT_LT(found.position_sigma, 0.08e-3);
}

/// Base x and y in units of 1 and 2 mm, standard deviations 0.1 and 0.2 units, correlation 0.5; joints that do not
/// repeat.
TEST(ErrorModelEstimate, CovariancesByHand) {
  const ArmGeometry arm(nominal);
  ErrorModelEstimate estimate{.arm = ArmParameterisation({arm}, {{0, -1, 1e-3, 0}, {1, -1, 2e-3, 0}})};
  estimate.covariance = RealMatrix(2, 2, {0.01, 0.01, 0.01, 0.04});
  estimate.position_sigma = 0.3e-3;
  estimate.joint_sigma = 0.1e-3;
  estimate.orientation_sigma = 0.2e-3;
  estimate.fallback_error = 0.8e-3;
  const JointVector<6> q(0.1, -0.5, 0.3, 0.7, -0.4, 1);
  RealMatrix model(6, 6);
  model.set_block(0, 0, RealMatrix(2, 2, {0.01e-6, 0.02e-6, 0.02e-6, 0.16e-6}));
  EXPECT_LT((estimate.model_covariance(q) - model).norm(), 1e-18);
  const RealMatrix jacobian = nominal.jacobian(q), of_joints = 1e-8 * (jacobian * jacobian.transpose());
  const auto visit = [&](double position, double rotation) {
    return model + of_joints +
           RealMatrix::diagonal(vector({position, position, position, rotation, rotation, rotation}));
  };
  const RealMatrix measured = visit(9e-8, 4e-8);
  const RealMatrix outside = visit(9e-8 + 0.25e-6 * 0.5625, 4e-8);  // three quarters of 0.8 mm / 1.6, squared
  EXPECT_LT((estimate.visit_covariance(q, 0.25) - outside).norm(), 1e-12 * outside.norm());
  EXPECT_LT((estimate.visit_covariance(q, 1) - measured).norm(), 1e-12 * measured.norm());
}

// The estimate of the first of two stations has the shared unknowns and its own ones, with their covariances.
TEST(ErrorModelEstimate, TheFirstStationByHand) {
  const ArmGeometry arm(nominal);
  ErrorModelEstimate both{
      .arm = ArmParameterisation({arm, arm},
                                 {{0, 1, 1e-3, 0}, {0, 0, 1e-3, 0}, {7, -1, 2e-3, 4}, {8, -1, 1e-5, 1, true}})};
  JointTerms terms(6);
  terms.transmission[3] = Fourier::up_to(1);
  both.arm.set_terms(terms, vector({1e-3, 2e-3}), vector({3, 5}));
  both.arm.move(vector({50, 2, 3, 4, 5, 6}));
  both.covariance = MatrixX(6, 6);
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j) both.covariance(i, j) = static_cast<double>(10 * std::min(i, j) + std::max(i, j));
  both.converged = true;
  both.position_sigma = 1;
  both.joint_sigma = 2;
  both.orientation_sigma = 3;
  both.fallback_error = 4;
  both.mean_temperature = 5;
  both.temperature_std = 6;
  both.variance_factor = 7;
  both.residual_variance = 8;
  const ErrorModelEstimate first = both.first_station();
  EXPECT_TRUE(first.converged);
  EXPECT_EQ(first.position_sigma, 1);
  EXPECT_EQ(first.joint_sigma, 2);
  EXPECT_EQ(first.orientation_sigma, 3);
  EXPECT_EQ(first.fallback_error, 4);
  EXPECT_EQ(first.mean_temperature, 5);
  EXPECT_EQ(first.temperature_std, 6);
  EXPECT_EQ(first.variance_factor, 7);
  EXPECT_EQ(first.residual_variance, 8);
  ASSERT_EQ(first.arm.geometric().size(), 3u);
  for (const GeometricUnknown& u : first.arm.geometric()) EXPECT_EQ(u.station, -1);
  EXPECT_EQ(RealMatrix(first.covariance), RealMatrix(both.covariance).block(1, 1, 5, 5));
  EXPECT_EQ(RealMatrix(first.arm.geometry(0).parameters()), RealMatrix(both.arm.geometry(0).parameters()));
  EXPECT_NEAR(first.arm.thermal_rates(0)(8), 4e-5, 1e-15);
  const RealMatrix coefficients = first.arm.joint_errors().coefficients();
  EXPECT_LT((coefficients - vector({5e-3, 12e-3})).norm(), 1e-15);
  EXPECT_EQ(RealMatrix(first.arm.precisions()).block(3, 0, 2, 1), vector({3, 5}));
  EXPECT_EQ(RealMatrix(first.arm.scales()).block(3, 0, 2, 1), vector({1e-3, 2e-3}));
}

// A slide between two revolute joints has no harmonics, and every kind of term its own expected size.
TEST(ExpectedTermsWhiteBox, KindsByHand) {
  const DhChain<3> chain{{{{.alpha = 1.5, .d = 0.3}, {.alpha = 0.5, .joint = JointType::prismatic}, {.a = 0.35}}}};
  ErrorModelOptions options{.harmonics = 4, .spectrum = {{1, 2, 7e-5}, {3, 4, 8e-5}}};
  options.compliance_prior_std = 1e-3;
  options.gear_ratio_prior_std = 2e-4;
  options.coupling_prior_std = 3e-4;
  options.hysteresis_prior_std = 4e-5;
  options.tilt_prior_std = 5e-3;
  const JointTerms terms = detail::allowed_terms(detail::ChainTable(chain.view()), options, 30);
  EXPECT_EQ(terms.transmission[0].orders, (std::vector<int>{1, 2, 3, 4}));
  EXPECT_EQ(terms.transmission[1].size(), 0);
  EXPECT_EQ(terms.transmission[2].orders, (std::vector<int>{1, 2, 3, 4}));
  EXPECT_TRUE(terms.gear_ratio && terms.coupling && terms.gravity && terms.tilt && !terms.hysteresis.empty());
  const VectorX sizes = detail::expected_sizes(terms, options, detail::spectra_of(options, 3));
  const std::vector<std::string> names = terms.names();
  std::map<double, int> count;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string& name = names[k];
    const double size = sizes(static_cast<Index>(k));
    ++count[size];
    if (name.starts_with("gear")) {
      EXPECT_EQ(size, 2e-4);
    } else if (name.starts_with("coupling")) {
      EXPECT_EQ(size, 3e-4);
    } else if (name.starts_with("sag")) {
      EXPECT_EQ(size, 1e-3);
    } else if (name.starts_with("cos") || name.starts_with("sin")) {
      EXPECT_EQ(size, name.back() < '3' ? 7e-5 : 8e-5) << name;
    }
  }
  EXPECT_EQ(count[7e-5] + count[8e-5], 16);
  EXPECT_EQ(count[4e-5], 3 * static_cast<int>(terms.hysteresis.size()));
  EXPECT_GT(count[5e-3], 0);
  options.harmonics = 0;  // gears come beside joint-wise terms alone
  const JointTerms bare = detail::allowed_terms(detail::ChainTable(chain.view()), options, 30);
  EXPECT_FALSE(bare.gear_ratio || bare.coupling);
}

// Below 400 measurements orders end at 60, and drives have no lines of their own.
TEST(ExpectedTermsWhiteBox, OrdersByTheNumberOfMeasurements) {
  ErrorModelOptions options{.spectrum = {{1, 2, 7e-5}, {59, 62, 8e-5}, {200, 200, 1e-5}}};
  options.drives = {{.gear_ratio = 100}, {.encoder_periods = 600}};
  const auto spectra = detail::spectra_of(options, 2);
  const auto orders = [&](std::size_t joint, Index measurements) {
    return detail::orders_of_joint(options, spectra, joint, measurements).orders;
  };
  EXPECT_EQ(orders(0, 399), (std::vector<int>{1, 2, 59, 60}));
  EXPECT_EQ(orders(1, 399), (std::vector<int>{1, 2, 59, 60}));
  EXPECT_EQ(orders(1, 400), (std::vector<int>{1, 2, 59, 60, 61, 62, 200, 598, 599, 600, 601, 602, 1198, 1199, 1200,
                                              1201, 1202}));  // lines beyond `harmonics`, too
  EXPECT_EQ(expected_std(spectra[0], 400), 12e-6);
  EXPECT_EQ(expected_std(spectra[0], 200), 7e-6);  // the line of the drive
  EXPECT_EQ(expected_std(spectra[1], 200), 1e-5);
  options.harmonics = 50;
  EXPECT_EQ(orders(0, 399), (std::vector<int>{1, 2}));
  EXPECT_EQ(orders(0, 400).front(), 1);
  EXPECT_EQ(orders(0, 400)[2], 199);
  options.drives.clear();
  options.harmonics = 61;
  EXPECT_EQ(orders(0, 400), (std::vector<int>{1, 2, 59, 60, 61}));
  options.drives.resize(1);
  EXPECT_EQ(vernier_test::complaint([&] { (void)detail::spectra_of(options, 2); }),
            "fit_error_model: drives of 1 joints for an arm of 2");
}

// a cos q + b sin q at 0 and pi: a and -a, mean 0; its variance is that of a.
TEST(ErrorModelEstimate, TransmissionByHand) {
  ErrorModelEstimate estimate{.arm = ArmParameterisation({ArmGeometry(nominal)}, {{0, -1, 1e-3, 0}})};
  JointTerms terms(6);
  terms.gear_ratio = true;  // six coefficients before those of the transmissions
  terms.transmission[1] = Fourier::up_to(1);
  terms.transmission[2] = Fourier::up_to(1);
  estimate.arm.set_terms(terms, vector({1, 1, 1, 1, 1, 1, 1e-3, 2e-3, 3e-3, 4e-3}), VectorX::Ones(10));
  estimate.arm.move(vector({0, 8, 8, 8, 8, 8, 8, 1, 2, 5, 7}));
  estimate.covariance = RealMatrix::diagonal(vector({1, 8, 8, 8, 8, 8, 8, 4, 9, 16, 25}));
  const JointFunction f = estimate.transmission(2, {0, std::numbers::pi});
  EXPECT_LT((f.value - vector({15e-3, -15e-3})).norm(), 1e-15);
  EXPECT_LT((f.std - vector({12e-3, 12e-3})).norm(), 1e-15);  // 4 units of 3 mrad
  constexpr double quarter = std::numbers::pi / 2;            // sines alone: b and -b
  const JointFunction sines = estimate.transmission(2, {quarter, -quarter});
  EXPECT_LT((sines.value - vector({28e-3, -28e-3})).norm(), 1e-15);
  EXPECT_LT((sines.std - vector({20e-3, 20e-3})).norm(), 1e-15);
  const JointFunction mean = estimate.transmission(2, {0, 0});
  EXPECT_LT(mean.value.norm() + mean.std.norm(), 1e-15);
  EXPECT_EQ(RealMatrix(estimate.transmission(0, {0, 1}).value), vector({0, 0}));
}

// Behind a joint with more coefficients, and where sines count: of a cos q + b sin q at 0 and pi / 2.
TEST(ErrorModelEstimate, TransmissionOfAJointBehindOneOfMoreOrders) {
  ErrorModelEstimate estimate{.arm = ArmParameterisation({ArmGeometry(nominal)}, {{0, -1, 1e-3, 0}})};
  JointTerms terms(6);
  terms.transmission[1] = Fourier::up_to(2);
  terms.transmission[2] = Fourier::up_to(1);
  estimate.arm.set_terms(terms, VectorX::Constant(6, 1e-3), VectorX::Ones(6));
  estimate.arm.move(vector({0, 9, 9, 9, 9, 4, 7}));
  estimate.covariance = RealMatrix::diagonal(vector({1, 9, 9, 9, 9, 16, 9}));
  const JointFunction f = estimate.transmission(2, {0, std::numbers::pi / 2});
  EXPECT_LT((f.value - vector({-1.5e-3, 1.5e-3})).norm(), 1e-15);  // 4 and 7 mrad about their mean
  EXPECT_LT((f.std - vector({2.5e-3, 2.5e-3})).norm(), 1e-15);     // half of sqrt(4^2 + 3^2)
}

}  // namespace
}  // namespace vernier::fit_error_model_test
