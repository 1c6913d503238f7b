// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whether unknowns that a model lacks exist: a score test by sign flips, which needs the fit without them alone.

#include <cstdint>
#include <vector>

#include "vernier/least_squares/evidence.hpp"

namespace vernier {

/// Unknowns that are not in a model, as the data see them. Directions are combinations of them whose estimates are
/// uncorrelated. They count in expected sizes, the units of the unknowns.
struct ScoreTest {
  double p = 1;  ///< probability of scores at least as large, if all of these unknowns are zero
  /// Of each direction, descending: by how much the sum of whitened squares grows with one expected size of it, less
  /// what the other unknowns take over.
  VectorX information{};
  VectorX estimates{};  ///< of each direction, by least squares
  VectorX variances{};  ///< of the estimates; positions and other values each have a noise of their own
  double noise = 1;     ///< variance of the whitened residuals, as the flipped scores have it
  /// Mean squared displacement of the measured positions, less what the other unknowns take over: a quadratic form of
  /// the directions [m^2].
  MatrixX displacement{};
  std::vector<Index> tested{};  ///< unknowns, of many those of which the data tell most
  MatrixX directions{};         ///< tested x directions: combinations of unknowns, which are orthonormal
};

/// Precision that is added to the information of each direction where scores are weighted by its inverse: of effects of
/// a third of the expected sizes no other weights find more.
inline constexpr double score_precision = 10;

/// Tests whether some unknowns are zero. The score of a pose is what it contributes to their gradient, at the minimum
/// without them and less what the other unknowns take over. If they are zero, the sign of each score is as likely as
/// the opposite one. So the weighted square of their sum is compared with those of flipped signs. That holds for any
/// symmetric noise, whatever its variance at each pose. The noise is the residual of each pose under a model with the
/// unknowns that was fitted without its cluster, so no large effect changes it. If the unknowns are many, such a
/// residual is larger than the noise of the measurements. The mean product of a residual left out and as fitted is the
/// variance of that noise, if it is equal at all poses. Variances of estimates are made of such products.
/// @param system,normal the problem; the unknowns in question have columns
/// @param precisions    of independent priors of all unknowns, those of the group as their evidence suggests
/// @param steps         present values of the unknowns, relative to the means of the priors
/// @param group         the unknowns in question; of many, the 400 of which the data tell most
/// @param clusters      of each block: those of equal number are not independent; empty: each is on its own
/// @param local_steps   present values of local unknowns, likewise
/// @param draws         number of random arrangements of signs; fewer where p is obviously large
/// @return              p = 1 and nothing else where the equations have no solution
/// @complexity O(draws blocks m) for m of the group, beside two factorisations
/// @cite Hemerik 2020 (signs of scores); De Santis 2022 (leverage)
VERNIER_API ScoreTest score_test(const BlockSystem& system, const NormalEquations& normal, const VectorX& precisions,
                                 const VectorX& steps, const UnknownGroup& group,
                                 const std::vector<Index>& clusters = {}, const VectorX& local_steps = {},
                                 Index draws = 1999);
/// The same of equations that are factorised, which saves two factorisations.
/// @param with    solved with `precisions`
/// @param without solved with the group held at zero, by `suppressing_precision`
VERNIER_API ScoreTest score_test(const BlockSystem& system, const FactorisedEquations& with,
                                 const FactorisedEquations& without, const VectorX& precisions, const VectorX& steps,
                                 const UnknownGroup& group, const std::vector<Index>& clusters = {},
                                 Index draws = 1999);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/score_test.ipp"
#endif
