#pragma once

/// @file
/// The optimally pruned extreme learning machine: as many of its nodes as leave-one-out asks for.

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

namespace detail {

/// Nodes in the order in which orthogonal forward selection takes them, and the leave-one-out error (PRESS) of the
/// least-squares fit on the first 0, 1, 2, ... of them and a constant.
struct RankedNodes {
  std::vector<Index> order;   ///< of columns of H; those left out depend on the ones before
  std::vector<double> press;  ///< weighted mean square of the left-out errors, summed over outputs; order.size() + 1
};

/// Each step takes the column that, made orthogonal to those taken, lowers the squared error of all targets together by
/// the most. The orthogonal basis gives every residual and leverage, and so PRESS of every count, as it grows: O(n h^2)
/// for all. A count at which a sample is reproduced whatever its target (leverage one) has no error left out: infinity.
/// @param h       n x nodes
/// @param targets n x outputs
/// @param weights n; a sample is left out with all its weight
/// @cite Chen, Cowan and Grant 1991; Allen 1974
template <class H, class T>
RankedNodes rank_nodes(const Eigen::MatrixBase<H>& h, const Eigen::MatrixBase<T>& targets, const VectorX& weights) {
  constexpr double rounding = 1e-10;
  const Index n = h.rows();
  const VectorX root = weights.cwiseSqrt();
  MatrixX columns = root.asDiagonal() * h, residual = root.asDiagonal() * targets;
  VectorX basis = root / root.norm(), leverage = VectorX::Zero(n);
  const VectorX norms = columns.colwise().norm();
  MatrixX taken(n, std::min(n, h.cols() + 1));
  std::vector<Index> left(static_cast<std::size_t>(h.cols()));
  for (Index k = 0; k < h.cols(); ++k) left[static_cast<std::size_t>(k)] = k;

  RankedNodes out;
  for (Index count = 0;; ++count) {
    taken.col(count) = basis;
    leverage += basis.cwiseAbs2();
    residual -= basis * (basis.transpose() * residual);
    const Eigen::ArrayXd kept = 1 - leverage.array();
    out.press.push_back(kept.minCoeff() > 1e-8
                            ? (kept.inverse().matrix().asDiagonal() * residual).squaredNorm() / weights.sum()
                            : std::numeric_limits<double>::infinity());
    if (count + 1 == taken.cols()) break;

    std::size_t best = left.size();
    double most = -1;
    for (std::size_t i = 0; i < left.size(); ++i) {
      auto column = columns.col(left[i]);
      column -= basis * basis.dot(column);
      const double square = column.squaredNorm();
      if (!(square > std::pow(rounding * norms(left[i]), 2))) continue;
      const double gain = (column.transpose() * residual).squaredNorm() / square;
      if (gain > most) {
        most = gain;
        best = i;
      }
    }
    if (best == left.size()) break;
    const Index node = left[best];
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    basis = columns.col(node);
    for (int pass = 0; pass < 2; ++pass)  // what many subtractions have left of the directions taken
      basis -= taken.leftCols(count + 1) * (taken.leftCols(count + 1).transpose() * basis);
    if (!(basis.norm() > rounding * norms(node))) break;
    basis.normalize();
    out.order.push_back(node);
  }
  return out;
}

}  // namespace detail

/// Optimally pruned ELM. Of `hidden_nodes` random nodes those are kept, in the order of orthogonal forward selection,
/// that give the least leave-one-out error (PRESS) of a least-squares fit; none is a candidate. Targets keep their
/// units, so outputs weigh as they are; the mean is free. Miche ranks by multi-response sparse regression, which lowers
/// the error along equiangular directions; forward selection ranks by the very error that PRESS then judges, takes all
/// outputs at once, too, and PRESS of every count falls out of it. As the ranking has seen all samples, the PRESS of
/// what is kept flatters a little. O(n nodes^2).
/// @cite Miche 2010; Chen, Cowan and Grant 1991
struct OpElm {
  int hidden_nodes = 100;  ///< candidates, at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// What the layer sees of each input.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  double weight_limit = 1;                   ///< hidden weights and biases lie in [-limit, limit]

  /// The hidden layer of all candidates.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the seed draws the candidates; a sample of weight w counts as w in the fit, and is left out whole
  /// @return        the nodes that are left; where none is, one whose output weights are zero
  /// @throws std::invalid_argument for unusable samples, weights or options
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                               const Eigen::MatrixBase<Y>& targets,
                                                               const FitOptions& options = {}) const {
    layer().validate("OpElm");
    detail::require_samples("OpElm", inputs, targets, options);
    const VectorX weights = detail::weights_or_ones(options.weights, inputs.rows());
    const MatrixX mapped = layer().map(inputs);
    const ColumnScaling scaling = layer().scaling(mapped);
    const VectorX theta = layer().draw(X::ColsAtCompileTime, options.seed);
    MatrixX h;
    layer().outputs(scaling.apply(mapped), theta, h);

    const Eigen::RowVectorXd mean = weights.transpose() * targets / weights.sum();
    const detail::RankedNodes ranked = detail::rank_nodes(h, targets.rowwise() - mean, weights);
    std::size_t kept = 0;
    for (std::size_t count = 1; count < ranked.press.size(); ++count)
      if (ranked.press[count] < ranked.press[kept]) kept = count;

    using Predictor = ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime>;
    HiddenLayer pruned = layer();
    pruned.nodes = std::max(1, static_cast<int>(kept));
    const Index each = layer().features(X::ColsAtCompileTime) + 1;
    if (kept == 0) return Predictor(pruned, scaling, theta.head(each), MatrixX::Zero(1, targets.cols()), mean);
    const std::vector<Index> nodes(ranked.order.begin(), ranked.order.begin() + static_cast<std::ptrdiff_t>(kept));
    MatrixX design(h.rows(), pruned.nodes + 1);
    design << h(Eigen::all, nodes), VectorX::Ones(h.rows());
    const VectorX root = weights.cwiseSqrt();
    const MatrixX beta = Eigen::HouseholderQR<MatrixX>(root.asDiagonal() * design)
                             .solve(MatrixX(root.asDiagonal() * (targets.rowwise() - mean)));
    const MatrixX chosen = theta.reshaped(each, hidden_nodes)(Eigen::all, nodes);
    return Predictor(pruned, scaling, chosen.reshaped(), beta.topRows(pruned.nodes),
                     (beta.bottomRows(1) + mean).transpose());
  }
};

}  // namespace vernier
