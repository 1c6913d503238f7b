// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/tile_product.hpp"
#include "vernier/regression/detail/variable_projection.hpp"

namespace vernier::detail {

VERNIER_IMPL VariableProjection::VariableProjection(const HiddenLayer& layer, const MatrixX& features,
                                                    const MatrixX& targets, double ridge, const VectorX* weights,
                                                    InstructionSet set)
    : layer_(layer),
      features_(features),
      roots_(weights != nullptr ? VectorX(weights->cwiseSqrt()) : VectorX(VectorX::Ones(features.rows()))),
      targets_(rows_scaled(roots_, targets)),
      samples_(features.rows()),
      nodes_(layer.nodes),
      n_(weights != nullptr ? weights->sum() : static_cast<double>(samples_)),
      lambda_(ridge * n_),
      set_(set),
      stride_((nodes_ + 1 + targets.cols() + 7) / 8 * 8),
      shared_(samples_, features.cols() + (radial() ? 2 : 1)),
      hidden_(MatrixX::Zero(stride_, samples_)),
      products_(stride_, stride_),
      ones_(VectorX::Ones((std::max)(samples_, nodes_ + 1))) {
  const Index f = features.cols();
  VERNIER_LATER(shared_).leftCols(f) = features;
  VERNIER_LATER(shared_).col(f).setOnes();
  if (radial()) VERNIER_LATER(shared_).col(f + 1) = squared_row_norms(features);
  for (Index i = 0; i < samples_; ++i) {
    hidden_(nodes_, i) = roots_(i);
    for (Index o = 0; o < targets.cols(); ++o) hidden_(nodes_ + 1 + o, i) = targets_(i, o);
  }
}

VERNIER_IMPL double VariableProjection::evaluate(const ConstVectorRef& theta) {
  theta_ = theta;
  slopes_known_ = false;
  fill(theta_, hidden_);
  const Index m = targets_.cols();
  products_.setZero();
  add_square(hidden_, products_, tile_samples());
  for (Index k = 0; k < nodes_; ++k)
    if (!std::isfinite(products_(k, k))) return std::numeric_limits<double>::infinity();
  mean_.resize(nodes_);
  for (Index k = 0; k < nodes_; ++k) mean_(k) = products_(nodes_, k) / n_;
  MatrixX gram = VERNIER_LATER(products_).topLeftCorner(nodes_, nodes_);  // its lower triangle
  for (Index c = 0; c < nodes_; ++c) {
    for (Index r = c; r < nodes_; ++r) gram(r, c) -= n_ * mean_(r) * mean_(c);
    gram(c, c) += lambda_;
  }
  factorise(std::move(gram));
  const auto h = VERNIER_LATER(hidden_).topRows(nodes_);
  const auto centred = [&](MatrixX right, const MatrixX& residual) {  // H' residual becomes that of the centred H
    const VectorX sums = transposed_product(residual, roots_);
    for (Index o = 0; o < m; ++o) VERNIER_LATER(right).col(o) -= sums(o) * mean_;
    return right;
  };
  const auto fit = [&](const MatrixX& beta) {  // leaves the residual
    add_transposed_product(residual_, h, beta, -1);
    const VectorX shift = transposed_product(beta, mean_);
    for (Index o = 0; o < m; ++o) VERNIER_LATER(residual_).col(o) += shift(o) * roots_;
  };
  residual_ = targets_;
  beta_ = solve(centred(VERNIER_LATER(products_).block(nodes_ + 1, 0, m, nodes_).transpose(), targets_));
  fit(beta_);
  // The products lose digits that the samples have: one step of refinement brings them back.
  MatrixX right = centred(matrix_product(h, residual_), residual_);
  right -= lambda_ * beta_;
  const MatrixX more = solve(std::move(right));
  beta_ += more;
  fit(more);
  return (residual_.squaredNorm() + lambda_ * beta_.squaredNorm()) / n_;
}

VERNIER_IMPL VectorX VariableProjection::gradient() {
  find_slopes();
  const MatrixX residual = VERNIER_LATER(residual_).transpose();
  MatrixX pulled = matrix_product(beta_, residual);
  for (Index i = 0; i < samples_; ++i)
    for (Index k = 0; k < nodes_; ++k) pulled(k, i) *= slopes_(k, i);
  const MatrixX by_shared = matrix_product(pulled, shared_);
  const Index p = features_.cols() + 1;
  VectorX out(dimension());
  for (Index k = 0; k < nodes_; ++k) VERNIER_LATER(out).segment(k * p, p) = to_weights(k, row_of(by_shared, k));
  return (-2 / n_) * out;
}

VERNIER_IMPL void VariableProjection::curvature(MatrixX& out, ExecutorRef executor) {
  find_slopes();
  const Index d = shared_.cols(), pairs = d * (d + 1) / 2, p = features_.cols() + 1;
  by_pair_.assign(static_cast<std::size_t>(pairs + d), MatrixX());
  executor.for_ranges(pairs + d, [&](Index begin, Index end) { products_of_pairs(begin, end); });

  // What the output weights and the mean take over: columns of `taken` times themselves.
  const Index padded = (dimension() + 7) / 8 * 8;
  MatrixX cross(nodes_, dimension()), taken = MatrixX::Zero(padded, nodes_ + 1), of_node(d, nodes_ + 1);
  for (Index k = 0; k < nodes_; ++k) {
    for (Index j = 0; j < d; ++j) {
      const MatrixX& by_feature = by_pair_[static_cast<std::size_t>(pairs + j)];
      for (Index l = 0; l <= nodes_; ++l) of_node(j, l) = by_feature(l, k);
    }
    const MatrixX of_weights = to_weights(k, of_node);
    for (Index i = 0; i < p; ++i) {
      const double sum = of_weights(i, nodes_);
      for (Index l = 0; l < nodes_; ++l) cross(l, k * p + i) = of_weights(i, l) - mean_(l) * sum;
      taken(k * p + i, nodes_) = sum / std::sqrt(n_);
    }
  }
  solve_lower(factor_, cross);
  VERNIER_LATER(taken).topLeftCorner(dimension(), nodes_) = VERNIER_LATER(cross).transpose();
  MatrixX all_taken = MatrixX::Zero(padded, padded);
  add_square(taken, all_taken, nodes_ + 1);

  out.resize(dimension(), dimension());
  const MatrixX by_node = VERNIER_LATER(beta_).transpose();
  MatrixX block(d, d), radial_block;
  for (Index k = 0; k < nodes_; ++k)
    for (Index l = k; l < nodes_; ++l) {
      for (Index j = 0, pair = 0; j < d; ++j)
        for (Index i = j; i < d; ++i, ++pair)
          block(i, j) = block(j, i) = by_pair_[static_cast<std::size_t>(pair)](l, k);
      if (radial()) radial_block = to_weights(l, VERNIER_LATER(to_weights(k, block)).transpose());
      const MatrixX& of_weights = radial() ? radial_block : block;  // p x p, rows of node l
      const double weight = 2 / n_ * VERNIER_LATER(by_node).col(k).dot(VERNIER_LATER(by_node).col(l));
      for (Index j = k * p; j < (k + 1) * p; ++j)
        for (Index i = l * p; i < (l + 1) * p; ++i)
          out(i, j) = weight * (of_weights(i - l * p, j - k * p) - all_taken(i, j));
    }
}

VERNIER_IMPL VectorX VariableProjection::offset() const { return -transposed_product(beta_, mean_); }

VERNIER_IMPL void VariableProjection::fill(const VectorX& theta, MatrixX& columns) const {
  constexpr Index tile = 256;
  MatrixX block;
  for (Index begin = 0; begin < samples_; begin += tile) {
    const Index count = (std::min)(tile, samples_ - begin);
    layer_.outputs(VERNIER_LATER(features_).middleRows(begin, count), theta, block);
    for (Index i = 0; i < count; ++i)
      for (Index k = 0; k < nodes_; ++k) columns(k, begin + i) = roots_(begin + i) * block(i, k);
  }
}

VERNIER_IMPL void VariableProjection::find_slopes() {
  if (slopes_known_) return;
  slopes_known_ = true;
  if (slopes_.size() == 0) slopes_ = MatrixX::Zero(stride_, samples_);
  if (layer_.activation == Activation::sine) {  // cos z = sin(z + pi / 2)
    VectorX shifted = theta_;
    const Index f = features_.cols();
    for (Index k = 0; k < nodes_; ++k) shifted(k * (f + 1) + f) += 1.57079632679489661923;
    fill(shifted, slopes_);
    return;
  }
  for (Index i = 0; i < samples_; ++i) {
    const double root = roots_(i);
    const double* h = VERNIER_LATER(hidden_).col(i).data();  // root times output
    double* slope = VERNIER_LATER(slopes_).col(i).data();    // root times slope
    switch (layer_.activation) {
      case Activation::sigmoid:
        for (Index k = 0; k < nodes_; ++k) slope[k] = h[k] * (1 - h[k] / root);
        break;
      case Activation::tanh:
        for (Index k = 0; k < nodes_; ++k) slope[k] = root - h[k] * h[k] / root;
        break;
      case Activation::radial_basis: std::copy(h, h + nodes_, slope); break;
      case Activation::sine: break;
    }
  }
}

VERNIER_IMPL MatrixX VariableProjection::to_weights(Index k, const ConstMatrixRef& rows) const {
  if (!radial()) return rows;
  // h = exp(-b^2 |x - w|^2): dh/dw = 2 b^2 (x - w) h, dh/db = -2 b |x - w|^2 h
  const Index f = features_.cols();
  const double *w = theta_.data() + k * (f + 1), b = w[f];
  MatrixX out(f + 1, rows.cols());
  for (Index c = 0; c < rows.cols(); ++c) {
    double product = 0, square = 0;
    for (Index j = 0; j < f; ++j) {
      out(j, c) = 2 * b * b * (rows(j, c) - w[j] * rows(f, c));
      product += w[j] * rows(j, c);
      square += w[j] * w[j];
    }
    out(f, c) = -2 * b * (rows(f + 1, c) - 2 * product + square * rows(f, c));
  }
  return out;
}

VERNIER_IMPL void VariableProjection::products_of_pairs(Index begin, Index end) {
  const Index d = shared_.cols(), pairs = d * (d + 1) / 2;
  constexpr Index stage = 512;  // samples that stay in the second-level cache while all tasks pass over them
  MatrixX tile(stride_, tile_samples());
  VectorX weights((std::min)(stage, samples_));
  for (Index task = begin; task < end; ++task)
    by_pair_[static_cast<std::size_t>(task)] = MatrixX::Zero(stride_, stride_);
  for (Index from = 0; from < samples_; from += stage) {
    const Index count = (std::min)(stage, samples_ - from);
    Index task = 0;
    const auto run = [&](const MatrixX& right, bool symmetric) {
      add_weighted_product(
          {VERNIER_LATER(slopes_).col(from).data(), VERNIER_LATER(right).col(from).data(), weights.data(), tile.data(),
           by_pair_[static_cast<std::size_t>(task)].data(), count, stride_, tile.cols(), symmetric},
          set_);
    };
    for (Index j = 0; j < d; ++j)
      for (Index i = j; i < d; ++i, ++task) {
        if (task < begin || task >= end) continue;
        for (Index s = 0; s < count; ++s) weights(s) = shared_(from + s, j) * shared_(from + s, i);
        run(slopes_, true);
      }
    for (task = (std::max)(begin, pairs); task < end; ++task) {
      for (Index s = 0; s < count; ++s) weights(s) = shared_(from + s, task - pairs);
      run(hidden_, false);
    }
  }
}

VERNIER_IMPL void VariableProjection::add_square(const MatrixX& columns, MatrixX& out, Index tile_columns) const {
  MatrixX tile(columns.rows(), tile_columns);
  add_weighted_product({columns.data(), columns.data(), ones_.data(), tile.data(), out.data(), columns.cols(),
                        columns.rows(), tile_columns, true},
                       set_);
}

VERNIER_IMPL void VariableProjection::factorise(MatrixX gram) {
  factor_ = std::move(gram);
  if (cholesky(factor_)) return;
  MatrixX stacked = MatrixX::Zero(samples_ + nodes_, nodes_);
  for (Index k = 0; k < nodes_; ++k) {
    for (Index i = 0; i < samples_; ++i) stacked(i, k) = hidden_(k, i) - roots_(i) * mean_(k);
    stacked(samples_ + k, k) = std::sqrt(lambda_);
  }
  factor_ = VERNIER_LATER(triangular_factor(stacked)).transpose();
}

VERNIER_IMPL MatrixX VariableProjection::solve(MatrixX right) const {
  solve_cholesky(factor_, right);
  return right;
}

}  // namespace vernier::detail
