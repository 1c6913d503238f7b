// SPDX-License-Identifier: BSD-3-Clause
// Sentences of the report whose numbers are worked by hand.

#include "vernier/calibration/calibration_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

TEST(WordingWhiteBox, TablesHaveThreeDigits) {
  const std::pair<double, const char*> cases[] = {
      {0, "0"},        {0.05, "0.0500"},   {0.5, "0.500"},       {9.994, "9.99"},     {9.996, "10.0"},   {-12, "-12.0"},
      {999.6, "1000"}, {123456, "123456"}, {1.25e6, "1.25e+06"}, {2e-5, "0.0000200"}, {1e-7, "1.00e-07"}};
  for (const auto& [value, text] : cases) EXPECT_EQ(detail::three_digits(value), text);
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
    EXPECT_TRUE(says(report.details(),
                     "During the session the base moved by up to 0.05 mm and 30 urad, fastest (0.04 mm) between 110 "
                     "and 120 of 100 .. 120 [row, or time_s]. The zero of joint 2 moved most, by 20 " +
                         std::string(revolute ? "urad" : "um") + ". The model that is saved is without drift."));
  }
}

TEST(CalibrationReport, WeakParametersByName) {
  CalibrationReport report = report_of_four();
  const std::string weak = " weakly determined and regularised around nominal: ";
  for (const char* name : {"d1", "a2", "a3", "d4", "d5", "d6"})
    report.identification.parameters.push_back({name, ParameterKind::length, 0, 0, 0, ParameterState::identified, ""});
  for (const std::string& line : report.verdict()) EXPECT_EQ(line.find(weak), std::string::npos);
  report.identification.parameters[1].state = ParameterState::weak;
  EXPECT_TRUE(says(report.verdict(), "1 parameter is" + weak + "a2."));
  for (const std::size_t k : {2, 3, 4}) report.identification.parameters[k].state = ParameterState::weak;
  EXPECT_TRUE(says(report.verdict(), "4 parameters are" + weak + "a2, a3, d4, d5."));
  report.identification.parameters[5].state = ParameterState::weak;
  EXPECT_TRUE(says(report.verdict(), "5 parameters are" + weak + "a2, a3, d4, d5 and 1 more."));
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
            "frames                     2.33     2.65     4.00     1.00     3.80\n");
  stages[0].rotation = 1e-3 * VectorX{{1, 2, 6}};
  stages.push_back(
      {learned_stage(true, Learner::pso_elm), "geometry + PSO-ELM", 0.5 * errors, 0.5 * stages[0].rotation});
  EXPECT_EQ(stage_table(stages),
            "stage                      mean      rms      max      min      p95  mean [mrad]\n"
            "frames                     2.33     2.65     4.00     1.00     3.80         3.00\n"
            "geometry + PSO-ELM         1.17     1.32     2.00    0.500     1.90         1.50\n");
}

// Errors 0.1, 0.15, 0.2, 0.3 and 9: mean 1.95, at 3.8 of 4 they are 0.3 + 0.8 x 8.7. The squared deviations add up to
// 62.15, and Student's t of 4 degrees of freedom at 0.975 is 2.776: the mean has 1.95 +- 4.894, and is not negative.
TEST(CalibrationReport, AllHeldOutPosesComeFirst) {
  CalibrationReport report = five_poses();
  EXPECT_EQ(report.extrapolated(), 1);
  EXPECT_EQ(joined(report.verdict()),
            "Only 5 poses were held out: too few to judge the accuracy; hold out at least 10.\n"
            "Position error of all 5 held-out poses: 1.95 mm mean (95 % interval 0 to 6.84 mm), 7.26 mm at the 95th "
            "percentile, 9 mm maximum.\n"
            "4 of them lie inside the range of validity: 0.188 mm mean, 0.3 mm maximum. The other has 9 mm; there the "
            "learned functions of the joints fade out.\n"
            "Deployed, as left-out poses decide: joint-wise.\n");
  EXPECT_DOUBLE_EQ(report.held_out_mean().mean, 1.95e-3);
  EXPECT_EQ(report.held_out_mean().lower, 0);
  EXPECT_NEAR(report.held_out_mean().upper, 1.95e-3 + 2.776445e-3 * std::sqrt(62.15 / 4 / 5), 2e-6);
  report.gates(0) = 0;
  EXPECT_TRUE(says(report.verdict(),
                   "3 of them lie inside the range of validity: 0.217 mm mean, 0.3 mm maximum. The other 2 have a mean "
                   "of 4.55 mm; there the learned functions of the joints fade out."))
      << joined(report.verdict());
  report.chosen = Stage::geometry;  // 0.1 to 0.5
  EXPECT_EQ(report.verdict()[1].rfind("Position error of all 5 held-out poses: 0.3 mm mean", 0), 0u);
  EXPECT_TRUE(says(report.verdict(), "Deployed, as left-out poses decide: geometry."));
  report.gates.setConstant(0.5);
  EXPECT_TRUE(says(report.verdict(),
                   "None of them lies inside the range of validity; outside, the learned functions of the joints fade "
                   "out."));
  EXPECT_EQ(report.extrapolated(), 5);
}

// Nine poses are few, ten are not. Their errors 1 .. 10 um have the mean 5.5 and the variance 55 / 6; t of 9 degrees of
// freedom is 2.262, so the interval is +- 2.166.
TEST(CalibrationReport, TenPosesAreEnough) {
  CalibrationReport report;
  VectorX errors(10);
  for (Index i = 0; i < 10; ++i) errors(i) = 1e-6 * static_cast<double>(i + 1);
  report.stages.push_back({Stage::frames, "frames", 100 * errors, {}});
  report.stages.push_back({Stage::geometry, "geometry", errors, {}});
  report.gates = VectorX::Ones(10);
  EXPECT_EQ(joined(report.verdict()),
            "Position error of all 10 held-out poses: 0.0055 mm mean (95 % interval 0.00333 to 0.00767 mm), 0.00955 mm "
            "at the 95th percentile, 0.01 mm maximum; links as designed: 0.55 mm mean.\n"
            "Deployed, as left-out poses decide: geometry.\n");
  EXPECT_EQ(report.few_poses(), "");
  report.held_out_poses = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4};  // each read twice: means 1.5, 3.5 .. 9.5, t of 4 is 2.776
  EXPECT_EQ(report.independent_poses(), 5);
  EXPECT_EQ(report.few_poses(),
            "Only 5 independent poses were held out: too few to judge the accuracy; hold out at least 10.");
  report.block_error = 12e-6;
  EXPECT_EQ(report.verdict()[1],
            "Position error of all 10 held-out rows (5 independent poses, each counted once): 0.0055 mm mean (95 % "
            "interval 0.00157 to "
            "0.00943 mm), 0.00955 mm at the 95th percentile, 0.01 mm maximum; links as designed: 0.55 mm mean; the "
            "training rows follow a path, and blocks of neighbours left out have 0.012 mm.");
  report.held_out_poses.clear();
  for (StageErrors& stage : report.stages) stage.position.conservativeResize(9);
  EXPECT_EQ(report.few_poses(), "Only 9 poses were held out: too few to judge the accuracy; hold out at least 10.");
  EXPECT_EQ(report_of_four().verdict()[1],
            "Position error of all 4 held-out poses: 0.1 mm mean (too few poses for an interval), 0.1 mm at the 95th "
            "percentile, 0.1 mm maximum.");
}

// Everything at once has seven lines.
TEST(CalibrationReport, TheVerdictHasSevenLinesAtMost) {
  CalibrationReport report = five_poses();
  report.blocks = {{Block::elastic, 1e-3, 0.5e-3, true},
                   {Block::jointwise, 1e-3, 0.5e-3, true},
                   {Block::approach, 1e-3, 2e-3, false, 1, {Answer::ruled_out}},
                   {Block::tilt, 1e-3, 2e-3, false, 1, {Answer::undecided}}};
  report.converged = false;
  report.outliers = {{.file = "m.csv", .line = 3, .position = 2}, {.file = "m.csv", .line = 9, .position = 0.5}};
  report.identification.status = IdentifyStatus::not_converged;
  report.identification.message = "100 iterations";
  report.identification.condition = 2.6e6;
  report.identification.parameters = {{"d4", ParameterKind::length, 0, 0, 0, ParameterState::weak, ""}};
  SessionDrift still{.begin = 0, .spacing = 1}, moving = still;
  still.knots = MatrixX::Zero(6, 2);
  moving.knots = MatrixX::Zero(6, 2);
  moving.knots(0, 1) = 3e-5;
  moving.knots(1, 1) = 4e-5;
  moving.knots(5, 1) = -2e-5;
  report.drift = {still, moving};
  const std::vector<std::string> said = report.verdict();
  ASSERT_EQ(said.size(), 7u) << joined(said);
  EXPECT_EQ(said[3],
            "Deployed, as left-out poses decide: joint-wise. Included: gravity compliance, functions of single joints. "
            "Ruled out, as too small to matter: hysteresis by the direction of approach. Undecided, since the poses "
            "are too few: tilts of joint frames under gravity.");
  EXPECT_EQ(said[4],
            "The fit of the joint errors stopped before it converged. The fit of the geometry did not converge: 100 "
            "iterations. The geometry is poorly determined: its condition is 2.6e+06. 2 training rows are "
            "outliers and left out: m.csv, lines 3 and 9 (off by up to 2000 mm).");
  EXPECT_EQ(said[5],
            "Drift was estimated and is not in the saved model: the base of station 2 moved by up to 0.05 mm and 20 "
            "urad during the session.");
}

// Gravity compliance was decided on twice: the second decision holds. Drift is estimated, but not deployed.
TEST(CalibrationReport, TheVerdictNamesWhatIsDeployed) {
  CalibrationReport report = five_poses();
  report.blocks = {{Block::elastic, 1e-3, 0.5e-3, true},
                   {Block::jointwise, 1e-3, 0.5e-3, true},
                   {Block::elastic_again, 1e-3, 2e-3, false, 1, {Answer::ruled_out}},
                   {Block::gears, 1e-3, 2e-3, false, 1, {Answer::found}},
                   {Block::temperature, 1e-3, 1e-3, false},
                   {Block::drift, 1e-3, 0.5e-3, true, 1, {Answer::found}},
                   {Block::joint_drift, 1e-3, 2e-3, false, 1, {Answer::ruled_out}}};
  EXPECT_TRUE(
      says(report.verdict(),
           "Deployed, as left-out poses decide: joint-wise. Included: functions of single joints. Found, but not "
           "deployed, because they predict left-out poses worse: gear ratios and coupling. Ruled out, as too "
           "small to matter: gravity compliance, drift of the joints' zeros. Not tested, because time cannot be "
           "told apart: change of the geometry with temperature."))
      << joined(report.verdict());
  report.chosen = {Stage::geometry_learned, Learner::pso_elm};
  report.stages.push_back({report.chosen, "geometry + PSO-ELM", 1e-3 * VectorX{{0.1, 0.2, 0.3, 9, 0.15}}, {}});
  EXPECT_TRUE(says(report.verdict(), "Deployed, as left-out poses decide: geometry + PSO-ELM."));
}

// Deflection is in the model, but gears may do the same at these poses.
TEST(CalibrationReport, NamesWhatPosesCannotTellApart) {
  CalibrationReport report = five_poses();
  Existence open{.answer = Answer::undecided, .p = 5e-4, .size = 0.03e-3, .interval = {0, 0.05e-3}, .look_alike = true};
  report.blocks = {{Block::elastic, 1e-3, 0.5e-3, true, 1, open},
                   {Block::jointwise, 1e-3, 0.5e-3, true},
                   {Block::gears, 1e-3, 2e-3, false, 1, open}};
  EXPECT_TRUE(
      says(report.verdict(),
           "Deployed, as left-out poses decide: joint-wise. Included: functions of single joints. Included, "
           "though these poses cannot tell it from other errors of joints: gravity compliance. Undecided, since "
           "the poses are too few: gear ratios and coupling."))
      << joined(report.verdict());
  const std::string details = joined(report.details());
  EXPECT_NE(details.find("Gravity compliance: undecided, because these poses cannot tell it from other errors of "
                         "joints. In place of them it has 0.03 mm at the tool (p = 0.0005); included. Left-out error"),
            std::string::npos)
      << details;
  EXPECT_NE(details.find("(p = 0.0005); left out. Left-out error"), std::string::npos) << details;
}

TEST(CalibrationReport, DegradationIsThatOfAnotherStageThanGeometry) {
  CalibrationReport report = five_poses();
  const std::string no_worse = "Inside the range of validity no held-out pose is worse than with geometry alone";
  EXPECT_TRUE(says(report.details(), no_worse + "."));
  report.max_degradation = 0.05e-3;
  EXPECT_TRUE(says(report.details(), no_worse + " by more than 0.05 mm."));
  report.chosen = Stage::geometry;
  EXPECT_EQ(joined(report.details()).find(no_worse), std::string::npos);
  report.chosen = Stage::jointwise;
  report.gates.setZero();  // nothing is said of no poses
  EXPECT_EQ(joined(report.details()).find(no_worse), std::string::npos);
}

TEST(CalibrationReport, RangesInDegreesAndMillimetres) {
  CalibrationReport report = five_poses();
  report.joints.resize(2);
  report.joints[0].measured_ranges = {{-1, 0.5}, {1, 2}};
  report.joints[1].revolute = false;
  for (int k = 0; k < 6; ++k) report.joints[1].measured_ranges.push_back({0.1 * k, 0.1 * k + 0.05});
  EXPECT_TRUE(says(report.details(),
                   "Measured joint ranges [deg, mm]: q1 -57..29, 57..115; q2 0..50, 100..150, 200..250, 300..350, and "
                   "2 more."))
      << joined(report.details());
  report.joints[1].measured_ranges.resize(4);
  report.joints[0].valid_ranges = {{-1.1, 0.6}};
  EXPECT_TRUE(says(report.details(),
                   "Measured joint ranges [deg, mm]: q1 -57..29, 57..115; q2 0..50, 100..150, 200..250, 300..350."))
      << joined(report.details());
  EXPECT_TRUE(says(report.details(), "Range of validity [deg, mm]: q1 -63..34; q2."));
  report.joints[0].formula = "-J2 - J3";  // a joint of the chain that is none of the controller's
  EXPECT_TRUE(says(report.details(), "Range of validity [deg, mm]: -J2 - J3: -63..34; q2."));
}

// A block has a sentence for each answer, with sizes and errors in millimetres.
TEST(CalibrationReport, AnswersByHand) {
  const auto said = [](Block block, bool used, const Existence& existence) {
    CalibrationReport report = five_poses();
    report.blocks = {{block, 0.25e-3, 0.125e-3, used, 1, existence}};
    return report.details();
  };
  const std::string errors = " Left-out error: 0.25 mm without, 0.125 mm with.";
  const Existence found{Answer::found, 0.001, 0.5e-3, {0.25e-3, 0.75e-3}, 0.1e-3, 20};
  const std::string size = "Gear ratios and coupling: found (p = 0.001), 0.5 mm at the tool, 0.25 to 0.75 with 95 %";
  EXPECT_TRUE(says(said(Block::gears, true, found), size + "." + errors));
  EXPECT_TRUE(says(said(Block::gears, false, found),
                   size + "; not deployed, because it predicts left-out poses worse." + errors));
  EXPECT_TRUE(says(said(Block::drift, false, {Answer::ruled_out, 0.5, 0, {0, 0.05e-3}, 0.1e-3, 20}),
                   "Drift of the base: ruled out above 0.05 mm at the tool." + errors));
  const std::string few = "Gravity compliance: undecided (p = 0.5): below 0.25 mm at the tool, 0.1 mm would matter; ";
  EXPECT_TRUE(says(said(Block::elastic, false, {Answer::undecided, 0.5, 0, {0, 0.25e-3}, 0.1e-3, 120}),
                   few + "about 120 poses would decide." + errors));
  EXPECT_TRUE(says(said(Block::elastic, false, {Answer::undecided, 0.5, 0, {0, 0.25e-3}, 0.1e-3, 0}),
                   few + "more poses of this kind would not decide." + errors));
  EXPECT_TRUE(says(said(Block::tuned_priors, true, {}), "Optimised priors: included." + errors));
  EXPECT_TRUE(says(said(Block::tuned_priors, false, {}), "Optimised priors: left out." + errors));
  EXPECT_TRUE(says(said(Block::temperature, false, {}),
                   "Change of the geometry with temperature: not tested, because temperature and time cannot be told "
                   "apart." +
                       errors));
}

TEST(CalibrationReport, WhatWasLearnedAndKnownBefore) {
  CalibrationReport report = five_poses();
  report.trials = {{true, Learner::pso_elm, 0.5e-3, 0.25e-3}, {false, Learner::kernel_elm, 0.1e-3, 0.125e-3}};
  report.mean_temperature = 21.5;
  report.prior = PriorTransfer{"last year", 0.25, 0.5, true};
  EXPECT_TRUE(says(report.details(),
                   "Left-out poses with what was learned on top: PSO-ELM on geometry 0.25 mm (0.5 without); kernel ELM "
                   "on the error model 0.125 mm (0.1 without)."))
      << joined(report.details());
  EXPECT_TRUE(says(report.details(),
                   "Where no temperature is given, the model is that of 21.5 deg C, the mean of the measurements."));
  const std::string of_prior =
      "Of the calibration 'last year' the geometry has changed by 25 % and the joint errors by 50 % of their expected "
      "sizes, as far as evidence tells.";
  EXPECT_TRUE(says(report.details(), of_prior)) << joined(report.details());
  report.prior->used = false;
  EXPECT_FALSE(says(report.details(), of_prior));
  const std::string none =
      "No learned correction was added to the error model: none reduced the left-out error by enough.";
  EXPECT_TRUE(says(report.details(), none));
  report.chosen = {Stage::learned, Learner::kernel_elm};
  report.stages.push_back({report.chosen, "joint-wise + kernel ELM", 1e-3 * VectorX{{0.1, 0.2, 0.3, 9, 0.15}}, {}});
  EXPECT_FALSE(says(report.details(), none));
  report.chosen = Stage::jointwise;
  report.trials.pop_back();
  EXPECT_FALSE(says(report.details(), none));
}

TEST(CalibrationReport, RemarksByHand) {
  CalibrationReport report = five_poses();
  EXPECT_TRUE(report.remarks().empty());
  report.converged = false;
  EXPECT_EQ(joined(report.remarks()), "The fit of the joint errors stopped before it converged.\n");
  report.converged = true;
  report.identification.condition = 1e6;
  EXPECT_TRUE(report.remarks().empty());
  report.identification.status = IdentifyStatus::underdetermined;
  report.identification.message = "2 poses give 6 values";
  EXPECT_EQ(joined(report.remarks()), "The geometry is underdetermined: 2 poses give 6 values.\n");
  report.identification.status = IdentifyStatus::converged;
  report.outliers = {{.row = 4, .position = 2e-3, .rotation = 0.1}};
  EXPECT_EQ(joined(report.remarks()),
            "1 training row is an outlier and left out: row 4 (off by up to 2 mm, 100 mrad).\n");
  report.outliers_kept = true;
  EXPECT_EQ(joined(report.remarks()),
            "1 training row is an outlier and kept, as asked: row 4 (off by up to 2 mm, 100 mrad).\n");
  report.others = {{"touches.csv", "lengths", 12, 0.02e-3}};
  const std::string brief = report.summary(), full = report.full_summary();
  EXPECT_EQ(brief.rfind("Verdict\n- Only 5 poses", 0), 0u) << brief;
  for (const char* words : {"and kept, as asked: row 4 (off by up to 2 mm, 100 mrad).\n",
                            "\nErrors of the 5 held-out poses [mm]\n\nstage  ",
                            "touches.csv: 12 measurements (lengths), fitted to 0.02 mm (rms)\n"})
    EXPECT_NE(brief.find(words), std::string::npos) << words << brief;
  EXPECT_EQ(full, brief + "\n" + report.identification.summary() + "\nDetails\n- " + report.details()[0] + "\n- " +
                      report.details()[1] + "\n- " + report.details()[2] + "\n");
}

// The details list the lines of a joint above the orders of assembly errors, at most three, each with the half-width
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
  EXPECT_TRUE(says(report.details(), "Joint 2: 70 urad (+-20) at order 29; 60 urad (+-10) at order 64, " + cause +
                                         "; 50 urad (+-10) at order 37."))
      << joined(report.details());
  EXPECT_EQ(joined(report.details()).find("Joint 1:"), std::string::npos);
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
  EXPECT_TRUE(says(report.details(),
                   "During the session the base of station 2 moved by up to 0.0594 mm and 16 urad, fastest (0.0502 mm) "
                   "between 65 and 75 of 0 .. 80 [row, or time_s]. The model that is saved is without drift."))
      << joined(report.details());
  // a jump at the very end
  drift.knots.setZero();
  drift.knots(0, 16) = 1e-5;
  report.drift = {drift};
  EXPECT_NE(joined(report.details())
                .find("the base moved by up to 0.01 mm and 0 urad, fastest (0.01 mm) between 70 and "
                      "80 of 0 .. 80"),
            std::string::npos)
      << joined(report.details());
}

}  // namespace
}  // namespace vernier::calibration_report_test
