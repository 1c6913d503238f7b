// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier {

VERNIER_IMPL Box Elm::box(int inputs) const { return layer().box(inputs); }

VERNIER_IMPL void Elm::validate() const {
  layer().validate("Elm");
  demand(rcond >= 0 && rcond < 1, "Elm: rcond is ", rcond, ", must lie in [0, 1)");
}

VERNIER_IMPL detail::ElmFitness Elm::fitness(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                             const VectorX* weights) const {
  constexpr double fitness_lambda = 1e-10;  // ridge of the fitness alone, relative to tr(H'H) / nodes
  const MatrixX mapped = layer().map(inputs);
  return {layer(), layer().scaling(mapped).apply(mapped), ColumnScaling::fit(targets, target_scaling).apply(targets),
          fitness_lambda, weights};
}

VERNIER_IMPL detail::FittedNetwork Elm::solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                              const VectorX& theta, const FitOptions& options) const {
  const Index expected = dimension(static_cast<int>(inputs.cols()));
  demand(theta.size() == expected, "Elm: ", theta.size(), " hidden weights, expected ", expected);
  const MatrixX mapped = layer().map(inputs);
  const ColumnScaling in = layer().scaling(mapped), out = ColumnScaling::fit(targets, target_scaling);
  MatrixX h, t = out.apply(targets);
  layer().outputs(in.apply(mapped), theta, h);
  if (options.weights != nullptr) {
    const VectorX roots = options.weights->cwiseSqrt();
    h = detail::rows_scaled(roots, h);
    t = detail::rows_scaled(roots, t);
  }
  MatrixX beta = minimum_norm_solution(h, t, rcond);
  for (Index o = 0; o < beta.cols(); ++o) VERNIER_LATER(beta).col(o) /= out.factor(o);
  return {layer(), in, theta, beta, out.offset};
}

}  // namespace vernier
