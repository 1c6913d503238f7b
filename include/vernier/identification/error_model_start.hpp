#pragma once

/// @file
/// Where the fit of an error model starts: from an identified arm, in every station.

#include <cmath>
#include <span>
#include <vector>

#include "vernier/identification/error_model_options.hpp"
#include "vernier/identification/error_model_problem.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identified.hpp"

namespace vernier::detail {

/// The identified arm in every station's own base; that of distances has its origin at their fixed point.
template <class Chain>
std::vector<Framed<Chain>> starting_arms(const Identified<Chain>& start, std::span<const Dataset<Chain::dof>> stations,
                                         std::span<const Distances<Chain::dof>> distances) {
  constexpr int N = Chain::dof;
  const Framed<Chain>& first = start.model.actual();
  if (stations.size() + distances.size() == 1) {
    require((stations.empty() ? distances.front().size() : stations.front().size()) >= 1,
            "fit_error_model: a station without measurements");
    return {first};
  }
  const Framed<Chain> unregistered(first.model(), {}, first.tool());
  std::vector<Framed<Chain>> out;
  for (const Dataset<N>& data : stations) {
    require(data.size() >= 1, "fit_error_model: a station without poses");
    out.emplace_back(first.model(), register_points(positions(unregistered, data.joints()), data.positions()),
                     first.tool());
  }
  for (const Distances<N>& data : distances) {
    require(data.size() >= 1, "fit_error_model: a station without distances");
    Isometry3 base = Isometry3::Identity();
    base.translation() = -trilaterate(positions(unregistered, data.joints()), data.lengths());
    out.emplace_back(first.model(), base, first.tool());
  }
  return out;
}

/// What may move: what the identification moved, frames once a station.
/// @param of_poses how many stations see poses, the first of all `stations`
template <class Chain>
std::vector<GeometricUnknown> geometric_unknowns(const Identified<Chain>& start, std::size_t of_poses,
                                                 std::size_t stations, const ErrorModelOptions& options) {
  std::vector<GeometricUnknown> out;
  const auto own = [&](Index k) {
    return stations > 1 && (k < 6 || (options.own_tools && k >= 6 + Chain::num_parameters));  // a base, or a tool
  };
  for (const Index k : start.free) {
    const ParameterEstimate& p = start.parameters[static_cast<std::size_t>(k)];
    const bool of_chain = k >= 6 && k < 6 + Chain::num_parameters;
    // thirty expected sizes bind nothing that is determined
    const double deviation = std::isfinite(p.prior) ? p.prior / p.size : 30;
    const double precision = of_chain ? 1 / (deviation * deviation) : 0;
    if (!own(k)) {
      out.push_back({k, -1, p.size, precision});
      continue;
    }
    const auto last = k < 6 ? of_poses : stations;
    for (std::size_t s = 0; s < last; ++s) out.push_back({k, static_cast<int>(s), p.size, precision});
  }
  // a fixed point has a place, but no orientation
  for (std::size_t s = of_poses; s < stations && stations > 1; ++s)
    for (Index k = 0; k < 3; ++k)
      out.push_back({k, static_cast<int>(s), start.parameters[static_cast<std::size_t>(k)].size, 0});
  return out;
}

/// What was measured and how well, poses first.
template <int N>
std::vector<Station<N>> sensors(std::span<const Dataset<N>> stations, std::span<const Distances<N>> distances,
                                const ErrorModelOptions& options) {
  std::vector<Station<N>> out;
  for (const Dataset<N>& data : stations)
    out.push_back({.poses = &data,
                   .oriented = options.use_orientations && data.has_orientations(),
                   .position_sigma = options.position_sigma,
                   .orientation_sigma = options.orientation_sigma,
                   .joint_sigma = options.joint_sigma});
  for (const Distances<N>& data : distances)
    out.push_back({.distances = &data, .position_sigma = options.distance_sigma, .joint_sigma = options.joint_sigma});
  return out;
}

}  // namespace vernier::detail
