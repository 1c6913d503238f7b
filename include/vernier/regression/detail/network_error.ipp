#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vernier/regression/detail/network_error.hpp"
#include "vernier/regression/detail/tile_product.hpp"

namespace vernier::detail {

VERNIER_IMPL double NetworkError::evaluate(const VectorX& theta) {
  theta_ = theta;
  const double value = over_samples(nullptr);
  return std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
}

VERNIER_IMPL VectorX NetworkError::gradient() {
  VectorX out = VectorX::Zero(dimension());
  over_samples(&out);
  return out;
}

VERNIER_IMPL double NetworkError::batch(const VectorX& theta, const std::vector<Index>& rows, VectorX& gradient) {
  theta_ = theta;
  const MatrixX x = features_(rows, Eigen::all), t = targets_(rows, Eigen::all);
  // A batch of heavy samples counts for more: the mean over batches is then the gradient of F.
  const VectorX q = shares_(rows) * (static_cast<double>(samples()) / static_cast<double>(rows.size()));
  gradient.setZero(dimension());
  return add(x, t, q, &gradient) + add_decay(&gradient);
}

VERNIER_IMPL void NetworkError::curvature(MatrixX& out, ExecutorRef executor) {
  fill();
  const Index h = layer_.nodes, d = features_.cols() + 1, pairs = d * (d + 1) / 2;
  products_.assign(static_cast<std::size_t>(pairs + d + 1), RowMatrix());
  executor.for_ranges(pairs + d + 1, [&](Index begin, Index end) { form_products(begin, end); });
  const auto product = [&](Index task) -> const RowMatrix& { return products_[static_cast<std::size_t>(task)]; };

  out.setZero(dimension(), dimension());
  const auto b = output_weights().topRows(h);
  const MatrixX both = 2 * b * b.transpose();
  for (Index j = 0, pair = 0; j < d; ++j)
    for (Index i = j; i < d; ++i, ++pair)
      for (Index k = 0; k < h; ++k)
        for (Index l = k; l < h; ++l)
          out(l * d + i, k * d + j) = out(l * d + j, k * d + i) = both(k, l) * product(pair)(k, l);
  for (Index o = 0; o < targets_.cols(); ++o) {
    const Index row = hidden() + o * (h + 1);
    for (Index k = 0; k < h; ++k)
      for (Index j = 0; j < d; ++j)
        out.col(k * d + j).segment(row, h + 1) = 2 * b(k, o) * product(pairs + j).row(k).head(h + 1).transpose();
    out.block(row, row, h + 1, h + 1) = 2 * product(pairs + d).topLeftCorner(h + 1, h + 1).transpose();
  }
  for (Index k = 0; k < h; ++k) {
    out.diagonal().segment(k * d, d - 1).array() += 2 * decay_;
    for (Index o = 0; o < targets_.cols(); ++o) out.diagonal()(hidden() + o * (h + 1) + k) += 2 * decay_;
  }
}

VERNIER_IMPL double NetworkError::over_samples(VectorX* gradient) {
  constexpr Index tile = 256;  // stays in the second-level cache
  double value = add_decay(gradient);
  for (Index begin = 0; begin < samples(); begin += tile) {
    const Index count = std::min(tile, samples() - begin);
    value += add(features_.middleRows(begin, count), targets_.middleRows(begin, count), shares_.segment(begin, count),
                 gradient);
  }
  return value;
}

VERNIER_IMPL double NetworkError::add_decay(VectorX* gradient) const {
  const Index f = features_.cols(), h = layer_.nodes;
  if (gradient != nullptr) {
    Eigen::Map<MatrixX>(gradient->data(), f + 1, h).topRows(f) += 2 * decay_ * hidden_weights().topRows(f);
    Eigen::Map<MatrixX>(gradient->data() + hidden(), h + 1, targets_.cols()).topRows(h) +=
        2 * decay_ * output_weights().topRows(h);
  }
  return decay_ * (hidden_weights().topRows(f).squaredNorm() + output_weights().topRows(h).squaredNorm());
}

VERNIER_IMPL double NetworkError::add(const ConstMatrixRef& x, const ConstMatrixRef& t, const ConstVectorRef& q,
                                      VectorX* gradient) {
  const Index f = features_.cols(), h = layer_.nodes;
  layer_.outputs(x, theta_.head(hidden()), outputs_);
  residual_.noalias() = outputs_ * output_weights().topRows(h);
  residual_.rowwise() += output_weights().row(h);
  residual_ -= t;
  const double value = q.dot(residual_.rowwise().squaredNorm());
  if (gradient == nullptr) return value;
  residual_ = 2 * q.asDiagonal() * residual_;
  Eigen::Map<MatrixX> to_hidden(gradient->data(), f + 1, h);
  Eigen::Map<MatrixX> to_output(gradient->data() + hidden(), h + 1, targets_.cols());
  to_output.topRows(h).noalias() += outputs_.transpose() * residual_;
  to_output.row(h) += residual_.colwise().sum();
  pulled_.noalias() = residual_ * output_weights().topRows(h).transpose();
  to_slopes(outputs_);
  pulled_.array() *= outputs_.array();
  to_hidden.topRows(f).noalias() += x.transpose() * pulled_;
  to_hidden.row(f) += pulled_.colwise().sum();
  return value;
}

VERNIER_IMPL void NetworkError::to_slopes(MatrixX& h) const {
  if (layer_.activation == Activation::tanh) {
    h.array() = 1 - h.array().square();
  } else {
    h.array() *= 1 - h.array();
  }
}

VERNIER_IMPL void NetworkError::fill() {
  const Index h = layer_.nodes;
  stride_ = (h + 8) / 8 * 8;
  if (nodes_.size() == 0) nodes_ = slopes_ = RowMatrix::Zero(samples(), stride_);
  layer_.outputs(features_, theta_.head(hidden()), outputs_);
  nodes_.leftCols(h) = outputs_;
  nodes_.col(h).setOnes();
  to_slopes(outputs_);
  slopes_.leftCols(h) = outputs_;
}

VERNIER_IMPL void NetworkError::form_products(Index begin, Index end) {
  const Index d = features_.cols() + 1;
  constexpr Index stage = 512;  // samples that stay in the second-level cache while all tasks pass over them
  RowMatrix tile(std::max<Index>(8, 3072 / stride_), stride_);  // 24 KiB, the first-level cache
  for (Index task = begin; task < end; ++task)
    products_[static_cast<std::size_t>(task)] = RowMatrix::Zero(stride_, stride_);
  for (Index from = 0; from < samples(); from += stage) {
    const Index count = std::min(stage, samples() - from);
    MatrixX shared(count, d);
    shared.leftCols(d - 1) = features_.middleRows(from, count);
    shared.col(d - 1).setOnes();
    VectorX weights(count);
    const auto run = [&](Index task, const RowMatrix& left, const RowMatrix& right, Index j, Index i) {
      if (task < begin || task >= end) return;
      weights = shares_.segment(from, count).cwiseProduct(shared.col(j)).cwiseProduct(shared.col(i));
      add_weighted_product(
          {left.row(from).data(), right.row(from).data(), weights.data(), tile.data(),
           products_[static_cast<std::size_t>(task)].data(), count, stride_, tile.rows(), &left == &right},
          set_);
    };
    Index task = 0;
    for (Index j = 0; j < d; ++j)
      for (Index i = j; i < d; ++i) run(task++, slopes_, slopes_, j, i);
    for (Index j = 0; j < d; ++j) run(task++, slopes_, nodes_, j, d - 1);
    run(task, nodes_, nodes_, d - 1, d - 1);
  }
}

}  // namespace vernier::detail
