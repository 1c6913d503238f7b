#pragma once

/// @file
/// An extreme learning machine that goes on learning: online sequential ELM.

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// A fitted `OsElm`: predicts like any other, and learns from further samples by `update`. An update costs three times
/// (nodes + 1)^2 multiply-adds.
///
/// `P = (H'W H + Lambda)^-1` is kept as B with `P = B'B` (Potter's square root), so that it stays symmetric and
/// positive semidefinite however many updates there are, and rounding sees the square root of its condition. Without
/// forgetting, P shrinks and the output weights settle. With forgetting, P grows by 1 / mu an update in directions of
/// the hidden layer that no sample excites any more (the ridge is forgotten, too): the samples must keep visiting the
/// whole working range, or after some ln(1e12) / (1 - mu) updates at one place the next sample elsewhere moves the
/// prediction by as much as it likes.
/// @cite Liang 2006; Potter 1963
template <int Inputs, int Outputs>
class OsElmPredictor {
 public:
  /// Number of inputs.
  static constexpr int inputs = Inputs;
  /// Number of outputs.
  static constexpr int outputs = Outputs;
  /// One sample.
  using Input = Eigen::Matrix<double, Inputs, 1>;
  /// One prediction.
  using Output = Eigen::Matrix<double, Outputs, 1>;

  /// The batch solution.
  /// @param layer      the hidden layer; its features are not scaled
  /// @param theta      weights and biases, node by node
  /// @param lambda     ridge of the output weights
  /// @param forgetting mu
  /// @param x          n x inputs
  /// @param y          n x outputs
  /// @param weights    of the samples; null: one
  template <class X, class Y>
  OsElmPredictor(const HiddenLayer& layer, const VectorX& theta, double lambda, double forgetting,
                 const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y, const VectorX* weights)
      : layer_(layer), theta_(theta), forgetting_(forgetting) {
    const Index n = x.rows(), size = layer.nodes + 1;
    MatrixX stacked = MatrixX::Zero(n + layer.nodes, size), right = MatrixX::Zero(n + layer.nodes, Outputs);
    stacked.topRows(n) = hidden(x);
    right.topRows(n) = y;
    total_ = static_cast<double>(n);
    if (weights != nullptr) {
      stacked.topRows(n) = weights->cwiseSqrt().asDiagonal() * MatrixX(stacked.topRows(n));
      right.topRows(n) = weights->cwiseSqrt().asDiagonal() * y;
      total_ = weights->sum();
    }
    stacked.bottomRows(layer.nodes).diagonal().setConstant(std::sqrt(lambda));  // the constant has none
    const Eigen::HouseholderQR<MatrixX> qr(stacked);
    coefficients_ = qr.solve(right);
    square_ = (right - stacked * coefficients_).colwise().squaredNorm().transpose();
    root_ = MatrixX::Identity(size, size);  // R^-T
    qr.matrixQR().topRows(size).template triangularView<Eigen::Upper>().transpose().solveInPlace(root_);
    learned_ = learned();
  }

  /// One sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output predict(const Eigen::MatrixBase<Derived>& x)
  const noexcept { return learned_.predict(x); }

  /// Samples as rows, n x inputs to n x outputs.
  template <class Derived>
    requires detail::SampleRowsOf<Derived, Inputs> Eigen::Matrix<double, Eigen::Dynamic, Outputs> predict(
        const Eigen::MatrixBase<Derived>& x)
  const { return learned_.predict(x); }

  /// d predict / d x at one sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Eigen::Matrix<double, Outputs, Inputs> derivative(
        const Eigen::MatrixBase<Derived>& x)
  const noexcept { return learned_.derivative(x); }

  /// Of the predicted function, `sqrt(noise_variance() h'P h)`, h the hidden layer at x: how far the output weights
  /// are known, given the hidden ones. O(nodes^2).
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    constexpr Index tile = 128;
    const detail::MappedSample<Inputs> at(layer_.input_map, learned_.scaling(), x);
    const Index size = root_.rows();
    double square = 0;
    for (Index first = 0; first < size; first += tile) {
      const Index count = std::min(tile, size - first);
      double product[tile] = {};
      for (Index k = 0; k < size; ++k) {
        const double h = node(k, at.value);
        for (Index i = 0; i < count; ++i) product[i] += root_(first + i, k) * h;
      }
      for (const double part : product) square += part * part;
    }
    return (noise_variance() * square).cwiseSqrt();
  }

  /// Learns one sample: what was learned before counts mu times as much, then the sample is added.
  /// @param x      as `predict` takes it
  /// @param y      what should have been predicted
  /// @param weight positive; a sample of weight 2 counts as two
  /// @throws std::invalid_argument when a value is not finite or the weight not positive; then nothing is learned
  void update(const Input& x, const Output& y, double weight = 1) {
    const VectorX one = VectorX::Constant(1, weight);
    update(Eigen::Matrix<double, Eigen::Dynamic, Inputs>(x.transpose()),
           Eigen::Matrix<double, Eigen::Dynamic, Outputs>(y.transpose()), &one);
  }

  /// Learns a block of samples, which are one moment in time: mu applies once.
  /// @param x       n x inputs, n may be 0
  /// @param y       n x outputs
  /// @param weights positive, one a row; null: one
  /// @throws std::invalid_argument as above, and for numbers of rows that differ
  template <class X, class Y>
    requires detail::SampleRowsOf<X, Inputs> && detail::SampleRowsOf<Y, Outputs>
  void update(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y, const VectorX* weights = nullptr) {
    if (x.rows() == 0 && y.rows() == 0) return;
    detail::require_samples("OsElmPredictor::update", x, y, FitOptions{.weights = weights});
    const MatrixX h = hidden(x);
    root_ /= std::sqrt(forgetting_);
    square_ *= forgetting_;
    total_ *= forgetting_;
    for (Index i = 0; i < h.rows(); ++i)
      absorb(h.row(i).transpose(), y.row(i).transpose(), weights != nullptr ? (*weights)(i) : 1);
    learned_ = learned();
  }

  /// The hidden layer.
  const HiddenLayer& layer() const { return layer_; }
  /// What predicts, as it is now.
  const ElmPredictor<Inputs, Outputs>& elm() const { return learned_; }
  /// P, (nodes + 1) square, the constant last.
  MatrixX covariance() const { return root_.transpose() * root_; }
  /// Of a sample of weight one, each output: squared residuals and ridge, over the weight of all samples learned.
  Output noise_variance() const { return square_ / total_; }

 private:
  static ColumnScaling unscaled(Index features) { return {VectorX::Zero(features), VectorX::Ones(features)}; }

  /// Outputs of the nodes and a one, n x (nodes + 1).
  template <class X>
  MatrixX hidden(const Eigen::MatrixBase<X>& x) const {
    MatrixX nodes, out(x.rows(), layer_.nodes + 1);
    layer_.outputs(layer_.map(x), theta_, nodes);
    out << nodes, VectorX::Ones(x.rows());
    return out;
  }

  /// One of them, of features.
  double node(Index k, const double* features) const noexcept {
    if (k == layer_.nodes) return 1;
    const Index f = layer_.features(Inputs);
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
  void absorb(const VectorX& h, const Output& y, double weight) {
    const VectorX f = root_ * h, through = root_.transpose() * f;
    const double scale = 1 / (1 / weight + f.squaredNorm());
    const Output error = y - coefficients_.transpose() * h;
    coefficients_ += scale * through * error.transpose();
    root_ -= scale / (1 + std::sqrt(scale / weight)) * f * through.transpose();
    square_ += scale * error.cwiseAbs2();
    total_ += weight;
  }

  ElmPredictor<Inputs, Outputs> learned() const {
    return {layer_, unscaled(layer_.features(Inputs)), theta_, coefficients_.topRows(layer_.nodes),
            coefficients_.row(layer_.nodes).transpose()};
  }

  HiddenLayer layer_;
  VectorX theta_;
  double forgetting_, total_ = 0;
  MatrixX root_;                                                 // B
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> coefficients_;  // output weights, then the constant
  Output square_;                                                // |residuals|^2 + lambda |beta|^2
  ElmPredictor<Inputs, Outputs> learned_{
      HiddenLayer{.nodes = 1, .input_map = InputMap::raw}, unscaled(Inputs), VectorX::Zero(Inputs + 1),
      Eigen::Matrix<double, Eigen::Dynamic, Outputs>::Zero(1, Outputs), Output::Zero()};
};

/// Online sequential ELM: hidden weights drawn from the seed, output weights by ridge regression, and a predictor that
/// goes on learning, see `OsElmPredictor::update`. After any updates without forgetting it is the fit of all samples
/// at once, whichever came first. So nothing may depend on the range of the first samples: inputs are not scaled (raw
/// ones should be of size one, as radians are), targets neither, and the mean is not penalised.
/// @cite Liang 2006
struct OsElm {
  int hidden_nodes = 65;  ///< at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// What the layer sees of each input; raw inputs as they are.
  InputMap input_map = InputMap::sines_and_cosines;
  double weight_limit = 1;  ///< hidden weights and biases lie in [-limit, limit]
  double lambda = 1e-6;     ///< ridge of the output weights, positive
  double forgetting =
      1;  ///< mu in (0, 1]: by how much an update lets everything before it count; `fit` forgets nothing

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, Scaling::none, weight_limit}; }

  /// The batch solution.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the seed draws the hidden weights
  /// @throws std::invalid_argument for unusable samples, weights or options
  template <class X, class Y>
  OsElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                                 const Eigen::MatrixBase<Y>& targets,
                                                                 const FitOptions& options = {}) const {
    layer().validate("OsElm");
    require(lambda > 0 && std::isfinite(lambda), "OsElm: lambda is ", lambda, ", must be positive");
    require(forgetting > 0 && forgetting <= 1, "OsElm: forgetting is ", forgetting, ", must lie in (0, 1]");
    detail::require_samples("OsElm", inputs, targets, options);
    return {layer(),        layer().draw(X::ColsAtCompileTime, options.seed), lambda, forgetting, inputs, targets,
            options.weights};
  }
};

}  // namespace vernier
