#pragma once

/// @file
/// One hidden layer of an extreme learning machine: input map, scaling, weights, activation.

#include <cmath>
#include <utility>

#include "vernier/core/box.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/concepts.hpp"
#include "vernier/regression/scaling.hpp"

namespace vernier {

/// The function of a hidden node, z = w'x + b.
enum class Activation {
  sigmoid,       ///< 1 / (1 + exp(-z))
  tanh,          ///< tanh(z)
  sine,          ///< sin(z)
  radial_basis,  ///< exp(-b^2 |x - w|^2): w is a centre, b an inverse width
};

/// What the layer sees of each input.
enum class InputMap {
  raw,               ///< the input itself, scaled
  sines_and_cosines  ///< sin and cos of each input, unscaled: right for joint angles, needs no range
};

/// The hidden layer as a recipe; shared by the members of the ELM family.
/// @cite Huang 2006
struct HiddenLayer {
  int nodes = 65;  ///< number of hidden nodes, at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// What the layer sees of each input.
  InputMap input_map = InputMap::raw;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs; sines and cosines stay as they are
  double weight_limit = 1;                   ///< weights and biases lie in [-limit, limit]

  /// Number of features of so many inputs.
  int features(int inputs) const { return input_map == InputMap::raw ? inputs : 2 * inputs; }
  /// Weights and bias of every node, node by node.
  Index dimension(int inputs) const { return static_cast<Index>(nodes) * (features(inputs) + 1); }
  /// Where weights and biases lie.
  Box box(int inputs) const { return Box::cube(dimension(inputs), -weight_limit, weight_limit); }

  /// Throws `std::invalid_argument` naming an unusable value.
  void validate(const char* caller) const {
    require(nodes >= 1, caller, ": hidden_nodes is ", nodes, ", must be at least 1");
    require(weight_limit > 0 && weight_limit < 1e6, caller, ": weight_limit is ", weight_limit,
            ", must be positive and below 1e6");
  }

  /// Weights drawn uniformly from the box.
  VectorX draw(int inputs, std::uint64_t seed) const {
    Rng rng(seed);
    VectorX theta(dimension(inputs));
    for (auto& value : theta) value = rng.uniform(-weight_limit, weight_limit);
    return theta;
  }

  /// Features of samples before scaling, n x features.
  template <class Inputs>
  MatrixX map(const Eigen::MatrixBase<Inputs>& inputs) const {
    if (input_map == InputMap::raw) return inputs;
    MatrixX out(inputs.rows(), 2 * inputs.cols());
    out << inputs.array().sin().matrix(), inputs.array().cos().matrix();
    return out;
  }

  /// Scaling of the mapped features.
  ColumnScaling scaling(const Eigen::Ref<const MatrixX>& mapped) const {
    return ColumnScaling::fit(mapped, input_map == InputMap::raw ? input_scaling : Scaling::none);
  }

  /// H, n x nodes, of scaled features n x features at weights `theta`. `out` is resized only when its shape differs.
  template <class Features>
  void outputs(const Eigen::MatrixBase<Features>& features, const Eigen::Ref<const VectorX>& theta,
               MatrixX& out) const {
    const Index f = features.cols();
    const Eigen::Map<const MatrixX> weights(theta.data(), f + 1, nodes);
    out.resize(features.rows(), nodes);
    if (activation == Activation::radial_basis) {
      for (Index k = 0; k < nodes; ++k) {
        const double inverse_width = weights(f, k);
        out.col(k) = (-inverse_width * inverse_width *
                      (features.rowwise() - weights.col(k).head(f).transpose()).rowwise().squaredNorm().array())
                         .exp()
                         .matrix();
      }
      return;
    }
    out.noalias() = features * weights.topRows(f);
    out.rowwise() += weights.row(f);
    switch (activation) {
      case Activation::sigmoid: out = (1 + (-out.array()).exp()).inverse().matrix(); break;
      case Activation::tanh: out = out.array().tanh().matrix(); break;
      case Activation::sine: out = out.array().sin().matrix(); break;
      case Activation::radial_basis: break;
    }
  }
};

}  // namespace vernier
