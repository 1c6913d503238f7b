// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Inverse kinematics of any model: damped least squares from a seed, within joint limits, best iterate kept.

#include <algorithm>

#include "vernier/core/checked_joints.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/kinematics/detail/explain_model.hpp"
#include "vernier/kinematics/dh.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace vernier {

/// How a search for joint values ended.
enum class IkStatus {
  converged,    ///< both tolerances met
  stalled,      ///< the iterations ran out, or no step made progress
  unreachable,  ///< no small motion within the limits brings the tool nearer: the target lies out of reach from this
                ///< seed
};

/// Options of `inverse_kinematics`.
template <int N>
struct IkOptions {
  JointLimits<N> limits{};           ///< never left; unbounded by default
  double position_tolerance = 1e-9;  ///< [m]
  double rotation_tolerance = 1e-9;  ///< [rad]
  double rotation_length = 0.3;      ///< 1 rad of rotation error weighs as many metres [m]
  int max_iterations = 200;          ///< evaluations of the model, from each start
  int restarts = 0;                  ///< further starts where one does not converge: drawn within the limits, half a
                                     ///< turn (pi m) to either side of the seed where there are none; always the
                                     ///< same ones. The solution may then lie on another branch than the seed.
  int moving_joints = N;             ///< number of leading joints that move, 1..N
};

/// The best joints found.
template <int N>
struct IkResult {
  JointVector<N> joints;      ///< within the limits, whatever the status
  IkStatus status;            ///< see `IkStatus`
  double position_error = 0;  ///< what is left [m]
  double rotation_error = 0;  ///< remaining [rad]; 0 where the target is a position
  int iterations = 0;         ///< evaluations of the model
};

namespace detail {

/// A problem whose number of joints is known at run time.
struct IkProblem {
  int joints, moving_joints, restarts, max_iterations;
  FunctionRef<void(const double* q, Isometry3& pose, double* jacobian)> model;  ///< jacobian 6 x joints
  const Isometry3& target;
  bool oriented;  ///< whether the orientation is a target too
  const double *seed, *lower, *upper;
  double position_tolerance, rotation_tolerance, rotation_length;
};

/// Everything of an `IkResult` but the joints.
struct IkOutcome {
  IkStatus status;
  double position_error, rotation_error;
  int iterations;
};

/// Levenberg-Marquardt on the joints, from the seed and then from further starts until one converges. Damping grows
/// with the remaining error, so steps stay small near singularities and convergence is quadratic at the solution.
/// @cite Levenberg 1944; Marquardt 1963; Nakamura and Hanafusa 1986; Sugihara 2011
VERNIER_API IkOutcome solve_inverse_kinematics(const IkProblem& problem, double* joints) noexcept;

/// `solve_inverse_kinematics` for a model whose number of joints is known at compile time.
template <KinematicModel M>
IkResult<M::dof> inverse_kinematics(const M& model, const Isometry3& target, bool oriented,
                                    const JointVector<M::dof>& seed, const IkOptions<M::dof>& options) noexcept {
  constexpr int N = M::dof;
  static_assert(N <= max_joints);
  const auto evaluate = [&](const double* q, Isometry3& pose, double* jacobian) {
    const PoseAndJacobian<N> at = model.pose_and_jacobian(JointVector<N>(q));
    pose = at.pose;
    std::copy_n(at.jacobian.data(), 6 * N, jacobian);
  };
  IkResult<N> out;
  const IkOutcome outcome =
      solve_inverse_kinematics({N, options.moving_joints, options.restarts, options.max_iterations, evaluate, target,
                                oriented, seed.data(), options.limits.lower.data(), options.limits.upper.data(),
                                options.position_tolerance, options.rotation_tolerance, options.rotation_length},
                               out.joints.data());
  out.status = outcome.status;
  out.position_error = outcome.position_error;
  out.rotation_error = outcome.rotation_error;
  out.iterations = outcome.iterations;
  return out;
}

}  // namespace detail

/// Joints that bring the tool to a full pose, on the branch of the seed and near to it unless `restarts` is set.
/// Does not allocate.
/// @param model   any kinematic model
/// @param target  base_T_tool
/// @param seed    where to start [rad, m]; clamped to the limits first
/// @param options tolerances, limits, iterations
/// @return        the best joints found and how it ended
/// @complexity    about five evaluations of pose and Jacobian from a near seed
template <KinematicModel M>
[[nodiscard]] IkResult<M::dof> inverse_kinematics(const M& model, const Isometry3& target,
                                                  const JointVector<M::dof>& seed,
                                                  const IkOptions<M::dof>& options = {}) noexcept {
  return detail::inverse_kinematics(model, target, true, seed, options);
}

/// Joints that bring the tool to a position [m], whatever its orientation; otherwise as above.
template <KinematicModel M>
[[nodiscard]] IkResult<M::dof> inverse_kinematics(const M& model, const Vector3& target,
                                                  const JointVector<M::dof>& seed,
                                                  const IkOptions<M::dof>& options = {}) noexcept {
  const Isometry3 pose = rigid_motion(Matrix3::Identity(), target);
  return detail::inverse_kinematics(model, pose, false, seed, options);
}

/// Joints that bring the tool to a pose or a position, from a seed whose size is known at run time only.
/// @throws std::invalid_argument on another number of joint values
template <KinematicModel M, class Target, SizedAtRunTime Seed>
[[nodiscard]] IkResult<M::dof> inverse_kinematics(const M& model, const Target& target, const Seed& seed,
                                                  const IkOptions<M::dof>& options = {}) {
  return inverse_kinematics(model, target, detail::joint_vector<M::dof>(seed), options);
}

/// Does not compile, and says what the model lacks.
template <class M, class Target>
  requires(!KinematicModel<M>)
IkResult<M::dof> inverse_kinematics(const M&, const Target&, const JointVector<M::dof>&,
                                    const IkOptions<M::dof>& = {}) {
  static_assert(detail::explain_kinematic_model<M>());
  return {};
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/inverse_kinematics.ipp"
#endif
