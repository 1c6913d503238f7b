// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vernier/error_model/detail/session_columns.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

VERNIER_IMPL SessionColumns::SessionColumns(const ModelSelection& model)
    : model_(model),
      dense_(model.linearised().system.dense),
      added_(0),
      size_(model.linearised().system.local_size),
      phase_(VectorX::Zero(model.problem.num_blocks())) {
  const CalibrationProblem& problem = model.problem;
  std::vector<Index> number;  // of each set
  Index sets = 0;
  for (std::size_t s = 0; s < problem.drift.size(); ++s) {
    const std::size_t first = problem.place_of(s);
    number.push_back(problem.drift[s].empty() ? -1 : first != s ? number[first] : sets++);
  }
  added_ = sets * size_ * half_periods;
  for (Index b = 0; b < problem.num_blocks(); ++b) {
    const auto s = static_cast<std::size_t>(problem.station_index(b));
    set_.push_back(number[s]);
    if (number[s] < 0) continue;
    const SessionDrift& drift = problem.drift[s];
    const double length = drift.spacing * static_cast<double>(drift.knots.cols() - 1);
    phase_(b) = (problem.set_of(b).times(problem.row_of(b)) - drift.begin) / length;
  }
}

VERNIER_IMPL void SessionColumns::operator()(Index first, Index count, RowBlock* out) const {
  model_.linearised().system.rows(first, count, out);
  for (Index i = 0; i < count; ++i) {
    RowBlock& rows = out[i];
    const auto b = static_cast<std::size_t>(first + i);
    Rows6 dense(6, dense_ + added_), knots(6, size_);
    std::fill_n(dense.data(), dense.size(), 0.0);
    std::fill_n(knots.data(), knots.size(), 0.0);
    std::copy_n(rows.dense.data(), rows.dense.size(), dense.data());
    for (RowBlock::Local& part : rows.local) {
      for (Index k = 0; part.state >= 0 && k < knots.size(); ++k)  // their shares add up to one
        knots.data()[k] += part.columns.data()[k];
      part = {};
    }
    for (Index k = 0; k < half_periods && set_[b] >= 0; ++k) {
      const auto order = static_cast<double>(k + 1);
      const Index at = dense_ + (set_[b] * half_periods + k) * size_;
      const double slow = std::cos(order * std::numbers::pi * phase_(first + i)) / order;
      for (Index c = 0; c < knots.size(); ++c) dense.data()[6 * at + c] = slow * knots.data()[c];
    }
    rows.dense = std::move(dense);
  }
}

VERNIER_IMPL ScoreTest SessionColumns::beside_drift(const UnknownGroup& group) const {
  UnknownGroup moved;
  for (const Index unknown : group) moved.push_back(place(unknown));
  return test(moved, size_);
}

VERNIER_IMPL ScoreTest SessionColumns::of_drift(Index first, Index end) const {
  UnknownGroup group;
  for (Index k = 0; k < added_; ++k)
    if (k % size_ >= first && k % size_ < end) group.push_back(dense_ + k);
  return test(group, end);
}

/// @param components of knots that there are; the others are held at zero
VERNIER_IMPL ScoreTest SessionColumns::test(const UnknownGroup& group, Index components) const {
  const ModelSelection::Linearised& at = model_.linearised();
  BlockSystem system = at.system;
  system.dense += added_;
  system.rows = *this;
  system.local_states = system.local_size = 0;
  const VectorX precisions = model_.problem.arm.precisions();
  VectorX all_precisions = VectorX::Ones(precisions.size() + added_), steps = VectorX::Zero(all_precisions.size());
  for (Index k = 0; k < precisions.size(); ++k) {
    all_precisions(place(k)) = precisions(k);
    steps(place(k)) = at.steps(k);
  }
  for (Index k = 0; k < added_; ++k)
    if (k % size_ >= components) all_precisions(dense_ + k) = suppressing_precision;
  const NormalEquations normal(system, {}, model_.problem.executor, model_.of_same_functions());
  return score_test(system, normal, all_precisions, steps, group, model_.clusters());
}

}  // namespace vernier::detail
