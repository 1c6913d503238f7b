#pragma once

/// @file
/// Householder reflections of small dense matrices, column-major, in plain loops: Eigen's blocked ones take a compiler
/// several seconds for each size. @cite Golub and Van Loan 2013

#include <algorithm>
#include <cmath>

namespace vernier::detail {

/// Replaces x by the unit vector v with which `x - 2 v (v.x)` keeps only its first component; by zero where it is zero.
inline void to_reflector(double* x, int n) noexcept {
  double square = 0;
  for (int i = 0; i < n; ++i) square += x[i] * x[i];
  x[0] += std::copysign(std::sqrt(square), x[0]);
  square = 0;
  for (int i = 0; i < n; ++i) square += x[i] * x[i];
  const double inverse = square > 0 ? 1 / std::sqrt(square) : 0;
  for (int i = 0; i < n; ++i) x[i] *= inverse;
}

/// Reflects x, whose entries are `stride` apart.
inline void reflect(const double* v, double* x, int n, int stride = 1) noexcept {
  double along = 0;
  for (int i = 0; i < n; ++i) along += v[i] * x[i * stride];
  for (int i = 0; i < n; ++i) x[i * stride] -= 2 * along * v[i];
}

/// Orthonormal columns, `rows` x (`rows` - `rank`), orthogonal to those `rank` columns of `a` that pivoting finds most
/// independent. Overwrites `a`.
inline void orthogonal_complement(double* a, int rows, int columns, int rank, double* complement) noexcept {
  const auto square = [&](int column, int from) {
    double sum = 0;
    for (int i = from; i < rows; ++i) sum += a[column * rows + i] * a[column * rows + i];
    return sum;
  };
  for (int j = 0; j < rank; ++j) {
    int pivot = j;
    for (int c = j + 1; c < columns; ++c)
      if (square(c, j) > square(pivot, j)) pivot = c;
    if (pivot != j) std::swap_ranges(a + j * rows, a + (j + 1) * rows, a + pivot * rows);
    double* const v = a + j * rows + j;
    to_reflector(v, rows - j);
    for (int c = j + 1; c < columns; ++c) reflect(v, a + c * rows + j, rows - j);
  }
  std::fill_n(complement, rows * (rows - rank), 0.0);
  for (int c = rank; c < rows; ++c, complement += rows) {
    complement[c] = 1;
    for (int j = rank - 1; j >= 0; --j) reflect(a + j * rows + j, complement + j, rows - j);
  }
}

/// An upper Hessenberg matrix with the same eigenvalues, in place of an n x n matrix.
/// @param work n numbers
inline void to_hessenberg(double* a, int n, double* work) noexcept {
  for (int j = 0; j + 2 < n; ++j) {
    const int below = n - j - 1;
    std::copy_n(a + j * n + j + 1, below, work);
    to_reflector(work, below);
    for (int c = j; c < n; ++c) reflect(work, a + c * n + j + 1, below);
    for (int r = 0; r < n; ++r) reflect(work, a + (j + 1) * n + r, below, n);
    std::fill_n(a + j * n + j + 2, below - 1, 0.0);
  }
}

}  // namespace vernier::detail
