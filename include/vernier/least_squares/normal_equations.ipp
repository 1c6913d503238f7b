#pragma once

#include <algorithm>
#include <array>
#include <limits>

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

  PairBlocks(std::vector<Pair> pairs, Index block_size) : pairs_(std::move(pairs)), size_(block_size) {
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    values_.assign(pairs_.size() * static_cast<std::size_t>(size_ * size_), 0.0);
  }

  static Pair pair(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

  /// The block of rows of the later state and columns of the earlier one.
  Eigen::Map<MatrixX> block(const Pair& pair) {
    const auto at = std::lower_bound(pairs_.begin(), pairs_.end(), pair) - pairs_.begin();
    return {values_.data() + at * size_ * size_, size_, size_};
  }

  /// By columns, the same entries for any values.
  SparseSymmetric compressed(Index states) const {
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
VERNIER_API void add_local(const BlockSystem& system, const std::vector<LocalPrior>& priors, NormalEquations& out) {
  const Index k = system.local_size;
  std::vector<PairBlocks::Pair> pairs;
  for (Index s = 0; s < system.local_states; ++s) pairs.push_back({s, s});
  visit_blocks(system, 0, 1, system.blocks, [&](Index, const RowBlock& rows) {
    const Index a = rows.local[0].state, b = rows.local[1].state;
    require(a != b || a < 0, "NormalEquations: a block depends twice on local state ", a);
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
      add_transposed_product(out.coupling.middleRows(a.state * k, k), a.columns, expanded);
      out.local_gradient.segment(a.state * k, k) += a.columns.transpose().lazyProduct(rows.residual);
      for (const RowBlock::Local& b : rows.local)
        if (b.state >= 0 && b.state <= a.state)
          sums.block({b.state, a.state}) += a.columns.transpose().lazyProduct(b.columns);
    }
  });
  for (const LocalPrior& prior : priors)
    if (prior.first >= prior.second)
      prior_sums.block(PairBlocks::pair(prior.first, prior.second)) += prior.precision;
    else
      prior_sums.block(PairBlocks::pair(prior.first, prior.second)) += prior.precision.transpose();
  out.local = sums.compressed(system.local_states);
  out.local_prior = prior_sums.compressed(system.local_states);
}

/// `matrix x`, from its lower triangle.
VERNIER_API VectorX multiply(const SparseSymmetric& matrix, const VectorX& x) {
  VectorX out = VectorX::Zero(matrix.size);
  for (Index j = 0; j < matrix.size; ++j)
    for (int at = matrix.starts[static_cast<std::size_t>(j)]; at < matrix.starts[static_cast<std::size_t>(j + 1)];
         ++at) {
      const Index i = matrix.rows[static_cast<std::size_t>(at)];
      const double value = matrix.values[static_cast<std::size_t>(at)];
      out(i) += value * x(j);
      if (i != j) out(j) += value * x(i);
    }
  return out;
}

}  // namespace detail

VERNIER_IMPL NormalEquations::NormalEquations(const BlockSystem& system, const std::vector<LocalPrior>& local_priors,
                                              ExecutorRef of_sums)
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
  for (Index first = 0; first < system.blocks; first += chunk) {
    const Index n = std::min(chunk, system.blocks - first);
    executor.for_ranges((n + detail::rows_at_a_time - 1) / detail::rows_at_a_time, [&](Index from, Index to) {
      const Index start = from * detail::rows_at_a_time, stop = std::min(n, to * detail::rows_at_a_time);
      MatrixX product;
      detail::visit_blocks(system, first + start, 1, stop - start, [&](Index k, const RowBlock& rows) {
        const Index b = start + k;
        if (d > 0) dense.middleRows(6 * b, 6) = rows.dense;
        residuals.segment(6 * b, 6) = rows.residual;
        if (all == d) return;
        h.row(b) = rows.functions.transpose();
        product = rows.factor.transpose().lazyProduct(rows.factor);
        factor_product.row(b) = product.reshaped().transpose();
        if (d > 0) {
          product = rows.dense.transpose().lazyProduct(rows.factor);
          mixed.row(b) = product.reshaped().transpose();
        }
        factor_residual.row(b) = rows.residual.transpose().lazyProduct(rows.factor);
      });
    });
    const auto dense_rows = dense.topRows(6 * n);
    detail::add_transposed_product(matrix.topLeftCorner(d, d), dense_rows, dense_rows);
    detail::add_transposed_product(gradient.head(d), dense_rows, residuals.head(6 * n));
    cost += residuals.head(6 * n).squaredNorm();
    const auto functions = [&](Index j) {
      const auto group = static_cast<std::size_t>(j);
      return h.block(0, begin[group], n, begin[group + 1] - begin[group]);
    };
    for (Index j = 0; j < groups && all > d; ++j) {
      const auto h_j = functions(j);
      const Index at = d + begin[static_cast<std::size_t>(j)];
      detail::add_transposed_product(gradient.segment(at, h_j.cols()), h_j, factor_residual.col(j).head(n));
      detail::add_transposed_product(matrix.block(0, at, d, h_j.cols()), mixed.block(0, j * d, n, d), h_j);
    }
    executor.for_ranges(all > d ? static_cast<Index>(pairs.size()) : 0, [&](Index from, Index to) {
      MatrixX scaled;
      for (Index pair = from; pair < to; ++pair) {
        const Index i = pairs[static_cast<std::size_t>(pair)][0], j = pairs[static_cast<std::size_t>(pair)][1];
        const auto h_i = functions(i), h_j = functions(j);
        const Index row = d + begin[static_cast<std::size_t>(i)], column = d + begin[static_cast<std::size_t>(j)];
        scaled = factor_product.col(i + groups * j).head(n).asDiagonal() * h_j;
        if (i != j) {
          detail::add_transposed_product(matrix.block(row, column, h_i.cols(), h_j.cols()), h_i, scaled);
          continue;
        }
        const Index half = h_i.cols() / 2, rest = h_i.cols() - half;  // nothing below the diagonal blocks of this block
        detail::add_transposed_product(matrix.block(row, column, half, h_i.cols()), h_i.leftCols(half), scaled);
        detail::add_transposed_product(matrix.block(row + half, column + half, rest, rest), h_i.rightCols(rest),
                                       scaled.rightCols(rest));
      }
    });
  }
  matrix.triangularView<Eigen::StrictlyLower>() = matrix.transpose();
  if (system.local_states > 0) detail::add_local(system, local_priors, *this);
}

VERNIER_IMPL double JointPrior::cost(const VectorX& steps) const {
  const MatrixX offset = steps - mean;
  MatrixX slope = MatrixX::Zero(offset.rows(), 1);
  detail::add_product(slope, precision, offset);
  return slope.col(0).dot(offset.col(0));
}

VERNIER_IMPL void NormalEquations::add(const JointPrior& joint, const VectorX& steps) {
  const MatrixX offset = steps - joint.mean;
  MatrixX slope = MatrixX::Zero(offset.rows(), 1);
  detail::add_product(slope, joint.precision, offset);
  matrix += joint.precision;
  gradient += slope.col(0);
  cost += slope.col(0).dot(offset.col(0));
  prior = joint.precision;
  prior_unknowns = joint.unknowns;
}

VERNIER_IMPL double local_prior_cost(const NormalEquations& normal, const VectorX& local_steps) {
  return normal.local.size == 0 ? 0 : local_steps.dot(detail::multiply(normal.local_prior, local_steps));
}

VERNIER_IMPL double local_gain(const NormalEquations& normal, const VectorX& step, const VectorX& local_steps) {
  if (normal.local.size == 0) return 0;
  return step.dot(normal.local_gradient + detail::multiply(normal.local_prior, local_steps));
}

namespace detail {

/// Calls `use(first, count)` for panels of the columns of a lower triangle.
template <class Use>
void visit_panels(ExecutorRef executor, Index n, Index width, const Use& use) {
  const Index panels = (n + width - 1) / width;
  executor.for_ranges(panels, [&](Index from, Index to) {
    for (Index k = from; k < to; ++k) {
      // the first panels are the longest: every thread gets long and short ones
      const Index first = width * (k % 2 == 0 ? k / 2 : panels - 1 - k / 2);
      use(first, std::min(width, n - first));
    }
  });
}

}  // namespace detail

VERNIER_IMPL FactorisedEquations::FactorisedEquations(const NormalEquations& normal, const VectorX& precisions,
                                                      const VectorX& steps, const VectorX& local_steps,
                                                      SparseSolve solve, double damping)
    : FactorisedEquations(normal, solve, eliminate(normal, local_steps, solve)) {
  factorise(precisions, steps, damping);
}

VERNIER_IMPL FactorisedEquations FactorisedEquations::with(const VectorX& precisions, const VectorX& steps) const {
  FactorisedEquations out(*normal_, solve_, reduced_);
  out.factorise(precisions, steps, 0);
  return out;
}

VERNIER_IMPL std::shared_ptr<const FactorisedEquations::Reduced> FactorisedEquations::eliminate(
    const NormalEquations& normal, const VectorX& local_steps, SparseSolve solve) {
  if (normal.local.size == 0) return {};
  Reduced out{normal.matrix, normal.gradient, normal.local, {}, {}};
  for (std::size_t k = 0; k < out.local.values.size(); ++k) out.local.values[k] += normal.local_prior.values[k];
  const Index n = normal.matrix.rows();
  out.eliminated.resize(normal.local.size, 1 + n);
  out.eliminated.col(0) = normal.local_gradient;
  if (local_steps.size() > 0) out.eliminated.col(0) += detail::multiply(normal.local_prior, local_steps);
  out.eliminated.rightCols(n) = normal.coupling;
  // factorised once a panel, which costs little beside its solutions
  constexpr Index width = 256;
  const Index panels = n / width + 1;
  std::vector<SparseOutcome> outcomes(static_cast<std::size_t>(panels));
  normal.executor.for_ranges(panels, [&](Index from, Index to) {
    for (Index k = from; k < to; ++k)
      outcomes[static_cast<std::size_t>(k)] =
          solve(out.local, out.eliminated.middleCols(k * width, std::min(width, n + 1 - k * width)));
  });
  if (!outcomes.front().solved) return {};
  out.log_determinant = outcomes.front().log_determinant;
  detail::add_transposed_product(out.gradient, normal.coupling, out.eliminated.col(0), -1);
  detail::visit_panels(normal.executor, n, 64, [&](Index first, Index count) {
    detail::add_transposed_product(out.matrix.block(first, first, n - first, count),
                                   normal.coupling.rightCols(n - first), out.eliminated.middleCols(1 + first, count),
                                   -1);
  });
  return std::make_shared<const Reduced>(std::move(out));
}

VERNIER_IMPL void FactorisedEquations::factorise(const VectorX& precisions, const VectorX& steps, double damping) {
  const NormalEquations& normal = *normal_;
  const bool local = normal.local.size > 0;
  if (local && reduced_ == nullptr) return;
  factor_ = local ? reduced_->matrix : normal.matrix;
  VectorX right = precisions.cwiseProduct(steps);
  right += local ? reduced_->gradient : normal.gradient;
  factor_.diagonal() += precisions + damping * (normal.matrix.diagonal() + precisions);
  VectorX of_data = normal.matrix.diagonal();  // priors may be huge
  if (normal.prior.size() > 0) of_data -= normal.prior.diagonal();
  factor_.diagonal().array() += 1e-12 * of_data.maxCoeff();
  if (!detail::cholesky(factor_)) return;
  step_ = -right;
  detail::solve_cholesky(factor_, step_);
  usable_ = step_.allFinite();
  if (!local) return;
  local_step_ = -reduced_->eliminated.col(0);
  detail::add_product(local_step_, reduced_->eliminated.rightCols(step_.size()), step_, -1);
}

VERNIER_IMPL double FactorisedEquations::log_determinant() const {
  return 2 * factor_.diagonal().array().log().sum() + (reduced_ == nullptr ? 0 : reduced_->log_determinant);
}

VERNIER_IMPL MatrixX FactorisedEquations::inverse() const { return detail::inverse_from_cholesky(factor_); }

VERNIER_IMPL VectorX FactorisedEquations::inverse_diagonal() const {
  // columns of the inverse factor start at their own row
  const Index n = factor_.rows();
  VectorX out(n);
  detail::visit_panels(executor(), n, 64, [&](Index first, Index count) {
    MatrixX columns = MatrixX::Zero(n - first, count);
    columns.topRows(count).setIdentity();
    detail::solve_lower(factor_.bottomRightCorner(n - first, n - first), columns);
    out.segment(first, count) = columns.colwise().squaredNorm().transpose();
  });
  return out;
}

VERNIER_IMPL void FactorisedEquations::apply_inverse_factor(MatrixRef columns) const {
  detail::solve_lower(factor_, columns);
}

VERNIER_IMPL void FactorisedEquations::eliminate_local(const RowBlock& block, Eigen::Ref<Rows6> rows) const {
  for (const RowBlock::Local& local : block.local) {
    if (local.state < 0) continue;
    const Index k = local.columns.cols();
    rows -= local.columns.lazyProduct(reduced_->eliminated.block(local.state * k, 1, k, rows.cols()));
  }
}

VERNIER_IMPL MatrixX FactorisedEquations::local_gains(const std::vector<RowBlock>& blocks) const {
  MatrixX out = MatrixX::Zero(6, 6 * static_cast<Index>(blocks.size()));
  if (reduced_ == nullptr) return out;
  MatrixX columns = MatrixX::Zero(reduced_->local.size, out.cols());
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (const RowBlock::Local& local : blocks[b].local)
      if (local.state >= 0)
        columns.block(local.state * local.columns.cols(), 6 * static_cast<Index>(b), local.columns.cols(), 6) =
            local.columns.transpose();
  solve_(reduced_->local, columns);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (const RowBlock::Local& local : blocks[b].local)
      if (local.state >= 0)
        out.middleCols(6 * static_cast<Index>(b), 6) += local.columns.lazyProduct(
            columns.block(local.state * local.columns.cols(), 6 * static_cast<Index>(b), local.columns.cols(), 6));
  return out;
}

VERNIER_IMPL LeftOutBlocks leave_one_out(const BlockSystem& system, const FactorisedEquations& solved, Index stride) {
  const Index size = (system.validation_blocks + stride - 1) / stride;
  LeftOutBlocks out{Eigen::Matrix3Xd::Constant(3, size, std::numeric_limits<double>::infinity()),
                    VectorX::Constant(size, -std::numeric_limits<double>::infinity())};
  if (!solved.usable()) return out;
  VectorX squares(size), log_determinants(size), values(size);  // of whitened errors; of I - H; measured ones
  constexpr Index batch = 32;
  const bool local = system.local_states > 0;
  solved.executor().for_ranges((size + batch - 1) / batch, [&](Index from, Index to) {
    std::vector<RowBlock> kept;
    Rows6 expanded(6, system.unknowns());
    MatrixX columns(system.unknowns(), 6 * batch), residuals(6, batch), unwhiten(6, 6 * batch), gains, rest;
    VectorX sigmas(batch);
    for (Index first = from * batch; first < std::min(to * batch, size); first += batch) {
      const Index n = std::min(batch, size - first);
      kept.clear();
      detail::visit_blocks(system, first * stride, stride, n, [&](Index b, const RowBlock& rows) {
        rows.expand(system.group_sizes, expanded);
        residuals.col(b) = rows.residual + expanded.lazyProduct(solved.step());
        if (local) {
          for (const RowBlock::Local& part : rows.local)
            if (part.state >= 0)
              residuals.col(b) += part.columns.lazyProduct(
                  solved.local_step().segment(part.state * system.local_size, system.local_size));
          solved.eliminate_local(rows, expanded);
          kept.push_back(rows);
        }
        columns.middleCols(6 * b, 6) = expanded.transpose();
        unwhiten.middleCols(6 * b, 6) = rows.unwhiten;
        sigmas(b) = rows.position_sigma;
        values(first + b) = 0;
        for (Index i = 0; i < 6; ++i)
          if (rows.residual(i) != 0 || (rows.dense.row(i).array() != 0).any()) values(first + b) += 1;
      });
      solved.apply_inverse_factor(columns.leftCols(6 * n));
      if (local) gains = solved.local_gains(kept);
      for (Index b = 0; b < n; ++b) {
        const auto z = columns.middleCols(6 * b, 6);
        rest.setIdentity(6, 6);
        detail::add_transposed_product(rest, z, z, -1);
        if (local) rest -= gains.middleCols(6 * b, 6);
        const Vector6 residual = residuals.col(b);
        log_determinants(first + b) = detail::solve_general(rest, residuals.col(b));
        squares(first + b) = residual.dot(residuals.col(b));
        out.errors.col(first + b) = sigmas(b) * unwhiten.block(0, 6 * b, 3, 6).lazyProduct(residuals.col(b));
      }
    }
  });
  const double variance = squares.sum() / values.sum();
  out.log_densities = -0.5 * (squares / variance - log_determinants + std::log(variance) * values);
  return out;
}

VERNIER_IMPL Eigen::Matrix3Xd leave_one_out_errors(const BlockSystem& system, const FactorisedEquations& solved,
                                                   Index stride) {
  return leave_one_out(system, solved, stride).errors;
}

}  // namespace vernier
