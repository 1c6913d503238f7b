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

  const Eigen::RowVectorXd mean = weights.transpose() * targets / weights.sum();
  const detail::RankedNodes ranked = detail::rank_nodes(h, targets.rowwise() - mean, weights);
  std::size_t kept = 0;
  for (std::size_t count = 1; count < ranked.press.size(); ++count)
    if (ranked.press[count] < ranked.press[kept]) kept = count;

  HiddenLayer pruned = layer();
  pruned.nodes = std::max(1, static_cast<int>(kept));
  const Index each = layer().features(n) + 1;
  if (kept == 0) return {pruned, scaling, theta.head(each), MatrixX::Zero(1, targets.cols()), mean};
  const std::vector<Index> nodes(ranked.order.begin(), ranked.order.begin() + static_cast<std::ptrdiff_t>(kept));
  MatrixX design(h.rows(), pruned.nodes + 1);
  design << h(Eigen::all, nodes), VectorX::Ones(h.rows());
  const VectorX root = weights.cwiseSqrt();
  const MatrixX beta =
      detail::solve_by_qr(root.asDiagonal() * design, root.asDiagonal() * (targets.rowwise() - mean)).solution;
  const MatrixX chosen = theta.reshaped(each, hidden_nodes)(Eigen::all, nodes);
  return {pruned, scaling, chosen.reshaped(), beta.topRows(pruned.nodes), (beta.bottomRows(1) + mean).transpose()};
}

}  // namespace vernier
