// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/bounded_bfgs.hpp"

namespace vernier::detail {

VERNIER_IMPL BoundedMinimum minimise_within(FunctionRef<double(const VectorX& x, VectorX& gradient)> function,
                                            VectorX x, const VectorX& lower, const VectorX& upper, int iterations,
                                            double tolerance) {
  constexpr double longest = 2;  // step in any coordinate: they are logarithms
  const Index d = x.size();
  VectorX gradient(d), next_gradient(d);
  const auto clamp = [&](VectorX& point) {
    for (Index j = 0; j < d; ++j) point(j) = (std::min)((std::max)(point(j), lower(j)), upper(j));
  };
  const auto longest_part = [](const VectorX& v) {
    return (std::max)(VERNIER_LATER(v).maxCoeff(), -VERNIER_LATER(v).minCoeff());
  };
  clamp(x);
  double value = function(x, gradient);
  MatrixX inverse = MatrixX::Identity(d, d);  // of the Hessian
  bool fresh = true;                          // it still is the identity
  for (int iteration = 0; iteration < iterations && std::isfinite(value); ++iteration) {
    VectorX free(d);
    for (Index j = 0; j < d; ++j)
      free(j) = (x(j) <= lower(j) && gradient(j) > 0) || (x(j) >= upper(j) && gradient(j) < 0) ? 0 : 1;
    const VectorX slope = VERNIER_LATER(gradient).cwiseProduct(free);
    const double steepest = longest_part(slope);
    if (!(steepest > tolerance)) break;
    VectorX step = product(inverse, slope);
    for (Index j = 0; j < d; ++j) step(j) *= -free(j);
    if (fresh) step /= (std::max)(1.0, steepest);
    step *= (std::min)(1.0, longest / longest_part(step));

    VectorX next;
    double next_value = std::numeric_limits<double>::infinity();
    bool fallen = false;
    for (int halvings = 0; halvings < 30 && !fallen; ++halvings, step /= 2) {
      next = x + step;
      clamp(next);
      next_value = function(next, next_gradient);
      const VectorX moved = next - x;
      fallen = next_value <= value + 1e-4 * gradient.dot(moved) && next_value < value;
    }
    if (!fallen) {
      if (fresh) break;
      inverse.setIdentity();
      fresh = true;
      continue;
    }
    const VectorX moved = next - x, change = next_gradient - gradient;
    const double curvature = moved.dot(change);
    if (curvature > 1e-10 * moved.norm() * change.norm()) {
      if (fresh) inverse *= curvature / change.squaredNorm();
      const VectorX along = product(inverse, change);
      const double factor = 1 + change.dot(along) / curvature;
      for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i)
          inverse(i, j) += (factor * moved(i) * moved(j) - (moved(i) * along(j) + along(i) * moved(j))) / curvature;
      fresh = false;
    }
    x = std::move(next);
    gradient = next_gradient;
    value = next_value;
  }
  return {x, value};
}

}  // namespace vernier::detail
