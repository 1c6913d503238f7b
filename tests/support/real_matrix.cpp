// SPDX-License-Identifier: BSD-3-Clause
#include "real_matrix.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <ostream>
#include <stdexcept>

namespace vernier_test {

using vernier::MatrixX;
using vernier::VectorX;

namespace {

void require_shape(const RealMatrix& a, Index rows, Index cols) {
  if (a.rows() != rows || a.cols() != cols) throw std::invalid_argument("RealMatrix: another shape");
}
void require_same_shape(const RealMatrix& a, const RealMatrix& b) { require_shape(a, b.rows(), b.cols()); }

const MatrixX& value(const RealMatrix& a) { return a; }

}  // namespace

RealMatrix::RealMatrix(Index rows, Index cols) : values_(MatrixX::Zero(rows, cols)) {}
RealMatrix::RealMatrix(Index rows, Index cols, std::initializer_list<double> values) : values_(rows, cols) {
  if (static_cast<Index>(values.size()) != rows * cols)
    throw std::invalid_argument("RealMatrix: not rows x cols values");
  Index k = 0;
  for (const double x : values) {
    values_(k / cols, k % cols) = x;
    ++k;
  }
}
RealMatrix::RealMatrix(const MatrixX& a) : values_(a) {}
RealMatrix::RealMatrix(const VectorX& a) : values_(a) {}
RealMatrix::RealMatrix(const vernier::Matrix3& a) : values_(a) {}
RealMatrix::RealMatrix(const vernier::Vector3& a) : values_(a) {}
RealMatrix::RealMatrix(const vernier::Matrix6& a) : values_(a) {}
RealMatrix::RealMatrix(const vernier::Vector6& a) : values_(a) {}
RealMatrix::RealMatrix(const vernier::Isometry3& a) : values_(a.matrix()) {}
RealMatrix::RealMatrix(const vernier::PointRows& a) : values_(a) {}
RealMatrix::RealMatrix(const vernier::JointRows<6>& a) : values_(a) {}
RealMatrix::RealMatrix(const Eigen::Matrix<double, 6, Eigen::Dynamic>& a) : values_(a) {}
RealMatrix RealMatrix::of(const vernier::ConstMatrixRef& a) { return MatrixX(a); }
RealMatrix RealMatrix::identity(Index n) { return MatrixX(MatrixX::Identity(n, n)); }
RealMatrix RealMatrix::diagonal(const RealMatrix& column) { return MatrixX(VectorX(column).asDiagonal()); }

RealMatrix::operator vernier::ConstMatrixRef() const { return values_; }
RealMatrix::operator VectorX() const {
  require_shape(*this, rows(), 1);
  return values_.col(0);
}
RealMatrix::operator vernier::ConstVectorRef() const {
  require_shape(*this, rows(), 1);
  return values_.col(0);
}
RealMatrix::operator vernier::Matrix3() const {
  require_shape(*this, 3, 3);
  return values_;
}
RealMatrix::operator vernier::Vector3() const {
  require_shape(*this, 3, 1);
  return values_;
}
RealMatrix::operator vernier::Matrix6() const {
  require_shape(*this, 6, 6);
  return values_;
}
RealMatrix RealMatrix::row(Index i) const { return MatrixX(values_.row(i)); }
RealMatrix RealMatrix::col(Index j) const { return MatrixX(values_.col(j)); }
RealMatrix RealMatrix::block(Index row, Index col, Index rows, Index cols) const {
  return MatrixX(values_.block(row, col, rows, cols));
}
void RealMatrix::set_block(Index row, Index col, const RealMatrix& values) {
  values_.block(row, col, values.rows(), values.cols()) = values.values_;
}
void RealMatrix::add_block(Index row, Index col, const RealMatrix& values) {
  values_.block(row, col, values.rows(), values.cols()) += values.values_;
}
RealMatrix RealMatrix::diagonal() const { return MatrixX(values_.diagonal()); }
RealMatrix RealMatrix::transpose() const { return MatrixX(values_.transpose()); }

RealMatrix RealMatrix::inverse() const {
  require_shape(*this, rows(), rows());
  return solve(identity(rows()));
}
double RealMatrix::determinant() const { return values_.determinant(); }
double RealMatrix::log_determinant() const {
  const Eigen::LLT<MatrixX> factor(values_);
  if (factor.info() != Eigen::Success) throw std::invalid_argument("RealMatrix: not positive definite");
  return 2 * MatrixX(factor.matrixL()).diagonal().array().log().sum();
}
RealMatrix RealMatrix::solve_by_cholesky(const RealMatrix& right) const {
  return MatrixX(Eigen::LLT<MatrixX>(values_).solve(right.values_));
}
RealMatrix RealMatrix::solve(const RealMatrix& right) const {
  return MatrixX(values_.colPivHouseholderQr().solve(right.values_));
}
// The eigenvalues of [0 A; A' 0] are the singular values, their negatives and zeros. An SVD would take seconds to
// compile.
RealMatrix RealMatrix::singular_values() const {
  const Index n = rows() + cols(), k = std::min(rows(), cols());
  RealMatrix both(n, n);
  both.set_block(0, rows(), *this);
  both.set_block(rows(), 0, transpose());
  const RealMatrix eigenvalues = both.symmetric_eigenvalues();
  RealMatrix out(k, 1);
  for (Index i = 0; i < k; ++i) out(i, 0) = std::max(0.0, eigenvalues(n - 1 - i, 0));
  return out;
}
RealMatrix RealMatrix::symmetric_eigenvalues() const {
  return VectorX(Eigen::SelfAdjointEigenSolver<MatrixX>(values_, Eigen::EigenvaluesOnly).eigenvalues());
}

RealMatrix RealMatrix::times(const RealMatrix& other) const {
  require_same_shape(*this, other);
  return MatrixX(values_.cwiseProduct(other.values_));
}
RealMatrix RealMatrix::over(const RealMatrix& other) const {
  require_same_shape(*this, other);
  return MatrixX(values_.cwiseQuotient(other.values_));
}
RealMatrix RealMatrix::sqrt() const { return MatrixX(values_.cwiseSqrt()); }

double RealMatrix::norm() const { return values_.norm(); }
double RealMatrix::squared_norm() const { return values_.squaredNorm(); }
double RealMatrix::largest() const {
  return values_.size() == 0 ? 0 : values_.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
}
double RealMatrix::sum() const { return values_.sum(); }
double RealMatrix::mean() const { return values_.mean(); }
double RealMatrix::trace() const { return values_.trace(); }
double RealMatrix::dot(const RealMatrix& other) const {
  require_same_shape(*this, other);
  return values_.cwiseProduct(other.values_).sum();
}

RealMatrix& RealMatrix::operator+=(const RealMatrix& other) {
  require_same_shape(*this, other);
  values_ += other.values_;
  return *this;
}
RealMatrix& RealMatrix::operator-=(const RealMatrix& other) {
  require_same_shape(*this, other);
  values_ -= other.values_;
  return *this;
}
RealMatrix& RealMatrix::operator*=(double factor) {
  values_ *= factor;
  return *this;
}
RealMatrix RealMatrix::operator-() const { return MatrixX(-values_); }
RealMatrix operator+(const RealMatrix& a, const RealMatrix& b) { return RealMatrix(a) += b; }
RealMatrix operator-(const RealMatrix& a, const RealMatrix& b) { return RealMatrix(a) -= b; }
RealMatrix operator*(const RealMatrix& a, const RealMatrix& b) {
  if (a.cols() != b.rows()) throw std::invalid_argument("RealMatrix: shapes do not fit");
  return MatrixX(value(a) * value(b));
}
RealMatrix operator*(double factor, const RealMatrix& a) { return RealMatrix(a) *= factor; }
RealMatrix operator*(const RealMatrix& a, double factor) { return RealMatrix(a) *= factor; }
RealMatrix operator/(const RealMatrix& a, double divisor) { return MatrixX(value(a) / divisor); }
bool operator==(const RealMatrix& a, const RealMatrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && value(a) == value(b);
}

RealMatrix vector(std::initializer_list<double> elements) {
  return RealMatrix(static_cast<Index>(elements.size()), 1, elements);
}

RealMatrix lower_triangle(RealMatrix a) {
  for (Index j = 0; j < a.cols(); ++j)
    for (Index i = 0; i < std::min(j, a.rows()); ++i) a(i, j) = 0;
  return a;
}

double difference(const RealMatrix& a, const RealMatrix& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
  return (a - b).largest();
}

void PrintTo(const RealMatrix& a, std::ostream* out) { *out << a.rows() << " x " << a.cols() << '\n' << value(a); }

}  // namespace vernier_test
