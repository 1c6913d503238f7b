// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Householder reflections of small dense matrices, column-major, in plain loops: Eigen's blocked ones take a compiler
/// several seconds for each size. @cite Golub and Van Loan 2013

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "vernier/core/language.hpp"

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

/// Eigenvalues of an upper n x n Hessenberg matrix, which is overwritten, by QR steps with double shifts.
/// @return whether they converged
/// @cite Golub and Van Loan 2013
inline bool hessenberg_eigenvalues(double* a, int n, std::complex<double>* out) noexcept {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  constexpr int most_steps = 60;  // for one eigenvalue or pair; three are usual
  const auto at = [&](int i, int j) -> double& { return a[j * n + i]; };
  double size = 0;
  for (int k = 0; k < n * n; ++k) size = (std::max)(size, std::abs(a[k]));
  for (int last = n - 1, steps = 0; last >= 0;) {
    int first = last;  // of the block that is left
    for (; first > 0; --first) {
      const double around = std::abs(at(first, first)) + std::abs(at(first - 1, first - 1));
      if (std::abs(at(first, first - 1)) <= epsilon * (around > 0 ? around : size)) break;
    }
    const double below = first < last ? at(last, last - 1) : 0, beside = first < last ? at(last - 1, last) : 0;
    double x = at(last, last), y = first < last ? at(last - 1, last - 1) : x, product = below * beside;
    if (first == last) {
      out[last--] = x;
      steps = 0;
      continue;
    }
    if (first == last - 1) {
      const double middle = (x + y) / 2, half = y - middle;
      const std::complex<double> root = std::sqrt(std::complex<double>(half * half + product));
      out[first] = middle + root;
      out[last] = middle - root;
      last -= 2;
      steps = 0;
      continue;
    }
    if (++steps > most_steps) return false;
    if (steps % 10 == 0) {  // shifts of their own where the usual ones go round in circles
      const double away = std::abs(below) + std::abs(at(last - 1, last - 2));
      x = y = x + 0.75 * away;
      product = -0.4375 * away * away;
    }
    // The first column of (A - shift)(A - other shift), from where two small entries below the diagonal let it begin.
    int begin = last - 2;
    double v[3];
    for (;; --begin) {
      const double here = at(begin, begin), next = at(begin + 1, begin + 1), r = x - here, s = y - here;
      v[0] = (r * s - product) / at(begin + 1, begin) + at(begin, begin + 1);
      v[1] = next - here - r - s;
      v[2] = at(begin + 2, begin + 1);
      if (begin == first) break;
      const double before = std::abs(at(begin - 1, begin - 1)), rest = std::abs(v[1]) + std::abs(v[2]);
      if (std::abs(at(begin, begin - 1)) * rest <=
          epsilon * std::abs(v[0]) * (before + std::abs(here) + std::abs(next)))
        break;
    }
    for (int k = begin; k < last; ++k) {
      const int rows = (std::min)(3, last - k + 1);
      if (k > begin) std::copy_n(&at(k, k - 1), rows, v);
      to_reflector(v, rows);
      for (int j = (std::max)(k - 1, first); j <= last; ++j) reflect(v, &at(k, j), rows);
      for (int i = first; i <= (std::min)(k + 3, last); ++i) reflect(v, &at(i, k), rows, n);
      for (int i = k + 1; k > first && i < k + rows; ++i) at(i, k - 1) = 0;
    }
  }
  return true;
}

}  // namespace vernier::detail
