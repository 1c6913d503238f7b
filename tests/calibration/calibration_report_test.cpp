// Sentences of the report whose numbers are worked by hand.

#include "vernier/calibration/calibration_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/detail/number_text.hpp"
#include "vernier/error_terms/drive_lines.hpp"

namespace vernier::calibration_report_test {
namespace {

/// Whether a verdict has a sentence.
bool says(const std::vector<std::string>& verdict, const std::string& sentence) {
  return std::find(verdict.begin(), verdict.end(), sentence) != verdict.end();
}

/// A report of four held-out poses.
CalibrationReport report_of_four() {
  CalibrationReport out;
  out.stages.push_back({Stage::geometry, "geometry", VectorX::Constant(4, 1e-4), {}});
  out.gates = VectorX::Ones(4);
  return out;
}

TEST(WordingWhiteBox, NumbersAreBrief) {
  const std::pair<double, const char*> cases[] = {{0.012345, "0.0123"}, {-2, "-2"},         {999.4, "999"},
                                                  {999.6, "1000"},      {-1234.4, "-1234"}, {999999, "999999"},
                                                  {1e6, "1e+06"},       {1e200, "1e+200"}};
  for (const auto& [value, text] : cases) EXPECT_EQ(detail::brief(value), text);
}

TEST(CalibrationReport, DriftByHand) {
  SessionDrift drift{.begin = 100, .spacing = 10};
  drift.knots = MatrixX::Zero(9, 3);
  drift.knots(0, 1) = 0.01e-3;  // x: 0, 0.01 and 0.05 mm
  drift.knots(0, 2) = 0.05e-3;
  drift.knots(5, 2) = 30e-6;
  for (Index k = 0; k < 3; ++k) {
    drift.knots(7, k) = 10e-6 * static_cast<double>(1 + k);      // joint 2: 10 to 30 urad
    drift.knots(8, k) = 7.5e-6 * static_cast<double>(k) - 5e-6;  // joint 3: -5 to 10 urad
  }
  CalibrationReport report = report_of_four();
  report.drift = {drift};
  report.joints.resize(3);
  for (const bool revolute : {true, false}) {
    report.joints[1].revolute = revolute;
    EXPECT_TRUE(says(report.verdict(),
                     "During the session the base moved by up to 0.05 mm and 30 urad, fastest (0.04 mm) between 110 "
                     "and 120 of 100 .. 120 [row, or time_s]. The zero of joint 2 moved most, by 20 " +
                         std::string(revolute ? "urad" : "um") + ". The model that is saved is without drift."));
  }
}

TEST(CalibrationReport, RemarksOnWhatRanAway) {
  CalibrationReport report = report_of_four();
  const auto length = [](const char* name, double value) {
    return ParameterEstimate{name, ParameterKind::length, 0, value, 0, ParameterState::identified, {}};
  };
  report.identification.parameters = {length("base_x", 5), length("a1", 0.3), length("d1", -0.1), length("tool_x", 0.3),
                                      length("tool_z", 0.4)};
  report.joints.resize(1);
  report.joints[0].revolute = false;
  report.joints[0].measured_ranges = {{-0.2, 0.1}};
  report.identification.condition = 1e6;
  EXPECT_TRUE(report.remarks().empty());  // the tool is 0.5 m long, the reach 0.6 m
  report.joints[0].revolute = true;
  report.identification.condition = 2e6;
  const std::vector<std::string> remarks = report.remarks();
  ASSERT_EQ(remarks.size(), 2u);
  EXPECT_EQ(remarks[0],
            "The poses hardly determine some of the estimated parameters (condition 2e+06): do not trust values with "
            "large standard deviations.");
  EXPECT_EQ(remarks[1],
            "The tool point was found 500 mm from the flange, beyond the arm's reach of 400 mm: wrong robot, or poses "
            "that do not determine it?");
}

TEST(CalibrationReport, CountsPosesAndParameters) {
  CalibrationReport report = report_of_four();
  const std::string outside = " outside those ranges; there the learned functions of the joints fade out.";
  const std::string weak = " weakly determined and regularised around nominal.";
  report.gates(2) = 0.5;
  report.identification.parameters.resize(3);
  report.identification.parameters[1].state = ParameterState::weak;
  EXPECT_EQ(report.extrapolated(), 1);
  EXPECT_TRUE(says(report.verdict(), "1 held-out pose lies" + outside));
  EXPECT_TRUE(says(report.verdict(), "1 parameter is" + weak));
  report.gates(3) = 0;
  report.identification.parameters[2].state = ParameterState::weak;
  EXPECT_TRUE(says(report.verdict(), "2 held-out poses lie" + outside));
  EXPECT_TRUE(says(report.verdict(), "2 parameters are" + weak));
  report.advice.resize(1);
  EXPECT_TRUE(says(report.verdict(), "1 more parameter is" + weak));
  report.advice.resize(2);
  for (const std::string& sentence : report.verdict()) EXPECT_EQ(sentence.find("regularised"), std::string::npos);
}

/// Position errors [mm] of five held-out poses by geometry and by joint-wise terms; the fourth pose is out of range.
CalibrationReport five_poses() {
  CalibrationReport report;
  report.stages.push_back({Stage::geometry, "geometry", 1e-3 * VectorX{{0.5, 0.4, 0.3, 0.2, 0.1}}, {}});
  report.stages.push_back({Stage::jointwise, "joint-wise", 1e-3 * VectorX{{0.1, 0.2, 0.3, 9, 0.15}}, {}});
  report.gates = VectorX{{1, 1, 1, 0.5, 1}};
  report.chosen = Stage::jointwise;
  return report;
}

/// All of them, a line each.
std::string joined(const std::vector<std::string>& sentences) {
  std::string out;
  for (const std::string& one : sentences) out += one + "\n";
  return out;
}

// Mean, rms, maximum, minimum and 95 % of 1, 2 and 4: 7/3, sqrt(7), 4, 1 and 3.8.
TEST(CalibrationReport, TableByHand) {
  const VectorX errors = 1e-3 * VectorX{{2, 4, 1}};
  std::vector<StageErrors> stages{{Stage::frames, "frames", errors, {}}};
  EXPECT_EQ(stage_table(stages),
            "stage                      mean      rms      max      min      p95\n"
            "frames                   2.3333   2.6458   4.0000   1.0000   3.8000\n");
  stages[0].rotation = 1e-3 * VectorX{{1, 2, 6}};
  stages.push_back(
      {learned_stage(true, Learner::pso_elm), "geometry + PSO-ELM", 0.5 * errors, 0.5 * stages[0].rotation});
  EXPECT_EQ(stage_table(stages),
            "stage                      mean      rms      max      min      p95  mean [mrad]\n"
            "frames                   2.3333   2.6458   4.0000   1.0000   3.8000       3.0000\n"
            "geometry + PSO-ELM       1.1667   1.3229   2.0000   0.5000   1.9000       1.5000\n");
}

TEST(CalibrationReport, AccuracyByHand) {
  CalibrationReport report = five_poses();
  report.max_degradation = 0.05e-3;
  EXPECT_EQ(report.extrapolated(), 1);
  std::vector<std::string> said = report.verdict();
  ASSERT_GE(said.size(), 2u);
  // 0.1, 0.15, 0.2 and 0.3: mean 0.1875; at 2.85 of 3 they are 0.2 + 0.85 x 0.1
  EXPECT_EQ(said[0],
            "Accurate to 0.188 mm mean, 0.285 mm (95 %), 0.3 mm maximum, inside the measured joint ranges: 4 of 5 "
            "held-out poses. None of them is worse than with geometry alone by more than 0.05 mm.");
  EXPECT_EQ(said[1], "1 held-out pose lies outside those ranges; there the learned functions of the joints fade out.");
  EXPECT_TRUE(says(said, "Chosen by left-out poses: joint-wise.")) << joined(said);
  report.max_degradation = 0;
  EXPECT_TRUE(report.verdict()[0].ends_with("None of them is worse than with geometry alone."));
  report.chosen = Stage::geometry;
  EXPECT_EQ(report.verdict()[0].rfind("Accurate to 0.325 mm mean", 0), 0u) << report.verdict()[0];
  EXPECT_TRUE(says(report.verdict(), "Chosen by left-out poses: geometry."));
  report.gates.setConstant(0.5);  // nothing is said of no poses
  EXPECT_EQ(report.verdict()[0].rfind("5 held-out poses lie outside", 0), 0u) << report.verdict()[0];
  EXPECT_EQ(report.extrapolated(), 5);
}

TEST(CalibrationReport, RangesInDegreesAndMillimetres) {
  CalibrationReport report = five_poses();
  report.joints.resize(2);
  report.joints[0].measured_ranges = {{-1, 0.5}, {1, 2}};
  report.joints[1].revolute = false;
  for (int k = 0; k < 6; ++k) report.joints[1].measured_ranges.push_back({0.1 * k, 0.1 * k + 0.05});
  EXPECT_TRUE(says(report.verdict(),
                   "Measured joint ranges [deg, mm]: q1 -57..29, 57..115; q2 0..50, 100..150, 200..250, 300..350, and "
                   "2 more."))
      << joined(report.verdict());
  report.joints[1].measured_ranges.resize(4);
  EXPECT_TRUE(says(report.verdict(),
                   "Measured joint ranges [deg, mm]: q1 -57..29, 57..115; q2 0..50, 100..150, 200..250, 300..350."))
      << joined(report.verdict());
}

// A block has a sentence for either decision, with errors in millimetres and the gain of density where that decided.
TEST(CalibrationReport, DecisionsByHand) {
  const struct {
    Block block;
    const char *helps, *does_not;
  } sentences[] = {{Block::elastic, "Gravity compliance helps ", "Gravity compliance alone does not help "},
                   {Block::gears, "Gear ratios and coupling help ", "Gear ratios and coupling do not help "},
                   {Block::tuned_priors, "Optimised priors help ", "Optimised priors are left out: they do not help "}};
  for (const auto& [block, helps, does_not] : sentences)
    for (const bool used : {true, false}) {
      CalibrationReport report = five_poses();
      report.blocks = {{block, 0.25e-3, 0.125e-3, used, 1, used ? 0.5 : 0}};
      EXPECT_TRUE(says(report.verdict(),
                       std::string(used ? helps : does_not) +
                           "(leave-one-pose-out error: 0.25 mm without, 0.125 mm with" +
                           (used ? "; log predictive density of a left-out pose greater by 0.5 nat)." : ").")))
          << helps << '\n'
          << joined(report.verdict());
    }
}

TEST(CalibrationReport, WhatWasLearnedAndKnownBefore) {
  CalibrationReport report = five_poses();
  report.trials = {{true, Learner::pso_elm, 0.5e-3, 0.25e-3}, {false, Learner::kernel_elm, 0.1e-3, 0.125e-3}};
  report.mean_temperature = 21.5;
  report.prior = PriorTransfer{"last year", 0.25, 0.5, true};
  EXPECT_TRUE(says(report.verdict(),
                   "Left-out poses with what was learned on top: PSO-ELM on geometry 0.25 mm (0.5 without); kernel ELM "
                   "on the error model 0.125 mm (0.1 without)."))
      << joined(report.verdict());
  EXPECT_TRUE(says(report.verdict(),
                   "Where no temperature is given, the model is that of 21.5 deg C, the mean of the measurements."));
  const std::string of_prior =
      "Of the calibration 'last year' the geometry has changed by 25 % and the joint errors by 50 % of their expected "
      "sizes, as far as evidence tells.";
  EXPECT_TRUE(says(report.verdict(), of_prior)) << joined(report.verdict());
  report.prior->used = false;
  EXPECT_FALSE(says(report.verdict(), of_prior));
}

TEST(CalibrationReport, RemarksByHand) {
  CalibrationReport report = five_poses();
  EXPECT_TRUE(report.remarks().empty());
  report.converged = false;
  EXPECT_EQ(joined(report.remarks()), "The fit of the joint errors stopped before it converged.\n");
  report.converged = true;
  report.trials = {{true, Learner::pso_elm, 0.5e-3, 0.25e-3}};
  EXPECT_TRUE(report.remarks().empty());
  report.trials.push_back({false, Learner::ridge_elm, 0.1e-3, 0.125e-3});
  EXPECT_TRUE(report.remarks().empty());
  report.trials.push_back({false, Learner::pso_elm, 0.1e-3, 0.125e-3});
  const char* not_used = "What learners find in what the error model leaves does not help left-out poses: not used.\n";
  EXPECT_EQ(joined(report.remarks()), not_used);
  report.chosen = {Stage::learned, Learner::kernel_elm};
  EXPECT_TRUE(report.remarks().empty());
  report.outliers = 3;
  report.median_error = 0.5e-6;  // of exact data nothing is an outlier
  EXPECT_TRUE(report.remarks().empty());
  report.median_error = 0.04e-3;
  EXPECT_EQ(joined(report.remarks()),
            "3 of the training rows have errors above eight times the median of 0.04 mm: outliers? The loss reduces "
            "their weight in the fit; check them.\n");
  report.loss = Loss::squared;
  EXPECT_EQ(joined(report.remarks()),
            "3 of the training rows have errors above eight times the median of 0.04 mm: outliers? A robust loss "
            "(huber) reduces their weight.\n");
  report.chosen = Stage::jointwise;
  EXPECT_NE(report.summary().find(not_used), std::string::npos);
}

// The verdict lists the lines of a joint above the orders of assembly errors, at most three, each with the half-width
// of its 95 % interval.
TEST(CalibrationReport, LinesOfTheDrivesByHand) {
  CalibrationReport report = five_poses();
  report.joints.resize(2);
  report.joints[1].drive = {.gear_ratio = 50, .encoder_periods = 64};
  report.joints[1].lines = {{1, 90e-6, 1e-6, 0},  {28, 80e-6, 1e-6, 0}, {29, 70e-6, 10e-6, 0},
                            {64, 60e-6, 5e-6, 0}, {37, 50e-6, 5e-6, 0}, {41, 40e-6, 5e-6, 0}};
  const std::string cause = cause_of(64, report.joints[1].drive);
  ASSERT_FALSE(cause.empty());
  for (const int order : {29, 37}) ASSERT_EQ(cause_of(order, report.joints[1].drive), "");
  EXPECT_TRUE(says(report.verdict(), "Joint 2: 70 urad (+-20) at order 29; 60 urad (+-10) at order 64, " + cause +
                                         "; 50 urad (+-10) at order 37."))
      << joined(report.verdict());
  EXPECT_EQ(joined(report.verdict()).find("Joint 1:"), std::string::npos);
}

// A base that creeps, jumps and creeps: the fastest eighth of its seventeen knots, two steps, is where it jumps.
TEST(CalibrationReport, DriftOfStationsIsFastestWithinAnEighthOfTheSession) {
  SessionDrift drift{.begin = 0, .spacing = 5};
  drift.knots = MatrixX::Zero(6, 17);
  for (Index k = 0; k < 17; ++k) {
    const double jump = k < 14 ? 0 : k == 14 ? 0.5 : 1;
    drift.knots(0, k) = 3e-5 * jump;
    drift.knots(1, k) = 2e-6 * static_cast<double>(k);
    drift.knots(2, k) = 4e-5 * jump;
    drift.knots(3, k) = -1e-6 * static_cast<double>(k);
  }
  CalibrationReport report = five_poses();
  report.drift = {SessionDrift{}, drift};
  // from the first knot to the last (30, 32, 40) um; between knots 13 and 15 (30, 4, 40) um
  EXPECT_TRUE(says(report.verdict(),
                   "During the session the base of station 2 moved by up to 0.0594 mm and 16 urad, fastest (0.0502 mm) "
                   "between 65 and 75 of 0 .. 80 [row, or time_s]. The model that is saved is without drift."))
      << joined(report.verdict());
  // a jump at the very end
  drift.knots.setZero();
  drift.knots(0, 16) = 1e-5;
  report.drift = {drift};
  EXPECT_NE(joined(report.verdict())
                .find("the base moved by up to 0.01 mm and 0 urad, fastest (0.01 mm) between 70 and "
                      "80 of 0 .. 80"),
            std::string::npos)
      << joined(report.verdict());
}

}  // namespace
}  // namespace vernier::calibration_report_test
