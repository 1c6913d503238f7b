// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "vernier/regression/detail/feature_ridge.hpp"
#include "vernier/regression/trigonometric_regression.hpp"

namespace vernier {

VERNIER_IMPL void TrigonometricRegression::validate() const {
  demand(max_degree >= 0, "TrigonometricRegression: max_degree is ", max_degree, ", must not be negative");
  demand(!ridge || (*ridge >= 1e-15 && *ridge < 1e15), "TrigonometricRegression: ridge is ", ridge.value_or(0),
         ", must lie in [1e-15, 1e15)");
  demand(growth >= 1e-3 && growth <= 1e3, "TrigonometricRegression: growth is ", growth, ", must lie in [1e-3, 1e3]");
}

VERNIER_IMPL detail::TrigonometricSum TrigonometricRegression::solve(const ConstMatrixRef& inputs,
                                                                     const ConstMatrixRef& targets,
                                                                     const VectorX* weights) const {
  const int n = static_cast<int>(inputs.cols());
  const Index count = detail::power_of_three(n);
  std::vector<Index> features;
  std::vector<double> roots;  // a feature is divided by the root of its growth, then all have one ridge
  for (Index f = 1; f < count; ++f)
    if (const int degree = detail::trigonometric_degree(f); degree <= max_degree) {
      features.push_back(f);
      roots.push_back(std::pow(growth, -0.5 * degree));
    }
  const VectorX scale = Eigen::Map<const VectorX>(roots.data(), static_cast<Index>(roots.size()));
  MatrixX z(inputs.rows(), scale.size());
  VectorX x(inputs.cols()), all(count);
  for (Index i = 0; i < z.rows() && z.cols() > 0; ++i) {
    for (Index j = 0; j < x.size(); ++j) x(j) = inputs(i, j);
    detail::trigonometric_features(x.data(), n, all.data());
    for (Index k = 0; k < z.cols(); ++k) z(i, k) = all(features[static_cast<std::size_t>(k)]) * scale(k);
  }

  const detail::FeatureRidge path(z, targets, weights);
  detail::FeatureRidgeFit found = ridge ? path.fit(*ridge * path.total_weight()) : path.best_fit();
  MatrixX coefficients = MatrixX::Zero(count, targets.cols());
  for (Index o = 0; o < coefficients.cols(); ++o) {
    coefficients(0, o) = found.offset(o);
    for (Index k = 0; k < scale.size(); ++k)
      coefficients(features[static_cast<std::size_t>(k)], o) = scale(k) * found.coefficients(k, o);
  }
  detail::TrigonometricSpread spread{.features = std::move(features),
                                     .scale = scale,
                                     .mean = path.mean_features(),
                                     .directions = std::move(found.directions),
                                     .gain = std::move(found.gain),
                                     .rest = found.rest,
                                     .mean_share = 1 / path.total_weight(),
                                     .noise = VERNIER_LATER(found.noise).cwiseSqrt()};
  return {n, coefficients, std::move(spread)};
}

}  // namespace vernier
