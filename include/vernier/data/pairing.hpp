// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Pairs of commanded poses and measured points, and what is wrong with them.

#include <optional>
#include <vector>

#include "vernier/data/point_pair.hpp"

namespace vernier {

/// Consecutive rows or points.
struct IndexRange {
  Index first = 0;  ///< from 0
  Index last = -1;  ///< included; before `first` where there is none

  /// Number of them.
  Index size() const { return last - first + 1; }
};

/// Where a table of points departs from the order, or the names, of the commanded poses.
struct PairingFault {
  /// What it may be.
  enum class Kind {
    missing,       ///< poses without a point
    additional,    ///< points without a pose
    swapped,       ///< two points in exchanged places
    out_of_order,  ///< a point in another place
    misfit,        ///< a point in its place that is too far from where the arm was
  };
  Kind kind = Kind::missing;  ///< which of them
  IndexRange rows{};          ///< poses concerned, of swapped points both; of additional points those before and after
  IndexRange points{};        ///< points of these poses, or those additional; of missing ones those before and after
  Index count = 1;            ///< how many are missing or additional; fewer than concerned where several fit as well
  double distance = 0;        ///< of a misfit: from where the arm was to the point [m]
};

/// What the nominal arm says about the pairs.
enum class PairingStatus {
  proven,      ///< they hold
  wrong_unit,  ///< they would, with the points in another unit
  mirrored,    ///< they would, with the points mirrored: their frame is left-handed
  ambiguous,   ///< shifted by a row the points would fit as well
  unrelated,   ///< points and poses have nothing to do with each other, or too much is wrong
  too_few,     ///< fewer than six poses or points
};

/// Registration of the points with the nominal arm. Its base frame and the offset of the reflector from the flange are
/// unknown: `point = base * flange * offset`.
struct PairingProof {
  PairingStatus status = PairingStatus::too_few;  ///< the outcome
  Isometry3 base = Isometry3::Identity();         ///< base frame of the arm in that of the points
  Vector3 offset = Vector3::Zero();               ///< of the reflector, in the flange's frame [m]
  double median = 0;                              ///< distance of the pairs' points from the nominal arm's [m]
  double limit = 0;                               ///< distance up to which a point belongs to a pose [m]
  double scale = 1;                               ///< of the points against the arm, e.g. 25.4 for inches read as mm
  double spread_ratio = 1;                        ///< of the points' scatter to that of the flange's positions
  Index indistinct = 0;  ///< poses so near the one before that their exchange would not be seen
};

/// The pairs, and what is wrong with the others.
struct Pairing {
  std::vector<PointPair> pairs{};       ///< ascending rows
  std::vector<PairingFault> faults{};   ///< in the order of rows
  std::optional<PairingProof> proof{};  ///< where the arm is known
};

}  // namespace vernier
