// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Online sequential ELM: an extreme learning machine that is updated with further samples.

#include <cmath>

#include "vernier/regression/detail/online_elm.hpp"

namespace vernier {

/// A fitted `OsElm`: a predictor that `update` trains on further samples. An update costs three times
/// (nodes + 1)^2 multiply-adds.
///
/// `P = (H'W H + Lambda)^-1` is kept as B with `P = B'B` (Potter's square root), so that it stays symmetric and
/// positive semidefinite however many updates there are, and rounding errors grow with the square root of its
/// condition. Without forgetting, P shrinks and the output weights settle. With forgetting, P grows by 1 / mu an update
/// in directions of the hidden layer that no sample excites any more (the ridge is forgotten, too): the samples must
/// keep visiting the whole working range, or after some ln(1e12) / (1 - mu) updates at one place the next sample
/// elsewhere changes the prediction without bound.
/// @cite Liang 2006; Potter 1963
template <int Inputs, int Outputs>
class OsElmPredictor : public detail::PredictorInterface<OsElmPredictor<Inputs, Outputs>, Inputs, Outputs> {
  using Base = detail::PredictorInterface<OsElmPredictor<Inputs, Outputs>, Inputs, Outputs>;

 public:
  using typename Base::Input;
  using typename Base::Output;
  using typename Base::Slope;

  /// Predicts by the network of `online`.
  explicit OsElmPredictor(const detail::OnlineElm& online) : online_(online), learned_(online.network()) {}

  /// The prediction, and where `slope` is not null the derivative.
  void evaluate(const Input& x, Output& y, Slope* slope) const noexcept { learned_.evaluate(x, y, slope); }
  /// Predictions of samples, one a row.
  void evaluate_rows(const ConstMatrixRef& x, MatrixRef y) const { learned_.evaluate_rows(x, y); }

  /// Of the predicted function, `sqrt(noise_variance() h'P h)`, h the hidden layer at x: the uncertainty of the output
  /// weights, given the hidden ones. O(nodes^2).
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Input at = x;
    double workspace[detail::NodeSum::workspace(Inputs)];
    learned_.features(at, workspace);
    const double factor = online_.variance_factor(workspace);
    Output out;
    for (int o = 0; o < Outputs; ++o) out(o) = std::sqrt(online_.noise_variance(o) * factor);
    return out;
  }

  /// Learns one sample: all samples before are weighted by mu, then the sample is added.
  /// @param x      as `predict` takes it
  /// @param y      measured output
  /// @param weight positive; a sample of weight 2 counts as two
  /// @throws std::invalid_argument when a value is not finite or the weight not positive; then nothing is learned
  void update(const Input& x, const Output& y, double weight = 1) {
    const VectorX one = VectorX::Constant(1, weight);
    update(Eigen::Matrix<double, Eigen::Dynamic, Inputs>(x.transpose()),
           Eigen::Matrix<double, Eigen::Dynamic, Outputs>(y.transpose()), &one);
  }

  /// Learns a block of samples, all of one time: mu applies once.
  /// @param x       n x inputs, n may be 0
  /// @param y       n x outputs
  /// @param weights positive, one a row; null: one
  /// @throws std::invalid_argument as above, and for numbers of rows that differ
  template <class X, class Y>
    requires detail::SampleRowsOf<X, Inputs> && detail::SampleRowsOf<Y, Outputs>
  void update(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y, const VectorX* weights = nullptr) {
    if (x.rows() == 0 && y.rows() == 0) return;
    detail::require_samples("OsElmPredictor::update", x, y, FitOptions{.weights = weights});
    online_.update(x.derived(), y.derived(), weights);
    learned_ = ElmPredictor<Inputs, Outputs>(online_.network());
  }

  /// The hidden layer.
  const HiddenLayer& layer() const { return online_.layer(); }
  /// The network as it is now.
  const ElmPredictor<Inputs, Outputs>& elm() const { return learned_; }
  /// P, (nodes + 1) square, the constant last.
  MatrixX covariance() const { return online_.covariance(); }
  /// Of a sample of weight one, each output: squared residuals and ridge, over the weight of all samples learned.
  Output noise_variance() const { return online_.noise_variance(); }

 private:
  detail::OnlineElm online_;
  ElmPredictor<Inputs, Outputs> learned_;
};

/// Online sequential ELM: hidden weights drawn from the seed, output weights by ridge regression, and a predictor with
/// an `update`. Without forgetting the updates lead to the fit of all samples at once, in any order. So nothing may
/// depend on the range of the first samples: inputs are not scaled (raw ones should be of size one, as radians are),
/// targets neither, and the mean is not penalised.
/// @cite Liang 2006
struct OsElm {
  int hidden_nodes = 65;  ///< at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// Features of the inputs; not scaled.
  InputMap input_map = InputMap::sines_and_cosines;
  double weight_limit = 1;  ///< hidden weights and biases lie in [-limit, limit]
  double lambda = 1e-6;     ///< ridge of the output weights, positive
  double forgetting = 1;    ///< mu in (0, 1]: an update multiplies the weight of all samples before it by mu

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
    validate();
    detail::require_samples("OsElm", inputs, targets, options);
    return OsElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime>(
        detail::OnlineElm(layer(), layer().draw(X::ColsAtCompileTime, options.seed), lambda, forgetting,
                          inputs.derived(), targets.derived(), options.weights));
  }

 private:
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/os_elm.ipp"
#endif
