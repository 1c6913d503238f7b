// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/existence.hpp"
#include "vernier/evaluation/chi_square.hpp"

namespace vernier {

namespace detail {

/// A gamma distribution by its moments.
struct Moments {
  double mean, variance;
  /// Probability of more than a value.
  VERNIER_LOCAL double tail(double value) const {
    if (!(mean > 0)) return 0;
    if (!(value > 0)) return 1;
    if (!(variance > 0)) return value < mean ? 1 : 0;
    return chi_square_tail(2 * value * mean / variance, 2 * mean * mean / variance);
  }
};

/// Squared sizes of an effect [m^2], as the data leave them: a mixture over the variance of its coefficients, whose
/// root has a uniform prior.
class SizeOfEffect {
 public:
  VERNIER_LOCAL explicit SizeOfEffect(const ScoreTest& score) {
    const Index m = score.information.size();
    double largest = 0;  // that the estimates suggest
    for (Index k = 0; k < m; ++k)
      largest = (std::max)(largest, std::abs(score.estimates(k)) + 3 * std::sqrt(score.noise / score.information(k)));
    // from a hundredth of the least that can be seen; a direction that nothing determines suggests nothing
    const double least = 1e-2 * std::sqrt(score.noise / score.information(0));
    constexpr int grid = 120;
    const double step = std::pow((std::max)(largest / least, 10.0), 1.0 / grid);
    double highest = -1e300;
    std::vector<double> logs;
    double tau = least;
    for (int i = 0; i <= grid; ++i, tau *= step) {
      double log_likelihood = std::log(tau);  // the grid is logarithmic
      VectorX at(m), spread(m);               // of each direction: mean and variance
      for (Index k = 0; k < m; ++k) {
        const double of_data = score.noise / score.information(k), total = tau * tau + of_data;
        log_likelihood -= 0.5 * (std::log(total / of_data) + score.estimates(k) * score.estimates(k) / total);
        at(k) = tau * tau / total * score.estimates(k);
        spread(k) = tau * tau / total * of_data;
      }
      parts_.push_back(moments_of(score.displacement, at, spread));
      logs.push_back(log_likelihood);
      highest = (std::max)(highest, log_likelihood);
    }
    double sum = 0;
    for (const double value : logs) {
      weights_.push_back(std::exp(value - highest));
      sum += weights_.back();
    }
    for (double& weight : weights_) weight /= sum;
  }

  /// Moments of a quadratic form of independent normal numbers.
  VERNIER_LOCAL static Moments moments_of(const MatrixX& form, const VectorX& mean, const VectorX& variance) {
    const VectorX image = product(form, mean);
    Moments out{image.dot(mean) + diagonal_of(form).dot(variance), 4 * weighted_square(variance, image)};
    for (Index j = 0; j < form.cols(); ++j)
      for (Index i = 0; i < form.rows(); ++i) out.variance += 2 * form(i, j) * form(i, j) * variance(i) * variance(j);
    return out;
  }

  /// The value that is exceeded with a probability.
  VERNIER_LOCAL double exceeded_with(double probability) const {
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

 private:
  std::vector<Moments> parts_{};
  std::vector<double> weights_{};
};

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

VERNIER_IMPL Existence existence(const ScoreTest& score, double level, double relevance, Index poses) {
  Existence out{.p = score.p, .relevance = relevance};
  const double moved2 = detail::diagonal_of(score.displacement).sum();  // by one expected size of all
  if (score.information.size() == 0 || !(moved2 > 0) || !std::isfinite(relevance)) return out;
  const detail::SizeOfEffect squares(score);
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
