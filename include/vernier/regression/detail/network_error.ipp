// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vernier/core/detail/dense.hpp"
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
  const MatrixX x = rows_of(features_, rows), t = rows_of(targets_, rows);
  // A batch of heavy samples counts for more: the mean over batches is then the gradient of F.
  VectorX q = rows_of(shares_, rows);
  q *= static_cast<double>(samples()) / static_cast<double>(rows.size());
  gradient.setZero(dimension());
  return add(x, t, q, &gradient) + add_decay(&gradient);
}

VERNIER_IMPL void NetworkError::curvature(MatrixX& out, ExecutorRef executor) {
  fill();
  const Index h = layer_.nodes, d = features_.cols() + 1, pairs = d * (d + 1) / 2;
  products_.assign(static_cast<std::size_t>(pairs + d + 1), MatrixX());
  executor.for_ranges(pairs + d + 1, [&](Index begin, Index end) { form_products(begin, end); });
  const auto product = [&](Index task) -> const MatrixX& { return products_[static_cast<std::size_t>(task)]; };

  out.setZero(dimension(), dimension());
  const MatrixX b = output_weights(), transposed = VERNIER_LATER(b).transpose(),
                both = 2 * matrix_product(b, transposed);
  for (Index j = 0, pair = 0; j < d; ++j)
    for (Index i = j; i < d; ++i, ++pair)
      for (Index k = 0; k < h; ++k)
        for (Index l = k; l < h; ++l)
          out(l * d + i, k * d + j) = out(l * d + j, k * d + i) = both(l, k) * product(pair)(l, k);
  for (Index o = 0; o < targets_.cols(); ++o) {
    const Index row = hidden() + o * (h + 1);
    for (Index k = 0; k < h; ++k)
      for (Index j = 0; j < d; ++j)
        for (Index l = 0; l <= h; ++l) out(row + l, k * d + j) = 2 * b(k, o) * product(pairs + j)(l, k);
    for (Index k = 0; k <= h; ++k)
      for (Index l = k; l <= h; ++l) out(row + l, row + k) = 2 * product(pairs + d)(l, k);
  }
  for (Index k = 0; k < h; ++k) {
    for (Index j = k * d; j < k * d + d - 1; ++j) out(j, j) += 2 * decay_;
    for (Index o = 0; o < targets_.cols(); ++o) {
      const Index j = hidden() + o * (h + 1) + k;
      out(j, j) += 2 * decay_;
    }
  }
}

VERNIER_IMPL double NetworkError::over_samples(VectorX* gradient) {
  constexpr Index tile = 256;  // stays in the second-level cache
  double value = add_decay(gradient);
  for (Index begin = 0; begin < samples(); begin += tile) {
    const Index count = (std::min)(tile, samples() - begin);
    value += add(VERNIER_LATER(features_).middleRows(begin, count), VERNIER_LATER(targets_).middleRows(begin, count),
                 VERNIER_LATER(shares_).segment(begin, count), gradient);
  }
  return value;
}

VERNIER_IMPL double NetworkError::add_decay(VectorX* gradient) const {
  double sum = 0;
  const auto add = [&](Index first, Index rows, Index columns) {  // after every column a bias
    for (Index c = 0; c < columns; ++c)
      for (Index k = first + c * (rows + 1); k < first + c * (rows + 1) + rows; ++k) {
        sum += theta_(k) * theta_(k);
        if (gradient != nullptr) (*gradient)(k) += 2 * decay_ * theta_(k);
      }
  };
  add(0, features_.cols(), layer_.nodes);
  add(hidden(), layer_.nodes, targets_.cols());
  return decay_ * sum;
}

VERNIER_IMPL double NetworkError::add(const ConstMatrixRef& x, const ConstMatrixRef& t, const ConstVectorRef& q,
                                      VectorX* gradient) {
  const Index n = x.rows(), f = features_.cols(), h = layer_.nodes, m = targets_.cols();
  const auto bias = [&](Index o) { return hidden() + o * (h + 1) + h; };
  layer_.outputs(x, VERNIER_LATER(theta_).head(hidden()), outputs_);
  residual_.resize(n, m);
  for (Index o = 0; o < m; ++o)
    for (Index i = 0; i < n; ++i) residual_(i, o) = theta_(bias(o)) - t(i, o);
  add_product(residual_, outputs_, output_weights());
  const double value = q.dot(squared_row_norms(residual_));
  if (gradient == nullptr) return value;
  for (Index o = 0; o < m; ++o)
    for (Index i = 0; i < n; ++i) residual_(i, o) *= 2 * q(i);
  const MatrixX back = VERNIER_LATER(output_weights()).transpose();
  pulled_.setZero(n, h);
  add_product(pulled_, residual_, back);
  Eigen::Map<MatrixX, 0, Eigen::OuterStride<>> to_hidden(gradient->data(), f, h, Eigen::OuterStride<>(f + 1)),
      to_output(gradient->data() + hidden(), h, m, Eigen::OuterStride<>(h + 1));
  add_transposed_product(to_output, outputs_, residual_);
  for (Index o = 0; o < m; ++o) (*gradient)(bias(o)) += VERNIER_LATER(residual_).col(o).sum();
  to_slopes(outputs_);
  pulled_ = VERNIER_LATER(pulled_).cwiseProduct(outputs_);
  add_transposed_product(to_hidden, x, pulled_);
  for (Index k = 0; k < h; ++k) (*gradient)(k * (f + 1) + f) += VERNIER_LATER(pulled_).col(k).sum();
  return value;
}

VERNIER_IMPL void NetworkError::to_slopes(MatrixX& h) const {
  if (layer_.activation == Activation::tanh)
    h = MatrixX::Ones(h.rows(), h.cols()) - VERNIER_LATER(h).cwiseAbs2();
  else
    h -= VERNIER_LATER(h).cwiseAbs2();
}

VERNIER_IMPL void NetworkError::fill() {
  const Index h = layer_.nodes;
  stride_ = (h + 8) / 8 * 8;
  if (nodes_.size() == 0) nodes_ = slopes_ = MatrixX::Zero(stride_, samples());
  layer_.outputs(features_, VERNIER_LATER(theta_).head(hidden()), outputs_);
  VERNIER_LATER(nodes_).topRows(h) = VERNIER_LATER(outputs_).transpose();
  for (Index i = 0; i < samples(); ++i) nodes_(h, i) = 1;
  to_slopes(outputs_);
  VERNIER_LATER(slopes_).topRows(h) = VERNIER_LATER(outputs_).transpose();
}

VERNIER_IMPL void NetworkError::form_products(Index begin, Index end) {
  const Index d = features_.cols() + 1;
  constexpr Index stage = 512;  // samples that stay in the second-level cache while all tasks pass over them
  MatrixX tile(stride_, std::max<Index>(8, 3072 / stride_));  // 24 KiB, the first-level cache
  for (Index task = begin; task < end; ++task)
    products_[static_cast<std::size_t>(task)] = MatrixX::Zero(stride_, stride_);
  for (Index from = 0; from < samples(); from += stage) {
    const Index count = (std::min)(stage, samples() - from);
    VectorX weights(count);
    const auto shared = [&](Index i, Index j) { return j < d - 1 ? features_(from + i, j) : 1; };
    const auto run = [&](Index task, const MatrixX& left, const MatrixX& right, Index j, Index i) {
      if (task < begin || task >= end) return;
      for (Index s = 0; s < count; ++s) weights(s) = shares_(from + s) * shared(s, j) * shared(s, i);
      add_weighted_product(
          {VERNIER_LATER(left).col(from).data(), VERNIER_LATER(right).col(from).data(), weights.data(), tile.data(),
           products_[static_cast<std::size_t>(task)].data(), count, stride_, tile.cols(), &left == &right},
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
