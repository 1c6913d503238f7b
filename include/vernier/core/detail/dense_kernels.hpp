// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Kernels of dense algebra, of which the library has a copy for each instruction set. Plain pointers: no type of Eigen
/// may pass between units that are compiled for different ones.

#include <cstddef>

#include "vernier/core/language.hpp"

namespace vernier::detail {

/// A column-major matrix somewhere in memory.
template <class T>
struct MatrixAt {
  T* data;                ///< first entry
  std::ptrdiff_t stride;  ///< from a column to the next
  std::ptrdiff_t rows;    ///< number of rows
  std::ptrdiff_t cols;    ///< number of columns
};

/// Products and triangular solves for one instruction set; see `dense.hpp`.
struct DenseKernels {
  void (*add_product)(MatrixAt<double> out, MatrixAt<const double> a, MatrixAt<const double> b, double factor);
  void (*add_transposed_product)(MatrixAt<double> out, MatrixAt<const double> a, MatrixAt<const double> b,
                                 double factor);
  bool (*cholesky)(MatrixAt<double> matrix);
  void (*solve_lower)(MatrixAt<const double> factor, MatrixAt<double> right);
  void (*solve_lower_transposed)(MatrixAt<const double> factor, MatrixAt<double> right);
};

/// With AVX2 and FMA.
extern const DenseKernels avx2_kernels;
/// With AVX-512.
extern const DenseKernels avx512_kernels;

}  // namespace vernier::detail
