#pragma once

/// @file
/// Which measured point belongs to which commanded pose: by name, or by order with a proof.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/data/csv.hpp"
#include "vernier/data/point_pair.hpp"
#include "vernier/data/point_table.hpp"

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

/// Pairs poses and points of the same name. Points that no pose names, e.g. reference points, are no faults.
/// @param commanded the file of the poses
/// @param key       its column with the names of the points
/// @param points    with names
/// @throws DataError naming file and lines, where a name is there twice, or the column is missing
VERNIER_API Pairing pair_by_name(const CsvText& commanded, const std::string& key, const PointTable& points);

/// Checks pairs against the nominal arm: adds a proof, takes pairs that do not fit out, and exchanges swapped ones.
/// @param pairing by name
/// @param flanges poses of the nominal flange at all rows
/// @param points  measured points, n x 3 [m]
VERNIER_API Pairing check_pairs(const Pairing& pairing, std::span<const Isometry3> flanges, const PointRows& points);

/// Pairs poses and points by their order, and proves it with the nominal arm. Short runs of both are registered
/// rigidly, with an unknown offset of the reflector, under all shifts; from the frames that explain most, both are
/// aligned by dynamic programming with gaps (Needleman and Wunsch), and registered again. So missing, additional,
/// swapped and misplaced points are found, where their distance from the right place exceeds `PairingProof::limit`:
/// three times the 90 % quantile, at most six times the median, of the distances of the points from the nominal arm.
/// Unless the outcome is `proven` there are no pairs. With fewer than twelve poses a fault is often in the way of any
/// proof.
/// @param flanges poses of the nominal flange, in the order of measuring
/// @param points  measured points, n x 3 [m]
/// @throws std::invalid_argument for more than 10^8 rows times points
/// @complexity O(rows x points)
/// @cite Needleman and Wunsch 1970; Kabsch 1976
VERNIER_API Pairing pair_by_order(std::span<const Isometry3> flanges, const PointRows& points);

/// A fault in a sentence, with the lines of both files.
VERNIER_API std::string describe(const PairingFault& fault, const CsvText& commanded, const PointTable& points);

/// What is wrong in a sentence, empty where the pairs are proven.
VERNIER_API std::string describe(const PairingProof& proof);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/pair_points.ipp"
#endif
