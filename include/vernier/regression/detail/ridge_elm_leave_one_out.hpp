// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The objective of a search over the hidden weights of a `RidgeElm`.

#include "vernier/regression/hidden_layer.hpp"

namespace vernier::detail {

/// Fitness of hidden weights: the leave-one-out error at the best ridge, the mean alone among the candidates.
class RidgeElmLeaveOneOutError {
 public:
  /// @param layer    the nodes
  /// @param features n x f, scaled
  /// @param targets  n x m
  /// @param weights  of the samples; null: all the same
  VERNIER_API RidgeElmLeaveOneOutError(const HiddenLayer& layer, MatrixX features, MatrixX targets,
                                       const VectorX* weights);

  /// @param population dimension x particles
  /// @param fitness    one value a particle
  VERNIER_API void operator()(const ConstMatrixRef& population, VectorRef fitness) const;

 private:
  HiddenLayer layer_;
  MatrixX features_, targets_;
  VectorX weights_;  // empty: all the same
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/ridge_elm_leave_one_out.ipp"
#endif
