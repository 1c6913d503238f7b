// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/online_elm.hpp"

namespace vernier::detail {

VERNIER_IMPL OnlineElm::OnlineElm(const HiddenLayer& layer, const VectorX& theta, double lambda, double forgetting,
                                  const ConstMatrixRef& x, const ConstMatrixRef& y, const VectorX* weights)
    : layer_(layer), theta_(theta), features_(layer.features(static_cast<int>(x.cols()))), forgetting_(forgetting) {
  const Index n = x.rows(), size = layer.nodes + 1;
  MatrixX stacked = MatrixX::Zero(n + layer.nodes, size), right = MatrixX::Zero(n + layer.nodes, y.cols());
  const VectorX samples = weights_or_ones(weights, n), root = VERNIER_LATER(samples).cwiseSqrt();
  total_ = samples.sum();
  VERNIER_LATER(stacked).topRows(n) = rows_scaled(root, hidden(x));
  VERNIER_LATER(right).topRows(n) = rows_scaled(root, y);
  for (Index k = 0; k < layer.nodes; ++k) stacked(n + k, k) = std::sqrt(lambda);  // the constant has none
  QrSolution qr = solve_by_qr(stacked, right);
  coefficients_ = std::move(qr.solution);
  add_product(right, stacked, coefficients_, -1);
  square_ = squared_column_norms(right);
  root_ = MatrixX::Identity(size, size);  // R^-T
  solve_lower(VERNIER_LATER(qr.triangle).transpose(), root_);
}

VERNIER_IMPL void OnlineElm::update(const ConstMatrixRef& x, const ConstMatrixRef& y, const VectorX* weights) {
  const MatrixX h = hidden(x);
  root_ /= std::sqrt(forgetting_);
  square_ *= forgetting_;
  total_ *= forgetting_;
  for (Index i = 0; i < h.rows(); ++i) absorb(row_of(h, i), row_of(y, i), weights != nullptr ? (*weights)(i) : 1);
}

VERNIER_IMPL double OnlineElm::variance_factor(const double* features) const noexcept {
  constexpr Index tile = 128;
  const Index size = root_.rows();
  double square = 0;
  for (Index first = 0; first < size; first += tile) {
    const Index count = (std::min)(tile, size - first);
    double product[tile] = {};
    for (Index k = 0; k < size; ++k) {
      const double h = node(k, features);
      for (Index i = 0; i < count; ++i) product[i] += root_(first + i, k) * h;
    }
    for (const double part : product) square += part * part;
  }
  return square;
}

VERNIER_IMPL FittedNetwork OnlineElm::network() const {
  return {layer_, ColumnScaling{VectorX::Zero(features_), VectorX::Ones(features_)}, theta_,
          VERNIER_LATER(coefficients_).topRows(layer_.nodes), row_of(coefficients_, layer_.nodes)};
}

VERNIER_IMPL MatrixX OnlineElm::covariance() const { return transposed_matrix_product(root_, root_); }

VERNIER_IMPL VectorX OnlineElm::noise_variance() const { return square_ / total_; }

/// Outputs of the nodes and a one, n x (nodes + 1).
VERNIER_IMPL MatrixX OnlineElm::hidden(const ConstMatrixRef& x) const {
  MatrixX nodes, out(x.rows(), layer_.nodes + 1);
  layer_.outputs(layer_.map(x), theta_, nodes);
  VERNIER_LATER(out).leftCols(layer_.nodes) = nodes;
  VERNIER_LATER(out).col(layer_.nodes).setOnes();
  return out;
}

/// One of them, of features.
VERNIER_IMPL double OnlineElm::node(Index k, const double* features) const noexcept {
  if (k == layer_.nodes) return 1;
  const Index f = features_;
  const double* w = theta_.data() + k * (f + 1);
  double z = 0, square = 0;
  for (Index j = 0; j < f; ++j) {
    z += w[j] * features[j];
    square += (features[j] - w[j]) * (features[j] - w[j]);
  }
  z += w[f];
  switch (layer_.activation) {
    case Activation::tanh: return std::tanh(z);
    case Activation::sine: return std::sin(z);
    case Activation::radial_basis: return std::exp(-w[f] * w[f] * square);
    default: return 1 / (1 + std::exp(-z));
  }
}

/// `P <- P - P h h'P / (1 / weight + h'P h)`, `beta <- beta + P h weight (y - h'beta)`, by the square root:
/// with f = B h, `B <- (I - g f f') B` where `(I - g f f')^2 = I - f f' / (1 / weight + f'f)`.
VERNIER_IMPL void OnlineElm::absorb(const VectorX& h, const VectorX& y, double weight) {
  const VectorX f = product(root_, h), through = transposed_product(root_, f);
  const double scale = 1 / (1 / weight + f.squaredNorm());
  const VectorX error = y - transposed_product(coefficients_, h);
  for (Index o = 0; o < error.size(); ++o) {
    VERNIER_LATER(coefficients_).col(o) += scale * error(o) * through;
    square_(o) += scale * error(o) * error(o);
  }
  const double of_root = scale / (1 + std::sqrt(scale / weight));
  for (Index k = 0; k < through.size(); ++k) VERNIER_LATER(root_).col(k) -= of_root * through(k) * f;
  total_ += weight;
}

}  // namespace vernier::detail
