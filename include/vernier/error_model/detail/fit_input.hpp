#pragma once

/// @file
/// Where the fit of an error model starts: arms, unknowns and measurements of all stations.

#include <span>
#include <vector>

#include "vernier/data/contacts.hpp"
#include "vernier/error_model/error_model_options.hpp"
#include "vernier/identification/arm_parameterisation.hpp"
#include "vernier/identification/detail/station.hpp"
#include "vernier/identification/identification_report.hpp"

namespace vernier::detail {

/// Where a fit starts, and what it is fitted to.
struct ErrorModelInput {
  const IdentificationReport& identification;
  ArmGeometry identified;  ///< seen from the first station
  ChainTable nominal;      ///< for the torques of gravity
  std::vector<Station> poses;
  std::vector<Station> distances;
  std::span<const Contact> contacts{};
};

/// The identified arm in every station's own base; that of distances has its origin at their fixed point, that of a
/// contact is the frame of its object.
VERNIER_API std::vector<ArmGeometry> starting_arms(const ErrorModelInput& input);

/// What is estimated: what the identification estimated, frames once a station.
VERNIER_API std::vector<GeometricUnknown> geometric_unknowns(const ErrorModelInput& input,
                                                             const ErrorModelOptions& options);

/// Stations of poses, distances and contacts, in this order.
VERNIER_API std::vector<Station> joined_stations(const ErrorModelInput& input, const SensorModel& sensors);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/fit_input.ipp"
#endif
