// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Orthogonal forward selection of hidden nodes.

#include <vector>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Nodes in the order of orthogonal forward selection, and the leave-one-out error (PRESS) of the
/// least-squares fit on the first 0, 1, 2, ... of them and a constant.
struct RankedNodes {
  std::vector<Index> order;   ///< of columns of H; those left out depend on the ones before
  std::vector<double> press;  ///< weighted mean square of the left-out errors, summed over outputs; order.size() + 1
};

/// Each step takes the column that, made orthogonal to those taken, lowers the squared error of all targets together by
/// the most. The orthogonal basis gives every residual and leverage, and so PRESS of every count, as it grows: O(n h^2)
/// for all. Where a sample has leverage one, the left-out error of that count is infinity.
/// @param h       n x nodes
/// @param targets n x outputs
/// @param weights n; a sample is left out with all its weight
/// @cite Chen, Cowan and Grant 1991; Allen 1974
VERNIER_API RankedNodes rank_nodes(const ConstMatrixRef& h, const ConstMatrixRef& targets, const VectorX& weights);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/rank_nodes.ipp"
#endif
