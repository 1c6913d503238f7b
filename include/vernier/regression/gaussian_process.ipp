// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/detail/bounded_bfgs.hpp"
#include "vernier/regression/detail/marginal_likelihood.hpp"
#include "vernier/regression/gaussian_process.hpp"

namespace vernier {

VERNIER_IMPL void GaussianProcess::validate(Index dimension) const {
  demand(input_map != InputMap::sine_cosine_products,
         "GaussianProcess: products of sines and cosines have no length scale of one input");
  demand(length_scales.size() == 0 || length_scales.size() == dimension, "GaussianProcess: ", length_scales.size(),
         " length scales for ", dimension, " inputs");
  demand(
      length_scales.size() == 0 || (detail::all_finite(length_scales) && VERNIER_LATER(length_scales).minCoeff() > 0),
      "GaussianProcess: the length scales must be positive");
  demand(!noise_ratio || (*noise_ratio > 0 && std::isfinite(*noise_ratio)), "GaussianProcess: noise_ratio is ",
         noise_ratio.value_or(0), ", must be positive");
  demand(starts >= 1 && iterations >= 1, "GaussianProcess: starts is ", starts, ", iterations is ", iterations,
         ", both must be at least 1");
  demand(max_hyper_samples >= 2, "GaussianProcess: max_hyper_samples is ", max_hyper_samples, ", must be at least 2");
}

VERNIER_IMPL detail::FittedProcess GaussianProcess::solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                                          const FitOptions& options) const {
  const int dimension = static_cast<int>(inputs.cols());
  validate(dimension);
  detail::KernelFeatures features(inputs, input_map, input_scaling);
  const VectorX weights = detail::weights_or_ones(options.weights, inputs.rows());
  const VectorX found = logarithms(features.values, dimension, targets, weights, options);
  const double ratio = std::exp(found(dimension));
  VectorX scales = VERNIER_LATER(found).head(dimension);
  detail::exponentiate(scales);
  features.divide(scales);
  const VectorX inverse = VERNIER_LATER(weights).cwiseInverse();
  const detail::KernelSystem system(detail::kernel_matrix(kernel, features.values), ratio * inverse, targets);
  demand(system.solved, "GaussianProcess: noise_ratio is ", ratio, ", too small for ", inputs.rows(), " samples");
  VectorX variance = detail::varying_outputs(targets);
  for (Index o = 0; o < variance.size(); ++o) variance(o) *= (std::max)(system.square(o), 0.0) / weights.sum();
  return {{kernel, input_map, features.scaling, features.values, system.alpha, system.mean},
          detail::ProcessSpread(system, variance, ratio)};
}

VERNIER_IMPL VectorX GaussianProcess::logarithms(const MatrixX& features, int dimension, const ConstMatrixRef& targets,
                                                 const VectorX& weights, const FitOptions& options) const {
  const double tenfold = std::log(10.0);
  const Index n = features.rows();
  const VectorX squares = detail::squared_column_norms(detail::rows_minus(features, detail::column_means(features)));
  VectorX start(dimension + 1), lower(dimension + 1), upper(dimension + 1);
  for (int j = 0; j < dimension; ++j) {
    double square = 0;  // of an input's spread
    for (Index k = j; k < features.cols(); k += dimension) square += squares(k) / static_cast<double>(n);
    if (!(square > 0)) square = 1;
    start(j) = 0.5 * std::log(2.0 * dimension * square);  // two samples are typically one length scale apart
    lower(j) = 0.5 * std::log(square) - 1.5 * tenfold;
    upper(j) = 0.5 * std::log(square) + 2 * tenfold;
  }
  start(dimension) = -2 * tenfold;
  lower(dimension) = -8 * tenfold;
  upper(dimension) = 3 * tenfold;
  if (length_scales.size() > 0) {
    for (int j = 0; j < dimension; ++j) lower(j) = upper(j) = start(j) = std::log(length_scales(j));
  }
  if (noise_ratio) lower(dimension) = upper(dimension) = start(dimension) = std::log(*noise_ratio);
  if (length_scales.size() > 0 && noise_ratio) return start;

  Rng rng(options.seed);
  std::vector<Index> rows(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) rows[static_cast<std::size_t>(i)] = i;
  if (n > max_hyper_samples) {
    rows = rng.permutation(n);
    rows.resize(static_cast<std::size_t>(max_hyper_samples));
  }
  const detail::MarginalLikelihood likelihood(kernel, detail::rows_of(features, rows), dimension,
                                              detail::rows_of(targets, rows), detail::rows_of(weights, rows));
  std::vector<detail::BoundedMinimum> found(static_cast<std::size_t>(starts));
  for (std::size_t k = 0; k < found.size(); ++k) {
    found[k].x = start;
    if (k == 0) continue;
    for (int j = 0; j < dimension; ++j) found[k].x(j) += rng.uniform(-0.7, 0.7) * tenfold;
    found[k].x(dimension) = rng.uniform(-6, 0) * tenfold;
  }
  options.executor.for_ranges(starts, [&](Index begin, Index end) {
    for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
      found[k] = detail::minimise_within(likelihood, found[k].x, lower, upper, iterations, 1e-7);
  });
  std::size_t best = 0;
  for (std::size_t k = 1; k < found.size(); ++k)
    if (found[k].value < found[best].value) best = k;
  return found[best].x;
}

}  // namespace vernier
