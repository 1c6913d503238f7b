// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/identification/detail/shared_touch_errors.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/evidence.hpp"

namespace vernier::detail {

/// What an error of a socket, a face or a ball does to the whitened residuals. Each column is one error of unit size:
/// it moves the object along one of its measured values.
VERNIER_LOCAL MatrixX object_columns(const CalibrationProblem& problem, std::span<const Contact> contacts) {
  std::vector<Index> first, row_of_block;  // column of each block; its first row
  Index columns = 0, rows = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    std::vector<double> lengths;
    const VectorX& known = contacts[c].known();
    const Index values = problem.sets()[c].values();
    for (Index i = 0; i < contacts[c].size(); ++i) {
      const auto same = [&](double length) { return same_value(length, known(i)); };
      const auto at = std::find_if(lengths.begin(), lengths.end(), same) - lengths.begin();
      if (at == static_cast<std::ptrdiff_t>(lengths.size())) lengths.push_back(known(i));
      first.push_back(columns + values * static_cast<Index>(at));
      row_of_block.push_back(rows);
      rows += values;
    }
    columns += values * static_cast<Index>(lengths.size());
  }
  MatrixX out = MatrixX::Zero(rows, columns);
  visit_blocks(problem.system(), 0, 1, problem.num_blocks(), [&](Index b, const RowBlock& block) {
    const auto at = static_cast<std::size_t>(b);
    const Index values = problem.set_of(b).values();
    Rows6 unit(6, values);
    std::fill_n(unit.data(), unit.size(), 0.0);
    for (Index k = 0; k < values; ++k) unit(k, k) = 1 / block.position_sigma;
    solve_lower(block.unwhiten, unit);
    for (Index k = 0; k < values; ++k)
      for (Index r = 0; r < values; ++r) out(row_of_block[at] + r, first[at] + k) = unit(r, k);
  });
  return out;
}

/// A linear least-squares problem with priors on some unknowns.
struct PriorProblem {
  NormalEquations normal;
  VectorX precisions, steps;
  Index values;
  double variance;  ///< of the rows at the minimum
};

/// The variance of rows that is left at the minimum.
VERNIER_LOCAL double least_variance(const PriorProblem& problem) {
  const FactorisedEquations solved(problem.normal, problem.precisions, problem.steps);
  double cost = problem.normal.cost, freedom = static_cast<double>(problem.values + problem.normal.prior_unknowns);
  for (Index k = 0; k < problem.steps.size(); ++k) {
    const double prior = problem.precisions(k) * problem.steps(k);
    cost += prior * problem.steps(k) + solved.step()(k) * (problem.normal.gradient(k) + prior);
    if (problem.precisions(k) <= 0) freedom -= 1;
  }
  return freedom >= 1 && cost > 0 ? cost / freedom : problem.variance;
}

/// Gives some unknowns the size of most evidence, held near an expected one.
/// @param factor by which it may well be larger or smaller: one standard deviation
/// @return that size
VERNIER_LOCAL double choose_size(PriorProblem& problem, Index begin, Index count, double expected, double factor) {
  const double start = problem.variance / (expected * expected);
  const auto with = [&](double log_size) {
    VectorX out = problem.precisions;
    for (Index k = begin; k < begin + count; ++k) out(k) = start * std::exp(-2 * log_size);
    return out;
  };
  const auto evidence = [&](double log_size) {
    const VectorX precisions = with(log_size);
    const FactorisedEquations solved(problem.normal, precisions, problem.steps);
    const double away = log_size / std::log(factor);
    return log_evidence(problem.normal, solved, precisions, problem.steps, problem.values) - 0.5 * away * away;
  };
  double best = 0, highest = evidence(0);
  for (const double step : {1.0, 0.25, 0.0625})
    for (const double towards : {step, -step})
      for (double now = best + towards; std::abs(now) < 10; now += towards) {
        const double reached = evidence(now);
        if (!(reached > highest)) break;
        highest = reached;
        best = now;
      }
  problem.precisions = with(best);
  problem.variance = least_variance(problem);
  return expected * std::exp(best);
}

VERNIER_IMPL SharedTouchErrors shared_touch_errors(const ContactProblem& solved, const MatrixX& inverse,
                                                   double variance) {
  const SharedTouchErrors expected;
  SharedTouchErrors out = expected;
  CalibrationProblem problem = solved.problem;
  const int joints = problem.arm.geometry(0).joints();
  const Index unknowns = problem.arm.size();
  JointTerms terms(joints);
  for (int j = 0; j < joints; ++j)
    if (problem.arm.geometry(0).chain().revolute(j))
      terms.transmission[static_cast<std::size_t>(j)] = Fourier::up_to(3);
  const Index of_joints = terms.size();
  problem.joint_columns = true;
  VectorX scales(of_joints);  // order k is expected to have 1/k of the first
  for (int j = 0; j < joints; ++j) {
    const Fourier& harmonics = terms.transmission[static_cast<std::size_t>(j)];
    for (Index k = 0; k < harmonics.size(); ++k) scales(terms.transmission_begin(j) + k) = 1.0 / harmonics.order(k);
  }
  problem.arm.set_terms(terms, scales, VectorX::Constant(of_joints, 1));
  const StackedRows rows = problem.stacked(true);
  const MatrixX objects = object_columns(problem, solved.contacts);
  const Index of_objects = objects.cols(), all = unknowns + of_joints + of_objects;

  MatrixX jacobian(rows.jacobian.rows(), all);
  VERNIER_LATER(jacobian).leftCols(unknowns + of_joints) = rows.jacobian;
  VERNIER_LATER(jacobian).rightCols(of_objects) = objects;
  const auto row = [&](Index first, Index count, RowBlock* blocks) {
    for (Index i = 0; i < count; ++i) {
      RowBlock& block = blocks[i];
      block.factor.resize(6, 0);
      block.functions.resize(0);
      block.local = {};
      block.residual.setZero();
      block.unwhiten.setIdentity();
      block.residual(0) = rows.residuals(first + i);
      block.dense.resize(6, all);
      std::fill_n(block.dense.data(), block.dense.size(), 0.0);
      for (Index k = 0; k < all; ++k) block.dense(0, k) = jacobian(first + i, k);
    }
  };
  PriorProblem trial{NormalEquations({jacobian.rows(), jacobian.rows(), all, {}, row}), VectorX(all),
                     VectorX::Zero(all), jacobian.rows(), variance};
  if (solved.problem.prior) {
    JointPrior held{MatrixX::Zero(all, all), VectorX::Zero(all), solved.problem.prior->unknowns};
    VERNIER_LATER(held.precision).topLeftCorner(unknowns, unknowns) = solved.problem.prior->precision;
    VectorX at = VectorX::Zero(all);
    VERNIER_LATER(at).head(unknowns) = solved.problem.arm.steps();
    trial.normal.add(held, at);
  }
  const VectorX precisions = solved.problem.arm.precisions(), steps = solved.problem.arm.steps();
  for (Index k = 0; k < all; ++k) {
    const double size = k < unknowns ? 1 : k < unknowns + of_joints ? expected.joint : expected.object;
    trial.precisions(k) = k < unknowns ? precisions(k) : variance / (size * size);
    if (k < unknowns) trial.steps(k) = steps(k);
  }
  for (int round = 0; round < 3; ++round) {
    if (of_joints > 0) out.joint = choose_size(trial, unknowns, of_joints, expected.joint, 8);
    out.object = choose_size(trial, unknowns + of_joints, of_objects, expected.object, 2);
  }
  out.variance = trial.variance;
  const MatrixX arm = VERNIER_LATER(jacobian).leftCols(unknowns);
  MatrixX shared = VERNIER_LATER(jacobian).rightCols(of_joints + of_objects);
  for (Index k = 0; k < shared.cols(); ++k) VERNIER_LATER(shared).col(k) *= k < of_joints ? out.joint : out.object;
  const MatrixX moved = matrix_product(inverse, transposed_matrix_product(arm, shared));
  out.covariance = matrix_product(moved, VERNIER_LATER(moved).transpose());
  return out;
}

}  // namespace vernier::detail
