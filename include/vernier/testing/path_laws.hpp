// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the corrected commands of a path must satisfy, as a list of violations.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "vernier/compensation/correct_path.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::testing {

/// How closely the laws are held.
struct PathLawOptions {
  double position_tolerance = 1e-6;  ///< by which a command may miss its target [m]
  double rotation_tolerance = 1e-6;  ///< likewise [rad]
  double line_slack = 1.1;           ///< between the places where a path is checked a line may be left by so much more
  static constexpr double joint_tolerance = 1e-6;  ///< between a path and its reverse [rad, m]
  bool reversible = true;                          ///< whether the arm has no hysteresis
};

namespace detail {

/// Where the arm is at q, coming from a command.
template <class Arm>
Isometry3 pose_from(const Arm& arm, const JointVector<Arm::dof>& from, const JointVector<Arm::dof>& q) {
  if constexpr (requires { arm.approached_from(from); }) {
    return arm.approached_from(from).pose(q);
  } else {
    return arm.pose(q);
  }
}

/// Largest distance from a line where a controller interpolates the nominal arm's pose between two commands, followed
/// in small steps; infinite where it leaps.
template <class Arm>
double deviation_from_line(const Arm& arm, const JointVector<Arm::dof>& coming, const JointVector<Arm::dof>& a,
                           const JointVector<Arm::dof>& b, const Isometry3& start, const Isometry3& end) {
  constexpr int steps = 16;
  const auto& nominal = nominal_of(arm);
  const Isometry3 first = nominal.pose(a), last = nominal.pose(b);
  const auto between = [](const Isometry3& x, const Isometry3& y, double s) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond(x.linear()).slerp(s, Eigen::Quaterniond(y.linear()));
    Isometry3 out(turn);
    out.translation() = (1 - s) * x.translation() + s * y.translation();
    return out;
  };
  double worst = 0;
  JointVector<Arm::dof> q = a;
  for (int k = 1; k < steps; ++k) {
    const double s = static_cast<double>(k) / steps;
    const auto found = inverse_kinematics(nominal, between(first, last, s), q);
    if (found.status != IkStatus::converged) return std::numeric_limits<double>::infinity();
    q = found.joints;
    const JointVector<Arm::dof> approach = vernier::detail::approach_on_the_way(coming, a, q);
    const Vector3 off = translation(pose_from(arm, approach, q)) - translation(between(start, end, s));
    if (std::isnan(off.norm())) return std::numeric_limits<double>::infinity();
    worst = (std::max)(worst, off.norm());
  }
  return worst;
}

}  // namespace detail

/// Laws of a path corrector, at one path.
/// @param correct callable as `correct(arm, targets, options)`, with a `CorrectedPath`
/// @param arm     the model, with `nominal()`
/// @param targets all of which can be met
/// @param options with which it is called
/// @param laws    tolerances
/// @return        one sentence a violation; empty where there is none
template <class Correct, KinematicModel Arm>
std::vector<std::string> path_violations(const Correct& correct, const Arm& arm,
                                         const std::vector<PathTarget<Arm::dof>>& targets,
                                         const PathOptions<Arm::dof>& options, const PathLawOptions& laws = {}) {
  constexpr int N = Arm::dof;
  std::vector<std::string> out;
  const auto expect = [&](bool holds, const auto&... text) {
    if (!holds) out.push_back(message(text...));
  };
  const CorrectedPath<N> path = correct(arm, targets, options);
  const CorrectedPath<N> again = correct(arm, targets, options);
  bool same = path.points.size() == again.points.size();
  for (std::size_t i = 0; same && i < path.points.size(); ++i)
    same = std::memcmp(path.points[i].command.data(), again.points[i].command.data(), sizeof(double) * N) == 0;
  expect(same, "a repeated call gives other commands");

  Index next = 0;
  JointVector<N> before = options.start, coming = options.start;  // of the target before
  Index pieces = 0;
  for (const PathPoint<N>& p : path.points) {
    expect(p.target == next, "a point belongs to target ", p.target, " where ", next, " is next");
    if (p.target != next || next >= static_cast<Index>(targets.size())) break;
    const PathTarget<N>& target = targets[static_cast<std::size_t>(next)];
    expect(p.status == PointStatus::met, "target ", next, " is not met");
    expect(options.limits.contains(p.command), "target ", next, ": a command is beyond the limits");
    ++pieces;
    if (!p.inserted) {
      // the line as a whole, for its inserted points divide it equally
      if (target.motion == Motion::linear && next > 0) {
        const Isometry3& start = targets[static_cast<std::size_t>(next - 1)].pose;
        const PathPoint<N>* const first = &p - pieces;  // the point before the line
        const auto n = static_cast<double>(pieces);
        JointVector<N> from = coming;
        for (const PathPoint<N>* piece = first; piece != &p; ++piece) {
          const JointVector<N>&a = piece->command, &b = (piece + 1)->command;
          const auto k = static_cast<double>(piece - first);
          const Isometry3 s = interpolated(start, target.pose, k / n);
          const Isometry3 e = interpolated(start, target.pose, (k + 1) / n);
          expect((b - a).cwiseAbs().maxCoeff() <= options.max_joint_step, "target ", next, ": a joint leaps");
          expect(detail::deviation_from_line(arm, from, a, b, s, e) <= laws.line_slack * options.tolerance, "target ",
                 next, ": the tool leaves its line");
          from = vernier::detail::approach_on_the_way(from, a, b);
        }
        if (pieces > 1) before = from;
      }
      const Isometry3 there = detail::pose_from(arm, before, p.command);
      const Vector3 missed = translation(there) - translation(target.pose);
      expect(missed.norm() <= laws.position_tolerance, "target ", next, " is missed");
      if constexpr (N >= 6)
        expect(rotation_difference(rotation(there), rotation(target.pose)).norm() <= laws.rotation_tolerance, "target ",
               next, ": its orientation is missed");
      coming = before;
      pieces = 0;
      ++next;
    }
    before = p.command;
  }
  expect(next == static_cast<Index>(targets.size()), next, " of ", targets.size(), " targets have a point");
  if (!laws.reversible || !out.empty() || path.points.empty()) return out;

  std::vector<PathTarget<N>> back;
  for (std::size_t i = targets.size() - 1; i-- > 0;) {
    back.push_back(targets[i]);
    back.back().motion = targets[i + 1].motion;
  }
  if (back.empty()) return out;
  back.insert(back.begin(), targets.back());
  back.front().motion = Motion::joint;
  PathOptions<N> reversed = options;
  reversed.start = path.points.back().command;
  const CorrectedPath<N> returned = correct(arm, back, reversed);
  expect(returned.points.size() == path.points.size(), "the way back has ", returned.points.size(), " points, the way ",
         path.points.size());
  if (returned.points.size() != path.points.size()) return out;
  double worst = 0;
  for (std::size_t i = 0; i < path.points.size(); ++i)
    worst = (std::max)(
        worst, (path.points[i].command - returned.points[path.points.size() - 1 - i].command).cwiseAbs().maxCoeff());
  expect(worst <= laws.joint_tolerance, "the way back differs from the way by ", worst);
  return out;
}

}  // namespace vernier::testing
