// Reports as JSON: every number under its name, in its unit.

#include "vernier/io/report_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace vernier::report_json_test {
namespace {

using Json = nlohmann::ordered_json;

void expect_values(const Json& json, std::initializer_list<double> expected, double tolerance = 1e-9) {
  ASSERT_EQ(json.size(), expected.size()) << json.dump();
  std::size_t k = 0;
  for (const double value : expected) EXPECT_NEAR(json.at(k++).get<double>(), value, tolerance) << json.dump();
}

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
  EXPECT_NEAR(stages.at("frames").at("mean_mm").get<double>(), 3, 1e-12);
  EXPECT_NEAR(stages.at("frames").at("rms_mm").get<double>(), std::sqrt(12.5), 1e-12);
  EXPECT_NEAR(stages.at("frames").at("max_mm").get<double>(), 6, 1e-12);
  EXPECT_NEAR(stages.at("frames").at("min_mm").get<double>(), 1, 1e-12);
  EXPECT_NEAR(stages.at("frames").at("p95_mm").get<double>(), 5.55, 1e-12);
  EXPECT_FALSE(stages.at("frames").contains("mean_mrad"));
  EXPECT_NEAR(stages.at("geometry").at("mean_mrad").get<double>(), 2, 1e-12);
}

TEST(ReportJson, DecisionsParametersAndIdentifiability) {
  CalibrationReport report = least();
  report.train_poses = 17;
  report.chosen = Stage::geometry;
  report.blocks = {{Block::elastic, 1e-3, 2e-3, true, 3, 0.25}, {Block::jointwise, 4e-3, 5e-3, false, 6, 0}};
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
  EXPECT_EQ(json.at("robot"), "arm");
  EXPECT_EQ(json.at("train_rows"), 17);
  EXPECT_EQ(json.at("test_rows"), 4);
  EXPECT_EQ(json.at("chosen"), "geometry");
  EXPECT_EQ(json.at("mean_temperature_c"), 31);
  EXPECT_EQ(json.at("gated_rows"), 2);
  EXPECT_NEAR(json.at("worst_harm_beside_geometry_mm").get<double>(), 9e-3, 1e-12);
  EXPECT_EQ(json.at("within_95_percent_ellipsoids"), 0.75);
  EXPECT_EQ(json.at("verdict"), report.verdict());

  const Json& block = json.at("blocks").at(0);
  EXPECT_EQ(block.at("name"), "elastic");
  EXPECT_EQ(block.at("used"), true);
  EXPECT_NEAR(block.at("left_out_without_mm").get<double>(), 1, 1e-12);
  EXPECT_NEAR(block.at("left_out_with_mm").get<double>(), 2, 1e-12);
  EXPECT_EQ(block.at("log_density_gain"), 0.25);
  EXPECT_EQ(block.at("tightness"), 3);
  EXPECT_TRUE(json.at("blocks").at(1).at("tightness").is_null());  // of a block that is not there

  const Json& learner = json.at("learners").at(0);
  EXPECT_EQ(learner.at("stage"), "geometry_pso_elm");
  EXPECT_EQ(learner.at("used"), true);
  EXPECT_NEAR(learner.at("left_out_without_mm").get<double>(), 7, 1e-12);
  EXPECT_NEAR(learner.at("left_out_with_mm").get<double>(), 8, 1e-12);

  EXPECT_EQ(json.at("prior").at("name"), "last year");
  EXPECT_EQ(json.at("prior").at("used"), true);
  EXPECT_EQ(json.at("prior").at("geometry_kappa"), 0.1);
  EXPECT_EQ(json.at("prior").at("joints_kappa"), 0.2);

  const Json &length = json.at("parameters").at(0), &angle = json.at("parameters").at(1);
  EXPECT_EQ(length.at("name"), "a2");
  EXPECT_EQ(length.at("unit"), "mm");
  EXPECT_NEAR(length.at("nominal").get<double>(), 100, 1e-9);
  EXPECT_NEAR(length.at("identified").get<double>(), 200, 1e-9);
  EXPECT_NEAR(length.at("std").get<double>(), 300, 1e-9);
  EXPECT_EQ(angle.at("unit"), "mrad");
  EXPECT_NEAR(angle.at("nominal").get<double>(), 400, 1e-9);

  const Json& known = json.at("identifiability");
  EXPECT_EQ(known.at("rank"), 3);
  EXPECT_EQ(known.at("free"), 1);
  EXPECT_EQ(known.at("condition"), 250);
  EXPECT_EQ(known.at("weak"), std::vector<std::string>{"theta3"});
  for (int k = 1; k <= 5; ++k) EXPECT_EQ(known.at("observability").at(message('O', k)), k);
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
  const Json& first = json.at("drift").at(0);
  EXPECT_EQ(first.at("station"), 1);
  EXPECT_EQ(first.at("knots").at(0).at("time"), 10);
  EXPECT_EQ(first.at("knots").at(1).at("time"), 60);
  expect_values(first.at("knots").at(0).at("translation_um"), {1, 2, 3});
  expect_values(first.at("knots").at(0).at("rotation_urad"), {4, 5, 6});
  expect_values(first.at("knots").at(1).at("translation_um"), {7, 8, 9});
  EXPECT_FALSE(first.at("knots").at(0).contains("joint_zeros_urad"));
  const Json& second = json.at("drift").at(1);
  EXPECT_EQ(second.at("station"), 2);
  expect_values(second.at("knots").at(1).at("joint_zeros_urad"), {1, 4});
  report.drift[0].knots.conservativeResize(7, 2);  // one joint
  report.drift[0].knots(6, 0) = report.drift[0].knots(6, 1) = 13e-6;
  expect_values(to_json(report, "arm").at("drift").at(0).at("knots").at(0).at("joint_zeros_urad"), {13});

  EXPECT_EQ(json.at("spectrum").at(0).at("joint"), 1);
  EXPECT_TRUE(json.at("spectrum").at(0).at("orders").empty());
  const Json& spectrum = json.at("spectrum").at(1);
  EXPECT_EQ(spectrum.at("joint"), 2);
  EXPECT_EQ(spectrum.at("orders"), (std::vector<int>{1, 5}));
  expect_values(spectrum.at("amplitudes_urad"), {2, 6});
  expect_values(spectrum.at("stds_urad"), {3, 7});
  const Json& line = spectrum.at("lines").at(0);
  EXPECT_EQ(line.at("order"), 1);
  EXPECT_NEAR(line.at("amplitude_urad").get<double>(), 9, 1e-9);
  EXPECT_NEAR(line.at("margin_urad").get<double>(), 19.6, 1e-9);
  EXPECT_EQ(line.at("chi_square"), 11);
  EXPECT_EQ(line.at("cause"), "once a turn: an eccentric encoder or gear");
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
  expect_values(json.at("base_change_m_rad"), {1, 2, 3, 0, 0, 0});
  expect_values(json.at("tool_change_m_rad"), {4, 5, 6, 0, 0, 0});
  expect_values(json.at("offsets_rad"), {0.01, 0.02});
  EXPECT_NEAR(json.at("position_sigma_mm").get<double>(), 7e-3, 1e-12);
  EXPECT_NEAR(json.at("orientation_sigma_mrad").get<double>(), 8e-3, 1e-12);
  EXPECT_EQ(json.at("probe").at("turned"), true);
  expect_values(json.at("probe").at("by_mrad"), {1, 2, 3});
  EXPECT_EQ(json.at("probe").at("contradiction"), 9);
  EXPECT_EQ(json.at("held"), std::vector<std::string>{"the turn of the tool about its z"});
  EXPECT_EQ(json.at("remarks"), moved().remarks());
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
  out.mean_error = 1.5e-3;
  out.mean_upper = 2.5e-3;
  out.options.level = 0.01;
  return out;
}

TEST(ReportJson, Verifications) {
  VerificationReport report = checked();
  Json json = to_json(report, "arm");
  EXPECT_EQ(json.at("robot"), "arm");
  EXPECT_EQ(json.at("valid"), true);
  EXPECT_EQ(json.at("consistent"), false);
  EXPECT_EQ(json.at("verdict"), report.verdict());
  EXPECT_EQ(json.at("poses"), 3);
  EXPECT_NEAR(json.at("mean_mm").get<double>(), 1.5, 1e-12);
  EXPECT_NEAR(json.at("mean_upper_mm").get<double>(), 2.5, 1e-12);
  EXPECT_TRUE(json.at("accept_mm").is_null());
  EXPECT_EQ(json.at("level"), 0.01);
  EXPECT_EQ(json.at("chi_square"), 12);
  EXPECT_EQ(json.at("dof"), 9);
  EXPECT_EQ(json.at("p_value"), 0.2);
  EXPECT_EQ(json.at("aside"), std::vector<int>{2});
  EXPECT_TRUE(json.at("registration").is_null());
  EXPECT_EQ(json.at("advice"), report.advice());
  const Json &first = json.at("joints").at(0), &second = json.at("joints").at(1);
  EXPECT_EQ(first.at("joint"), 1);
  EXPECT_EQ(first.at("unit"), "mrad");
  EXPECT_EQ(first.at("determined"), true);
  EXPECT_NEAR(first.at("zero_change").get<double>(), 1e-3, 1e-12);
  EXPECT_NEAR(first.at("zero_std").get<double>(), 2e-3, 1e-12);
  EXPECT_EQ(first.at("zero_p"), 0.3);
  EXPECT_EQ(first.at("once_p"), 0.4);
  EXPECT_EQ(first.at("zero_changed"), true);
  EXPECT_EQ(first.at("transmission_changed"), false);
  EXPECT_EQ(second.at("unit"), "mm");
  EXPECT_TRUE(second.at("zero_change").is_null());
  EXPECT_TRUE(second.at("zero_std").is_null());
  EXPECT_EQ(second.at("transmission_changed"), true);

  // without a registration there is one stage, the errors themselves
  EXPECT_EQ(json.at("stages").size(), 1u);
  EXPECT_NEAR(json.at("stages").at("as_fitted").at("mean_mm").get<double>(), 2, 1e-12);
  EXPECT_NEAR(json.at("stages").at("as_fitted").at("mean_mrad").get<double>(), 5, 1e-12);
  report.registration = moved();
  report.options.accept = 0.5e-3;
  report.mean_upper = std::numeric_limits<double>::infinity();
  json = to_json(report, "arm");
  ASSERT_EQ(json.at("stages").size(), 2u);
  EXPECT_NEAR(json.at("stages").at("as_fitted").at("mean_mm").get<double>(), 8, 1e-12);
  EXPECT_NEAR(json.at("stages").at("as_fitted").at("mean_mrad").get<double>(), 11, 1e-12);
  EXPECT_NEAR(json.at("stages").at("registered").at("mean_mm").get<double>(), 2, 1e-12);
  EXPECT_NEAR(json.at("stages").at("registered").at("mean_mrad").get<double>(), 5, 1e-12);
  EXPECT_NEAR(json.at("accept_mm").get<double>(), 0.5, 1e-12);
  EXPECT_TRUE(json.at("mean_upper_mm").is_null());
  EXPECT_EQ(json.at("registration"), to_json(*report.registration));
}

}  // namespace
}  // namespace vernier::report_json_test
