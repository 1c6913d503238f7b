// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/prior_choice.hpp"
#include "vernier/least_squares/score_test.hpp"

namespace vernier {

namespace detail {

/// The problem without a group of unknowns, solved, and the group's columns less what the others take over.
struct WithoutGroup {
  const FactorisedEquations& solved;  ///< with the group held at zero
  std::vector<Index> others;          ///< unknowns that are not of the group
  std::vector<Index> tested;          ///< of the group, those of which the data tell most
  MatrixX taken_over{};               ///< others x tested: what they change by for one of the tested
  MatrixX factor{}, information{};    ///< Cholesky factor of the others; of the tested ones
};

/// @param solved with the group held at zero
VERNIER_LOCAL WithoutGroup without_group(const FactorisedEquations& solved, const VectorX& precisions,
                                         const UnknownGroup& group) {
  std::vector<bool> of_group(static_cast<std::size_t>(precisions.size()), false);
  for (const Index k : group) of_group[static_cast<std::size_t>(k)] = true;
  WithoutGroup out{solved, {}, {}};
  for (Index k = 0; k < precisions.size(); ++k)
    if (!of_group[static_cast<std::size_t>(k)]) out.others.push_back(k);
  if (!out.solved.usable()) return out;
  const MatrixX whole = out.solved.reduced();
  const MatrixX of_others = columns_of(whole, out.others);
  out.factor = rows_of(of_others, out.others);
  for (std::size_t k = 0; k < out.others.size(); ++k) {
    const auto at = static_cast<Index>(k);
    out.factor(at, at) += precisions(out.others[k]) + 1e-12 * whole(out.others[k], out.others[k]);
  }
  if (!cholesky(out.factor)) return out;
  MatrixX coupling = rows_of(columns_of(whole, group), out.others);
  MatrixX half = coupling;
  solve_lower(out.factor, half);
  VectorX told(static_cast<Index>(group.size()));  // by the data of each
  const VectorX explained = squared_column_norms(half);
  for (Index k = 0; k < told.size(); ++k) {
    const Index unknown = group[static_cast<std::size_t>(k)];
    told(k) = whole(unknown, unknown) - explained(k);
  }
  std::vector<Index> order(group.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<Index>(k);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return told(a) > told(b); });
  constexpr std::size_t most = 400;
  order.resize((std::min)(order.size(), most));
  std::sort(order.begin(), order.end());
  for (const Index k : order) out.tested.push_back(group[static_cast<std::size_t>(k)]);
  half = columns_of(half, order);
  out.information = rows_of(columns_of(whole, out.tested), out.tested);
  add_transposed_product(out.information, half, half, -1);
  solve_lower_transposed(out.factor, half);
  out.taken_over = std::move(half);
  return out;
}

/// Scores of the tested unknowns, a column a cluster, and one for each prior of the others.
struct Scores {
  MatrixX flipped;        ///< with residuals of the model with the group, left out: those whose signs are flipped
  MatrixX fitted;         ///< the same with residuals as fitted
  VectorX sum;            ///< of the scores as they are
  MatrixX displacements;  ///< sum of squared displacements of all positions, a quadratic form of the columns [m^2]
  Index positions = 0;    ///< blocks with positions
  MatrixX of_positions;   ///< information that positions have, of some blocks
  double counted = 0;     ///< share of the blocks that `of_positions` has
  /// Residuals of positions, and of all other values.
  struct Residuals {
    double left_out = 0;  ///< sum of squares of those that are flipped
    double mixed = 0;     ///< sum of their products with the residuals as fitted
    Index values = 0;
  };
  std::array<Residuals, 2> residuals{};
};

/// Residual of a block at the solution.
/// @param all its columns of dense and factored unknowns
VERNIER_LOCAL Vector6 residual_of(const BlockSystem& system, const FactorisedEquations& solved, const RowBlock& rows,
                                  const Rows6& all) {
  Vector6 residual = rows.residual;
  add_columns(all, solved.step().data(), 1, residual.data());
  for (const RowBlock::Local& part : rows.local)
    if (system.local_states > 0 && part.state >= 0)
      add_columns(part.columns, &solved.local_step()(part.state * system.local_size), 1, residual.data());
  return residual;
}

/// Residuals of the blocks of a cluster under a model that was fitted without them, written to columns of `out`.
VERNIER_LOCAL void leave_out_cluster(const BlockSystem& system, const FactorisedEquations& solved,
                                     const std::vector<Index>& blocks, MatrixX& out) {
  const auto size = static_cast<Index>(6 * blocks.size());
  MatrixX columns(system.unknowns(), size), rest = MatrixX::Identity(size, size);
  VectorX residuals(size);
  RowBlock rows;
  Rows6 all(6, system.unknowns());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    system.rows(blocks[k], 1, &rows);
    rows.expand(system.group_sizes, all);
    const Vector6 residual = residual_of(system, solved, rows, all);
    if (system.local_states > 0) solved.eliminate_local(rows, all);
    for (Index i = 0; i < 6; ++i) {
      residuals(static_cast<Index>(6 * k) + i) = residual(i);
      for (Index c = 0; c < all.cols(); ++c) columns(c, static_cast<Index>(6 * k) + i) = all(i, c);
    }
  }
  solved.apply_inverse_factor(columns);
  add_transposed_product(rest, columns, columns, -1);
  for (Index k = 0; k < size; ++k) rest(k, k) = (std::max)(rest(k, k), 0.0) + 1e-3;  // what is all taken over
  solve_general(rest, residuals);
  for (std::size_t k = 0; k < blocks.size(); ++k)
    std::copy_n(&residuals(static_cast<Index>(6 * k)), 6, &out(0, blocks[k]));
}

/// Share of the measured values that the model explains, as if readings of a pose were one.
VERNIER_LOCAL double mean_leverage(const BlockSystem& system, const FactorisedEquations& solved,
                                   const VectorX& precisions) {
  const VectorX variance = solved.inverse_diagonal();
  const double explained = static_cast<double>(precisions.size()) - variance.dot(precisions);
  RowBlock block;
  system.rows(0, 1, &block);
  Index rows = 0;
  const VectorX squares = squared_row_norms(block.dense);
  for (const double square : squares) rows += square > 0;
  const auto poses = static_cast<Index>(std::set<Index>(system.poses.begin(), system.poses.end()).size());
  const Index independent = poses > 0 ? system.blocks - system.validation_blocks + poses : system.blocks;
  return (std::min)(0.9, explained / static_cast<double>((std::max)(Index{1}, rows) * independent));
}

/// @param with the equations solved with the group
VERNIER_LOCAL Scores scores_of(const BlockSystem& system, const WithoutGroup& at, const FactorisedEquations& with,
                               const VectorX& precisions, const VectorX& steps, const std::vector<Index>& clusters) {
  const auto m = static_cast<Index>(at.tested.size()), rest = static_cast<Index>(at.others.size());
  const auto cluster_of = [&](Index b) { return clusters.empty() ? b : clusters[static_cast<std::size_t>(b)]; };
  std::map<Index, Index> columns;  // of each cluster
  for (Index b = 0; b < system.blocks; ++b) columns.emplace(cluster_of(b), static_cast<Index>(columns.size()));
  std::vector<Index> informed;  // others with a prior
  for (std::size_t k = 0; k < at.others.size(); ++k)
    if (precisions(at.others[k]) > 0) informed.push_back(static_cast<Index>(k));
  const auto of_data = static_cast<Index>(columns.size());
  const MatrixX none = MatrixX::Zero(m, of_data + static_cast<Index>(informed.size()));
  Scores out{none, none, VectorX::Zero(m), MatrixX::Zero(m, m), 0, MatrixX::Zero(m, m)};

  constexpr Index many = 500;  // exact where there are few poses; among many the mean leverage is that of each
  const bool exact = system.blocks < many;
  const double mean = exact ? 1 : 1 / (1 - mean_leverage(system, with, precisions));
  MatrixX left_out(6, exact ? system.blocks : 0);
  if (exact) {
    std::vector<std::vector<Index>> members(static_cast<std::size_t>(of_data));
    for (Index b = 0; b < system.blocks; ++b) members[static_cast<std::size_t>(columns.at(cluster_of(b)))].push_back(b);
    for (const std::vector<Index>& blocks : members) leave_out_cluster(system, with, blocks, left_out);
  }
  Rows6 all(6, system.unknowns()), others(6, rest), tested(6, m);
  const Index stride = 1 + system.blocks / many;  // of those whose positions count
  out.counted = 1 / static_cast<double>(stride);
  const auto top_of = [](const Rows6& rows) -> MatrixX { return rows.topRows<3>(); };
  constexpr Index batch = 64;
  MatrixX waiting(3 * batch, m);  // displacements of positions
  visit_blocks(system, 0, 1, system.blocks, [&](Index b, const RowBlock& rows) {
    rows.expand(system.group_sizes, all);
    const Vector6 residual = residual_of(system, at.solved, rows, all);
    const Vector6 fitted = residual_of(system, with, rows, all);
    Vector6 noise = mean * fitted;
    if (exact) std::copy_n(&left_out(0, b), 6, noise.data());
    if (system.local_states > 0) at.solved.eliminate_local(rows, all);
    for (Index k = 0; k < rest; ++k) std::copy_n(&all(0, at.others[static_cast<std::size_t>(k)]), 6, &others(0, k));
    for (Index k = 0; k < m; ++k) std::copy_n(&all(0, at.tested[static_cast<std::size_t>(k)]), 6, &tested(0, k));
    add_product(tested, others, at.taken_over, -1);
    out.flipped.col(columns.at(cluster_of(b))) += transposed_product(tested, noise);
    out.fitted.col(columns.at(cluster_of(b))) += transposed_product(tested, fitted);
    out.sum += transposed_product(tested, residual);
    for (Index r = 0; r < 6; ++r) {
      if (!(std::abs(fitted(r)) > 0)) continue;  // no value
      Scores::Residuals& kind = out.residuals[r < 3 ? 0 : 1];
      kind.left_out += noise(r) * noise(r);
      kind.mixed += noise(r) * fitted(r);
      ++kind.values;
    }
    if (b % stride == 0) add_transposed_product(out.of_positions, top_of(tested), top_of(tested));
    if (b >= system.validation_blocks) return;
    const Index row = 3 * (out.positions % batch);
    for (Index k = 0; k < m; ++k) {
      const Vector6 moved = rows.unwhiten * column_of(tested, k);
      for (Index r = 0; r < 3; ++r) waiting(row + r, k) = rows.position_sigma * moved(r);
    }
    if (++out.positions % batch == 0) add_transposed_product(out.displacements, waiting, waiting);
  });
  for (Index k = 0; k < m; ++k)
    for (Index r = 3 * (out.positions % batch); r < 3 * batch; ++r) waiting(r, k) = 0;
  add_transposed_product(out.displacements, waiting, waiting);
  for (std::size_t i = 0; i < informed.size(); ++i) {  // a prior is a measurement of zero
    const Index k = informed[i], unknown = at.others[static_cast<std::size_t>(k)];
    const auto pulled = [&](const FactorisedEquations& solved) -> VectorX {
      return row_of(at.taken_over, k) * (-precisions(unknown) * (steps(unknown) + solved.step()(unknown)));
    };
    out.flipped.col(of_data + static_cast<Index>(i)) = pulled(with);
    out.fitted.col(of_data + static_cast<Index>(i)) = pulled(with);
    out.sum += pulled(at.solved);
  }
  return out;
}

/// Variances of the estimates along directions. The scores of clusters give their common scale. The residuals of
/// positions and of other values give the ratios.
/// @param information of each direction
VERNIER_LOCAL VectorX variances_of(const Scores& scores, const MatrixX& directions, const VectorX& information) {
  Scores::Residuals positions = scores.residuals[0], others = scores.residuals[1];
  if (positions.values == 0) positions = others;
  if (others.values == 0) others = positions;
  const auto mean = [](const Scores::Residuals& kind) {  // few poses may have a sum of products that is negative
    return (std::max)(kind.mixed, 0.01 * kind.left_out) / static_cast<double>(kind.values);
  };
  const auto of = [&](double of_positions, double all) {
    const double share = std::clamp(of_positions / (scores.counted * all), 0.0, 1.0);
    return share * mean(positions) + (1 - share) * mean(others);
  };
  const VectorX of_positions =
      diagonal_of(transposed_matrix_product(directions, matrix_product(scores.of_positions, directions)));
  double products = 0, squares = 0;
  for (Index k = 0; k < scores.flipped.size(); ++k) {
    products += scores.flipped.data()[k] * scores.fitted.data()[k];
    squares += scores.flipped.data()[k] * scores.flipped.data()[k];
  }
  const double all = information.sum(),
               scale = (std::max)(products, 0.01 * squares) / all / of(of_positions.sum(), all);
  constexpr double exact = 1e-12;  // of whitened values; without noise all of this is zero
  VectorX out(information.size());
  for (Index k = 0; k < out.size(); ++k)
    out(k) = (std::max)(exact, scale * of(of_positions(k), information(k))) / information(k);
  return out;
}

/// Share of arrangements of signs with a weighted square of the sum as large as that of the scores.
VERNIER_LOCAL double share_as_large(const Scores& scores, Index draws) {
  const double reached = scores.sum.squaredNorm() * (1 - 1e-9);
  Rng rng(0x5c07e5);
  constexpr Index batch = 100;
  Index as_large = 0, drawn = 0;
  MatrixX signs(scores.flipped.cols(), batch);
  while (drawn < draws) {
    std::uint64_t bits = 0;
    for (Index i = 0; i < signs.size(); ++i) {
      if (i % 64 == 0) bits = rng();
      signs.data()[i] = (bits >> (i % 64)) % 2 == 0 ? 1 : -1;
    }
    const VectorX squares = squared_column_norms(matrix_product(scores.flipped, signs));
    for (Index i = 0; i < batch && drawn < draws; ++i, ++drawn) as_large += squares(i) >= reached;
    constexpr Index plenty = 20;
    if (as_large >= plenty) break;
  }
  return static_cast<double>(as_large + 1) / static_cast<double>(drawn + 1);
}

}  // namespace detail

VERNIER_IMPL ScoreTest score_test(const BlockSystem& system, const NormalEquations& normal, const VectorX& precisions,
                                  const VectorX& steps, const UnknownGroup& group, const std::vector<Index>& clusters,
                                  const VectorX& local_steps, Index draws) {
  const FactorisedEquations with(normal, precisions, steps, local_steps);
  VectorX held = precisions;
  for (const Index k : group) held(k) = suppressing_precision;
  return score_test(system, with, with.with(held, steps), precisions, steps, group, clusters, draws);
}

VERNIER_IMPL ScoreTest score_test(const BlockSystem& system, const FactorisedEquations& with,
                                  const FactorisedEquations& without, const VectorX& precisions, const VectorX& steps,
                                  const UnknownGroup& group, const std::vector<Index>& clusters, Index draws) {
  const detail::WithoutGroup at = detail::without_group(without, precisions, group);
  if (at.taken_over.size() == 0 || !with.usable()) return {};
  const detail::SymmetricEigen directions = detail::symmetric_eigen(at.information);
  const Index m = directions.values.size();
  const double most = m > 0 ? directions.values(m - 1) : 0;
  if (!directions.converged || !(most > 0)) return {};
  detail::Scores scores = detail::scores_of(system, at, with, precisions, steps, clusters);
  const double information = detail::diagonal_of(at.information).sum();
  ScoreTest out{};
  out.noise = detail::squared_column_norms(scores.flipped).sum() / information;
  const VectorX along = detail::transposed_product(directions.vectors, scores.sum);
  Index first = 0;
  while (directions.values(first) <= 1e-9 * most) ++first;
  out.information.resize(m - first);
  out.estimates.resize(m - first);
  for (Index k = 0; k < m - first; ++k) {
    out.information(k) = directions.values(m - 1 - k);
    out.estimates(k) = -along(m - 1 - k) / out.information(k);
  }
  std::vector<Index> descending;
  for (Index k = m; k-- > first;) descending.push_back(k);
  out.tested = at.tested;
  out.directions = detail::columns_of(directions.vectors, descending);
  out.variances = detail::variances_of(scores, out.directions, out.information);
  out.displacement =
      detail::transposed_matrix_product(out.directions, detail::matrix_product(scores.displacements, out.directions));
  out.displacement *= 1 / static_cast<double>((std::max)(Index{1}, scores.positions));
  VectorX weights(m);
  for (Index k = 0; k < m; ++k) weights(k) = 1 / std::sqrt((std::max)(directions.values(k), 0.0) + score_precision);
  const MatrixX along_directions = detail::rows_scaled(weights, VERNIER_LATER(directions.vectors).transpose());
  scores.flipped = detail::matrix_product(along_directions, scores.flipped);
  scores.sum = detail::product(along_directions, scores.sum);
  out.p = detail::share_as_large(scores, draws);
  return out;
}

}  // namespace vernier
