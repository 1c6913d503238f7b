#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

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
      targets_(roots_.asDiagonal() * targets),
      samples_(features.rows()),
      nodes_(layer.nodes),
      n_(weights != nullptr ? weights->sum() : static_cast<double>(samples_)),
      lambda_(ridge * n_),
      set_(set),
      stride_((nodes_ + 1 + targets.cols() + 7) / 8 * 8),
      shared_(samples_, features.cols() + (radial() ? 2 : 1)),
      hidden_(RowMatrix::Zero(samples_, stride_)),
      products_(stride_, stride_),
      ones_(VectorX::Ones(std::max(samples_, nodes_ + 1))) {
  shared_.leftCols(features.cols()) = features;
  shared_.col(features.cols()).setOnes();
  if (radial()) shared_.rightCols(1) = features.rowwise().squaredNorm();
  hidden_.col(nodes_) = roots_;
  hidden_.middleCols(nodes_ + 1, targets.cols()) = targets_;
}

VERNIER_IMPL double VariableProjection::evaluate(const ConstVectorRef& theta) {
  theta_ = theta;
  slopes_known_ = false;
  fill(theta_, hidden_);
  if (!hidden_.leftCols(nodes_).allFinite()) return std::numeric_limits<double>::infinity();
  const Index m = targets_.cols();
  products_.setZero();
  add_product(hidden_, hidden_, ones_.data(), samples_, products_, true);
  mean_ = products_.col(nodes_).head(nodes_) / n_;
  MatrixX gram = products_.topLeftCorner(nodes_, nodes_).transpose();  // its lower triangle
  gram.triangularView<Eigen::Lower>() -= MatrixX(n_ * mean_ * mean_.transpose());
  gram.diagonal().array() += lambda_;
  factorise(gram);
  const auto correlate = [&](const MatrixX& residual) -> MatrixX {  // centred H' residual
    return hidden_.leftCols(nodes_).transpose() * residual - mean_ * (roots_.transpose() * residual);
  };
  beta_ = solve(products_.block(0, nodes_ + 1, nodes_, m) - mean_ * (roots_.transpose() * targets_));
  residual_ = targets_ - hidden_.leftCols(nodes_) * beta_;
  residual_.noalias() += roots_ * (mean_.transpose() * beta_);
  // The products lose digits that the samples have: one step of refinement brings them back.
  const MatrixX more = solve(correlate(residual_) - lambda_ * beta_);
  beta_ += more;
  residual_.noalias() -= hidden_.leftCols(nodes_) * more;
  residual_.noalias() += roots_ * (mean_.transpose() * more);
  return (residual_.squaredNorm() + lambda_ * beta_.squaredNorm()) / n_;
}

VERNIER_IMPL VectorX VariableProjection::gradient() {
  find_slopes();
  const RowMatrix pulled = slopes_.leftCols(nodes_).cwiseProduct(residual_ * beta_.transpose());
  const MatrixX by_shared = shared_.transpose() * pulled;
  MatrixX out(features_.cols() + 1, nodes_);
  for (Index k = 0; k < nodes_; ++k) out.col(k) = to_weights(k, by_shared.col(k));
  return (-2 / n_) * out.reshaped();
}

VERNIER_IMPL void VariableProjection::curvature(MatrixX& out, ExecutorRef executor) {
  find_slopes();
  const Index d = shared_.cols(), pairs = d * (d + 1) / 2, p = features_.cols() + 1;
  by_pair_.assign(static_cast<std::size_t>(pairs + d), RowMatrix());
  executor.for_ranges(pairs + d, [&](Index begin, Index end) { products_of_pairs(begin, end); });

  // What the output weights and the mean take over: rows of `taken` times themselves.
  const Index padded = (dimension() + 7) / 8 * 8;
  MatrixX cross(nodes_, dimension());
  RowMatrix taken = RowMatrix::Zero(nodes_ + 1, padded);
  MatrixX of_node(d, nodes_ + 1);
  for (Index k = 0; k < nodes_; ++k) {
    for (Index j = 0; j < d; ++j)
      of_node.row(j) = by_pair_[static_cast<std::size_t>(pairs + j)].row(k).head(nodes_ + 1);
    const MatrixX of_weights = to_weights(k, of_node);
    cross.middleCols(k * p, p) = of_weights.leftCols(nodes_).transpose() - mean_ * of_weights.col(nodes_).transpose();
    taken.row(nodes_).segment(k * p, p) = of_weights.col(nodes_).transpose() / std::sqrt(n_);
  }
  factor_.triangularView<Eigen::Lower>().solveInPlace(cross);
  taken.topLeftCorner(nodes_, dimension()) = cross;
  RowMatrix all_taken = RowMatrix::Zero(padded, padded);
  add_product(taken, taken, ones_.data(), nodes_ + 1, all_taken, true, nodes_ + 1);

  out.resize(dimension(), dimension());
  const MatrixX weight = (2 / n_) * beta_ * beta_.transpose();
  MatrixX block(d, d);
  for (Index k = 0; k < nodes_; ++k)
    for (Index l = k; l < nodes_; ++l) {
      for (Index j = 0, pair = 0; j < d; ++j)
        for (Index i = j; i < d; ++i, ++pair)
          block(i, j) = block(j, i) = by_pair_[static_cast<std::size_t>(pair)](k, l);
      if (radial()) {
        const MatrixX rows = to_weights(k, block);
        const MatrixX both = to_weights(l, rows.transpose());  // p x p, rows of node l
        out.block(l * p, k * p, p, p) = both;
      } else {
        out.block(l * p, k * p, p, p) = block;
      }
      auto to = out.block(l * p, k * p, p, p);
      to = weight(k, l) * (to - all_taken.block(k * p, l * p, p, p).transpose());
    }
}

VERNIER_IMPL VectorX VariableProjection::offset() const { return -(beta_.transpose() * mean_); }

VERNIER_IMPL void VariableProjection::fill(const VectorX& theta, RowMatrix& rows) const {
  constexpr Index tile = 256;
  MatrixX block;
  for (Index begin = 0; begin < samples_; begin += tile) {
    const Index count = std::min(tile, samples_ - begin);
    layer_.outputs(features_.middleRows(begin, count), theta, block);
    rows.block(begin, 0, count, nodes_) = roots_.segment(begin, count).asDiagonal() * block;
  }
}

VERNIER_IMPL void VariableProjection::find_slopes() {
  if (slopes_known_) return;
  slopes_known_ = true;
  if (slopes_.size() == 0) slopes_ = RowMatrix::Zero(samples_, stride_);
  const auto h = hidden_.leftCols(nodes_).array();  // root times output; the slopes are root times slope
  auto s = slopes_.leftCols(nodes_).array();
  switch (layer_.activation) {
    case Activation::sigmoid: s = h * (1 - h.colwise() / roots_.array()); break;
    case Activation::tanh: s = (-h.square()).colwise() / roots_.array(), s.colwise() += roots_.array(); break;
    case Activation::radial_basis: s = h; break;
    case Activation::sine: {  // cos z = sin(z + pi / 2)
      VectorX shifted = theta_;
      shifted.reshaped(features_.cols() + 1, nodes_).row(features_.cols()).array() += 1.57079632679489661923;
      fill(shifted, slopes_);
      break;
    }
  }
}

VERNIER_IMPL MatrixX VariableProjection::to_weights(Index k, const ConstMatrixRef& rows) const {
  if (!radial()) return rows;
  // h = exp(-b^2 |x - w|^2): dh/dw = 2 b^2 (x - w) h, dh/db = -2 b |x - w|^2 h
  const Index f = features_.cols();
  const auto w = theta_.segment(k * (f + 1), f);
  const double b = theta_(k * (f + 1) + f);
  MatrixX out(f + 1, rows.cols());
  out.topRows(f) = 2 * b * b * (rows.topRows(f) - w * rows.row(f));
  out.row(f) = -2 * b * (rows.row(f + 1) - 2 * w.transpose() * rows.topRows(f) + w.squaredNorm() * rows.row(f));
  return out;
}

VERNIER_IMPL void VariableProjection::products_of_pairs(Index begin, Index end) {
  const Index d = shared_.cols(), pairs = d * (d + 1) / 2;
  constexpr Index stage = 512;  // samples that stay in the second-level cache while all tasks pass over them
  RowMatrix tile(tile_samples(), stride_);
  VectorX weights(std::min(stage, samples_));
  for (Index task = begin; task < end; ++task)
    by_pair_[static_cast<std::size_t>(task)] = RowMatrix::Zero(stride_, stride_);
  for (Index from = 0; from < samples_; from += stage) {
    const Index count = std::min(stage, samples_ - from);
    Index task = 0;
    const auto run = [&](const RowMatrix& right, bool symmetric) {
      add_weighted_product({slopes_.row(from).data(), right.row(from).data(), weights.data(), tile.data(),
                            by_pair_[static_cast<std::size_t>(task)].data(), count, stride_, tile.rows(), symmetric},
                           set_);
    };
    for (Index j = 0; j < d; ++j)
      for (Index i = j; i < d; ++i, ++task) {
        if (task < begin || task >= end) continue;
        weights.head(count) = shared_.col(j).segment(from, count).cwiseProduct(shared_.col(i).segment(from, count));
        run(slopes_, true);
      }
    for (task = std::max(begin, pairs); task < end; ++task) {
      weights.head(count) = shared_.col(task - pairs).segment(from, count);
      run(hidden_, false);
    }
  }
}

VERNIER_IMPL void VariableProjection::add_product(const RowMatrix& left, const RowMatrix& right, const double* weights,
                                                  Index rows, RowMatrix& out, bool symmetric, Index tile_rows) const {
  RowMatrix tile(tile_rows > 0 ? tile_rows : tile_samples(), left.cols());
  add_weighted_product(
      {left.data(), right.data(), weights, tile.data(), out.data(), rows, left.cols(), tile.rows(), symmetric}, set_);
}

VERNIER_IMPL void VariableProjection::factorise(const MatrixX& gram) {
  const Eigen::LLT<MatrixX> factor(gram);
  if (factor.info() == Eigen::Success) {
    factor_ = factor.matrixL();
    return;
  }
  MatrixX stacked(samples_ + nodes_, nodes_);
  stacked << hidden_.leftCols(nodes_) - roots_ * mean_.transpose(),
      std::sqrt(lambda_) * MatrixX::Identity(nodes_, nodes_);
  factor_ = triangular_factor(stacked).transpose();
}

VERNIER_IMPL MatrixX VariableProjection::solve(const MatrixX& right) const {
  const auto lower = factor_.triangularView<Eigen::Lower>();
  return lower.transpose().solve(MatrixX(lower.solve(right)));
}

}  // namespace vernier::detail
