// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/simd.hpp"
#include "vernier/regression/detail/node_sum.hpp"

namespace vernier::detail {

/// Arguments of the kernel: nodes and one sample.
struct NodeBlock {
  NodeFunction function;
  const double* weights;       // rows of `stride`: of each feature, then biases
  const double* features;      // of the sample
  Index count, stride, nodes;  // of features, of a row, of nodes to evaluate, a multiple of 8
  double* values;              // nodes
  double* slopes;              // nodes; see `node_function`
};

/// z becomes the value of sigmoid, tanh or sine nodes, `slope` their derivative.
template <int W>
VERNIER_INLINE void projection_function(NodeFunction function, typename Simd<W>::Double& z,
                                        typename Simd<W>::Double& slope) {
  using Double = typename Simd<W>::Double;
  if (function == NodeFunction::sine) {
    Double angle[1] = {z}, sine[1], cosine[1];
    sincos<W>(angle, sine, cosine);
    z = sine[0];
    slope = cosine[0];
  } else if (function == NodeFunction::tanh) {
    z += z;
    sigmoid<W>(z);
    z = 2.0 * z - 1.0;
    slope = 1.0 - z * z;
  } else {
    sigmoid<W>(z);
    slope = z * (1.0 - z);
  }
}

/// `square`, of the distance, becomes the value of a node around a centre; `slope` its derivative with respect to a
/// coordinate, divided by the distance along that coordinate.
template <int W>
VERNIER_INLINE void distance_function(NodeFunction function, const typename Simd<W>::Double& bias,
                                      typename Simd<W>::Double& square, typename Simd<W>::Double& slope) {
  using Double = typename Simd<W>::Double;
  if (function == NodeFunction::squared_exponential) {
    square *= -0.5;
    exponential<W>(square);
    slope = -square;
  } else if (function == NodeFunction::radial_basis) {
    square *= -bias * bias;
    exponential<W>(square);
    slope = -2.0 * bias * bias * square;
  } else {
    Double s = 5.0 * square;
    VERNIER_UNROLL
    for (int lane = 0; lane < W; ++lane) s[lane] = std::sqrt(s[lane]);
    Double e = -s;
    exponential<W>(e);
    slope = (1.0 + s) * e;
    square = slope + (5.0 / 3) * square * e;
    slope *= -5.0 / 3;
  }
}

VERNIER_LOCAL inline bool is_projection(NodeFunction function) { return function <= NodeFunction::sine; }

/// Values and slopes of all nodes of a block.
template <int W>
VERNIER_INLINE void evaluate_nodes(const NodeBlock& b) {
  typename Simd<W>::Double value, slope, weight, bias;
  const double* biases = b.weights + b.count * b.stride;
  for (Index k = 0; k < b.nodes; k += W) {
    load<W>(bias, biases + k);
    if (is_projection(b.function)) {
      value = bias;
      for (Index j = 0; j < b.count; ++j) {
        load<W>(weight, b.weights + j * b.stride + k);
        value += b.features[j] * weight;
      }
      projection_function<W>(b.function, value, slope);
    } else {
      value = typename Simd<W>::Double{};
      for (Index j = 0; j < b.count; ++j) {
        load<W>(weight, b.weights + j * b.stride + k);
        weight = b.features[j] - weight;
        value += weight * weight;
      }
      distance_function<W>(b.function, bias, value, slope);
    }
    store<W>(b.values + k, value);
    store<W>(b.slopes + k, slope);
  }
}

/// Sums over 8 lanes, whatever the width of the vectors, so that all instruction sets add up in one order.
template <int W>
struct Lanes {
  static constexpr int vectors = 8 / W;
  typename Simd<W>::Double sum[vectors];

  VERNIER_INLINE void clear() {
    VERNIER_UNROLL
    for (int v = 0; v < vectors; ++v) sum[v] = typename Simd<W>::Double{};
  }

  VERNIER_INLINE double total() const {
    double parts[8];
    VERNIER_UNROLL
    for (int v = 0; v < vectors; ++v) store<W>(parts + v * W, sum[v]);
    return ((parts[0] + parts[4]) + (parts[2] + parts[6])) + ((parts[1] + parts[5]) + (parts[3] + parts[7]));
  }
};

/// Sum over the nodes of a block: one output.
template <int W>
VERNIER_INLINE double sum_of_nodes(const NodeBlock& b, const double* coefficients) {
  Lanes<W> lanes;
  lanes.clear();
  typename Simd<W>::Double coefficient, value;
  for (Index k = 0; k < b.nodes; k += 8) {
    VERNIER_UNROLL
    for (int v = 0; v < Lanes<W>::vectors; ++v) {
      load<W>(coefficient, coefficients + k + v * W);
      load<W>(value, b.values + k + v * W);
      lanes.sum[v] += coefficient * value;
    }
  }
  return lanes.total();
}

/// Its derivative with respect to each feature.
/// @param effects coefficients times slopes, of the nodes
template <int W>
VERNIER_INLINE void feature_gradient(const NodeBlock& b, const double* coefficients, double* effects,
                                     double* gradient) {
  Lanes<W> lanes;
  typename Simd<W>::Double effect, weight;
  for (Index k = 0; k < b.nodes; k += W) {
    load<W>(effect, coefficients + k);
    load<W>(weight, b.slopes + k);
    effect *= weight;
    store<W>(effects + k, effect);
  }
  const bool projection = is_projection(b.function);
  for (Index j = 0; j < b.count; ++j) {
    lanes.clear();
    for (Index k = 0; k < b.nodes; k += 8) {
      VERNIER_UNROLL
      for (int v = 0; v < Lanes<W>::vectors; ++v) {
        load<W>(effect, effects + k + v * W);
        load<W>(weight, b.weights + j * b.stride + k + v * W);
        if (!projection) weight = b.features[j] - weight;
        lanes.sum[v] += effect * weight;
      }
    }
    gradient[j] = lanes.total();
  }
}

VERNIER_IMPL NodeSum::NodeSum(NodeFunction function, InputMap map, int inputs, const ColumnScaling& scaling,
                              const ConstMatrixRef& weights, const ConstVectorRef& biases,
                              const ConstMatrixRef& coefficients, const ConstVectorRef& offset)
    : function_(function),
      map_(map),
      inputs_(inputs),
      features_(weights.rows()),
      nodes_(weights.cols()),
      outputs_(coefficients.cols()),
      scaling_(scaling),
      packed_(MatrixX::Zero((nodes_ + 7) / 8 * 8, features_ + 1 + outputs_)),
      offset_(offset) {
  for (Index k = 0; k < nodes_; ++k) {
    for (Index j = 0; j < features_; ++j) packed_(k, j) = weights(j, k);
    if (biases.size() > 0) packed_(k, features_) = biases(k);
    for (Index o = 0; o < outputs_; ++o) packed_(k, features_ + 1 + o) = coefficients(k, o);
  }
}

VERNIER_IMPL void NodeSum::features(const double* x, double* workspace) const noexcept {
  map_inputs(map_, x, inputs_, workspace, workspace + features_, workspace + features_ + inputs_);
  for (Index j = 0; j < features_; ++j) workspace[j] = (workspace[j] - scaling_.offset(j)) * scaling_.factor(j);
}

VERNIER_IMPL void NodeSum::evaluate(const double* x, double* y, double* slope, double* workspace) const noexcept {
  constexpr Index most = 128;  // nodes of a block
  double values[most], slopes[most], effects[most];
  const double *sine = workspace + features_, *cosine = sine + inputs_;
  double* gradient = workspace + features_ + 2 * inputs_;
  features(x, workspace);
  std::copy(offset_.data(), offset_.data() + outputs_, y);
  if (slope != nullptr) std::fill(slope, slope + outputs_ * inputs_, 0.0);
  run_widest([&]<int W>() VERNIER_INLINED {
    for (Index first = 0; first < packed_.rows(); first += most) {
      const NodeBlock block{function_,      column(0) + first,
                            workspace,      features_,
                            packed_.rows(), (std::min)(most, packed_.rows() - first),
                            values,         slopes};
      evaluate_nodes<W>(block);
      for (Index o = 0; o < outputs_; ++o) {
        const double* coefficients = column(features_ + 1 + o) + first;
        y[o] += sum_of_nodes<W>(block, coefficients);
        if (slope == nullptr) continue;
        feature_gradient<W>(block, coefficients, effects, gradient);
        for (Index j = 0; j < features_; ++j) gradient[j] *= scaling_.factor(j);
        add_input_gradient(map_, gradient, sine, cosine, inputs_, slope + o, outputs_);
      }
    }
  });
}

VERNIER_IMPL void NodeSum::evaluate_rows(const ConstMatrixRef& x, MatrixRef y) const {
  VectorX sample(inputs_), prediction(outputs_), memory(workspace(static_cast<int>(inputs_)));
  for (Index i = 0; i < x.rows(); ++i) {
    for (Index j = 0; j < inputs_; ++j) sample(j) = x(i, j);
    evaluate(sample.data(), prediction.data(), nullptr, memory.data());
    for (Index o = 0; o < outputs_; ++o) y(i, o) = prediction(o);
  }
}

VERNIER_IMPL void NodeSum::node_values(const double* features, Index first, Index count, double* out) const noexcept {
  constexpr Index most = 64;
  double slopes[most];
  for (Index begin = 0; begin < count; begin += most) {
    const NodeBlock block{function_,      column(0) + first + begin,       features,    features_,
                          packed_.rows(), (std::min)(most, count - begin), out + begin, slopes};
    run_widest([&]<int W>() VERNIER_INLINED { evaluate_nodes<W>(block); });
  }
}

VERNIER_IMPL MatrixX NodeSum::weights() const {
  return VERNIER_LATER(packed_).topLeftCorner(nodes_, features_).transpose();
}

VERNIER_IMPL VectorX NodeSum::weights_and_biases() const {
  VectorX out(nodes_ * (features_ + 1));
  for (Index k = 0; k < nodes_; ++k)
    for (Index j = 0; j <= features_; ++j) out(k * (features_ + 1) + j) = packed_(k, j);
  return out;
}

VERNIER_IMPL MatrixX NodeSum::coefficients() const {
  return VERNIER_LATER(packed_).block(0, features_ + 1, nodes_, outputs_);
}

}  // namespace vernier::detail
