#pragma once

/// @file
/// The calibration pipeline: from measurements to everything known of a real arm. It starts with `identify`, so it
/// needs the component `ceres`: include vernier/ceres.hpp.

#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/calibration/calibration.hpp"
#include "vernier/calibration/detail/plausibility.hpp"
#include "vernier/calibration/learn_remainders.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/evaluation/statistics.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/identification/stations.hpp"

namespace vernier {

/// Options of `calibrate`.
struct CalibrateOptions {
  IdentifyOptions geometry{.frames = Frames::base_and_tool};  ///< of the geometric identification
  ErrorModelOptions errors{};                                 ///< of the joint errors
  SensorModel sensors{};                                      ///< of all measurements, for every step
  RemainderOptions remainder{};                               ///< of what is learned on top
  bool refuse_implausible = true;    ///< throw for data that do not fit the arm, or do not support a calibration
  std::string arm_name = "the arm";  ///< how messages name the arm
  std::vector<std::string> station_names{};   ///< how messages name the stations; by default "station 1", ...
  std::vector<std::string> distance_names{};  ///< how messages name the sets of distances; "distances 1", ...
};

namespace detail {

/// A given name, or `what` and a number.
inline std::string name_of(const std::vector<std::string>& names, std::size_t k, const char* what) {
  return k < names.size() ? names[k] : message(what, ' ', k + 1);
}

}  // namespace detail

/// Calibrates an arm: registers every station, identifies geometry and frames, fits geometry, frames and joint errors
/// together, and learns the remainder. Whatever leave-one-out errors do not support is left out.
/// @param arm       the arm as designed; its frames are where base and tool are assumed, and stay where they are known
/// @param stations  measured poses, one set a place of the sensor; may be empty
/// @param distances measured distances, one set a fixed point; in the error model beside poses, in both steps without
/// @param options   of all steps
/// @param fit       seed and observer of what is learned, executor of that and of the error model
/// @param search    of priors, see `fit_error_model`
/// @param contacts  what the tool point of the poses touched; enters the error model, beside poses only
/// @throws std::invalid_argument on an unusable option or no measurements, or contacts without poses
/// @throws CalibrationFailure for data that do not fit the arm or do not support a calibration, with the reason, unless
///         `refuse_implausible` is off
template <NominalArm Arm, RangeOf<Dataset<Arm::dof>> Stations, RangeOf<Distances<Arm::dof>> Wires>
Calibration<ChainOf<Arm>> calibrate(const Arm& arm, const Stations& stations, const Wires& distances,
                                    const CalibrateOptions& options = {}, const FitOptions& fit = {},
                                    PriorSearch search = {}, std::span<const Contact> contacts = {}) {
  using Chain = ChainOf<Arm>;
  constexpr int N = Chain::dof;
  const Framed<Chain> nominal = in_frames(arm);
  const std::span<const Dataset<N>> poses(std::data(stations), std::size(stations));
  const std::span<const Distances<N>> wires(std::data(distances), std::size(distances));
  require(poses.size() + wires.size() > 0, "calibrate: no measurements");
  options.errors.validate();
  options.sensors.validate();

  IdentifyOptions frames_alone = options.geometry;
  frames_alone.geometry = false;
  StagedModels<Chain> frames{Stage::frames, true, {}};
  std::optional<ArmGeometry> first;  // as registered from the first station
  std::vector<Isometry3> bases;
  for (std::size_t s = 0; s < poses.size(); ++s) {
    const auto registered = identify(nominal, poses[s], frames_alone, options.sensors);
    if (options.refuse_implausible) {
      detail::require_plausible(ArmGeometry(nominal), detail::station_of(poses[s], options.sensors),
                                registered.rms_after, options.arm_name,
                                detail::name_of(options.station_names, s, "station"));
      detail::require_usable(registered, "registering the frames");
    }
    const Framed<Chain>& arm_there = registered.model.identified();
    frames.models.emplace_back(nominal.model(), arm_there.around(WithJointErrors<Chain>(arm_there.model())));
    bases.push_back(arm_there.base());
    if (s == 0) first.emplace(arm_there);
  }
  for (std::size_t d = 0; d < wires.size() && first && options.refuse_implausible; ++d)
    detail::require_plausible_distances(*first, detail::station_of(wires[d], options.sensors),
                                        detail::name_of(options.distance_names, d, "distances"));

  if (first && options.refuse_implausible && !options.errors.tool_per_station)
    for (const Contact& contact : contacts) detail::require_plausible_contact(*first, contact);

  const auto began = std::chrono::steady_clock::now();
  const auto identified = [&](const IdentifyOptions& of_geometry) {
    return poses.empty() ? identify(nominal, wires.front(), of_geometry, options.sensors)
                         : identify(nominal, in_one_frame<N>(poses, bases, options.sensors.use_orientations),
                                    of_geometry, options.sensors);
  };
  Identified<Chain> geometry = identified(options.geometry);
  if (options.errors.prior != nullptr && geometry.status == IdentifyStatus::underdetermined)
    geometry = identified(frames_alone);  // an earlier calibration knows the rest
  if (options.refuse_implausible) detail::require_usable(geometry, "identifying the geometry");
  ErrorModelOptions of_errors = options.errors;
  of_errors.executor = fit.executor;
  FittedErrorModel<Chain> errors =
      fit_error_model(geometry, poses, wires, of_errors, options.sensors, search, contacts);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;

  if (!poses.empty()) errors.stages.insert(errors.stages.begin(), std::move(frames));
  Calibration<Chain> out{std::move(geometry), std::move(errors)};
  out.fit_seconds = seconds.count();
  out.sensors = options.sensors;
  if (!poses.empty()) detail::learn_remainders<Chain>(out, poses, options.remainder, fit);

  std::vector<double> residuals;
  out.oriented = options.sensors.use_orientations && !poses.empty();
  for (std::size_t s = 0; s < poses.size(); ++s) {
    out.poses += poses[s].size();
    out.oriented = out.oriented && poses[s].has_orientations();
    const VectorX e = detail::visited_errors(out.errors.models()[s], poses[s]);
    residuals.insert(residuals.end(), e.begin(), e.end());
  }
  for (const auto& data : wires) out.distances += data.size();
  Index touches = 0;
  for (const Contact& contact : contacts) touches += contact.size();
  JointRows<N> measured(out.poses + out.distances + touches, N);
  Index at = 0;
  const auto append = [&](const auto& data) {
    measured.middleRows(at, data.size()) = data.joints();
    at += data.size();
  };
  for (const auto& data : poses) append(data);
  for (const auto& data : wires) append(data);
  for (const Contact& contact : contacts) append(contact);
  out.coverage = JointCoverage<N>::covering(measured);
  for (int i = 0; i < N; ++i)
    out.coverage.periodic[static_cast<std::size_t>(i)] = nominal.model().row(i).joint == JointType::revolute;
  if (!residuals.empty()) {
    const Eigen::Map<const VectorX> e(residuals.data(), static_cast<Index>(residuals.size()));
    out.median_error = ErrorStatistics::of(e).median;
    out.outliers = (e.array() > 8 * out.median_error).count();
  }
  return out;
}

/// The same from poses alone.
template <NominalArm Arm, RangeOf<Dataset<Arm::dof>> Stations>
Calibration<ChainOf<Arm>> calibrate(const Arm& arm, const Stations& stations, const CalibrateOptions& options = {},
                                    const FitOptions& fit = {}, PriorSearch search = {}) {
  return calibrate(arm, stations, std::span<const Distances<Arm::dof>>(), options, fit, search);
}

/// The same from one station.
template <NominalArm Arm>
Calibration<ChainOf<Arm>> calibrate(const Arm& arm, const Dataset<Arm::dof>& data, const CalibrateOptions& options = {},
                                    const FitOptions& fit = {}, PriorSearch search = {}) {
  return calibrate(arm, std::span<const Dataset<Arm::dof>>(&data, 1), options, fit, search);
}

/// The same from distances alone, one set a fixed point: frames are relative to the first fixed point.
template <NominalArm Arm, RangeOf<Distances<Arm::dof>> Wires>
Calibration<ChainOf<Arm>> calibrate(const Arm& arm, const Wires& distances, const CalibrateOptions& options = {},
                                    const FitOptions& fit = {}, PriorSearch search = {}) {
  return calibrate(arm, std::span<const Dataset<Arm::dof>>(), distances, options, fit, search);
}

}  // namespace vernier
