// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/leave_one_out.hpp"
#include "vernier/regression/detail/ridge_elm_leave_one_out.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::detail {

VERNIER_IMPL RidgeElmLeaveOneOutError::RidgeElmLeaveOneOutError(const HiddenLayer& layer, MatrixX features,
                                                                MatrixX targets, const VectorX* weights)
    : layer_(layer), features_(std::move(features)), targets_(std::move(targets)) {
  if (weights != nullptr) weights_ = *weights;
}

VERNIER_IMPL void RidgeElmLeaveOneOutError::operator()(const ConstMatrixRef& population, VectorRef fitness) const {
  std::optional<LeaveOneOutError> products;
  const VectorX* weights = weights_.size() > 0 ? &weights_ : nullptr;
  if (weights == nullptr && LeaveOneOutError::supports(layer_, targets_.rows()))
    products.emplace(layer_, features_, targets_);
  MatrixX h;
  for (Index k = 0; k < population.cols(); ++k) {
    fitness(k) = products ? (*products)(VERNIER_LATER(population).col(k)) : -1;
    if (fitness(k) >= 0) continue;  // else from the singular values
    layer_.outputs(features_, VERNIER_LATER(population).col(k), h);
    fitness(k) = all_finite(h) ? choose_lambda(RidgePath(h, targets_, weights), targets_.rows()).mean_squared_error
                               : std::numeric_limits<double>::infinity();
  }
}

}  // namespace vernier::detail
