#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vernier/calibration/detail/wording.hpp"
#include "vernier/core/argsort.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/version.hpp"
#include "vernier/error_terms/drive_lines.hpp"
#include "vernier/evaluation/mean_interval.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/evaluation/statistics.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/report_sections.hpp"
#include "vernier/io/detail/svg_chart.hpp"

namespace vernier::detail {

/// Errors above this many predicted standard deviations are suspect.
inline constexpr double suspect_sigmas = 4;

VERNIER_API std::string paragraph(const std::string& text, const char* kind = "") {
  return text.empty()
             ? ""
             : message("<p", *kind != 0 ? message(" class=\"", kind, '"') : "", ">", html_escape(text), "</p>\n");
}

VERNIER_API std::string bullets(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += "<li>" + html_escape(text) + "</li>\n";
  return out.empty() ? out : "<ul>\n" + out + "</ul>\n";
}

VERNIER_IMPL std::string section(const std::string& id, const std::string& heading, const std::string& content) {
  if (content.empty()) return "";
  return message("<section id=\"", id, "\"><h2>", html_escape(heading), "</h2>\n", content, "</section>\n");
}

VERNIER_IMPL RankCorrelation rank_correlation(const VectorX& a, const VectorX& b) {
  if (a.size() < 3) return {};
  VectorX ra = ranks(a), rb = ranks(b);
  for (VectorX* one : {&ra, &rb}) {
    const double mean = one->mean();
    for (double& rank : *one) rank -= mean;
  }
  const double size = std::sqrt(ra.squaredNorm() * rb.squaredNorm());
  if (!(size > 0)) return {};
  const double rho = ra.dot(rb) / size;
  return {rho, std::erfc(std::abs(rho) * std::sqrt(static_cast<double>(a.size() - 1) / 2))};
}

/// Name of a row of the poses.
VERNIER_API std::string row_name(const ReportPoses& poses, Index i) {
  const auto at = static_cast<std::size_t>(i);
  const std::size_t file = poses.file.empty() ? 0 : static_cast<std::size_t>(poses.file[at]);
  return message(poses.row.empty() ? i : poses.row[at], file < poses.files.size() ? " of " + poses.files[file] : "");
}

/// A suspect row, of those shown or of training.
VERNIER_API std::vector<std::vector<std::string>> suspect_rows(const ReportInput& input) {
  std::vector<std::pair<double, std::vector<std::string>>> all;
  const VectorX& errors = stage_of(input, input.after).position;
  const ReportPoses& poses = input.poses;
  const auto cells = [](const std::string& name, const char* kind, double error, double sigmas,
                        const std::string& why) {
    return std::vector<std::string>{name, kind, fixed(error * 1e3, 3), fixed(sigmas, 1), why};
  };
  for (Index i = 0; i < poses.normalised.size(); ++i)
    if (poses.normalised(i) > suspect_sigmas)
      all.emplace_back(
          poses.normalised(i),
          cells(row_name(poses, i), input.held_out ? "held out" : "checked", errors(i), poses.normalised(i),
                poses.gates.size() > 0 && poses.gates(i) < 1 ? "outside the measured joint ranges" : ""));
  for (const ReportSuspect& one : input.suspects)
    all.emplace_back(one.normalised, cells(one.row, "training", one.error, one.normalised, one.remark));
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::vector<std::string>> out;
  for (auto& one : all) out.push_back(std::move(one.second));
  return out;
}

/// What deserves a look, at most five lines, each with a link.
VERNIER_API std::string look_at(const ReportInput& input) {
  std::vector<std::pair<const char*, std::string>> all;
  if (input.audit && !input.audit->empty())
    all.emplace_back("audit", "The audit of the data has " +
                                  counted(static_cast<long long>(input.audit->size()), "finding.", "findings."));
  if (const auto n = static_cast<long long>(suspect_rows(input).size()); n > 0)
    all.emplace_back("suspects", counted(n, "row is suspect.", "rows are suspect."));
  const auto n = static_cast<double>(stage_of(input, input.after).position.size());
  if (input.ellipsoid_coverage && std::abs(*input.ellipsoid_coverage - 0.95) > 1.96 * std::sqrt(0.95 * 0.05 / n))
    all.emplace_back("where", message("The predicted 95 % ellipsoids contain ", brief(100 * *input.ellipsoid_coverage),
                                      " % of the errors: predicted uncertainties are too ",
                                      *input.ellipsoid_coverage < 0.95 ? "small." : "large."));
  if (const Index outside =
          std::count_if(input.poses.gates.begin(), input.poses.gates.end(), [](double gate) { return gate < 1; });
      outside > 0)
    all.emplace_back("where", counted(outside, "pose lies", "poses lie") + " outside the measured joint ranges.");
  if (std::any_of(input.drift.begin(), input.drift.end(), [](const SessionDrift& d) { return !d.empty(); }))
    all.emplace_back("drift", "Something moved during the session.");
  else if (input.times.size() > 0 &&
           rank_correlation(input.times, stage_of(input, input.after).position).p_value < 0.001)
    all.emplace_back("drift", "The errors depend on when a pose was measured.");
  if (!input.advice.empty()) all.emplace_back("next", "See what to do next.");
  std::string out;
  for (std::size_t k = 0; k < all.size() && k < 5; ++k)
    out += message("<li><a href=\"#", all[k].first, "\">", html_escape(all[k].second), "</a></li>\n");
  return out.empty() ? out : "<p>Look at this:</p>\n<ul>\n" + out + "</ul>\n";
}

VERNIER_IMPL std::string verdict_section(const ReportInput& input) {
  const StageErrors& after = stage_of(input, input.after);
  const ErrorStatistics e = ErrorStatistics::of(after.position * 1e3),
                        was = ErrorStatistics::of(stage_of(input, input.before).position * 1e3);
  const MeanInterval interval = MeanInterval::of(after.position * 1e3);
  std::string decision, kind;
  if (input.accept) {
    const double limit = *input.accept * 1e3;
    kind = interval.upper <= limit ? "yes" : interval.lower > limit ? "no" : "";
    decision = message(" Accepted up to ", brief(limit), " mm: <strong>",
                       kind == "yes"  ? "yes"
                       : kind == "no" ? "no"
                                      : "not decided, the limit lies within the interval",
                       "</strong>.");
  }
  if (input.passed) kind = *input.passed ? "yes" : "no";
  std::string out =
      message("<p class=\"verdict ", kind, "\">", html_escape(input.headline), input.headline.empty() ? "" : " ",
              input.held_out ? "Held-out position error" : "Position error", " <strong data-value=\"", e.mean, "\">",
              brief(e.mean), " mm</strong> (mean; ");
  out += std::isfinite(interval.upper)
             ? message("95 % interval ", brief(interval.lower), " to ", brief(interval.upper), " mm")
             : std::string("too few poses for an interval");
  out += message("), 95 % of the poses within ", brief(e.p95), " mm, largest ", brief(e.max), " mm",
                 input.before == input.after ? "." : message("; before ", brief(was.mean), " mm."), decision, "</p>\n");
  out += paragraph(message("Of ", e.n, input.held_out ? " held-out poses" : " poses",
                           input.rule.empty() ? "" : " (" + input.rule + ")",
                           input.train_poses > 0 ? message(", fitted to ", input.train_poses, " others") : "",
                           ". The interval is that of the mean by Student's t, the poses taken as independent."),
                   "faint");
  out += look_at(input);
  if (!input.sentences.empty())
    out += "<details><summary>In words</summary>\n" + bullets(input.sentences) + "</details>\n";
  return section("verdict", "Verdict", out);
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
  HtmlTable table{.caption = message("Position errors of ", input.held_out ? "held-out" : "the checked", " poses [mm]",
                                     oriented ? ", mean orientation errors [mrad]" : ""),
                  .head = {"model", "mean", "rms", "max", "min", "95 %"}};
  if (oriented) table.head.push_back("mean [mrad]");
  Chart chart{.title = "Cumulative distribution of position errors",
              .x_label = "position error [mm]",
              .y_label = "share of poses [%]",
              .log_x = true};
  int colour = 0;
  for (const StageErrors& stage : input.stages) {
    const ErrorStatistics e = ErrorStatistics::of(stage.position * 1e3);
    table.rows.push_back({stage.title + (input.held_out && stage.key == input.after ? " (deployed)" : ""),
                          fixed(e.mean, 4), fixed(e.rms, 4), fixed(e.max, 4), fixed(e.min, 4), fixed(e.p95, 4)});
    if (oriented) table.rows.back().push_back(stage.rotation.size() > 0 ? fixed(stage.rotation.mean() * 1e3, 4) : "");
    if (stage.key != input.before && stage.key != "geometry" && stage.key != input.after) continue;
    ChartSeries series{.title = stage.title, .colour = colour++};
    VectorX sorted = stage.position * 1e3;
    std::sort(sorted.begin(), sorted.end());
    for (int percent = 0; percent <= 100; ++percent) {
      series.x.push_back(std::max(quantile_of_sorted(sorted, percent / 100.0), 1e-6));
      series.y.push_back(percent);
    }
    chart.series.push_back(std::move(series));
  }
  return section("errors", "Before and after", html_table(table) + chart_svg(chart));
}

VERNIER_IMPL std::string poses_section(const ReportInput& input, const PoseView& view) {
  if (view.shown.empty()) return "";
  std::string out =
      paragraph(message(view.shown.size(),
                        " poses in the arm's base frame, coloured by their position error; larger errors are "
                        "drawn larger. Colours end at the 99th percentile, the last one stands for all above.",
                        static_cast<Index>(view.shown.size()) < input.poses.positions.rows()
                            ? message(" Of all ", input.poses.positions.rows(), " poses these were drawn by lot.")
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
                             " of ", errors.size(), " poses (", fixed(100 * *input.ellipsoid_coverage, 1),
                             " %; by chance 95 +- ", fixed(196 * std::sqrt(0.95 * 0.05 / n), 1), " %)."));
  }
  if (gates.size() > 0) {
    HtmlTable where{.caption = "Position errors inside and outside the measured joint ranges [mm]",
                    .head = {"where", "poses", "mean", "95 %", "max"}};
    for (const bool inside : {true, false}) {
      std::vector<double> some;
      for (Index i = 0; i < gates.size(); ++i)
        if ((gates(i) == 1) == inside) some.push_back(errors(i) * 1e3);
      if (some.empty()) continue;
      const auto e = ErrorStatistics::of(Eigen::Map<const VectorX>(some.data(), static_cast<Index>(some.size())));
      where.rows.push_back(
          {inside ? "inside" : "outside", message(e.n), fixed(e.mean, 4), fixed(e.p95, 4), fixed(e.max, 4)});
    }
    out += html_table(where);
  }
  HtmlTable ranges{.caption = "Measured joint ranges, where the functions of the joints hold; outside they fade out",
                   .head = {"joint", "unit", "measured ranges"},
                   .numbers = false};
  for (std::size_t j = 0; j < input.joints.size(); ++j) {
    const JointReport& joint = input.joints[j];
    const double unit = joint.revolute ? 180 / std::numbers::pi : 1e3;
    std::string text;
    for (const auto& [lower, upper] : joint.measured_ranges)
      text += message(text.empty() ? "" : ", ", fixed(lower * unit, 1), " .. ", fixed(upper * unit, 1));
    if (!text.empty()) ranges.rows.push_back({message(j + 1), joint.revolute ? "deg" : "mm", text});
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
    table.rows.push_back(
        {p.name, p.kind == ParameterKind::length ? "mm" : "mrad", fixed(p.nominal * 1e3, 4),
         fixed(p.identified * 1e3, 4), estimated ? fixed(change * 1e3, 4) : "", estimated ? fixed(p.std * 1e3, 4) : "",
         estimated && p.scale > 0 ? fixed(change / p.scale, 2) : "", states[static_cast<int>(p.state)], p.remark});
  }
  std::string out = html_table(table);
  if (!input.correlated.empty())
    out += paragraph("Pairs that the poses hardly tell apart (correlation):") + bullets(input.correlated);
  return section("parameters", "Parameters", out);
}

/// What a transmission adds over one measured range, in at most 240 columns: the extremes of each, with the band.
VERNIER_API void append_function(const JointReport& joint, std::size_t from, std::size_t to, double unit,
                                 ChartSeries& function, ChartSeries& band) {
  const std::size_t count = to - from, columns = std::min<std::size_t>(count, 240);
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t first = from + c * count / columns, last = from + (c + 1) * count / columns;
    double lower = 1e300, upper = -1e300, margin = 0;
    for (std::size_t k = first; k < last; ++k) {
      const auto i = static_cast<Index>(k);
      lower = std::min(lower, joint.transmission(i));
      upper = std::max(upper, joint.transmission(i));
      margin = std::max(margin, 1.96 * joint.transmission_std(i));
    }
    const double x = (joint.angle[first] + joint.angle[last - 1]) / 2 * unit;
    band.x.push_back(x);
    band.y.push_back((lower - margin) * 1e3);
    band.upper.push_back((upper + margin) * 1e3);
    // up and down in turn: a dense oscillation fills its envelope
    function.x.push_back(x);
    function.y.push_back((c % 2 == 0 ? lower : upper) * 1e3);
    if (last - first < 2) continue;
    function.x.push_back(x);
    function.y.push_back((c % 2 == 0 ? upper : lower) * 1e3);
  }
  for (ChartSeries* series : {&function, &band}) {  // a gap
    series->x.push_back(std::numeric_limits<double>::quiet_NaN());
    series->y.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  band.upper.push_back(std::numeric_limits<double>::quiet_NaN());
}

VERNIER_IMPL std::string joints_section(const ReportInput& input) {
  std::string out;
  for (std::size_t j = 0; j < input.joints.size(); ++j) {
    const JointReport& joint = input.joints[j];
    const std::size_t n = joint.angle.size();
    if (n == 0 || joint.transmission.size() != static_cast<Index>(n) ||
        std::none_of(joint.transmission_std.begin(), joint.transmission_std.end(), [](double std) { return std > 0; }))
      continue;
    const double unit = joint.revolute ? 180 / std::numbers::pi : 1e3;
    ChartSeries function{.title = "function", .colour = 1},
        band{.title = "95 % band", .style = ChartStyle::band, .colour = 1};
    std::size_t from = 0;
    for (std::size_t k = 1; k <= n; ++k) {  // a new range begins where the step is no longer that of this one
      const bool ends = k == n || (k > from + 1 && joint.angle[k] - joint.angle[k - 1] >
                                                       1.5 * (joint.angle[from + 1] - joint.angle[from]));
      if (!ends) continue;
      append_function(joint, from, k, unit, function, band);
      from = k;
    }
    const std::string name = message("joint ", j + 1);
    Chart over_angle{.title = message("Function of ", name),
                     .x_label = name + (joint.revolute ? " [deg]" : " [mm]"),
                     .y_label = "joint error [mrad]",
                     .series = {band, function},
                     .height = 250};
    Chart spectrum{.title = message("Spectrum of ", name),
                   .x_label = "periods a turn",
                   .y_label = "amplitude [urad]",
                   .log_x = true,
                   .log_y = true,
                   .height = 250};
    double largest = 0;
    for (const HarmonicEstimate& one : joint.spectrum) largest = std::max(largest, one.amplitude * 1e6);
    ChartSeries sticks{.style = ChartStyle::sticks, .colour = 2};
    for (const HarmonicEstimate& one : joint.spectrum) {
      sticks.x.push_back(one.order);
      sticks.y.push_back(std::max(one.amplitude * 1e6, 1e-3 * largest));
    }
    HtmlTable lines{.head = {"order", "amplitude [urad]", "+- (95 %)", "chi-square", "probable cause"}};
    for (std::size_t k = 0; k < joint.lines.size() && k < 8; ++k) {
      const HarmonicEstimate& line = joint.lines[k];
      lines.rows.push_back({message(line.order), fixed(line.amplitude * 1e6, 1), fixed(line.margin() * 1e6, 1),
                            fixed(line.chi_square, 0), cause_of(line.order, joint.drive)});
      if (k < 3)
        spectrum.labels.push_back({static_cast<double>(line.order), line.amplitude * 1e6, message(line.order)});
    }
    spectrum.series.push_back(std::move(sticks));
    out += "<h3>Joint " + message(j + 1) + "</h3>\n<div class=\"pair\">" + chart_svg(over_angle) +
           (joint.spectrum.empty() ? "" : chart_svg(spectrum)) + "</div>\n" + html_table(lines);
  }
  if (!out.empty())
    out = paragraph(
              "What the transmission of each joint adds over its measured ranges, mean subtracted, and the "
              "amplitude of each order by the measurements alone. Named orders exceed noise.") +
          out;
  return section("joints", "Functions of the joints", out);
}

VERNIER_IMPL std::string suspects_section(const ReportInput& input) {
  constexpr std::size_t most = 25;
  if (input.poses.normalised.size() == 0 && input.left_out == 0) return "";
  HtmlTable table{.head = {"row", "", "error [mm]", "in standard deviations", "remark"}, .rows = suspect_rows(input)};
  const std::size_t n = table.rows.size();
  std::string out = paragraph(message(
      "Rows whose error exceeds ", suspect_sigmas, " standard deviations",
      input.poses.normalised.size() > 0 ? ": of the predicted ellipsoid, which chance exceeds in one row of 900" : "",
      input.left_out > 0
          ? message("; of ", input.left_out, " training rows that were left out in turn, of their spread")
          : "",
      ". Rows are counted from 0, the first behind the header."));
  if (n == 0) return section("suspects", "Suspect rows", out + paragraph("There are none."));
  if (n > most) table.rows.resize(most);
  out += html_table(table);
  if (n > most) out += paragraph(message("And ", n - most, " more."));
  return section("suspects", "Suspect rows", out);
}

VERNIER_IMPL std::string drift_section(const ReportInput& input) {
  std::string out;
  for (std::size_t s = 0; s < input.drift.size(); ++s) {
    const SessionDrift& drift = input.drift[s];
    if (drift.empty()) continue;
    static constexpr const char* names[] = {"x", "y", "z"};
    for (const int part : {0, 3}) {
      const std::string of = input.drift.size() > 1 ? message(" of station ", s + 1) : "";
      Chart chart{.title = (part == 0 ? "Translation" : "Rotation") + message(" of the base", of),
                  .x_label = "row, or time_s",
                  .y_label = part == 0 ? "base moved by [um]" : "base turned by [urad]",
                  .height = 250};
      for (int k = 0; k < 3; ++k) {
        ChartSeries series{.title = names[k] + of, .colour = k + 1};
        for (Index i = 0; i < drift.knots.cols(); ++i) {
          series.x.push_back(drift.begin + drift.spacing * static_cast<double>(i));
          series.y.push_back(drift.knots(part + k, i) * 1e6);
        }
        chart.series.push_back(std::move(series));
      }
      out += chart_svg(chart);
    }
  }
  const VectorX& errors = stage_of(input, input.after).position;
  if (input.times.size() == errors.size() && errors.size() >= 20) {
    const RankCorrelation found = rank_correlation(input.times, errors);
    out += paragraph(message("Errors against the time of measuring: Spearman's rank correlation ", fixed(found.rho, 3),
                             found.p_value < 1e-4 ? ", p < 0.0001." : ", p = " + fixed(found.p_value, 4) + "."));
    const std::vector<Index> order = argsort(input.times);
    const Index n = errors.size(), groups = std::min<Index>(20, n / 10);
    ChartSeries median{.title = "median", .colour = 1}, p95{.title = "95 %", .colour = 2};
    for (Index g = 0; g < groups; ++g) {
      const Index first = g * n / groups, count = (g + 1) * n / groups - first;
      VectorX some(count);
      double time = 0;
      for (Index k = 0; k < count; ++k) {
        const Index i = order[static_cast<std::size_t>(first + k)];
        some(k) = errors(i) * 1e3;
        time += input.times(i) / static_cast<double>(count);
      }
      const ErrorStatistics e = ErrorStatistics::of(some);
      median.x.push_back(time);
      median.y.push_back(e.median);
      p95.x.push_back(time);
      p95.y.push_back(e.p95);
    }
    if (groups >= 2)
      out += chart_svg({.title = "Errors in the order of measuring",
                        .x_label = message("row, or time_s; groups of ", n / groups, " poses"),
                        .y_label = "position error [mm]",
                        .series = {median, p95},
                        .height = 250});
  }
  return section("drift", "Drift", out);
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
