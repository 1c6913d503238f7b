// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "vernier/regression/least_squares.hpp"
#include "vernier/regression/ridge_elm.hpp"

namespace vernier {

VERNIER_IMPL Box RidgeElm::box(int inputs) const { return layer().box(inputs); }

VERNIER_IMPL detail::RidgeElmLeaveOneOutError RidgeElm::leave_one_out_error(const ConstMatrixRef& inputs,
                                                                            const ConstMatrixRef& targets,
                                                                            const VectorX* weights) const {
  const MatrixX mapped = layer().map(inputs);
  return {layer(), layer().scaling(mapped).apply(mapped), targets, weights};
}

VERNIER_IMPL detail::FittedNetwork RidgeElm::solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                                   const VectorX& theta, const FitOptions& options) const {
  const Index expected = dimension(static_cast<int>(inputs.cols()));
  demand(theta.size() == expected, "RidgeElm: ", theta.size(), " hidden weights, expected ", expected);
  const MatrixX mapped = layer().map(inputs);
  const ColumnScaling in = layer().scaling(mapped);
  MatrixX h;
  layer().outputs(in.apply(mapped), theta, h);
  const RidgePath path(h, targets, options.weights);
  double lambda = choose_lambda(path, h.rows()).lambda;
  // in standard errors: among many layers a search finds one that is a little better by chance
  constexpr double enough = 3;
  if (evidence_against_mean(path, lambda, h.rows()) < enough) lambda = std::numeric_limits<double>::infinity();
  const MatrixX beta = path.beta(lambda);
  return {layer(), in, theta, beta, path.offset(beta)};
}

}  // namespace vernier
