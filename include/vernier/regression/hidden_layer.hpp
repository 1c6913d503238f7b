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

  /// Value and derivative of a node that is not a radial basis.
  static std::pair<double, double> activate(Activation activation, double z) noexcept {
    switch (activation) {
      case Activation::tanh: {
        const double t = std::tanh(z);
        return {t, 1 - t * t};
      }
      case Activation::sine: return {std::sin(z), std::cos(z)};
      default: {
        const double s = 1 / (1 + std::exp(-z));
        return {s, s * (1 - s)};
      }
    }
  }
};

/// A fitted member of the ELM family: `y = offset + sum_k beta_k g(w_k, b_k, x)`, scalings folded in where possible.
template <int Inputs, int Outputs>
class ElmPredictor {
 public:
  /// Number of inputs.
  static constexpr int inputs = Inputs;
  /// Number of outputs.
  static constexpr int outputs = Outputs;
  /// One sample.
  using Input = Eigen::Matrix<double, Inputs, 1>;
  /// One prediction.
  using Output = Eigen::Matrix<double, Outputs, 1>;

  /// @param layer   how the hidden layer is built
  /// @param scaling of the mapped features, as fitted
  /// @param theta   weights and biases, node by node
  /// @param beta    nodes x outputs, in units of the outputs
  /// @param offset  added to every prediction
  /// @throws std::invalid_argument when the sizes do not fit together
  ElmPredictor(const HiddenLayer& layer, ColumnScaling scaling, const VectorX& theta,
               const Eigen::Matrix<double, Eigen::Dynamic, Outputs>& beta, const Output& offset)
      : layer_(layer), scaling_(std::move(scaling)), beta_(beta.transpose()), offset_(offset) {
    const Index f = layer.features(Inputs);
    require(theta.size() == layer.dimension(Inputs) && beta.rows() == layer.nodes && scaling_.offset.size() == f &&
                scaling_.factor.size() == f,
            "ElmPredictor: ", layer.nodes, " nodes of ", f, " features need ", layer.dimension(Inputs), " weights and ",
            layer.nodes, " rows of output weights, got ", theta.size(), " and ", beta.rows());
    weights_ = Eigen::Map<const MatrixX>(theta.data(), f + 1, layer.nodes);
  }

  /// One sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output predict(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Features features = features_of(Input(x));
    Output y = offset_;
    for (Index k = 0; k < weights_.cols(); ++k) y += beta_.col(k) * node(k, features).first;
    return y;
  }

  /// Samples as rows, n x inputs to n x outputs.
  template <class Derived>
    requires detail::SampleRowsOf<Derived, Inputs> Eigen::Matrix<double, Eigen::Dynamic, Outputs> predict(
        const Eigen::MatrixBase<Derived>& x)
  const {
    Eigen::Matrix<double, Eigen::Dynamic, Outputs> y(x.rows(), Outputs);
    for (Index i = 0; i < x.rows(); ++i) y.row(i) = predict(Input(x.row(i).transpose())).transpose();
    return y;
  }

  /// d predict / d x at one sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Eigen::Matrix<double, Outputs, Inputs> derivative(
        const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Features features = features_of(Input(x));
    const Index f = features.size();
    constexpr int layout = Outputs == 1 ? Eigen::RowMajor : Eigen::ColMajor;  // Eigen wants row vectors stored by row
    Eigen::Matrix<double, Outputs, Eigen::Dynamic, layout, Outputs, 2 * Inputs> by_feature(Outputs, f);
    by_feature.setZero();
    for (Index k = 0; k < weights_.cols(); ++k) {
      const double slope = node(k, features).second;
      const double bias = weights_(f, k);
      for (Index j = 0; j < f; ++j) {
        const double direction = layer_.activation == Activation::radial_basis
                                     ? -2 * bias * bias * (features(j) - weights_(j, k))
                                     : weights_(j, k);
        by_feature.col(j) += beta_.col(k) * (slope * direction);
      }
    }
    Eigen::Matrix<double, Outputs, Inputs> out;
    for (int j = 0; j < Inputs; ++j) {
      if (layer_.input_map == InputMap::raw) {
        out.col(j) = by_feature.col(j) * scaling_.factor(j);
      } else {
        out.col(j) = by_feature.col(j) * (scaling_.factor(j) * std::cos(x(j))) -
                     by_feature.col(Inputs + j) * (scaling_.factor(Inputs + j) * std::sin(x(j)));
      }
    }
    return out;
  }

  /// The hidden layer.
  const HiddenLayer& layer() const { return layer_; }
  /// Scaling of the mapped features.
  const ColumnScaling& scaling() const { return scaling_; }
  VectorX theta() const { return weights_.reshaped(); }  ///< weights and biases, node by node
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> beta() const { return beta_.transpose(); }  ///< nodes x outputs
  /// Added to every prediction.
  const Output& offset() const { return offset_; }

 private:
  using Features = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * Inputs, 1>;

  Features features_of(const Input& x) const noexcept {
    Features f(layer_.features(Inputs));
    if (layer_.input_map == InputMap::raw) {
      f = x;
    } else {
      for (int j = 0; j < Inputs; ++j) {
        f(j) = std::sin(x(j));
        f(Inputs + j) = std::cos(x(j));
      }
    }
    f = (f - scaling_.offset).cwiseProduct(scaling_.factor);
    return f;
  }

  /// Value and slope of node k; a radial basis has its slope with respect to the exponent.
  std::pair<double, double> node(Index k, const Features& f) const noexcept {
    const Index n = f.size();
    if (layer_.activation == Activation::radial_basis) {
      const double b = weights_(n, k), g = std::exp(-b * b * (f - weights_.col(k).head(n)).squaredNorm());
      return {g, g};
    }
    return HiddenLayer::activate(layer_.activation, weights_.col(k).head(n).dot(f) + weights_(n, k));
  }

  HiddenLayer layer_;
  ColumnScaling scaling_;
  MatrixX weights_;                                      // (features + 1) x nodes, biases in the last row
  Eigen::Matrix<double, Outputs, Eigen::Dynamic> beta_;  // outputs x nodes: one node contiguous
  Output offset_;
};

}  // namespace vernier
