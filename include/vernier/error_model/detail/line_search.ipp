// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/detail/line_search.hpp"
#include "vernier/error_model/detail/periodogram.hpp"
#include "vernier/error_model/joint_spectrum.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"

namespace vernier::detail {

/// Orders of each joint that are not in the model and stand out of what it leaves.
VERNIER_LOCAL std::vector<std::vector<int>> lines_beyond(const ModelSelection& model, int highest) {
  const ModelSelection::Linearised& at = model.linearised();
  const JointTerms& terms = model.problem.arm.terms();
  const VectorX precisions = model.problem.arm.precisions();
  const FactorisedEquations solved(at.normal, precisions, at.steps, at.local_steps);
  const double explained = static_cast<double>(precisions.size()) - solved.inverse_diagonal().dot(precisions);
  const double values = static_cast<double>(model.problem.measured_values());
  const double variance = at.normal.cost / (std::max)(1.0, values - explained);
  const Index joints = terms.joints;
  MatrixX score = MatrixX::Zero(at.system.blocks, joints), weight = score;
  visit_blocks(at.system, 0, 1, at.system.blocks, [&](Index b, const RowBlock& rows) {
    for (Index j = 0; j < rows.factor.cols(); ++j) {
      const Vector6 effect = column_of(rows.factor, j);
      score(b, j) = effect.dot(rows.residual);
      weight(b, j) = effect.squaredNorm();
    }
  });
  const MatrixX angles = terms.motors.angles(model.problem.joints());
  const double threshold = line_threshold(joints * highest);
  std::vector<std::vector<int>> out(static_cast<std::size_t>(joints));
  for (Index j = 0; j < joints; ++j) {
    const std::vector<int>& known = terms.transmission[static_cast<std::size_t>(j)].orders;
    if (known.empty() || !tells_orders_apart(VERNIER_LATER(angles).col(j), VERNIER_LATER(weight).col(j), highest))
      continue;
    out[static_cast<std::size_t>(j)] =
        lines_of_residuals(VERNIER_LATER(angles).col(j), VERNIER_LATER(score).col(j), VERNIER_LATER(weight).col(j),
                           known, highest, variance * threshold);
  }
  return out;
}

VERNIER_IMPL bool find_lines(ModelSelection& model) {
  constexpr Index enough = 400;
  constexpr int highest = 2500;
  constexpr double expected = 7e-6;
  if (model.problem.num_blocks() < enough) return false;
  const std::vector<std::vector<int>> found = lines_beyond(model, highest);
  JointTerms terms = model.problem.arm.terms();
  bool any = false;
  for (std::size_t j = 0; j < found.size(); ++j)
    for (const int order : found[j]) {
      auto& orders = terms.transmission[j].orders;
      orders.insert(std::lower_bound(orders.begin(), orders.end(), order), order);
      model.spectra[j].push_back({order, order, expected});
      any = true;
    }
  if (!any) return false;
  const ArmParameterisation without = model.problem.arm;
  model.extend_terms(terms);
  UnknownGroup added;
  const Index geometric = static_cast<Index>(model.problem.arm.geometric().size());
  for (std::size_t j = 0; j < found.size(); ++j)
    for (Index k = 0; k < terms.transmission[j].size(); ++k) {
      const int order = terms.transmission[j].order(k);
      if (std::find(found[j].begin(), found[j].end(), order) != found[j].end())
        added.push_back(geometric + terms.transmission_begin(static_cast<int>(j)) + k);
    }
  if (model.choose_by_evidence(Block::lines, added)) return true;
  model.problem.arm = without;
  model.changed();
  return false;
}

}  // namespace vernier::detail
