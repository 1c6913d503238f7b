// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/evaluation/iso9283.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/detail/iso9283_visits.hpp"
#include "vernier/evaluation/quantile.hpp"

namespace vernier {

namespace detail {

VERNIER_IMPL Matrix3 karcher_mean(std::span<const Matrix3> rotations) {
  Matrix3 mean = rotations.front();
  double last = std::numeric_limits<double>::infinity();
  for (;;) {
    const Vector3 step = centroid(rotation_vectors_from(rotations, mean));
    if (!(step.norm() < last / 2)) break;  // only rounding is left
    last = step.norm();
    mean = exp_so3(step) * mean;
  }
  return mean;
}

VERNIER_IMPL PointRows rotation_vectors_from(std::span<const Matrix3> rotations, const Matrix3& reference) {
  PointRows out(static_cast<Index>(rotations.size()), 3);
  for (std::size_t i = 0; i < rotations.size(); ++i)
    set_point(out, static_cast<Index>(i), rotation_difference(rotations[i], reference));
  return out;
}

VERNIER_IMPL double repeatability(const PointRows& points) {
  if (points.rows() < 2) return std::numeric_limits<double>::quiet_NaN();
  const VectorX l = distances_from(points, centroid(points));
  const double mean = l.mean();
  double squares = 0;
  for (const double one : l) squares += (one - mean) * (one - mean);
  return mean + 3 * std::sqrt(squares / static_cast<double>(l.size() - 1));
}

VERNIER_IMPL VectorX three_deviations(const ConstMatrixRef& values) {
  if (values.rows() < 2) return VectorX::Constant(values.cols(), std::numeric_limits<double>::quiet_NaN());
  VectorX out = squared_column_norms(rows_minus(values, column_means(values)));
  for (double& one : out) one = 3 * std::sqrt(one / static_cast<double>(values.rows() - 1));
  return out;
}

/// RP of visits that are drawn `counts` times, and its standard error by the influence of each visit.
struct DrawnRepeatability {
  double value;  ///< RP
  double error;  ///< 0 where all distances are equal
};

VERNIER_LOCAL DrawnRepeatability drawn_repeatability(const PointRows& points, const VectorX& counts, VectorX& l) {
  const double n = counts.sum();
  const Vector3 centre = Vector3(counts.dot(VERNIER_LATER(points).col(0)), counts.dot(VERNIER_LATER(points).col(1)),
                                 counts.dot(VERNIER_LATER(points).col(2))) /
                         n;
  for (Index i = 0; i < l.size(); ++i) l(i) = (point(points, i) - centre).squaredNorm();
  l = VERNIER_LATER(l).cwiseSqrt();
  const double mean = counts.dot(l) / n;
  for (double& d : l) d -= mean;
  const double variance = counts.dot(VERNIER_LATER(l).cwiseAbs2()) / (n - 1), s = std::sqrt(variance);
  if (!(s > 1e-12 * mean)) return {mean, 0};
  for (double& d : l) d += 1.5 / s * (d * d - variance);  // its influence
  return {mean + 3 * s, std::sqrt(counts.dot(VERNIER_LATER(l).cwiseAbs2())) / n};
}

/// 95 % interval of RP by the bootstrap-t.
VERNIER_LOCAL std::pair<double, double> repeatability_interval(const PointRows& points, int draws, std::uint64_t seed) {
  const Index n = points.rows();
  if (n < 3 || draws == 0) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const PointRows centred = rows_minus(points, centroid(points));
  VectorX counts = VectorX::Ones(n), l(n), t(draws);
  const DrawnRepeatability all = drawn_repeatability(centred, counts, l);
  if (same_value(all.error, 0)) return {all.value, all.value};
  Rng rng(seed);
  Index kept = 0;
  for (int k = 0; k < draws; ++k) {
    counts.setZero();
    for (Index i = 0; i < n; ++i) counts(static_cast<Index>(rng.uniform() * static_cast<double>(n))) += 1;
    const DrawnRepeatability one = drawn_repeatability(centred, counts, l);
    if (one.error > 0) t(kept++) = (one.value - all.value) / one.error;
  }
  if (kept == 0) return {all.value, all.value};
  t.conservativeResize(kept);
  std::sort(t.begin(), t.end());
  return {(std::max)(0.0, all.value - quantile_of_sorted(t, 0.975) * all.error),
          (std::max)(0.0, all.value - quantile_of_sorted(t, 0.025) * all.error)};
}

VERNIER_LOCAL Iso9283Pose accuracy_of_pose(int pose, const VisitedPose& visited, const Isometry3& command,
                                           const Iso9283Options& options) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double n = static_cast<double>(visited.positions.rows());
  Iso9283Pose out{.pose = pose,
                  .direction = visited.visits.front()->direction,
                  .n = visited.positions.rows(),
                  .mean = Isometry3::Identity()};
  const Vector3 centre = centroid(visited.positions);
  out.mean.translation() = centre;
  out.ap_xyz = centre - translation(command);
  out.ap = out.ap_xyz.norm();
  out.rp = repeatability(visited.positions);
  out.rp_xyz = three_deviations(visited.positions);
  // std::max would take a NaN for 0
  const double square = out.ap * out.ap - out.rp_xyz.squaredNorm() / 9 / n;
  out.ap_debiased = square < 0 ? 0 : std::sqrt(square);
  out.ap_registered = nan;
  const auto interval = repeatability_interval(visited.positions, options.draws,
                                               child_seed(options.seed, static_cast<std::uint64_t>(pose)));
  out.rp_low = interval.first;
  out.rp_high = interval.second;
  out.ap_abc = out.rp_abc = Vector3::Constant(nan);
  if (!options.orientations) return out;
  const Matrix3 mean = karcher_mean(visited.rotations);
  out.mean.linear() = mean;
  out.ap_abc = rotation_difference(mean, rotation(command));
  out.rp_abc = three_deviations(rotation_vectors_from(visited.rotations, mean));
  return out;
}

VERNIER_LOCAL std::optional<Isometry3> registration_of(const std::vector<Iso9283Pose>& poses,
                                                       std::span<const Isometry3> commanded) {
  const auto n = static_cast<Index>(poses.size());
  PointRows from(n, 3), to(n, 3);
  for (Index k = 0; k < n; ++k) {
    const Iso9283Pose& one = poses[static_cast<std::size_t>(k)];
    set_point(from, k, translation(commanded[static_cast<std::size_t>(one.pose - 1)]));
    set_point(to, k, translation(one.mean));
  }
  if (n < 3) return {};
  const VectorX spread = right_singular(rows_minus(from, centroid(from))).values;
  if (!(spread(1) > 1e-6 * spread(0))) return {};
  return register_points(from, to);
}

/// Distance of two poses, along each axis, and the angles between them: 1 + 3 + 3 values.
VERNIER_LOCAL VectorX distance_and_angles(const Isometry3& a, const Isometry3& b) {
  const Vector3 p = translation(a) - translation(b), r = rotation_difference(rotation(a), rotation(b));
  VectorX out(7);
  out(0) = p.norm();
  for (Index c = 0; c < 3; ++c) {
    out(1 + c) = std::abs(p(c));
    out(4 + c) = std::abs(r(c));
  }
  return out;
}

VERNIER_LOCAL std::optional<Iso9283Distance> accuracy_of_distance(const VisitedPose& first, const VisitedPose& second,
                                                                  const Isometry3& from, const Isometry3& to,
                                                                  bool oriented) {
  std::map<int, const Iso9283Visit*> cycles;
  for (const auto* v : second.visits) cycles.emplace(v->cycle, v);
  std::vector<VectorX> pairs;
  for (const auto* v : first.visits)
    if (const auto other = cycles.find(v->cycle); other != cycles.end())
      pairs.push_back(distance_and_angles(v->measured, other->second->measured));
  if (pairs.empty()) return {};
  MatrixX rows(static_cast<Index>(pairs.size()), 7);
  for (Index i = 0; i < rows.rows(); ++i)
    for (Index c = 0; c < 7; ++c) rows(i, c) = pairs[static_cast<std::size_t>(i)](c);
  VectorX accuracy = column_means(rows) - distance_and_angles(from, to), scatter = three_deviations(rows);
  if (!oriented)
    for (Index c = 4; c < 7; ++c) accuracy(c) = scatter(c) = std::numeric_limits<double>::quiet_NaN();
  return Iso9283Distance{first.visits.front()->pose,
                         second.visits.front()->pose,
                         rows.rows(),
                         accuracy(0),
                         scatter(0),
                         VERNIER_LATER(accuracy).segment(1, 3),
                         VERNIER_LATER(accuracy).segment(4, 3),
                         VERNIER_LATER(scatter).segment(1, 3),
                         VERNIER_LATER(scatter).segment(4, 3)};
}

VERNIER_LOCAL Iso9283Variation variation_of(int pose, const std::map<int, VisitedPose>& directions, bool oriented) {
  Iso9283Variation out{pose, 0, 0, Vector3::Zero()};
  if (!oriented) out.vap_abc.setConstant(std::numeric_limits<double>::quiet_NaN());
  std::vector<Vector3> centres;
  std::vector<Matrix3> rotations;
  for (const auto& [direction, visited] : directions) {
    if (direction == 0) continue;
    centres.push_back(centroid(visited.positions));
    if (oriented) rotations.push_back(karcher_mean(visited.rotations));
    for (std::size_t k = 0; k + 1 < centres.size(); ++k) {
      out.vap = (std::max)(out.vap, (centres.back() - centres[k]).norm());
      if (!oriented) continue;
      const Vector3 turn = rotation_difference(rotations.back(), rotations[k]);
      for (Index c = 0; c < 3; ++c) out.vap_abc(c) = (std::max)(out.vap_abc(c), std::abs(turn(c)));
    }
  }
  out.directions = static_cast<int>(centres.size());
  return out;
}

VERNIER_LOCAL Iso9283Drift drift_of(int pose, const VisitedPose& visited, const Isometry3& command, int together) {
  Iso9283Drift out{pose, {}, 0, 0};
  for (Index i = 0; i + together <= visited.positions.rows(); i += together) {
    const PointRows points = VERNIER_LATER(visited.positions).middleRows(i, together);
    double time = 0;
    for (Index k = i; k < i + together; ++k) time += visited.visits[static_cast<std::size_t>(k)]->time_s / together;
    out.groups.push_back({time, (centroid(points) - translation(command)).norm(), repeatability(points)});
    out.dap = (std::max)(out.dap, std::abs(out.groups.back().ap - out.groups.front().ap));
    out.drp = (std::max)(out.drp, std::abs(out.groups.back().rp - out.groups.front().rp));
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL Iso9283 iso9283(std::span<const Iso9283Visit> visits, std::span<const Isometry3> commanded,
                             const Iso9283Options& options) {
  demand(options.draws >= 0, "iso9283: ", options.draws, " draws, must be 0 or more");
  demand(options.drift_visits >= 2, "iso9283: ", options.drift_visits, " visits in a group, must be at least 2");
  const detail::VisitedPoses visited = detail::visited_poses(visits, commanded, options.orientations);
  const auto command = [&](int pose) { return commanded[static_cast<std::size_t>(pose - 1)]; };
  Iso9283 out;
  for (const auto& [pose, directions] : visited) {
    const detail::VisitedPose& one = directions.begin()->second;
    out.poses.push_back(detail::accuracy_of_pose(pose, one, command(pose), options));
    const Iso9283Variation variation = detail::variation_of(pose, directions, options.orientations);
    if (variation.directions > 1) out.variations.push_back(variation);
    Iso9283Drift drift = detail::drift_of(pose, one, command(pose), options.drift_visits);
    if (drift.groups.size() > 1) out.drift.push_back(std::move(drift));
  }
  out.registration = detail::registration_of(out.poses, commanded);
  if (out.registration)
    for (Iso9283Pose& one : out.poses)
      one.ap_registered = (translation(one.mean) - *out.registration * translation(command(one.pose))).norm();
  if (visited.contains(2) && visited.contains(4))
    out.distance = detail::accuracy_of_distance(visited.at(2).begin()->second, visited.at(4).begin()->second,
                                                command(2), command(4), options.orientations);
  out.departures = detail::departures_of(visits, visited, commanded, options.orientations);
  return out;
}

}  // namespace vernier
