// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Corrected commands along a path, for an arm whose number of joints is known at run time.

#include <vector>

#include "vernier/core/fit_options.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/kinematics/detail/branch_refinement.hpp"

namespace vernier {

/// How the arm moves to a target.
enum class Motion {
  joint,   ///< joint by joint, on any way
  linear,  ///< the tool along a straight line, its orientation turning about a fixed axis
};

/// What became of a point of a path.
enum class PointStatus {
  met,
  jump,            ///< met, but the move to it is not the one asked for: it leaves the branch, or a joint leaps
  off_path,        ///< met, but the linear move to it stays farther from the line than the tolerance
  beyond_limits,   ///< joint limits exclude it
  not_found,       ///< no joint values were found
  proven_out,      ///< farther away than the real arm is long
  invalid_target,  ///< not finite, or no rotation
};

namespace detail {

/// Joint values; no allocation.
using PathJoints = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_arm_joints, 1>;

/// A target; `joints` has no entries where any branch will do.
struct PathGoal {
  Isometry3 pose;
  PathJoints joints;
  Motion motion;
};

/// One branch at a target.
struct PathBranch {
  PathJoints joints;
  int id;
};

/// What the path's solver has to know of an arm.
struct PathArm {
  int joints;
  int equations;  ///< of a target: 6, or 3 where positions alone are met
  /// Branches of the arm, whatever the direction of approach, at a target: appended; the reach is returned.
  FunctionRef<Reach(const Isometry3& target, const PathJoints& close_to, std::vector<PathBranch>& out)> branches;
  /// The command that brings the arm to a target, coming from another command; which may be not finite.
  FunctionRef<bool(const Isometry3& target, const PathJoints& from, PathJoints& command, double* errors)> correct;
  /// Where the arm is at joint values, coming from a command.
  FunctionRef<Isometry3(const PathJoints& joints, const PathJoints& from)> pose;
  /// The nominal arm, as the controller knows it, and its inverse kinematics near joint values.
  FunctionRef<Isometry3(const PathJoints& joints)> nominal_pose;
  FunctionRef<bool(const Isometry3& target, PathJoints& joints)> nominal_joints;
  /// Cost of being at joint values.
  FunctionRef<double(const PathJoints& joints)> cost;
  /// Bits of singularity signs.
  FunctionRef<int(const PathJoints& joints)> branch_id;
};

/// Options with their number of joints known at run time.
struct PathSettings {
  double tolerance, rotation_tolerance, max_joint_step;
  int max_inserted;
  PathJoints lower, upper, start;
  ObserverRef observer{};  ///< see `PathOptions`
};

/// A command of the path.
struct SolvedPoint {
  PathJoints command;
  Index target;
  bool inserted;
  PointStatus status;
  double position_error, rotation_error;  ///< what is left [m, rad]
  double deviation = 0;                   ///< of the move to it from its line [m]; 0 for joint moves
  PathJoints coming{};                    ///< joint values from which it is approached
  double ends_only = 0;                   ///< of the whole linear move, were its ends alone corrected [m]
};

/// All commands, and what linear moves would have been without inserted points.
struct SolvedPath {
  std::vector<SolvedPoint> points;
  double before = 0, after = 0;  ///< largest deviation of linear moves [m]
};

/// All commands; those of the first targets alone where the observer stops it.
VERNIER_API SolvedPath solve_path(const PathArm& arm, const std::vector<PathGoal>& goals, const PathSettings& settings);

/// The joint values from which an arm comes to q on its way from a command, as hysteresis counts: a joint that goes on
/// in its direction still comes from where it came to the command; one that turned round comes from the command, beyond
/// a transition in which its hysteresis turns round, too.
/// @param coming  joint values from which it came to the command; not finite where unknown
VERNIER_API PathJoints approach_on_the_way(const PathJoints& coming, const PathJoints& command, const PathJoints& q);

}  // namespace detail
}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/compensation/detail/path_solver.ipp"
#endif
