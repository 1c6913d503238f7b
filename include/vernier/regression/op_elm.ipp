// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/rank_nodes.hpp"
#include "vernier/regression/op_elm.hpp"

namespace vernier {

VERNIER_IMPL detail::FittedNetwork OpElm::solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                                const FitOptions& options) const {
  const int n = static_cast<int>(inputs.cols());
  const VectorX weights = detail::weights_or_ones(options.weights, inputs.rows());
  const MatrixX mapped = layer().map(inputs);
  const ColumnScaling scaling = layer().scaling(mapped);
  const VectorX theta = layer().draw(n, options.seed);
  MatrixX h;
  layer().outputs(scaling.apply(mapped), theta, h);

  const VectorX mean = detail::transposed_product(targets, weights) / weights.sum();
  const MatrixX centred = detail::rows_minus(targets, mean);
  const detail::RankedNodes ranked = detail::rank_nodes(h, centred, weights);
  std::size_t kept = 0;
  for (std::size_t count = 1; count < ranked.press.size(); ++count)
    if (ranked.press[count] < ranked.press[kept]) kept = count;

  HiddenLayer pruned = layer();
  pruned.nodes = (std::max)(1, static_cast<int>(kept));
  const Index each = layer().features(n) + 1;
  if (kept == 0) return {pruned, scaling, VERNIER_LATER(theta).head(each), MatrixX::Zero(1, targets.cols()), mean};
  const std::vector<Index> nodes(ranked.order.begin(), ranked.order.begin() + static_cast<std::ptrdiff_t>(kept));
  MatrixX design = MatrixX::Ones(h.rows(), pruned.nodes + 1);
  VectorX chosen(each * pruned.nodes);
  for (Index k = 0; k < pruned.nodes; ++k) {
    const Index node = nodes[static_cast<std::size_t>(k)];
    VERNIER_LATER(design).col(k) = VERNIER_LATER(h).col(node);
    VERNIER_LATER(chosen).segment(k * each, each) = VERNIER_LATER(theta).segment(node * each, each);
  }
  const VectorX root = VERNIER_LATER(weights).cwiseSqrt();
  const MatrixX beta =
      detail::solve_by_qr(detail::rows_scaled(root, design), detail::rows_scaled(root, centred)).solution;
  return {pruned, scaling, chosen, VERNIER_LATER(beta).topRows(pruned.nodes),
          detail::row_of(beta, pruned.nodes) + mean};
}

}  // namespace vernier
