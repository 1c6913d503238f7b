#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vernier/regression/detail/bounded_bfgs.hpp"

namespace vernier::detail {

VERNIER_IMPL BoundedMinimum minimise_within(FunctionRef<double(const VectorX& x, VectorX& gradient)> function,
                                            VectorX x, const VectorX& lower, const VectorX& upper, int iterations,
                                            double tolerance) {
  constexpr double longest = 2;  // step in any coordinate: they are logarithms
  const Index d = x.size();
  VectorX gradient(d), next_gradient(d);
  x = x.cwiseMax(lower).cwiseMin(upper);
  double value = function(x, gradient);
  MatrixX inverse = MatrixX::Identity(d, d);  // of the Hessian
  bool fresh = true;                          // it still is the identity
  for (int iteration = 0; iteration < iterations && std::isfinite(value); ++iteration) {
    VectorX free(d);
    for (Index j = 0; j < d; ++j)
      free(j) = (x(j) <= lower(j) && gradient(j) > 0) || (x(j) >= upper(j) && gradient(j) < 0) ? 0 : 1;
    const VectorX slope = gradient.cwiseProduct(free);
    const double steepest = slope.cwiseAbs().maxCoeff();
    if (!(steepest > tolerance)) break;
    VectorX step = -free.cwiseProduct(inverse * slope);
    if (fresh) step /= std::max(1.0, steepest);
    step *= std::min(1.0, longest / step.cwiseAbs().maxCoeff());

    VectorX next;
    double next_value = std::numeric_limits<double>::infinity();
    bool fallen = false;
    for (int halvings = 0; halvings < 30 && !fallen; ++halvings, step /= 2) {
      next = (x + step).cwiseMax(lower).cwiseMin(upper);
      next_value = function(next, next_gradient);
      fallen = next_value <= value + 1e-4 * gradient.dot(next - x) && next_value < value;
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
      if (fresh) inverse = MatrixX::Identity(d, d) * (curvature / change.squaredNorm());
      const VectorX along = inverse * change;
      inverse += (1 + change.dot(along) / curvature) / curvature * moved * moved.transpose() -
                 (moved * along.transpose() + along * moved.transpose()) / curvature;
      fresh = false;
    }
    x = std::move(next);
    gradient = next_gradient;
    value = next_value;
  }
  return {x, value};
}

}  // namespace vernier::detail
