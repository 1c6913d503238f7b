// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/regression/detail/kernel_system.hpp"
#include "vernier/regression/detail/marginal_likelihood.hpp"

namespace vernier::detail {

VERNIER_IMPL VectorX varying_outputs(const ConstMatrixRef& targets) {
  VectorX out(targets.cols());
  for (Index o = 0; o < targets.cols(); ++o) {
    const double low = VERNIER_LATER(targets).col(o).minCoeff(), high = VERNIER_LATER(targets).col(o).maxCoeff();
    out(o) = high - low > 1e-12 * (std::max)(std::abs(low), std::abs(high)) ? 1 : 0;
  }
  return out;
}

VERNIER_IMPL double MarginalLikelihood::operator()(const VectorX& logarithms, VectorX& gradient) const {
  const Index n = features_.rows();
  const double ratio = std::exp(logarithms(inputs_)), total = weights_.sum(), outputs = varying_.sum();
  gradient = VectorX::Zero(inputs_ + 1);
  if (same_value(outputs, 0)) return 0;
  MatrixX x = features_;
  for (Index j = 0; j < x.cols(); ++j) VERNIER_LATER(x).col(j) *= std::exp(-logarithms(j % inputs_));
  VectorX noise = VERNIER_LATER(weights_).cwiseInverse();
  noise *= ratio;
  const KernelSystem system(kernel_matrix(kernel_, x), noise, targets_);
  if (!system.solved) return std::numeric_limits<double>::infinity();

  double shared = system.log_determinant() + (total - static_cast<double>(n)) * logarithms(inputs_) +
                  total * (1 + std::log(2 * std::numbers::pi));
  for (const double weight : weights_) shared += std::log(weight);
  double likelihood = -0.5 * outputs * shared;
  // A^-1 outputs - sum of alpha alpha' / s^2, its lower triangle
  MatrixX pull = outputs * inverse_from_cholesky(system.factor);
  for (Index o = 0; o < targets_.cols(); ++o) {
    if (same_value(varying_(o), 0)) continue;
    const double variance = system.square(o) / total;
    if (!(variance > 0)) return std::numeric_limits<double>::infinity();
    likelihood -= 0.5 * total * std::log(variance);
    for (Index b = 0; b < n; ++b) {
      const double of_b = system.alpha(b, o) / variance;
      for (Index a = b; a < n; ++a) pull(a, b) -= of_b * system.alpha(a, o);
    }
  }
  gradient(inputs_) = -0.5 * (diagonal_of(pull).dot(noise) + outputs * (total - static_cast<double>(n)));
  for (Index b = 0; b < n; ++b) {  // all pairs once, so twice the half
    const Index rest = n - b - 1;
    MatrixX square(rest, x.cols());
    VectorX distance = VectorX::Zero(rest);
    for (Index j = 0; j < x.cols(); ++j)
      for (Index i = 0; i < rest; ++i) {
        const double along = x(b + 1 + i, j) - x(b, j);
        square(i, j) = along * along;
        distance(i) += along * along;
      }
    VectorX pulled = slope(std::move(distance));
    for (Index i = 0; i < rest; ++i) pulled(i) *= pull(b + 1 + i, b);
    for (Index j = 0; j < x.cols(); ++j) gradient(j % inputs_) -= pulled.dot(VERNIER_LATER(square).col(j));
  }
  const double scale = -1 / (total * outputs);
  gradient *= scale;
  return scale * likelihood;
}

VERNIER_IMPL VectorX MarginalLikelihood::slope(VectorX square) const {
  if (kernel_ == Kernel::squared_exponential) {
    kernel_values(kernel_, square);  // the kernel itself
    return square;
  }
  VectorX s = 5 * square;
  s = VERNIER_LATER(s).cwiseSqrt();
  VectorX out = -1 * s;
  exponentiate(out);
  for (Index i = 0; i < s.size(); ++i) out(i) *= 5.0 / 3 * (1 + s(i));
  return out;
}

}  // namespace vernier::detail
