// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/detail/size_of_effect.hpp"
#include "vernier/evaluation/chi_square.hpp"

namespace vernier::detail {

VERNIER_IMPL double Moments::tail(double value) const {
  if (!(mean > 0)) return 0;
  if (!(value > 0)) return 1;
  if (!(variance > 0)) return value < mean ? 1 : 0;
  return chi_square_tail(2 * value * mean / variance, 2 * mean * mean / variance);
}

/// The prior of the noise's scale counts as so many residuals.
inline constexpr double known_residuals = 30;

/// Directions of unknowns that are expected to have other sizes.
/// @param sizes of the tested unknowns, relative
VERNIER_LOCAL EffectEstimates reshaped(const ScoreTest& score, const VectorX& sizes) {
  const MatrixX in_units = rows_scaled(sizes, score.directions);
  const VectorX information = VERNIER_LATER(score.variances).cwiseInverse();
  const MatrixX weighted = columns_scaled(in_units, information);
  const SymmetricEigen turned = symmetric_eigen(matrix_product(weighted, MatrixX(in_units.transpose())));
  const Index m = turned.values.size();
  std::vector<Index> kept;
  for (Index k = turned.converged ? m : 0; k-- > 0 && turned.values(k) > 1e-9 * turned.values(m - 1);)
    kept.push_back(k);
  const MatrixX vectors = columns_of(turned.vectors, kept);
  EffectEstimates out{transposed_product(vectors, product(weighted, score.estimates)), VectorX(kept.size()), {}};
  out.rest = weighted_square(information, score.estimates);
  for (Index k = 0; k < out.variances.size(); ++k) {
    const double of_data = turned.values(kept[static_cast<std::size_t>(k)]);
    out.variances(k) = 1 / of_data;
    out.rest = (std::max)(0.0, out.rest - out.estimates(k) * out.estimates(k) / of_data);
    out.estimates(k) /= of_data;
  }
  const MatrixX back = transposed_matrix_product(in_units, vectors);
  out.displacement = transposed_matrix_product(back, matrix_product(score.displacement, back));
  return out;
}

VERNIER_IMPL SizeOfEffect::SizeOfEffect(const ScoreTest& score, const std::vector<VectorX>& shapes) {
  std::vector<EffectEstimates> effects{{score.estimates, score.variances, score.displacement}};
  for (const VectorX& shape : shapes) effects.push_back(reshaped(score, shape));
  freedom_ = known_residuals + static_cast<double>(score.estimates.size());
  std::vector<Part> all;
  for (const EffectEstimates& effect : effects) add(effect, all);
  double highest = -1e300, sum = 0;
  for (const Part& part : all) highest = (std::max)(highest, part.log_weight);
  constexpr double negligible = -15;
  for (const Part& part : all) {
    if (!(part.log_weight - highest >= negligible)) continue;
    parts_.push_back(moments_of(part));
    weights_.push_back(std::exp(part.log_weight - highest));
    sum += weights_.back();
  }
  for (double& weight : weights_) weight /= sum;
}

VERNIER_IMPL double SizeOfEffect::exceeded_with(double probability) const {
  double low = 0, high = 0;
  for (const Moments& part : parts_) high = (std::max)(high, part.mean + 20 * std::sqrt(part.variance));
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    double tail = 0;
    for (std::size_t k = 0; k < parts_.size(); ++k) tail += weights_[k] * parts_[k].tail(middle);
    (tail > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

VERNIER_IMPL void SizeOfEffect::add(const EffectEstimates& effect, std::vector<Part>& out) const {
  const Index m = effect.estimates.size();
  double largest = 0, least = (std::numeric_limits<double>::max)();  // that the estimates suggest
  for (Index k = 0; k < m; ++k) {
    const double std = std::sqrt(effect.variances(k));
    largest = (std::max)(largest, std::abs(effect.estimates(k)) + 3 * std);
    least = (std::min)(least, 1e-2 * std);  // a direction that nothing determines suggests nothing
  }
  constexpr int grid = 120;
  const double step = std::pow((std::max)(largest / least, 10.0), 1.0 / grid);
  const double size = std::sqrt(diagonal_of(effect.displacement).sum()) * std::log(step);
  double tau = least;
  for (int i = 0; i <= grid; ++i, tau *= step) {
    double squares = known_residuals + effect.rest, log_weight = std::log(tau * size);  // the grid is logarithmic
    for (Index k = 0; k < m; ++k) {
      const double total = tau * tau + effect.variances(k);
      log_weight -= 0.5 * std::log(total / effect.variances(k));
      squares += effect.estimates(k) * effect.estimates(k) / total;
    }
    out.push_back({&effect, tau, squares, log_weight - 0.5 * freedom_ * std::log(squares)});
  }
}

VERNIER_IMPL Moments SizeOfEffect::moments_of(const Part& part) const {
  const MatrixX& form = part.effect->displacement;
  const double noise = part.squares / (freedom_ - 2);
  const VectorX& of_data = part.effect->variances;
  const Index m = of_data.size();
  VectorX mean(m), variance(m);  // of each direction
  for (Index k = 0; k < m; ++k) {
    const double share = part.tau * part.tau / (part.tau * part.tau + of_data(k));
    mean(k) = share * part.effect->estimates(k);
    variance(k) = noise * share * of_data(k);
  }
  const VectorX image = product(form, mean);
  const double of_variance = diagonal_of(form).dot(variance);
  Moments out{image.dot(mean) + of_variance,
              4 * weighted_square(variance, image) + 2 * of_variance * of_variance / (freedom_ - 4)};
  const double spread = 2 * (freedom_ - 2) / (freedom_ - 4);  // 2, but for the factor
  for (Index j = 0; j < m; ++j)
    for (Index i = 0; i < m; ++i) out.variance += spread * form(i, j) * form(i, j) * variance(i) * variance(j);
  return out;
}

}  // namespace vernier::detail
