// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/version.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/report_sections.hpp"
#include "vernier/io/detail/svg_chart.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string paragraph(const std::string& text, const char* kind) {
  return text.empty()
             ? ""
             : message("<p", *kind != 0 ? message(" class=\"", kind, '"') : "", ">", html_escape(text), "</p>\n");
}

VERNIER_IMPL std::string bullets(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += "<li>" + html_escape(text) + "</li>\n";
  return out.empty() ? out : "<ul>\n" + out + "</ul>\n";
}

VERNIER_IMPL std::string section(const std::string& id, const std::string& heading, const std::string& content) {
  if (content.empty()) return "";
  return message("<section id=\"", id, "\"><h2>", html_escape(heading), "</h2>\n", content, "</section>\n");
}

VERNIER_IMPL std::string audit_section(const ReportInput& input) {
  if (!input.audit) return "";
  if (input.audit->empty()) return section("audit", "Data audit", paragraph("Nothing was found."));
  HtmlTable table{.head = {"finding", "rows", "what was seen, what to do"}, .numbers = false};
  for (const ReportFinding& one : *input.audit) table.rows.push_back({one.kind, one.rows, one.message});
  return section("audit", "Data audit", html_table(table));
}

VERNIER_IMPL std::string errors_section(const ReportInput& input) {
  bool oriented = false;
  for (const StageErrors& stage : input.stages) oriented = oriented || stage.rotation.size() > 0;
  HtmlTable table{.caption = message("Position errors of ", input.held_out ? "held-out " : "the checked ", input.what,
                                     " [mm]", oriented ? ", mean orientation errors [mrad]" : ""),
                  .head = {"model", "mean", "rms", "max", "min", "95 %"}};
  if (oriented) table.head.push_back("mean [mrad]");
  Chart chart{.title = "Cumulative distribution of position errors",
              .x_label = "position error [mm]",
              .y_label = "share of " + input.what + " [%]",
              .log_x = true};
  int colour = 0;
  for (const StageErrors& stage : input.stages) {
    const ErrorStatistics e = ErrorStatistics::of(stage.position * 1e3);
    table.rows.push_back({stage.title + (input.held_out && stage.name == input.after ? " (deployed)" : ""),
                          three_digits(e.mean), three_digits(e.rms), three_digits(e.max), three_digits(e.min),
                          three_digits(e.p95)});
    if (oriented)
      table.rows.back().push_back(stage.rotation.size() > 0 ? three_digits(stage.rotation.mean() * 1e3) : "");
    if (stage.name != input.before && stage.name != Stage::geometry && stage.name != input.after) continue;
    ChartSeries series{.title = stage.title, .colour = colour++};
    VectorX sorted = stage.position * 1e3;
    std::sort(sorted.begin(), sorted.end());
    for (int percent = 0; percent <= 100; ++percent) {
      series.x.push_back((std::max)(quantile_of_sorted(sorted, percent / 100.0), 1e-6));
      series.y.push_back(percent);
    }
    chart.series.push_back(std::move(series));
  }
  return section("errors", "Before and after", html_table(table) + chart_svg(chart));
}

VERNIER_IMPL std::string poses_section(const ReportInput& input, const PoseView& view) {
  if (view.shown.empty()) return "";
  std::string out = paragraph(
      message(view.shown.size(), ' ', input.what,
              " in the arm's base frame, coloured by their position error; larger errors are "
              "drawn larger. Colours end at the 99th percentile, the last one stands for all above.",
              static_cast<Index>(view.shown.size()) < input.poses.positions.rows()
                  ? message(" Of all ", input.poses.positions.rows(), ' ', input.what, " these were drawn by lot.")
                  : ""));
  out +=
      "<div id=\"view\" hidden>\n<canvas id=\"canvas\" width=\"640\" height=\"420\" tabindex=\"0\" aria-label=\"poses "
      "in space; arrow keys turn the view\"></canvas>\n<p><button type=\"button\" id=\"show-before\" "
      "aria-pressed=\"false\">before</button> <button type=\"button\" id=\"show-after\" "
      "aria-pressed=\"true\">after</button> <output id=\"picked\"></output></p>\n";
  out += "<div id=\"scale-before\" hidden>" + error_legend(view.before_clip) + "</div>\n<div id=\"scale-after\">" +
         error_legend(view.after_clip) + "</div>\n</div>\n";
  out += pose_projections(input, view) + "<div class=\"plain\">" + error_legend(view.after_clip) + "</div>\n";
  return section("poses", "Errors in space", out);
}

VERNIER_IMPL std::string coverage_section(const ReportInput& input) {
  const VectorX &errors = stage_of(input, input.after).position, &gates = input.poses.gates;
  std::string out;
  if (input.ellipsoid_coverage) {
    const auto n = static_cast<double>(errors.size());
    out += paragraph(message("Within their predicted 95 % ellipsoids: ", std::llround(*input.ellipsoid_coverage * n),
                             " of ", errors.size(), " poses (", fixed_digits(100 * *input.ellipsoid_coverage, 1),
                             " %; by chance 95 +- ", fixed_digits(196 * std::sqrt(0.95 * 0.05 / n), 1), " %)."));
  }
  if (gates.size() > 0) {
    HtmlTable where{.caption = "Position errors inside and outside the range of validity [mm]",
                    .head = {"where", "poses", "mean", "95 %", "max"}};
    for (const bool inside : {true, false}) {
      std::vector<double> some;
      for (Index i = 0; i < gates.size(); ++i)
        if ((gates(i) >= 1) == inside) some.push_back(errors(i) * 1e3);
      if (some.empty()) continue;
      const auto e = ErrorStatistics::of(Eigen::Map<const VectorX>(some.data(), static_cast<Index>(some.size())));
      where.rows.push_back({inside ? "inside" : "outside", message(e.n), three_digits(e.mean), three_digits(e.p95),
                            three_digits(e.max)});
    }
    out += html_table(where);
  }
  HtmlTable ranges{
      .caption = "Measured joint ranges, and the range of validity; outside, functions of the joints fade out",
      .head = {"joint", "unit", "measured ranges", "range of validity"},
      .numbers = false};
  for (std::size_t j = 0; j < input.joints.size(); ++j) {
    const JointReport& joint = input.joints[j];
    const double unit = joint.revolute ? 180 / std::numbers::pi : 1e3;
    const auto text = [&](const std::vector<std::pair<double, double>>& of) {
      std::string out_of;
      for (const auto& [lower, upper] : of)
        out_of +=
            message(out_of.empty() ? "" : ", ", fixed_digits(lower * unit, 1), " .. ", fixed_digits(upper * unit, 1));
      return out_of;
    };
    if (!joint.measured_ranges.empty())
      ranges.rows.push_back({joint.formula.empty() ? message(j + 1) : joint.formula, joint.revolute ? "deg" : "mm",
                             text(joint.measured_ranges), text(joint.valid_ranges)});
  }
  return section("where", "Where it is good", out + html_table(ranges));
}

VERNIER_IMPL std::string parameters_section(const ReportInput& input) {
  HtmlTable table{.caption = "Parameters of frames and chain, geometry identified alone [mm, mrad]",
                  .head = {"parameter", "unit", "nominal", "identified", "change", "standard deviation",
                           "change / expected size", "state", "what absorbs it"}};
  for (const ParameterEstimate& p : input.parameters) {
    const double change = p.identified - p.nominal;
    const bool estimated = p.state == ParameterState::identified || p.state == ParameterState::weak;
    static constexpr const char* states[] = {"fixed", "identified", "weak: held near nominal by its prior",
                                             "not identifiable"};
    table.rows.push_back({p.name, p.kind == ParameterKind::length ? "mm" : "mrad", fixed_digits(p.nominal * 1e3, 4),
                          fixed_digits(p.identified * 1e3, 4), estimated ? fixed_digits(change * 1e3, 4) : "",
                          estimated ? fixed_digits(p.std * 1e3, 4) : "",
                          estimated && p.scale > 0 ? fixed_digits(change / p.scale, 2) : "",
                          states[static_cast<int>(p.state)], p.remark});
  }
  std::string out = html_table(table);
  if (!input.correlated.empty())
    out += paragraph("Pairs that the poses hardly tell apart (correlation):") + bullets(input.correlated);
  return section("parameters", "Parameters", out);
}

VERNIER_IMPL std::string advice_section(const ReportInput& input) {
  return section("next", input.held_out ? "What to measure next" : "What to do", bullets(input.advice));
}

VERNIER_IMPL std::string provenance_section(const ReportInput& input) {
  const ReportProvenance& from = input.provenance;
  std::string compiler = from.compiler;
  if (compiler.empty()) {
#if defined(__clang__)
    compiler = std::string("clang ") + __clang_version__;
#elif defined(__GNUC__)
    compiler = std::string("gcc ") + __VERSION__;
#endif
  }
  HtmlTable table{.head = {"what", "value"}, .numbers = false};
  const auto add = [&](const char* what, const std::string& value) {
    if (!value.empty()) table.rows.push_back({what, value});
  };
  add("command", from.command);
  add("date", from.date);
  add("seed", message(from.seed));
  add("Vernier", from.version.empty()
                     ? message(VERNIER_VERSION_MAJOR, '.', VERNIER_VERSION_MINOR, '.', VERNIER_VERSION_PATCH)
                     : from.version);
  add("compiler", compiler);
  add("Eigen", from.eigen.empty() ? message(EIGEN_WORLD_VERSION, '.', EIGEN_MAJOR_VERSION, '.', EIGEN_MINOR_VERSION)
                                  : from.eigen);
  if (!from.model.empty())
    add("model", from.model + (from.model_sha256.empty() ? "" : ", SHA-256 " + from.model_sha256));
  HtmlTable files{.caption = "Files that were read", .head = {"file", "rows", "SHA-256"}, .numbers = false};
  for (const ReportFile& file : from.inputs) files.rows.push_back({file.name, message(file.rows), file.sha256});
  return section("provenance", "Provenance",
                 html_table(table) + html_table(files) +
                     paragraph("All results are in this page as JSON, in the element "
                               "\"data\" of its source."));
}

}  // namespace vernier::detail
