#pragma once

/// @file
/// From measured poses to everything known of a real arm: identification, then an error model on top of it.

#include <span>
#include <vector>

#include "vernier/ceres/identify.hpp"
#include "vernier/identification/fit_error_model.hpp"
#include "vernier/identification/stations.hpp"

namespace vernier {

/// Options of `calibrate`.
struct CalibrateOptions {
  /// Of the geometric identification. Its sigmas, loss and use of orientations are those of `errors`.
  IdentifyOptions geometry{.frames = Frames::base_and_tool};
  /// Of the joint errors.
  ErrorModelOptions errors{};
};

/// An identified arm, and the error model fitted on top of it.
template <class Chain>
struct Calibration {
  Identified<Chain> geometry;      ///< frames and geometry alone, stations brought into the frame of the first
  FittedErrorModel<Chain> errors;  ///< everything together

  /// The best model there is, of the first station.
  const ErrorModel<Chain>& model() const { return errors.model(); }
};

namespace detail {

/// `calibrate`, given how the geometry is identified: from poses alone, so that whoever has no distances does not pay
/// for compiling what reads them.
template <int N, class Convention, class IdentifyGeometry>
Calibration<DhChain<N, Convention>> calibrate_with(const DhChain<N, Convention>& nominal,
                                                   std::span<const Dataset<N>> stations,
                                                   std::span<const Distances<N>> distances, CalibrateOptions options,
                                                   PriorSearch search, const IdentifyGeometry& identify_geometry) {
  require(stations.size() + distances.size() > 0, "calibrate: no stations");
  options.geometry.position_sigma = stations.empty() ? options.errors.distance_sigma : options.errors.position_sigma;
  options.geometry.orientation_sigma = options.errors.orientation_sigma;
  options.geometry.loss = options.errors.loss;
  options.geometry.use_orientations = options.errors.use_orientations;
  std::vector<Isometry3> bases;
  if (stations.size() > 1) {
    IdentifyOptions frames = options.geometry;
    frames.geometry = false;
    for (const auto& data : stations) bases.push_back(identify(nominal, data, frames).model.actual().base());
  }
  Identified<DhChain<N, Convention>> geometry = identify_geometry(bases, options.geometry);
  FittedErrorModel<DhChain<N, Convention>> errors =
      fit_error_model(geometry, stations, distances, options.errors, search);
  return {std::move(geometry), std::move(errors)};
}

}  // namespace detail

/// Calibrates an arm from poses measured from one place or several: identifies geometry and frames (Ceres), then fits
/// geometry, frames and joint errors together. Blocks that the data do not support are left out.
/// @param nominal  the arm as designed
/// @param stations measured poses, one set a place of the sensor
/// @param options  of both steps
/// @param search   of priors, see `fit_error_model`
/// @throws std::invalid_argument on an unusable option or no poses, never for poor data: see the statuses
template <int N, class Convention>
Calibration<DhChain<N, Convention>> calibrate(const DhChain<N, Convention>& nominal,
                                              std::span<const Dataset<N>> stations,
                                              const CalibrateOptions& options = {}, PriorSearch search = {}) {
  return detail::calibrate_with(nominal, stations, std::span<const Distances<N>>(), options, search,
                                [&](const std::vector<Isometry3>& bases, const IdentifyOptions& geometry) {
                                  return identify(nominal, in_one_frame(stations, bases, geometry.use_orientations),
                                                  geometry);
                                });
}

/// The same from poses and distances.
/// @param nominal   the arm as designed
/// @param stations  measured poses, one set a place of the sensor; may be empty
/// @param distances measured distances, one set a fixed point; they count in the second step, in both where there are
/// no
///                  poses. Then frames are those of the first fixed point, see `identify`
/// @param options   of both steps
/// @param search    of priors, see `fit_error_model`
template <int N, class Convention>
Calibration<DhChain<N, Convention>> calibrate(const DhChain<N, Convention>& nominal,
                                              std::span<const Dataset<N>> stations,
                                              std::span<const Distances<N>> distances,
                                              const CalibrateOptions& options = {}, PriorSearch search = {}) {
  return detail::calibrate_with(nominal, stations, distances, options, search,
                                [&](const std::vector<Isometry3>& bases, const IdentifyOptions& geometry) {
                                  if (stations.empty()) return identify(nominal, distances.front(), geometry);
                                  return identify(nominal, in_one_frame(stations, bases, geometry.use_orientations),
                                                  geometry);
                                });
}

/// The same from one station.
template <int N, class Convention>
Calibration<DhChain<N, Convention>> calibrate(const DhChain<N, Convention>& nominal, const Dataset<N>& data,
                                              const CalibrateOptions& options = {}) {
  return calibrate(nominal, std::span<const Dataset<N>>(&data, 1), options);
}

}  // namespace vernier
