// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What measurements would say about the unknowns of an error model, before any is made.

#include "vernier/error_model/error_model_options.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/measurements/sensor_model.hpp"
#include "vernier/planning/detail/candidate_rows.hpp"

namespace vernier::detail {

/// What is to be calibrated, and how it is measured.
struct PlannedCalibration {
  ArmGeometry nominal;
  IdentifyOptions geometry;
  ErrorModelOptions errors;
  SensorModel sensors;
  bool oriented;       ///< whether orientations are measured
  Index measurements;  ///< how many there will be: decides on orders of harmonics
};

/// Whitened rows of all unknowns that `fit_error_model` would have, in units of their prior sizes: three a pose, or
/// six. Frames are all but free.
/// @param joints   n x joints [rad, m]
/// @param previous from which they are approached, likewise; no rows, or not finite, where unknown
/// @param observer told every 64 poses
/// @throws PlanningStopped where the observer requests a stop
VERNIER_API CandidateRows expected_candidate_rows(const PlannedCalibration& planned, const ConstMatrixRef& joints,
                                                  const ConstMatrixRef& previous, const ObserverRef& observer = {});

/// Those rows as one matrix, a column an unknown.
VERNIER_API MatrixX expected_rows(const PlannedCalibration& planned, const ConstMatrixRef& joints,
                                  const ConstMatrixRef& previous, const ObserverRef& observer = {});

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/planning/detail/expected_rows.ipp"
#endif
