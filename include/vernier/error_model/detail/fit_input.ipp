#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/error_model/detail/fit_input.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<ArmGeometry> starting_arms(const ErrorModelInput& input) {
  for (const Station& data : input.poses) require(data.size() >= 1, "fit_error_model: a station without poses");
  for (const Station& data : input.distances) require(data.size() >= 1, "fit_error_model: a station without distances");
  if (input.poses.size() + input.distances.size() + input.contacts.size() == 1) return {input.identified};
  const ArmGeometry unregistered = input.identified.with_frames({}, input.identified.tool());
  std::vector<ArmGeometry> out;
  for (const Station& data : input.poses)
    out.push_back(input.identified.with_frames(
        FrameParameters(register_points(unregistered.positions(data.joints()), *data.positions)),
        input.identified.tool()));
  for (const Station& data : input.distances) {
    const Vector3 fixed = trilaterate(unregistered.positions(data.joints()), *data.lengths);
    const Isometry3 base = rigid_motion(Matrix3::Identity(), -fixed);
    out.push_back(input.identified.with_frames(FrameParameters(base), input.identified.tool()));
  }
  for (const Contact& contact : input.contacts) {
    Station station = station_of(contact, {});
    out.push_back(contact_arm(input.identified, contact, station));
    require_spread(out.back(), contact);
  }
  return out;
}

VERNIER_IMPL std::vector<GeometricUnknown> geometric_unknowns(const ErrorModelInput& input,
                                                              const ErrorModelOptions& options) {
  const std::size_t of_poses = input.poses.size(), of_objects = of_poses + input.distances.size(),
                    stations = of_objects + input.contacts.size();
  const Index chain_end = 6 + 5 * input.identified.joints();
  std::vector<GeometricUnknown> out;
  for (const Index k : input.identification.free) {
    const ParameterEstimate& p = input.identification.parameters[static_cast<std::size_t>(k)];
    const bool of_chain = k >= 6 && k < chain_end;
    // thirty expected sizes do not affect what is determined
    const double deviation = std::isfinite(p.prior_std) ? p.prior_std / p.scale : 30;
    const double precision = of_chain ? 1 / (deviation * deviation) : 0;
    const bool own = stations > 1 && (k < 6 || (options.tool_per_station && k >= chain_end));  // a base, or a tool
    if (!own) {
      out.push_back({k, -1, p.scale, precision});
      continue;
    }
    const auto last = k < 6 ? of_poses : stations;
    for (std::size_t s = 0; s < last; ++s) out.push_back({k, static_cast<int>(s), p.scale, precision});
  }
  // a fixed point has a position, but no orientation
  const auto add = [&](std::size_t s, Index k) {
    out.push_back({k, static_cast<int>(s), input.identification.parameters[static_cast<std::size_t>(k)].scale, 0});
  };
  for (std::size_t s = of_poses; s < of_objects && stations > 1; ++s)
    for (Index k = 0; k < 3; ++k) add(s, k);
  for (std::size_t s = of_objects; s < stations; ++s)
    for (const Index k : contact_unknowns(input.contacts[s - of_objects])) add(s, k);
  return out;
}

VERNIER_IMPL std::vector<Station> joined_stations(const ErrorModelInput& input, const SensorModel& sensors) {
  std::vector<Station> out = input.poses;
  out.insert(out.end(), input.distances.begin(), input.distances.end());
  for (const Contact& contact : input.contacts) {
    out.push_back(station_of(contact, sensors));
    static_cast<void>(contact_arm(input.identified, contact, out.back()));  // which way its heights count
  }
  return out;
}

}  // namespace vernier::detail
