#pragma once

#include "vernier/core/check.hpp"
#include "vernier/regression/kernel_predictor.hpp"

namespace vernier::detail {

VERNIER_IMPL MatrixX kernel_matrix(Kernel kernel, const ConstMatrixRef& features) {
  const Index n = features.rows();
  MatrixX out(n, n);
  VectorX square, s;
  for (Index j = 0; j < n; ++j) {
    const Index rest = n - j;
    square = (features.bottomRows(rest).rowwise() - features.row(j)).rowwise().squaredNorm();
    if (kernel == Kernel::squared_exponential) {
      out.col(j).tail(rest) = (-0.5 * square.array()).exp().matrix();
    } else {
      s = (5.0 * square).cwiseSqrt();
      out.col(j).tail(rest) = ((1 + s.array() + s.array().square() / 3) * (-s.array()).exp()).matrix();
    }
  }
  return out;
}

VERNIER_IMPL NodeSum node_sum_of(const FittedKernels& fitted, int inputs) {
  const Index f = feature_count(fitted.input_map, inputs), n = fitted.centres.rows();
  require(fitted.centres.cols() == f && fitted.alpha.rows() == n && fitted.scaling.offset.size() == f &&
              fitted.scaling.factor.size() == f,
          "KernelPredictor: ", n, " centres of ", fitted.centres.cols(), " features (expected ", f, ") and ",
          fitted.alpha.rows(), " coefficients");
  const NodeFunction function =
      fitted.kernel == Kernel::squared_exponential ? NodeFunction::squared_exponential : NodeFunction::matern_5_2;
  return {function,  fitted.input_map, inputs,     fitted.scaling, MatrixX(fitted.centres.transpose()),
          VectorX(), fitted.alpha,     fitted.mean};
}

}  // namespace vernier::detail
