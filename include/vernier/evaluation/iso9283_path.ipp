// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/evaluation/iso9283_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/detail/iso9283_visits.hpp"
#include "vernier/evaluation/iso9283.hpp"

namespace vernier {

namespace detail {

/// Poses over the length of arc.
struct PoseLine {
  std::vector<double> arc;  ///< ascending
  std::vector<Isometry3> poses;

  /// Where `at` is reached first.
  VERNIER_LOCAL Isometry3 pose(double at, bool oriented) const {
    const auto next = std::find_if(arc.begin() + 1, arc.end() - 1, [&](double s) { return s >= at; });
    const auto k = static_cast<std::size_t>(next - arc.begin());
    const double step = arc[k] - arc[k - 1];
    const Isometry3 out = interpolated(poses[k - 1], poses[k], step > 0 ? (at - arc[k - 1]) / step : 1);
    return oriented ? out : rigid_motion(Matrix3::Identity(), translation(out));
  }
};

/// The arc length of the point of a path nearest to p, within a range of arc lengths; and its distance from p.
struct PathProjection {
  double arc, distance;
};

VERNIER_LOCAL PathProjection nearest_on_path(const PoseLine& path, const Vector3& p, double from, double to) {
  PathProjection best{from, std::numeric_limits<double>::infinity()};
  for (std::size_t k = 1; k < path.arc.size(); ++k) {
    const double begin = path.arc[k - 1], length = path.arc[k] - begin;
    if (path.arc[k] < from || begin > to) continue;
    const Vector3 a = translation(path.poses[k - 1]), step = translation(path.poses[k]) - a;
    const Vector3 direction = step / length, arm = p - a;
    const double along = std::clamp(std::clamp(direction.dot(arm), from - begin, to - begin), 0.0, length);
    const Vector3 foot = along * direction;
    const double distance = (foot - arm).norm();
    if (distance < best.distance) best = {begin + along, distance};
  }
  return best;
}

/// A run over the arc length of the path.
VERNIER_LOCAL PoseLine along_path(const PoseLine& path, const std::vector<Isometry3>& run) {
  PoseLine out{{}, run};
  const double length = path.arc.back();
  PathProjection last = nearest_on_path(path, translation(run.front()), 0, length / 2);
  out.arc.push_back(last.arc);
  for (std::size_t k = 1; k < run.size(); ++k) {
    // corners that are cut short are passed in less way than the path's; noise may look like a step back
    const double reach = 3 * ((translation(run[k]) - translation(run[k - 1])).norm() + last.distance);
    last = nearest_on_path(path, translation(run[k]), last.arc, (std::min)(length, last.arc + reach));
    out.arc.push_back(last.arc);
  }
  return out;
}

VERNIER_LOCAL Iso9283PathPoint accuracy_at_point(double arc, const Isometry3& commanded,
                                                 const std::vector<Isometry3>& passed, bool oriented) {
  Iso9283PathPoint out{.arc_length = arc, .commanded = commanded};
  PointRows positions(static_cast<Index>(passed.size()), 3);
  std::vector<Matrix3> rotations;
  for (std::size_t j = 0; j < passed.size(); ++j) {
    set_point(positions, static_cast<Index>(j), translation(passed[j]));
    rotations.push_back(rotation(passed[j]));
  }
  const Vector3 centre = centroid(positions);
  out.mean.translation() = centre;
  out.at = (centre - translation(commanded)).norm();
  out.rt = repeatability(positions);
  out.at_abc = out.rt_abc = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  if (!oriented) return out;
  const Matrix3 mean = karcher_mean(rotations);
  out.mean.linear() = mean;
  out.at_abc = rotation_difference(mean, rotation(commanded));
  out.rt_abc = three_deviations(rotation_vectors_from(rotations, mean));
  return out;
}

}  // namespace detail

VERNIER_IMPL Iso9283Path iso9283_path(std::span<const Isometry3> commanded,
                                      std::span<const std::vector<Isometry3>> runs, const Iso9283PathOptions& options) {
  constexpr int points_of_norm = 10;
  constexpr std::size_t runs_of_norm = 10;
  const bool oriented = options.orientations;
  demand(commanded.size() >= 2, "iso9283_path: ", counted(commanded.size(), "commanded pose", "commanded poses"),
         ", a path has at least 2");
  demand(!runs.empty(), "iso9283_path: no runs");
  demand(options.points >= 1, "iso9283_path: ", options.points, " points, must be at least 1");
  detail::PoseLine path;
  for (std::size_t k = 0; k < commanded.size(); ++k) {
    if (const char* fault = detail::fault_of_pose(commanded[k], oriented))
      demand(false, "iso9283_path: commanded pose ", k + 1, ": ", fault);
    const double step = k == 0 ? 0 : (translation(commanded[k]) - translation(commanded[k - 1])).norm();
    demand(k == 0 || step > 0, "iso9283_path: commanded poses ", k, " and ", k + 1, " have the same position");
    path.arc.push_back(k == 0 ? 0 : path.arc.back() + step);
    path.poses.push_back(commanded[k]);
  }
  Iso9283Path out{.length = path.arc.back(), .runs = static_cast<Index>(runs.size())};
  const double spacing = out.length / options.points;
  std::vector<double> stations;
  for (int i = 0; i < options.points; ++i) stations.push_back((i + 0.5) * spacing);

  std::vector<std::vector<Isometry3>> passed(stations.size());
  for (std::size_t j = 0; j < runs.size(); ++j) {
    demand(runs[j].size() >= 2, "iso9283_path: run ", j + 1, " has ", runs[j].size(), " poses, must be at least 2");
    for (std::size_t k = 0; k < runs[j].size(); ++k)
      if (const char* fault = detail::fault_of_pose(runs[j][k], oriented))
        demand(false, "iso9283_path: run ", j + 1, ", pose ", k + 1, ": ", fault);
    const detail::PoseLine run = detail::along_path(path, runs[j]);
    demand(run.arc.front() <= stations.front() && run.arc.back() >= stations.back(), "iso9283_path: run ", j + 1,
           " passes the path from ", run.arc.front(), " m to ", run.arc.back(), " m, the points to compare lie from ",
           stations.front(), " m to ", stations.back(), " m");
    for (std::size_t i = 0; i < stations.size(); ++i) passed[i].push_back(run.pose(stations[i], oriented));
    double gap = 0;
    for (std::size_t k = 1; k < run.arc.size(); ++k) gap = (std::max)(gap, run.arc[k] - run.arc[k - 1]);
    if (gap > spacing)
      out.departures.push_back(message("run ", j + 1, ": poses are up to ", gap, " m apart, the points to compare ",
                                       spacing, " m: interpolated between them"));
  }
  if (options.points < points_of_norm)
    out.departures.push_back(message(options.points, " points, the norm asks for ", points_of_norm));
  if (runs.size() < runs_of_norm)
    out.departures.push_back(message(runs.size(), " runs, the norm asks for ", runs_of_norm));
  if (!oriented) out.departures.push_back("no orientations were measured: AT and RT of positions only");

  for (std::size_t i = 0; i < stations.size(); ++i) {
    out.points.push_back(detail::accuracy_at_point(stations[i], path.pose(stations[i], oriented), passed[i], oriented));
    const Iso9283PathPoint& one = out.points.back();
    out.at = (std::max)(out.at, one.at);
    out.rt = i == 0 ? one.rt : (std::max)(out.rt, one.rt);
    for (Index c = 0; c < 3; ++c) {  // NaN of all points, or of none
      out.at_abc(c) = i == 0 ? std::abs(one.at_abc(c)) : (std::max)(out.at_abc(c), std::abs(one.at_abc(c)));
      out.rt_abc(c) = i == 0 ? one.rt_abc(c) : (std::max)(out.rt_abc(c), one.rt_abc(c));
    }
  }
  return out;
}

}  // namespace vernier
