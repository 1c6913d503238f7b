// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which measured point belongs to which commanded pose: by name, or by order with a proof.

#include <span>
#include <string>

#include "vernier/data/csv.hpp"
#include "vernier/data/pairing.hpp"
#include "vernier/data/point_table.hpp"

namespace vernier {

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
