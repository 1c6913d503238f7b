// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/normal_equations.hpp"

namespace vernier {

namespace detail {

/// A symmetric matrix of blocks, by its pairs of states.
class PairBlocks {
 public:
  using Pair = std::pair<Index, Index>;  // (column state, row state), row at or below column

  VERNIER_LOCAL PairBlocks(std::vector<Pair> pairs, Index block_size) : pairs_(std::move(pairs)), size_(block_size) {
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    values_.assign(pairs_.size() * static_cast<std::size_t>(size_ * size_), 0.0);
  }

  static Pair pair(Index a, Index b) { return {(std::min)(a, b), (std::max)(a, b)}; }

  /// The block of rows of the later state and columns of the earlier one, by columns.
  VERNIER_LOCAL double* block(const Pair& pair) {
    const auto at = std::lower_bound(pairs_.begin(), pairs_.end(), pair) - pairs_.begin();
    return values_.data() + at * size_ * size_;
  }

  /// By columns, the same entries for any values.
  VERNIER_LOCAL SparseSymmetric compressed(Index states) const {
    SparseSymmetric out;
    out.size = states * size_;
    std::size_t next = 0;
    for (Index state = 0; state < states; ++state) {
      std::size_t end = next;
      while (end < pairs_.size() && pairs_[end].first == state) ++end;
      for (Index column = 0; column < size_; ++column) {
        out.starts.push_back(static_cast<int>(out.rows.size()));
        for (std::size_t k = next; k < end; ++k)
          for (Index row = pairs_[k].second == state ? column : 0; row < size_; ++row) {
            out.rows.push_back(static_cast<int>(pairs_[k].second * size_ + row));
            out.values.push_back(
                values_[k * static_cast<std::size_t>(size_ * size_) + static_cast<std::size_t>(column * size_ + row)]);
          }
      }
      next = end;
    }
    out.starts.push_back(static_cast<int>(out.rows.size()));
    return out;
  }

 private:
  std::vector<Pair> pairs_;
  Index size_;
  std::vector<double> values_;
};

/// The local part of the normal equations.
VERNIER_LOCAL void add_local(const BlockSystem& system, const std::vector<LocalPrior>& priors, NormalEquations& out) {
  const Index k = system.local_size;
  std::vector<PairBlocks::Pair> pairs;
  for (Index s = 0; s < system.local_states; ++s) pairs.push_back({s, s});
  visit_blocks(system, 0, 1, system.blocks, [&](Index, const RowBlock& rows) {
    const Index a = rows.local[0].state, b = rows.local[1].state;
    demand(a != b || a < 0, "NormalEquations: a block depends twice on local state ", a);
    if (a >= 0 && b >= 0) pairs.push_back(PairBlocks::pair(a, b));
  });
  for (const LocalPrior& prior : priors) pairs.push_back(PairBlocks::pair(prior.first, prior.second));
  PairBlocks sums(pairs, k), prior_sums(pairs, k);
  out.coupling.setZero(system.local_unknowns(), system.unknowns());
  out.local_gradient.setZero(system.local_unknowns());
  Rows6 expanded(6, system.unknowns());
  visit_blocks(system, 0, 1, system.blocks, [&](Index, const RowBlock& rows) {
    if (rows.local[0].state < 0 && rows.local[1].state < 0) return;
    rows.expand(system.group_sizes, expanded);
    for (const RowBlock::Local& a : rows.local) {
      if (a.state < 0) continue;
      add_transposed_product(VERNIER_LATER(out.coupling).middleRows(a.state * k, k), a.columns, expanded);
      for (Index i = 0; i < k; ++i)
        out.local_gradient(a.state * k + i) += detail::column_of(a.columns, i).dot(rows.residual);
      for (const RowBlock::Local& b : rows.local) {
        if (b.state < 0 || b.state > a.state) continue;
        double* sum = VERNIER_LATER(sums).block({b.state, a.state});
        for (Index j = 0; j < k; ++j) {
          const Vector6 right = detail::column_of(b.columns, j);
          for (Index i = 0; i < k; ++i) sum[k * j + i] += detail::column_of(a.columns, i).dot(right);
        }
      }
    }
  });
  for (const LocalPrior& prior : priors) {
    double* sum = VERNIER_LATER(prior_sums).block(PairBlocks::pair(prior.first, prior.second));
    for (Index j = 0; j < k; ++j)
      for (Index i = 0; i < k; ++i)
        sum[k * j + i] += prior.first >= prior.second ? prior.precision(i, j) : prior.precision(j, i);
  }
  out.local = sums.compressed(system.local_states);
  out.local_prior = prior_sums.compressed(system.local_states);
}

}  // namespace detail

VERNIER_IMPL NormalEquations::NormalEquations(const BlockSystem& system, const std::vector<LocalPrior>& local_priors,
                                              ExecutorRef of_sums, const NormalEquations* same_functions)
    : matrix(MatrixX::Zero(system.unknowns(), system.unknowns())),
      gradient(VectorX::Zero(system.unknowns())),
      executor(of_sums) {
  constexpr Index chunk = 256;
  const Index all = system.unknowns(), d = system.dense, groups = system.groups();
  MatrixX dense(6 * chunk, d), h(chunk, all - d), mixed(chunk, d * groups);
  MatrixX factor_residual(chunk, groups), factor_product(chunk, groups * groups);  // f_j' r and f_i' f_j of each block
  VectorX residuals(6 * chunk);
  std::vector<std::array<Index, 2>> pairs;  // of groups, the second not before the first
  std::vector<Index> begin{0};              // of each group's functions
  for (Index j = 0; j < groups; ++j) {
    begin.push_back(begin.back() + system.group_sizes[static_cast<std::size_t>(j)]);
    for (Index i = 0; i <= j; ++i) pairs.push_back({i, j});
  }
  demand(same_functions == nullptr || (same_functions->matrix.rows() >= all - d && same_functions->prior.size() == 0),
         "NormalEquations: same_functions have fewer unknowns, or a joint prior");
  const Index summed = all > d && same_functions == nullptr ? static_cast<Index>(pairs.size()) : 0;
  for (Index first = 0; first < system.blocks; first += chunk) {
    const Index n = (std::min)(chunk, system.blocks - first);
    executor.for_ranges((n + detail::rows_at_a_time - 1) / detail::rows_at_a_time, [&](Index from, Index to) {
      const Index start = from * detail::rows_at_a_time, stop = (std::min)(n, to * detail::rows_at_a_time);
      detail::visit_blocks(system, first + start, 1, stop - start, [&](Index k, const RowBlock& rows) {
        const Index b = start + k;
        for (Index c = 0; c < d; ++c)
          for (Index r = 0; r < 6; ++r) dense(6 * b + r, c) = rows.dense(r, c);
        for (Index r = 0; r < 6; ++r) residuals(6 * b + r) = rows.residual(r);
        if (all == d) return;
        for (Index c = 0; c < all - d; ++c) h(b, c) = rows.functions(c);
        for (Index j = 0; j < groups; ++j) {
          const Vector6 factor = detail::column_of(rows.factor, j);
          for (Index i = 0; i <= j; ++i)
            factor_product(b, i + groups * j) = detail::column_of(rows.factor, i).dot(factor);
          for (Index c = 0; c < d; ++c) mixed(b, c + d * j) = detail::column_of(rows.dense, c).dot(factor);
          factor_residual(b, j) = rows.residual.dot(factor);
        }
      });
    });
    const auto dense_rows = VERNIER_LATER(dense).topRows(6 * n);
    const VectorX present = VERNIER_LATER(residuals).head(6 * n);
    detail::add_transposed_product(VERNIER_LATER(matrix).topLeftCorner(d, d), dense_rows, dense_rows);
    detail::add_transposed_product(VERNIER_LATER(gradient).head(d), dense_rows, present);
    cost += present.squaredNorm();
    const auto functions = [&](Index j) {
      const auto group = static_cast<std::size_t>(j);
      return VERNIER_LATER(h).block(0, begin[group], n, begin[group + 1] - begin[group]);
    };
    for (Index j = 0; j < groups && all > d; ++j) {
      const auto h_j = functions(j);
      const Index at = d + begin[static_cast<std::size_t>(j)];
      detail::add_transposed_product(VERNIER_LATER(gradient).segment(at, h_j.cols()), h_j,
                                     VERNIER_LATER(factor_residual).col(j).head(n));
      detail::add_transposed_product(VERNIER_LATER(matrix).block(0, at, d, h_j.cols()),
                                     VERNIER_LATER(mixed).block(0, j * d, n, d), h_j);
    }
    executor.for_ranges(summed, [&](Index from, Index to) {
      for (Index pair = from; pair < to; ++pair) {
        const Index i = pairs[static_cast<std::size_t>(pair)][0], j = pairs[static_cast<std::size_t>(pair)][1];
        const auto h_i = functions(i), h_j = functions(j);
        const Index row = d + begin[static_cast<std::size_t>(i)], column = d + begin[static_cast<std::size_t>(j)];
        const MatrixX scaled = detail::rows_scaled(VERNIER_LATER(factor_product).col(i + groups * j).head(n), h_j);
        if (i != j) {
          detail::add_transposed_product(VERNIER_LATER(matrix).block(row, column, h_i.cols(), h_j.cols()), h_i, scaled);
          continue;
        }
        const Index half = h_i.cols() / 2, rest = h_i.cols() - half;  // nothing below the diagonal blocks of this block
        const Index at = begin[static_cast<std::size_t>(i)];
        detail::add_transposed_product(VERNIER_LATER(matrix).block(row, column, half, h_i.cols()),
                                       VERNIER_LATER(h).block(0, at, n, half), scaled);
        detail::add_transposed_product(VERNIER_LATER(matrix).block(row + half, column + half, rest, rest),
                                       VERNIER_LATER(h).block(0, at + half, n, rest),
                                       VERNIER_LATER(scaled).rightCols(rest));
      }
    });
  }
  if (same_functions != nullptr)
    VERNIER_LATER(matrix).bottomRightCorner(all - d, all - d) =
        VERNIER_LATER(same_functions->matrix).bottomRightCorner(all - d, all - d);
  for (Index c = 0; c < all; ++c)
    for (Index r = c + 1; r < all; ++r) matrix(r, c) = matrix(c, r);
  if (system.local_states > 0) detail::add_local(system, local_priors, *this);
}

VERNIER_IMPL double JointPrior::cost(const VectorX& steps) const {
  const VectorX offset = steps - mean;
  return offset.dot(detail::product(precision, offset));
}

VERNIER_IMPL void NormalEquations::add(const JointPrior& joint, const VectorX& steps) {
  const VectorX offset = steps - joint.mean, slope = detail::product(joint.precision, offset);
  matrix += joint.precision;
  gradient += slope;
  cost += offset.dot(slope);
  prior = joint.precision;
  prior_unknowns = joint.unknowns;
}

VERNIER_IMPL double local_prior_cost(const NormalEquations& normal, const VectorX& local_steps) {
  return normal.local.size == 0 ? 0 : local_steps.dot(detail::multiply(normal.local_prior, local_steps));
}

VERNIER_IMPL double local_gain(const NormalEquations& normal, const VectorX& step, const VectorX& local_steps) {
  if (normal.local.size == 0) return 0;
  const VectorX slope = normal.local_gradient + detail::multiply(normal.local_prior, local_steps);
  return step.dot(slope);
}

}  // namespace vernier
