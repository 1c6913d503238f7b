// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "vernier/error_model/detail/left_out_sessions.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"

namespace vernier::detail {

/// Mean position error of some blocks, predicted from the others [m].
VERNIER_LOCAL double error_without(const ModelSelection& model, const VectorX& precisions,
                                   const std::vector<Index>& left_out) {
  const ModelSelection::Linearised& at = model.linearised();
  std::vector<bool> left(static_cast<std::size_t>(at.system.blocks), false);
  for (const Index b : left_out) left[static_cast<std::size_t>(b)] = true;
  std::vector<Index> kept;
  for (Index b = 0; b < at.system.blocks; ++b)
    if (!left[static_cast<std::size_t>(b)]) kept.push_back(b);
  const auto rows_of_kept = [&](Index first, Index count, RowBlock* out) {
    for (Index k = 0; k < count; ++k) at.system.rows(kept[static_cast<std::size_t>(first + k)], 1, out + k);
  };
  BlockSystem system = at.system;
  system.blocks = system.validation_blocks = static_cast<Index>(kept.size());
  system.rows = rows_of_kept;
  system.poses.clear();
  const NormalEquations normal(system, {}, model.problem.executor);
  const FactorisedEquations solved(normal, precisions, at.steps);
  if (!solved.usable()) return std::numeric_limits<double>::infinity();
  RowBlock rows;
  Rows6 all(6, system.unknowns());
  double sum = 0;
  for (const Index b : left_out) {
    at.system.rows(b, 1, &rows);
    rows.expand(system.group_sizes, all);
    Vector6 residual = rows.residual;
    add_columns(all, solved.step().data(), 1, residual.data());
    const Vector6 error = rows.unwhiten * residual;
    sum += rows.position_sigma * Vector3(error(0), error(1), error(2)).norm();
  }
  return sum / static_cast<double>(left_out.size());
}

VERNIER_IMPL VectorX errors_of_left_out_sessions(const ModelSelection& model, const VectorX& precisions) {
  const CalibrationProblem& problem = model.problem;
  std::vector<std::vector<Index>> sessions(problem.sets().size());
  for (Index b = 0; b < problem.num_blocks(); ++b)
    if (problem.set_of(b).locates())
      sessions[problem.place_of(static_cast<std::size_t>(problem.station_index(b)))].push_back(b);
  std::erase_if(sessions, [](const std::vector<Index>& blocks) { return blocks.empty(); });
  constexpr std::size_t registering = 15, fewest = 2 * registering;
  for (const std::vector<Index>& blocks : sessions)
    if (sessions.size() < 2 || blocks.size() < fewest) return {};
  VectorX out(static_cast<Index>(sessions.size()));
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    std::vector<Index> left_out;
    const std::size_t step = sessions[s].size() / registering;
    for (std::size_t k = 0; k < sessions[s].size(); ++k)
      if (k % step != 0) left_out.push_back(sessions[s][k]);
    out(static_cast<Index>(s)) = error_without(model, precisions, left_out);
  }
  return out;
}

}  // namespace vernier::detail
