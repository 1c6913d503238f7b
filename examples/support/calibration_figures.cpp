// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "figures.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace support {

namespace {

using vernier::ErrorStatistics;
using vernier::StageErrors;

std::vector<double> scaled(const auto& values, double by) {
  std::vector<double> out(values.begin(), values.end());
  for (double& v : out) v *= by;
  return out;
}

/// Stages that figures of poses show, each in a colour of its own throughout: before, geometry alone, joint-wise, and
/// what is deployed.
std::vector<std::pair<const StageErrors*, int>> shown_stages(const vernier::CalibrationReport& report) {
  std::vector<std::pair<const StageErrors*, int>> out;
  for (const StageErrors& stage : report.stages) {
    const int colour = stage.name == vernier::Stage::frames      ? 0
                       : stage.name == vernier::Stage::geometry  ? 1
                       : stage.name == vernier::Stage::jointwise ? 2
                       : stage.name == report.chosen             ? 5
                                                                 : -1;
    if (colour >= 0) out.emplace_back(&stage, colour);
  }
  return out;
}

void draw_stages(const std::filesystem::path& folder, const std::string& robot,
                 const vernier::CalibrationReport& report) {
  std::vector<std::string> titles;
  Series mean{"mean", {}, {}, Style::points, 2}, p95{"95 %", {}, {}, Style::points, 1};
  for (const StageErrors& stage : report.stages) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    titles.push_back(stage.title);
    mean.y.push_back(e.mean);
    p95.y.push_back(e.p95);
  }
  dots_svg(folder / "stages.svg", robot + ": held-out position error after each stage", "position error [mm]", titles,
           {mean, p95});
  std::vector<Sample> samples;
  for (const auto& [stage, colour] : shown_stages(report))
    samples.push_back({colour == 0 ? "as designed" : stage->title, scaled(stage->position, 1e3), colour});
  std::vector<Panel> poses;
  const Sample& before = samples.front();
  std::vector<std::size_t> order(before.values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return before.values[a] < before.values[b]; });
  const auto sorted = [&](const Sample& sample, const char* name, Style style, int colour) {
    Series out{name, {}, {}, style, colour};
    for (std::size_t i = 0; i < order.size(); ++i) {
      out.x.push_back(static_cast<double>(i + 1));
      out.y.push_back(sample.values[order[i]]);
    }
    return out;
  };
  for (std::size_t k = 1; k < samples.size(); ++k)
    poses.push_back(
        {samples[k].name,
         {sorted(samples[k], "this stage", Style::points, 5), sorted(before, "as designed", Style::lines, 0)}});
  plot_svg(folder / "distribution.svg", robot + ": distribution of held-out errors", "position error [mm]",
           "share of poses [%]", cumulative(samples), {.log_x = true});
  if (!poses.empty())
    panels_svg(folder / "poses.svg", robot + ": each held-out pose after each stage",
               "held-out pose, in order of its error as designed", "position error [mm]", poses, {.log_y = true});
}

}  // namespace

namespace {

void draw_drift(const std::filesystem::path& folder, const std::string& robot,
                const std::vector<vernier::SessionDrift>& drift) {
  for (std::size_t s = 0; s < drift.size(); ++s) {
    if (drift[s].empty()) continue;
    const std::string of = drift.size() > 1 ? fmt::format(" of station {}", s + 1) : "";
    const char* names[] = {"x", "y", "z"};
    Panel moved{"", {}, "shift [um]"}, turned{"", {}, "rotation [urad]"};
    for (vernier::Index c = 0; c < 6; ++c) {
      Series one{names[c % 3], {}, {}, Style::lines, std::array{0, 4, 2}[static_cast<std::size_t>(c % 3)]};
      for (vernier::Index k = 0; k < drift[s].knots.cols(); ++k) {
        one.x.push_back(drift[s].begin + drift[s].spacing * static_cast<double>(k));
        one.y.push_back(drift[s].knots(c, k) * 1e6);
      }
      (c < 3 ? moved : turned).series.push_back(std::move(one));
    }
    panels_svg(folder / (drift.size() > 1 ? fmt::format("drift_{}.svg", s + 1) : std::string("drift.svg")),
               fmt::format("{}: drift of the base{} during the session", robot, of), "time [s], or row without times",
               "", {moved, turned});
  }
}

}  // namespace

void draw_calibration(const std::filesystem::path& folder, const std::string& robot,
                      const vernier::CalibrationReport& report) {
  draw_stages(folder, robot, report);
  draw_drift(folder, robot, report.drift);
  std::vector<Series> ranges;
  vernier::Index trials = 0;
  for (const vernier::JointReport& joint : report.joints) trials += static_cast<vernier::Index>(joint.spectrum.size());
  for (std::size_t j = 0; j < report.joints.size(); ++j) {
    const vernier::JointReport& joint = report.joints[j];
    const double unit = joint.revolute ? 180 / std::numbers::pi : 1e3;
    const std::string name = fmt::format("joint {}", j + 1), x_label = name + (joint.revolute ? " [deg]" : " [mm]");
    const std::vector<double> held_out = scaled(joint.held_out, unit), angle = scaled(joint.angle, unit);
    std::vector<Series> errors;
    for (const auto& [stage, colour] : shown_stages(report))
      if (colour == 1 || stage->name == report.chosen)
        errors.push_back({stage->title, held_out, scaled(stage->position, 1e3), Style::points, colour});
    plot_svg(folder / fmt::format("errors_along_joint_{}.svg", j + 1),
             fmt::format("{}: held-out errors along {}", robot, name), x_label, "position error [mm]", errors,
             {.log_y = true});
    const vernier::VectorX margin = 1.96 * joint.transmission_std;
    if ((margin.array() > 0).any())
      plot_svg(folder / fmt::format("transmission_{}.svg", j + 1),
               fmt::format("{}: error function of {}, mean subtracted", robot, name), x_label, "joint error [mrad]",
               {{"joint error", angle, scaled(joint.transmission, 1e3), Style::lines, 5},
                {"95 % band", angle, scaled(vernier::VectorX(joint.transmission + margin), 1e3), Style::dashed, 2},
                {"", angle, scaled(vernier::VectorX(joint.transmission - margin), 1e3), Style::dashed, 2}});
    if (!joint.spectrum.empty()) {
      Series amplitude{"amplitude", {}, {}, Style::points, 5}, limit{"above noise", {}, {}, Style::dashed, 0};
      for (const vernier::HarmonicEstimate& one : joint.spectrum) {
        amplitude.x.push_back(one.order);
        amplitude.y.push_back(one.amplitude * 1e6);
        limit.y.push_back(one.std * 1e6 * std::sqrt(vernier::line_threshold(trials)));
      }
      limit.x = amplitude.x;
      plot_svg(folder / fmt::format("spectrum_{}.svg", j + 1), fmt::format("{}: errors of {} by order", robot, name),
               "order [periods per turn]", "amplitude [urad]", {amplitude, limit}, {.log_x = true, .log_y = true});
    }
    const double row = static_cast<double>(j + 1);
    for (std::size_t k = 0; k < joint.measured_ranges.size(); ++k)
      ranges.push_back({"",
                        {joint.measured_ranges[k].first * unit, joint.measured_ranges[k].second * unit},
                        {row, row},
                        Style::lines,
                        5});
  }
  plot_svg(folder / "joint_ranges.svg", robot + ": measured joint ranges", "joint value [deg, mm]", "joint", ranges,
           {.y_range = std::pair{0.0, static_cast<double>(report.joints.size() + 1)}});
}

}  // namespace support
