// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The evidence (marginal likelihood) of a linearised least-squares problem, by which the sizes of priors are chosen.

#include <vector>

#include "vernier/least_squares/factorised_equations.hpp"

namespace vernier {

/// Values that the stated accuracy of the sensor counts as, in the variance of the noise: as many as ten positions.
inline constexpr double sensor_values = 30;

/// Logarithm of the evidence of priors, up to a constant, over all variances of the whitened noise. The prior of that
/// variance is the scaled inverse chi-square distribution of `sensor_values` around one, the sensor's: a model that
/// fits a few poses exactly is not taken for one whose measurements have no noise.
/// @param normal      the problem
/// @param solved      the same with these priors
/// @param precisions  of the priors; 0 for unknowns without
/// @param steps       present values of the unknowns, relative to the means of the priors
/// @param values      number of measured values
/// @param local_steps present values of local unknowns, likewise
/// @return            minus infinity where there is no solution
/// @cite MacKay 1992; Gelman 2013 (3.3, the prior of a variance)
VERNIER_API double log_evidence(const NormalEquations& normal, const FactorisedEquations& solved,
                                const VectorX& precisions, const VectorX& steps, Index values,
                                const VectorX& local_steps = {});

/// Some unknowns whose priors have one common factor.
using UnknownGroup = std::vector<Index>;

/// The common factor, on a grid, under which the priors of a group have most evidence.
/// @param normal      the problem
/// @param precisions  of all priors; those of the group are the expected ones
/// @param steps       present values of the unknowns, relative to the means of the priors
/// @param values      number of measured values
/// @param group       whose precisions are multiplied
/// @param local_steps present values of local unknowns, likewise
/// @return            precisions with those of the group multiplied
VERNIER_API VectorX scale_priors(const NormalEquations& normal, const VectorX& precisions, const VectorX& steps,
                                 Index values, const UnknownGroup& group, const VectorX& local_steps = {});

/// The factors under which priors of several groups have most evidence, by fixed-point iteration.
/// @param normal      the problem
/// @param precisions  of all priors, where to start
/// @param steps       present values of the unknowns, relative to the means of the priors
/// @param values      number of measured values
/// @param groups      disjoint
/// @param iterations  number of iterations, each a factorisation and the diagonal of an inverse
/// @param local_steps present values of local unknowns, likewise
/// @return            precisions with those of each group multiplied
/// @cite MacKay 1992
VERNIER_API VectorX learn_priors(const NormalEquations& normal, VectorX precisions, const VectorX& steps, Index values,
                                 const std::vector<UnknownGroup>& groups, int iterations,
                                 const VectorX& local_steps = {});

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/evidence.ipp"
#endif
