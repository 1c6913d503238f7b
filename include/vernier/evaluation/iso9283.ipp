#pragma once

#include "vernier/evaluation/iso9283.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/quantile.hpp"

namespace vernier {

namespace detail {

VERNIER_IMPL Matrix3 karcher_mean(std::span<const Matrix3> rotations) {
  Matrix3 mean = rotations.front();
  double last = std::numeric_limits<double>::infinity();
  for (;;) {
    const Vector3 step = rotation_vectors(rotations, mean).colwise().mean().transpose();
    if (!(step.norm() < last / 2)) break;  // only rounding is left
    last = step.norm();
    mean = exp_so3(step) * mean;
  }
  return mean;
}

VERNIER_IMPL PointRows rotation_vectors(std::span<const Matrix3> rotations, const Matrix3& reference) {
  PointRows out(static_cast<Index>(rotations.size()), 3);
  for (std::size_t i = 0; i < rotations.size(); ++i)
    out.row(static_cast<Index>(i)) = log_so3(Matrix3(rotations[i] * reference.transpose())).transpose();
  return out;
}

VERNIER_IMPL double repeatability(const PointRows& points) {
  if (points.rows() < 2) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::RowVector3d centre = points.colwise().mean();  // not in the expression: there it is evaluated row by row
  const VectorX l = (points.rowwise() - centre).rowwise().norm();
  const double mean = l.mean();
  return mean + 3 * std::sqrt((l.array() - mean).square().sum() / static_cast<double>(l.size() - 1));
}

VERNIER_IMPL Vector3 three_deviations(const PointRows& values) {
  if (values.rows() < 2) return Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Eigen::RowVector3d centre = values.colwise().mean();
  const PointRows centred = values.rowwise() - centre;
  return 3 * (centred.colwise().squaredNorm() / static_cast<double>(values.rows() - 1)).cwiseSqrt().transpose();
}

VERNIER_IMPL const char* fault_of_pose(const Isometry3& pose, bool oriented) {
  if (!pose.translation().allFinite()) return "the position is not finite";
  if (!oriented) return nullptr;
  const Matrix3 r = pose.linear();
  const bool rotation = (r * r.transpose() - Matrix3::Identity()).squaredNorm() < 1e-12 && r.determinant() > 0;
  return rotation ? nullptr : "the orientation is not a rotation";
}

/// RP of visits that are drawn `counts` times, and its standard error by the influence of each visit.
struct DrawnRepeatability {
  double value;  ///< RP
  double error;  ///< 0 where all distances are equal
};

VERNIER_API DrawnRepeatability drawn_repeatability(const PointRows& points, const VectorX& counts, VectorX& l) {
  const double n = counts.sum();
  const Eigen::RowVector3d centre = (counts.transpose() * points) / n;
  l = ((points.col(0).array() - centre(0)).square() + (points.col(1).array() - centre(1)).square() +
       (points.col(2).array() - centre(2)).square())
          .sqrt();
  const double mean = counts.dot(l) / n;
  const auto d = (l.array() - mean);
  const double variance = (counts.array() * d.square()).sum() / (n - 1), s = std::sqrt(variance);
  if (!(s > 1e-12 * mean)) return {mean, 0};
  const auto influence = d + 1.5 / s * (d.square() - variance);
  return {mean + 3 * s, std::sqrt((counts.array() * influence.square()).sum()) / n};
}

/// 95 % interval of RP by the bootstrap-t.
VERNIER_API std::pair<double, double> repeatability_interval(const PointRows& points, int draws, std::uint64_t seed) {
  const Index n = points.rows();
  if (n < 3 || draws == 0) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const Eigen::RowVector3d centre = points.colwise().mean();
  const PointRows centred = points.rowwise() - centre;
  VectorX counts = VectorX::Ones(n), l(n), t(draws);
  const DrawnRepeatability all = drawn_repeatability(centred, counts, l);
  if (all.error == 0) return {all.value, all.value};
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
  return {std::max(0.0, all.value - quantile_of_sorted(t, 0.975) * all.error),
          std::max(0.0, all.value - quantile_of_sorted(t, 0.025) * all.error)};
}

/// Visits of one pose from one direction, in sequence.
struct VisitedPose {
  std::vector<const Iso9283Visit*> visits;
  PointRows positions{};
  std::vector<Matrix3> rotations{};
  bool timed = true;  ///< whether all times are known

  explicit VisitedPose(std::vector<const Iso9283Visit*> all) : visits(std::move(all)) {
    for (const auto* v : visits) timed = timed && std::isfinite(v->time_s);
    std::sort(visits.begin(), visits.end(), [&](const Iso9283Visit* a, const Iso9283Visit* b) {
      return timed && a->time_s != b->time_s ? a->time_s < b->time_s : a->cycle < b->cycle;
    });
    positions.resize(static_cast<Index>(visits.size()), 3);
    for (std::size_t i = 0; i < visits.size(); ++i) {
      positions.row(static_cast<Index>(i)) = visits[i]->measured.translation().transpose();
      rotations.emplace_back(visits[i]->measured.linear());
    }
  }
};

/// By pose, then by direction.
using VisitedPoses = std::map<int, std::map<int, VisitedPose>>;

VERNIER_API VisitedPoses visited_poses(std::span<const Iso9283Visit> visits, std::span<const Isometry3> commanded,
                                       bool oriented) {
  require(!visits.empty(), "iso9283: no visits");
  for (std::size_t k = 0; k < commanded.size(); ++k)
    if (const char* fault = fault_of_pose(commanded[k], oriented))
      require(false, "iso9283: commanded pose ", k + 1, ": ", fault);
  std::map<int, std::map<int, std::map<int, const Iso9283Visit*>>> sorted;
  for (const Iso9283Visit& v : visits) {
    require(v.pose >= 1 && static_cast<std::size_t>(v.pose) <= commanded.size(), "iso9283: a visit of pose ", v.pose,
            ", the commanded poses are 1 to ", commanded.size());
    require(v.direction >= 0, "iso9283: pose ", v.pose, ", cycle ", v.cycle, ": direction ", v.direction,
            ", must be 0 or more");
    if (const char* fault = fault_of_pose(v.measured, oriented))
      require(false, "iso9283: pose ", v.pose, ", cycle ", v.cycle, ": ", fault);
    require(sorted[v.pose][v.direction].emplace(v.cycle, &v).second, "iso9283: pose ", v.pose, ", cycle ", v.cycle,
            ", direction ", v.direction, " is there twice");
  }
  VisitedPoses out;
  for (const auto& [pose, directions] : sorted)
    for (const auto& [direction, cycles] : directions) {
      std::vector<const Iso9283Visit*> all;
      for (const auto& [cycle, visit] : cycles) all.push_back(visit);
      out[pose].emplace(direction, VisitedPose(std::move(all)));
    }
  return out;
}

VERNIER_API Iso9283Pose accuracy_of_pose(int pose, const VisitedPose& visited, const Isometry3& command,
                                         const Iso9283Options& options) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double n = static_cast<double>(visited.positions.rows());
  Iso9283Pose out{.pose = pose,
                  .direction = visited.visits.front()->direction,
                  .n = visited.positions.rows(),
                  .mean = Isometry3::Identity()};
  out.mean.translation() = visited.positions.colwise().mean().transpose();
  out.ap_xyz = out.mean.translation() - command.translation();
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
  out.ap_abc = log_so3(Matrix3(mean * command.linear().transpose()));
  out.rp_abc = three_deviations(rotation_vectors(visited.rotations, mean));
  return out;
}

VERNIER_API std::optional<Isometry3> registration_of(const std::vector<Iso9283Pose>& poses,
                                                     std::span<const Isometry3> commanded) {
  Eigen::Matrix3Xd from(3, static_cast<Index>(poses.size())), to(3, from.cols());
  for (Index k = 0; k < from.cols(); ++k) {
    const Iso9283Pose& one = poses[static_cast<std::size_t>(k)];
    from.col(k) = commanded[static_cast<std::size_t>(one.pose - 1)].translation();
    to.col(k) = one.mean.translation();
  }
  if (from.cols() < 3) return {};
  const MatrixX centred = from.colwise() - from.rowwise().mean();
  const VectorX spread = Eigen::JacobiSVD<MatrixX>(centred).singularValues();
  if (!(spread(1) > 1e-6 * spread(0))) return {};
  Isometry3 out = Isometry3::Identity();
  out.matrix() = Eigen::umeyama(from, to, false);
  return out;
}

VERNIER_API std::optional<Iso9283Distance> accuracy_of_distance(const VisitedPose& first, const VisitedPose& second,
                                                                const Isometry3& from, const Isometry3& to,
                                                                bool oriented) {
  std::map<int, const Iso9283Visit*> cycles;
  for (const auto* v : second.visits) cycles.emplace(v->cycle, v);
  const auto pair_of = [](const Isometry3& a, const Isometry3& b) {  // distance, its axes, its angles
    const Vector3 p = (a.translation() - b.translation()).cwiseAbs();
    const Vector3 r = log_so3(Matrix3(a.linear() * b.linear().transpose())).cwiseAbs();
    return Eigen::Matrix<double, 1, 7>(
        (Eigen::Matrix<double, 1, 7>() << p.norm(), p.transpose(), r.transpose()).finished());
  };
  Eigen::Matrix<double, Eigen::Dynamic, 7> d(static_cast<Index>(first.visits.size()), 7);
  Index n = 0;
  for (const auto* v : first.visits)
    if (const auto other = cycles.find(v->cycle); other != cycles.end())
      d.row(n++) = pair_of(v->measured, other->second->measured);
  if (n == 0) return {};
  d.conservativeResize(n, 7);
  Eigen::Matrix<double, 1, 7> accuracy = d.colwise().mean(), scatter;
  scatter << three_deviations(d.leftCols<3>()).transpose(), three_deviations(d.middleCols<3>(3)).transpose(),
      three_deviations(d.rightCols<3>())(2);
  accuracy -= pair_of(from, to);
  if (!oriented) accuracy.tail<3>().setConstant(std::numeric_limits<double>::quiet_NaN());
  if (!oriented) scatter.tail<3>().setConstant(std::numeric_limits<double>::quiet_NaN());
  return Iso9283Distance{first.visits.front()->pose,
                         second.visits.front()->pose,
                         n,
                         accuracy(0),
                         scatter(0),
                         accuracy.segment<3>(1).transpose(),
                         accuracy.tail<3>().transpose(),
                         scatter.segment<3>(1).transpose(),
                         scatter.tail<3>().transpose()};
}

VERNIER_API Iso9283Variation variation_of(int pose, const std::map<int, VisitedPose>& directions, bool oriented) {
  Iso9283Variation out{pose, 0, 0, Vector3::Zero()};
  if (!oriented) out.vap_abc.setConstant(std::numeric_limits<double>::quiet_NaN());
  std::vector<Vector3> centres;
  std::vector<Matrix3> rotations;
  for (const auto& [direction, visited] : directions) {
    if (direction == 0) continue;
    centres.emplace_back(visited.positions.colwise().mean().transpose());
    if (oriented) rotations.push_back(karcher_mean(visited.rotations));
    for (std::size_t k = 0; k + 1 < centres.size(); ++k) {
      out.vap = std::max(out.vap, (centres.back() - centres[k]).norm());
      if (oriented)
        out.vap_abc = out.vap_abc.cwiseMax(log_so3(Matrix3(rotations.back() * rotations[k].transpose())).cwiseAbs());
    }
  }
  out.directions = static_cast<int>(centres.size());
  return out;
}

VERNIER_API Iso9283Drift drift_of(int pose, const VisitedPose& visited, const Isometry3& command, int together) {
  Iso9283Drift out{pose, {}, 0, 0};
  for (Index i = 0; i + together <= visited.positions.rows(); i += together) {
    const PointRows points = visited.positions.middleRows(i, together);
    double time = 0;
    for (Index k = i; k < i + together; ++k) time += visited.visits[static_cast<std::size_t>(k)]->time_s / together;
    out.groups.push_back(
        {time, (points.colwise().mean().transpose() - command.translation()).norm(), repeatability(points)});
    out.dap = std::max(out.dap, std::abs(out.groups.back().ap - out.groups.front().ap));
    out.drp = std::max(out.drp, std::abs(out.groups.back().rp - out.groups.front().rp));
  }
  return out;
}

/// Sentences about poses, those of the same words joined.
class Departures {
 public:
  void add(int pose, const std::string& words) {
    for (auto& [text, poses] : all_)
      if (text == words) return poses.push_back(pose);
    all_.push_back({words, {pose}});
  }
  std::vector<std::string> sentences() const {
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
VERNIER_API bool on_cube(std::span<const Isometry3> p) {
  std::array<Vector3, 4> arm;
  double mean = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    arm[k] = p[k + 1].translation() - p[0].translation();
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
         std::min(std::abs(between - crossing), std::abs(between - (std::numbers::pi - crossing))) < tolerance;
}

/// Where times are known: cycles out of order, and poses reached from more than one other pose.
VERNIER_API void check_sequence(std::span<const Iso9283Visit> visits, Departures& departures) {
  std::vector<const Iso9283Visit*> sequence;
  for (const Iso9283Visit& v : visits) {
    if (!std::isfinite(v.time_s)) return;
    sequence.push_back(&v);
  }
  std::stable_sort(sequence.begin(), sequence.end(),
                   [](const Iso9283Visit* a, const Iso9283Visit* b) { return a->time_s < b->time_s; });
  std::map<std::pair<int, int>, const Iso9283Visit*> last;
  std::map<int, std::map<int, int>> before;
  std::map<std::pair<int, int>, bool> told;
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
        words += message(words.empty() ? "" : " and ", times, " times from pose ", other);
      departures.add(pose, "reached " + words + ", the norm asks for one direction");
    }
}

VERNIER_API std::vector<std::string> departures_of(std::span<const Iso9283Visit> visits, const VisitedPoses& visited,
                                                   std::span<const Isometry3> commanded,
                                                   const Iso9283Options& options) {
  constexpr std::size_t cycles_of_norm = 30;
  Departures departures;
  std::vector<std::string> out;
  if (commanded.size() != 5) out.push_back(message(commanded.size(), " commanded poses, the norm has 5"));
  if (commanded.size() == 5 && !on_cube(commanded))
    out.push_back(
        "the commanded poses are not the centre of a cube and four points on the diagonals of a diagonal plane, 10 % "
        "from their ends");
  if (!options.orientations) out.push_back("no orientations were measured: AP, RP, AD, RD and vAP of positions only");
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
      departures.add(
          pose, message(states, states == 1 ? " direction" : " directions", " of approach, vAP of the norm needs 3"));
    if (!directions.contains(0) && states > 0)
      departures.add(pose, message("AP and RP are those of direction ", directions.begin()->first));
  }
  check_sequence(visits, departures);
  for (std::string& sentence : departures.sentences()) out.push_back(std::move(sentence));
  return out;
}

}  // namespace detail

VERNIER_IMPL Iso9283 iso9283(std::span<const Iso9283Visit> visits, std::span<const Isometry3> commanded,
                             const Iso9283Options& options) {
  require(options.draws >= 0, "iso9283: ", options.draws, " draws, must be 0 or more");
  require(options.drift_visits >= 2, "iso9283: ", options.drift_visits, " visits in a group, must be at least 2");
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
      one.ap_registered = (one.mean.translation() - *out.registration * command(one.pose).translation()).norm();
  if (visited.contains(2) && visited.contains(4))
    out.distance = detail::accuracy_of_distance(visited.at(2).begin()->second, visited.at(4).begin()->second,
                                                command(2), command(4), options.orientations);
  out.departures = detail::departures_of(visits, visited, commanded, options);
  return out;
}

}  // namespace vernier
