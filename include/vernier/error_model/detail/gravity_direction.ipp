// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/detail/gravity_direction.hpp"

namespace vernier::detail {

/// Half the sum of squares of whitened residuals and priors at the solution for a direction of gravity.
VERNIER_LOCAL inline double cost_of(ModelSelection& model, JointTerms& terms, const ChainTable& nominal,
                                    const Vector3& down) {
  CalibrationProblem& problem = model.problem;
  terms.gravity.emplace(nominal, down);
  if (terms.payload) terms.payload.emplace(nominal, down, Payload(terms.payload->reference()));
  const VectorX scales = problem.arm.scales(), precisions = problem.arm.precisions();
  problem.arm.set_terms(terms, VERNIER_LATER(scales).tail(terms.size()), VERNIER_LATER(precisions).tail(terms.size()));
  problem.solve(8);
  model.changed();
  const VectorX steps = problem.arm.steps();
  return (problem.stacked(false).residuals.squaredNorm() + weighted_square(precisions, steps)) / 2;
}

VERNIER_IMPL double estimate_down(ModelSelection& model, JointTerms& terms, const ChainTable& nominal,
                                  const Vector3& start) {
  CalibrationProblem& problem = model.problem;
  Vector3 down = start;
  double least = cost_of(model, terms, nominal, down);
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vector3 other = Vector3::Zero();
      other(axis) = sign;
      const double cost = cost_of(model, terms, nominal, other);
      if (!(cost < least)) continue;
      least = cost;
      down = other;
    }
  constexpr double step = 0.02;  // [rad]
  double weaker = 1;
  for (int iteration = 0; iteration < 20; ++iteration) {
    int smallest = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(down(axis)) < std::abs(down(smallest))) smallest = axis;
    Vector3 unit = Vector3::Zero();
    unit(smallest) = 1;
    Vector3 a = down.cross(unit);
    a /= a.norm();
    const Vector3 b = down.cross(a);
    const auto at = [&](double along_a, double along_b) {
      Vector3 moved = down;
      moved += along_a * a;
      moved += along_b * b;
      moved /= moved.norm();
      return moved;
    };
    const auto cost = [&](double along_a, double along_b) {
      return cost_of(model, terms, nominal, at(along_a, along_b));
    };
    const double here = cost(0, 0), a_up = cost(step, 0), a_down = cost(-step, 0), b_up = cost(0, step),
                 b_down = cost(0, -step), both = cost(step, step);
    const double ga = (a_up - a_down) / (2 * step), gb = (b_up - b_down) / (2 * step),
                 haa = (a_up - 2 * here + a_down) / (step * step), hbb = (b_up - 2 * here + b_down) / (step * step),
                 hab = (both - a_up - b_up + here) / (step * step), determinant = haa * hbb - hab * hab;
    const bool convex = haa > 0 && determinant > 0;
    double along_a = convex ? -(hbb * ga - hab * gb) / determinant : -ga,
           along_b = convex ? -(haa * gb - hab * ga) / determinant : -gb;
    constexpr double most = 0.5;
    const double length = std::hypot(along_a, along_b);
    if (!convex || length > most) {
      along_a *= most / length;
      along_b *= most / length;
    }
    const double information = (haa + hbb) / 2 - std::hypot((haa - hbb) / 2, hab);  // of the weaker angle
    weaker = information > 0 ? 1 / std::sqrt(information) : 1;
    const Vector3 next = at(along_a, along_b);
    if (!(cost_of(model, terms, nominal, next) < here)) break;
    down = next;
    if (std::hypot(along_a, along_b) < 0.01 * weaker) break;
  }
  (void)cost_of(model, terms, nominal, down);
  model.solve();
  const double variance =
      problem.stacked(false).residuals.squaredNorm() / static_cast<double>(problem.measured_values());
  const double std = weaker * std::sqrt((std::max)(1.0, variance));
  constexpr double nothing = 0.3;  // [rad]; compliance so small says nothing of a direction, which stays as given
  if (std < nothing) return std;
  (void)cost_of(model, terms, nominal, start);
  model.solve();
  return 0;
}

}  // namespace vernier::detail
