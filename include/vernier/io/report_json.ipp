// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "vernier/error_terms/drive_lines.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/io/report_json.hpp"

namespace vernier {

VERNIER_IMPL nlohmann::ordered_json stages_to_json(const std::vector<StageErrors>& stages) {
  nlohmann::ordered_json out;
  for (const StageErrors& stage : stages) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    nlohmann::ordered_json& of_stage = out[stage.key()];
    of_stage = {{"mean_mm", e.mean}, {"rms_mm", e.rms}, {"max_mm", e.max}, {"min_mm", e.min}, {"p95_mm", e.p95}};
    if (stage.rotation.size() > 0) of_stage["mean_mrad"] = stage.rotation.mean() * 1e3;
  }
  return out;
}

VERNIER_IMPL nlohmann::ordered_json to_json(const CalibrationReport& report, const std::string& robot) {
  using Json = nlohmann::ordered_json;
  const IdentificationReport& identification = report.identification;
  Json parameters = Json::array(), blocks = Json::array();
  for (const BlockChoice& block : report.blocks)
    blocks.push_back({{"name", traits_of(block.block).key},
                      {"used", block.used},
                      {"left_out_without_mm", block.without * 1e3},
                      {"left_out_with_mm", block.with * 1e3},
                      {"answer", name_of(block.existence.answer)},
                      {"look_alike", block.existence.look_alike},
                      {"p", block.existence.p},
                      {"size_mm", block.existence.size * 1e3},
                      {"interval_mm", {block.existence.interval[0] * 1e3, block.existence.interval[1] * 1e3}},
                      {"relevant_mm", block.existence.relevance * 1e3},
                      {"poses_to_decide", block.existence.poses},
                      {"tightness", block.used ? Json(block.precision) : Json()}});
  for (const ParameterEstimate& p : identification.parameters)
    parameters.push_back({{"name", p.name},
                          {"unit", p.kind == ParameterKind::length ? "mm" : "mrad"},
                          {"nominal", p.nominal * 1e3},
                          {"identified", p.identified * 1e3},
                          {"std", p.std * 1e3}});
  Json trials = Json::array();
  for (const RemainderTrial& trial : report.trials)
    trials.push_back({{"stage", learned_stage(trial.on_geometry, trial.learner).key()},
                      {"used", trial.supported},
                      {"left_out_without_mm", trial.without * 1e3},
                      {"left_out_with_mm", trial.with * 1e3}});
  Json outliers = Json::array();
  for (const OutlyingRow& one : report.outliers)
    outliers.push_back({{"file", one.file.empty() ? Json() : Json(one.file)},
                        {"line", one.file.empty() ? Json() : Json(one.line)},
                        {"station", one.station + 1},
                        {"row", one.row},
                        {"position_mm", one.position * 1e3},
                        {"rotation_mrad", one.rotation * 1e3},
                        {"spreads", one.factor}});
  Json drift = Json::array();
  for (const SessionDrift& of_station : report.drift) {
    Json knots = Json::array();
    for (Index k = 0; k < of_station.knots.cols(); ++k) {
      const VectorX knot = of_station.knots.col(k) * 1e6;
      Json one{{"time", of_station.begin + of_station.spacing * static_cast<double>(k)},
               {"translation_um", {knot(0), knot(1), knot(2)}},
               {"rotation_urad", {knot(3), knot(4), knot(5)}}};
      if (knot.size() > 6) one["joint_zeros_urad"] = std::vector<double>(knot.begin() + 6, knot.end());
      knots.push_back(std::move(one));
    }
    drift.push_back({{"station", drift.size() + 1}, {"knots", std::move(knots)}});
  }
  Json spectrum = Json::array();
  for (std::size_t j = 0; j < report.joints.size(); ++j) {
    const JointReport& joint = report.joints[j];
    Json orders = Json::array(), amplitudes = Json::array(), stds = Json::array(), lines = Json::array();
    for (const HarmonicEstimate& one : joint.spectrum) {
      orders.push_back(one.order);
      amplitudes.push_back(one.amplitude * 1e6);
      stds.push_back(one.std * 1e6);
    }
    for (const HarmonicEstimate& line : joint.lines)
      lines.push_back({{"order", line.order},
                       {"amplitude_urad", line.amplitude * 1e6},
                       {"margin_urad", line.margin() * 1e6},
                       {"chi_square", line.chi_square},
                       {"cause", cause_of(line.order, joint.drive)}});
    spectrum.push_back({{"joint", j + 1},
                        {"lines", std::move(lines)},
                        {"orders", std::move(orders)},
                        {"amplitudes_urad", std::move(amplitudes)},
                        {"stds_urad", std::move(stds)}});
  }
  const Observability& o = identification.observability;
  const MeanInterval mean = report.held_out_mean();
  return {{"robot", robot},
          {"train_rows", report.train_poses},
          {"test_rows", report.test_poses()},
          {"independent_test_poses", report.independent_poses()},
          {"left_out_blocks_mm", report.block_error > 0 ? Json(report.block_error * 1e3) : Json()},
          {"outliers_kept", report.outliers_kept},
          {"outliers", outliers},
          {"stages", stages_to_json(report.stages)},
          {"chosen", report.chosen.key()},
          {"mean_temperature_c", report.mean_temperature ? Json(*report.mean_temperature) : Json()},
          {"down",
           report.down
               ? Json{{"direction", {report.down->direction(0), report.down->direction(1), report.down->direction(2)}},
                      {"std_mrad", report.down->std * 1e3}}
               : Json()},
          {"payload",
           report.payload ? Json{{"mean_kg", report.payload->mean}, {"estimated", report.payload->estimated}} : Json()},
          {"blocks", blocks},
          {"learners", trials},
          {"prior", report.prior ? Json{{"name", report.prior->name},
                                        {"used", report.prior->used},
                                        {"geometry_kappa", report.prior->geometry},
                                        {"joints_kappa", report.prior->joints}}
                                 : Json()},
          {"parameters", parameters},
          {"identifiability",
           {{"rank", identification.rank},
            {"free", identification.free.size()},
            {"condition", identification.condition},
            {"weak", identification.names(ParameterState::weak)},
            {"strongly_correlated", identification.strongly_correlated()},
            {"observability", {{"O1", o.o1}, {"O2", o.o2}, {"O3", o.o3}, {"O4", o.o4}, {"O5", o.o5}}}}},
          {"spectrum", spectrum},
          {"drift", drift},
          {"gated_rows", report.extrapolated()},
          {"worst_harm_beside_geometry_mm", report.max_degradation * 1e3},
          {"within_95_percent_ellipsoids", report.ellipsoid_coverage},
          {"held_out_mean_mm",
           {{"mean", mean.mean * 1e3},
            {"lower", mean.lower * 1e3},
            {"upper", std::isfinite(mean.upper) ? Json(mean.upper * 1e3) : Json()}}},
          {"verdict", report.verdict()},
          {"details", report.details()}};
}

VERNIER_IMPL nlohmann::ordered_json to_json(const ReregistrationReport& report) {
  const auto values = [](const auto& vector) { return std::vector<double>(vector.begin(), vector.end()); };
  return {{"base_change_m_rad", values(FrameParameters(report.motion.base).values())},
          {"tool_change_m_rad", values(FrameParameters(report.motion.tool).values())},
          {"offsets_rad", values(report.motion.offsets)},
          {"position_sigma_mm", report.position_sigma * 1e3},
          {"orientation_sigma_mrad", report.orientation_sigma * 1e3},
          {"probe",
           {{"turned", report.probe_turned},
            {"by_mrad", values(Vector3(1e3 * report.motion.probe))},
            {"contradiction", report.contradiction}}},
          {"held", report.held},
          {"remarks", report.remarks()}};
}

VERNIER_IMPL std::vector<StageErrors> stages_of(const VerificationReport& report) {
  if (!report.registration) return {{Stage::as_fitted, report.errors, report.rotations}};
  return {{Stage::as_fitted, report.as_fitted, report.rotations_as_fitted},
          {Stage::registered, report.errors, report.rotations}};
}

VERNIER_IMPL nlohmann::ordered_json to_json(const VerificationReport& report, const std::string& robot) {
  using Json = nlohmann::ordered_json;
  Json joints = Json::array();
  for (std::size_t j = 0; j < report.joints.size(); ++j) {
    const JointCheck& joint = report.joints[j];
    joints.push_back({{"joint", j + 1},
                      {"unit", report.joint_types[j] == JointType::revolute ? "mrad" : "mm"},
                      {"determined", joint.determined},
                      {"zero_change", joint.determined ? Json(joint.zero_change * 1e3) : Json()},
                      {"zero_std", joint.determined ? Json(joint.zero_std * 1e3) : Json()},
                      {"zero_p", joint.zero_p},
                      {"once_p", joint.once_p},
                      {"zero_changed", joint.zero_changed},
                      {"transmission_changed", joint.transmission_changed}});
  }
  return {{"robot", robot},
          {"valid", report.valid},
          {"consistent", report.consistent},
          {"verdict", report.verdict()},
          {"poses", report.poses},
          {"poses_left_out", report.known},
          {"stages", stages_to_json(stages_of(report))},
          {"mean_mm", report.mean_error * 1e3},
          {"mean_upper_mm", std::isfinite(report.mean_upper) ? Json(report.mean_upper * 1e3) : Json()},
          {"accept_mm", report.options.accept ? Json(*report.options.accept * 1e3) : Json()},
          {"level", report.options.level},
          {"chi_square", report.chi_square},
          {"dof", report.dof},
          {"p_value", report.p_value},
          {"joints", joints},
          {"aside", report.aside},
          {"registration", report.registration ? to_json(*report.registration) : Json()},
          {"advice", report.advice()}};
}

}  // namespace vernier
