// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/concepts.hpp"
#include "vernier/regression/detail/layer_equations.hpp"
#include "vernier/regression/detail/var_pro_training_error.hpp"
#include "vernier/regression/detail/variable_projection.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::detail {

VERNIER_IMPL VarProTrainingError::VarProTrainingError(const HiddenLayer& layer, MatrixX features, MatrixX targets,
                                                      double ridge, const VectorX* weights)
    : layer_(layer), features_(std::move(features)), targets_(std::move(targets)), ridge_(ridge) {
  if (weights != nullptr) weights_ = *weights;
}

VERNIER_IMPL void VarProTrainingError::operator()(const ConstMatrixRef& population, VectorRef fitness) const {
  const VectorX roots = VERNIER_LATER(weights_or_ones(weights(), targets_.rows())).cwiseSqrt();
  const double n = roots.squaredNorm(), target_square = rows_scaled(roots, targets_).squaredNorm();
  MatrixX ones_and_targets(targets_.rows(), targets_.cols() + 1);
  VERNIER_LATER(ones_and_targets).col(0).setOnes();
  VERNIER_LATER(ones_and_targets).rightCols(targets_.cols()) = targets_;
  LayerEquations equations(layer_, features_, ones_and_targets, widest_instruction_set(), false,
                           weights_ ? roots.data() : nullptr);
  std::optional<VariableProjection> projection;
  for (Index k = 0; k < population.cols(); ++k) {
    double objective = -1;
    if (LayerEquations::supports(layer_.activation)) {
      equations.form(VERNIER_LATER(population).col(k));
      const VectorX sum = row_of(equations.right(), 0);
      MatrixX gram = equations.gram();
      const double trace = diagonal_of(gram).sum();
      for (Index c = 0; c < gram.cols(); ++c)
        for (Index r = c; r < gram.rows(); ++r) gram(r, c) -= sum(r) * sum(c) / n;
      const ConstMatrixRef right = VERNIER_LATER(equations.right()).bottomRows(targets_.cols());
      objective = objective_from_products(gram, right, target_square, ridge_weights(gram, right, ridge_ * n),
                                          ridge_ * n, trace);
    }
    if (!(objective >= 0)) {  // too nearly perfect or too badly conditioned for the products
      if (!projection) projection.emplace(layer_, features_, targets_, ridge_, weights());
      objective = projection->evaluate(VERNIER_LATER(population).col(k)) * n;
    }
    fitness(k) = objective / n;
  }
}

VERNIER_IMPL VectorX VarProTrainingError::gradient(const ConstVectorRef& theta) const {
  VariableProjection projection(layer_, features_, targets_, ridge_, weights());
  demand(theta.size() == projection.dimension(), "VarProElm: ", theta.size(), " hidden weights, expected ",
         projection.dimension());
  projection.evaluate(theta);
  return projection.gradient();
}

}  // namespace vernier::detail
