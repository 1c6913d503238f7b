// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/box.hpp"

namespace vernier {

VERNIER_IMPL Box Box::cube(Index dimension, double lower, double upper) {
  demand(dimension >= 1, "Box::cube: dimension is ", dimension, ", must be at least 1");
  demand(lower < upper, "Box::cube: lower bound ", lower, " is not below upper bound ", upper);
  return {VectorX::Constant(dimension, lower), VectorX::Constant(dimension, upper)};
}

VERNIER_IMPL bool Box::contains(const ConstVectorRef& x) const {
  if (x.size() != dimension()) return false;
  for (Index i = 0; i < x.size(); ++i)
    if (!(x(i) >= lower(i) && x(i) <= upper(i))) return false;
  return true;
}

VERNIER_IMPL void Box::validate() const {
  demand(lower.size() == upper.size() && lower.size() >= 1, "Box: ", lower.size(), " lower and ", upper.size(),
         " upper bounds");
  for (Index i = 0; i < lower.size(); ++i)
    demand(lower(i) < upper(i) && upper(i) - lower(i) < 1e300, "Box: dimension ", i, " has bounds [", lower(i), ", ",
           upper(i), "], must be finite and lower below upper");
}

}  // namespace vernier
