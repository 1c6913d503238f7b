// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/small_systems.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"

namespace vernier::detail {

/// Joints in the course of an inverse kinematics, and the model there. Entries beyond the number of joints are unused.
struct IkIterate {
  double q[max_joints];
  double jacobian[6 * max_joints];  ///< rows weighted
  Vector6 error;                    ///< rows weighted
  double position_error, rotation_error;
  double cost;  ///< squared norm of the weighted error
};

/// Starts at `next.q`; the iterates change places, the better one is `*best`.
VERNIER_LOCAL IkOutcome damped_least_squares(const IkProblem& problem, IkIterate* best, IkIterate* next,
                                             double* joints) noexcept {
  const int n = problem.joints, moving = std::clamp(problem.moving_joints, 1, n), rows = problem.oriented ? 6 : 3;
  // With fewer equations than joints the step is J' (J J' + d)^-1 e = (J' J + d)^-1 J' e, without rounding errors along
  // the null space of J, which the singular J' J would magnify.
  const bool redundant = rows < n;
  const int size = redundant ? rows : n;
  double normal[max_joints * max_joints], damped[max_joints * max_joints], gradient[max_joints], step[max_joints];
  double solution[(std::max)(6, max_joints)];
  bool held[max_joints];
  const double rotation_weight = problem.oriented ? problem.rotation_length : 0;

  const auto evaluate = [&](IkIterate& it) {
    Isometry3 pose;
    problem.model(it.q, pose, it.jacobian);
    const Vector3 position = translation(problem.target) - translation(pose);
    Vector3 turn = Vector3::Zero();
    if (problem.oriented) {
      Matrix3 between;
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
          between(r, c) =
              problem.target(r, 0) * pose(c, 0) + problem.target(r, 1) * pose(c, 1) + problem.target(r, 2) * pose(c, 2);
      turn = log_so3(between);
    }
    it.position_error = position.norm();
    it.rotation_error = turn.norm();
    for (int k = 0; k < 3; ++k) {
      it.error(k) = position(k);
      it.error(3 + k) = rotation_weight * turn(k);
    }
    it.cost = it.error.squaredNorm();
    for (int i = 0; i < n; ++i)
      for (int k = 3; k < 6; ++k) it.jacobian[6 * i + k] *= rotation_weight;
  };
  const auto converged = [&] {
    return best->position_error <= problem.position_tolerance && best->rotation_error <= problem.rotation_tolerance;
  };
  int iterations = 1;
  const auto finish = [&](IkStatus status) {
    std::copy_n(best->q, n, joints);
    return IkOutcome{status, best->position_error, best->rotation_error, iterations};
  };

  std::swap(best, next);
  for (int i = 0; i < moving; ++i) best->q[i] = (std::min)((std::max)(best->q[i], problem.lower[i]), problem.upper[i]);
  evaluate(*best);
  double damping = 1e-3;  // in units of the cost
  if (!std::isfinite(best->cost)) return finish(IkStatus::stalled);
  while (!converged()) {
    double trace = 0, gradient_square = 0;
    for (int j = 0; j < n; ++j) {
      const double* const of_j = best->jacobian + 6 * j;
      gradient[j] = dot6(of_j, best->error.data());
      trace += dot6(of_j, of_j);
      held[j] = j >= moving || (best->q[j] <= problem.lower[j] && gradient[j] < 0) ||
                (best->q[j] >= problem.upper[j] && gradient[j] > 0);
      if (held[j]) gradient[j] = 0;
      gradient_square += gradient[j] * gradient[j];
    }
    const double scale = (std::max)(trace, 1e-12);
    if (redundant) {
      std::fill_n(normal, size * size, 0.0);
      for (int j = 0; j < n; ++j) {
        const double* const of_j = best->jacobian + 6 * j;
        if (held[j]) continue;
        for (int k = 0; k < rows; ++k)
          for (int i = k; i < rows; ++i) normal[k * size + i] += of_j[i] * of_j[k];
      }
    } else {
      for (int j = 0; j < n; ++j)
        for (int i = j; i < n; ++i)
          normal[j * n + i] =
              held[i] || held[j] ? (i == j ? 1.0 : 0.0) : dot6(best->jacobian + 6 * i, best->jacobian + 6 * j);
    }
    // Nothing to gain in any direction; and no motion below 10 rad (or m) would remove the error to first order, or it
    // is only the slow way out of a singularity.
    if (std::sqrt(gradient_square) <= (std::min)(1e-3 * std::sqrt(scale * best->cost), 0.1 * best->cost))
      return finish(IkStatus::unreachable);
    for (;;) {
      if (iterations >= problem.max_iterations || damping > 1e12) return finish(IkStatus::stalled);
      std::copy_n(normal, size * size, damped);
      for (int i = 0; i < size; ++i) damped[i * size + i] += damping * best->cost + 1e-14 * scale;
      std::copy_n(redundant ? best->error.data() : gradient, size, solution);
      solve_few(damped, solution, size);
      for (int j = 0; j < n; ++j) {
        step[j] = held[j] ? 0 : solution[j];
        if (redundant && !held[j]) step[j] = std::inner_product(solution, solution + rows, best->jacobian + 6 * j, 0.0);
      }
      double square = 0;
      for (int i = 0; i < n; ++i) square += step[i] * step[i];
      const double shorten =
          (std::min)(1.0, 1.5 / std::sqrt(square));  // rad (or m): no needless turns near a singularity
      for (int i = 0; i < n; ++i)
        next->q[i] = i < moving
                         ? (std::min)((std::max)(best->q[i] + shorten * step[i], problem.lower[i]), problem.upper[i])
                         : best->q[i];
      evaluate(*next);
      ++iterations;
      if (next->cost < best->cost) {  // false for NaN too
        std::swap(best, next);
        damping = (std::max)(damping / 8, 1e-9);
        break;
      }
      damping = (std::max)(damping * 8, 1e-9);
    }
  }
  return finish(IkStatus::converged);
}

VERNIER_IMPL IkOutcome solve_inverse_kinematics(const IkProblem& problem, double* joints) noexcept {
  const int n = problem.joints, moving = std::clamp(problem.moving_joints, 1, n);
  IkIterate one, other;
  std::copy_n(problem.seed, n, one.q);
  IkOutcome best = damped_least_squares(problem, &other, &one, joints);
  const auto error = [&](const IkOutcome& r) {
    return std::hypot(r.position_error, problem.rotation_length * r.rotation_error);
  };
  Rng rng;
  for (int k = 0; k < problem.restarts && best.status != IkStatus::converged; ++k) {
    std::copy_n(problem.seed, n, one.q);
    for (int i = 0; i < moving; ++i) {
      const bool bounded = std::isfinite(problem.upper[i] - problem.lower[i]);
      one.q[i] = bounded ? rng.uniform(problem.lower[i], problem.upper[i])
                         : problem.seed[i] + rng.uniform(-3.14159265358979323846, 3.14159265358979323846);
    }
    double found[max_joints];
    IkOutcome again = damped_least_squares(problem, &other, &one, found);
    const int spent = best.iterations + again.iterations;
    if (again.status == IkStatus::converged || error(again) < error(best)) {
      best = again;
      std::copy_n(found, n, joints);
    }
    best.iterations = spent;
  }
  return best;
}

}  // namespace vernier::detail
