#pragma once

/// @file
/// Inverse kinematics of any model: damped least squares from a seed, within joint limits, best iterate kept.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/concepts.hpp"
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
  int moving_joints = N;             ///< only the first so many joints move, 1..N
};

/// The best joints found.
template <int N>
struct IkResult {
  JointVector<N> joints;      ///< within the limits, whatever the status
  IkStatus status;            ///< see `IkStatus`
  double position_error = 0;  ///< what is left [m]
  double rotation_error = 0;  ///< what is left [rad]; 0 where only a position was asked for
  int iterations = 0;         ///< evaluations of the model
};

namespace detail {

/// Levenberg-Marquardt on the joints; without `oriented` the position alone counts. Damping grows with the remaining
/// error, so steps stay small near singularities and convergence is quadratic at the solution. The model is reached
/// through a reference, so that this is compiled once for each N and not for each model.
/// @cite Levenberg 1944; Marquardt 1963; Nakamura and Hanafusa 1986; Sugihara 2011
template <int N>
IkResult<N> damped_inverse_kinematics(FunctionRef<PoseAndJacobian<N>(const JointVector<N>&)> model,
                                      const Isometry3& target, bool oriented, const JointVector<N>& seed,
                                      const IkOptions<N>& options) noexcept {
  using Square = Eigen::Matrix<double, N, N>;
  const int moving = std::clamp(options.moving_joints, 1, N);
  Vector6 weight = Vector6::Ones();
  weight.tail<3>().setConstant(oriented ? options.rotation_length : 0);

  struct Iterate {
    JointVector<N> q;
    Jacobian<N> jacobian;  // weighted
    Vector6 error;
    double cost;
  };
  const auto evaluate = [&](const JointVector<N>& q) {
    const PoseAndJacobian<N> at = model(q);
    Iterate it;
    it.q = q;
    it.error.template head<3>() = target.translation() - at.pose.translation();
    it.error.template tail<3>().setZero();
    if (oriented) it.error.template tail<3>() = log_so3(target.linear() * at.pose.linear().transpose());
    it.jacobian = weight.asDiagonal() * at.jacobian;
    it.cost = it.error.cwiseProduct(weight).squaredNorm();
    return it;
  };
  const auto finish = [](const Iterate& it, IkStatus status, int iterations) {
    return IkResult<N>{it.q, status, it.error.template head<3>().norm(), it.error.template tail<3>().norm(),
                       iterations};
  };
  const auto converged = [&](const Iterate& it) {
    return it.error.template head<3>().norm() <= options.position_tolerance &&
           it.error.template tail<3>().norm() <= options.rotation_tolerance;
  };

  JointVector<N> start = seed;
  start.head(moving) = options.limits.clamp(seed).head(moving);
  Iterate best = evaluate(start);
  double damping = 1e-3;  // in units of the cost
  int iterations = 1;
  if (!std::isfinite(best.cost)) return finish(best, IkStatus::stalled, iterations);
  while (!converged(best)) {
    JointVector<N> gradient = best.jacobian.transpose() * best.error.cwiseProduct(weight);
    Square normal = best.jacobian.transpose() * best.jacobian;
    const double scale = std::max(normal.trace(), 1e-12);
    for (int i = 0; i < N; ++i) {
      const bool held = i >= moving || (best.q(i) <= options.limits.lower(i) && gradient(i) < 0) ||
                        (best.q(i) >= options.limits.upper(i) && gradient(i) > 0);
      if (!held) continue;
      gradient(i) = 0;
      normal.row(i).setZero();
      normal.col(i).setZero();
      normal(i, i) = 1;
    }
    // Nothing to gain in any direction; and no motion below 10 rad (or m) would remove the error to first order, or it
    // is only the slow way out of a singularity.
    if (gradient.norm() <= std::min(1e-3 * std::sqrt(scale * best.cost), 0.1 * best.cost))
      return finish(best, IkStatus::unreachable, iterations);
    for (;;) {
      if (iterations >= options.max_iterations || damping > 1e12) return finish(best, IkStatus::stalled, iterations);
      Square damped = normal;
      damped.diagonal().array() += damping * best.cost + 1e-14 * scale;
      JointVector<N> step = damped.ldlt().solve(gradient);
      step *= std::min(1.0, 1.5 / step.norm());  // rad (or m): no turns for nothing near a singularity
      const JointVector<N> q = options.limits.clamp(best.q + step);
      JointVector<N> trial = best.q;
      trial.head(moving) = q.head(moving);
      const Iterate next = evaluate(trial);
      ++iterations;
      if (next.cost < best.cost) {  // false for NaN too
        best = next;
        damping = std::max(damping / 8, 1e-9);
        break;
      }
      damping = std::max(damping * 8, 1e-9);
    }
  }
  return finish(best, IkStatus::converged, iterations);
}

/// The same, from further starts until one converges; the best of all.
template <int N>
IkResult<N> restarted_inverse_kinematics(FunctionRef<PoseAndJacobian<N>(const JointVector<N>&)> model,
                                         const Isometry3& target, bool oriented, const JointVector<N>& seed,
                                         const IkOptions<N>& options) noexcept {
  IkResult<N> best = damped_inverse_kinematics<N>(model, target, oriented, seed, options);
  const auto error = [&](const IkResult<N>& r) {
    return std::hypot(r.position_error, options.rotation_length * r.rotation_error);
  };
  const int moving = std::clamp(options.moving_joints, 1, N);
  Rng rng;
  for (int k = 0; k < options.restarts && best.status != IkStatus::converged; ++k) {
    JointVector<N> start = seed;
    for (int i = 0; i < moving; ++i) {
      const bool bounded = std::isfinite(options.limits.upper(i) - options.limits.lower(i));
      start(i) = bounded ? rng.uniform(options.limits.lower(i), options.limits.upper(i))
                         : seed(i) + rng.uniform(-3.14159265358979323846, 3.14159265358979323846);
    }
    IkResult<N> found = damped_inverse_kinematics<N>(model, target, oriented, start, options);
    const int spent = best.iterations + found.iterations;
    if (found.status == IkStatus::converged || error(found) < error(best)) best = found;
    best.iterations = spent;
  }
  return best;
}

}  // namespace detail

/// Joints that bring the tool to a full pose, on the branch of the seed and near to it unless restarts are asked for.
/// Does not allocate.
/// @param model   any kinematic model
/// @param target  base_T_tool
/// @param seed    where to start [rad, m]; taken into the limits first
/// @param options tolerances, limits, iterations
/// @return        the best joints found and how it ended
/// @complexity    about five evaluations of pose and Jacobian from a near seed
template <KinematicModel M>
[[nodiscard]] IkResult<M::dof> inverse_kinematics(const M& model, const Isometry3& target,
                                                  const JointVector<M::dof>& seed,
                                                  const IkOptions<M::dof>& options = {}) noexcept {
  const auto evaluate = [&](const JointVector<M::dof>& q) { return model.pose_and_jacobian(q); };
  return detail::restarted_inverse_kinematics<M::dof>(evaluate, target, true, seed, options);
}

/// Joints that bring the tool to a position [m], whatever its orientation; otherwise as above.
template <KinematicModel M>
[[nodiscard]] IkResult<M::dof> inverse_kinematics(const M& model, const Vector3& target,
                                                  const JointVector<M::dof>& seed,
                                                  const IkOptions<M::dof>& options = {}) noexcept {
  Isometry3 pose = Isometry3::Identity();
  pose.translation() = target;
  const auto evaluate = [&](const JointVector<M::dof>& q) { return model.pose_and_jacobian(q); };
  return detail::restarted_inverse_kinematics<M::dof>(evaluate, pose, false, seed, options);
}

}  // namespace vernier
