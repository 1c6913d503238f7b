// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The reduced objective of `VarProElm` for searches.

#include <optional>

#include "vernier/regression/hidden_layer.hpp"

namespace vernier::detail {

/// The reduced objective of `VarProElm` for searches: see `VarProElm::objective`.
class VarProTrainingError {
 public:
  /// @param layer    the nodes
  /// @param features n x f, scaled
  /// @param targets  n x m, scaled
  /// @param ridge    of the output weights, per sample
  /// @param weights  of the samples; null: all the same
  VERNIER_API VarProTrainingError(const HiddenLayer& layer, MatrixX features, MatrixX targets, double ridge,
                                  const VectorX* weights);

  /// @param population dimension x particles
  /// @param fitness    one value a particle
  VERNIER_API void operator()(const ConstMatrixRef& population, VectorRef fitness) const;

  /// Its exact gradient with respect to the hidden weights.
  VERNIER_API VectorX gradient(const ConstVectorRef& theta) const;

 private:
  const VectorX* weights() const { return weights_ ? &*weights_ : nullptr; }

  HiddenLayer layer_;
  MatrixX features_, targets_;
  double ridge_;
  std::optional<VectorX> weights_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/var_pro_training_error.ipp"
#endif
