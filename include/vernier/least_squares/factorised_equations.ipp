// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/factorised_equations.hpp"

namespace vernier {

namespace detail {

/// Calls `use(first, count)` for panels of the columns of a lower triangle.
template <class Use>
void visit_panels(ExecutorRef executor, Index n, Index width, const Use& use) {
  const Index panels = (n + width - 1) / width;
  executor.for_ranges(panels, [&](Index from, Index to) {
    for (Index k = from; k < to; ++k) {
      // the first panels are the longest: every thread gets long and short ones
      const Index first = width * (k % 2 == 0 ? k / 2 : panels - 1 - k / 2);
      use(first, (std::min)(width, n - first));
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
  VERNIER_LATER(out.eliminated).col(0) = normal.local_gradient;
  if (local_steps.size() > 0) VERNIER_LATER(out.eliminated).col(0) += detail::multiply(normal.local_prior, local_steps);
  VERNIER_LATER(out.eliminated).rightCols(n) = normal.coupling;
  // factorised once a panel, which costs little beside its solutions
  constexpr Index width = 256;
  const Index panels = n / width + 1;
  std::vector<SparseOutcome> outcomes(static_cast<std::size_t>(panels));
  normal.executor.for_ranges(panels, [&](Index from, Index to) {
    for (Index k = from; k < to; ++k)
      outcomes[static_cast<std::size_t>(k)] =
          solve(out.local, VERNIER_LATER(out.eliminated).middleCols(k * width, (std::min)(width, n + 1 - k * width)));
  });
  if (!outcomes.front().solved) return {};
  out.log_determinant = outcomes.front().log_determinant;
  detail::add_transposed_product(out.gradient, normal.coupling, VERNIER_LATER(out.eliminated).col(0), -1);
  detail::visit_panels(normal.executor, n, 64, [&](Index first, Index count) {
    detail::add_transposed_product(VERNIER_LATER(out.matrix).block(first, first, n - first, count),
                                   VERNIER_LATER(normal.coupling).rightCols(n - first),
                                   VERNIER_LATER(out.eliminated).middleCols(1 + first, count), -1);
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
  const double least = 1e-12 * VERNIER_LATER(of_data).maxCoeff();
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
  local_step_ = VERNIER_LATER(reduced_->eliminated).col(0);
  detail::add_product(local_step_, VERNIER_LATER(reduced_->eliminated).rightCols(n), step_);
  local_step_ *= -1;
}

VERNIER_IMPL double FactorisedEquations::log_determinant() const {
  return detail::cholesky_log_determinant(factor_) + (reduced_ == nullptr ? 0 : reduced_->log_determinant);
}

VERNIER_IMPL MatrixX FactorisedEquations::reduced() const {
  MatrixX out = reduced_ == nullptr ? normal_->matrix : reduced_->matrix;
  for (Index j = 0; j < out.cols(); ++j)
    for (Index i = j + 1; i < out.rows(); ++i) out(j, i) = out(i, j);
  return out;
}

VERNIER_IMPL MatrixX FactorisedEquations::inverse() const { return detail::inverse_from_cholesky(factor_); }

VERNIER_IMPL VectorX FactorisedEquations::inverse_diagonal() const {
  // columns of the inverse factor start at their own row
  const Index n = factor_.rows();
  VectorX out(n);
  detail::visit_panels(executor(), n, 64, [&](Index first, Index count) {
    MatrixX columns = MatrixX::Identity(n - first, count);
    detail::solve_lower(VERNIER_LATER(factor_).bottomRightCorner(n - first, n - first), columns);
    VERNIER_LATER(out).segment(first, count) = detail::squared_column_norms(columns);
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

VERNIER_IMPL MatrixX FactorisedEquations::local_covariances(const std::vector<RowBlock>& blocks) const {
  MatrixX columns = MatrixX::Zero(reduced_->local.size, 6 * static_cast<Index>(blocks.size()));
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (const RowBlock::Local& local : blocks[b].local)
      for (Index j = 0; local.state >= 0 && j < local.columns.cols(); ++j)
        for (Index r = 0; r < 6; ++r)
          columns(local.state * local.columns.cols() + j, 6 * static_cast<Index>(b) + r) = local.columns(r, j);
  solve_(reduced_->local, columns);
  return columns;
}

VERNIER_IMPL MatrixX FactorisedEquations::local_gains(const std::vector<RowBlock>& blocks) const {
  MatrixX out = MatrixX::Zero(6, 6 * static_cast<Index>(blocks.size()));
  if (reduced_ == nullptr) return out;
  const MatrixX columns = local_covariances(blocks);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (const RowBlock::Local& local : blocks[b].local)
      for (Index c = 6 * static_cast<Index>(b); local.state >= 0 && c < 6 * static_cast<Index>(b + 1); ++c)
        detail::add_columns(local.columns, &columns(local.state * local.columns.cols(), c), 1, &out(0, c));
  return out;
}

VERNIER_IMPL MatrixX FactorisedEquations::joint_local_gains(const std::vector<RowBlock>& blocks) const {
  MatrixX out = MatrixX::Zero(6 * static_cast<Index>(blocks.size()), 6 * static_cast<Index>(blocks.size()));
  if (reduced_ == nullptr) return out;
  const MatrixX columns = local_covariances(blocks);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (const RowBlock::Local& local : blocks[b].local)
      for (Index c = 0; local.state >= 0 && c < out.cols(); ++c)
        detail::add_columns(local.columns, &columns(local.state * local.columns.cols(), c), 1,
                            &out(6 * static_cast<Index>(b), c));
  return out;
}

}  // namespace vernier
