// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Recursive least squares for the output weights of a hidden layer.

#include "vernier/regression/elm_predictor.hpp"

namespace vernier::detail {

/// The state of an `OsElmPredictor`. `P = (H'W H + Lambda)^-1` is kept as B with `P = B'B`.
/// @cite Liang 2006; Potter 1963
class OnlineElm {
 public:
  /// The batch solution, see `OsElmPredictor`.
  /// @param weights of the samples; null: one
  VERNIER_API OnlineElm(const HiddenLayer& layer, const VectorX& theta, double lambda, double forgetting,
                        const ConstMatrixRef& x, const ConstMatrixRef& y, const VectorX* weights);

  /// Learns a block of samples.
  VERNIER_API void update(const ConstMatrixRef& x, const ConstMatrixRef& y, const VectorX* weights);

  /// h'P h, h being the hidden layer at a sample and a one.
  /// @param features of the sample
  VERNIER_API double variance_factor(const double* features) const noexcept;

  /// The network as it is now.
  VERNIER_API FittedNetwork network() const;
  /// The hidden layer.
  const HiddenLayer& layer() const { return layer_; }
  /// P.
  VERNIER_API MatrixX covariance() const;
  /// Of a sample of weight one, each output.
  VERNIER_API VectorX noise_variance() const;
  /// The update for one output.
  double noise_variance(Index output) const noexcept { return square_(output) / total_; }

 private:
  VERNIER_API MatrixX hidden(const ConstMatrixRef& x) const;
  VERNIER_API double node(Index k, const double* features) const noexcept;
  VERNIER_API void absorb(const VectorX& h, const VectorX& y, double weight);

  HiddenLayer layer_;
  VectorX theta_;
  Index features_;
  double forgetting_, total_ = 0;
  MatrixX root_;          // B
  MatrixX coefficients_;  // output weights, then the constant
  VectorX square_;        // |residuals|^2 + lambda |beta|^2
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/online_elm.ipp"
#endif
