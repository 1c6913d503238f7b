#pragma once

/// @file
/// Linear regression on all products of sines and cosines of different inputs: what the position of an arm with
/// revolute joints is made of.

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "vernier/regression/concepts.hpp"
#include "vernier/regression/feature_ridge.hpp"
#include "vernier/regression/trigonometric_predictor.hpp"

namespace vernier {

/// Linear least squares on the 3^N products of one of (1, sin q_j, cos q_j) of every input q_j. The position of a chain
/// of revolute joints is exactly linear in them, and so is what errors of its geometry do to it. The ridge of a feature
/// grows with its degree, the number of angles in it: with few samples, what one or two joints explain is not left to
/// six. The mean has none. Inputs are angles [rad].
/// @complexity with f features and k = min(n, f): n f k + 9 k^3; six inputs and 5,000 samples take seconds, seven with
/// all features minutes
/// @cite Hoerl and Kennard 1970; Allen 1974
struct TrigonometricRegression {
  /// Features of at most so many angles, at least 0; all by default.
  int max_degree = std::numeric_limits<int>::max();
  /// Of the coefficient of a feature of one angle, per sample, divided by `growth`; at least 1e-15. By default chosen
  /// by the closed-form leave-one-out error, the mean alone being a candidate.
  std::optional<double> ridge = std::nullopt;
  double growth = 2;  ///< a feature of d angles has the ridge `ridge growth^d`; in [1e-3, 1e3]

  /// Samples of weight q count as q samples. Neither seed nor executor matter.
  /// @param inputs  n x inputs, angles [rad]
  /// @param targets n x outputs
  /// @param options weights
  template <class X, class Y>
  TrigonometricPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                                         const Eigen::MatrixBase<Y>& targets,
                                                                         const FitOptions& options = {}) const {
    constexpr int n_inputs = X::ColsAtCompileTime, n_outputs = Y::ColsAtCompileTime;
    using Predictor = TrigonometricPredictor<n_inputs, n_outputs>;
    require(max_degree >= 0, "TrigonometricRegression: max_degree is ", max_degree, ", must not be negative");
    require(!ridge || (*ridge >= 1e-15 && *ridge < 1e15), "TrigonometricRegression: ridge is ", ridge.value_or(0),
            ", must lie in [1e-15, 1e15)");
    require(growth >= 1e-3 && growth <= 1e3, "TrigonometricRegression: growth is ", growth,
            ", must lie in [1e-3, 1e3]");
    detail::require_samples("TrigonometricRegression", inputs, targets, options);

    std::vector<Index> features;
    std::vector<double> roots;  // a feature is divided by the root of its growth, then all have one ridge
    for (Index f = 1; f < Predictor::features; ++f)
      if (const int degree = detail::trigonometric_degree(f); degree <= max_degree) {
        features.push_back(f);
        roots.push_back(std::pow(growth, -0.5 * degree));
      }
    const VectorX scale = Eigen::Map<const VectorX>(roots.data(), static_cast<Index>(roots.size()));
    MatrixX z(inputs.rows(), scale.size());
    VectorX all(Predictor::features);
    for (Index i = 0; i < z.rows() && z.cols() > 0; ++i) {
      detail::trigonometric_features<n_inputs>(typename Predictor::Input(inputs.row(i).transpose()), all.data());
      z.row(i) = all(features).cwiseProduct(scale).transpose();
    }

    const detail::FeatureRidge path(z, targets, options.weights);
    detail::FeatureRidgeFit found = ridge ? path.fit(*ridge * path.total_weight()) : path.best_fit();
    typename Predictor::Coefficients coefficients = Predictor::Coefficients::Zero(Predictor::features, n_outputs);
    coefficients.row(0) = found.offset.transpose();
    coefficients(features, Eigen::all) = scale.asDiagonal() * found.coefficients;
    detail::TrigonometricSpread spread{.features = std::move(features),
                                       .scale = scale,
                                       .mean = path.mean_features().transpose(),
                                       .directions = std::move(found.directions),
                                       .gain = std::move(found.gain),
                                       .rest = found.rest,
                                       .mean_share = 1 / path.total_weight(),
                                       .noise = found.noise.cwiseSqrt()};
    return {std::move(coefficients), std::move(spread)};
  }
};

}  // namespace vernier
