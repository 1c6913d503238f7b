// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/estimate_covariance.hpp"

namespace vernier {

VERNIER_IMPL EstimateCovariance::EstimateCovariance(const ConstMatrixRef& jacobian, const VectorX& row_variance,
                                                    const VectorX& prior, const VectorX& prior_variance) {
  const Index columns = jacobian.cols();
  if (columns == 0) {
    condition = 1;
    return;
  }
  const MatrixX triangle = detail::triangular_factor(jacobian);
  detail::RightSingular svd = detail::right_singular(triangle);
  singular_values = svd.values;
  while (rank < columns && singular_values(rank) > 1e-12 * singular_values(0)) ++rank;
  condition =
      rank < columns ? std::numeric_limits<double>::infinity() : singular_values(0) / singular_values(columns - 1);
  if (VERNIER_LATER(prior).maxCoeff() > 0) {
    MatrixX stacked = MatrixX::Zero(2 * columns, columns);
    VERNIER_LATER(stacked).topRows(columns) = triangle;
    for (Index k = 0; k < columns; ++k) stacked(columns + k, k) = std::sqrt(prior(k));
    svd = detail::right_singular(stacked);
  }
  if (!(svd.values(columns - 1) > 1e-12 * svd.values(0))) return;
  MatrixX scaled = svd.vectors;  // V diag(1/s)
  for (Index k = 0; k < columns; ++k)
    for (Index r = 0; r < columns; ++r) scaled(r, k) /= svd.values(k);
  inverse = detail::matrix_product(scaled, VERNIER_LATER(scaled).transpose());
  MatrixX middle = detail::transposed_matrix_product(jacobian, detail::rows_scaled(row_variance, jacobian));
  for (Index k = 0; k < columns; ++k)
    if (prior(k) > 0) middle(k, k) += prior(k) * prior(k) * prior_variance(k);
  covariance = detail::matrix_product(detail::matrix_product(inverse, middle), inverse);
}

}  // namespace vernier
