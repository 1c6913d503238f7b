// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/observability.hpp"

namespace vernier {

VERNIER_IMPL Observability Observability::of(const VectorX& singular_values, Index poses) {
  demand(singular_values.size() >= 1 && poses >= 1, "Observability: ", singular_values.size(), " singular values of ",
         poses, " poses");
  const double largest = singular_values(0), least = singular_values(singular_values.size() - 1);
  if (!(least > 0)) return {};
  double logarithms = 0, inverses = 0;
  for (const double value : singular_values) {
    logarithms += std::log(value);
    inverses += 1 / value;
  }
  const double mean = std::exp(logarithms / static_cast<double>(singular_values.size()));
  return {mean / std::sqrt(static_cast<double>(poses)), least / largest, least, least * least / largest, 1 / inverses};
}

VERNIER_IMPL std::vector<Correlation> strong_correlations(const MatrixX& covariance, double limit) {
  std::vector<Correlation> out;
  for (Index j = 0; j < covariance.cols(); ++j)
    for (Index i = 0; i < j; ++i) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      if (scale > 0 && std::abs(covariance(i, j)) >= limit * scale) out.push_back({i, j, covariance(i, j) / scale});
    }
  std::sort(out.begin(), out.end(),
            [](const Correlation& a, const Correlation& b) { return std::abs(a.value) > std::abs(b.value); });
  return out;
}

namespace detail {

/// `rows * covariance`, whitened: multiplied by the inverse Cholesky factor of `I + rows covariance rows'`, so that
/// measuring the rows subtracts the square of this from the covariance.
VERNIER_LOCAL MatrixX whitened_gain(const MatrixX& rows, const MatrixX& covariance) {
  MatrixX cross = MatrixX::Zero(rows.rows(), covariance.cols()), inner = MatrixX::Identity(rows.rows(), rows.rows());
  add_product(cross, rows, covariance);
  add_product(inner, cross, VERNIER_LATER(rows).transpose());
  cholesky(inner);
  solve_lower(inner, cross);
  return cross;
}

}  // namespace detail

VERNIER_IMPL HelpfulPoses helpful_poses(MatrixX covariance, const std::vector<MatrixX>& candidates, Index unknown,
                                        int count) {
  demand(unknown >= 0 && unknown < covariance.cols(), "helpful_poses: unknown ", unknown, " of ", covariance.cols());
  HelpfulPoses out;
  for (int k = 0; k < count; ++k) {
    double best = 0;
    Index at = -1;
    MatrixX gain;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      MatrixX of_candidate = detail::whitened_gain(candidates[c], covariance);
      const double reduction = VERNIER_LATER(of_candidate).col(unknown).squaredNorm();
      if (reduction <= best) continue;
      best = reduction;
      at = static_cast<Index>(c);
      gain = std::move(of_candidate);
    }
    if (at < 0) break;
    detail::add_transposed_product(covariance, gain, gain, -1);
    out.poses.push_back(at);
    out.variances.push_back(covariance(unknown, unknown));
  }
  return out;
}

}  // namespace vernier
