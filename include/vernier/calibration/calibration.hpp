#pragma once

/// @file
/// A calibrated arm: every step of the pipeline with its result.

#include <optional>
#include <span>
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
  std::optional<LearnedRemainder<dof>> remainder{};           ///< learned on the error model, without hysteresis
  bool remainder_supported = false;                           ///< whether cross-validation supports that remainder
  JointCoverage<dof> coverage{};                              ///< measured joint ranges
  Index poses = 0;                                            ///< number of poses it was fitted to
  Index distances = 0;                                        ///< number of distances it was fitted to
  bool oriented = false;                                      ///< whether orientations were used
  SensorModel sensors{};                                      ///< as given
  Index outliers = 0;                                         ///< poses whose error exceeds eight times the median
  double median_error = 0;  ///< median position error of the poses it was fitted to [m]
  double fit_seconds = 0;   ///< time from poses to error model

  /// The key of the last stage that left-out poses support: the one that is deployed. See `StageErrors`.
  const char* chosen() const {
    if (remainder_supported) return "jointwise_pso_elm";
    const char* out = "geometry";
    for (const BlockChoice& block : errors.blocks)
      for (const char* stage : {"elastic", "jointwise", "approach", "tilt", "temperature", "prior"})
        if (block.used && block.name == stage) out = stage;
    return out;
  }
  /// The error model of the first station, without learned remainder.
  const ErrorModel<Chain>& model() const { return errors.model(); }
};

namespace detail {

/// The model at the temperature of a row; unchanged where that is unknown.
template <class Chain>
ErrorModel<Chain> at_temperature_of(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data, Index row) {
  return data.temperatures().size() > 0 ? model.at_temperature(data.temperatures()(row)) : model;
}

/// Poses as they would have been measured at the mean temperature, in the middle of both directions of approach.
template <class Chain>
Dataset<Chain::dof> without_hysteresis(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data) {
  const bool thermal = model.thermal() != nullptr && data.temperatures().size() > 0;
  if (!thermal && model.identified().model().joint_errors().terms().hysteresis.empty()) return data;
  PointRows positions = data.positions();
  for (Index i = 0; i < data.size(); ++i) {
    const JointVector<Chain::dof> q = data.joints(i);
    const auto visit = [&](const ErrorModel<Chain>& now) {
      return Vector3(now.approached_from(data.previous().row(i).transpose()).position(q));
    };
    positions.row(i) -=
        ((thermal ? visit(at_temperature_of(model, data, i)) : visit(model)) - model.position(q)).transpose();
  }
  return Dataset<Chain::dof>(data.joints(), positions).without_approach();
}
/// The same for every station.
template <class Chain>
std::vector<Dataset<Chain::dof>> without_hysteresis(const std::vector<ErrorModel<Chain>>& models,
                                                    std::span<const Dataset<Chain::dof>> stations) {
  std::vector<Dataset<Chain::dof>> out;
  for (std::size_t s = 0; s < stations.size(); ++s) out.push_back(without_hysteresis(models[s], stations[s]));
  return out;
}

}  // namespace detail

}  // namespace vernier
