// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/pose_view.hpp"

namespace vernier::detail {

VERNIER_IMPL const StageErrors& stage_of(const ReportInput& input, const StageName& name) {
  for (const StageErrors& stage : input.stages)
    if (stage.name == name) return stage;
  throw std::invalid_argument(message("report_html: there is no stage '", name.key(), "'"));
}

VERNIER_IMPL PoseView pose_view(const ReportInput& input) {
  constexpr Index most = 5000;
  PoseView out;
  out.before = stage_of(input, input.before).position;
  out.after = stage_of(input, input.after).position;
  out.before_clip = quantile(out.before, 0.99);
  out.after_clip = quantile(out.after, 0.99);
  const Index n = input.poses.positions.rows();
  out.shown.resize(static_cast<std::size_t>(n));
  std::iota(out.shown.begin(), out.shown.end(), Index{0});
  if (n > most) {  // those of the smallest hash: no pattern in the rows is picked out
    const auto hash = [](Index row) {
      std::uint64_t x = static_cast<std::uint64_t>(row) + 0x9e3779b97f4a7c15u;
      x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
      x = (x ^ x >> 27) * 0x94d049bb133111ebu;
      return x ^ x >> 31;
    };
    std::sort(out.shown.begin(), out.shown.end(), [&](Index a, Index b) { return hash(a) < hash(b); });
    out.shown.resize(most);
    std::sort(out.shown.begin(), out.shown.end());
  }
  return out;
}

VERNIER_IMPL std::size_t error_class(double error, double clip) {
  const double share = clip > 0 ? error / clip : 0;
  return static_cast<std::size_t>(std::clamp(std::floor(8 * share), 0.0, 7.0));
}

/// Middle of the poses shown, and half the largest extent around it [m].
struct PoseBounds {
  Vector3 centre = Vector3::Zero();
  double half = 1e-3;
};
VERNIER_LOCAL PoseBounds pose_bounds(const ReportInput& input, const PoseView& view) {
  if (view.shown.empty()) return {};
  PoseBounds out;
  for (Index c = 0; c < 3; ++c) {
    double lower = input.poses.positions(view.shown.front(), c), upper = lower;
    for (const Index i : view.shown) {
      lower = (std::min)(lower, input.poses.positions(i, c));
      upper = (std::max)(upper, input.poses.positions(i, c));
    }
    out.centre(c) = (lower + upper) / 2;
    out.half = (std::max)(out.half, (upper - lower) / 2);
  }
  return out;
}

VERNIER_IMPL std::string poses_json(const ReportInput& input, const PoseView& view) {
  const ReportPoses& poses = input.poses;
  const Index joints = poses.joints.cols();
  const PoseBounds bounds = pose_bounds(input, view);
  const auto list = [&](const auto& append) {
    std::string out = "[";
    for (const Index i : view.shown) append(out, i);
    if (out.size() > 1) out.pop_back();
    return out + "]";
  };
  const auto whole = [](std::string& out, double value) {
    out += std::to_string(std::isfinite(value) ? std::llround(std::clamp(value, -1e15, 1e15)) : 0);
    out += ',';
  };
  const auto errors = [&](const VectorX& values) {
    return list([&](std::string& out, Index i) { whole(out, values(i) * 1e6); });
  };
  std::string units, files, colours;
  for (Index j = 0; j < joints; ++j)
    units += input.joints.empty() || input.joints[static_cast<std::size_t>(j)].revolute ? "\"deg\"," : "\"mm\",";
  if (!units.empty()) units.pop_back();
  for (std::size_t k = 0; k < poses.files.size() || k == 0; ++k) {
    if (k > 0) files += ',';
    files += nlohmann::json(k < poses.files.size() ? poses.files[k] : std::string())
                 .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  for (const char* colour : error_colours) colours += message(colours.empty() ? "\"" : ",\"", colour, "\"");
  const auto unit = [&](Index j) {
    return input.joints.empty() || input.joints[static_cast<std::size_t>(j)].revolute ? 180 / std::numbers::pi : 1e3;
  };
  return message("{\"centre\":[", std::llround(bounds.centre.x() * 1e3), ',', std::llround(bounds.centre.y() * 1e3),
                 ',', std::llround(bounds.centre.z() * 1e3), "],\"half\":", std::llround(bounds.half * 1e3),
                 ",\"units\":[", units, "],\"files\":[", files, "],\"colours\":[", colours,
                 "],\n\"clip\":{\"before\":", fixed_digits(view.before_clip * 1e6, 3),
                 ",\"after\":", fixed_digits(view.after_clip * 1e6, 3),
                 "},\n\"file\":", poses.file.empty() ? "[]" : list([&](std::string& out, Index i) {
                   whole(out, poses.file[static_cast<std::size_t>(i)]);
                 }),
                 ",\n\"line\":", list([&](std::string& out, Index i) {
                   whole(out, static_cast<double>(poses.line.empty() ? i : poses.line[static_cast<std::size_t>(i)]));
                 }),
                 ",\n\"xyz\":", list([&](std::string& out, Index i) {
                   for (Index k = 0; k < 3; ++k) whole(out, poses.positions(i, k) * 1e3);
                 }),
                 ",\n\"before\":", errors(view.before), ",\n\"after\":", errors(view.after),
                 ",\n\"joints\":", list([&](std::string& out, Index i) {
                   for (Index j = 0; j < joints; ++j) whole(out, poses.joints(i, j) * unit(j) * 100);
                 }),
                 "}");
}

VERNIER_IMPL std::string pose_projections(const ReportInput& input, const PoseView& view) {
  const PoseBounds bounds = pose_bounds(input, view);
  constexpr double size = 1000, middle = size / 2, room = 430;
  struct Axes {
    int right, up;
    const char *right_name, *up_name, *title;
  };
  static constexpr Axes all[] = {
      {0, 1, "x", "y", "from above"}, {0, 2, "x", "z", "from the front"}, {1, 2, "y", "z", "from the side"}};
  const double round = std::pow(10, std::floor(std::log10(bounds.half)));  // the scale bar, at most half the width
  std::string out = "<div class=\"three\" id=\"flat\">\n";
  for (const Axes& axes : all) {
    std::array<std::string, 8> paths;
    for (const Index i : view.shown) {
      const Vector3 arm = point(input.poses.positions, i) - bounds.centre, p = arm * (room / bounds.half);
      std::string& path = paths[error_class(view.after(i), view.after_clip)];
      path += message('M', std::llround(middle + p(axes.right)), ' ', std::llround(middle - p(axes.up)), "h0");
    }
    out += message("<svg class=\"flat\" viewBox=\"0 0 1000 1060\" role=\"img\" aria-label=\"poses ", axes.title,
                   "\"><text class=\"big\" x=\"12\" y=\"36\">", axes.up_name, " up, ", axes.right_name,
                   " to the right</text>\n");
    for (std::size_t c = 0; c < paths.size(); ++c)
      if (!paths[c].empty())
        out += message("<path fill=\"none\" stroke-linecap=\"round\" stroke=\"", error_colours[c], "\" stroke-width=\"",
                       12 + 2 * c, "\" d=\"", paths[c], "\"/>\n");
    out += message("<path class=\"bar\" stroke-width=\"6\" d=\"M20 1000h", std::llround(round / bounds.half * room),
                   "\"/><text class=\"big\" x=\"20\" y=\"1045\">", brief(round * 1e3), " mm</text></svg>\n");
  }
  return out + "</div>\n";
}

VERNIER_IMPL std::string error_legend(double clip) {
  std::string out = "<svg class=\"legend\" viewBox=\"0 0 680 44\" role=\"img\" aria-label=\"colours of errors\">\n";
  for (std::size_t c = 0; c < error_colours.size(); ++c) {
    const long long x = 12 + 78 * static_cast<long long>(c);
    out += message("<circle cx=\"", x, "\" cy=\"14\" r=\"", 4 + c / 2, "\" fill=\"", error_colours[c],
                   "\"/><text class=\"tick\" x=\"", x + 12, "\" y=\"18\">",
                   c + 1 < error_colours.size() ? "to " : "above ",
                   brief(clip * 1e3 * static_cast<double>(c + 1 < error_colours.size() ? c + 1 : c) / 8), "</text>\n");
  }
  return out + "<text class=\"tick\" x=\"8\" y=\"40\">position error [mm]</text></svg>\n";
}

}  // namespace vernier::detail
