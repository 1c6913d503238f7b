// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The size of an effect, as the data leave it: a distribution, of which `Existence` has the median and an interval.

#include <vector>

#include "vernier/least_squares/score_test.hpp"

namespace vernier::detail {

/// A gamma distribution by its moments.
struct Moments {
  double mean, variance;
  /// Probability of more than a value.
  VERNIER_API double tail(double value) const;
};

/// Estimates of an effect along directions in which they are independent.
struct EffectEstimates {
  VectorX estimates, variances;
  MatrixX displacement;  ///< mean squared displacement, a quadratic form [m^2]
  double rest = 0;       ///< squares of estimates along directions that are left out, over their variances
};

/// Squared sizes of an effect [m^2]: a mixture over shapes of its spectrum and over the variance of its coefficients.
/// All shapes are equally likely before the data, and so are all sizes. The variances of the estimates have a common
/// unknown factor. Its prior counts as thirty residuals, and many estimates tell it better.
/// @cite Gelman 2013 (scale of the noise, marginal likelihood)
class SizeOfEffect {
 public:
  /// @param score  of its unknowns
  /// @param shapes relative sizes that the unknowns may have beside equal ones, of those that are tested
  VERNIER_API SizeOfEffect(const ScoreTest& score, const std::vector<VectorX>& shapes);
  /// The value that is exceeded with a probability.
  VERNIER_API double exceeded_with(double probability) const;

 private:
  /// One size of the coefficients.
  struct Part {
    const EffectEstimates* effect;
    double tau;         ///< standard deviation of a coefficient, over that of the noise
    double squares;     ///< of estimates over their total variances, with those left out and those of the prior
    double log_weight;  ///< logarithm of its likelihood and prior
  };
  /// Adds the sizes of one shape.
  VERNIER_API void add(const EffectEstimates& effect, std::vector<Part>& out) const;
  /// Moments of the squared size, a quadratic form of normal numbers.
  VERNIER_API Moments moments_of(const Part& part) const;

  double freedom_ = 0;
  std::vector<Moments> parts_{};
  std::vector<double> weights_{};
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/size_of_effect.ipp"
#endif
