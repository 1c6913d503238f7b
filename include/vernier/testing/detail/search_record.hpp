// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The function on which laws of searches are checked, and a record of its evaluations.

#include <vector>

#include "vernier/core/box.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::testing::detail {

/// Everything a search evaluated.
struct SearchRecord {
  std::vector<MatrixX> populations;
  std::vector<VectorX> values;

  bool operator==(const SearchRecord& other) const {
    if (populations.size() != other.populations.size()) return false;
    for (std::size_t i = 0; i < populations.size(); ++i)
      if (!same_bits(populations[i], other.populations[i]) || !same_bits(values[i], other.values[i])) return false;
    return true;
  }
};

/// A quadratic function in coordinates of the unit box, its minimum just outside in two of them.
struct Bowl {
  Box box{(VectorX(4) << -1, 0.5, 10, -1e-3).finished(), (VectorX(4) << 2, 0.75, 30, 1e-3).finished()};

  double operator()(const Eigen::Ref<const VectorX>& x) const {
    const VectorX bottom = (VectorX(4) << 0.3, 1.1, -0.1, 0.6).finished();
    return ((x - box.lower).cwiseQuotient(box.upper - box.lower) - bottom).squaredNorm() + 0.25;
  }

  /// Evaluates populations and records them with their values.
  auto recorder(SearchRecord& record) const {
    return [this, &record](const MatrixX& population, VectorX& fitness) {
      fitness.resize(population.cols());
      for (Index k = 0; k < population.cols(); ++k) fitness(k) = (*this)(population.col(k));
      record.populations.push_back(population);
      record.values.push_back(fitness);
    };
  }
};

}  // namespace vernier::testing::detail
