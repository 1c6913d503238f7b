#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/detail/dense_kernels.hpp"
#include "vernier/core/simd.hpp"

namespace vernier::detail {

/// Kernels for the widest instruction set of this machine; null for Eigen as this unit is compiled: where the operation
/// is small, the machine has neither AVX2 nor AVX-512, or this is not the library.
inline const DenseKernels* wide_kernels([[maybe_unused]] double operations) {
#if defined(VERNIER_DENSE_KERNELS)
  static const DenseKernels* const kernels = widest_instruction_set() == InstructionSet::avx512 ? &avx512_kernels
                                             : widest_instruction_set() == InstructionSet::avx2 ? &avx2_kernels
                                                                                                : nullptr;
  if (operations > 1e5) return kernels;
#endif
  return nullptr;
}

inline MatrixAt<double> at(MatrixRef m) { return {m.data(), m.outerStride(), m.rows(), m.cols()}; }
inline MatrixAt<const double> at(const ConstMatrixRef& m) { return {m.data(), m.outerStride(), m.rows(), m.cols()}; }
/// Number of operations on some matrices.
inline double operations(Index a, Index b, Index c) {
  return static_cast<double>(a) * static_cast<double>(b) * static_cast<double>(c);
}

VERNIER_IMPL void add_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b, double factor) {
  if (const auto* wide = wide_kernels(operations(out.rows(), out.cols(), a.cols())))
    return wide->add_product(at(out), at(a), at(b), factor);
  out.noalias() += factor * (a * b);
}

VERNIER_IMPL void add_transposed_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b,
                                         double factor) {
  if (const auto* wide = wide_kernels(operations(out.rows(), out.cols(), a.rows())))
    return wide->add_transposed_product(at(out), at(a), at(b), factor);
  out.noalias() += factor * (a.transpose() * b);
}

VERNIER_IMPL bool cholesky(MatrixRef matrix) {
  if (const auto* wide = wide_kernels(operations(matrix.rows(), matrix.rows(), matrix.rows())))
    return wide->cholesky(at(matrix));
  return Eigen::LLT<MatrixRef>(matrix).info() == Eigen::Success;  // in place
}

VERNIER_IMPL void solve_lower(const ConstMatrixRef& factor, MatrixRef right) {
  if (const auto* wide = wide_kernels(operations(factor.rows(), factor.rows(), right.cols())))
    return wide->solve_lower(at(factor), at(right));
  factor.triangularView<Eigen::Lower>().solveInPlace(right);
}

VERNIER_IMPL void solve_lower_transposed(const ConstMatrixRef& factor, MatrixRef right) {
  if (const auto* wide = wide_kernels(operations(factor.rows(), factor.rows(), right.cols())))
    return wide->solve_lower_transposed(at(factor), at(right));
  factor.triangularView<Eigen::Lower>().transpose().solveInPlace(right);
}

VERNIER_IMPL void solve_cholesky(const ConstMatrixRef& factor, MatrixRef right) {
  solve_lower(factor, right);
  solve_lower_transposed(factor, right);
}

VERNIER_IMPL MatrixX inverse_from_cholesky(const ConstMatrixRef& factor) {
  MatrixX out = MatrixX::Identity(factor.rows(), factor.rows());
  solve_cholesky(factor, out);
  return out;
}

VERNIER_IMPL double solve_general(MatrixRef a, VectorRef b) {
  const Eigen::PartialPivLU<MatrixRef> lu(a);  // in place
  b = VectorX(lu.solve(b));
  return a.diagonal().array().abs().log().sum();
}

/// R of a decomposition of a matrix of n columns, n x n.
VERNIER_API MatrixX triangle_of(const Eigen::HouseholderQR<MatrixX>& qr) {
  const Index columns = qr.cols(), height = std::min(qr.rows(), columns);
  MatrixX out = MatrixX::Zero(columns, columns);
  out.topRows(height) = qr.matrixQR().topRows(height).triangularView<Eigen::Upper>();
  return out;
}

VERNIER_IMPL MatrixX triangular_factor(const ConstMatrixRef& matrix) {
  return triangle_of(Eigen::HouseholderQR<MatrixX>(matrix));
}

VERNIER_IMPL QrSolution solve_by_qr(const ConstMatrixRef& matrix, const ConstMatrixRef& right) {
  const Eigen::HouseholderQR<MatrixX> qr(matrix);
  return {qr.solve(right), triangle_of(qr)};
}

VERNIER_IMPL SymmetricEigen symmetric_eigen(const ConstMatrixRef& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixX> eigen(matrix);
  return {eigen.eigenvalues(), eigen.eigenvectors(), eigen.info() == Eigen::Success};
}

using JacobiSvd = Eigen::JacobiSVD<MatrixX, Eigen::NoQRPreconditioner>;

VERNIER_IMPL RightSingular right_singular(const ConstMatrixRef& matrix) {
  const MatrixX square = matrix.rows() == matrix.cols() ? MatrixX(matrix) : triangular_factor(matrix);
  const JacobiSvd svd(square, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

VERNIER_IMPL ThinSvd thin_svd(const ConstMatrixRef& h) {
  const bool tall = h.rows() >= h.cols();
  const Index k = std::min(h.rows(), h.cols());
  const Eigen::HouseholderQR<MatrixX> qr(tall ? MatrixX(h) : MatrixX(h.transpose()));
  const JacobiSvd svd(triangle_of(qr), Eigen::ComputeFullU | Eigen::ComputeFullV);
  MatrixX longer = MatrixX::Zero(qr.rows(), k);
  longer.topRows(k) = svd.matrixU();
  longer.applyOnTheLeft(qr.householderQ());
  return {tall ? longer : svd.matrixV(), svd.singularValues(), tall ? svd.matrixV() : longer};
}

}  // namespace vernier::detail
