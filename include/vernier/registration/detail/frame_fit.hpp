// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The least-squares fit behind a re-registration: base, joint zeros, tool and probe, with weights from the residuals.

#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/measurements/measured_set.hpp"
#include "vernier/registration/frame_update.hpp"

namespace vernier::detail {

/// Modelled poses of all samples after a motion, and the geometric Jacobians, 6 x joints each, side by side.
using MovedPoses = FunctionRef<void(const FrameMotion& motion, std::vector<Isometry3>& poses, MatrixX& jacobians)>;

/// A fit of frames at its present values.
struct FrameFit {
  FrameUpdate update;                 ///< the unknowns
  VectorX prior_std;                  ///< of each unknown, mean 0; infinite for none
  FrameMotion motion;                 ///< where it starts, and what it found
  double position_sigma;              ///< of a position, per component [m]
  double orientation_sigma;           ///< of an orientation, per component [rad]
  VectorX total;                      ///< change of the unknowns against the means of their priors
  MatrixX held{};                     ///< columns: directions of the unknowns that stay at the means of their priors
  MatrixX covariance{};               ///< of the unknowns; empty where they are not determined
  double position_squares = 0;        ///< sum of squares of whitened position residuals
  double orientation_squares = 0;     ///< the same of orientations
  double position_redundancy = 0;     ///< number of position values less what the unknowns took of them
  double orientation_redundancy = 0;  ///< the same of orientations
  bool determined = false;            ///< whether poses and priors determine all unknowns
  bool converged = false;             ///< whether the iteration converged
  std::vector<Isometry3> poses{};     ///< as modelled after the motion

  /// Covariance of some unknowns that follow each other.
  VERNIER_API MatrixX covariance_of(Index begin, Index count) const {
    return covariance.block(begin, begin, count, count);
  }
};

/// Solves for the unknowns, weights as given.
VERNIER_API void solve_frames(const MovedPoses& evaluate, const MeasuredSet& data, FrameFit& fit);

/// Solves, with the standard deviations of positions and of orientations estimated from their residuals: the model has
/// errors of its own, which a sensor's accuracy does not know. Never below those of the sensor.
/// @cite Foerstner 1979
VERNIER_API void solve_frames_and_weights(const MovedPoses& evaluate, const MeasuredSet& data, FrameFit& fit);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/registration/detail/frame_fit.ipp"
#endif
