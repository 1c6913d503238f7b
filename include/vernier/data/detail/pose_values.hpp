// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Positions and orientations of a CSV file, in whichever columns it has them.

#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/types.hpp"
#include "vernier/data/detail/csv_table.hpp"

namespace vernier::detail {

/// Positions, and orientations where the file has them.
struct PoseValues {
  MatrixX values{};                   ///< n x 3 [m], or n x 6 with rotation vectors [rad]
  std::vector<std::string> points{};  ///< reflector of each row, where a line has several; none else
  std::vector<Index> rows{};          ///< of the file, that each row is of, where a line has several points; none else
};

/// Whether three letters are axes about which Euler angles turn: all capital or all small, no axis twice in a row.
VERNIER_API bool euler_axes(std::string_view order);

/// The rotation of Euler angles.
/// @param order  see `CsvFormat::euler`
/// @param angles in the order of turning [rad]
VERNIER_API Matrix3 euler_rotation(std::string_view order, const Vector3& angles);

/// Positions x, y, z, and orientations as rotation vectors, quaternions, matrices or Euler angles.
/// @param euler see `CsvFormat::euler`; empty: there are none, and columns named like some are refused
/// @return      n x 3 [m], or n x 6 with rotation vectors [rad]
/// @throws DataError naming file, line and column
/// @throws std::invalid_argument for an order that cannot be
VERNIER_API MatrixX oriented_values(const CsvTable& table, const std::string& euler);

/// The same, or several points a line: x1, y1, z1, x2 .. zK. Three empty cells are a point that was not seen.
VERNIER_API PoseValues pose_values(const CsvTable& table, const std::string& euler);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/data/detail/pose_values.ipp"
#endif
