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

  /// The block of rows of the later state and columns of the earlier one, by columns.
  double* block(const Pair& pair) {
    const auto at = std::lower_bound(pairs_.begin(), pairs_.end(), pair) - pairs_.begin();
    return values_.data() + at * size_ * size_;
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
      for (Index i = 0; i < k; ++i)
        out.local_gradient(a.state * k + i) += detail::column_of(a.columns, i).dot(rows.residual);
      for (const RowBlock::Local& b : rows.local) {
        if (b.state < 0 || b.state > a.state) continue;
        double* sum = sums.block({b.state, a.state});
        for (Index j = 0; j < k; ++j)
          for (Index i = 0; i < k; ++i)
            sum[k * j + i] += detail::column_of(a.columns, i).dot(detail::column_of(b.columns, j));
      }
    }
  });
  for (const LocalPrior& prior : priors) {
    double* sum = prior_sums.block(PairBlocks::pair(prior.first, prior.second));
    for (Index j = 0; j < k; ++j)
      for (Index i = 0; i < k; ++i)
        sum[k * j + i] += prior.first >= prior.second ? prior.precision(i, j) : prior.precision(j, i);
  }
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
    const auto dense_rows = dense.topRows(6 * n);
    const VectorX present = residuals.head(6 * n);
    detail::add_transposed_product(matrix.topLeftCorner(d, d), dense_rows, dense_rows);
    detail::add_transposed_product(gradient.head(d), dense_rows, present);
    cost += present.squaredNorm();
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
      for (Index pair = from; pair < to; ++pair) {
        const Index i = pairs[static_cast<std::size_t>(pair)][0], j = pairs[static_cast<std::size_t>(pair)][1];
        const auto h_i = functions(i), h_j = functions(j);
        const Index row = d + begin[static_cast<std::size_t>(i)], column = d + begin[static_cast<std::size_t>(j)];
        const MatrixX scaled = detail::rows_scaled(factor_product.col(i + groups * j).head(n), h_j);
        if (i != j) {
          detail::add_transposed_product(matrix.block(row, column, h_i.cols(), h_j.cols()), h_i, scaled);
          continue;
        }
        const Index half = h_i.cols() / 2, rest = h_i.cols() - half;  // nothing below the diagonal blocks of this block
        const Index at = begin[static_cast<std::size_t>(i)];
        detail::add_transposed_product(matrix.block(row, column, half, h_i.cols()), h.block(0, at, n, half), scaled);
        detail::add_transposed_product(matrix.block(row + half, column + half, rest, rest),
                                       h.block(0, at + half, n, rest), scaled.rightCols(rest));
      }
    });
  }
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

namespace detail {

/// out += factor columns x, six values
inline void add_columns(const Rows6& columns, const double* x, double factor, double* out) {
  double sum[6] = {};
  for (Index j = 0; j < columns.cols(); ++j)
    for (Index r = 0; r < 6; ++r) sum[r] += x[j] * columns(r, j);
  for (Index r = 0; r < 6; ++r) out[r] += factor * sum[r];
}

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
    : FactorisedEquations(normal, eliminate(normal, local_steps, solve), solve) {
  factorise(precisions, steps, damping);
}

VERNIER_IMPL FactorisedEquations FactorisedEquations::with(const VectorX& precisions, const VectorX& steps) const {
  FactorisedEquations out(*normal_, reduced_, solve_);
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
  const VectorX& gradient = local ? reduced_->gradient : normal.gradient;
  const Index n = gradient.size();
  VectorX of_data = detail::diagonal_of(normal.matrix);  // priors may be huge
  if (normal.prior.size() > 0) of_data -= detail::diagonal_of(normal.prior);
  const double least = 1e-12 * of_data.maxCoeff();
  VectorX step(n);
  for (Index k = 0; k < n; ++k) {
    factor_(k, k) += precisions(k) + damping * (normal.matrix(k, k) + precisions(k)) + least;
    step(k) = -(precisions(k) * steps(k) + gradient(k));
  }
  if (!detail::cholesky(factor_)) return;
  step_ = std::move(step);
  detail::solve_cholesky(factor_, step_);
  usable_ = detail::all_finite(step_);
  if (!local) return;
  local_step_ = reduced_->eliminated.col(0);
  detail::add_product(local_step_, reduced_->eliminated.rightCols(n), step_);
  local_step_ *= -1;
}

VERNIER_IMPL double FactorisedEquations::log_determinant() const {
  return detail::cholesky_log_determinant(factor_) + (reduced_ == nullptr ? 0 : reduced_->log_determinant);
}

VERNIER_IMPL MatrixX FactorisedEquations::inverse() const { return detail::inverse_from_cholesky(factor_); }

VERNIER_IMPL VectorX FactorisedEquations::inverse_diagonal() const {
  // columns of the inverse factor start at their own row
  const Index n = factor_.rows();
  VectorX out(n);
  detail::visit_panels(executor(), n, 64, [&](Index first, Index count) {
    MatrixX columns = MatrixX::Identity(n - first, count);
    detail::solve_lower(factor_.bottomRightCorner(n - first, n - first), columns);
    out.segment(first, count) = detail::squared_column_norms(columns);
  });
  return out;
}

VERNIER_IMPL void FactorisedEquations::apply_inverse_factor(MatrixRef columns) const {
  detail::solve_lower(factor_, columns);
}

VERNIER_IMPL void FactorisedEquations::eliminate_local(const RowBlock& block, Rows6& rows) const {
  for (const RowBlock::Local& local : block.local) {
    if (local.state < 0) continue;
    const Index k = local.columns.cols();
    for (Index c = 0; c < rows.cols(); ++c)
      detail::add_columns(local.columns, &reduced_->eliminated(local.state * k, 1 + c), -1, &rows(0, c));
  }
}

VERNIER_IMPL MatrixX FactorisedEquations::local_gains(const std::vector<RowBlock>& blocks) const {
  MatrixX out = MatrixX::Zero(6, 6 * static_cast<Index>(blocks.size()));
  if (reduced_ == nullptr) return out;
  MatrixX columns = MatrixX::Zero(reduced_->local.size, out.cols());
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (const RowBlock::Local& local : blocks[b].local)
      for (Index j = 0; local.state >= 0 && j < local.columns.cols(); ++j)
        for (Index r = 0; r < 6; ++r)
          columns(local.state * local.columns.cols() + j, 6 * static_cast<Index>(b) + r) = local.columns(r, j);
  solve_(reduced_->local, columns);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (const RowBlock::Local& local : blocks[b].local)
      for (Index c = 6 * static_cast<Index>(b); local.state >= 0 && c < 6 * static_cast<Index>(b + 1); ++c)
        detail::add_columns(local.columns, &columns(local.state * local.columns.cols(), c), 1, &out(0, c));
  return out;
}

VERNIER_IMPL LeftOutBlocks leave_one_out(const BlockSystem& system, const FactorisedEquations& solved, Index stride) {
  const Index size = (system.validation_blocks + stride - 1) / stride;
  LeftOutBlocks out{Eigen::Matrix3Xd(3, size), VectorX::Constant(size, -std::numeric_limits<double>::infinity())};
  std::fill_n(out.errors.data(), 3 * size, std::numeric_limits<double>::infinity());
  if (!solved.usable()) return out;
  VectorX squares(size), log_determinants(size), values(size);  // of whitened errors; of I - H; measured ones
  constexpr Index batch = 32;
  const bool local = system.local_states > 0;
  solved.executor().for_ranges((size + batch - 1) / batch, [&](Index from, Index to) {
    std::vector<RowBlock> kept;
    Rows6 expanded(6, system.unknowns());
    MatrixX columns(system.unknowns(), 6 * batch), gains, rest;
    std::array<Vector6, batch> residuals;
    std::array<Matrix6, batch> unwhiten;
    VectorX sigmas(batch);
    for (Index first = from * batch; first < std::min(to * batch, size); first += batch) {
      const Index n = std::min(batch, size - first);
      kept.clear();
      detail::visit_blocks(system, first * stride, stride, n, [&](Index b, const RowBlock& rows) {
        rows.expand(system.group_sizes, expanded);
        const auto k = static_cast<std::size_t>(b);
        residuals[k] = rows.residual;
        detail::add_columns(expanded, solved.step().data(), 1, residuals[k].data());
        if (local) {
          for (const RowBlock::Local& part : rows.local)
            if (part.state >= 0)
              detail::add_columns(part.columns, &solved.local_step()(part.state * system.local_size), 1,
                                  residuals[k].data());
          solved.eliminate_local(rows, expanded);
          kept.push_back(rows);
        }
        unwhiten[k] = rows.unwhiten;
        sigmas(b) = rows.position_sigma;
        values(first + b) = 0;
        for (Index i = 0; i < 6; ++i) {
          for (Index c = 0; c < expanded.cols(); ++c) columns(c, 6 * b + i) = expanded(i, c);
          bool measured = rows.residual(i) != 0;
          for (Index c = 0; c < rows.dense.cols() && !measured; ++c) measured = rows.dense(i, c) != 0;
          if (measured) values(first + b) += 1;
        }
      });
      solved.apply_inverse_factor(columns.leftCols(6 * n));
      if (local) gains = solved.local_gains(kept);
      for (Index b = 0; b < n; ++b) {
        const auto z = columns.middleCols(6 * b, 6);
        rest.setIdentity(6, 6);
        detail::add_transposed_product(rest, z, z, -1);
        if (local) rest -= gains.middleCols(6 * b, 6);
        const auto k = static_cast<std::size_t>(b);
        Vector6 left_out = residuals[k];
        log_determinants(first + b) = detail::solve_general(rest, left_out);
        squares(first + b) = residuals[k].dot(left_out);
        const Vector6 error = unwhiten[k] * left_out;
        for (Index r = 0; r < 3; ++r) out.errors(r, first + b) = sigmas(b) * error(r);
      }
    }
  });
  const double variance = squares.sum() / values.sum();
  for (Index b = 0; b < size; ++b)
    out.log_densities(b) = -0.5 * (squares(b) / variance - log_determinants(b) + std::log(variance) * values(b));
  return out;
}

VERNIER_IMPL Eigen::Matrix3Xd leave_one_out_errors(const BlockSystem& system, const FactorisedEquations& solved,
                                                   Index stride) {
  return leave_one_out(system, solved, stride).errors;
}

VERNIER_IMPL VectorX detail::error_norms(const Eigen::Matrix3Xd& errors) {
  VectorX out(errors.cols());
  for (Index b = 0; b < out.size(); ++b) out(b) = Vector3(errors(0, b), errors(1, b), errors(2, b)).norm();
  return out;
}

}  // namespace vernier
