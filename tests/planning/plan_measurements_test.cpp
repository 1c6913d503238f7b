// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/planning/plan_measurements.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "complaint.hpp"
#include "planned_candidates.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"

namespace vernier::plan_measurements_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;
using vernier_test::some_candidates;

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
  for (const bool oriented : {false, true})
    for (const auto criterion : {DesignCriterion::information, DesignCriterion::region_variance}) {
      PlanOptions options = few_harmonics(8);
      options.oriented = oriented;
      options.criterion = criterion;
      options.bound_iterations = 3;
      const JointRows<6> region = some_candidates(oriented ? 7 : 1, 12).joints;
      const auto plan = plan_measurements(chain, candidates, options, {}, region);
      detail::PlannedCalibration planned{
          ArmGeometry(in_frames(chain)), options.geometry, options.errors, options.sensors, oriented, 8};
      const auto expected = detail::expected_candidate_rows(planned, candidates.joints, candidates.previous);
      const MatrixX rows = detail::expected_rows(planned, candidates.joints, candidates.previous);
      planned.oriented = false;
      const MatrixX of_region = detail::expected_rows(planned, region, MatrixX());
      const Index block = oriented ? 6 : 3;
      const PoseDesign design = detail::design_poses(expected, {8, criterion, {}}, MatrixX(), of_region);
      EXPECT_EQ(plan.chosen, design.chosen);
      EXPECT_EQ(plan.chosen, design_poses(rows, block, {8, criterion, {}}, MatrixX(), of_region).chosen);
      EXPECT_EQ(plan.unknowns, rows.cols());
      EXPECT_LT(difference(plan.log_det, design.log_det), 1e-9);
      EXPECT_NEAR(plan.bound, information_bound(rows, block, 8, 3), 1e-9);
      for (Index k = 0; k <= 8; ++k)
        EXPECT_NEAR(plan.relative_error(k) / std::sqrt(design.region_variance(k) / design.region_variance(8)), 1, 1e-6);
    }
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

// The choices until then are those of the whole plan; before the first there are none.
TEST(PlanMeasurements, AnObserverEndsAPlan) {
  const auto chain = robots::abb_irb120().chain;
  const MeasurementCandidates<6> candidates = some_candidates(300, 6);
  PlanOptions options = few_harmonics(20);
  const auto whole = plan_measurements(chain, candidates, options);
  Index most = 0, reports = 0;
  const auto until = [&](const Progress& progress) {
    EXPECT_GE(progress.generation, most);
    most = progress.generation;
    ++reports;
    return progress.generation < 9;
  };
  options.observer = until;
  const auto stopped = plan_measurements(chain, candidates, options);
  EXPECT_EQ(stopped.chosen, (std::vector<Index>(whole.chosen.begin(), whole.chosen.begin() + 9)));
  EXPECT_EQ(stopped.log_det.size(), 10);
  EXPECT_EQ(stopped.log_det(9), whole.log_det(9));
  EXPECT_EQ(stopped.relative_error(9), 1);
  EXPECT_EQ(stopped.joints.rows(), 9);
  EXPECT_EQ(stopped.visits.size(), 10u);  // the first one again at the end
  EXPECT_GT(reports, 9 + 300 / 64);       // rows of the candidates, too
  const auto at_once = [](const Progress&) { return false; };
  options.observer = at_once;
  EXPECT_TRUE(plan_measurements(chain, candidates, options).chosen.empty());
  const auto all = [&](const Progress&) { return true; };
  options.observer = all;
  EXPECT_EQ(plan_measurements(chain, candidates, options).visits, whole.visits);
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
}  // namespace vernier::plan_measurements_test
