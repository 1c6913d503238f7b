// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Newton's method from the roots of a nominal arm to the branches of a real one.

#include <algorithm>
#include <array>
#include <string>

#include "vernier/core/function_ref.hpp"
#include "vernier/kinematics/detail/six_axes.hpp"

namespace vernier {

/// What became of a target.
enum class Reach {
  met,             ///< at least one branch within limits
  beyond_limits,   ///< branches, but none within limits
  not_found,       ///< no branch was found; there may be one
  proven_out,      ///< farther away than the real arm is long: there is none
  invalid_target,  ///< not finite, or no rotation
};

namespace detail {

/// Most joints of an arm whose branches are found: six that move, and one that is held.
inline constexpr int most_branch_joints = 7;

/// A target and a model of run-time size.
struct BranchProblem {
  int joints;                                                                   ///< 6 or 7
  std::array<int, 6> moving;                                                    ///< those that move
  FunctionRef<void(const double* q, Isometry3& pose, double* jacobian)> model;  ///< jacobian 6 x 6, of those that move
  const Isometry3& target;
  const double *lower, *upper, *close_to;
  double rotation_length;
  double lipschitz;  ///< of the Jacobian, see `lipschitz_bound`
};

/// Joint values that meet the target, see `Branch`.
struct FoundBranch {
  double q[most_branch_joints];
  double position_error, rotation_error, sigma_min, radius;
  int iterations;
};

/// Branches that were found, no two alike.
struct BranchSet {
  static constexpr int capacity = 24;
  std::array<FoundBranch, capacity> branches;
  int count = 0;
  int seeds_lost = 0;
  static constexpr int max_stalled = 8;
  std::array<double, most_branch_joints>
      stalled[max_stalled];  ///< where Newton's method came from seeds that were lost
  int stalled_count = 0;
  bool suspicious = false;  ///< whether a seed was beyond a boundary, lost, or not alone at its solution

  /// Whether some may be missing: branches come in pairs, and may change their number next to a singularity.
  VERNIER_API bool may_be_incomplete() const {
    return suspicious || count % 2 != 0 ||
           std::any_of(branches.begin(), branches.begin() + count, [](const auto& b) { return b.sigma_min < 0.002; });
  }
  /// Adds the branch to which Newton's method leads.
  /// @param margin  of the seed, see `SixAxisRoot`
  /// @param sampled whether the seed is one of many, which need not lead to a branch
  VERNIER_API void refine(const BranchProblem& problem, const double* seed, double margin, bool sampled) noexcept;
  /// Looks for missing ones beyond the folds next to those found; computes how sure each is.
  VERNIER_API void complete(const BranchProblem& problem) noexcept;
};

/// Bound of the Lipschitz constant of the derivative of the error of a geometric arm that is so long, rotations
/// weighted as lengths.
/// @cite Kantorovich and Akilov 1982
VERNIER_API double lipschitz_bound(double arm_length, double rotation_length) noexcept;
/// Whether a target is finite and its linear part a rotation, to 1e-9.
VERNIER_API bool is_pose(const Isometry3& target) noexcept;
/// A sentence for a target.
VERNIER_API std::string describe_reach(Reach reach, int branches, double margin);
/// `angle` plus whole turns: nearest to `close_to` between the bounds; nearest to the bounds where no turn is between
/// them.
VERNIER_API double nearest_turn(double angle, double close_to, double lower, double upper) noexcept;

}  // namespace detail
}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/branch_refinement.ipp"
#endif
