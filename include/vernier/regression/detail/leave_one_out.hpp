// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The leave-one-out error of a ridge regression on a hidden layer from products of its outputs, without their singular
/// value decomposition: the inner loop of searches that `RidgeElm` serves.
///
/// With H'H = V S^2 V' (centred) the rotated outputs P = H V give every leverage `1/n + sum_j P_j^2 / (s_j^2 + lambda)`
/// and every prediction, for all lambda at once. One pass over the samples forms the products, one the errors, tile by
/// tile; per sample h^2 multiply-adds to rotate and h (1 + outputs) for each lambda.

#include <vector>

#include "vernier/regression/detail/layer_equations.hpp"

namespace vernier::detail {

/// Leave-one-out errors of hidden weights at the best ridge. Allocates in the constructor, and the decomposition of
/// the nodes' Gram matrix.
class LeaveOneOutError {
 public:
  /// Whether there is a kernel for these nodes and this number of samples: n centred samples span n - 1 dimensions, so
  /// with n - 1 nodes or more every leverage is one.
  static bool supports(const HiddenLayer& layer, Index samples) {
    return LayerEquations::supports(layer.activation) && samples >= layer.nodes + 2 && samples >= 8;
  }

  /// @param features samples x inputs, scaled; must outlive this
  /// @param targets  samples x outputs; must outlive this
  VERNIER_API LeaveOneOutError(const HiddenLayer& layer, const MatrixX& features, const MatrixX& targets,
                               InstructionSet set = widest_instruction_set());
  LeaveOneOutError(const LeaveOneOutError&) = delete;
  LeaveOneOutError& operator=(const LeaveOneOutError&) = delete;

  /// Mean squared error at the best of the ridges 1, 10^-0.5, ... 10^-12 times the largest squared singular value, and
  /// of the mean alone; equals that of `choose_lambda` to 1e-8. -1 where products are not that accurate: the best
  /// ridge is below 10^-8, a sample has a leverage near one, or nodes are nearly constant.
  VERNIER_API double operator()(const ConstVectorRef& theta);

 private:
  static constexpr Index lambdas = 25, padded_lambdas = 32, trusted = 17;

  HiddenLayer layer_;
  Index samples_, outputs_, rotated_;
  InstructionSet set_;
  VectorX mean_target_;
  MatrixX mean_feature_, targets_and_ones_, shift_;
  double centred_square_ = 0;
  LayerEquations equations_;
  std::vector<double> scratch_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/leave_one_out.ipp"
#endif
