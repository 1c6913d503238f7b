// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vernier/core/argsort.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/error_terms/drive_lines.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/report_functions.hpp"
#include "vernier/io/detail/report_sections.hpp"
#include "vernier/io/detail/svg_chart.hpp"

namespace vernier::detail {

/// What a transmission adds over one measured range, in at most 240 columns: the extremes of each, with the band.
VERNIER_LOCAL void append_function(const JointReport& joint, std::size_t from, std::size_t to, double unit,
                                   ChartSeries& function, ChartSeries& band) {
  const std::size_t count = to - from, columns = std::min<std::size_t>(count, 240);
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t first = from + c * count / columns, last = from + (c + 1) * count / columns;
    double lower = 1e300, upper = -1e300, margin = 0;
    for (std::size_t k = first; k < last; ++k) {
      const auto i = static_cast<Index>(k);
      lower = (std::min)(lower, joint.transmission(i));
      upper = (std::max)(upper, joint.transmission(i));
      margin = (std::max)(margin, 1.96 * joint.transmission_std(i));
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
    const std::string name = message("joint ", j + 1, joint.bracketed_formula());
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
    for (const HarmonicEstimate& one : joint.spectrum) largest = (std::max)(largest, one.amplitude * 1e6);
    ChartSeries sticks{.style = ChartStyle::sticks, .colour = 2};
    for (const HarmonicEstimate& one : joint.spectrum) {
      sticks.x.push_back(one.order);
      sticks.y.push_back((std::max)(one.amplitude * 1e6, 1e-3 * largest));
    }
    HtmlTable lines{.head = {"order", "amplitude [urad]", "+- (95 %)", "chi-square", "probable cause"}};
    for (std::size_t k = 0; k < joint.lines.size() && k < 8; ++k) {
      const HarmonicEstimate& line = joint.lines[k];
      lines.rows.push_back({message(line.order), fixed_digits(line.amplitude * 1e6, 1),
                            fixed_digits(line.margin() * 1e6, 1), fixed_digits(line.chi_square, 0),
                            cause_of(line.order, joint.drive)});
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
    out += paragraph(message("Errors against the time of measuring: Spearman's rank correlation ",
                             fixed_digits(found.rho, 3),
                             found.p_value < 1e-4 ? ", p < 0.0001." : ", p = " + fixed_digits(found.p_value, 4) + "."));
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

}  // namespace vernier::detail
