// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/concepts.hpp"

namespace vernier::detail {

VERNIER_IMPL void check_samples(const char* caller, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                const VectorX* weights) {
  demand(inputs.rows() == targets.rows(), caller, ": ", inputs.rows(), " rows of inputs, but ", targets.rows(),
         " rows of targets");
  demand(inputs.rows() >= 1, caller, ": no samples");
  demand(all_finite(inputs) && all_finite(targets), caller, ": the samples have a value that is not finite");
  if (weights == nullptr) return;
  demand(weights->size() == inputs.rows(), caller, ": ", weights->size(), " weights for ", inputs.rows(), " samples");
  demand(all_finite(*weights) && weights->minCoeff() > 0, caller, ": the weights go down to ", weights->minCoeff(),
         ", all must be finite and positive");
}

VERNIER_IMPL VectorX weights_or_ones(const VectorX* weights, Index n) {
  return weights != nullptr ? *weights : VectorX(VectorX::Ones(n));
}

VERNIER_IMPL void require_no_weights(const char* caller, const FitOptions& options) {
  demand(options.weights == nullptr, caller, " takes no weights");
}

}  // namespace vernier::detail
