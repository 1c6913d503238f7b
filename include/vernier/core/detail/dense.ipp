// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/detail/dense_kernels.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/simd.hpp"

namespace vernier::detail {

/// Kernels for the widest instruction set of this machine; null for Eigen as this unit is compiled: where the operation
/// is small, the machine has neither AVX2 nor AVX-512, or this is not the library.
VERNIER_LOCAL inline const DenseKernels* wide_kernels([[maybe_unused]] double operations) {
#if defined(VERNIER_DENSE_KERNELS)
  static const DenseKernels* const kernels = widest_instruction_set() == InstructionSet::avx512 ? &avx512_kernels
                                             : widest_instruction_set() == InstructionSet::avx2 ? &avx2_kernels
                                                                                                : nullptr;
  if (operations > 1e5) return kernels;
#endif
  return nullptr;
}

VERNIER_LOCAL inline MatrixAt<double> at(MatrixRef m) { return {m.data(), m.outerStride(), m.rows(), m.cols()}; }
VERNIER_LOCAL inline MatrixAt<const double> at(const ConstMatrixRef& m) {
  return {m.data(), m.outerStride(), m.rows(), m.cols()};
}
/// Number of operations on some matrices.
VERNIER_LOCAL inline double operations(Index a, Index b, Index c) {
  return static_cast<double>(a) * static_cast<double>(b) * static_cast<double>(c);
}

VERNIER_IMPL void add_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b, double factor) {
  if (const auto* wide = wide_kernels(operations(out.rows(), out.cols(), a.cols())))
    return wide->add_product(at(out), at(a), at(b), factor);
  if (same_value(factor, 1))
    VERNIER_LATER(out).noalias() += VERNIER_LATER(a) * b;
  else
    VERNIER_LATER(out).noalias() += VERNIER_LATER(a) * ConstMatrixRef(MatrixX(factor * VERNIER_LATER(b)));
}

VERNIER_IMPL void add_transposed_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b,
                                         double factor) {
  if (const auto* wide = wide_kernels(operations(out.rows(), out.cols(), a.rows())))
    return wide->add_transposed_product(at(out), at(a), at(b), factor);
  if (same_value(factor, 1))
    VERNIER_LATER(out).noalias() += VERNIER_LATER(a).transpose() * b;
  else
    VERNIER_LATER(out).noalias() += VERNIER_LATER(a).transpose() * ConstMatrixRef(MatrixX(factor * VERNIER_LATER(b)));
}

VERNIER_IMPL VectorX product(const ConstMatrixRef& a, const ConstVectorRef& x) { return VERNIER_LATER(a) * x; }

VERNIER_IMPL VectorX transposed_product(const ConstMatrixRef& a, const ConstVectorRef& x) {
  return VERNIER_LATER(a).transpose() * x;
}

VERNIER_IMPL MatrixX matrix_product(const ConstMatrixRef& a, const ConstMatrixRef& b) {
  MatrixX out = MatrixX::Zero(a.rows(), b.cols());
  add_product(out, a, b);
  return out;
}

VERNIER_IMPL MatrixX transposed_matrix_product(const ConstMatrixRef& a, const ConstMatrixRef& b) {
  MatrixX out = MatrixX::Zero(a.cols(), b.cols());
  add_transposed_product(out, a, b);
  return out;
}

VERNIER_IMPL MatrixX rows_scaled(const ConstVectorRef& factors, const ConstMatrixRef& a) {
  MatrixX out(a.rows(), a.cols());
  for (Index c = 0; c < a.cols(); ++c)
    for (Index r = 0; r < a.rows(); ++r) out(r, c) = factors(r) * a(r, c);
  return out;
}

VERNIER_IMPL MatrixX columns_scaled(const ConstMatrixRef& a, const ConstVectorRef& factors) {
  MatrixX out(a.rows(), a.cols());
  for (Index c = 0; c < a.cols(); ++c)
    for (Index r = 0; r < a.rows(); ++r) out(r, c) = a(r, c) * factors(c);
  return out;
}

VERNIER_IMPL MatrixX rows_minus(const ConstMatrixRef& a, const ConstVectorRef& row) {
  MatrixX out(a.rows(), a.cols());
  for (Index c = 0; c < a.cols(); ++c)
    for (Index r = 0; r < a.rows(); ++r) out(r, c) = a(r, c) - row(c);
  return out;
}

VERNIER_IMPL VectorX row_of(const ConstMatrixRef& a, Index i) {
  VectorX out(a.cols());
  for (Index c = 0; c < a.cols(); ++c) out(c) = a(i, c);
  return out;
}

VERNIER_IMPL MatrixX rows_of(const ConstMatrixRef& a, std::span<const Index> rows) {
  MatrixX out(static_cast<Index>(rows.size()), a.cols());
  for (Index c = 0; c < out.cols(); ++c)
    for (Index r = 0; r < out.rows(); ++r) out(r, c) = a(rows[static_cast<std::size_t>(r)], c);
  return out;
}

VERNIER_IMPL MatrixX columns_of(const ConstMatrixRef& a, std::span<const Index> columns) {
  MatrixX out(a.rows(), static_cast<Index>(columns.size()));
  for (Index c = 0; c < out.cols(); ++c)
    std::copy_n(a.data() + columns[static_cast<std::size_t>(c)] * a.outerStride(), a.rows(), out.data() + c * a.rows());
  return out;
}

VERNIER_IMPL VectorX diagonal_of(const ConstMatrixRef& a) {
  VectorX out((std::min)(a.rows(), a.cols()));
  for (Index k = 0; k < out.size(); ++k) out(k) = a(k, k);
  return out;
}

VERNIER_IMPL VectorX column_means(const ConstMatrixRef& a) {
  VectorX out(a.cols());
  for (Index c = 0; c < a.cols(); ++c) out(c) = VERNIER_LATER(a).col(c).sum() / static_cast<double>(a.rows());
  return out;
}

VERNIER_IMPL VectorX squared_column_norms(const ConstMatrixRef& a) {
  VectorX out(a.cols());
  for (Index c = 0; c < a.cols(); ++c) out(c) = VERNIER_LATER(a).col(c).squaredNorm();
  return out;
}

VERNIER_IMPL VectorX squared_row_norms(const ConstMatrixRef& a) {
  VectorX out = VectorX::Zero(a.rows());
  for (Index c = 0; c < a.cols(); ++c)
    for (Index r = 0; r < a.rows(); ++r) out(r) += a(r, c) * a(r, c);
  return out;
}

VERNIER_IMPL bool all_finite(const ConstMatrixRef& a) {
  for (Index c = 0; c < a.cols(); ++c)
    for (Index r = 0; r < a.rows(); ++r)
      if (!std::isfinite(a(r, c))) return false;
  return true;
}

VERNIER_IMPL double weighted_square(const ConstVectorRef& weights, const ConstVectorRef& values) {
  double sum = 0;
  for (Index k = 0; k < values.size(); ++k) sum += weights(k) * values(k) * values(k);
  return sum;
}

VERNIER_IMPL bool cholesky(MatrixRef matrix) {
  if (const auto* wide = wide_kernels(operations(matrix.rows(), matrix.rows(), matrix.rows())))
    return wide->cholesky(at(matrix));
  return succeeded(VERNIER_LATER_TYPE(Eigen::LLT<MatrixRef>)(matrix));  // in place
}

VERNIER_IMPL void solve_lower(const ConstMatrixRef& factor, MatrixRef right) {
  if (const auto* wide = wide_kernels(operations(factor.rows(), factor.rows(), right.cols())))
    return wide->solve_lower(at(factor), at(right));
  VERNIER_LATER(factor).template triangularView<Eigen::Lower>().solveInPlace(right);
}

VERNIER_IMPL void solve_lower_transposed(const ConstMatrixRef& factor, MatrixRef right) {
  if (const auto* wide = wide_kernels(operations(factor.rows(), factor.rows(), right.cols())))
    return wide->solve_lower_transposed(at(factor), at(right));
  VERNIER_LATER(factor).template triangularView<Eigen::Lower>().transpose().solveInPlace(right);
}

VERNIER_IMPL void solve_cholesky(const ConstMatrixRef& factor, MatrixRef right) {
  solve_lower(factor, right);
  solve_lower_transposed(factor, right);
}

VERNIER_IMPL double cholesky_log_determinant(const ConstMatrixRef& factor) {
  double sum = 0;
  for (Index k = 0; k < factor.rows(); ++k) sum += std::log(factor(k, k));
  return 2 * sum;
}

VERNIER_IMPL MatrixX inverse_from_cholesky(const ConstMatrixRef& factor) {
  MatrixX out = MatrixX::Identity(factor.rows(), factor.rows());
  solve_cholesky(factor, out);
  return out;
}

VERNIER_IMPL double solve_general(MatrixRef a, VectorRef b) {
  const VERNIER_LATER_TYPE(Eigen::PartialPivLU<MatrixRef>) lu(a);  // in place
  b = VectorX(lu.solve(b));
  return VERNIER_LATER(a).diagonal().array().abs().log().sum();
}

/// R of a decomposition of a matrix of n columns, n x n.
VERNIER_LOCAL MatrixX triangle_of(const Eigen::HouseholderQR<MatrixX>& qr) {
  const Index columns = VERNIER_LATER(qr).cols(), height = (std::min)(VERNIER_LATER(qr).rows(), columns);
  MatrixX out = MatrixX::Zero(columns, columns);
  VERNIER_LATER(out).topRows(height) =
      VERNIER_LATER(qr).matrixQR().topRows(height).template triangularView<Eigen::Upper>();
  return out;
}

VERNIER_IMPL MatrixX triangular_factor(const ConstMatrixRef& matrix) {
  return triangle_of(VERNIER_LATER_TYPE(Eigen::HouseholderQR<MatrixX>)(matrix));
}

VERNIER_IMPL QrSolution solve_by_qr(const ConstMatrixRef& matrix, const ConstMatrixRef& right) {
  const VERNIER_LATER_TYPE(Eigen::HouseholderQR<MatrixX>) qr(matrix);
  return {qr.solve(right), triangle_of(qr)};
}

VERNIER_IMPL SymmetricEigen symmetric_eigen(const ConstMatrixRef& matrix) {
  const VERNIER_LATER_TYPE(Eigen::SelfAdjointEigenSolver<MatrixX>) eigen(matrix);
  return {eigen.eigenvalues(), eigen.eigenvectors(), succeeded(eigen)};
}

VERNIER_IMPL TridiagonalForm tridiagonal_form(const ConstMatrixRef& matrix) {
  const VERNIER_LATER_TYPE(Eigen::Tridiagonalization<MatrixX>) form(matrix);
  return {form.matrixQ(), VERNIER_LATER(form).diagonal(), form.subDiagonal()};
}

using JacobiSvd = Eigen::JacobiSVD<MatrixX, Eigen::NoQRPreconditioner>;

VERNIER_IMPL RightSingular right_singular(const ConstMatrixRef& matrix) {
  const MatrixX square = matrix.rows() == matrix.cols() ? MatrixX(matrix) : triangular_factor(matrix);
  const VERNIER_LATER_TYPE(JacobiSvd) svd(square, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

VERNIER_IMPL ThinSvd thin_svd(const ConstMatrixRef& h) {
  const bool tall = h.rows() >= h.cols();
  const Index k = (std::min)(h.rows(), h.cols());
  const VERNIER_LATER_TYPE(Eigen::HouseholderQR<MatrixX>) qr(tall ? MatrixX(h) : MatrixX(VERNIER_LATER(h).transpose()));
  const VERNIER_LATER_TYPE(JacobiSvd) svd(triangle_of(qr), Eigen::ComputeFullU | Eigen::ComputeFullV);
  VERNIER_LATER_TYPE(MatrixX) longer = MatrixX::Zero(qr.rows(), k);
  VERNIER_LATER(longer).topRows(k) = svd.matrixU();
  longer.applyOnTheLeft(qr.householderQ());
  return {tall ? longer : svd.matrixV(), svd.singularValues(), tall ? svd.matrixV() : longer};
}

}  // namespace vernier::detail
