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
  rank = (singular_values.array() > 1e-12 * singular_values(0)).count();
  condition =
      rank < columns ? std::numeric_limits<double>::infinity() : singular_values(0) / singular_values(columns - 1);
  if (prior.maxCoeff() > 0) {
    MatrixX stacked = MatrixX::Zero(2 * columns, columns);
    stacked.topRows(columns) = triangle;
    for (Index k = 0; k < columns; ++k) stacked(columns + k, k) = std::sqrt(prior(k));
    svd = detail::right_singular(stacked);
  }
  if (!(svd.values(columns - 1) > 1e-12 * svd.values(0))) return;
  MatrixX scaled = svd.vectors;  // V diag(1/s)
  for (Index k = 0; k < columns; ++k) scaled.col(k) /= svd.values(k);
  inverse.setZero(columns, columns);
  detail::add_product(inverse, scaled, scaled.transpose());
  MatrixX weighted = jacobian;
  for (Index i = 0; i < weighted.rows(); ++i) weighted.row(i) *= row_variance(i);
  MatrixX middle = MatrixX::Zero(columns, columns), half = middle;
  detail::add_transposed_product(middle, jacobian, weighted);
  for (Index k = 0; k < columns; ++k)
    if (prior(k) > 0) middle(k, k) += prior(k) * prior(k) * prior_variance(k);
  detail::add_product(half, inverse, middle);
  covariance.setZero(columns, columns);
  detail::add_product(covariance, half, inverse);
}

}  // namespace vernier
