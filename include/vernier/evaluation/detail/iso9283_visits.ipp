// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/evaluation/detail/iso9283_visits.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/same_value.hpp"

namespace vernier::detail {

VERNIER_IMPL const char* fault_of_pose(const Isometry3& pose, bool oriented) {
  if (!all_finite(VERNIER_LATER(translation(pose)))) return "the position is not finite";
  if (!oriented) return nullptr;
  const auto r = VERNIER_LATER(rotation(pose));
  const Matrix3 product = r * VERNIER_LATER(r).transpose(), fault = VERNIER_LATER(product) - Matrix3::Identity();
  const bool turns = VERNIER_LATER(fault).squaredNorm() < 1e-12 && r.determinant() > 0;
  return turns ? nullptr : "the orientation is not a rotation";
}

VERNIER_LOCAL VisitedPose in_sequence(std::vector<const Iso9283Visit*> visits) {
  bool timed = true;
  for (const auto* v : visits) timed = timed && std::isfinite(v->time_s);
  std::sort(visits.begin(), visits.end(), [timed](const Iso9283Visit* a, const Iso9283Visit* b) {
    return timed && !same_value(a->time_s, b->time_s) ? a->time_s < b->time_s : a->cycle < b->cycle;
  });
  VisitedPose out{std::move(visits), {}, {}};
  out.positions.resize(static_cast<Index>(out.visits.size()), 3);
  for (std::size_t i = 0; i < out.visits.size(); ++i) {
    set_point(out.positions, static_cast<Index>(i), translation(out.visits[i]->measured));
    out.rotations.push_back(rotation(out.visits[i]->measured));
  }
  return out;
}

VERNIER_IMPL VisitedPoses visited_poses(std::span<const Iso9283Visit> visits, std::span<const Isometry3> commanded,
                                        bool oriented) {
  demand(!visits.empty(), "iso9283: no visits");
  for (std::size_t k = 0; k < commanded.size(); ++k)
    if (const char* fault = fault_of_pose(commanded[k], oriented))
      demand(false, "iso9283: commanded pose ", k + 1, ": ", fault);
  VERNIER_LATER_TYPE(std::map<int, std::map<int, std::map<int, const Iso9283Visit*>>>) sorted;
  for (const Iso9283Visit& v : visits) {
    demand(v.pose >= 1 && static_cast<std::size_t>(v.pose) <= commanded.size(), "iso9283: a visit of pose ", v.pose,
           ", the commanded poses are 1 to ", commanded.size());
    demand(v.direction >= 0, "iso9283: pose ", v.pose, ", cycle ", v.cycle, ": direction ", v.direction,
           ", must be 0 or more");
    if (const char* fault = fault_of_pose(v.measured, oriented))
      demand(false, "iso9283: pose ", v.pose, ", cycle ", v.cycle, ": ", fault);
    demand(sorted[v.pose][v.direction].emplace(v.cycle, &v).second, "iso9283: pose ", v.pose, ", cycle ", v.cycle,
           ", direction ", v.direction, " is there twice");
  }
  VisitedPoses out;
  for (const auto& [pose, directions] : sorted)
    for (const auto& [direction, cycles] : directions) {
      std::vector<const Iso9283Visit*> all;
      for (const auto& [cycle, visit] : cycles) all.push_back(visit);
      out[pose].emplace(direction, in_sequence(std::move(all)));
    }
  return out;
}

/// Sentences about poses, those of the same words joined.
class Departures {
 public:
  VERNIER_LOCAL void add(int pose, const std::string& words) {
    for (auto& [text, poses] : all_)
      if (text == words) return poses.push_back(pose);
    all_.push_back({words, {pose}});
  }
  VERNIER_LOCAL std::vector<std::string> sentences() const {
    std::vector<std::string> out;
    for (const auto& [text, poses] : all_) {
      std::string names = poses.size() == 1 ? "pose " : "poses ";
      for (std::size_t i = 0; i < poses.size() && i < 5; ++i) names += message(i == 0 ? "" : ", ", poses[i]);
      if (poses.size() > 5) names += message(", ... (", poses.size(), " in all)");
      out.push_back(names + ": " + text);
    }
    return out;
  }

 private:
  std::vector<std::pair<std::string, std::vector<int>>> all_{};
};

/// Whether P1 is the centre, and P2 to P5 are on the diagonals of a diagonal plane of a cube, at 10 +- 2 % from their
/// ends.
VERNIER_LOCAL bool on_cube(std::span<const Isometry3> p) {
  std::array<Vector3, 4> arm;
  double mean = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    arm[k] = translation(p[k + 1]) - translation(p[0]);
    mean += arm[k].norm() / 4;
  }
  const double tolerance = 0.05;  // 2 % of a diagonal is a twentieth of the distance from its middle
  for (const Vector3& a : arm)
    if (!(std::abs(a.norm() - mean) <= tolerance * mean)) return false;
  const auto angle = [&](std::size_t i, std::size_t k) {
    return std::atan2(arm[i].cross(arm[k]).norm(), arm[i].dot(arm[k]));
  };
  const double crossing = 2 * std::atan(std::numbers::sqrt2), between = angle(0, 1);
  return angle(0, 2) > std::numbers::pi - tolerance && angle(1, 3) > std::numbers::pi - tolerance &&
         (std::min)(std::abs(between - crossing), std::abs(between - (std::numbers::pi - crossing))) < tolerance;
}

/// Where times are known: cycles out of order, and poses reached from more than one other pose.
VERNIER_LOCAL void check_sequence(std::span<const Iso9283Visit> visits, Departures& departures) {
  std::vector<const Iso9283Visit*> sequence;
  for (const Iso9283Visit& v : visits) {
    if (!std::isfinite(v.time_s)) return;
    sequence.push_back(&v);
  }
  std::sort(sequence.begin(), sequence.end(), [](const Iso9283Visit* a, const Iso9283Visit* b) {
    return a->time_s < b->time_s || (same_value(a->time_s, b->time_s) && a < b);
  });
  VERNIER_LATER_TYPE(std::map<std::pair<int, int>, const Iso9283Visit*>) last;
  VERNIER_LATER_TYPE(std::map<int, std::map<int, int>>) before;
  VERNIER_LATER_TYPE(std::map<std::pair<int, int>, bool>) told;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const Iso9283Visit& v = *sequence[i];
    const std::pair<int, int> key{v.pose, v.direction};
    if (const Iso9283Visit*& previous = last[key]; previous != nullptr && previous->cycle > v.cycle && !told[key]) {
      departures.add(v.pose, message("cycle ", v.cycle, " was measured after cycle ", previous->cycle));
      told[key] = true;
    }
    last[key] = &v;
    if (i > 0 && v.direction == 0) ++before[v.pose][sequence[i - 1]->pose];
  }
  for (const auto& [pose, from] : before)
    if (from.size() > 1) {
      std::string words;
      for (const auto& [other, times] : from)
        words += message(words.empty() ? "" : " and ", counted(times, "time", "times"), " from pose ", other);
      departures.add(pose, "reached " + words + ", the norm asks for one direction");
    }
}

VERNIER_IMPL std::vector<std::string> departures_of(std::span<const Iso9283Visit> visits, const VisitedPoses& visited,
                                                    std::span<const Isometry3> commanded, bool oriented) {
  constexpr std::size_t cycles_of_norm = 30;
  Departures departures;
  std::vector<std::string> out;
  if (commanded.size() != 5)
    out.push_back(counted(commanded.size(), "commanded pose", "commanded poses") + ", the norm has 5");
  if (commanded.size() == 5 && !on_cube(commanded))
    out.push_back(
        "the commanded poses are not the centre of a cube and four points on the diagonals of a diagonal plane, 10 % "
        "from their ends");
  if (!oriented) out.push_back("no orientations were measured: AP, RP, AD, RD and vAP of positions only");
  bool directed = false;
  std::pair<std::size_t, int> fewest{visits.size() + 1, 0}, most{0, 0};
  for (const auto& [pose, directions] : visited) {
    directed = directed || directions.rbegin()->first > 0;
    const std::size_t n = directions.begin()->second.visits.size();
    if (n < fewest.first) fewest = {n, pose};
    if (n > most.first) most = {n, pose};
  }
  if (fewest.first != most.first)
    out.push_back(message("unequal numbers of cycles: ", fewest.first, " (pose ", fewest.second, ") to ", most.first,
                          " (pose ", most.second, ")"));
  for (int pose = 1; static_cast<std::size_t>(pose) <= commanded.size(); ++pose) {
    const auto found = visited.find(pose);
    if (found == visited.end()) {
      departures.add(pose, "commanded, but not visited");
      continue;
    }
    const auto& directions = found->second;
    for (const auto& [direction, one] : directions) {
      const std::string from = direction > 0 ? message("direction ", direction, ": ") : std::string();
      if (one.visits.size() == 1)
        departures.add(pose, from + "one visit only: AP is the error of that visit, and there is no RP");
      else if (one.visits.size() < cycles_of_norm)
        departures.add(pose, message(from, one.visits.size(), " cycles, the norm asks for ", cycles_of_norm));
    }
    const int states = static_cast<int>(directions.size()) - (directions.contains(0) ? 1 : 0);
    if (directed && (states > 0 || pose == 1 || pose == 2 || pose == 4) && states != 3)
      departures.add(pose, counted(states, "direction", "directions") + " of approach, vAP of the norm needs 3");
    if (!directions.contains(0))
      departures.add(pose, message("AP and RP are those of direction ", directions.begin()->first));
  }
  check_sequence(visits, departures);
  for (std::string& sentence : departures.sentences()) out.push_back(std::move(sentence));
  return out;
}

}  // namespace vernier::detail
