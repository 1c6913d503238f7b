// What an identification reports of its own accuracy, from few poses and without Ceres.

#include "vernier/identification/detail/identification.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "gauss_newton.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/least_squares/loss.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::identification_test {
namespace {

using vernier_test::identify_by_gauss_newton;
using Chain = DhChain<6>;

const Robot<6> robot = robots::abb_irb120();
const FrameParameters base(Vector6{0.4, -0.3, 0.2, 0.3, -0.4, 0.6}), tool(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5});
const SensorModel squared{.position_sigma = 0.05e-3, .orientation_sigma = 0.2e-3, .loss = Loss::squared};

/// Few poses of an arm that is off by noise.
Dataset<6> measured(Index poses, std::uint64_t seed, bool oriented = false, const GeometricErrors& errors = {}) {
  const Framed<Chain> actual(with_geometric_errors(robot.chain, errors, 4), base, tool);
  return measure(actual, abb_irb120_operating_region().sample(robot.chain, poses, seed),
                 {.position = 0.1e-3, .orientation = 0.1e-3, .with_orientations = oriented}, seed);
}

/// The rows of an identified problem at its solution, in steps of expected sizes.
detail::StackedRows rows_of(const Identified<Chain>& found, const Dataset<6>& data, const SensorModel& sensors) {
  std::vector<GeometricUnknown> unknowns;
  for (const Index k : found.free) unknowns.push_back({k, -1, found.parameters[static_cast<std::size_t>(k)].scale, 0});
  const detail::CalibrationProblem problem(
      ArmParameterisation({ArmGeometry(found.model.identified())}, std::move(unknowns)),
      {detail::station_of(data, sensors)}, Loss::squared);
  return problem.stacked(true);
}

VectorX scales_of(const Identified<Chain>& found) {
  VectorX out(static_cast<Index>(found.free.size()));
  for (Index k = 0; k < out.size(); ++k)
    out(k) = found.parameters[static_cast<std::size_t>(found.free[static_cast<std::size_t>(k)])].scale;
  return out;
}

/// Largest difference of two covariances, relative to the deviations.
double difference(const MatrixX& a, const MatrixX& b) {
  const VectorX std = b.diagonal().cwiseSqrt();
  return ((a - b).array() / (std * std.transpose()).array()).abs().maxCoeff();
}

// s^2 (J'J)^-1 in units of the parameters, s^2 the sum of squares over values minus estimated parameters: of 45 values
// and 27 parameters that is 2.5 times their mean.
TEST(IdentificationWhiteBox, CovarianceCountsTheFreeParameters) {
  const Dataset<6> data = measured(15, 1);
  const auto found = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                              {.frames = Frames::base_and_tool, .priors = false}, squared);
  ASSERT_TRUE(found.converged()) << found.message;
  const auto p = static_cast<Index>(found.free.size());
  ASSERT_EQ(p, 27);
  const detail::StackedRows rows = rows_of(found, data, squared);
  const double variance = rows.residuals.squaredNorm() / static_cast<double>(45 - p);
  const VectorX scales = scales_of(found);
  const MatrixX wanted =
      variance * (scales.asDiagonal() * (rows.jacobian.transpose() * rows.jacobian).inverse() * scales.asDiagonal());
  EXPECT_LT(difference(found.covariance, wanted), 1e-6);
  for (Index k = 0; k < p; ++k) {
    const ParameterEstimate& of_k = found.parameters[static_cast<std::size_t>(found.free[static_cast<std::size_t>(k)])];
    EXPECT_NEAR(of_k.std, std::sqrt(wanted(k, k)), 1e-6 * of_k.std) << of_k.name;
    EXPECT_EQ(of_k.state, ParameterState::identified);
  }
}

// Sensors of unequal accuracy, both of unknown scale: each has its own factor.
TEST(IdentificationWhiteBox, EverySensorHasItsOwnScale) {
  const Dataset<6> data = measured(12, 2, true);
  const auto found = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                              {.frames = Frames::base_and_tool, .priors = false}, squared);
  ASSERT_TRUE(found.converged()) << found.message;
  const detail::StackedRows rows = rows_of(found, data, squared);
  const double factor = 72.0 / static_cast<double>(72 - found.free.size());
  double square[2] = {0, 0};
  for (Index i = 0; i < 72; ++i)
    square[rows.of_orientation[static_cast<std::size_t>(i)] ? 1 : 0] += rows.residuals(i) * rows.residuals(i) / 36;
  EXPECT_GT(square[0], 4 * square[1]);  // of 0.1 mm to 0.05, and 0.1 mrad to 0.2
  VectorX variance(72);
  for (Index i = 0; i < 72; ++i)
    variance(i) = factor * square[rows.of_orientation[static_cast<std::size_t>(i)] ? 1 : 0];
  const MatrixX half = (rows.jacobian.transpose() * rows.jacobian).inverse() * rows.jacobian.transpose();
  const VectorX scales = scales_of(found);
  const MatrixX wanted = scales.asDiagonal() * (half * variance.asDiagonal() * half.transpose()) * scales.asDiagonal();
  EXPECT_LT(difference(found.covariance, wanted), 1e-6);
}

TEST(IdentificationWhiteBox, ARobustLossTakesTheMedianForTheScale) {
  SensorModel huber = squared;
  huber.loss = Loss::huber;
  const Dataset<6> data = measured(20, 3);
  const auto found = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                              {.frames = Frames::base_and_tool, .priors = false}, huber);
  ASSERT_TRUE(found.converged()) << found.message;
  const detail::StackedRows rows = rows_of(found, data, huber);
  std::vector<double> norms;
  for (Index b = 0; b < 20; ++b) norms.push_back(rows.residuals.segment<3>(3 * b).norm());
  const double sigma = robust_sigma(norms, 3), factor = 60.0 / static_cast<double>(60 - found.free.size());
  const VectorX scales = scales_of(found);
  const MatrixX wanted =
      sigma * sigma * factor *
      (scales.asDiagonal() * (rows.jacobian.transpose() * rows.jacobian).inverse() * scales.asDiagonal());
  EXPECT_LT(difference(found.covariance, wanted), 1e-6);
}

// Errors, and what is expected of them, far below the noise: then parameters of the chain are weak, and their
// covariance is that of rows and priors together.
TEST(IdentificationWhiteBox, CovarianceOfWeakParametersHasTheirPriors) {
  const Dataset<6> data =
      measured(20, 5, false, {.length_min = 5e-6, .length_max = 20e-6, .angle_min = 5e-6, .angle_max = 20e-6});
  const auto identified = [&](bool priors) {
    return identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                    {.frames = Frames::base_and_tool,
                                     .priors = priors,
                                     .length_prior_std = 20e-6,
                                     .angle_prior_std = 1e-3,
                                     .joint_zero_prior_std = 20e-6},
                                    squared);
  };
  const auto loose = identified(false), held = identified(true);
  ASSERT_TRUE(loose.converged() && held.converged());
  ASSERT_EQ(loose.free, held.free);
  const auto p = static_cast<Index>(held.free.size());
  const std::vector<std::string> weak = held.names(ParameterState::weak);
  ASSERT_GE(weak.size(), 3u);
  ASSERT_GE(p, static_cast<Index>(weak.size()) + 6);
  const double freedom = static_cast<double>(60 - p);
  const double before = rows_of(loose, data, squared).residuals.squaredNorm() / freedom;
  const detail::StackedRows rows = rows_of(held, data, squared);
  const double after = rows.residuals.squaredNorm() / freedom;
  VectorX precisions = VectorX::Zero(p), variances = precisions;
  for (Index k = 0; k < p; ++k) {
    const auto at = static_cast<std::size_t>(held.free[static_cast<std::size_t>(k)]);
    const ParameterEstimate &of_k = held.parameters[at], &without = loose.parameters[at];
    const bool chain = at >= 6 && at < 36;
    EXPECT_EQ(of_k.state == ParameterState::weak, chain && without.std > without.scale) << of_k.name;
    if (of_k.state != ParameterState::weak) {
      EXPECT_TRUE(std::isinf(of_k.prior_std)) << of_k.name;
      continue;
    }
    const double width = of_k.prior_std / of_k.scale;
    EXPECT_TRUE(std::abs(width - 1) < 1e-12 || std::abs(width - 3) < 1e-12 || std::abs(width - 10) < 1e-12) << width;
    precisions(k) = before / (width * width);
    variances(k) = width * width;
    EXPECT_LT(of_k.std, of_k.prior_std) << of_k.name;
    EXPECT_LT(of_k.std, without.std) << of_k.name;
  }
  const MatrixX information = rows.jacobian.transpose() * rows.jacobian;
  const MatrixX inverse = (information + MatrixX(precisions.asDiagonal())).inverse();
  const MatrixX middle =
      after * information + MatrixX(precisions.cwiseProduct(variances).cwiseProduct(precisions).asDiagonal());
  const VectorX scales = scales_of(held);
  const MatrixX wanted = scales.asDiagonal() * (inverse * middle * inverse) * scales.asDiagonal();
  EXPECT_LT(difference(held.covariance, wanted), 1e-6);
}

// Six values and six parameters: nothing is left over that would say whether the model holds.
TEST(IdentificationWhiteBox, AsManyValuesAsParametersAreTooFew) {
  const Framed<Chain> arm(robot.chain, base, tool);
  const IdentifyOptions base_alone{.frames = Frames::base, .geometry = false};
  const auto exact = identify_by_gauss_newton(arm, measured(1, 6, true), base_alone, squared);
  EXPECT_EQ(exact.free.size(), 6u);
  EXPECT_EQ(exact.rank, 6);
  EXPECT_EQ(exact.status, IdentifyStatus::underdetermined);
  EXPECT_FALSE(exact.converged());
  EXPECT_NE(exact.message.find("1 poses give 6 measured values, which determine only 6 of the 6 parameters"),
            std::string::npos)
      << exact.message;
  EXPECT_EQ(identify_by_gauss_newton(arm, measured(2, 6, true), base_alone, squared).status, IdentifyStatus::converged);
}

}  // namespace
}  // namespace vernier::identification_test
