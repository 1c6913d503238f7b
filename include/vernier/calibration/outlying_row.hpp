// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Training rows whose measurement is not that of their joints.

#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// A training row that is an outlier: its residual is many times its own predicted spread.
struct OutlyingRow {
  std::string file{};       ///< where it stands; empty where its file is not known
  Index line = 0;           ///< in that file, from 1
  std::size_t station = 0;  ///< whose poses it is of, from 0
  Index row = 0;            ///< among the training rows of that station, from 0
  double position = 0;      ///< by how much its position is off [m]
  double rotation = 0;      ///< by how much its orientation is off [rad]; 0 where orientations are not used
  double factor = 0;        ///< the larger residual, as a multiple of its spread
};

/// Where some rows stand, for a message: "measured.csv, lines 3 and 5"; ten of them at most, then their number.
VERNIER_API std::string where(const std::vector<OutlyingRow>& rows);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/outlying_row.ipp"
#endif
