// SPDX-License-Identifier: BSD-3-Clause
// Reports as JSON: every number under its name, in its unit.

#include "vernier/io/report_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "json_parts.hpp"

namespace vernier::report_json_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::expect_parts;

VectorX list(std::initializer_list<double> values) {
  VectorX out(static_cast<Index>(values.size()));
  Index k = 0;
  for (const double value : values) out(k++) = value;
  return out;
}

/// A report without poses outside the measured ranges, and the least that its sentences need.
CalibrationReport least() {
  CalibrationReport out;
  out.stages = {{Stage::frames, "frames alone", list({1e-3, 2e-3, 3e-3, 6e-3}), {}},
                {Stage::geometry, "geometry", list({0.1e-3, 0.2e-3, 0.3e-3, 0.6e-3}), list({1e-3, 2e-3, 3e-3, 2e-3})}};
  out.gates = VectorX::Ones(4);
  return out;
}

// Errors 1, 2, 3 and 6 mm: mean 3, rms sqrt(50 / 4), the 95 % quantile at 0.85 of the way from 3 to 6.
TEST(ReportJson, StagesInMillimetresAndMilliradians) {
  const Json stages = stages_to_json(least().stages);
  expect_parts(stages, R"({
    "frames": {"mean_mm": 3, "rms_mm": 3.5355339059327378, "max_mm": 6, "min_mm": 1, "p95_mm": 5.55},
    "geometry": {"mean_mrad": 2}})");
  EXPECT_FALSE(stages.at("frames").contains("mean_mrad"));
}

TEST(ReportJson, DecisionsParametersAndIdentifiability) {
  CalibrationReport report = least();
  report.train_poses = 17;
  report.chosen = Stage::geometry;
  report.blocks = {{Block::elastic, 1e-3, 2e-3, true, 3, {Answer::found, 0.25, 3e-3, {2e-3, 5e-3}, 1e-3, 70}},
                   {Block::jointwise, 4e-3, 5e-3, false, 6}};
  report.trials = {{true, Learner::pso_elm, 7e-3, 8e-3, true}};
  report.mean_temperature = 31;
  report.prior = PriorTransfer{"last year", 0.1, 0.2, true};
  report.max_degradation = 9e-6;
  report.ellipsoid_coverage = 0.75;
  report.gates = list({1, 0.5, 0, 1});
  IdentificationReport& id = report.identification;
  id.parameters = {{"a2", ParameterKind::length, 0.1, 0.2, 0.3, ParameterState::identified, "", 1e-3},
                   {"theta3", ParameterKind::angle, 0.4, 0.5, 0.6, ParameterState::weak, "", 1e-3}};
  id.free = {1};
  id.rank = 3;
  id.condition = 250;
  id.observability = {1, 2, 3, 4, 5};

  const Json json = to_json(report, "arm");
  EXPECT_EQ(json.at("verdict"), report.verdict());
  EXPECT_EQ(json.at("details"), report.details());
  // the second block is not there, so its prior has no tightness
  expect_parts(json, R"({
    "robot": "arm", "train_rows": 17, "test_rows": 4, "chosen": "geometry", "mean_temperature_c": 31, "gated_rows": 2,
    "held_out_mean_mm": {"mean": 0.3, "lower": 0, "upper": null}, "worst_harm_beside_geometry_mm": 9e-3, "within_95_percent_ellipsoids": 0.75,
    "blocks": [{"name": "elastic", "used": true, "left_out_without_mm": 1, "left_out_with_mm": 2,
                "answer": "found", "p": 0.25, "size_mm": 3, "interval_mm": [2, 5], "relevant_mm": 1,
                "poses_to_decide": 70, "tightness": 3},
               {"tightness": null}],
    "learners": [{"stage": "geometry_pso_elm", "used": true, "left_out_without_mm": 7, "left_out_with_mm": 8}],
    "prior": {"name": "last year", "used": true, "geometry_kappa": 0.1, "joints_kappa": 0.2},
    "parameters": [{"name": "a2", "unit": "mm", "nominal": 100, "identified": 200, "std": 300},
                   {"unit": "mrad", "nominal": 400}],
    "identifiability": {"rank": 3, "free": 1, "condition": 250, "weak": ["theta3"],
                        "observability": {"O1": 1, "O2": 2, "O3": 3, "O4": 4, "O5": 5}}})");
}

// Errors 1 to 5 mm: mean 3, variance 2.5, Student's t of 4 degrees of freedom 2.776.
TEST(ReportJson, MeanOfHeldOutPosesWithItsInterval) {
  CalibrationReport report = least();
  report.stages[1].position = list({1e-3, 2e-3, 3e-3, 4e-3, 5e-3});
  report.stages[0].position = report.stages[1].position;
  report.gates = VectorX::Ones(5);
  const Json mean = to_json(report, "arm").at("held_out_mean_mm");
  EXPECT_NEAR(mean.at("mean"), 3, 1e-12);
  EXPECT_NEAR(mean.at("lower"), 3 - 2.776445 * std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(mean.at("upper"), 3 + 2.776445 * std::sqrt(0.5), 1e-3);
}

// All of them, however many; rows of no file have none.
TEST(ReportJson, EveryOutlierIsListed) {
  CalibrationReport report = least();
  report.outliers.assign(12, {.row = 5, .position = 1e-3, .factor = 20});
  report.outliers[0] = {
      .file = "m.csv", .line = 9, .station = 1, .row = 7, .position = 2, .rotation = 0.1, .factor = 3e4};
  const Json json = to_json(report, "arm");
  ASSERT_EQ(json.at("outliers").size(), 12u);
  expect_parts(json.at("outliers").at(0), R"({"file": "m.csv", "line": 9, "station": 2, "row": 7, "position_mm": 2000,
    "rotation_mrad": 100, "spreads": 30000})");
  EXPECT_TRUE(json.at("outliers").at(11).at("file").is_null());
  EXPECT_EQ(json.at("outliers_kept"), false);
}

TEST(ReportJson, WhatThereIsNotIsNull) {
  const Json json = to_json(least(), "arm");
  EXPECT_TRUE(json.at("mean_temperature_c").is_null());
  EXPECT_TRUE(json.at("prior").is_null());
  for (const char* key : {"blocks", "learners", "parameters", "spectrum", "drift"})
    EXPECT_TRUE(json.at(key).is_array() && json.at(key).empty()) << key;
}

// A station whose base drifts, and one where the joints' zeros do, too: two knots each, 50 apart.
TEST(ReportJson, DriftAndSpectrumInMicrometresAndMicroradians) {
  CalibrationReport report = least();
  SessionDrift drift{.begin = 10, .spacing = 50};
  drift.knots.resize(6, 2);
  for (Index k = 0; k < 12; ++k) drift.knots(k % 6, k / 6) = 1e-6 * static_cast<double>(1 + k);
  SessionDrift with_zeros{.begin = -5, .spacing = 50};
  with_zeros.knots.setConstant(8, 2, 1e-6);
  with_zeros.knots(7, 1) = 4e-6;
  report.drift = {drift, with_zeros};
  JointReport joint;
  joint.spectrum = {{1, 2e-6, 3e-6, 4}, {5, 6e-6, 7e-6, 8}};
  joint.lines = {{1, 9e-6, 10e-6, 11}};
  report.joints = {JointReport{}, joint};

  const Json json = to_json(report, "arm");
  expect_parts(json, R"({
    "drift": [{"station": 1, "knots": [
                {"time": 10, "translation_um": [1, 2, 3], "rotation_urad": [4, 5, 6]},
                {"time": 60, "translation_um": [7, 8, 9]}]},
              {"station": 2, "knots": [{}, {"joint_zeros_urad": [1, 4]}]}],
    "spectrum": [{"joint": 1, "orders": []},
                 {"joint": 2, "orders": [1, 5], "amplitudes_urad": [2, 6], "stds_urad": [3, 7],
                  "lines": [{"order": 1, "amplitude_urad": 9, "margin_urad": 19.6, "chi_square": 11,
                             "cause": "once a turn: an eccentric encoder or gear"}]}]})");
  EXPECT_FALSE(json.at("drift").at(0).at("knots").at(0).contains("joint_zeros_urad"));
  report.drift[0].knots.conservativeResize(7, 2);  // one joint
  report.drift[0].knots(6, 0) = report.drift[0].knots(6, 1) = 13e-6;
  expect_parts(to_json(report, "arm").at("drift").at(0), R"({"knots": [{"joint_zeros_urad": [13]}, {}]})");
}

ReregistrationReport moved() {
  ReregistrationReport out;
  out.determined = out.converged = true;
  out.motion.base.translation() = Vector3(1, 2, 3);
  out.motion.tool.translation() = Vector3(4, 5, 6);
  out.motion.offsets = list({0.01, 0.02});
  out.motion.probe = Vector3(1e-3, 2e-3, 3e-3);
  out.joint_types = {JointType::revolute, JointType::revolute};
  out.change_std = VectorX::Constant(14, 1e-6);
  out.position_sigma = 7e-6;
  out.orientation_sigma = 8e-6;
  out.contradiction = 9;
  out.probe_turned = true;
  out.held = {"the turn of the tool about its z"};
  return out;
}

TEST(ReportJson, Reregistrations) {
  const Json json = to_json(moved());
  EXPECT_EQ(json.at("remarks"), moved().remarks());
  expect_parts(json, R"({
    "base_change_m_rad": [1, 2, 3, 0, 0, 0], "tool_change_m_rad": [4, 5, 6, 0, 0, 0], "offsets_rad": [0.01, 0.02],
    "position_sigma_mm": 7e-3, "orientation_sigma_mrad": 8e-3,
    "probe": {"turned": true, "by_mrad": [1, 2, 3], "contradiction": 9},
    "held": ["the turn of the tool about its z"]})");
}

VerificationReport checked() {
  VerificationReport out;
  out.valid = true;
  out.poses = 3;
  out.chi_square = 12;
  out.dof = 9;
  out.p_value = 0.2;
  out.joint_types = {JointType::revolute, JointType::prismatic};
  out.joints = {{true, 1e-6, 2e-6, 0.3, 0.4, true, false}, {false, 5e-6, 6e-6, 0.7, 0.8, false, true}};
  out.errors = list({1e-3, 2e-3, 3e-3});
  out.rotations = list({4e-3, 5e-3, 6e-3});
  out.as_fitted = list({7e-3, 8e-3, 9e-3});
  out.rotations_as_fitted = list({10e-3, 11e-3, 12e-3});
  out.normalised = list({0.1, 0.2, 0.3});
  out.aside = {2};
  out.known = 4;
  out.mean_error = 1.5e-3;
  out.mean_upper = 2.5e-3;
  out.options.level = 0.01;
  return out;
}

TEST(ReportJson, Verifications) {
  VerificationReport report = checked();
  Json json = to_json(report, "arm");
  EXPECT_EQ(json.at("verdict"), report.verdict());
  EXPECT_EQ(json.at("advice"), report.advice());
  EXPECT_EQ(json.at("stages").size(), 1u);  // without a registration the errors themselves
  expect_parts(json, R"({
    "robot": "arm", "valid": true, "consistent": false, "poses": 3, "poses_left_out": 4, "mean_mm": 1.5, "mean_upper_mm": 2.5,
    "accept_mm": null, "level": 0.01, "chi_square": 12, "dof": 9, "p_value": 0.2, "aside": [2], "registration": null,
    "joints": [{"joint": 1, "unit": "mrad", "determined": true, "zero_change": 1e-3, "zero_std": 2e-3, "zero_p": 0.3,
                "once_p": 0.4, "zero_changed": true, "transmission_changed": false},
               {"unit": "mm", "zero_change": null, "zero_std": null, "transmission_changed": true}],
    "stages": {"as_fitted": {"mean_mm": 2, "mean_mrad": 5}}})");
  report.registration = moved();
  report.options.accept = 0.5e-3;
  report.mean_upper = std::numeric_limits<double>::infinity();
  json = to_json(report, "arm");
  EXPECT_EQ(json.at("registration"), to_json(*report.registration));
  ASSERT_EQ(json.at("stages").size(), 2u);
  expect_parts(json, R"({
    "accept_mm": 0.5, "mean_upper_mm": null,
    "stages": {"as_fitted": {"mean_mm": 8, "mean_mrad": 11}, "registered": {"mean_mm": 2, "mean_mrad": 5}}})");
}

}  // namespace
}  // namespace vernier::report_json_test
