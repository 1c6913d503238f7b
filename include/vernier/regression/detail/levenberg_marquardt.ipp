// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/marquardt_damping.hpp"
#include "vernier/regression/detail/levenberg_marquardt.hpp"

namespace vernier::detail {

VERNIER_IMPL double levenberg_marquardt(const LeastSquaresProblem& problem, VectorX& theta, int iterations,
                                        double tolerance, ExecutorRef executor, FunctionRef<bool(double best)> watch) {
  constexpr double rounding = 1e-26;  // of targets of spread 1
  double value = problem.evaluate(theta), at_check = value;
  MarquardtDamping damping(0.1);
  int accepted = 0;
  bool moved = true;
  VectorX gradient, scale;
  MatrixX curvature, damped;
  bool go_on = watch(value) && std::isfinite(value);
  for (int iteration = 0; go_on && iteration < iterations && value > rounding; ++iteration) {
    if (moved) {
      gradient = problem.gradient();
      problem.curvature(curvature, executor);
      scale = diagonal_of(curvature);
      if (!(VERNIER_LATER(scale).maxCoeff() > 0)) break;  // every node is saturated or unused
      // Nodes that hardly matter at the moment must not be thrown far away.
      const double least = 1e-3 * scale.mean();
      for (double& of_weight : scale) of_weight = (std::max)(of_weight, least);
      moved = false;
    }
    damped = curvature;
    for (Index k = 0; k < scale.size(); ++k) damped(k, k) += damping.value() * scale(k);
    if (cholesky(damped)) {
      VectorX step = -gradient;
      solve_cholesky(damped, step);
      const VectorX scaled = VERNIER_LATER(scale).cwiseProduct(step);
      const double predicted = 0.5 * (damping.value() * step.dot(scaled) - gradient.dot(step));
      if (!(predicted > 1e-15 * value)) break;  // the value cannot tell such steps apart
      const VectorX trial = theta + step;
      const double found = problem.evaluate(trial);
      if (found < value) {
        damping.accept(value - found, predicted);
        theta = trial;
        value = found;
        moved = true;
      }
    }
    if (!moved) {
      damping.reject();
    } else if (++accepted % 10 == 0) {
      go_on = at_check - value >= tolerance * value;
      at_check = value;
    }
    go_on = watch(value) && go_on;
  }
  return value;
}

}  // namespace vernier::detail
