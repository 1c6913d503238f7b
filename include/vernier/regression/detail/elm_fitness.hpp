// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The objective of a search over an ELM's hidden weights: the training error.

#include "vernier/regression/hidden_layer.hpp"

namespace vernier::detail {

/// Fitness of hidden weights, `min over beta of (|H beta - T|^2 + lambda |beta|^2) / n`; columns of a population are
/// independent.
class ElmFitness {
 public:
  /// @param layer           the nodes
  /// @param features        n x f, scaled
  /// @param targets         n x m, scaled
  /// @param relative_lambda ridge, relative to tr(H'H) / nodes
  /// @param weights         of the samples; null: all the same
  VERNIER_API ElmFitness(const HiddenLayer& layer, MatrixX features, MatrixX targets, double relative_lambda,
                         const VectorX* weights);

  /// @param population dimension x particles
  /// @param fitness    one value a particle
  VERNIER_API void operator()(const ConstMatrixRef& population, VectorRef fitness) const;

 private:
  VERNIER_API double from_samples(const ConstVectorRef& theta) const;

  HiddenLayer layer_;
  MatrixX features_, targets_;
  VectorX roots_;  // of the weights; empty: all are 1
  double total_weight_, relative_lambda_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/elm_fitness.ipp"
#endif
