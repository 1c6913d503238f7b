#pragma once

/// @file
/// Poses of one arm measured from several places.

#include <span>
#include <vector>

#include "vernier/data/dataset.hpp"

namespace vernier {

/// All stations as one set of poses in the frame of the first, as far as what is known of their bases goes.
/// @param stations         one set of poses a place; a single one is given back as it is
/// @param bases            base frame of the arm as seen from each station; not looked at for a single one
/// @param use_orientations whether orientations are kept, where every station has them
template <int N>
Dataset<N> in_one_frame(std::span<const Dataset<N>> stations, const std::vector<Isometry3>& bases,
                        bool use_orientations = true) {
  require(!stations.empty(), "in_one_frame: no stations");
  if (stations.size() == 1) return stations.front();
  require(bases.size() == stations.size(), "in_one_frame: ", bases.size(), " bases for ", stations.size(), " stations");
  Index rows = 0;
  bool oriented = use_orientations;
  for (const auto& data : stations) {
    rows += data.size();
    oriented = oriented && data.has_orientations();
  }
  JointRows<N> joints(rows, N);
  PointRows positions(rows, 3), orientations(oriented ? rows : 0, 3);
  Index at = 0;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const Isometry3 move = bases.front() * bases[s].inverse();
    for (Index i = 0; i < stations[s].size(); ++i, ++at) {
      joints.row(at) = stations[s].joints(i).transpose();
      positions.row(at) = (move * stations[s].position(i)).transpose();
      if (oriented) orientations.row(at) = log_so3(move.linear() * stations[s].orientation(i)).transpose();
    }
  }
  return {joints, positions, orientations};
}

}  // namespace vernier
