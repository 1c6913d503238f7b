#pragma once

/// @file
/// A calibrated arm: every step of the pipeline with its result.

#include <optional>
#include <string>
#include <vector>

#include "vernier/compensation/cartesian.hpp"
#include "vernier/error_model/fitted_error_model.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/identification/sensor_model.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// A position error learned on top of a model, and where it is valid.
template <int N>
struct LearnedRemainder {
  ElmPredictor<N, 3> predictor;  ///< of the position error [m], base frame
  JointCoverage<N> coverage;     ///< the measured joint ranges

  /// Whether anything was learned: leave-one-out errors may prefer the mean alone, or nothing.
  bool empty() const { return predictor.beta().isZero(0); }
};

/// Everything that `calibrate` found.
template <class C>
struct Calibration {
  /// The kind of chain.
  using Chain = C;
  /// Number of joints.
  static constexpr int dof = Chain::dof;

  std::vector<Calibrated<Chain>> frames;  ///< the nominal chain in registered frames, one a station of poses
  Identified<Chain> geometry;             ///< frames and geometry alone, stations joined in the frame of the first
  FittedErrorModel<Chain> errors;         ///< geometry and joint errors together
  std::optional<LearnedRemainder<dof>> geometry_remainder{};  ///< learned on geometry alone, the classical alternative
  std::optional<LearnedRemainder<dof>> remainder{};           ///< learned on the error model
  JointCoverage<dof> coverage{};                              ///< measured joint ranges
  Index poses = 0;                                            ///< number of poses it was fitted to
  Index distances = 0;                                        ///< number of distances it was fitted to
  bool oriented = false;                                      ///< whether orientations were used
  SensorModel sensors{};                                      ///< as given
  Index outliers = 0;                                         ///< poses whose error exceeds eight times the median
  double median_error = 0;  ///< median position error of the poses it was fitted to [m]
  double fit_seconds = 0;   ///< time from poses to error model

  /// The error model of the first station, without learned remainder.
  const ErrorModel<Chain>& model() const { return errors.model(); }
};

}  // namespace vernier
