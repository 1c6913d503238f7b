// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/detail/size_of_effect.hpp"
#include "vernier/error_model/existence.hpp"

namespace vernier {

namespace detail {

/// Probability that an effect is found.
/// @param size2 mean of its squared coefficients, in expected sizes
/// @param more  times the poses
VERNIER_LOCAL double power(const ScoreTest& score, double level, double size2, double more) {
  Moments none{0, 0}, effect{0, 0};
  for (const double information : score.information) {
    const double now = more * information, weight = now / (now + score_precision), moved = weight * now * size2;
    none.mean += weight * score.noise;
    none.variance += 2 * weight * weight * score.noise * score.noise;
    effect.mean += moved;
    effect.variance += 4 * weight * score.noise * moved;
  }
  double low = none.mean, high = none.mean + 100 * std::sqrt(none.variance);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (none.tail(middle) > level ? low : high) = middle;
  }
  return Moments{none.mean + effect.mean, none.variance + effect.variance}.tail(low);
}

}  // namespace detail

VERNIER_IMPL Existence existence(const ScoreTest& score, double level, double relevance, Index poses,
                                 const std::vector<VectorX>& shapes) {
  Existence out{.p = score.p, .relevance = relevance};
  for (const VectorX& shape : shapes)
    demand(shape.size() == score.directions.rows(), "existence: a shape of ", shape.size(), " unknowns, tested are ",
           score.directions.rows());
  const double moved2 = detail::diagonal_of(score.displacement).sum();  // by one expected size of all
  if (score.information.size() == 0 || !(moved2 > 0) || !std::isfinite(relevance)) return out;
  const detail::SizeOfEffect squares(score, shapes);
  const auto size_exceeded_with = [&](double probability) { return std::sqrt(squares.exceeded_with(probability)); };
  out.size = size_exceeded_with(0.5);
  const double size2 = relevance * relevance / moved2;
  constexpr double wanted = 0.8, most = 1e4;  // times the poses
  if (detail::power(score, level, size2, most) >= wanted) {
    double low = 1e-4, high = most;
    for (int i = 0; i < 60; ++i) {
      const double middle = std::sqrt(low * high);
      (detail::power(score, level, size2, middle) < wanted ? low : high) = middle;
    }
    out.poses = static_cast<Index>(std::ceil(high * static_cast<double>(poses)));
  }
  if (score.p <= level) {
    out.answer = Answer::found;
    out.interval = {size_exceeded_with(0.975), size_exceeded_with(0.025)};
    return out;
  }
  out.interval = {0, size_exceeded_with(0.05)};
  out.answer = out.interval[1] < relevance ? Answer::ruled_out : Answer::undecided;
  return out;
}

}  // namespace vernier
