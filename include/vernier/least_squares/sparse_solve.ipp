// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/sparse_solve.hpp"

namespace vernier {

VERNIER_IMPL SparseOutcome EigenSparseSolver::operator()(const SparseSymmetric& matrix, MatrixRef right) const {
  using Sparse = Eigen::SparseMatrix<double>;
  const VERNIER_LATER_TYPE(Eigen::Map<const Sparse>)
      view(matrix.size, matrix.size, static_cast<Index>(matrix.values.size()), matrix.starts.data(), matrix.rows.data(),
           matrix.values.data());
  const VERNIER_LATER_TYPE(Eigen::SimplicialLDLT<Sparse>) factor{Sparse(view)};
  if (!detail::succeeded(factor)) return {};
  const VectorX diagonal = factor.vectorD();
  if (!(VERNIER_LATER(diagonal).minCoeff() > 0)) return {};
  const MatrixX given = right, solution = factor.solve(given);
  right = solution;
  double log_determinant = 0;
  for (const double d : diagonal) log_determinant += std::log(d);
  return {true, log_determinant};
}

VERNIER_IMPL VectorX detail::multiply(const SparseSymmetric& matrix, const VectorX& x) {
  VectorX out = VectorX::Zero(matrix.size);
  for (Index j = 0; j < matrix.size; ++j)
    for (int at = matrix.starts[static_cast<std::size_t>(j)]; at < matrix.starts[static_cast<std::size_t>(j + 1)];
         ++at) {
      const Index i = matrix.rows[static_cast<std::size_t>(at)];
      const double value = matrix.values[static_cast<std::size_t>(at)];
      out(i) += value * x(j);
      if (i != j) out(j) += value * x(i);
    }
  return out;
}

}  // namespace vernier
