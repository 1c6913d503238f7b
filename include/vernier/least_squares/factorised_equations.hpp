// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Normal equations with priors, solved: Gauss-Newton steps, covariances, log determinants. Local states are eliminated
/// by a Schur complement; what remains is dense.

#include <memory>
#include <utility>

#include "vernier/least_squares/normal_equations.hpp"

namespace vernier {

/// Normal equations with priors, factorised. Unknowns that nothing determines stay at their values.
class FactorisedEquations {
 public:
  /// @param normal      must outlive this, unchanged
  /// @param precisions  of independent priors of dense and factored unknowns
  /// @param steps       present values, relative to the means of the priors
  /// @param local_steps present values of local unknowns, likewise
  /// @param solve       for the local unknowns; must outlive this
  /// @param damping     of the step, a share of the diagonal of dense and factored unknowns; 0 where the inverse is to
  ///                    be a covariance
  VERNIER_API FactorisedEquations(const NormalEquations& normal, const VectorX& precisions, const VectorX& steps,
                                  const VectorX& local_steps = {}, SparseSolve solve = eigen_sparse_solver,
                                  double damping = 0);

  FactorisedEquations(NormalEquations&&, const VectorX&, const VectorX&, const VectorX& = {},
                      SparseSolve = eigen_sparse_solver, double = 0) = delete;

  /// The undamped solution with other priors of dense and factored unknowns: local ones are not eliminated again.
  VERNIER_API FactorisedEquations with(const VectorX& precisions, const VectorX& steps) const;

  /// Whether there is a solution.
  bool usable() const { return usable_; }
  /// Gauss-Newton step of dense and factored unknowns.
  const VectorX& step() const { return step_; }
  /// Gauss-Newton step of local unknowns.
  const VectorX& local_step() const { return local_step_; }
  /// log determinant of the whole matrix.
  VERNIER_API double log_determinant() const;
  /// The matrix of dense and factored unknowns, both triangles: local unknowns eliminated, priors of the others left
  /// out.
  VERNIER_API MatrixX reduced() const;
  /// Inverse of the matrix with local unknowns eliminated: the covariance of dense and factored unknowns.
  VERNIER_API MatrixX inverse() const;
  /// Its diagonal, at a third of the cost.
  VERNIER_API VectorX inverse_diagonal() const;
  /// Multiplies by the inverse of the Cholesky factor of that matrix, in place.
  VERNIER_API void apply_inverse_factor(MatrixRef columns) const;

  /// Rows of a block with local states eliminated.
  /// @param block the block
  /// @param rows  6 x unknowns, as expanded; then less what local states explain
  VERNIER_API void eliminate_local(const RowBlock& block, Rows6& rows) const;
  /// Covariances of the rows of blocks by local states alone: 6 x 6 of each block, side by side.
  VERNIER_API MatrixX local_gains(const std::vector<RowBlock>& blocks) const;
  /// Covariance of all rows of blocks by local states alone, with that between blocks: six rows and columns a block.
  VERNIER_API MatrixX joint_local_gains(const std::vector<RowBlock>& blocks) const;

  /// That of the normal equations.
  ExecutorRef executor() const { return normal_->executor; }

 private:
  /// Covariance of local unknowns with the rows of blocks: local unknowns x six a block.
  VERNIER_API MatrixX local_covariances(const std::vector<RowBlock>& blocks) const;
  /// Normal equations of dense and factored unknowns, local ones eliminated.
  struct Reduced {
    MatrixX matrix;         // lower triangle
    VectorX gradient;       // with the priors of local unknowns
    SparseSymmetric local;  // with priors
    MatrixX eliminated;     // inverse of the local part times its gradient and the coupling, side by side
    double log_determinant = 0;
  };

  FactorisedEquations(const NormalEquations& normal, std::shared_ptr<const Reduced> reduced, SparseSolve solve)
      : normal_(&normal), solve_(solve), reduced_(std::move(reduced)) {}
  /// Nothing where the local part is not positive definite.
  VERNIER_API static std::shared_ptr<const Reduced> eliminate(const NormalEquations& normal, const VectorX& local_steps,
                                                              SparseSolve solve);
  VERNIER_API void factorise(const VectorX& precisions, const VectorX& steps, double damping);

  const NormalEquations* normal_;
  SparseSolve solve_;
  std::shared_ptr<const Reduced> reduced_{};  // with local unknowns
  MatrixX factor_{};                          // lower triangle
  VectorX step_{}, local_step_{};
  bool usable_ = false;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/factorised_equations.ipp"
#endif
