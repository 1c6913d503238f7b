// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/regression/kernel_predictor.hpp"

namespace vernier::detail {

VERNIER_IMPL void exponentiate(VectorX& values) { VERNIER_LATER(values).array() = VERNIER_LATER(values).array().exp(); }

VERNIER_IMPL void kernel_values(Kernel kernel, VectorX& squares) {
  if (kernel == Kernel::squared_exponential) {
    squares *= -0.5;
    exponentiate(squares);
    return;
  }
  squares *= 5;
  const VectorX s = VERNIER_LATER(squares).cwiseSqrt();
  squares = -1 * s;
  exponentiate(squares);
  for (Index i = 0; i < s.size(); ++i) squares(i) *= 1 + s(i) * (1 + s(i) * (1.0 / 3));
}

VERNIER_IMPL MatrixX kernel_matrix(Kernel kernel, const ConstMatrixRef& features) {
  const Index n = features.rows();
  MatrixX out(n, n);
  VectorX squares;
  for (Index j = 0; j < n; ++j) {
    squares.setZero(n - j);
    for (Index f = 0; f < features.cols(); ++f)
      for (Index i = j; i < n; ++i) {
        const double along = features(i, f) - features(j, f);
        squares(i - j) += along * along;
      }
    kernel_values(kernel, squares);
    std::copy(squares.begin(), squares.end(), &out(j, j));
  }
  return out;
}

VERNIER_IMPL NodeSum node_sum_of(const FittedKernels& fitted, int inputs) {
  const Index f = feature_count(fitted.input_map, inputs), n = fitted.centres.rows();
  demand(fitted.centres.cols() == f && fitted.alpha.rows() == n && fitted.scaling.offset.size() == f &&
             fitted.scaling.factor.size() == f,
         "KernelPredictor: ", n, " centres of ", fitted.centres.cols(), " features (expected ", f, ") and ",
         fitted.alpha.rows(), " coefficients");
  const NodeFunction function =
      fitted.kernel == Kernel::squared_exponential ? NodeFunction::squared_exponential : NodeFunction::matern_5_2;
  return {function,  fitted.input_map, inputs,     fitted.scaling, VERNIER_LATER(fitted.centres).transpose(),
          VectorX(), fitted.alpha,     fitted.mean};
}

}  // namespace vernier::detail
