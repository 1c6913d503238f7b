#pragma once

/// @file
/// The training error of a network of one hidden layer as a function of all its weights: value, exact gradient,
/// Gauss-Newton curvature.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "vernier/core/executor.hpp"
#include "vernier/regression/hidden_layer.hpp"
#include "vernier/regression/tile_product.hpp"

namespace vernier::detail {

/// `F = sum_i q_i |B'h_i + c - t_i|^2 / sum q + decay (|W|^2 + |B|^2)`, h_i being the outputs of sigmoid or tanh nodes.
///
/// Weights lie in one vector: those of the hidden layer, node by node, then of each output B's column and c. With S the
/// slopes of the nodes and phi_j the features and one, the residuals of output o have the derivatives `B(k, o) s_k
/// phi_j`, h_k and 1, so the Gauss-Newton matrix needs no Jacobian: between hidden weights it is `(B B')(k, k')` times
/// `S' diag(phi_j phi_j') S`, between hidden and output weights `B(k, o)` times `S' diag(phi_j) [H 1]`, and for every
/// output the same `[H 1]'[H 1]`.
/// @cite Rumelhart 1986 (the gradient); Hagan and Menhaj 1994 (Gauss and Newton's matrix)
template <class Scalar>  // a template so that only its users pay for compiling the products
class NetworkErrorOf {
 public:
  /// @param layer    sigmoid or tanh nodes
  /// @param features n x f, scaled
  /// @param targets  n x m, scaled
  /// @param weights  q, n; only their ratios matter
  /// @param decay    of all weights but biases, 0 or more
  /// @param set      instructions to use; must be there
  NetworkErrorOf(const HiddenLayer& layer, MatrixX features, MatrixX targets, const VectorX& weights, double decay,
                 InstructionSet set = widest_instruction_set())
      : layer_(layer),
        features_(std::move(features)),
        targets_(std::move(targets)),
        shares_(weights / weights.sum()),
        decay_(decay),
        set_(set) {}

  /// Number of samples.
  Index samples() const { return features_.rows(); }
  /// Number of hidden weights and biases.
  Index hidden() const { return layer_.nodes * (features_.cols() + 1); }
  /// Number of all weights.
  Index dimension() const { return hidden() + (layer_.nodes + 1) * targets_.cols(); }

  /// F at weights `theta`, which `gradient` and `curvature` then speak of; infinity where it is not finite.
  double evaluate(const VectorX& theta) {
    theta_ = theta;
    const double value = over_samples(nullptr);
    return std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
  }

  /// dF/dtheta.
  VectorX gradient() {
    VectorX out = VectorX::Zero(dimension());
    over_samples(&out);
    return out;
  }

  /// The gradient of some samples' part of F, times how often they would make up all the weight there is: what a
  /// mini-batch says. @return their value of F
  double batch(const VectorX& theta, const std::vector<Index>& rows, VectorX& gradient) {
    theta_ = theta;
    const MatrixX x = features_(rows, Eigen::all), t = targets_(rows, Eigen::all);
    // A batch of heavy samples counts for more: the mean over batches is then the gradient of F.
    const VectorX q = shares_(rows) * (static_cast<double>(samples()) / static_cast<double>(rows.size()));
    gradient.setZero(dimension());
    return add(x, t, q, &gradient) + add_decay(&gradient);
  }

  /// The Gauss-Newton approximation of d2F/dtheta2.
  /// @param out      dimension x dimension, its lower triangle
  /// @param executor the bits do not depend on it
  void curvature(MatrixX& out, ExecutorRef executor = {}) {
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

 private:
  using RowMatrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::Map<const MatrixX> hidden_weights() const { return {theta_.data(), features_.cols() + 1, layer_.nodes}; }
  Eigen::Map<const MatrixX> output_weights() const {  // the last row: c
    return {theta_.data() + hidden(), layer_.nodes + 1, targets_.cols()};
  }

  double over_samples(VectorX* gradient) {
    constexpr Index tile = 256;  // stays in the second-level cache
    double value = add_decay(gradient);
    for (Index begin = 0; begin < samples(); begin += tile) {
      const Index count = std::min(tile, samples() - begin);
      value += add(features_.middleRows(begin, count), targets_.middleRows(begin, count), shares_.segment(begin, count),
                   gradient);
    }
    return value;
  }

  double add_decay(VectorX* gradient) const {
    const Index f = features_.cols(), h = layer_.nodes;
    if (gradient != nullptr) {
      Eigen::Map<MatrixX>(gradient->data(), f + 1, h).topRows(f) += 2 * decay_ * hidden_weights().topRows(f);
      Eigen::Map<MatrixX>(gradient->data() + hidden(), h + 1, targets_.cols()).topRows(h) +=
          2 * decay_ * output_weights().topRows(h);
    }
    return decay_ * (hidden_weights().topRows(f).squaredNorm() + output_weights().topRows(h).squaredNorm());
  }

  /// Forwards, and back where a gradient is asked for.
  template <class X, class T, class Q>
  double add(const X& x, const T& t, const Q& q, VectorX* gradient) {
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

  /// Outputs of nodes become their slopes.
  template <class H>
  void to_slopes(H&& h) const {
    if (layer_.activation == Activation::tanh) {
      h.array() = 1 - h.array().square();
    } else {
      h.array() *= 1 - h.array();
    }
  }

  /// [H 1] and S of all samples, by rows.
  void fill() {
    const Index h = layer_.nodes;
    stride_ = (h + 8) / 8 * 8;
    if (nodes_.size() == 0) nodes_ = slopes_ = RowMatrix::Zero(samples(), stride_);
    layer_.outputs(features_, theta_.head(hidden()), outputs_);
    nodes_.leftCols(h) = outputs_;
    nodes_.col(h).setOnes();
    to_slopes(outputs_);
    slopes_.leftCols(h) = outputs_;
  }

  /// Tasks below the number of pairs: S' diag(q phi_j phi_i) S. Then S' diag(q phi_j) [H 1]. The last: [H 1]'Q[H 1].
  void form_products(Index begin, Index end) {
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

  HiddenLayer layer_;
  MatrixX features_, targets_;
  VectorX shares_;  // of the samples in the weight there is
  double decay_;
  InstructionSet set_;
  VectorX theta_;
  MatrixX outputs_, residual_, pulled_;  // scratch
  Index stride_ = 0;
  RowMatrix nodes_, slopes_;         // n x stride: [H 1], S, zeros
  std::vector<RowMatrix> products_;  // see form_products
};

/// In double precision.
using NetworkError = NetworkErrorOf<double>;

}  // namespace vernier::detail
