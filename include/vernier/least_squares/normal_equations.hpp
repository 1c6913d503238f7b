// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Normal equations of a least-squares problem in blocks, dense with a sparse part for local states.
///
/// A factored unknown acts through one vector of its group: its columns are `factor_j h_k`. So the rows of a block
/// enter the sums as one row weighted by `factor_i' factor_j`: a sixth of the work, and memory that does not grow with
/// the number of blocks.

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
  /// @param same_functions equations of the same blocks with the same factored unknowns and other dense ones: the sums
  ///                       of factored unknowns alone, nearly all of the work, are copied from them. Null for none;
  ///                       without a `JointPrior`
  /// @throws std::invalid_argument where these have fewer unknowns, or such a prior
  /// @complexity O(blocks u^2 / 6) for u unknowns, memory O(u^2)
  VERNIER_API explicit NormalEquations(const BlockSystem& system, const std::vector<LocalPrior>& local_priors = {},
                                       ExecutorRef executor = {}, const NormalEquations* same_functions = nullptr);

  /// Adds a prior with correlations to matrix, gradient and cost, as if it were measurements.
  /// @param joint the prior
  /// @param steps present values of dense and factored unknowns
  VERNIER_API void add(const JointPrior& joint, const VectorX& steps);
};

/// `z' P z` for present values of local unknowns and the precisions P of their priors; 0 without local states.
VERNIER_API double local_prior_cost(const NormalEquations& normal, const VectorX& local_steps);
/// Slope of the cost (half its derivative) along a step of the local unknowns.
VERNIER_API double local_gain(const NormalEquations& normal, const VectorX& step, const VectorX& local_steps);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/normal_equations.ipp"
#endif
