// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// All branches of the inverse kinematics of an arm that is near a nominal one: identified, with joint errors, learned.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/detail/branch_refinement.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace vernier {

/// Options of `all_branches`.
template <int N>
struct BranchOptions {
  JointLimits<N> limits{};  ///< of the joints
  /// Of the whole turns by which a joint's value may differ, the nearest to this within the limits is taken [rad].
  /// Where a branch meets a singularity and a joint's value is arbitrary, it is this.
  JointVector<N> close_to = JointVector<N>::Zero();
  /// So near to a singularity of the nominal arm, branches may lie anywhere around it [m, rad]: a few
  /// times what the model differs from the nominal arm.
  double near_singularity = 0.03;
  double rotation_length = 0.3;  ///< 1 rad of rotation weighs as many metres in `sigma_min` and `radius` [m]
};

/// One branch.
template <int N>
struct Branch {
  JointVector<N> joints;               ///< [rad]
  SingularityDistances singularities;  ///< of the nominal arm there; zero without a closed form
  double position_error;               ///< what is left [m]
  double rotation_error;               ///< what is left [rad]
  double sigma_min;                    ///< smallest singular value of the Jacobian [m/rad]; zero in a singularity
  /// Around these joint values there is one exact solution, and no other within this distance [rad, Euclidean]; 0 where
  /// nothing can be said. Beyond rounding errors (Newton-Kantorovich).
  double radius;
  bool proven;         ///< whether `radius` is a proof: the model bounds the Lipschitz constant of its Jacobian
  int iterations;      ///< evaluations of the model
  bool within_limits;  ///< whether all joints are
};

/// All branches of one target; a range of `Branch`. No allocation.
template <int N>
struct Branches {
  /// Largest number of branches.
  static constexpr int capacity = detail::BranchSet::capacity;
  std::array<Branch<N>, capacity> branches;  ///< the first `count` are set
  int count = 0;                             ///< number of branches
  Reach reach = Reach::not_found;            ///< what became of the target
  /// Where no branch was found: by how much the target lies beyond a boundary of the nominal arm, relative to that; or
  /// of the real arm [m], where it is `proven_out`. Infinite where nothing is known.
  double margin = std::numeric_limits<double>::infinity();
  int seeds_lost = 0;  ///< roots of the nominal arm from which none was found

  /// The first branch.
  const Branch<N>* begin() const { return branches.data(); }
  /// Behind the last branch.
  const Branch<N>* end() const { return branches.data() + count; }
  /// The branch within limits whose largest joint difference from q is smallest; null where there is none.
  const Branch<N>* nearest(const JointVector<N>& q) const noexcept {
    const Branch<N>* best = nullptr;
    double least = 0;
    for (const Branch<N>& branch : *this) {
      double largest = 0;
      for (int j = 0; j < N; ++j) largest = (std::max)(largest, std::abs(branch.joints(j) - q(j)));
      if (!branch.within_limits || (best != nullptr && !(largest < least))) continue;
      best = &branch;
      least = largest;
    }
    return best;
  }
  /// What became of the target, in a sentence.
  std::string describe() const { return detail::describe_reach(reach, count, margin); }
};

/// Joint values that differ by whole turns from given ones: the nearest to other ones within limits. A joint that no
/// turn brings within its limits takes the nearest turn to its limits.
template <int N>
JointVector<N> nearest_turns(const JointVector<N>& joints, const JointVector<N>& close_to,
                             const JointLimits<N>& limits) noexcept {
  JointVector<N> out;
  for (int j = 0; j < N; ++j) out(j) = detail::nearest_turn(joints(j), close_to(j), limits.lower(j), limits.upper(j));
  return out;
}

namespace detail {

/// Whether a model is geometric, of revolute joints alone.
template <KinematicModel M>
bool all_revolute([[maybe_unused]] const M& model) noexcept {
  if constexpr (NominalArm<M>) {
    const auto framed = in_frames(model);
    bool out = true;
    for (int i = 0; i < M::dof; ++i) out = out && framed.model().row(i).joint == JointType::revolute;
    return out;
  } else {
    return false;
  }
}

}  // namespace detail

/// All branches of the inverse kinematics of a model whose nominal arm has a closed form: Newton's method from each of
/// its roots, and across the fold where two branches meet. Of seven joints the held one stays.
/// @param nominal roots of the nominal arm, in the same frames as the model: `ClosedForm(model.nominal())`, or
///                `GeneralSixAxis` where it has no closed form
/// @param model   any kinematic model near the nominal arm, e.g. by 1 mm and a few mrad
/// @param target  base_T_tool in the frames of the model
/// @param options limits, turns
/// @return        the branches; where there are none, a target farther away than the arm is long is `proven_out`: of a
///                geometric arm, and of a model that has `reach_sphere()`
/// @complexity    the roots, and per branch three evaluations of pose and Jacobian; no allocation
/// @cite Kantorovich and Akilov 1982
template <BranchRoots Roots, KinematicModel M>
  requires(Roots::dof == M::dof)
[[nodiscard]] Branches<M::dof> all_branches(const Roots& nominal, const M& model, const Isometry3& target,
                                            const BranchOptions<M::dof>& options = {}) noexcept {
  constexpr int N = M::dof;
  static_assert(N <= detail::most_branch_joints, "all_branches: arms of up to seven joints");
  const detail::MovingJoints<N> moving(HeldJoint{nominal.held_joint(), 0});
  Branches<N> out;
  if (!detail::is_pose(target)) {
    out.reach = Reach::invalid_target;
    return out;
  }
  const InverseRoots<N> roots = nominal.roots(target, options.close_to, options.near_singularity);
  const auto evaluate = [&](const double* q, Isometry3& pose, double* jacobian) {
    const PoseAndJacobian<N> at = model.pose_and_jacobian(JointVector<N>(q));
    pose = at.pose;
    for (int k = 0; k < 6; ++k)
      std::copy_n(at.jacobian.data() + 6 * moving.index[static_cast<std::size_t>(k)], 6, jacobian + 6 * k);
  };
  const bool geometric = detail::all_revolute(model);  // what a rail reaches depends on where it is
  const double length = [&] {
    if constexpr (NominalArm<M>)
      if (geometric) return detail::arm_length(detail::arm_axes(model));
    return nominal.arm_length();
  }();
  const detail::BranchProblem problem{N,
                                      moving.index,
                                      evaluate,
                                      target,
                                      options.limits.lower.data(),
                                      options.limits.upper.data(),
                                      options.close_to.data(),
                                      options.rotation_length,
                                      detail::lipschitz_bound(length, options.rotation_length)};

  detail::BranchSet found;
  const auto refine = [&](bool sampled) {
    for (const InverseRoot<N>& root : roots)
      if (root.sampled == sampled) found.refine(problem, root.joints.data(), root.margin, sampled);
  };
  refine(false);
  // Roots beyond a boundary of the nominal arm were left out; next to a singularity that of the real arm lies far off.
  const bool left_out = std::isfinite(roots.nearest_margin);
  if (left_out || found.may_be_incomplete()) refine(true);
  found.complete(problem);
  out.count = found.count;
  out.seeds_lost = found.seeds_lost;
  bool within = false;
  for (int k = 0; k < found.count; ++k) {
    const detail::FoundBranch& from = found.branches[static_cast<std::size_t>(k)];
    Branch<N>& to = out.branches[static_cast<std::size_t>(k)];
    to.joints = JointVector<N>(from.q);
    to.singularities = nominal.distances(to.joints);
    to.position_error = from.position_error;
    to.rotation_error = from.rotation_error;
    to.sigma_min = from.sigma_min;
    to.radius = from.radius;
    to.proven = geometric && from.radius > 0;
    to.iterations = from.iterations;
    to.within_limits = options.limits.contains(to.joints);
    within = within || to.within_limits;
  }
  if (out.count > 0) {
    out.reach = within ? Reach::met : Reach::beyond_limits;
    out.margin = 0;
  } else {
    out.margin = roots.nearest_margin;
    for (const InverseRoot<N>& root : roots) out.margin = (std::min)(out.margin, root.margin);
    double excess = 0;
    if constexpr (NominalArm<M>) {
      if (geometric) excess = detail::reach_excess(detail::arm_axes(model), target);
    } else if constexpr (requires { model.reach_sphere(); }) {
      const ReachSphere sphere = model.reach_sphere();
      excess = (translation(target) - sphere.centre).norm() - sphere.radius;
    }
    if (excess > 0) {
      out.reach = Reach::proven_out;
      out.margin = excess;
    }
  }
  return out;
}

}  // namespace vernier
