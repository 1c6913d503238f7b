#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

#include "vernier/core/detail/dense.hpp"

namespace vernier::detail {

VERNIER_IMPL void add_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b, double factor) {
  out.noalias() += factor * (a * b);
}

VERNIER_IMPL void add_transposed_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b,
                                         double factor) {
  out.noalias() += factor * (a.transpose() * b);
}

VERNIER_IMPL bool cholesky(MatrixRef matrix) {
  return Eigen::LLT<MatrixRef>(matrix).info() == Eigen::Success;  // in place
}

VERNIER_IMPL void solve_lower(const ConstMatrixRef& factor, MatrixRef right) {
  factor.triangularView<Eigen::Lower>().solveInPlace(right);
}

VERNIER_IMPL void solve_lower_transposed(const ConstMatrixRef& factor, MatrixRef right) {
  factor.triangularView<Eigen::Lower>().transpose().solveInPlace(right);
}

VERNIER_IMPL MatrixX inverse_from_cholesky(const ConstMatrixRef& factor) {
  MatrixX out = MatrixX::Identity(factor.rows(), factor.rows());
  solve_lower(factor, out);
  solve_lower_transposed(factor, out);
  return out;
}

VERNIER_IMPL void solve_general(MatrixRef a, VectorRef b) {
  const Eigen::PartialPivLU<MatrixRef> lu(a);  // in place
  b = VectorX(lu.solve(b));
}

VERNIER_IMPL MatrixX triangular_factor(const ConstMatrixRef& matrix) {
  const Index columns = matrix.cols(), height = std::min(matrix.rows(), columns);
  const Eigen::HouseholderQR<MatrixX> qr(matrix);
  MatrixX out = MatrixX::Zero(columns, columns);
  out.topRows(height) = qr.matrixQR().topRows(height).triangularView<Eigen::Upper>();
  return out;
}

VERNIER_IMPL RightSingular right_singular(const ConstMatrixRef& matrix) {
  const MatrixX square = matrix.rows() == matrix.cols() ? MatrixX(matrix) : triangular_factor(matrix);
  const Eigen::JacobiSVD<MatrixX, Eigen::NoQRPreconditioner> svd(square, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace vernier::detail
