// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/detail/kernel_ridge_path.hpp"
#include "vernier/regression/detail/kernel_system.hpp"
#include "vernier/regression/kernel_elm.hpp"

namespace vernier {

VERNIER_IMPL detail::FittedKernels KernelElm::solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                                    const FitOptions& options) const {
  demand(!length_scale || (*length_scale > 0 && std::isfinite(*length_scale)), "KernelElm: length_scale is ",
         length_scale.value_or(0), ", must be positive");
  demand(!lambda || (*lambda > 0 && std::isfinite(*lambda)), "KernelElm: lambda is ", lambda.value_or(0),
         ", must be positive");
  demand(max_search_samples >= 2, "KernelElm: max_search_samples is ", max_search_samples, ", must be at least 2");
  detail::KernelFeatures features(inputs, input_map, input_scaling);
  const VectorX weights = detail::weights_or_ones(options.weights, inputs.rows());
  const Choice chosen = choose(features.values, targets, weights, options);
  features.divide(VectorX::Constant(1, chosen.length_scale));
  if (!std::isfinite(chosen.lambda))
    return {Kernel::squared_exponential,
            input_map,
            features.scaling,
            features.values,
            MatrixX::Zero(targets.rows(), targets.cols()),
            detail::transposed_product(targets, weights) / weights.sum()};
  const VectorX inverse = VERNIER_LATER(weights).cwiseInverse();
  const detail::KernelSystem system(detail::kernel_matrix(Kernel::squared_exponential, features.values),
                                    chosen.lambda * inverse, targets);
  demand(system.solved, "KernelElm: lambda is ", chosen.lambda, ", too small for ", inputs.rows(),
         " samples at a length scale of ", chosen.length_scale);
  return {Kernel::squared_exponential, input_map, features.scaling, features.values, system.alpha, system.mean};
}

VERNIER_IMPL KernelElm::Choice KernelElm::choose(const MatrixX& features, const ConstMatrixRef& targets,
                                                 const VectorX& weights, const FitOptions& options) const {
  if (length_scale && lambda) return {*length_scale, *lambda, 0};
  const Index n = features.rows(), m = (std::min)(n, max_search_samples);
  if (n < 2) return {length_scale.value_or(1), lambda.value_or(std::numeric_limits<double>::infinity()), 0};
  std::vector<Index> rows = Rng(options.seed).permutation(n);
  rows.resize(static_cast<std::size_t>(m));
  if (m == n)  // in their own order
    for (Index i = 0; i < n; ++i) rows[static_cast<std::size_t>(i)] = i;
  const MatrixX x = detail::rows_of(features, rows), t = detail::rows_of(targets, rows);
  const VectorX w = detail::rows_of(weights, rows);

  const auto at = [&](double length) {
    const detail::KernelRidgePath path(detail::kernel_matrix(Kernel::squared_exponential, x / length), t, w);
    Choice best{length};
    const auto consider = [&](double candidate) {
      const double error = path.leave_one_out_error(candidate);
      if (error < best.error) best = {length, candidate, error};
    };
    if (lambda) {
      consider(*lambda);
    } else {
      consider(std::numeric_limits<double>::infinity());
      // below, coefficients grow so large that what is left of their sum has few digits
      for (int exponent = 4; exponent >= -16; --exponent) consider(std::pow(10.0, exponent / 2.0));
    }
    return best;
  };
  if (length_scale) return at(*length_scale);

  // Octaves around the typical distance of two samples, then half octaves beside the best.
  const MatrixX centred = detail::rows_minus(x, detail::column_means(x));
  double typical = std::sqrt(2 * centred.squaredNorm() / static_cast<double>(m));
  if (!(typical > 0)) typical = 1;
  Choice best;
  const auto try_all = [&](const std::vector<double>& lengths) {
    std::vector<Choice> found(lengths.size());
    options.executor.for_ranges(static_cast<Index>(lengths.size()), [&](Index begin, Index end) {
      for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) found[k] = at(lengths[k]);
    });
    for (const Choice& choice : found)
      if (choice.error < best.error) best = choice;
  };
  std::vector<double> octaves;
  for (int power = 3; power >= -4; --power) octaves.push_back(std::ldexp(typical, power));
  try_all(octaves);
  try_all({best.length_scale * std::sqrt(2.0), best.length_scale / std::sqrt(2.0)});
  return best;
}

}  // namespace vernier
