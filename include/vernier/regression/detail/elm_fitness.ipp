// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/elm_fitness.hpp"
#include "vernier/regression/detail/layer_equations.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::detail {

VERNIER_IMPL ElmFitness::ElmFitness(const HiddenLayer& layer, MatrixX features, MatrixX targets, double relative_lambda,
                                    const VectorX* weights)
    : layer_(layer),
      features_(std::move(features)),
      targets_(std::move(targets)),
      total_weight_(static_cast<double>(features_.rows())),
      relative_lambda_(relative_lambda) {
  if (weights == nullptr) return;
  roots_ = weights->cwiseSqrt();
  total_weight_ = roots_.squaredNorm();
}

VERNIER_IMPL void ElmFitness::operator()(const ConstMatrixRef& population, VectorRef fitness) const {
  std::optional<LayerEquations> equations;
  if (LayerEquations::supports(layer_.activation))
    equations.emplace(layer_, features_, targets_, widest_instruction_set(), false,
                      roots_.size() > 0 ? roots_.data() : nullptr);
  for (Index k = 0; k < population.cols(); ++k) {
    double error = -1;
    if (equations) {
      equations->form(VERNIER_LATER(population).col(k));
      error =
          relative_ridge_objective(equations->gram(), equations->right(), equations->target_square(), relative_lambda_);
    }
    // too nearly perfect or too badly conditioned for the products
    if (!(error >= 0)) error = from_samples(VERNIER_LATER(population).col(k));
    fitness(k) = error / total_weight_;
  }
}

VERNIER_IMPL double ElmFitness::from_samples(const ConstVectorRef& theta) const {
  MatrixX h;
  layer_.outputs(features_, theta, h);
  if (roots_.size() == 0) return relative_ridge(h, targets_, relative_lambda_).objective;
  return relative_ridge(rows_scaled(roots_, h), rows_scaled(roots_, targets_), relative_lambda_).objective;
}

}  // namespace vernier::detail
