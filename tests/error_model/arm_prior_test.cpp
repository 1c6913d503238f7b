// SPDX-License-Identifier: BSD-3-Clause
// An earlier calibration as the prior of a later one.

#include "vernier/error_model/arm_prior.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "complaint.hpp"
#include "gauss_newton.hpp"
#include "irb120_fits.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/error_model/detail/prior_transfer.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::arm_prior_test {
namespace {

using namespace vernier_test::irb120_fits;
using vernier_test::RealMatrix;
using vernier_test::vector;
using Actual = Framed<WithJointErrors<Chain>>;

const ErrorModelOptions twenty_orders{.harmonics = 20, .num_validation_poses = 100};

/// Joint errors of a typical size, of orders 1 to 20.
JointErrors joint_errors(std::uint64_t seed) {
  return draw_joint_errors(
      robot.chain, {.gear_ratio = 0, .coupling = 0, .compliance = 0.2e-3, .harmonic = 0.2e-3, .harmonics = 20}, seed);
}

/// An arm in a cell: where it stands depends on the seed of its geometry.
Actual arm(std::uint64_t geometry, const JointErrors& errors, double x) {
  return Actual({with_geometric_errors(robot.chain, {}, geometry), errors},
                FrameParameters(Vector6{x, -0.3, 0.2, 0.3, -0.4, 0.6}), tool);
}

/// The same joint functions, changed by a share of their sizes.
JointErrors changed(const JointErrors& before, double share, std::uint64_t seed) {
  const JointErrors other = joint_errors(seed);
  return {before.terms(), before.coefficients() + share * RealMatrix(other.coefficients())};
}

Dataset<6> measured(const Actual& actual, Index poses, std::uint64_t seed) {
  return measure(actual, sample_joints(robot.limits, poses, seed), {.position = 0.03e-3, .orientation = 0.1e-3}, seed);
}

FittedErrorModel<Chain> fitted(const Dataset<6>& data, const ArmPrior* prior) {
  const auto start = vernier_test::identify_by_gauss_newton(Framed<Chain>(robot.chain), data,
                                                            {.frames = Frames::base_and_tool}, squared);
  ErrorModelOptions options = twenty_orders;
  options.prior = prior;
  return fit_error_model(start, data, options, squared);
}

ArmPrior prior_from(const Actual& actual, Index poses) {
  const auto found = fitted(measured(actual, poses, 1), nullptr);
  return arm_prior("before", found.model(), found.first_station());
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Errors of unseen poses with a prior, divided by those without, of arms fitted to 20 poses.
struct Outcome {
  std::vector<double> ratios;
  std::vector<PriorTransfer> transfers;
};
template <class TrueArm>
Outcome from_twenty_poses(const ArmPrior& prior, const TrueArm& true_arm, int arms) {
  Outcome out;
  for (int k = 0; k < arms; ++k) {
    const auto seed = static_cast<std::uint64_t>(100 + k);
    const Actual actual = true_arm(seed);
    const Dataset<6> few = measured(actual, 20, seed), unseen = measured(actual, 200, seed + 1000);
    const auto without = fitted(few, nullptr), with = fitted(few, &prior);
    EXPECT_TRUE(with.prior.has_value());
    out.transfers.push_back(*with.prior);
    for (const BlockChoice& block : with.blocks)
      if (block.block == Block::prior) {
        EXPECT_NEAR(block.precision, std::pow(with.prior->joints, -2), 1e-9);
        EXPECT_TRUE(!block.used || block.with < block.without);
      }
    out.ratios.push_back(position_errors(with.model(), unseen).mean() /
                         position_errors(without.model(), unseen).mean());
  }
  return out;
}

// Joint functions that changed by 15 %, of the same arm in another cell, or of another arm of the type with a geometry
// of its own: from 20 poses at least a third less error.
TEST(ArmPrior, TheSameArmLaterAndATwinArePredictedFromFewPoses) {
  const JointErrors errors = joint_errors(5);
  const ArmPrior prior = prior_from(arm(4, errors, 0.4), 400);
  for (const bool twin : {false, true}) {
    const Outcome found = from_twenty_poses(
        prior, [&](std::uint64_t seed) { return arm(twin ? seed : 4, changed(errors, 0.15, seed), -0.7); }, 5);
    EXPECT_LT(median(found.ratios), 2.0 / 3) << twin;
    for (const PriorTransfer& transfer : found.transfers) {
      EXPECT_TRUE(transfer.used);
      EXPECT_TRUE(twin ? transfer.geometry >= 0.4 : transfer.geometry <= 0.1) << transfer.geometry;
      EXPECT_LE(transfer.joints, 0.4);
    }
  }
}

// Nothing of an arm with other functions and another geometry holds: named useless, and no harm.
TEST(ArmPrior, ADifferentArmIsNamedUseless) {
  const ArmPrior prior = prior_from(arm(4, joint_errors(5), 0.4), 400);
  const Outcome found = from_twenty_poses(
      prior, [&](std::uint64_t seed) { return arm(seed, joint_errors(seed + 50), -0.7); }, 5);
  for (std::size_t k = 0; k < found.ratios.size(); ++k) {
    EXPECT_FALSE(found.transfers[k].used) << found.transfers[k].geometry << ' ' << found.transfers[k].joints;
    EXPECT_LT(found.ratios[k], 1.05);
  }
}

/// Fits geometry and three orders a joint.
FittedErrorModel<Chain> fitted_plainly(const Dataset<6>& data, const ArmPrior* prior) {
  ErrorModelOptions options{.compliance = false,
                            .gear_ratio = false,
                            .coupling = false,
                            .harmonics = 3,
                            .hysteresis = false,
                            .tilt = false,
                            .drift = false,
                            .num_validation_poses = 100};
  options.prior = prior;
  const auto start = vernier_test::identify_by_gauss_newton(Framed<Chain>(robot.chain), data,
                                                            {.frames = Frames::base_and_tool}, squared);
  return fit_error_model(start, data, options, squared);
}

TEST(ArmPrior, OfAnotherNumberOfJointsIsRefused) {
  const Dataset<6> data = measured(arm(4, joint_errors(5), 0), 40, 2);
  const auto before = fitted_plainly(data, nullptr);
  ArmPrior prior = arm_prior("before", before.model(), before.first_station());
  prior.nominal = detail::ChainTable(robots::barrett_wam().chain.view());
  EXPECT_EQ(vernier_test::complaint([&] { fitted_plainly(data, &prior); }),
            "fit_error_model: the earlier calibration is of an arm of 7 joints in the standard convention");
  prior.nominal = detail::ChainTable(DhChain<6, ModifiedDh>({{}, {}, {}, {}, {}, {}}).view());
  EXPECT_EQ(vernier_test::complaint([&] { fitted_plainly(data, &prior); }),
            "fit_error_model: the earlier calibration is of an arm of 6 joints in the modified convention");
}

// What is found with an earlier calibration is where residuals and the prior N(m, S + kappa^2 V0) balance; the
// covariance is the inverse of both, times the variance of the noise over the values that they leave free.
TEST(ArmPrior, TheFitBalancesResidualsAndThePrior) {
  JointTerms terms(6);
  terms.transmission.assign(6, Fourier::up_to(3));
  Rng rng(3);
  VectorX coefficients(36), changed_coefficients(36);
  for (Index k = 0; k < 36; ++k) {
    coefficients(k) = rng.sign() * 0.2e-3;
    changed_coefficients(k) = coefficients(k) + rng.sign() * 0.06e-3;
  }
  const auto before = fitted_plainly(measured(arm(4, JointErrors(terms, coefficients), 0.4), 100, 1), nullptr);
  const ArmPrior prior = arm_prior("before", before.model(), before.first_station());
  const Dataset<6> data = measured(arm(4, JointErrors(terms, changed_coefficients), -0.7), 14, 2);
  const auto found = fitted_plainly(data, &prior);
  ASSERT_TRUE(found.prior && found.prior->used);
  ASSERT_NE(found.prior->geometry, found.prior->joints);
  ArmParameterisation at({found.arm.geometry(0)}, found.arm.geometric());
  const Index n = found.arm.terms().size(), size = at.size() + n;
  at.set_terms(found.arm.terms(), found.arm.scales().tail(n), VectorX::Zero(n));
  const auto known = detail::transferred_unknowns(prior, at, prior.nominal);
  VectorX coefficient_steps = VectorX::Zero(size);
  for (Index k = 0; k < n; ++k) coefficient_steps(size - n + k) = found.arm.steps()(size - n + k);
  at.move(coefficient_steps);
  const detail::CalibrationProblem problem(at, {vernier_test::set_of(data, squared)}, Loss::squared);
  const detail::StackedRows rows = problem.stacked(true);
  const RealMatrix jacobian = rows.jacobian, residuals = rows.residuals;
  const JointPrior balance = known.prior(size, found.prior->geometry, found.prior->joints);
  const RealMatrix information = jacobian.transpose() * jacobian + balance.precision;
  const RealMatrix offset = RealMatrix(coefficient_steps) - balance.mean;
  const RealMatrix inverse = information.inverse();
  const RealMatrix step = inverse * (jacobian.transpose() * residuals + RealMatrix(balance.precision) * offset);
  EXPECT_LT(step.over(inverse.diagonal().sqrt()).largest(), 0.02);  // of a deviation
  const double explained = static_cast<double>(size) - (inverse * balance.precision).trace();
  const double variance = (residuals.squared_norm() + offset.dot(RealMatrix(balance.precision) * offset)) /
                          (static_cast<double>(residuals.rows()) - explained);
  EXPECT_NEAR(found.residual_variance / variance, 1, 1e-3);
  const RealMatrix std = inverse.diagonal().sqrt();
  EXPECT_LT((RealMatrix(found.covariance) / found.variance_factor - inverse).over(std * std.transpose()).largest(),
            1e-3);
}

// What was measured by either of the two is covered.
TEST(ArmPrior, CoversWhatWasMeasuredBefore) {
  const JointErrors errors = joint_errors(5);
  const ArmPrior prior = prior_from(arm(4, errors, 0.4), 300);
  JointLimits<6> narrow = robot.limits;
  narrow.lower *= 0.2;
  narrow.upper *= 0.2;
  const Actual actual = arm(4, errors, -0.7);
  const Dataset<6> few = measure(actual, sample_joints(narrow, 20, 3), {.position = 0.03e-3, .orientation = 0.1e-3}, 3);
  const auto found = fitted(few, &prior);
  ASSERT_TRUE(found.prior && found.prior->used);
  const JointVector<6> far = 0.8 * robot.limits.upper;
  EXPECT_EQ(found.model().gate(far), 1);
  EXPECT_LT(found.models(Stage::jointwise).front().gate(far), 1);
  EXPECT_LT(position_errors(found.model(), measured(actual, 200, 9)).mean(), 0.1e-3);
}

// A third calibration starts from the sizes that joint errors were expected to have at first, not from none.
TEST(ArmPrior, IsHandedOnWithTheExpectedSizes) {
  const JointErrors errors = joint_errors(5);
  const ArmPrior prior = prior_from(arm(4, errors, 0.4), 300);
  const auto found = fitted(measured(arm(4, errors, -0.7), 40, 3), &prior);
  ASSERT_TRUE(found.prior && found.prior->used);
  const Index coefficients = prior.estimate.arm.terms().size();
  ASSERT_EQ(found.arm.terms().size(), coefficients);
  ASSERT_GT(coefficients, 100);
  const RealMatrix expected = prior.estimate.arm.precisions(), handed_on = found.arm.precisions();
  const Index geometric = handed_on.rows() - coefficients;
  const RealMatrix sizes = expected.block(expected.rows() - coefficients, 0, coefficients, 1);
  for (Index k = 0; k < coefficients; ++k) EXPECT_GT(sizes(k), 0);
  EXPECT_EQ(handed_on.block(geometric, 0, coefficients, 1), sizes);
  EXPECT_EQ(handed_on.block(0, 0, geometric, 1).largest(), 0);
  EXPECT_EQ(found.mean_temperature, 0);  // nobody measured any
  EXPECT_EQ(found.temperature_std, 0);
}

// All chain parameters of an earlier calibration are transferred, frames are not.
TEST(TransferredUnknownsWhiteBox, FramesAreNotTransferred) {
  const ArmPrior prior{"before",
                       detail::ChainTable(robot.chain.view()),
                       {.arm = ArmParameterisation({ArmGeometry(in_frames(robot.chain))},
                                                   {{5, -1, 1, 1}, {6, -1, 1, 1}, {35, -1, 1, 1}, {36, -1, 1, 1}})}};
  const auto unknowns = detail::with_unknowns_of(prior, {{36, -1, 1, 2}});
  ASSERT_EQ(unknowns.size(), 3u);
  EXPECT_EQ(unknowns[0].parameter, 36);
  EXPECT_EQ(unknowns[0].precision, 2);
  EXPECT_EQ(unknowns[1].parameter, 6);
  EXPECT_EQ(unknowns[2].parameter, 35);
  EXPECT_EQ(unknowns[2].precision, 0);
}

// A parameter and its change with temperature are two unknowns; where both calibrations know one, its prior is that of
// the earlier one.
TEST(TransferredUnknownsWhiteBox, WhatBothKnowHasNoPriorOfItsOwn) {
  const ArmPrior prior{
      "before",
      detail::ChainTable(robot.chain.view()),
      {.arm = ArmParameterisation({ArmGeometry(in_frames(robot.chain))}, {{7, -1, 1e-3, 1}, {8, -1, 1e-5, 1, true}})}};
  const auto unknowns = detail::with_unknowns_of(prior, {{7, -1, 2e-3, 3}, {8, -1, 3e-3, 4}, {9, -1, 4e-3, 5}});
  ASSERT_EQ(unknowns.size(), 4u);
  EXPECT_EQ(unknowns[0].precision, 0);
  EXPECT_EQ(unknowns[0].scale, 2e-3);
  EXPECT_EQ(unknowns[1].precision, 4);
  EXPECT_EQ(unknowns[2].precision, 5);
  EXPECT_TRUE(unknowns[3].thermal);
  EXPECT_EQ(unknowns[3].parameter, 8);
  EXPECT_EQ(unknowns[3].precision, 0);
}

TEST(TransferredUnknownsWhiteBox, ACovarianceThatIsNoneIsNamed) {
  const detail::TransferredUnknowns known{
      {0, 1}, 2, vector({0, 0}), RealMatrix(2, 2, {1, 3, 3, 1}), vector({1e-3, 1e-3})};
  EXPECT_EQ(vernier_test::complaint([&] { (void)known.prior(2, 0.1, 0.1); }),
            "an earlier calibration: its covariance is not positive definite");
}

// N(m, S + kappa^2 V0) of three unknowns by hand; the first is geometric.
TEST(TransferredUnknownsWhiteBox, PriorByHand) {
  const detail::TransferredUnknowns known{
      {2, 0}, 1, vector({0.5, -1}), RealMatrix(2, 2, {1, 0.5, 0.5, 2}), vector({4, 9})};
  const JointPrior prior = known.prior(3, 0.5, 2);
  // S + diag(0.25 * 4, 4 * 9) = [2, 0.5; 0.5, 38], whose determinant is 75.75
  EXPECT_EQ(prior.unknowns, 2);
  EXPECT_EQ(RealMatrix(prior.mean), vector({-1, 0, 0.5}));
  EXPECT_NEAR(prior.precision(2, 2), 38 / 75.75, 1e-12);
  EXPECT_NEAR(prior.precision(0, 0), 2 / 75.75, 1e-12);
  EXPECT_NEAR(prior.precision(0, 2), -0.5 / 75.75, 1e-12);
  EXPECT_EQ(RealMatrix(prior.precision).row(1).norm(), 0);
  EXPECT_NEAR(prior.cost(vector({0, 7, 0.5})), 2 / 75.75, 1e-12);
}

// Units, means, covariances and expected sizes of a length, its change with temperature, and two coefficients. The
// earlier covariance is that of a noise whose variance is 2.
TEST(TransferredUnknownsWhiteBox, UnitsByHand) {
  const ArmGeometry arm(in_frames(robot.chain));
  JointTerms terms(6);
  terms.transmission[1] = Fourier::up_to(1);
  ErrorModelEstimate before{.arm = ArmParameterisation({arm}, {{6, -1, 1e-3, 0}, {6, -1, 2e-5, 4, true}})};
  before.arm.set_terms(terms, vector({1e-3, 1e-3}), vector({4, 0}));
  before.arm.move(vector({3, 5, -1, 2}));  // a length by 3 mm, and by 100 um/K
  before.covariance = RealMatrix(4, 4, {0.5, 0.1, 0.2, 0, 0.1, 0.3, 0, 0, 0.2, 0, 0.7, 0, 0, 0, 0, 0.9});
  before.variance_factor = 2;
  const detail::ChainTable nominal(robot.chain.view());
  ArmParameterisation now({arm}, {{0, -1, 1e-3, 0}, {6, -1, 2e-3, 0}, {6, -1, 1e-5, 0, true}});
  now.set_terms(terms, vector({1e-3, 1e-3}), VectorX::Zero(2));
  const detail::TransferredUnknowns known = detail::transferred_unknowns({"before", nominal, before}, now, nominal);
  EXPECT_EQ(known.unknowns, (UnknownGroup{1, 2, 3, 4}));
  EXPECT_EQ(known.geometric, 2);
  EXPECT_LT((RealMatrix(known.mean) - vector({1.5, 10, -1, 2})).norm(), 1e-9);
  EXPECT_LT((RealMatrix(known.expected).over(vector({0.5, 1, 0.25, 1e6})) - vector({1, 1, 1, 1})).norm(), 1e-12);
  const RealMatrix covariance(4, 4, {0.0625, 0.05, 0.05, 0, 0.05, 0.6, 0, 0, 0.05, 0, 0.35, 0, 0, 0, 0, 0.45});
  EXPECT_LT((RealMatrix(known.covariance) - covariance).norm(), 1e-12);
}

/// Three lengths and six coefficients of an arm that was known before and has changed.
struct ChangedArm {
  JointTerms terms{6};
  VectorX sizes = VectorX::Constant(6, 1e-3);
  std::vector<GeometricUnknown> of_chain{{7, -1, 1e-3, 0}, {11, -1, 1e-3, 0}, {21, -1, 1e-3, 0}}, unknowns = of_chain;
  ArmGeometry there{Framed<Chain>(robot.chain, {}, FrameParameters(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5}))};
  ArmPrior prior{"before",
                 detail::ChainTable(robot.chain.view()),
                 {.arm = ArmParameterisation({ArmGeometry(in_frames(robot.chain))}, of_chain)}};

  ChangedArm() {
    terms.transmission[1] = terms.transmission[2] = terms.transmission[4] = Fourier::up_to(1);
    for (Index k = 0; k < 6; ++k) unknowns.push_back({k, -1, 1e-3, 0});
    prior.estimate.arm.set_terms(terms, sizes, VectorX::Constant(6, 4));
    prior.estimate.covariance = 1e-4 * MatrixX::Identity(9, 9);
    prior.estimate.variance_factor = 2;  // of its noise; expected variances are then 1 / 2 and 1 / 4
  }

  Dataset<6> measured(Index poses, std::uint64_t seed) const {
    Rng rng(seed);
    VectorX values = there.parameters(), coefficients(6);
    const double geometry = std::pow(10, rng.uniform(-1.5, 0.5)), joints = std::pow(10, rng.uniform(-1.5, 0.2));
    for (Index k = 0; k < 3; ++k) values(k) += 0.03 * rng.sign();  // it stands somewhere else
    for (const GeometricUnknown& u : of_chain) values(u.parameter) += rng.normal() * geometry * 1e-3;
    for (double& c : coefficients) c = rng.normal() * joints * 1e-3;
    const FittedArm actual{there.with_parameters(values), JointErrors(terms, coefficients)};
    return measure(actual.typed(robot.chain), sample_joints(robot.limits, poses, seed),
                   {.position = 0.06e-3, .orientation = 0.2e-3}, seed);
  }

  detail::CalibrationProblem problem(std::span<const Dataset<6>> stations) const {
    const SensorModel sensors{.position_sigma = 0.03e-3, .orientation_sigma = 0.1e-3, .loss = Loss::squared};
    std::vector<MeasuredSet> measured;
    for (const Dataset<6>& data : stations) measured.push_back(vernier_test::set_of(data, sensors));
    detail::CalibrationProblem out(ArmParameterisation(std::vector(stations.size(), there), unknowns), measured,
                                   Loss::squared);
    out.arm.set_terms(terms, sizes, VectorX::Zero(6));
    return out;
  }
};

// The likelihood of residuals, at the mean of the prior, in the directions that unknowns of the later calibration alone
// do not reach (restricted likelihood), over all variances of the noise: at what is chosen it is as large as anywhere
// on the grid. Of positions and of poses.
TEST(TransferredUnknownsWhiteBox, TheLikelyTransferHasMostRestrictedLikelihood) {
  const ChangedArm arm;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Dataset<6> data = arm.measured(9, seed);
    if (seed % 2 == 0) data = data.without_orientations();
    detail::CalibrationProblem problem = arm.problem({&data, 1});
    VectorX now(15);  // where the fit stands, from where it started
    for (Index k = 0; k < 15; ++k) now(k) = 0.5 * std::cos(static_cast<double>(k));
    problem.arm.move(now);
    const auto known = detail::transferred_unknowns(arm.prior, problem.arm, arm.prior.nominal);
    RealMatrix missing(9, 1);  // from there to the mean of the prior
    for (Index k = 0; k < 9; ++k) missing(k) = known.mean(k) - now(k < 3 ? k : k + 6);
    const PriorTransfer found = detail::likely_transfer(problem, known);
    const detail::StackedRows rows = problem.stacked(true);
    const RealMatrix jacobian = rows.jacobian, all = RealMatrix::identity(rows.residuals.size());
    RealMatrix shared(rows.residuals.size(), 9);  // of chain and joints; the frame is the later one's own
    shared.set_block(0, 0, jacobian.block(0, 0, shared.rows(), 3));
    shared.set_block(0, 3, jacobian.block(0, 9, shared.rows(), 6));
    const RealMatrix own = jacobian.block(0, 3, shared.rows(), 6);
    // instead of a basis of the rest: a variance of `own` that is large, its own determinant taken off
    const RealMatrix gram = own.transpose() * own;
    const auto likelihood = [&](double g, double j) {
      RealMatrix variances(9, 1);
      for (Index k = 0; k < 9; ++k) variances(k) = 0.5e-4 + (k < 3 ? g * g / 2 : j * j / 4);
      const RealMatrix covariance = all + shared * RealMatrix::diagonal(variances) * shared.transpose();
      const RealMatrix inverse = covariance.inverse(), middle = own.transpose() * inverse * own;
      const RealMatrix error = RealMatrix(rows.residuals) + shared * missing;
      const RealMatrix seen = own.transpose() * inverse * error;
      const double square = error.dot(inverse * error) - seen.dot(middle.inverse() * seen);
      const double freedom = static_cast<double>(all.rows() - 6);
      return -0.5 * (freedom * std::log(square / freedom) + covariance.log_determinant() + middle.log_determinant() -
                     gram.log_determinant());
    };
    double most = -1e300;
    for (const double g : {0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2})
      for (const double j : {0.02, 0.05, 0.1, 0.15, 0.2, 0.4, 0.8, 1.6}) most = std::max(most, likelihood(g, j));
    EXPECT_GT(likelihood(found.geometry, found.joints), most - 1e-3) << seed;
  }
}

}  // namespace
}  // namespace vernier::arm_prior_test
