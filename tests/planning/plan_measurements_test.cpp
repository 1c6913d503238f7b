#include "vernier/planning/plan_measurements.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

MeasurementCandidates<6> some_candidates(Index n, std::uint64_t seed) {
  MeasurementCandidates<6> out;
  out.joints = abb_irb120_operating_region().sample(robots::abb_irb120().chain, n, seed);
  out.previous = out.joints;
  for (Index i = 1; i < n; ++i) set_configuration(out.previous, i, configuration(out.joints, i - 1));
  return out;
}

/// Configurations that were measured, wherever.
Measurements<6> as_measured(const MeasurementCandidates<6>& at) {
  if (at.joints.rows() == 0) return {};
  const Dataset<6> data(at.joints, PointRows::Zero(at.joints.rows(), 3));
  return at.previous.rows() > 0 ? data.approached_from(at.previous) : data.without_approach();
}

PlanOptions few_harmonics(Index count) {
  PlanOptions out{.count = count};
  out.errors.harmonics = 6;
  return out;
}

/// Candidates that differ in their first two joints alone, by the same.
MeasurementCandidates<6> in_a_row(const std::vector<double>& values) {
  MeasurementCandidates<6> out;
  out.joints.resize(static_cast<Index>(values.size()), 6);
  for (std::size_t i = 0; i < values.size(); ++i)
    set_configuration(out.joints, static_cast<Index>(i), JointVector<6>(values[i], values[i], 0.3, 0.7, -0.4, 1));
  return out;
}

// Each column of the rows is the change of the pose by one prior size of one unknown, over the sensor's deviation.
TEST(PlanMeasurements, RowsAreDerivativesOfThePose) {
  const auto robot = robots::abb_irb120();
  const MeasurementCandidates<6> at = some_candidates(5, 1);
  detail::PlannedCalibration planned{
      ArmGeometry(in_frames(robot.chain)), {.frames = Frames::base_and_tool}, {.harmonics = 4}, {}, true, 30};
  const RealMatrix rows = detail::expected_rows(planned, at.joints, at.previous);
  const JointTerms terms = detail::allowed_terms(planned.nominal.chain(), planned.errors, 30);
  const VectorX sizes = detail::expected_sizes(terms, planned.errors, detail::spectra_of(planned.errors, 6));
  EXPECT_TRUE(terms.gear_ratio && terms.coupling && terms.gravity && terms.tilt && !terms.hysteresis.empty());
  const Index geometric = rows.cols() - terms.size();
  constexpr double step = 1e-3;  // prior sizes
  for (Index k = 0; k < terms.size(); ++k) {
    std::array<std::vector<Isometry3>, 2> ends;
    for (const int sign : {0, 1}) {
      VectorX coefficients = VectorX::Zero(terms.size());
      coefficients(k) = (sign ? 1 : -1) * step * sizes(k);
      const WithJointErrors<DhChain<6>> arm(robot.chain, JointErrors(terms, coefficients));
      for (Index i = 0; i < 5; ++i) {
        const JointVector<6> from = configuration(at.previous, i);
        ends[static_cast<std::size_t>(sign)].push_back(arm.pose_from(from.data(), configuration(at.joints, i)));
      }
    }
    for (Index i = 0; i < 5; ++i) {
      const auto& low = ends[0][static_cast<std::size_t>(i)];
      const auto& high = ends[1][static_cast<std::size_t>(i)];
      const Vector3 shift = translation(high) - translation(low),
                    turn = log_so3(rotation(composed(high, inverse_of(low))));
      RealMatrix expected(6, 1);
      expected.set_block(0, 0, RealMatrix(shift) / (2 * step * planned.sensors.position_sigma));
      expected.set_block(3, 0, RealMatrix(turn) / (2 * step * planned.sensors.orientation_sigma));
      EXPECT_LT((rows.block(6 * i, geometric + k, 6, 1) - expected).norm(), 1e-5 * (1 + expected.norm()))
          << terms.names()[static_cast<std::size_t>(k)] << ", pose " << i;
    }
  }
  // the first unknown is the base's x, which is known to 30 times 10 mm
  for (Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(rows(6 * i, 0), 0.3 / planned.sensors.position_sigma, 1e-6);
    EXPECT_NEAR(rows.block(6 * i + 1, 0, 5, 1).norm(), 0, 1e-6);
  }
  planned.oriented = false;
  const RealMatrix positions = detail::expected_rows(planned, at.joints, at.previous);
  ASSERT_EQ(positions.rows(), 15);
  for (Index i = 0; i < 5; ++i)
    EXPECT_EQ(positions.block(3 * i, 0, 3, rows.cols()), rows.block(6 * i, 0, 3, rows.cols()));
}

/// The parameters that `identify` estimates of an IRB 120: frames first; its second and third axes are parallel.
std::vector<std::string> estimated_of_irb120() {
  std::vector<std::string> out;
  for (const char* frame : {"base_", "tool_"})
    for (const char* axis : {"x", "y", "z", "rx", "ry", "rz"}) out.push_back(std::string(frame) + axis);
  for (int row = 1; row <= 6; ++row)
    for (const char* name : {"a", "alpha", row == 2 ? "" : "d", "theta", row == 2 ? "beta" : ""})
      if (*name != 0) out.push_back(name + std::to_string(row));
  return out;
}

// Geometry likewise: of the chain by the expected sizes of its errors, of the frames by 30 times 10 mm and 10 mrad.
TEST(PlanMeasurements, RowsOfGeometryAreDerivativesOfThePose) {
  const MeasurementCandidates<6> at = some_candidates(3, 1);
  ErrorModelOptions no_errors{.compliance = false, .harmonics = 0, .hysteresis = false, .tilt = false};
  const SensorModel sensors{.position_sigma = 2e-3, .orientation_sigma = 5e-3};
  IdentifyOptions geometry{.frames = Frames::base_and_tool};
  geometry.length_prior_std = 2e-3;
  geometry.angle_prior_std = 3e-3;
  geometry.joint_zero_prior_std = 7e-3;
  const detail::PlannedCalibration planned{
      ArmGeometry(in_frames(robots::abb_irb120().chain)), geometry, no_errors, sensors, true, 30};
  const RealMatrix rows = detail::expected_rows(planned, at.joints, MatrixX());
  const std::vector<std::string> estimated = estimated_of_irb120(), names = planned.nominal.parameter_names();
  ASSERT_EQ(rows.cols(), static_cast<Index>(estimated.size()));
  constexpr double step = 1e-6;
  for (std::size_t k = 0; k < estimated.size(); ++k) {
    const std::string& name = estimated[k];
    const Index parameter = std::find(names.begin(), names.end(), name) - names.begin();
    VectorX low = planned.nominal.parameters(), high = low;
    low(parameter) -= step;
    high(parameter) += step;
    const auto below = planned.nominal.with_parameters(low).poses(at.joints),
               above = planned.nominal.with_parameters(high).poses(at.joints);
    const double size = k < 12 ? 0.3 : name[0] == 't' ? 7e-3 : name[0] == 'd' || name[1] < 'a' ? 2e-3 : 3e-3;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 shift = translation(above[i]) - translation(below[i]),
                    turn = log_so3(rotation(composed(above[i], inverse_of(below[i]))));
      RealMatrix expected(6, 1);
      expected.set_block(0, 0, RealMatrix(shift) * (size / (2 * step * 2e-3)));
      expected.set_block(3, 0, RealMatrix(turn) * (size / (2 * step * 5e-3)));
      const RealMatrix found = rows.block(6 * static_cast<Index>(i), static_cast<Index>(k), 6, 1);
      EXPECT_LT((found - expected).norm(), 1e-6 * (1 + expected.norm())) << name << ", pose " << i;
    }
  }
}

// Errors of the joint readings move the tool by the Jacobian: what a pose says about the unknowns is A' C^-1 A.
TEST(PlanMeasurements, RowsCountErrorsOfTheJointReadings) {
  const auto chain = robots::abb_irb120().chain;
  const MeasurementCandidates<6> at = some_candidates(1, 1);
  detail::PlannedCalibration planned{
      ArmGeometry(in_frames(chain)), {.frames = Frames::base_and_tool}, {.harmonics = 2}, {}, true, 30};
  const RealMatrix exact = detail::expected_rows(planned, at.joints, at.previous);
  planned.sensors.joint_sigma = 0.2e-3;
  const RealMatrix rows = detail::expected_rows(planned, at.joints, at.previous);
  RealMatrix covariance(6, 6), unwhitened = exact;
  for (Index k = 0; k < 6; ++k) {
    const double sigma = k < 3 ? planned.sensors.position_sigma : planned.sensors.orientation_sigma;
    covariance(k, k) = sigma * sigma;
    for (Index c = 0; c < exact.cols(); ++c) unwhitened(k, c) *= sigma;
  }
  const RealMatrix jacobian = 0.2e-3 * RealMatrix::of(chain.jacobian(configuration(at.joints, 0)));
  covariance += jacobian * jacobian.transpose();
  const RealMatrix expected = unwhitened.transpose() * covariance.inverse() * unwhitened;
  EXPECT_LT((rows.transpose() * rows - expected).norm(), 1e-6 * expected.norm());
}

// From 400 measurements on, orders above 60 may be fitted, of each of six joints with a cosine and a sine; those that
// were made count, too.
TEST(PlanMeasurements, MeasurementsOfBeforeDecideOnTheOrders) {
  PlanOptions options{.count = 2};
  options.errors.spectrum = {{1, 1, 1e-4}, {70, 70, 1e-4}};
  options.errors.harmonics = 100;
  const auto chain = robots::abb_irb120().chain;
  const MeasurementCandidates<6> candidates = some_candidates(5, 9);
  Index before = 0;
  for (const Index made : {397, 398}) {
    const Index unknowns =
        plan_measurements(chain, candidates, options, as_measured(some_candidates(made, 10))).unknowns;
    EXPECT_EQ(unknowns - before, made == 397 ? unknowns : 12);
    before = unknowns;
  }
}

// A plan is a design of what its measurements are expected to say, poses in blocks of three rows or, with orientations,
// six; the region is one of positions.
TEST(PlanMeasurements, IsTheDesignOfExpectedRows) {
  const auto chain = robots::abb_irb120().chain;
  const MeasurementCandidates<6> candidates = some_candidates(25, 11);
  const JointRows<6> region = some_candidates(7, 12).joints;
  for (const bool oriented : {false, true})
    for (const auto criterion : {DesignCriterion::information, DesignCriterion::region_variance}) {
      PlanOptions options = few_harmonics(8);
      options.oriented = oriented;
      options.criterion = criterion;
      options.bound_iterations = 3;
      const auto plan = plan_measurements(chain, candidates, options, {}, region);
      detail::PlannedCalibration planned{
          ArmGeometry(in_frames(chain)), options.geometry, options.errors, options.sensors, oriented, 8};
      const MatrixX rows = detail::expected_rows(planned, candidates.joints, candidates.previous);
      planned.oriented = false;
      const MatrixX of_region = detail::expected_rows(planned, region, MatrixX());
      const Index block = oriented ? 6 : 3;
      const PoseDesign design = design_poses(rows, block, {8, criterion, {}}, MatrixX(), of_region);
      EXPECT_EQ(plan.chosen, design.chosen);
      EXPECT_EQ(plan.unknowns, rows.cols());
      EXPECT_LT(difference(plan.log_det, design.log_det), 1e-9);
      EXPECT_NEAR(plan.bound, information_bound(rows, block, 8, 3), 1e-9);
      for (Index k = 0; k <= 8; ++k)
        EXPECT_NEAR(plan.relative_error(k) / std::sqrt(design.region_variance(k) / design.region_variance(8)), 1, 1e-6);
    }
}

TEST(PlanMeasurements, MoreInformationThanByChanceAndTheFirstOnesAreThePlanOfFewer) {
  const MeasurementCandidates<6> candidates = some_candidates(300, 2);
  const auto chain = robots::abb_irb120().chain;
  const auto plan = plan_measurements(chain, candidates, few_harmonics(40));
  const auto fewer = plan_measurements(chain, candidates, few_harmonics(20));
  EXPECT_TRUE(std::equal(fewer.chosen.begin(), fewer.chosen.end(), plan.chosen.begin()));
  MeasurementCandidates<6> first = candidates;
  first.joints.conservativeResize(40, 6);
  first.previous.conservativeResize(40, 6);
  const auto by_chance = plan_measurements(chain, first, few_harmonics(40));
  EXPECT_GT(plan.log_det(40), by_chance.log_det(40) + 10);
  for (Index k = 0; k < 40; ++k) {
    EXPECT_GT(plan.log_det(k + 1), plan.log_det(k));
    EXPECT_GE(plan.relative_error(k), plan.relative_error(k + 1));
  }
  EXPECT_DOUBLE_EQ(plan.relative_error(40), 1);
  EXPECT_EQ(std::set<Index>(plan.chosen.begin(), plan.chosen.end()).size(), 40u);
}

TEST(PlanMeasurements, TheBoundHolds) {
  PlanOptions options = few_harmonics(15);
  const auto free = plan_measurements(robots::abb_irb120().chain, some_candidates(80, 3), options);
  EXPECT_TRUE(std::isinf(free.bound));
  options.bound_iterations = 30;
  const auto plan = plan_measurements(robots::abb_irb120().chain, some_candidates(80, 3), options);
  EXPECT_EQ(plan.chosen, free.chosen);
  EXPECT_GE(plan.bound, plan.log_det(15));
  EXPECT_LT(plan.bound, 1.2 * plan.log_det(15));
}

/// Sum of the variances of predicted rows, their unknowns known from measured rows and a prior of unit variances.
double variance_of(const RealMatrix& predicted, const RealMatrix& measured) {
  const RealMatrix information = RealMatrix::identity(measured.cols()) + measured.transpose() * measured;
  return (predicted * information.solve_by_cholesky(predicted.transpose())).trace();
}

TEST(PlanMeasurements, ARegionIsPredictedBetterByAPlanForIt) {
  const MeasurementCandidates<6> candidates = some_candidates(300, 4);
  const auto chain = robots::abb_irb120().chain;
  JointRows<6> region = some_candidates(60, 5).joints;
  for (Index i = 0; i < 60; ++i)
    for (Index j = 0; j < 3; ++j) region(i, j) *= 0.3;
  PlanOptions options = few_harmonics(30);
  const auto variance = [&](const MeasurementPlan<6>& plan) {
    const detail::PlannedCalibration planned{
        ArmGeometry(in_frames(chain)), options.geometry, options.errors, options.sensors, false, 30};
    return variance_of(detail::expected_rows(planned, region, MatrixX()),
                       detail::expected_rows(planned, plan.joints, MatrixX()));
  };
  const double general = variance(plan_measurements(chain, candidates, options, {}, region));
  options.criterion = DesignCriterion::region_variance;
  EXPECT_LT(variance(plan_measurements(chain, candidates, options, {}, region)), 0.95 * general);
}

// The errors of fewer measurements relative to those of all: the square root of the mean variance over the region.
TEST(PlanMeasurements, RelativeErrorsAreThoseOfTheRegion) {
  MeasurementCandidates<6> candidates = some_candidates(60, 4);
  candidates.previous.resize(0, 6);
  const auto chain = robots::abb_irb120().chain;
  const JointRows<6> region = some_candidates(20, 5).joints;
  const PlanOptions options = few_harmonics(30);
  const auto plan = plan_measurements(chain, candidates, options, {}, region);
  const detail::PlannedCalibration planned{
      ArmGeometry(in_frames(chain)), options.geometry, options.errors, options.sensors, false, 30};
  const RealMatrix rows = detail::expected_rows(planned, plan.joints, MatrixX());
  const RealMatrix of_region = detail::expected_rows(planned, region, MatrixX());
  const auto variance = [&](Index count) { return variance_of(of_region, rows.block(0, 0, 3 * count, rows.cols())); };
  for (const Index count : {0, 10, 29})
    EXPECT_NEAR(plan.relative_error(count) / std::sqrt(variance(count) / variance(30)), 1, 1e-6) << count;
}

// Every k-th row of a large region is used, about 150 in all.
TEST(PlanMeasurements, OfALargeRegionSomeCount) {
  const auto chain = robots::abb_irb120().chain;
  const MeasurementCandidates<6> candidates = some_candidates(40, 4);
  const JointRows<6> region = some_candidates(450, 5).joints;
  JointRows<6> thirds(150, 6);
  for (Index i = 0; i < 150; ++i) set_configuration(thirds, i, configuration(region, 3 * i));
  const VectorX all = plan_measurements(chain, candidates, few_harmonics(10), {}, region).relative_error;
  EXPECT_EQ(difference(all, plan_measurements(chain, candidates, few_harmonics(10), {}, thirds).relative_error), 0);
}

TEST(PlanMeasurements, ARegionMayBeOnePose) {
  const auto chain = robots::abb_irb120().chain;
  MeasurementCandidates<6> candidates = some_candidates(15, 4);
  candidates.previous.resize(0, 6);
  const JointRows<6> region = some_candidates(1, 5).joints;
  PlanOptions options = few_harmonics(5);
  for (const auto criterion : {DesignCriterion::information, DesignCriterion::region_variance}) {
    options.criterion = criterion;
    const auto plan = plan_measurements(chain, candidates, options, {}, region);
    const detail::PlannedCalibration planned{
        ArmGeometry(in_frames(chain)), options.geometry, options.errors, options.sensors, false, 5};
    const RealMatrix rows = detail::expected_rows(planned, plan.joints, MatrixX());
    const RealMatrix of_region = detail::expected_rows(planned, region, MatrixX());
    const double none = variance_of(of_region, RealMatrix(0, rows.cols())), all = variance_of(of_region, rows);
    EXPECT_NEAR(plan.relative_error(0) / std::sqrt(none / all), 1, 1e-6);
  }
}

// What one pose of before says is not said again: the information adds up.
TEST(PlanMeasurements, OnePoseMeasuredBeforeCounts) {
  const auto chain = robots::abb_irb120().chain;
  const MeasurementCandidates<6> candidates = some_candidates(15, 6);
  const auto at_once = plan_measurements(chain, candidates, few_harmonics(4));
  MeasurementCandidates<6> measured;
  measured.joints.resize(1, 6);
  measured.previous.resize(1, 6);
  set_configuration(measured.joints, 0, configuration(candidates.joints, at_once.chosen[0]));
  set_configuration(measured.previous, 0, configuration(candidates.previous, at_once.chosen[0]));
  const auto more = plan_measurements(chain, candidates, few_harmonics(3), as_measured(measured));
  EXPECT_EQ(more.chosen, (std::vector<Index>(at_once.chosen.begin() + 1, at_once.chosen.end())));
  EXPECT_NEAR(more.log_det(3), at_once.log_det(4) - at_once.log_det(1), 1e-6);
}

TEST(PlanMeasurements, OneIterationGivesABound) {
  PlanOptions options = few_harmonics(3);
  options.bound_iterations = 1;
  EXPECT_TRUE(std::isfinite(plan_measurements(robots::abb_irb120().chain, some_candidates(5, 3), options).bound));
}

TEST(PlanMeasurements, WhatWasMeasuredIsNotMeasuredAgain) {
  MeasurementCandidates<6> candidates = some_candidates(60, 6);
  const auto chain = robots::abb_irb120().chain;
  const auto plan = plan_measurements(chain, candidates, few_harmonics(20));
  MeasurementCandidates<6> measured;
  measured.joints = plan.joints;
  measured.previous.resize(20, 6);
  for (Index i = 0; i < 20; ++i)
    set_configuration(measured.previous, i,
                      configuration(candidates.previous, plan.chosen[static_cast<std::size_t>(i)]));
  const auto more = plan_measurements(chain, candidates, few_harmonics(10), as_measured(measured));
  PlanOptions both = few_harmonics(30);
  const auto at_once = plan_measurements(chain, candidates, both);
  for (const Index c : more.chosen) EXPECT_EQ(std::find(plan.chosen.begin(), plan.chosen.end(), c), plan.chosen.end());
  EXPECT_EQ(more.chosen, (std::vector<Index>(at_once.chosen.begin() + 20, at_once.chosen.end())));
  EXPECT_NEAR(more.log_det(10), at_once.log_det(30) - at_once.log_det(20), 1e-6);
  // the bound is one without them
  PlanOptions bounded = few_harmonics(10);
  bounded.bound_iterations = 2;
  EXPECT_TRUE(std::isinf(plan_measurements(chain, candidates, bounded, as_measured(measured)).bound));
}

TEST(PlanMeasurements, VisitsRegisterFirstAndCheckRepeatedly) {
  const auto chain = robots::abb_irb120().chain;
  const auto plan = plan_measurements(chain, some_candidates(200, 7), few_harmonics(45));
  ASSERT_EQ(plan.visits.size(), 45u + 3u);  // again after 20, after 40, at the end
  EXPECT_EQ(plan.visits[20], plan.visits[0]);
  EXPECT_EQ(plan.visits.back(), plan.visits[0]);
  EXPECT_EQ(std::set<Index>(plan.visits.begin(), plan.visits.end()).size(), 45u);
  const PointRows points = chain.positions(plan.joints);
  double widest = 0;
  for (Index i = 0; i < 45; ++i)
    for (Index j = 0; j < i; ++j) widest = std::max(widest, (point(points, i) - point(points, j)).norm());
  const Vector3 first = point(points, plan.visits[0]), a = point(points, plan.visits[1]) - first,
                b = point(points, plan.visits[2]) - first;
  EXPECT_DOUBLE_EQ(a.norm(), widest);
  double off = 0;  // of all others from the line of these two
  for (Index i = 0; i < 45; ++i) off = std::max(off, a.cross(point(points, i) - first).norm() / a.norm());
  EXPECT_DOUBLE_EQ(a.cross(b).norm() / a.norm(), off);
}

// Of few poses it matters that each may be one of the three that register: the two farthest apart, whichever they are.
TEST(PlanMeasurements, AnyThreePosesMayRegister) {
  const auto chain = robots::abb_irb120().chain;
  PlanOptions options{.errors = {.compliance = false, .harmonics = 0}};
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const Index n = seed <= 15 ? 5 : 3;
    options.count = n;
    const auto plan = plan_measurements(chain, some_candidates(n, seed), options);
    ASSERT_EQ(plan.visits.size(), static_cast<std::size_t>(n + 1));
    EXPECT_EQ(std::set<Index>(plan.visits.begin(), plan.visits.end()).size(), static_cast<std::size_t>(n));
    const PointRows points = chain.positions(plan.joints);
    double widest = 0, largest = 0;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < i; ++j) widest = std::max(widest, (point(points, i) - point(points, j)).norm());
    const Vector3 first = point(points, plan.visits[0]), a = point(points, plan.visits[1]) - first;
    const auto area = [&](Index i) { return a.cross(point(points, i) - first).norm(); };
    for (Index i = 0; i < n; ++i) largest = std::max(largest, area(i));
    EXPECT_DOUBLE_EQ(a.norm(), widest) << seed;
    EXPECT_DOUBLE_EQ(area(plan.visits[2]), largest) << seed;
  }
}

// The last joint turns the tool on the spot, so no pose is far from another; each is visited once all the same.
TEST(PlanMeasurements, PosesAtOnePlaceAreVisitedOnceEach) {
  MeasurementCandidates<6> candidates = in_a_row({0.2, 0.2, 0.2, 0.2});
  for (Index i = 0; i < 4; ++i) candidates.joints(i, 5) = 0.5 * static_cast<double>(i);
  PlanOptions options = few_harmonics(4);
  options.oriented = true;
  const auto plan = plan_measurements(robots::abb_irb120().chain, candidates, options);
  ASSERT_EQ(plan.visits.size(), 5u);
  EXPECT_EQ(std::set<Index>(plan.visits.begin(), plan.visits.end()), (std::set<Index>{0, 1, 2, 3}));
}

TEST(PlanMeasurements, CoversTheBinsOfAllJoints) {
  const auto chain = robots::abb_irb120().chain;
  PlanOptions options = few_harmonics(40);
  options.bin_count = 1;
  const auto covering = plan_measurements(chain, some_candidates(300, 8), options);
  EXPECT_TRUE(covering.uncovered.empty());
  options.count = 3;
  const auto few = plan_measurements(chain, some_candidates(300, 8), options);
  ASSERT_FALSE(few.uncovered.empty());
  for (const UncoveredBin& bin : few.uncovered) {
    EXPECT_NEAR(bin.range.upper - bin.range.lower, std::numbers::pi / 18, 1e-12);  // 10 degrees
    for (Index i = 0; i < 3; ++i)
      EXPECT_FALSE(few.joints(i, bin.joint) >= bin.range.lower && few.joints(i, bin.joint) < bin.range.upper);
  }
  // what was measured before covers, too
  MeasurementCandidates<6> measured;
  measured.joints = covering.joints;
  EXPECT_TRUE(plan_measurements(chain, some_candidates(300, 8), options, as_measured(measured)).uncovered.empty());
}

// Bins of a quarter from the smallest value to the largest, which lies in the last of them.
TEST(PlanMeasurements, BinsByHand) {
  const auto chain = robots::abb_irb120().chain;
  PlanOptions options = few_harmonics(1);
  options.bin = 0.25;
  for (const int wanted : {0, 1}) {
    options.bin_count = wanted;
    // what was measured above the bins of the first joint and below those of the second covers none of them
    MeasurementCandidates<6> outside = in_a_row({0.6});
    outside.joints(0, 1) = -0.3;
    MeasurementCandidates<6> other_side = in_a_row({-0.3});  // and the other way round
    other_side.joints(0, 1) = 0.6;
    for (const bool turned : {false, true})
      for (const auto& measured : {MeasurementCandidates<6>(), outside, other_side}) {
        const std::vector<double> values = turned ? std::vector<double>{0.5, 0} : std::vector<double>{0, 0.5};
        const auto plan = plan_measurements(chain, in_a_row(values), options, as_measured(measured));
        ASSERT_EQ(plan.uncovered.size(), 2u) << wanted;
        for (const int joint : {0, 1}) {
          const UncoveredBin& bin = plan.uncovered[static_cast<std::size_t>(joint)];
          EXPECT_EQ(bin.joint, joint);
          EXPECT_EQ(bin.range.lower, plan.joints(0, 0) == 0 ? 0.25 : 0);
          EXPECT_EQ(bin.range.upper, bin.range.lower + 0.25);
        }
      }
  }
  // the half that was measured needs no further pose
  for (const double half : {0.1, 0.4}) {
    const auto rest = plan_measurements(chain, in_a_row({0, 0.5}), options, as_measured(in_a_row({half})));
    EXPECT_EQ(rest.chosen, std::vector<Index>{half < 0.25 ? 1 : 0});
    EXPECT_TRUE(rest.uncovered.empty());
  }
  options.count = 2;
  EXPECT_TRUE(plan_measurements(chain, in_a_row({0, 0.25, 0.5}), options).uncovered.empty());
}

// Two measurements are required at each end of a range.
TEST(PlanMeasurements, BinsMayWantSeveralMeasurements) {
  const auto chain = robots::abb_irb120().chain;
  PlanOptions options;
  options.errors.harmonics = 6;
  options.bin = 0.25;
  options.bin_count = 2;
  const auto uncovered = [&](Index count, const MeasurementCandidates<6>& measured) {
    options.count = count;
    return plan_measurements(chain, in_a_row({0, 0.05, 0.1, 0.55, 0.6, 0.65}), options, as_measured(measured))
        .uncovered;
  };
  for (const UncoveredBin& bin : uncovered(3, {})) EXPECT_LT(bin.joint, 2);
  EXPECT_EQ(uncovered(3, {}).size(), 2u);  // one bin of each of the joints that move
  EXPECT_TRUE(uncovered(4, {}).empty());
  EXPECT_EQ(uncovered(2, in_a_row({0.1})).size(), 2u);  // two bins were half covered before
  EXPECT_TRUE(uncovered(3, in_a_row({0.1})).empty());
}

// Behind the three that register, the shortest way at the speeds of the joints; the first pose again and again.
TEST(PlanMeasurements, VisitsGoAtTheSpeedsOfTheJoints) {
  const auto chain = robots::abb_irb120().chain;
  PlanOptions options = few_harmonics(15);
  options.speeds = VectorX::Constant(6, 1);
  options.speeds(0) = 0.05;
  options.check_every = 100;
  const auto candidates = some_candidates(40, 13);
  const auto plan = plan_measurements(chain, candidates, options);
  ASSERT_EQ(plan.visits.size(), 16u);
  std::vector<Index> rows(plan.visits.begin(), plan.visits.begin() + 3);
  for (Index i = 0; i < 15; ++i)
    if (std::find(rows.begin(), rows.begin() + 3, i) == rows.begin() + 3) rows.push_back(i);
  JointRows<6> joints(15, 6);
  for (Index i = 0; i < 15; ++i)
    set_configuration(joints, i, configuration(plan.joints, rows[static_cast<std::size_t>(i)]));
  const std::vector<Index> order = visiting_order(joints, options.speeds, 3);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(plan.visits[i], rows[static_cast<std::size_t>(order[i])]) << i;
  options.check_every = 7;
  const auto checked = plan_measurements(chain, candidates, options);
  EXPECT_EQ(checked.visits, with_check_visits({plan.visits.begin(), plan.visits.begin() + 15}, 7));
}

TEST(PlanMeasurements, CandidatesObeyTheirConstraints) {
  const auto robot = robots::abb_irb120();
  MeasurementConstraints constraints{.tool_box = ToolBox{{0, -0.4, 0.1}, {0.8, 0.4, 0.9}},
                                     .tracker = Tracker{.position = {3, 0, 0.5}, .acceptance = 1}};
  const auto found = sample_candidates(robot.chain, robot.limits, constraints, 200, 3);
  EXPECT_EQ(difference(found.joints, sample_candidates(robot.chain, robot.limits, constraints, 200, 3).joints), 0);
  for (Index i = 0; i < 200; ++i) {
    const JointVector<6> q = configuration(found.joints, i);
    const Isometry3 pose = robot.chain.pose(q);
    const Vector3 position = translation(pose), axis(pose(0, 2), pose(1, 2), pose(2, 2));
    for (Index j = 0; j < 6; ++j) {
      EXPECT_GE(q(j), robot.limits.lower(j) + 0.05 - 1e-12);
      EXPECT_LE(q(j), robot.limits.upper(j) - 0.05 + 1e-12);
    }
    for (Index c = 0; c < 3; ++c) {
      EXPECT_GE(position(c), constraints.tool_box->lower(c));
      EXPECT_LE(position(c), constraints.tool_box->upper(c));
    }
    const Vector3 beam = (constraints.tracker->position - position).normalized();
    EXPECT_GE(beam.dot(axis), std::cos(1.0) - 1e-12);
  }
  EXPECT_GT(difference(found.joints, sample_candidates(robot.chain, robot.limits, constraints, 200, 4).joints), 0);
  for (Index i = 0; i < 200; ++i)  // each approached from the one before, the first from where it is
    EXPECT_EQ(configuration(found.previous, i), configuration(found.joints, std::max<Index>(i - 1, 0)));
  EXPECT_EQ(found.rejected[static_cast<std::size_t>(Rejection::none)], 0);
  for (const Rejection r : {Rejection::joint_limits, Rejection::tool_box, Rejection::acceptance})
    EXPECT_GT(found.rejected[static_cast<std::size_t>(r)], 0) << name_of(r);
  EXPECT_EQ(found.rejected[static_cast<std::size_t>(Rejection::self_collision)], 0);

  constraints.tool_box = ToolBox{{10, 10, 10}, {11, 11, 11}};
  const std::string said =
      vernier_test::complaint([&] { (void)sample_candidates(robot.chain, robot.limits, constraints, 200, 3); });
  EXPECT_NE(said.find("of 1000 configurations 0 can be measured; of the others"), std::string::npos) << said;
  EXPECT_NE(said.find("tool out of its box"), std::string::npos) << said;
  constraints.joint_margin = 10;
  const std::string narrow =
      vernier_test::complaint([&] { (void)sample_candidates(robot.chain, robot.limits, constraints, 200, 3); });
  EXPECT_NE(narrow.find("of the others 1000 are out of the joint limits"), std::string::npos) << narrow;
}

// Where nothing is rejected, each joint is uniform between its limits.
TEST(PlanMeasurements, CandidatesFillTheLimitsOfAllJoints) {
  const auto robot = robots::abb_irb120();
  const auto found = sample_candidates(robot.chain, robot.limits, {.joint_margin = 0}, 400, 3);
  for (const Index rejected : found.rejected) EXPECT_EQ(rejected, 0);
  for (Index j = 0; j < 6; ++j) {
    double sum = 0, squares = 0;
    for (Index i = 0; i < 400; ++i) {
      const double share =
          (found.joints(i, j) - robot.limits.lower(j)) / (robot.limits.upper(j) - robot.limits.lower(j));
      EXPECT_TRUE(share >= 0 && share <= 1) << share;
      sum += share / 400;
      squares += share * share / 400;
    }
    EXPECT_NEAR(sum, 0.5, 0.05) << j;  // three deviations of a mean of 400
    EXPECT_NEAR(squares - sum * sum, 1.0 / 12, 0.01) << j;
  }
}

TEST(PlanMeasurements, CandidatesNeedLimits) {
  const auto robot = robots::abb_irb120();
  const auto complaint = [&](const JointLimits<6>& limits, Index n) {
    return vernier_test::complaint([&] { (void)sample_candidates(robot.chain, limits, {}, n, 1); });
  };
  EXPECT_EQ(complaint(robot.limits, 1), "");
  EXPECT_EQ(complaint(robot.limits, 0), "sample_candidates: 0 candidates requested");
  const double infinity = std::numeric_limits<double>::infinity();
  for (const int fault : {0, 1, 2, 3}) {
    JointLimits<6> limits = robot.limits;
    if (fault == 0) limits.lower(2) = -infinity;
    if (fault == 1) limits.upper(2) = infinity;
    if (fault == 2) limits.upper(0) = limits.lower(0);
    if (fault == 3) limits.upper(5) = limits.lower(5) - 1;
    EXPECT_EQ(complaint(limits, 1), "sample_candidates: the joint limits are not finite, or empty") << fault;
  }
}

TEST(PlanMeasurements, EnoughIsWhereTenMoreGainLittle) {
  PlannedMeasurements plan;
  plan.chosen.resize(30);
  plan.relative_error = VectorX::LinSpaced(31, 4, 1);
  EXPECT_EQ(plan.enough(), 30);
  // the first ten of thirty even steps from 4 to 1 reduce it by a quarter, later ones by more
  EXPECT_EQ(plan.enough(0.24), 30);
  EXPECT_EQ(plan.enough(0.26), 0);
  for (Index k = 16; k < 31; ++k) plan.relative_error(k) = plan.relative_error(15);
  EXPECT_EQ(plan.enough(), 15);
  // the last ten alone gain nothing
  plan.relative_error = VectorX::LinSpaced(31, 4, 1);
  for (Index k = 21; k < 31; ++k) plan.relative_error(k) = plan.relative_error(20);
  EXPECT_EQ(plan.enough(), 20);
}

TEST(PlanMeasurements, RefusesWhatIsNotUsable) {
  const auto complaint = [](const PlanOptions& options, Index n) {
    return vernier_test::complaint(
        [&] { (void)plan_measurements(robots::abb_irb120().chain, some_candidates(n, 1), options); });
  };
  EXPECT_EQ(complaint({.count = 11}, 10), "plan_measurements: 10 candidates for 11 measurements");
  EXPECT_EQ(complaint({.count = 0}, 10), "plan_measurements: count is 0, must be at least 1");
  EXPECT_EQ(complaint({.count = 2, .criterion = DesignCriterion::region_variance}, 10),
            "plan_measurements: no region whose variance could be reduced");
  EXPECT_EQ(complaint({}, 10), "plan_measurements: 10 candidates for 100 measurements");
  EXPECT_EQ(complaint({.count = 2, .bin = 0}, 10), "plan_measurements: bin is 0, must be positive");
  EXPECT_NE(complaint({.count = 2, .errors = {.harmonics = -1}}, 10), "");
  EXPECT_NE(complaint({.count = 2, .sensors = {.position_sigma = 0}}, 10), "");
  MeasurementCandidates<6> half = some_candidates(10, 1);
  half.previous.conservativeResize(5, 6);
  EXPECT_EQ(
      vernier_test::complaint([&] { (void)plan_measurements(robots::abb_irb120().chain, half, few_harmonics(2)); }),
      "plan_measurements: 5 approaches for 10 candidates");
  const MeasurementCandidates<6> some = some_candidates(10, 1);
  const Measurements<6> lengths = as_measured(some).add(some.joints, DistanceSensor(VectorX::Ones(10)));
  EXPECT_EQ(vernier_test::complaint(
                [&] { (void)plan_measurements(robots::abb_irb120().chain, some, few_harmonics(2), lengths); }),
            "plan_measurements: 1 of 2 sets of measurements are no data sets of poses; a plan counts these alone");
  for (const int bad : {0, 1, 2}) {
    std::array<MeasurementCandidates<6>, 3> rows{some_candidates(3, 1), some_candidates(3, 2), some_candidates(3, 3)};
    rows[static_cast<std::size_t>(bad)].joints(1, 2) = std::nan("");
    EXPECT_EQ(
        vernier_test::complaint([&] {
          (void)plan_measurements(robots::abb_irb120().chain, rows[0], few_harmonics(2), as_measured(rows[1]),
                                  rows[2].joints);
        }),
        bad == 1 ? "Dataset: row 1 has a value that is not finite" : "plan_measurements: a joint value is not finite")
        << bad;
  }
}

}  // namespace
}  // namespace vernier
