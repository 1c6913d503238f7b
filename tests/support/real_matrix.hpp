// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Matrices for formulas in tests. Eigen's expressions cost seconds of compiling in each file that has some; the
// operators of these return matrices, by functions of Eigen that are compiled once, in real_matrix.cpp.

#include <initializer_list>
#include <iosfwd>

#include "vernier/core/types.hpp"

namespace vernier_test {

using vernier::Index;

/// A matrix of real numbers, or a column of them.
class RealMatrix {
 public:
  RealMatrix() = default;
  /// Zeros.
  RealMatrix(Index rows, Index cols);
  /// Row by row.
  RealMatrix(Index rows, Index cols, std::initializer_list<double> values);
  // What Vernier computes with. Of other matrices: RealMatrix::of.
  RealMatrix(const vernier::MatrixX& a);
  RealMatrix(const vernier::VectorX& a);
  RealMatrix(const vernier::Matrix3& a);
  RealMatrix(const vernier::Vector3& a);
  RealMatrix(const vernier::Matrix6& a);
  RealMatrix(const vernier::Vector6& a);
  RealMatrix(const vernier::Isometry3& a);
  RealMatrix(const vernier::PointRows& a);
  RealMatrix(const vernier::JointRows<6>& a);
  RealMatrix(const Eigen::Matrix<double, 6, Eigen::Dynamic>& a);
  static RealMatrix of(const vernier::ConstMatrixRef& a);
  static RealMatrix identity(Index n);
  /// Zeros but for its diagonal.
  static RealMatrix diagonal(const RealMatrix& column);

  // What Vernier's functions take, of matrices with that shape alone; vectors are one column.
  operator const vernier::MatrixX&() const { return values_; }
  operator vernier::ConstMatrixRef() const;
  operator vernier::VectorX() const;
  operator vernier::ConstVectorRef() const;
  operator vernier::Matrix3() const;
  operator vernier::Vector3() const;
  operator vernier::Matrix6() const;

  Index rows() const { return values_.rows(); }
  Index cols() const { return values_.cols(); }
  double& operator()(Index i, Index j) { return values_(i, j); }
  double operator()(Index i, Index j) const { return values_(i, j); }
  /// An element of a column.
  double& operator()(Index i) { return values_(i, 0); }
  double operator()(Index i) const { return values_(i, 0); }

  RealMatrix row(Index i) const;
  RealMatrix col(Index j) const;
  RealMatrix block(Index row, Index col, Index rows, Index cols) const;
  void set_block(Index row, Index col, const RealMatrix& values);
  void add_block(Index row, Index col, const RealMatrix& values);
  /// Its diagonal as a column.
  RealMatrix diagonal() const;
  RealMatrix transpose() const;

  /// By QR decomposition with column pivoting.
  RealMatrix inverse() const;
  double determinant() const;
  // Of a symmetric positive definite matrix, by its Cholesky factor.
  double log_determinant() const;
  RealMatrix solve_by_cholesky(const RealMatrix& right) const;
  /// x of least |this x - right|, by QR decomposition with column pivoting.
  RealMatrix solve(const RealMatrix& right) const;
  /// Decreasing.
  RealMatrix singular_values() const;
  /// Of a symmetric matrix, increasing.
  RealMatrix symmetric_eigenvalues() const;

  /// Element by element.
  RealMatrix times(const RealMatrix& other) const;
  RealMatrix over(const RealMatrix& other) const;
  RealMatrix sqrt() const;

  /// Square root of the sum of squares.
  double norm() const;
  double squared_norm() const;
  /// Largest absolute value; NaN where there is one.
  double largest() const;
  double sum() const;
  double mean() const;
  double trace() const;
  /// Sum of products of elements.
  double dot(const RealMatrix& other) const;

  RealMatrix& operator+=(const RealMatrix& other);
  RealMatrix& operator-=(const RealMatrix& other);
  RealMatrix& operator*=(double factor);
  RealMatrix operator-() const;
  friend RealMatrix operator+(const RealMatrix& a, const RealMatrix& b);
  friend RealMatrix operator-(const RealMatrix& a, const RealMatrix& b);
  friend RealMatrix operator*(const RealMatrix& a, const RealMatrix& b);
  friend RealMatrix operator*(double factor, const RealMatrix& a);
  friend RealMatrix operator*(const RealMatrix& a, double factor);
  friend RealMatrix operator/(const RealMatrix& a, double divisor);
  /// Same shape, same values.
  friend bool operator==(const RealMatrix& a, const RealMatrix& b);

 private:
  vernier::MatrixX values_{};
};

/// One column, by its elements.
RealMatrix vector(std::initializer_list<double> elements);

/// The matrix with zeros above its diagonal.
RealMatrix lower_triangle(RealMatrix a);

/// Largest absolute difference of elements; infinite where the shapes differ, NaN where a difference is.
double difference(const RealMatrix& a, const RealMatrix& b);

/// How GoogleTest shows one.
void PrintTo(const RealMatrix& a, std::ostream* out);

}  // namespace vernier_test
