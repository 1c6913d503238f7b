// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "vernier/error_model/detail/left_out_sessions.hpp"
#include "vernier/error_model/detail/session_columns.hpp"
#include "vernier/error_model/detail/temperature_selection.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

/// Share of the variance of the temperature that the time within sessions explains, 20 bins of time each: the rest
/// varies at one time, or from session to session.
VERNIER_LOCAL double explained_by_time(const CalibrationProblem& problem) {
  double otherwise = 0, all = 0;
  const double mean = problem.temperatures().mean;
  for (const MeasuredSet& set : problem.sets()) {
    if (!set.locates() || set.times.size() == 0) continue;
    const double begin = set.times.minCoeff(), length = set.times.maxCoeff() - begin;
    constexpr int bins = 20;
    std::array<double, bins> sums{}, squares{}, counts{};
    double sum = 0;
    for (Index i = 0; i < set.size(); ++i) {
      const double at = length > 0 ? (set.times(i) - begin) / length : 0, celsius = set.temperatures(i) - mean;
      const auto bin = static_cast<std::size_t>(std::clamp(static_cast<int>(bins * at), 0, bins - 1));
      sum += celsius;
      sums[bin] += celsius;
      squares[bin] += celsius * celsius;
      counts[bin] += 1;
      all += celsius * celsius;
    }
    otherwise += sum * sum / static_cast<double>(set.size());
    for (std::size_t k = 0; k < bins; ++k)
      if (counts[k] > 1) otherwise += (squares[k] - sums[k] * sums[k] / counts[k]) * counts[k] / (counts[k] - 1);
  }
  return all > 0 ? 1 - otherwise / all : 0;
}

/// Whether a parameter is a length, not an angle.
VERNIER_LOCAL bool is_length(Index parameter, int joints) {
  const Index end = ArmParameters::chain_end(joints);
  if (parameter < ArmParameters::chain_begin) return parameter < 3;
  if (parameter >= end) return parameter < end + 3;
  const auto in_row = static_cast<DhParameter>((parameter - ArmParameters::chain_begin) % 5);
  return in_row == DhParameter::a || in_row == DhParameter::d;
}

VERNIER_IMPL bool add_temperature(ModelSelection& model, double expansion) {
  CalibrationProblem& problem = model.problem;
  const auto [mean, std, range] = problem.temperatures();
  if (!(std > 0.02)) return false;  // not measured, or it did not vary
  constexpr double follows = 0.9;
  const bool timed = std::any_of(problem.sets().begin(), problem.sets().end(), [](const MeasuredSet& set) {
    return set.locates() && set.times.size() > 0 && set.times.maxCoeff() > set.times.minCoeff();
  });
  if (timed && explained_by_time(problem) > follows) {
    const double error = model.left_out_errors().mean();
    model.blocks.push_back({Block::temperature, error, error, false, suppressing_precision});
    return false;
  }
  const ArmParameterisation before = problem.arm;
  std::vector<GeometricUnknown> unknowns = before.geometric();
  UnknownGroup added;
  for (const GeometricUnknown& u : before.geometric()) {
    const double value = before.geometry((std::max)(0, u.station)).parameters()(u.parameter);
    constexpr double shortest = 0.3;  // a link of no length has bearings and a housing [m]
    const double size = is_length(u.parameter, before.geometry(0).joints()) ? (std::max)(shortest, std::abs(value)) : 1;
    added.push_back(static_cast<Index>(unknowns.size()));
    unknowns.push_back({u.parameter, u.station, expansion * size, 1, true, u.shared_with});
  }
  problem.reference_temperature = mean;
  problem.arm.set_geometric(std::move(unknowns));
  std::optional<ScoreTest> score;
  if (timed) {
    problem.start_drift(40);
    problem.drift_precision = 1;
    model.extended();
    score = SessionColumns(model).beside_drift(added);
    problem.stop_drift();
  }
  model.extended();
  bool used = model.choose_by_evidence(Block::temperature, added, score);
  if (used) {
    const VectorX with = problem.arm.precisions();
    VectorX without = with;
    for (const Index k : added) without(k) = suppressing_precision;
    const VectorX errors = errors_of_left_out_sessions(model, with),
                  others = errors_of_left_out_sessions(model, without);
    for (Index s = 0; s < errors.size(); ++s) used = used && errors(s) <= others(s);
  }
  if (used) {
    model.steps(1);
    return true;
  }
  model.blocks.back().used = false;
  model.blocks.back().precision = suppressing_precision;
  problem.arm = before;
  model.extended();
  return false;
}

}  // namespace vernier::detail
