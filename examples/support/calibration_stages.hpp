#pragma once

/// @file
/// The expensive steps of a calibration, compiled once for all numbers of joints, each in a file of its own.

#include <span>

#include "vernier/core/fit_options.hpp"
#include "vernier/identification/fit_error_model.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace support {

/// `vernier::identify`, for the numbers of joints in dispatch.hpp, as all below.
template <int N>
vernier::Identified<vernier::DhChain<N>> identify_arm(const vernier::DhChain<N>& nominal,
                                                      const vernier::Dataset<N>& data,
                                                      const vernier::IdentifyOptions& options);

/// `vernier::fit_error_model`.
template <int N>
vernier::FittedErrorModel<vernier::DhChain<N>> fit_errors(const vernier::Identified<vernier::DhChain<N>>& start,
                                                          std::span<const vernier::Dataset<N>> stations,
                                                          std::span<const vernier::Distances<N>> distances,
                                                          const vernier::ErrorModelOptions& options,
                                                          vernier::PriorSearch search);

/// Generations of `search_priors`.
inline constexpr vernier::Index prior_generations = 15;

/// Priors by a swarm (or a genetic algorithm): 20 individuals.
vernier::VectorX search_priors(const vernier::PriorObjective& objective, const vernier::Box& box, bool genetic,
                               const vernier::FitOptions& options);

/// A learned position error, and where it holds.
template <int N>
struct LearnedError {
  vernier::ElmPredictor<N, 3> predictor;
  vernier::JointCoverage<N> gate;
};

/// Generations of the swarm in `learn_residual`.
inline constexpr vernier::Index swarm_generations = 20;

/// A PSO-ELM of what a model leaves, by leave-one-out error; the mean alone is among the candidates, so where nothing
/// is left to learn nothing is learned.
template <int N>
LearnedError<N> learn_residual(const vernier::ErrorModel<vernier::DhChain<N>>& model, const vernier::Dataset<N>& data,
                               const vernier::FitOptions& options);

}  // namespace support
