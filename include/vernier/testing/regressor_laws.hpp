// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The laws of `Regressor`, as a list of violations.

#include <cstdint>
#include <string>
#include <vector>

#include "vernier/testing/any_regressor.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::testing {

/// Effect of `FitOptions::weights` on a recipe.
enum class SampleWeights {
  refused,  ///< weights throw `std::invalid_argument`
  taken,    ///< they have an effect unless all are one; unusable ones throw
  counted,  ///< and integer weights equal repeated samples
};

/// Claims of a recipe beside the concept, and tolerances.
struct RegressorLaws {
  bool uses_seed = true;               ///< another seed gives another predictor; otherwise the same one
  Index samples = 60;                  ///< rows a fit gets, at least 2
  std::uint64_t seed = 7;              ///< of the samples and the fits
  double derivative_tolerance = 1e-6;  ///< of the derivative against differences, relative to its largest entry
  SampleWeights weights = SampleWeights::refused;  ///< effect of weights
  double weight_tolerance = 1e-9;  ///< of predictions where weights should make no difference, relative to the largest
};

namespace detail {

/// Checks a recipe for one pair of numbers of inputs and outputs; adds a sentence for each violation.
VERNIER_API void check_regressor(const AnyRecipe& recipe, const RegressorLaws& laws,
                                 std::vector<std::string>& violations);

}  // namespace detail

/// Runs a recipe through the laws of `Regressor`, on seeded samples of three inputs and two outputs and of one each:
///
/// - the same seed gives the same bits, whatever was fitted before and whichever executor computes (this thread, 1 or 2
/// threads);
///   another seed gives another predictor, where the recipe uses it;
/// - `fit` leaves its samples unchanged, and the predictor does not refer to them;
/// - `predict(rows)` equals `predict(sample)` row by row, whatever the order of the calls;
/// - `derivative` equals central differences;
/// - `standard_deviation`, where there is one, is finite and not negative, and a copy's the same;
/// - numbers of rows that differ throw `std::invalid_argument`;
/// - weights are refused, or matter as claimed (`SampleWeights`); unusable ones throw `std::invalid_argument`.
/// @return one sentence a violation; empty when all laws hold
template <Regressor R>
std::vector<std::string> regressor_violations(const R& recipe, const RegressorLaws& laws = {}) {
  demand(laws.samples >= 2, "regressor_violations: samples is ", laws.samples, ", must be at least 2");
  std::vector<std::string> violations;
  detail::check_regressor(detail::RecipeOf<R, 3, 2>(recipe), laws, violations);
  detail::check_regressor(detail::RecipeOf<R, 1, 1>(recipe), laws, violations);
  return violations;
}

}  // namespace vernier::testing

#if VERNIER_HEADER_ONLY
#include "vernier/testing/regressor_laws.ipp"
#endif
