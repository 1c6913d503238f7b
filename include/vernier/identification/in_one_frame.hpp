// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Poses of one arm measured from several places.

#include <vector>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/ranges.hpp"

namespace vernier {

namespace detail {

/// Writes rows of measured poses, moved, from row `first` on.
/// The covariance of a pose in another frame.
VERNIER_API Matrix6 turned_covariance(const Isometry3& motion, const Matrix6& covariance);
VERNIER_API void move_poses(const Isometry3& motion, const PointRows& positions, const PointRows& orientations,
                            Index first, PointRows& moved_positions, PointRows& moved_orientations);

}  // namespace detail

/// All stations as one set of poses in the frame of the first, given the bases.
/// @param stations         one set of poses a place; a single one is returned as it is
/// @param bases            base frame of the arm as seen from each station; unused for a single one
/// @param use_orientations whether orientations are kept, where every station has them, as temperatures and payloads
/// are
/// @throws std::invalid_argument for no stations, or another number of bases
template <int N, RangeOf<Dataset<N>> Stations>
Dataset<N> in_one_frame(const Stations& stations, const std::vector<Isometry3>& bases, bool use_orientations = true) {
  demand(std::size(stations) > 0, "in_one_frame: no stations");
  if (std::size(stations) == 1) return *std::begin(stations);
  demand(bases.size() == std::size(stations), "in_one_frame: ", bases.size(), " bases for ", std::size(stations),
         " stations");
  Index rows = 0;
  bool oriented = use_orientations, thermal = true, loaded = true, correlated = true;
  for (const Dataset<N>& data : stations) {
    rows += data.size();
    oriented = oriented && data.has_orientations();
    thermal = thermal && data.temperatures().size() > 0;
    loaded = loaded && data.payloads().rows() > 0;
    correlated = correlated && !data.covariances().empty();
  }
  JointRows<N> joints(rows, N);
  JointRows<N> previous(rows, N);
  VectorX times(rows), temperatures(thermal ? rows : 0);
  MatrixX payloads(loaded ? rows : 0, 4);
  PointRows positions(rows, 3), orientations(oriented ? rows : 0, 3);
  Index at = 0;
  std::vector<Matrix6> covariances;
  RowOrigin origin;
  for (std::size_t s = 0; s < bases.size(); ++s) {
    const Dataset<N>& data = std::data(stations)[s];
    joints.middleRows(at, data.size()) = data.joints();
    previous.middleRows(at, data.size()) = data.previous();
    times.segment(at, data.size()) = data.times();
    if (loaded) payloads.middleRows(at, data.size()) = data.payloads();
    if (thermal) temperatures.segment(at, data.size()) = data.temperatures();
    detail::move_poses(composed(bases.front(), inverse_of(bases[s])), data.positions(), data.orientations(), at,
                       positions, orientations);
    for (std::size_t i = 0; correlated && i < data.covariances().size(); ++i)
      covariances.push_back(
          detail::turned_covariance(composed(bases.front(), inverse_of(bases[s])), data.covariances()[i]));
    origin.append(data.origin(), at);
    at += data.size();
  }
  return Dataset<N>(joints, positions, orientations)
      .approached_from(previous)
      .measured_at(times)
      .at_temperatures(temperatures)
      .carrying(payloads)
      .with_covariances(covariances)
      .from(origin);
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/in_one_frame.ipp"
#endif
