// SPDX-License-Identifier: BSD-3-Clause
// What an identification reports of its own accuracy, from few poses and without Ceres.

#include "vernier/identification/detail/identification.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gauss_newton.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/least_squares/loss.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::identification_test {
namespace {

using vernier_test::identify_by_gauss_newton;
using vernier_test::RealMatrix;
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
      {vernier_test::set_of(data, sensors)}, Loss::squared);
  return problem.stacked(true);
}

/// Expected sizes of the free parameters, as a diagonal matrix.
RealMatrix scales_of(const Identified<Chain>& found) {
  const auto n = static_cast<Index>(found.free.size());
  RealMatrix out(n, n);
  for (Index k = 0; k < n; ++k)
    out(k, k) = found.parameters[static_cast<std::size_t>(found.free[static_cast<std::size_t>(k)])].scale;
  return out;
}

/// Largest difference of two covariances, relative to the deviations.
double relative_difference(const RealMatrix& a, const RealMatrix& b) {
  const RealMatrix std = b.diagonal().sqrt();
  return (a - b).over(std * std.transpose()).largest();
}

/// J'J.
RealMatrix information_of(const detail::StackedRows& rows) {
  const RealMatrix jacobian = rows.jacobian;
  return jacobian.transpose() * jacobian;
}

/// r'r.
double square_sum(const detail::StackedRows& rows) { return RealMatrix(rows.residuals).squared_norm(); }

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
  const double variance = square_sum(rows) / static_cast<double>(45 - p);
  const RealMatrix scales = scales_of(found), wanted = variance * scales * information_of(rows).inverse() * scales;
  EXPECT_LT(relative_difference(found.covariance, wanted), 1e-6);
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
  RealMatrix variance(72, 72);
  for (Index i = 0; i < 72; ++i)
    variance(i, i) = factor * square[rows.of_orientation[static_cast<std::size_t>(i)] ? 1 : 0];
  const RealMatrix half = information_of(rows).inverse() * RealMatrix(rows.jacobian).transpose();
  const RealMatrix scales = scales_of(found), wanted = scales * half * variance * half.transpose() * scales;
  EXPECT_LT(relative_difference(found.covariance, wanted), 1e-6);
}

TEST(IdentificationWhiteBox, ARobustLossTakesTheMedianForTheScale) {
  SensorModel huber = squared;
  huber.loss = Loss::huber;
  const Dataset<6> data = measured(20, 3);
  const auto found = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                              {.frames = Frames::base_and_tool, .priors = false}, huber);
  ASSERT_TRUE(found.converged()) << found.message;
  const detail::StackedRows rows = rows_of(found, data, huber);
  const RealMatrix residuals = rows.residuals;
  std::vector<double> norms;
  for (Index b = 0; b < 20; ++b) norms.push_back(residuals.block(3 * b, 0, 3, 1).norm());
  const double sigma = robust_sigma(norms, 3), factor = 60.0 / static_cast<double>(60 - found.free.size());
  const RealMatrix scales = scales_of(found),
                   wanted = sigma * sigma * factor * scales * information_of(rows).inverse() * scales;
  EXPECT_LT(relative_difference(found.covariance, wanted), 1e-6);
}

// Links have priors, whose width follows from evidence; their covariance is that of rows and priors together.
TEST(IdentificationWhiteBox, CovarianceOfLinksHasTheirPriors) {
  constexpr double size = 1e-3;  // of the errors [m, rad], fifty times as large as expected
  const Dataset<6> data =
      measured(20, 5, false, {.length_min = size / 4, .length_max = size, .angle_min = size / 4, .angle_max = size});
  const auto identified = [&](bool priors) {
    return identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                    {.frames = Frames::base_and_tool,
                                     .priors = priors,
                                     .length_prior_std = 20e-6,
                                     .angle_prior_std = 20e-6,
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
  EXPECT_NEAR(held.residual_variance, square_sum(rows_of(loose, data, squared)) / (60 - static_cast<double>(p)), 1e-6);
  const double freedom = static_cast<double>(60 - p);
  const double before = square_sum(rows_of(loose, data, squared)) / freedom;
  const detail::StackedRows rows = rows_of(held, data, squared);
  const double after = square_sum(rows) / freedom;
  RealMatrix precisions(p, p), variances(p, p);  // diagonal
  for (Index k = 0; k < p; ++k) {
    const auto at = static_cast<std::size_t>(held.free[static_cast<std::size_t>(k)]);
    const ParameterEstimate &of_k = held.parameters[at], &without = loose.parameters[at];
    const bool chain = at >= 6 && at < 36;
    EXPECT_EQ(of_k.state == ParameterState::weak, chain && without.std > without.scale) << of_k.name;
    if (!chain) {
      EXPECT_TRUE(std::isinf(of_k.prior_std)) << of_k.name;
      continue;
    }
    const double width = of_k.prior_std / of_k.scale;
    EXPECT_GT(width, 10) << of_k.name;
    EXPECT_LT(width, 150) << of_k.name;
    precisions(k, k) = before / (width * width);
    variances(k, k) = width * width;
    EXPECT_LT(of_k.std, of_k.prior_std) << of_k.name;
  }
  const RealMatrix information = information_of(rows), inverse = (information + precisions).inverse(),
                   middle = after * information + precisions * variances * precisions;
  const RealMatrix scales = scales_of(held), wanted = scales * inverse * middle * inverse * scales;
  EXPECT_LT(relative_difference(held.covariance, wanted), 1e-6);
}

// Errors far below the noise: others do not predict left-out poses better than the links as designed.
TEST(IdentificationWhiteBox, LinksThatNothingShowsStayAsDesigned) {
  const Dataset<6> data =
      measured(20, 5, false, {.length_min = 5e-6, .length_max = 20e-6, .angle_min = 5e-6, .angle_max = 20e-6});
  const auto found = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                              {.frames = Frames::base_and_tool}, squared);
  EXPECT_TRUE(found.converged());
  EXPECT_TRUE(found.links_as_designed);
  EXPECT_EQ(found.free, (std::vector<Index>{0, 1, 2, 3, 4, 5, 36, 37, 38}));
  EXPECT_EQ(found.covariance.rows(), 9);
  EXPECT_TRUE(found.model.identified().model() == robot.chain);
  EXPECT_NE(found.summary().find("The links stay as designed"), std::string::npos);
}

// The errors are those of the arms before and after: frames alone, then all parameters.
TEST(IdentificationWhiteBox, ErrorsAreThoseOfTheIdentifiedArm) {
  const Dataset<6> data = measured(30, 7, true);
  const auto found = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                              {.frames = Frames::base_and_tool, .priors = false}, squared);
  double squares = 0, angles = 0;
  for (Index i = 0; i < 30; ++i) {
    const Isometry3 pose = found.model.identified().pose(data.joints(i));
    squares += (translation(pose) - data.position(i)).squaredNorm() / 30;
    angles += std::pow(Eigen::AngleAxisd(rotation(pose).transpose() * data.orientation(i)).angle(), 2) / 30;
  }
  EXPECT_NEAR(found.rms_after, std::sqrt(squares), 1e-12);
  EXPECT_NEAR(found.rotation_rms_after, std::sqrt(angles), 1e-10);
  EXPECT_GT(found.rotation_rms_after, 0.1e-3);  // of noise of 0.1 mrad about three axes
  // before, the frames alone are registered
  const auto registered = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), data,
                                                   {.frames = Frames::base_and_tool, .geometry = false}, squared);
  EXPECT_NEAR(found.rms_before, registered.rms_after, 1e-9);
  EXPECT_GE(found.iterations, 400);  // each solve counts its 200 iterations
  EXPECT_EQ(found.iterations % 200, 0);
  EXPECT_GT(found.rms_before, 5 * found.rms_after);
  // whitened rows in steps of expected sizes
  const RealMatrix jacobian = rows_of(found, data, squared).jacobian;
  const RealMatrix values = jacobian.singular_values();
  const Observability expected = Observability::of(values, 30);
  EXPECT_NEAR(found.observability.o1, expected.o1, 1e-5 * expected.o1);
  EXPECT_NEAR(found.observability.o3, expected.o3, 1e-5 * expected.o3);
  EXPECT_NEAR(found.condition, values(0) / values(values.rows() - 1), 1e-5 * found.condition);
  EXPECT_EQ(found.rank, values.rows());
  EXPECT_EQ(found.message.find("Gauss-Newton after "), 0u) << found.message;
  const auto positions = identify_by_gauss_newton(Framed<Chain>(robot.chain, base, tool), measured(30, 7),
                                                  {.frames = Frames::base_and_tool, .priors = false}, squared);
  EXPECT_EQ(positions.rotation_rms_after, 0);
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
  EXPECT_NE(exact.message.find("1 pose gives 6 measured values, which determine only 6 of the 6 parameters"),
            std::string::npos)
      << exact.message;
  EXPECT_EQ(identify_by_gauss_newton(arm, measured(2, 6, true), base_alone, squared).status, IdentifyStatus::converged);
}

// The residual of a distance is a single number, so its median is another multiple of the standard deviation; the
// reported errors are those of distances.
TEST(IdentificationWhiteBox, ErrorsAndScaleOfDistances) {
  const Framed<Chain> actual(robot.chain, base, tool);
  const Distances<6> data = measure_distances(actual, Vector3(0.3, -1, 0.5),
                                              abb_irb120_operating_region().sample(robot.chain, 40, 8), 0.1e-3, 9);
  SensorModel huber{.distance_sigma = 0.05e-3, .loss = Loss::huber};
  const auto found =
      identify_by_gauss_newton(actual, data, {.frames = Frames::base, .geometry = false, .priors = false}, huber);
  ASSERT_TRUE(found.converged()) << found.message;
  ASSERT_EQ(found.free, (std::vector<Index>{0, 1, 2}));
  for (std::size_t k = 3; k < 6; ++k) {  // by the structure of a distance, and not by these poses
    EXPECT_EQ(found.parameters[k].state, ParameterState::not_identifiable);
    EXPECT_EQ(found.parameters[k].remark, "absorbed by base_x, base_y, base_z");
  }
  std::vector<double> off;
  double squares = 0;
  RealMatrix jacobian(40, 3);
  for (Index i = 0; i < 40; ++i) {
    const Vector3 point = found.model.identified().position(data.joints(i));
    off.push_back(std::abs(point.norm() - data.lengths()(i)));
    squares += off.back() * off.back() / 40;
    for (Index c = 0; c < 3; ++c) jacobian(i, c) = point(c) / point.norm();
  }
  EXPECT_NEAR(found.rms_after, std::sqrt(squares), 1e-12);
  std::sort(off.begin(), off.end());
  const double sigma = off[20] / 0.6745;
  const RealMatrix wanted = sigma * sigma * (40.0 / 37) * (jacobian.transpose() * jacobian).inverse();
  EXPECT_LT(relative_difference(found.covariance, wanted), 1e-6);
}

/// The estimate of a parameter, by name.
ParameterEstimate named(const IdentificationReport& report, const std::string& name) {
  for (const ParameterEstimate& p : report.parameters)
    if (p.name == name) return p;
  ADD_FAILURE() << name;
  return {};
}

// Why a parameter is dependent: by the structure of arm and sensor, or for want of poses.
TEST(IdentificationWhiteBox, SaysWhatAbsorbsAParameter) {
  const FrameParameters straight(Vector6{0.02, 0.01, 0.11, 0, 0, 0});
  const Framed<Chain> nominal(robot.chain, base, straight);
  const IdentifyOptions everything{.frames = Frames::base_and_tool, .priors = false};
  const Dataset<6> data = measure(Framed<Chain>(with_geometric_errors(robot.chain, {}, 4), base, straight),
                                  abb_irb120_operating_region().sample(robot.chain, 40, 11),
                                  {.position = 0.1e-3, .orientation = 0.1e-3}, 11);
  const auto positions = identify_by_gauss_newton(nominal, data.without_orientations(), everything, squared);
  EXPECT_TRUE(positions.converged()) << positions.message;
  for (const char* name : {"tool_rx", "tool_ry", "tool_rz"}) {
    EXPECT_EQ(named(positions, name).state, ParameterState::not_identifiable);
    EXPECT_EQ(named(positions, name).remark, "no effect on what was measured");
  }
  EXPECT_EQ(named(positions, "theta6").remark, "absorbed by tool_x, tool_y");
  const auto poses = identify_by_gauss_newton(nominal, data, everything, squared);
  EXPECT_TRUE(poses.converged()) << poses.message;
  for (std::size_t k = 6; k < 36; ++k) {  // links that were not estimated are as they were
    const ParameterEstimate& p = poses.parameters[k];
    EXPECT_EQ(p.identified == p.nominal, p.state != ParameterState::identified) << p.name;
    EXPECT_EQ(p.remark.empty(), p.state != ParameterState::not_identifiable) << p.name;
  }
  EXPECT_EQ(named(poses, "tool_rz").state, ParameterState::identified);
  EXPECT_EQ(named(poses, "theta6").state, ParameterState::not_identifiable);
  EXPECT_EQ(named(poses, "theta6").remark, "absorbed by tool_rz");
  EXPECT_EQ(named(poses, "d1").remark.rfind("absorbed by base_", 0), 0u) << named(poses, "d1").remark;

  // the elbow never moves: upper arm and forearm are one link
  JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, 40, 12);
  for (Index i = 0; i < 40; ++i) joints(i, 2) = 0.3;
  const auto stiff = identify_by_gauss_newton(
      nominal,
      measure(Framed<Chain>(robot.chain, base, straight), joints, {.position = 0.1e-3, .orientation = 0.1e-3}, 3),
      everything, squared);
  EXPECT_EQ(stiff.status, IdentifyStatus::underdetermined);
  EXPECT_NE(stiff.message.find("40 poses give 240 measured values, which determine only "), std::string::npos)
      << stiff.message;
  EXPECT_EQ(named(stiff, "theta3").state, ParameterState::not_identifiable);
  EXPECT_EQ(named(stiff, "theta3").remark.rfind("at these poses indistinguishable from ", 0), 0u)
      << named(stiff, "theta3").remark;
  EXPECT_EQ(named(stiff, "theta6").remark, "absorbed by tool_rz");
  // an arm that does not move tells three values
  for (Index i = 0; i < 40; ++i)
    for (Index j = 0; j < 6; ++j) joints(i, j) = joints(0, j);
  const auto still = identify_by_gauss_newton(
      nominal, measure(Framed<Chain>(robot.chain, base, straight), joints, {.with_orientations = false}, 3),
      {.priors = false}, squared);
  EXPECT_EQ(still.status, IdentifyStatus::underdetermined);
  EXPECT_EQ(still.free.size(), 3u);
}

// At most four of the parameters that absorb another are named.
TEST(IdentificationWhiteBox, NamesFourOfWhatAbsorbsAParameter) {
  const FrameParameters far(Vector6{0.8, -0.7, 0.3, 0.2, -0.1, 0.5});
  const Framed<Chain> arm(robot.chain, base, far);
  const auto found =
      identify_by_gauss_newton(arm, measure(arm, abb_irb120_operating_region().sample(robot.chain, 40, 11), {}, 1),
                               {.frames = Frames::base_and_tool, .priors = false}, squared);
  EXPECT_EQ(named(found, "theta6").remark, "absorbed by tool_x, tool_y, tool_rx, tool_ry, ...");
}

/// A UR10 as made, whose parallel axes are no longer so, identified from the nominal arm.
auto identified_parallel_arm(bool hayati) {
  const Robot<6> parallel = robots::ur10();
  const Framed<Chain> actual(with_geometric_errors(parallel.chain, {}, 9), base, tool);
  JointLimits<6> limits;
  limits.lower.setConstant(-2.5);
  limits.upper.setConstant(2.5);
  return identify_by_gauss_newton(Framed<Chain>(parallel.chain, base, tool),
                                  measure(actual, sample_joints(limits, 60, 3), {.with_orientations = false}),
                                  {.frames = Frames::base_and_tool, .hayati = hayati, .priors = false}, squared);
}

// Parameters that are dependent where axes are parallel exactly are not so in an arm as it is made.
TEST(IdentificationWhiteBox, WhatIsDependentAtNominalMayBeFreeAtTheSolution) {
  const auto found = identified_parallel_arm(true);
  EXPECT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.free.size(), 27u);  // 4 R + 6 - 3 of six revolute joints
  EXPECT_LT(found.rms_after, 1e-7);
}

// The same by classical parameters: offsets of parallel axes are one unknown until the axes are found not to be
// parallel.
TEST(IdentificationWhiteBox, OffsetsOfParallelAxesAreFreeWhereAxesAreNot) {
  const auto found = identified_parallel_arm(false);
  EXPECT_EQ(found.free.size(), 27u);  // 4 R + 6 - 3 again
  EXPECT_LT(found.rms_after, 1e-7);
}

TEST(IdentificationWhiteBox, ASolverThatGivesUpIsReported) {
  const Framed<Chain> arm(robot.chain, base, tool);
  const Dataset<6> data = measured(30, 7);
  const auto gives_up = [](detail::CalibrationProblem&, int) { return SolverSummary{false, 3, "gave up"}; };
  const auto found = detail::identify_geometry(ArmGeometry(arm), {vernier_test::set_of(data, squared)},
                                               {.frames = Frames::base_and_tool, .priors = false}, squared, gives_up);
  EXPECT_EQ(found.report.status, IdentifyStatus::not_converged);
  EXPECT_EQ(found.report.message, "gave up");
}

// Expected sizes by kind of parameter; beta in place of d where axes are parallel; frames before the chain.
TEST(IdentificationPlanWhiteBox, ScalesAndCandidates) {
  const ArmGeometry arm(Framed<Chain>(robot.chain, base, tool));
  const IdentifyOptions options{.frames = Frames::tool,
                                .fixed = {"a2", "tool_y"},
                                .length_prior_std = 2e-3,
                                .angle_prior_std = 3e-3,
                                .joint_zero_prior_std = 5e-3};
  const detail::IdentificationPlan plan(arm, options);
  std::vector<std::string> candidates, frames;
  for (const Index k : plan.candidates) candidates.push_back(plan.names[static_cast<std::size_t>(k)]);
  for (const Index k : plan.frames) frames.push_back(plan.names[static_cast<std::size_t>(k)]);
  EXPECT_EQ(frames, (std::vector<std::string>{"tool_x", "tool_z", "tool_rx", "tool_ry", "tool_rz"}));
  std::vector<std::string> expected = frames;
  for (int j = 1; j <= 6; ++j)
    for (const std::string name : {"a", "alpha", "d", "theta", "beta"}) {
      const bool parallel = j == 2;
      if (name == (parallel ? "d" : "beta") || (name == "a" && j == 2)) continue;
      expected.push_back(name + std::to_string(j));
    }
  EXPECT_EQ(candidates, expected);
  for (Index k = 0; k < plan.scales.size(); ++k) {
    const std::string& name = plan.names[static_cast<std::size_t>(k)];
    const bool frame = name.starts_with("base") || name.starts_with("tool"), zero = name.starts_with("theta");
    const bool length = name.size() == 2 && (name[0] == 'a' || name[0] == 'd');
    EXPECT_EQ(plan.scales(k), frame ? 10e-3 : length ? 2e-3 : zero ? 5e-3 : 3e-3) << name;
  }
  const detail::IdentificationPlan of_base(arm, {.frames = Frames::base, .geometry = false});
  EXPECT_EQ(of_base.candidates, (std::vector<Index>{0, 1, 2, 3, 4, 5}));
  const detail::IdentificationPlan with_d(arm, {.hayati = false});
  EXPECT_EQ(with_d.candidates.size(), 24u);
  for (const Index k : with_d.candidates) EXPECT_FALSE(with_d.names[static_cast<std::size_t>(k)].starts_with("beta"));
}

}  // namespace
}  // namespace vernier::identification_test
