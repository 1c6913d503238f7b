// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/pose_view.hpp"
#include "vernier/io/detail/report_functions.hpp"
#include "vernier/io/detail/report_page.hpp"
#include "vernier/io/detail/report_sections.hpp"
#include "vernier/io/detail/report_verdict.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/io/report_json.hpp"

namespace vernier {

VERNIER_IMPL ReportInput report_input(const CalibrationReport& report, const std::string& robot,
                                      const std::vector<std::string>& train_rows) {
  ReportInput out;
  out.robot = robot;
  out.stages = report.stages;
  out.after = report.chosen;
  out.train_poses = report.train_poses;
  out.headline = report.few_poses();
  out.sentences = report.verdict();
  const std::vector<std::string> details = report.details();
  out.sentences.insert(out.sentences.end(), details.begin(), details.end());
  out.ellipsoid_coverage = report.ellipsoid_coverage;
  out.poses.visited = report.held_out_poses;
  out.poses.normalised = report.normalised_errors;
  out.poses.gates = report.gates;
  out.joints = report.joints;
  out.parameters = report.identification.parameters;
  out.correlated = report.identification.strongly_correlated();
  out.drift = report.drift;
  out.advice = report.next();
  out.left_out = report.left_out_errors.size();
  if (out.left_out > 0) {
    const double sigma = quantile(report.left_out_errors, 0.5) / median_norm;
    for (Index k = 0; k < out.left_out; ++k) {
      if (!(report.left_out_errors(k) > 4 * sigma)) continue;
      const auto row = static_cast<std::size_t>(report.left_out_rows[static_cast<std::size_t>(k)]);
      out.suspects.push_back({row < train_rows.size() ? train_rows[row] : message(row, " of those learned from"),
                              report.left_out_errors(k), report.left_out_errors(k) / sigma});
    }
  }
  out.results = to_json(report, robot).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  return out;
}

VERNIER_IMPL ReportInput report_input(const VerificationReport& report, const std::string& robot) {
  using detail::brief;
  ReportInput out;
  out.robot = robot;
  out.title = "Check of a calibration";
  out.headline = report.verdict();
  out.stages = stages_of(report);
  out.before = out.stages.front().name;
  out.after = out.stages.back().name;
  out.held_out = false;
  if (report.registration) out.rule = "the frames registered from the same poses";
  out.passed = report.valid;
  out.poses.normalised = report.normalised;
  const auto within = std::count_if(report.normalised.begin(), report.normalised.end(),
                                    [](double error) { return error <= std::sqrt(chi_square_95); });
  out.ellipsoid_coverage = static_cast<double>(within) / static_cast<double>(report.normalised.size());
  ReportTable joints{"Joint by joint",
                     message("Changes of zero and of transmission once a turn, each joint looked at alone; p is the "
                             "probability of a change as large by chance. A change is named at the level of ",
                             brief(100 * report.options.level), " % for all tests together."),
                     {"joint", "zero moved by", "+- (95 %)", "unit", "p", "p once a turn", "verdict"},
                     {}};
  for (std::size_t j = 0; j < report.joints.size(); ++j) {
    const JointCheck& joint = report.joints[j];
    joints.rows.push_back({report.joint_name(j),
                           joint.determined ? detail::fixed_digits(joint.zero_change * 1e3, 4) : "",
                           joint.determined ? detail::fixed_digits(1.96 * joint.zero_std * 1e3, 4) : "",
                           report.joint_types[j] == JointType::revolute ? "mrad" : "mm",
                           joint.determined ? brief(joint.zero_p) : "", brief(joint.once_p),
                           joint.zero_changed           ? "zero changed"
                           : joint.transmission_changed ? "transmission changed"
                           : joint.determined           ? "as calibrated"
                                                        : "not determined"});
  }
  out.tables.push_back(std::move(joints));
  if (report.registration) {
    ReportTable frames{"Registration", "How the arm stands now against the calibration.", {"what", ""}, {}};
    std::string text = report.registration->summary();
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = (std::min)(text.find('\n', at), text.size());
      frames.rows.push_back({text.substr(at, end - at), ""});
      at = end + 1;
    }
    out.tables.push_back(std::move(frames));
  }
  out.advice = report.advice();
  out.results = to_json(report, robot).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  return out;
}

VERNIER_IMPL std::string report_html(const ReportInput& input) {
  using namespace detail;
  const Index n = stage_of(input, input.after).position.size(), m = input.poses.positions.rows();
  for (const StageErrors& stage : input.stages)
    demand(stage.position.size() == n && (stage.rotation.size() == 0 || stage.rotation.size() == n),
           "report_html: stage '", stage.key(), "' has ", stage.position.size(), " errors, expected ", n);
  demand(m == 0 || m == n, "report_html: ", m, " poses for ", n, " errors");
  const auto fits = [&](const char* what, auto size) {
    demand(size == 0 || static_cast<Index>(size) == n, "report_html: ", size, ' ', what, " of ", n, " poses");
  };
  fits("rows of joints", input.poses.joints.rows());
  fits("files", input.poses.file.size());
  fits("lines", input.poses.line.size());
  fits("normalised errors", input.poses.normalised.size());
  fits("gates", input.poses.gates.size());
  fits("times", input.times.size());
  demand(input.joints.empty() || input.poses.joints.cols() == 0 ||
             static_cast<Index>(input.joints.size()) == input.poses.joints.cols(),
         "report_html: ", input.joints.size(), " joints, poses have ", input.poses.joints.cols());

  const PoseView view = pose_view(input);
  std::string tables;
  for (std::size_t k = 0; k < input.tables.size(); ++k) {
    const ReportTable& table = input.tables[k];
    tables += section(message("table-", k + 1), table.title,
                      (table.note.empty() ? "" : "<p>" + html_escape(table.note) + "</p>\n") +
                          html_table({.head = table.head, .rows = table.rows}));
  }
  const std::string sections[] = {
      verdict_section(input),     audit_section(input),    errors_section(input),     tables,
      poses_section(input, view), coverage_section(input), parameters_section(input), joints_section(input),
      suspects_section(input),    drift_section(input),    advice_section(input),     provenance_section(input)};
  static constexpr const char* names[][2] = {{"verdict", "Verdict"},
                                             {"audit", "Data audit"},
                                             {"errors", "Before and after"},
                                             {"", ""},
                                             {"poses", "Errors in space"},
                                             {"where", "Where it is good"},
                                             {"parameters", "Parameters"},
                                             {"joints", "Joints"},
                                             {"suspects", "Suspect rows"},
                                             {"drift", "Drift"},
                                             {"next", "Next"},
                                             {"provenance", "Provenance"}};
  const auto hash = [](std::string_view text) { return "'sha256-" + base64_of_hex(sha256(text)) + "'"; };
  const std::string name = html_escape(input.title) + ": " + html_escape(input.robot);
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  out += "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src " + hash(report_style) +
         "; script-src " + hash(report_script) + "; base-uri 'none'; form-action 'none'\">\n";
  out +=
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" + name + "</title>\n<style>";
  out += report_style;
  out += "</style>\n</head>\n<body>\n<header><h1>" + name + "</h1></header>\n<nav aria-label=\"sections\">";
  for (std::size_t k = 0; k < std::size(sections); ++k)
    if (*names[k][0] != 0 && !sections[k].empty())
      out += message("<a href=\"#", names[k][0], "\">", names[k][1], "</a> ");
  out += "</nav>\n<main>\n";
  for (const std::string& one : sections) out += one;
  out += "</main>\n";
  if (!view.shown.empty())
    out += "<script type=\"application/json\" id=\"points\">" + script_escape(poses_json(input, view)) + "</script>\n";
  out += "<script type=\"application/json\" id=\"data\">" +
         script_escape(input.results.empty() ? std::string("{}") : input.results) + "</script>\n<script>";
  out += report_script;
  return out + "</script>\n</body>\n</html>\n";
}

}  // namespace vernier
