// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "vernier/compensation/detail/path_solver.hpp"
#include "vernier/core/argsort.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

/// One value for each of n joints.
VERNIER_LOCAL inline PathJoints same_joints(int n, double value) noexcept {
  PathJoints out(n);
  for (int j = 0; j < n; ++j) out(j) = value;
  return out;
}

/// Largest difference of a joint.
VERNIER_LOCAL inline double largest_difference(const PathJoints& a, const PathJoints& b) noexcept {
  double out = 0;
  for (Index j = 0; j < a.size(); ++j) out = (std::max)(out, std::abs(a(j) - b(j)));
  return out;
}

/// a, and a share of the way to b.
VERNIER_LOCAL inline PathJoints joints_at_share(const PathJoints& a, const PathJoints& b, double share) noexcept {
  PathJoints out = a;
  for (Index j = 0; j < a.size(); ++j) out(j) += share * (b(j) - a(j));
  return out;
}

/// Whether joint values are the same but for rounding errors.
VERNIER_LOCAL inline bool nearly_same(const PathJoints& a, const PathJoints& b) noexcept {
  double off = 0, of_a = 0, of_b = 0;
  for (Index j = 0; j < a.size(); ++j) {
    off += (a(j) - b(j)) * (a(j) - b(j));
    of_a += a(j) * a(j);
    of_b += b(j) * b(j);
  }
  return off <= 1e-24 * (std::min)(of_a, of_b);
}

VERNIER_IMPL PathJoints approach_on_the_way(const PathJoints& coming, const PathJoints& command, const PathJoints& q) {
  constexpr double transition = 0.05;  // rad: hysteresis of a gear has turned round
  PathJoints out = command;
  for (Index j = 0; j < q.size(); ++j) {
    const double before = command(j) - coming(j), since = q(j) - command(j);
    if (!std::isfinite(before)) continue;
    if (before * since >= 0) {
      out(j) = coming(j);
    } else {
      const double share = (std::min)(1.0, std::abs(since) / transition);
      out(j) = q(j) - ((1 - share) * std::clamp(before, -transition, transition) + share * since);
    }
  }
  return out;
}

/// A branch with its whole turns at one target, and the cheapest way to it.
struct PathState {
  PathJoints joints;
  int id;
  double cost;
  int from;   ///< index of the state before
  bool jump;  ///< whether the move to it is not the one asked for
};

inline bool cheaper(const PathState& a, const PathState& b) { return a.cost < b.cost; }

/// The cheapest first; of equals in their order.
VERNIER_LOCAL std::vector<PathState> by_cost(const std::vector<PathState>& states) {
  VectorX costs(static_cast<Index>(states.size()));
  for (Index i = 0; i < costs.size(); ++i) costs(i) = states[static_cast<std::size_t>(i)].cost;
  std::vector<PathState> out;
  out.reserve(states.size());
  for (const Index i : argsort(costs)) out.push_back(states[static_cast<std::size_t>(i)]);
  return out;
}

/// Chooses branches and whole turns over a path, then commands.
class PathSearch {
 public:
  PathSearch(const PathArm& arm, const std::vector<PathGoal>& goals, const PathSettings& settings)
      : arm_(arm), goals_(goals), settings_(settings) {}

  VERNIER_LOCAL SolvedPath run();

 private:
  /// Time of a joint move whose joints are equally fast.
  VERNIER_LOCAL double duration(const PathJoints& a, const PathJoints& b) const {
    double out = 0;
    for (int j = 0; j < arm_.joints; ++j) out = (std::max)(out, std::abs(b(j) - a(j)));
    return out;
  }
  VERNIER_LOCAL PathJoints turned(const PathJoints& joints, const PathJoints& close_to) const {
    PathJoints out = joints;
    for (int j = 0; j < arm_.joints; ++j)
      out(j) = nearest_turn(joints(j), close_to(j), settings_.lower(j), settings_.upper(j));
    return out;
  }
  VERNIER_LOCAL bool within(const PathJoints& q) const {
    bool out = true;
    for (int j = 0; j < arm_.joints; ++j)
      out = out && q(j) >= settings_.lower(j) - 1e-9 && q(j) <= settings_.upper(j) + 1e-9;
    return out;
  }
  VERNIER_LOCAL bool at_limit(const PathJoints& q) const {
    bool out = false;
    for (int j = 0; j < arm_.joints; ++j)  // a held joint is no limit
      out = out || (settings_.lower(j) < settings_.upper(j) &&
                    (q(j) - settings_.lower(j) <= 1e-9 || settings_.upper(j) - q(j) <= 1e-9));
    return out;
  }
  /// Adds a state, or a cheaper way to it.
  VERNIER_LOCAL static void relax(std::vector<PathState>& states, const PathState& state) {
    for (PathState& known : states)
      if (known.id == state.id && largest_difference(known.joints, state.joints) < 1e-6) {
        if (state.cost < known.cost) known = state;
        return;
      }
    states.push_back(state);
  }

  VERNIER_LOCAL Reach find_branches(const PathGoal& goal, const PathJoints& close_to,
                                    std::vector<PathBranch>& out) const;
  VERNIER_LOCAL PathJoints next_seed(const PathJoints& before, const PathJoints& end, int left) const;
  VERNIER_LOCAL std::optional<PathJoints> end_of_line(const PathState& from, const PathGoal& start,
                                                      const PathBranch& to, const PathGoal& end) const;
  VERNIER_LOCAL void advance(const std::vector<PathState>& before, const PathGoal* start, const PathGoal& goal,
                             const std::vector<PathBranch>& branches, std::vector<PathState>& out) const;
  VERNIER_LOCAL double worst_ratio(const PathJoints& coming, const PathJoints& a, const PathJoints& b,
                                   const Isometry3& from, const Isometry3& to, double& deviation) const;
  VERNIER_LOCAL bool fill_line(const PathJoints& coming_from, const PathJoints& from, const PathJoints& close_to,
                               const Isometry3& start, const Isometry3& end, int pieces, std::vector<SolvedPoint>& out,
                               double& worst, double& deviation) const;
  VERNIER_LOCAL void move_to(Index target, const PathState& state, const SolvedPoint* before, SolvedPath& out) const;

  const PathArm& arm_;
  const std::vector<PathGoal>& goals_;
  const PathSettings& settings_;
};

VERNIER_IMPL Reach PathSearch::find_branches(const PathGoal& goal, const PathJoints& close_to,
                                             std::vector<PathBranch>& out) const {
  if (!is_pose(goal.pose)) return Reach::invalid_target;
  if (goal.joints.size() == 0) return arm_.branches(goal.pose, close_to, out);
  PathJoints command = goal.joints, unknown = same_joints(arm_.joints, std::nan(""));
  double errors[2];
  arm_.correct(goal.pose, unknown, command, errors);  // or the joint values that come nearest
  out.push_back({command, arm_.branch_id(command)});
  return Reach::met;
}

/// Where the next joint values on the way from some to others are looked for: at those before, since the pose tells all
/// joints; where there are more joints than equations, a share of the way farther, so that all joints arrive.
/// @param left pieces that are left, this one included
VERNIER_IMPL PathJoints PathSearch::next_seed(const PathJoints& before, const PathJoints& end, int left) const {
  return arm_.joints > arm_.equations ? joints_at_share(before, end, 1.0 / left) : before;
}

/// The turns of a branch at which a linear move ends: the nominal arm follows the line where the joints change by much.
/// It begins and ends where that arm has the poses, which may be far from the commands near a singularity.
VERNIER_IMPL std::optional<PathJoints> PathSearch::end_of_line(const PathState& from, const PathGoal& start,
                                                               const PathBranch& to, const PathGoal& end) const {
  constexpr double little = 0.2, step = 0.1;  // rad
  if (from.id != to.id) return std::nullopt;
  PathJoints close_to = turned(to.joints, from.joints);
  const double largest = largest_difference(close_to, from.joints);
  if (largest > little) {
    const int n = std::clamp(static_cast<int>(std::ceil(largest / step)), 4, 64);
    PathJoints q = from.joints, last = close_to;
    if (!arm_.nominal_joints(end.pose, last) || largest_difference(last, close_to) > settings_.max_joint_step)
      return std::nullopt;
    if (!arm_.nominal_joints(start.pose, q)) q = from.joints;
    for (int k = 1; k <= n; ++k) {
      const PathJoints before = q;
      q = next_seed(before, last, n - k + 2);
      if (!arm_.nominal_joints(interpolated(start.pose, end.pose, static_cast<double>(k) / n), q) ||
          largest_difference(q, before) > settings_.max_joint_step || arm_.branch_id(q) != from.id)
        return std::nullopt;
    }
    close_to = turned(to.joints, q);
    last = turned(last, q);
    if (largest_difference(last, q) > 0.1) return std::nullopt;
  }
  return within(close_to) ? std::optional<PathJoints>(close_to) : std::nullopt;
}

/// States at a target from those before.
VERNIER_IMPL void PathSearch::advance(const std::vector<PathState>& before, const PathGoal* start, const PathGoal& goal,
                                      const std::vector<PathBranch>& branches, std::vector<PathState>& out) const {
  constexpr std::size_t most_states = 40;
  const auto add = [&](PathJoints joints, const PathBranch& branch, int from, bool jump) {
    const PathState& last = before[static_cast<std::size_t>(from)];
    const double cost = goal.joints.size() > 0 ? 0 : arm_.cost(joints);
    relax(out, {joints, branch.id, last.cost + duration(last.joints, joints) + cost, from, jump});
  };
  const bool linear = start != nullptr && goal.motion == Motion::linear, first = before.front().from < 0;
  if (linear)
    for (std::size_t a = 0; a < before.size(); ++a)
      for (const PathBranch& branch : branches)
        if (const auto joints = end_of_line(before[a], *start, branch, goal))
          add(*joints, branch, static_cast<int>(a), false);
  if (out.empty()) {
    const bool jump = goal.motion == Motion::linear;  // on no branch does the line lead there
    const auto cheapest = static_cast<int>(std::min_element(before.begin(), before.end(), cheaper) - before.begin());
    for (std::size_t a = 0; a < before.size(); ++a)
      for (const PathBranch& branch : branches)
        if (const PathJoints joints = turned(branch.joints, before[a].joints); within(joints))
          add(joints, branch, static_cast<int>(a), jump);
    // Another turn of a joint, with which the moves to come may fit, or which was measured: of the nearest branches.
    std::vector<PathState> nearest;
    for (const PathState& state : out)
      if (state.from == cheapest) nearest.push_back(state);
    nearest = by_cost(nearest);
    for (std::size_t k = 0; k < std::min<std::size_t>(nearest.size(), first ? nearest.size() : 2); ++k)
      for (int j = 0; j < arm_.joints; ++j)
        for (const double turn : {-2 * std::numbers::pi, 2 * std::numbers::pi}) {
          PathJoints other = nearest[k].joints;
          other(j) += turn;
          if (within(other)) add(other, {other, nearest[k].id}, cheapest, jump);
        }
  }
  if (out.size() > most_states) {
    out = by_cost(out);
    out.resize(most_states);
  }
}

/// How far the tool is from a line where the controller interpolates between two commands, in units of the tolerances,
/// and in space [m].
VERNIER_IMPL double PathSearch::worst_ratio(const PathJoints& coming, const PathJoints& a, const PathJoints& b,
                                            const Isometry3& from, const Isometry3& to, double& deviation) const {
  const Isometry3 first = arm_.nominal_pose(a), last = arm_.nominal_pose(b);
  double worst = 0;
  for (const double share : {0.25, 0.5, 0.75}) {
    const PathJoints straight = joints_at_share(a, b, share);
    PathJoints q = straight;
    if (!arm_.nominal_joints(interpolated(first, last, share), q) ||
        largest_difference(q, straight) > settings_.max_joint_step)
      return std::numeric_limits<double>::infinity();
    const Isometry3 there = arm_.pose(q, approach_on_the_way(coming, a, q)), wanted = interpolated(from, to, share);
    const double off = (translation(there) - translation(wanted)).norm();
    const double turned = rotation_difference(rotation(there), rotation(wanted)).norm();
    deviation = (std::max)(deviation, off);
    worst = (std::max)({worst, off / settings_.tolerance, turned / settings_.rotation_tolerance});
  }
  return worst;
}

/// Commands that divide a line into equal pieces, the last one at its end.
/// @return whether all of them were found next to one another
VERNIER_IMPL bool PathSearch::fill_line(const PathJoints& coming_from, const PathJoints& from,
                                        const PathJoints& close_to, const Isometry3& start, const Isometry3& end,
                                        int pieces, std::vector<SolvedPoint>& out, double& worst,
                                        double& deviation) const {
  PathJoints before = from, tracked = from, coming = coming_from;
  Isometry3 at = start;
  worst = deviation = 0;
  for (int k = 1; k <= pieces; ++k) {
    const double share = static_cast<double>(k) / pieces;
    const Isometry3 wanted = k == pieces ? end : interpolated(start, end, share);
    SolvedPoint point{
        k == pieces ? close_to : next_seed(tracked, close_to, pieces - k + 1), 0, k < pieces, PointStatus::met, 0, 0};
    if (k < pieces) {
      if (!arm_.nominal_joints(wanted, point.command)) return false;
      tracked = point.command;
    }
    double errors[2];
    point.coming = approach_on_the_way(coming, before, point.command);
    bool found = arm_.correct(wanted, point.coming, point.command, errors);
    // the direction of a joint that hardly moves shows in the command only
    const PathJoints now = approach_on_the_way(coming, before, point.command);
    if (found && !nearly_same(now, point.coming)) {
      point.coming = now;
      found = arm_.correct(wanted, point.coming, point.command, errors);
    }
    if (!found || largest_difference(point.command, before) > settings_.max_joint_step) return false;
    point.position_error = errors[0];
    point.rotation_error = errors[1];
    worst = (std::max)(worst, worst_ratio(coming, before, point.command, at, wanted, point.deviation));
    coming = point.coming;
    deviation = (std::max)(deviation, point.deviation);
    before = point.command;
    at = wanted;
    out.push_back(point);
  }
  return true;
}

VERNIER_IMPL void PathSearch::move_to(Index target, const PathState& state, const SolvedPoint* before,
                                      SolvedPath& out) const {
  const PathGoal& goal = goals_[static_cast<std::size_t>(target)];
  const PathJoints from = before != nullptr ? before->command : settings_.start;
  SolvedPoint point{state.joints, target, false, state.jump ? PointStatus::jump : PointStatus::met, 0, 0};
  point.coming = from;
  double errors[2];
  const bool found = arm_.correct(goal.pose, from, point.command, errors);
  point.position_error = errors[0];
  point.rotation_error = errors[1];
  if (!found) point.status = at_limit(point.command) ? PointStatus::beyond_limits : PointStatus::not_found;
  if (goal.motion == Motion::linear && point.status == PointStatus::met) {
    if (before == nullptr || before->target + 1 != target) {
      if (before != nullptr) point.status = PointStatus::jump;  // the line does not begin at its target
    } else {
      const Isometry3& start = goals_[static_cast<std::size_t>(target - 1)].pose;
      const double ratio = worst_ratio(before->coming, from, point.command, start, goal.pose, point.deviation);
      point.ends_only = point.deviation;
      out.before = (std::max)(out.before, point.deviation);
      const double change = largest_difference(point.command, from);
      // what is left grows with the square of a piece's length
      int pieces = std::isfinite(ratio) ? static_cast<int>(std::ceil(std::sqrt((std::min)(ratio, 1e6)))) : 8;
      pieces = (std::max)(pieces, static_cast<int>(std::ceil(change / settings_.max_joint_step)));
      if (pieces > 1) {
        std::vector<SolvedPoint> line, finer;
        double worst = 0, deviation = 0;
        bool complete = false;
        for (pieces = (std::min)(pieces, settings_.max_inserted + 1);;) {
          double finer_worst = 0, finer_deviation = 0;
          finer.clear();
          const bool filled = fill_line(before->coming, from, point.command, start, goal.pose, pieces, finer,
                                        finer_worst, finer_deviation);
          if (filled && (!complete || finer_worst < worst)) {  // the ripple of gears does not shrink at once
            line.swap(finer);
            worst = finer_worst;
            deviation = finer_deviation;
            complete = true;
          }
          if ((complete && worst <= 1) || pieces == settings_.max_inserted + 1) break;
          pieces = (std::min)(2 * pieces, settings_.max_inserted + 1);
        }
        if (complete) {
          for (SolvedPoint& one : line) one.target = target;
          line.back().ends_only = point.ends_only;
          if (worst > 1) line.back().status = PointStatus::off_path;
          out.after = (std::max)(out.after, deviation);
          out.points.insert(out.points.end(), line.begin(), line.end());
          return;
        }
        point.status = PointStatus::jump;
      }
      out.after = (std::max)(out.after, point.deviation);
    }
  }
  out.points.push_back(point);
}

VERNIER_IMPL SolvedPath PathSearch::run() {
  const std::size_t n = goals_.size();
  std::vector<std::vector<PathState>> states(n);
  std::vector<Reach> reach(n);
  std::vector<PathBranch> branches;
  bool started = true;
  PathJoints close_to = same_joints(arm_.joints, 0);
  for (int j = 0; j < arm_.joints; ++j) {
    started = started && std::isfinite(settings_.start(j));
    if (std::isfinite(settings_.lower(j) + settings_.upper(j)))
      close_to(j) = 0.5 * (settings_.lower(j) + settings_.upper(j));
  }
  if (started) close_to = settings_.start;
  const std::vector<PathState> beginning{{close_to, 0, 0, -1, false}};

  const auto stopped = [&](std::size_t commands, std::size_t looked_at) {
    return !settings_.observer({static_cast<Index>(commands), static_cast<Index>(looked_at), 0});
  };
  std::size_t last = n;
  for (std::size_t k = 0; k < n; ++k) {
    if (stopped(0, k)) return {};
    branches.clear();
    const std::vector<PathState>& before = last < n ? states[last] : beginning;
    const auto cheapest = std::min_element(before.begin(), before.end(), cheaper);
    reach[k] = find_branches(goals_[k], cheapest->joints, branches);
    const PathGoal* const start = last < n && last + 1 == k ? &goals_[last] : nullptr;
    if (!branches.empty()) {
      advance(before, start, goals_[k], branches, states[k]);
      if (states[k].empty()) reach[k] = Reach::beyond_limits;
      if (last == n)
        for (PathState& state : states[k]) {
          state.jump = false;  // nothing is asked of the move to the first target
          if (!started) state.cost *= 1e-3;
        }
    }
    if (!states[k].empty()) last = k;
  }

  std::vector<int> chosen(n, -1);
  if (last < n) {
    const auto& end = states[last];
    int state = static_cast<int>(std::min_element(end.begin(), end.end(), cheaper) - end.begin());
    for (std::size_t k = last + 1; k-- > 0;) {
      if (states[k].empty()) continue;
      chosen[k] = state;
      state = states[k][static_cast<std::size_t>(state)].from;
    }
  }
  SolvedPath out;
  out.points.reserve(n);
  SolvedPoint before;
  bool any = false;
  for (std::size_t k = 0; k < n; ++k) {
    if (stopped(k, n)) return out;
    const auto target = static_cast<Index>(k);
    if (chosen[k] >= 0) {
      move_to(target, states[k][static_cast<std::size_t>(chosen[k])], any ? &before : nullptr, out);
      if (out.points.back().status <= PointStatus::off_path) {
        before = out.points.back();
        any = true;
      }
      continue;
    }
    SolvedPoint point{
        same_joints(arm_.joints, std::nan("")), target, false, PointStatus::not_found, std::nan(""), std::nan("")};
    switch (reach[k]) {
      case Reach::beyond_limits: point.status = PointStatus::beyond_limits; break;
      case Reach::proven_out: point.status = PointStatus::proven_out; break;
      case Reach::invalid_target: point.status = PointStatus::invalid_target; break;
      default: break;
    }
    out.points.push_back(point);
  }
  return out;
}

VERNIER_IMPL SolvedPath solve_path(const PathArm& arm, const std::vector<PathGoal>& goals,
                                   const PathSettings& settings) {
  return PathSearch(arm, goals, settings).run();
}

}  // namespace vernier::detail
