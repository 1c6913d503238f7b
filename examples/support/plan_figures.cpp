// SPDX-License-Identifier: BSD-3-Clause
#include "plan_figures.hpp"

#include <fmt/format.h>

#include <numbers>
#include <tuple>

#include "figures.hpp"

namespace support {

namespace {

/// From rad to degrees, or from m to mm.
double unit_of(const PlanOutcome& found, int joint) {
  return found.types[static_cast<std::size_t>(joint)] == vernier::JointType::revolute ? 180 / std::numbers::pi : 1e3;
}

}  // namespace

std::string gaps_of(const PlanOutcome& found, int joint) {
  std::string out;
  double upper = 0;
  int gaps = 0;
  constexpr int most = 4;
  const auto close = [&] {
    if (gaps > 0 && gaps <= most) out += fmt::format("{:.0f}", upper);
  };
  for (const vernier::UncoveredBin& bin : found.plan.uncovered) {
    if (bin.joint != joint) continue;
    const double lower = bin.range.lower * unit_of(found, joint);
    if (gaps == 0 || lower - upper > 1e-6) {
      close();
      ++gaps;
      if (gaps <= most) out += fmt::format("{}{:.0f}..", gaps > 1 ? ", " : "", lower);
    }
    upper = bin.range.upper * unit_of(found, joint);
  }
  close();
  if (gaps == 0) return {};
  out += found.types[static_cast<std::size_t>(joint)] == vernier::JointType::revolute ? " deg" : " mm";
  return gaps > most ? fmt::format("{} and {} more range{}", out, gaps - most, gaps - most == 1 ? "" : "s") : out;
}

std::string draw_plan(const std::filesystem::path& out, const PlanOutcome& found) {
  const auto named = [&](const char* what) { return out.parent_path() / (out.stem().string() + "_" + what + ".svg"); };
  Series possible{"candidates", {}, {}, Style::points, 6}, chosen{"chosen", {}, {}, Style::points, 5};
  const vernier::Index stride = std::max<vernier::Index>(1, found.candidates.rows() / 600);
  const auto add = [&](Series& to, const vernier::MatrixX& joints, vernier::Index step, double shift) {
    for (vernier::Index i = 0; i < joints.rows(); i += step)
      for (int j = 0; j < joints.cols(); ++j) {
        to.x.push_back(joints(i, j) * unit_of(found, j));
        to.y.push_back(j + 1 + shift);
      }
  };
  add(possible, found.candidates, stride, -0.12);
  add(chosen, found.joints, 1, 0.12);
  if (!plot_svg(named("joints"), "Joint values of the plan", "joint value [deg, mm]", "joint", {possible, chosen},
                {.y_range = {{0.4, static_cast<double>(found.joints.cols()) + 0.9}}}))
    return {};
  Series error{"", {}, {}};
  const vernier::VectorX predicted = found.predicted_errors();
  const bool known = predicted.size() > 0;
  for (vernier::Index k = known ? 0 : 3; k < found.plan.relative_error.size(); ++k) {
    error.x.push_back(static_cast<double>(found.measured + k));
    error.y.push_back(known ? 1e3 * predicted(k) : found.plan.relative_error(k));
  }
  plot_svg(named("error"),
           known ? "Expected error: of poses left out now, reduced as predicted"
                 : "Predicted error, relative to that of all planned poses",
           "number of poses", known ? "rms position error [mm]" : "relative error [-]", {error}, {.log_y = true});
  const auto view = [&](const char* name, const char* title, int up, const char* label) {
    for (auto [series, points, step] :
         {std::tuple(&possible, &found.reachable, stride), std::tuple(&chosen, &found.points, vernier::Index{1})}) {
      series->x.clear();
      series->y.clear();
      for (vernier::Index i = 0; i < points->rows(); i += step) {
        series->x.push_back((*points)(i, 0) * 1e3);
        series->y.push_back((*points)(i, up) * 1e3);
      }
    }
    plot_svg(named(name), title, "x [mm]", label, {possible, chosen}, {.width = 640, .height = 600});
  };
  view("top", "Tool points from above", 1, "y [mm]");
  view("side", "Tool points from the side", 2, "z [mm]");
  return out.stem().string() + "_{joints,error,top,side}.svg";
}

}  // namespace support
