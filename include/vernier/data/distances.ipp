// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/distances.hpp"

#include <cmath>

namespace vernier::detail {

VERNIER_IMPL void check_distances(const ConstMatrixRef& joints, const VectorX& lengths) {
  demand(joints.rows() == lengths.size(), "Distances: ", joints.rows(), " rows of joints, but ", lengths.size(),
         " distances");
  for (Index i = 0; i < lengths.size(); ++i) {
    demand(finite_row(joints, i) && std::isfinite(lengths(i)), "Distances: row ", i, " has a value that is not finite");
    demand(lengths(i) > 0, "Distances: row ", i, " has a distance of ", lengths(i), " m, must be positive");
  }
}

}  // namespace vernier::detail
