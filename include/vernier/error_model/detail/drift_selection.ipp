// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "vernier/core/same_value.hpp"
#include "vernier/error_model/detail/drift_selection.hpp"
#include "vernier/error_model/detail/session_columns.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::detail {

/// Chooses the precisions of random walks, of unknowns first .. end - 1 of each state: their factor by evidence, in
/// steps of four from 1 down to `lowest` or up to 64, and whether there is such a drift.
VERNIER_LOCAL BlockChoice choose_drift(const ModelSelection& model, Block block, Index first, Index end,
                                       double lowest) {
  const ScoreTest score = SessionColumns(model).of_drift(first, end);
  ModelSelection::Linearised at = model.linearised();  // the precisions of the random walks are all that changes
  SparseSymmetric& prior = at.normal.local_prior;
  const std::vector<double> expected = prior.values;
  const VectorX precisions = model.problem.arm.precisions();
  const auto scale = [&](double factor) {
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const Index unknown = prior.rows[k] % at.system.local_size;
      prior.values[k] = expected[k] * (unknown >= first && unknown < end ? factor : 1);
    }
  };
  const auto solve = [&](double factor) {
    scale(factor);
    return FactorisedEquations(at.normal, precisions, at.steps, at.local_steps);
  };
  const auto evidence = [&](const FactorisedEquations& solved) {  // as the prior was scaled last
    return log_evidence(at.normal, solved, precisions, at.steps, model.problem.measured_values(), at.local_steps);
  };
  FactorisedEquations with = solve(1);
  double best = 1, most = evidence(with);
  for (const double step : {4.0, 0.25})
    for (double factor = step; same_value(best, factor / step) && factor >= lowest && factor <= 64; factor *= step) {
      FactorisedEquations now = solve(factor);
      const double reached = evidence(now);
      if (!(reached > most)) break;
      with = std::move(now);
      most = reached;
      best = factor;
    }
  const VectorX errors = error_norms(model.left_out(at, with));
  const VectorX without = error_norms(model.left_out(at, solve(suppressing_precision)));
  return model.choice_between(block, score, errors, without, best);
}

/// Lets the joints' zeros drift beside the bases, if they do.
VERNIER_LOCAL void add_joint_drift(ModelSelection& model) {
  CalibrationProblem& problem = model.problem;
  problem.start_joint_drift();
  problem.joint_drift_precision = 1;
  model.extended();
  const BlockChoice choice = choose_drift(model, Block::joint_drift, 6, 6 + problem.arm.geometry(0).joints(), 0.25);
  model.blocks.push_back(choice);
  problem.joint_drift_precision = choice.precision;
  if (choice.used) {
    model.steps(1);
  } else {
    problem.stop_joint_drift();
    model.extended();
  }
}

VERNIER_IMPL bool add_drift(ModelSelection& model) {
  CalibrationProblem& problem = model.problem;
  problem.start_drift(40);
  problem.drift_precision = 1;
  if (problem.system().local_states == 0) {
    problem.stop_drift();
    return false;
  }
  model.extended();
  const BlockChoice choice = choose_drift(model, Block::drift, 0, 6, 0.0625);
  model.blocks.push_back(choice);
  problem.drift_precision = choice.precision;
  if (choice.used) {
    model.steps(1);
  } else {
    problem.stop_drift();
    model.extended();
  }
  if (choice.used) add_joint_drift(model);
  return choice.used;
}

}  // namespace vernier::detail
