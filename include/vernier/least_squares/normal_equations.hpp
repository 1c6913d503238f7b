#pragma once

/// @file
/// Normal equations of a least-squares problem in blocks, dense with a sparse part for local states; Gauss-Newton steps
/// and leave-one-block-out errors.
///
/// A factored unknown acts through one vector of its group: its columns are `factor_j h_k`. So the rows of a block
/// enter the sums as one row weighted by `factor_i' factor_j`: a sixth of the work, and memory that does not grow with
/// the number of blocks. Local states are eliminated by a Schur complement; what remains is dense.

#include <memory>
#include <utility>
#include <vector>

#include "vernier/core/executor.hpp"
#include "vernier/least_squares/row_block.hpp"
#include "vernier/least_squares/sparse_solve.hpp"

namespace vernier {

/// A Gaussian prior that couples two local states (or one with itself): adds `z_first' precision z_second`, and its
/// transpose where they differ, to the exponent's quadratic form.
struct LocalPrior {
  Index first;        ///< a state
  Index second;       ///< a state
  MatrixX precision;  ///< local_size x local_size
};

/// A Gaussian prior of all dense and factored unknowns together, with correlations.
struct JointPrior {
  MatrixX precision;  ///< unknowns x unknowns, both triangles; rows of unknowns without prior are zero
  VectorX mean;       ///< values of the unknowns in steps; zero for those without prior
  Index unknowns;     ///< number of those with a prior

  /// Twice the negative logarithm of its density, up to a constant.
  VERNIER_API double cost(const VectorX& steps) const;
};

/// J'J and J'r of all blocks, independent priors apart.
struct NormalEquations {
  MatrixX matrix;               ///< of dense and factored unknowns, both triangles
  VectorX gradient;             ///< of dense and factored unknowns
  double cost = 0;              ///< r'r
  MatrixX coupling;             ///< local unknowns x the others
  VectorX local_gradient;       ///< of local unknowns
  SparseSymmetric local;        ///< of local unknowns
  SparseSymmetric local_prior;  ///< precisions of local unknowns, same pattern
  MatrixX prior{};              ///< precision of a `JointPrior` that was added; empty for none
  Index prior_unknowns = 0;     ///< number of unknowns with such a prior
  ExecutorRef executor{};       ///< computes these sums and what follows from them; must outlive this

  /// Sums over all blocks; the bits do not depend on the executor.
  /// @complexity O(blocks u^2 / 6) for u unknowns, memory O(u^2)
  VERNIER_API explicit NormalEquations(const BlockSystem& system, const std::vector<LocalPrior>& local_priors = {},
                                       ExecutorRef executor = {});

  /// Adds a prior with correlations to matrix, gradient and cost, as if it were measurements.
  /// @param joint the prior
  /// @param steps present values of dense and factored unknowns
  VERNIER_API void add(const JointPrior& joint, const VectorX& steps);
};

/// `z' P z` for present values of local unknowns and the precisions P of their priors; 0 without local states.
VERNIER_API double local_prior_cost(const NormalEquations& normal, const VectorX& local_steps);
/// Slope of the cost (half its derivative) along a step of the local unknowns.
VERNIER_API double local_gain(const NormalEquations& normal, const VectorX& step, const VectorX& local_steps);

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

  /// The same, undamped, with other priors of dense and factored unknowns: local ones are not eliminated again.
  VERNIER_API FactorisedEquations with(const VectorX& precisions, const VectorX& steps) const;

  /// Whether there is a solution.
  bool usable() const { return usable_; }
  /// Gauss-Newton step of dense and factored unknowns.
  const VectorX& step() const { return step_; }
  /// Gauss-Newton step of local unknowns.
  const VectorX& local_step() const { return local_step_; }
  /// log determinant of the whole matrix.
  VERNIER_API double log_determinant() const;
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

  /// That of the normal equations.
  ExecutorRef executor() const { return normal_->executor; }

 private:
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

/// Validation blocks left out one at a time.
struct LeftOutBlocks {
  Eigen::Matrix3Xd errors;  ///< of positions, a column a block [m]; infinite where there is no solution
  /// Log predictive densities: of each block's measured values, predicted by all others, up to a constant [nat]. The
  /// variance of the whitened noise has its most likely value for these blocks. Not finite where there is no solution.
  VectorX log_densities;
};

/// Predicts blocks from all others, in closed form, at the solution of the linearised problem with given priors: the
/// whitened error is `e_b = (I - H_bb)^-1 r_b`, its covariance that of the noise times `(I - H_bb)^-1`.
/// @param system the problem
/// @param solved its normal equations with priors
/// @param stride every stride-th of the validation blocks is left out
/// @return       ceil(validation_blocks / stride) blocks
/// @cite Allen 1974; Vehtari 2017 (log predictive densities)
VERNIER_API LeftOutBlocks leave_one_out(const BlockSystem& system, const FactorisedEquations& solved, Index stride);

/// Position errors of `leave_one_out`, 3 x ceil(validation_blocks / stride) [m].
VERNIER_API Eigen::Matrix3Xd leave_one_out_errors(const BlockSystem& system, const FactorisedEquations& solved,
                                                  Index stride);

namespace detail {

/// Norm of the position error of each block [m].
VERNIER_API VectorX error_norms(const Eigen::Matrix3Xd& errors);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/normal_equations.ipp"
#endif
