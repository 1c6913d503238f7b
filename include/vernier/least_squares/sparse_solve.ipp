#pragma once

#include <Eigen/SparseCholesky>

#include "vernier/least_squares/sparse_solve.hpp"

namespace vernier {

VERNIER_IMPL SparseOutcome EigenSparseSolver::operator()(const SparseSymmetric& matrix, MatrixRef right) const {
  using Sparse = Eigen::SparseMatrix<double>;
  const Eigen::Map<const Sparse> view(matrix.size, matrix.size, static_cast<Index>(matrix.values.size()),
                                      matrix.starts.data(), matrix.rows.data(), matrix.values.data());
  const Eigen::SimplicialLDLT<Sparse> factor{Sparse(view)};
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return {};
  right = MatrixX(factor.solve(right));
  return {true, factor.vectorD().array().log().sum()};
}

}  // namespace vernier
