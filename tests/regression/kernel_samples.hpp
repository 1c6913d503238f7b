// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Kernels of samples from their formulas, for tests of what is made of kernels.

#include <cmath>

#include "regression_samples.hpp"
#include "vernier/regression/kernel_predictor.hpp"

namespace vernier_test {

/// Kernel of every row of one matrix with every row of another, at distances in units of a length.
inline RealMatrix kernels(vernier::Kernel kernel, const RealMatrix& a, const RealMatrix& b, double length = 1) {
  RealMatrix k(a.rows(), b.rows());
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < b.rows(); ++j) {
      const double r = distance_of_rows(a, i, b, j) / length, s = std::sqrt(5.0) * r;
      k(i, j) =
          kernel == vernier::Kernel::squared_exponential ? std::exp(-r * r / 2) : (1 + s + s * s / 3) * std::exp(-s);
    }
  return k;
}

}  // namespace vernier_test
