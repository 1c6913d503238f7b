// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A printed board of squares, whose inner corners a camera sees.

#include <string>

#include "vernier/core/types.hpp"

namespace vernier {

/// A chessboard, or one with ArUco markers in its white squares (ChArUco). Corner k is in column k % (columns - 1) and
/// row k / (columns - 1); its place is (column + 1, row + 1) squares from the board's origin, which is a corner of the
/// print.
struct Board {
  Index rows = 0;               ///< number of squares from top to bottom
  Index columns = 0;            ///< number of squares from left to right
  double square = 0;            ///< side of a square [m], as measured or, if it was not, as printed
  double scale_sigma = 3e-3;    ///< standard deviation of all lengths, as a share; 0.3 % for a print not measured
  double marker = 0;            ///< side of a marker [m]; 0: a chessboard
  std::string dictionary{};     ///< of the markers, as OpenCV names it
  bool legacy_pattern = false;  ///< ChArUco of OpenCV before 4.6, which begins with a white square

  /// Number of inner corners.
  Index corners() const { return (rows - 1) * (columns - 1); }
  /// Place of a corner on the flat board [m]; z is 0.
  Vector3 corner(Index k) const {
    return {static_cast<double>(k % (columns - 1) + 1) * square, static_cast<double>(k / (columns - 1) + 1) * square,
            0};
  }
  /// Middle of the board [m].
  Vector3 middle() const {
    return {static_cast<double>(columns) * square / 2, static_cast<double>(rows) * square / 2, 0};
  }
  /// Half the length of its diagonal [m].
  VERNIER_API double half_diagonal() const;
  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/camera/board.ipp"
#endif
