// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Products and linear systems of a few rows, column-major, in plain loops: for so few, Eigen's decompositions of
/// run-time size cost twice as much, and those of a fixed size take a compiler a second each.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "vernier/core/same_value.hpp"
#include "vernier/core/simd.hpp"

namespace vernier::detail {

/// Whether n numbers are finite.
inline bool are_finite(const double* values, int n) noexcept {
  return std::all_of(values, values + n, [](double value) { return std::isfinite(value); });
}

/// Scalar product of six numbers.
inline double dot6(const double* a, const double* b) noexcept {
  return ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) + (a[4] * b[4] + a[5] * b[5]);
}

/// An even number N of values in vector registers. Loads have the width of the stores before them, so that they are
/// forwarded.
template <int N>
struct FewNumbers {
  static_assert(N % 2 == 0);
  Simd<2>::Double pair[N / 2];

  VERNIER_INLINE explicit FewNumbers(const double* from, double factor = 1) noexcept {
    VERNIER_UNROLL
    for (int i = 0; i < N / 2; ++i) {
      load<2>(pair[i], from + 2 * i);
      pair[i] *= factor;
    }
  }
  /// += factor * other
  VERNIER_INLINE void add(double factor, const FewNumbers& other) noexcept {
    VERNIER_UNROLL
    for (int i = 0; i < N / 2; ++i) pair[i] += factor * other.pair[i];
  }
  VERNIER_INLINE void store(double* to) const noexcept {
    VERNIER_UNROLL
    for (int i = 0; i < N / 2; ++i) detail::store<2>(to + 2 * i, pair[i]);
  }
};

/// out = a x, a of Rows x Columns, column-major.
template <int Rows, int Columns>
VERNIER_INLINE void multiply_few(const double* a, const double* x, double* out) noexcept {
  FewNumbers<Rows> sum(a, x[0]);
  VERNIER_UNROLL
  for (int k = 1; k < Columns; ++k) sum.add(x[k], FewNumbers<Rows>(a + k * Rows));
  sum.store(out);
}

/// Solves `a x = b` for a symmetric positive definite matrix, its lower triangle; LDL' in place, then b is x.
inline void solve_few(double* a, double* b, int n) noexcept {
  for (int j = 0; j < n; ++j) {
    double* const column = a + j * n;
    for (int k = 0; k < j; ++k) {
      const double* const before = a + k * n;
      const double factor = before[j] * before[k];  // before[k]: pivot k
      for (int i = j; i < n; ++i) column[i] -= factor * before[i];
    }
    const double inverse = 1 / column[j];
    for (int i = j + 1; i < n; ++i) column[i] *= inverse;
    for (int i = j + 1; i < n; ++i) b[i] -= column[i] * b[j];
  }
  for (int j = n - 1; j >= 0; --j) {
    const double* const column = a + j * n;
    double sum = b[j] / column[j];
    for (int i = j + 1; i < n; ++i) sum -= column[i] * b[i];
    b[j] = sum;
  }
}

/// Determinant of an N x N matrix, which is overwritten: Gaussian elimination with row pivoting.
template <int N>
double determinant_few(double (&a)[N][N]) noexcept {
  double out = 1;
  for (int k = 0; k < N; ++k) {
    int pivot = k;
    for (int i = k + 1; i < N; ++i)
      if (std::abs(a[k][i]) > std::abs(a[k][pivot])) pivot = i;
    if (same_value(a[k][pivot], 0)) return 0;
    out *= pivot == k ? a[k][k] : -a[k][pivot];
    for (int j = k; j < N; ++j) std::swap(a[j][k], a[j][pivot]);
    for (int i = k + 1; i < N; ++i) a[k][i] /= a[k][k];
    for (int j = k + 1; j < N; ++j)
      for (int i = k + 1; i < N; ++i) a[j][i] -= a[k][i] * a[j][k];
  }
  return out;
}

/// Inverse of an N x N matrix, by Gauss-Jordan elimination with row pivoting; entries that are not finite for a
/// singular one. Rows are put in order at the end.
template <int N>
void invert_few(const double* matrix, double* out) noexcept {
  double a[N * N];
  for (int j = 0; j < N; ++j) FewNumbers<N>(matrix + j * N).store(a + j * N);
  static constexpr std::array<double, 2 * N> unit = [] {
    std::array<double, 2 * N> zeros_and_one{};
    zeros_and_one[N] = 1;
    return zeros_and_one;
  }();
  unsigned used = 0;
  int row[N];
  for (int k = 0; k < N; ++k) {
    double* const column = a + k * N;
    int pivot = 0;
    double largest = -1;
    for (int i = 0; i < N; ++i) {
      if ((used >> i & 1u) != 0 || !(std::abs(column[i]) > largest)) continue;
      largest = std::abs(column[i]);
      pivot = i;
    }
    used |= 1u << pivot;
    row[k] = pivot;
    const double inverse = 1 / column[pivot];
    const FewNumbers<N> of_pivot(unit.data() + N - pivot), before(column);
    FewNumbers<N> factor = of_pivot, left = of_pivot;
    VERNIER_UNROLL
    for (int i = 0; i < N / 2; ++i) {
      factor.pair[i] = inverse * (of_pivot.pair[i] - before.pair[i]);
      left.pair[i] += factor.pair[i];
    }
    for (int j = 0; j < N; ++j) {
      if (j == k) continue;
      FewNumbers<N> changed(a + j * N);
      changed.add(a[j * N + pivot], factor);
      changed.store(a + j * N);
    }
    left.store(column);
  }
  for (int j = 0; j < N; ++j)
    for (int k = 0; k < N; ++k) out[row[j] * N + k] = a[j * N + row[k]];
}

}  // namespace vernier::detail
