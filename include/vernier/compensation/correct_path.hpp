// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Corrected commands along a whole path: branches and whole turns chosen for all of it, linear moves kept straight.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "vernier/compensation/detail/path_solver.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"

namespace vernier {

/// A target of a path.
template <int N>
struct PathTarget {
  Isometry3 pose;  ///< base_T_tool in the frames of the model
  /// Joints near the command, which choose the branch [rad, m]; not finite where any branch will do.
  JointVector<N> joints = JointVector<N>::Constant(std::numeric_limits<double>::quiet_NaN());
  Motion motion = Motion::joint;  ///< how the arm moves there
};

/// Options of `correct_path`.
template <int N>
struct PathOptions {
  JointLimits<N> limits{};             ///< of the commands; equal ones hold a joint, e.g. a rail
  double tolerance = 0.05e-3;          ///< distance of the tool from the line of a linear move [m]
  double rotation_tolerance = 0.2e-3;  ///< deviation of its orientation from the one in between [rad]
  double max_joint_step = 0.5;         ///< largest change of a joint between commands of a linear move [rad, m]
  int max_inserted = 127;              ///< most points that are inserted in one linear move
  /// Each target outside the measured joint ranges, where the gate is 0, counts as so much joint motion in the choice
  /// of branches [rad, m]: inside, the model predicts better.
  double extrapolation_cost = 10;
  /// Whether each command is for the approach from the one before; else it is for the middle of all approaches.
  bool approach = true;
  /// Where the arm is before it moves to the first target [rad, m]; not finite where unknown. That move is no linear
  /// one.
  JointVector<N> start = JointVector<N>::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Who watches; must outlive the call. Told before each target's branches are looked for (`Progress::evaluations` of
  /// targets), and before its command (`Progress::generation`). A stop ends the path: it has the points until there.
  ObserverRef observer{};
};

/// A corrected command of a path.
template <int N>
struct PathPoint {
  JointVector<N> command;  ///< [rad, m]; not finite where there is none
  Index target;            ///< counted from 0: the one it reaches, or towards which it was inserted
  bool inserted;           ///< whether it lies on the way to the target, not at it
  PointStatus status;      ///< what became of it
  double position_error;   ///< what the model predicts to be left [m]
  double rotation_error;   ///< likewise [rad]
  double deviation;        ///< of the tool from the line of the linear move to it, as the model predicts [m]
  double ends_only;        ///< deviation of the whole linear move to a target, were its ends alone corrected [m]
  double gate;             ///< share of the learned correction that was used
  SingularityDistances singularities;  ///< of the nominal arm; not known without a closed form
};

/// Corrected commands of a path, in their order.
template <int N>
struct CorrectedPath {
  std::vector<PathPoint<N>> points;  ///< targets and inserted points
  double before = 0;  ///< largest deviation from the lines of linear moves, were the ends alone corrected [m]
  double after = 0;   ///< largest deviation with the inserted points [m]

  /// Number of points of a kind: those of targets.
  Index count(PointStatus status) const {
    Index out = 0;
    for (const PathPoint<N>& point : points) out += !point.inserted && point.status == status ? 1 : 0;
    return out;
  }
  /// Number of inserted points.
  Index inserted() const {
    Index out = 0;
    for (const PathPoint<N>& point : points) out += point.inserted ? 1 : 0;
    return out;
  }
  /// The first point that is not met as asked; null where all are.
  const PathPoint<N>* first_failure() const {
    for (const PathPoint<N>& point : points)
      if (point.status != PointStatus::met) return &point;
    return nullptr;
  }
};

namespace detail {

/// Stands for a closed form where there is none: branches are followed from target to target.
struct NoClosedForm {};

template <class Roots, class Arm>
CorrectedPath<Arm::dof> correct_path(const Arm& arm, const Roots& closed_form,
                                     const std::vector<PathTarget<Arm::dof>>& targets,
                                     const PathOptions<Arm::dof>& options) {
  constexpr int N = Arm::dof;
  constexpr bool branches_known = !std::is_same_v<Roots, NoClosedForm>;
  static_assert(N <= max_arm_joints, "correct_path: arms of up to nine joints");
  using Joints = JointVector<N>;
  demand(options.tolerance > 0 && options.rotation_tolerance > 0 && options.max_joint_step > 0 &&
             options.max_inserted >= 0,
         "correct_path: tolerances and steps must be positive");
  const auto& nominal = nominal_of(arm);
  IkOptions<N> tight;
  tight.max_iterations = 30;
  tight.position_tolerance = tight.rotation_tolerance = 1e-8;
  IkOptions<N> within = tight;
  within.limits = options.limits;
  for (int j = 0; j < N; ++j)  // the nominal arm is looked at beyond limits, but a held joint stays
    if (same_value(options.limits.lower(j), options.limits.upper(j)))
      tight.limits.lower(j) = tight.limits.upper(j) = options.limits.lower(j);

  // one or two joints go as near as they can
  const auto near_enough = [](IkStatus status) {
    return status == IkStatus::converged || (N < 3 && status == IkStatus::unreachable);
  };
  const auto solve = [&](const auto& model, const Isometry3& target, const Joints& seed, const IkOptions<N>& ik) {
    if constexpr (N >= 6) {
      return inverse_kinematics(model, target, seed, ik);
    } else {
      return inverse_kinematics(model, translation(target), seed, ik);
    }
  };
  const auto coming_from = [&](const Joints& from, const auto& use) {
    if constexpr (requires { arm.approached_from(from); }) {
      if (options.approach) return use(arm.approached_from(from));
    }
    return use(arm);
  };
  const auto find_branches = [&](const Isometry3& target, const PathJoints& close_to, std::vector<PathBranch>& out) {
    if constexpr (branches_known) {
      const Branches<N> found =
          all_branches(closed_form, arm, target, {.limits = options.limits, .close_to = Joints(close_to)});
      for (const Branch<N>& branch : found) out.push_back({branch.joints, branch.singularities.branch()});
      return found.reach;
    } else {
      const IkResult<N> found = solve(arm, target, Joints(close_to), within);
      if (!near_enough(found.status)) return Reach::not_found;
      out.push_back({found.joints, 0});
      return Reach::met;
    }
  };
  const auto correct = [&](const Isometry3& target, const PathJoints& from, PathJoints& command, double* errors) {
    const IkResult<N> found =
        coming_from(Joints(from), [&](const auto& model) { return solve(model, target, Joints(command), within); });
    command = found.joints;
    errors[0] = found.position_error;
    errors[1] = found.rotation_error;
    return near_enough(found.status);
  };
  const auto pose = [&](const PathJoints& q, const PathJoints& from) {
    return coming_from(Joints(from), [&](const auto& model) { return model.pose(Joints(q)); });
  };
  const auto nominal_pose = [&](const PathJoints& q) { return nominal.pose(Joints(q)); };
  const auto nominal_joints = [&](const Isometry3& target, PathJoints& q) {
    const IkResult<N> found = solve(nominal, target, Joints(q), tight);
    q = found.joints;
    return near_enough(found.status);
  };
  const auto distances = [&](const Joints& q) {
    if constexpr (branches_known) {
      return closed_form.distances(q);
    } else {
      return SingularityDistances{.known = false};
    }
  };
  const auto cost = [&](const PathJoints& q) {
    if constexpr (requires { arm.gate(Joints(q)); }) return options.extrapolation_cost * (1 - arm.gate(Joints(q)));
    return 0.0;
  };
  const auto branch_id = [&](const PathJoints& q) { return branches_known ? distances(Joints(q)).branch() : 0; };

  std::vector<PathGoal> goals;
  goals.reserve(targets.size());
  for (const PathTarget<N>& target : targets)
    goals.push_back(
        {target.pose, detail::all_finite(target.joints) ? PathJoints(target.joints) : PathJoints(), target.motion});
  const SolvedPath solved = solve_path(
      {N, N >= 6 ? 6 : 3, find_branches, correct, pose, nominal_pose, nominal_joints, cost, branch_id}, goals,
      {options.tolerance, N >= 6 ? options.rotation_tolerance : std::numeric_limits<double>::infinity(),
       options.max_joint_step, options.max_inserted, options.limits.lower, options.limits.upper, options.start,
       options.observer});
  CorrectedPath<N> out;
  out.before = solved.before;
  out.after = solved.after;
  out.points.reserve(solved.points.size());
  for (const SolvedPoint& from : solved.points) {
    const Joints command = from.command;
    PathPoint<N> point{command,
                       from.target,
                       from.inserted,
                       from.status,
                       from.position_error,
                       from.rotation_error,
                       from.deviation,
                       from.ends_only,
                       1,
                       {}};
    if (detail::all_finite(command)) {
      if constexpr (requires { arm.gate(command); }) point.gate = arm.gate(command);
      point.singularities = distances(command);
    }
    out.points.push_back(point);
  }
  return out;
}

}  // namespace detail

/// Corrected commands for a whole path; positions alone of an arm of fewer than six joints, as near as they can come of
/// one or two joints. Branches and whole turns
/// are chosen for all targets together, for the shortest time of joint moves within the measured joint ranges (dynamic
/// programming); a linear move stays on its branch. Between two commands a controller moves the tool of the *nominal*
/// arm along a line, the real one beside it: points are inserted, equally spaced, until it stays within the tolerances.
/// Each command is for the approach from the command before; on the way of a linear move, each joint comes from where
/// it turned round last.
/// @param arm         an identified or calibrated arm: a kinematic model with `nominal()`, the arm as the controller
/// knows
///                    it, in the same frames; with `approached_from` where its joints have hysteresis
/// @param closed_form of the nominal arm in the same frames, or `GeneralSixAxis`
/// @param targets     in the frames of the model
/// @param options     tolerances, limits, start
/// @return            points in order, fewer where the observer stopped it; what cannot be met as asked has a status
/// that says so, and no move jumps silently
/// @throws std::invalid_argument for options that are not positive
/// @complexity        O(targets)
template <KinematicModel Arm, BranchRoots Roots>
  requires(Roots::dof == Arm::dof)
[[nodiscard]] CorrectedPath<Arm::dof> correct_path(const Arm& arm, const Roots& closed_form,
                                                   const std::vector<PathTarget<Arm::dof>>& targets,
                                                   const PathOptions<Arm::dof>& options = {}) {
  return detail::correct_path(arm, closed_form, targets, options);
}
/// Corrects a path of an arm without closed form: its branch is that of the joints of a target, else of the point
/// before; at the first target of `start`.
template <KinematicModel Arm>
[[nodiscard]] CorrectedPath<Arm::dof> correct_path(const Arm& arm, const std::vector<PathTarget<Arm::dof>>& targets,
                                                   const PathOptions<Arm::dof>& options = {}) {
  return detail::correct_path(arm, detail::NoClosedForm{}, targets, options);
}

}  // namespace vernier
