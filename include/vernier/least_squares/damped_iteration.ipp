// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/least_squares/damped_iteration.hpp"
#include "vernier/least_squares/factorised_equations.hpp"
#include "vernier/least_squares/marquardt_damping.hpp"

namespace vernier {

VERNIER_IMPL IterationEnd minimise(const IteratedProblem& problem, const IterationLimits& limits) {
  IterationEnd out;
  MarquardtDamping damping;
  double reached = std::numeric_limits<double>::infinity(), predicted = 0;
  bool returned = false;  // to where the step before began, since it failed
  for (; out.iterations < limits.max_iterations; ++out.iterations) {
    const LinearisedProblem at = problem.linearise();
    if (at.with_old_weights > (1 + 1e-9) * reached) {  // the step failed, by more than rounding
      damping.reject();
      problem.restore();
      returned = true;
      continue;
    }
    if (damping.value() > 0 && !returned) damping.accept((std::max)(reached - at.with_old_weights, 0.0), predicted);
    returned = false;
    problem.keep();
    reached = at.with_new_weights;
    const FactorisedEquations solved(at.normal, at.precisions, at.steps, at.local_steps, eigen_sparse_solver,
                                     damping.value());
    out.usable = solved.usable();
    if (!out.usable) {  // damping makes nearly dependent unknowns independent
      if (damping.value() > 1) return out;
      damping.reject();
      returned = true;
      continue;
    }
    problem.move(solved.step(), solved.local_step());
    // converged when steps vanish, or change no more than digits of the cost
    double gain = -local_gain(at.normal, solved.local_step(), at.local_steps), damped = 0, largest = 0;
    for (Index k = 0; k < at.steps.size(); ++k) {
      const double step = solved.step()(k);
      gain -= step * (at.normal.gradient(k) + at.precisions(k) * at.steps(k));
      damped += step * step * (at.normal.matrix(k, k) + at.precisions(k));
      largest = (std::max)(largest, std::abs(step));
    }
    predicted = gain + damping.value() * damped;
    out.converged = damping.value() < limits.most_damping &&
                    (largest < limits.least_step || gain < limits.least_gain * at.normal.cost);
    if (out.converged) break;
  }
  return out;
}

}  // namespace vernier
