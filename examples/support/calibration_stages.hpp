#pragma once

/// @file
/// The two expensive steps of a calibration, compiled once for all numbers of joints, each in a file of its own.

#include "vernier/compensation/joint_range_gate.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/dh_chain.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace support {

/// `vernier::identify`, N = 3 to 9.
template <int N>
vernier::Identified<vernier::DhChain<N>> identify_arm(const vernier::DhChain<N>& nominal,
                                                      const vernier::Dataset<N>& data,
                                                      const vernier::IdentifyOptions& options);

/// A learned position error, and where it holds.
template <int N>
struct LearnedError {
  vernier::ElmPredictor<N, 3> predictor;
  vernier::JointRangeGate<N> gate;
};

/// Generations of the swarm in `learn_residual`.
inline constexpr vernier::Index swarm_generations = 20;

/// A PSO-ELM of what an identified arm leaves, by leave-one-out error; the mean alone is among the candidates, so where
/// nothing is left to learn nothing is learned. N = 3 to 9.
template <int N>
LearnedError<N> learn_residual(const vernier::Calibrated<vernier::DhChain<N>>& model, const vernier::Dataset<N>& data,
                               const vernier::FitOptions& options);

}  // namespace support
