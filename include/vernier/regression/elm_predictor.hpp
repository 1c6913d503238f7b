// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The fitted predictor of the ELM family.

#include "vernier/regression/detail/node_sum.hpp"
#include "vernier/regression/detail/predictor_interface.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier {

namespace detail {

/// A fitted network of one hidden layer.
struct FittedNetwork {
  HiddenLayer layer;      ///< its nodes
  ColumnScaling scaling;  ///< of the mapped features
  VectorX theta;          ///< weights and biases, node by node
  MatrixX beta;           ///< nodes x outputs
  VectorX offset;         ///< added to every prediction
};

/// @throws std::invalid_argument when the sizes do not fit together
VERNIER_API NodeSum node_sum_of(const FittedNetwork& network, int inputs);

}  // namespace detail

/// A fitted member of the ELM family: `y = offset + sum_k beta_k g(w_k, b_k, x)`.
template <int Inputs, int Outputs>
class ElmPredictor : public detail::PredictorInterface<ElmPredictor<Inputs, Outputs>, Inputs, Outputs> {
  using Base = detail::PredictorInterface<ElmPredictor<Inputs, Outputs>, Inputs, Outputs>;

 public:
  using typename Base::Input;
  using typename Base::Output;
  using typename Base::Slope;

  /// @param layer   how the hidden layer is built
  /// @param scaling of the mapped features, as fitted
  /// @param theta   weights and biases, node by node
  /// @param beta    nodes x outputs, in units of the outputs
  /// @param offset  added to every prediction
  /// @throws std::invalid_argument when the sizes do not fit together
  ElmPredictor(const HiddenLayer& layer, const ColumnScaling& scaling, const VectorX& theta,
               const Eigen::Matrix<double, Eigen::Dynamic, Outputs>& beta, const Output& offset)
      : ElmPredictor(detail::FittedNetwork{layer, scaling, theta, beta, offset}) {}

  /// The network of `Inputs` inputs and `Outputs` outputs.
  explicit ElmPredictor(const detail::FittedNetwork& network)
      : layer_(network.layer), sum_(detail::node_sum_of(network, Inputs)) {}

  /// The prediction, and where `slope` is not null the derivative.
  void evaluate(const Input& x, Output& y, Slope* slope) const noexcept {
    double workspace[detail::NodeSum::workspace(Inputs)];
    sum_.evaluate(x.data(), y.data(), slope != nullptr ? slope->data() : nullptr, workspace);
  }
  /// Predictions of samples, one a row.
  void evaluate_rows(const ConstMatrixRef& x, MatrixRef y) const { sum_.evaluate_rows(x, y); }

  /// Mapped and scaled features of a sample.
  /// @param x   the sample
  /// @param out `detail::NodeSum::workspace(Inputs)` numbers; the features are at its beginning
  void features(const Input& x, double* out) const noexcept { sum_.features(x.data(), out); }

  /// The hidden layer.
  const HiddenLayer& layer() const { return layer_; }
  /// Scaling of the mapped features.
  const ColumnScaling& scaling() const { return sum_.scaling(); }
  /// Weights and biases, node by node.
  VectorX theta() const { return sum_.weights_and_biases(); }
  /// Output weights, nodes x outputs.
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> beta() const { return sum_.coefficients(); }
  /// Added to every prediction.
  Output offset() const { return sum_.offset(); }

 private:
  HiddenLayer layer_;
  detail::NodeSum sum_;
};

namespace detail {

/// `ElmPredictor` for the numbers of columns of samples.
template <class X, class Y>
using ElmPredictorFor = ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime>;

}  // namespace detail
}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/elm_predictor.ipp"
#endif
