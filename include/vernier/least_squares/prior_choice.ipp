#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier {

namespace detail {

/// Standard error of the mean of some values.
VERNIER_LOCAL double standard_error(const VectorX& values) {
  const double n = static_cast<double>(values.size()), mean = values.mean();
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (std::max)(1.0, n * (n - 1)));
}

}  // namespace detail

VERNIER_IMPL std::size_t one_standard_error_rule(const std::vector<PriorTrial>& trials) {
  demand(!trials.empty(), "one_standard_error_rule: no trials");
  const auto best = std::min_element(trials.begin(), trials.end(), [](const PriorTrial& a, const PriorTrial& b) {
    return a.errors.mean() < b.errors.mean();
  });
  for (std::size_t k = trials.size(); k-- > 0;) {
    const VectorX excess = trials[k].errors - best->errors;
    if (excess.mean() <= detail::standard_error(excess)) return k;
  }
  return trials.size() - 1;  // errors that are not finite compare with nothing
}

namespace detail {

/// By how much the position errors of each pose are smaller [m].
VERNIER_LOCAL VectorX saved_errors(const LeftOutBlocks& with, const LeftOutBlocks& without) {
  return error_norms(without) - error_norms(with);
}

}  // namespace detail

VERNIER_IMPL bool errors_support(const LeftOutBlocks& with, const LeftOutBlocks& without) {
  const VectorX saved = detail::saved_errors(with, without);
  return saved.mean() > detail::standard_error(saved);
}

VERNIER_IMPL bool densities_support(const LeftOutBlocks& with, const LeftOutBlocks& without) {
  const VectorX gained = detail::means_of_poses(with.log_densities - without.log_densities, with.poses);
  return detail::saved_errors(with, without).mean() > 0 && gained.mean() > detail::standard_error(gained);
}

VERNIER_IMPL PriorChoice choose_prior(const BlockSystem& system, const NormalEquations& normal, VectorX precisions,
                                      const VectorX& steps, Index first, Index count, Index stride) {
  std::vector<PriorTrial> trials;
  for (const double precision : {0.3, 1.0, 3.0, 10.0, 100.0, 1e4, suppressing_precision}) {
    for (Index k = first; k < first + count; ++k) precisions(k) = precision;
    const FactorisedEquations solved(normal, precisions, steps);
    trials.push_back({precision, detail::error_norms(leave_one_out(system, solved, stride))});
  }
  double smallest = trials.front().errors.mean();
  for (const PriorTrial& trial : trials) smallest = (std::min)(smallest, trial.errors.mean());
  const PriorTrial& chosen = trials[one_standard_error_rule(trials)];
  return {chosen.precision, chosen.errors.mean(), smallest, trials.back().errors.mean()};
}

}  // namespace vernier
