// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A board as an image to be printed, and the cells that it is made of.

#include <cstdint>
#include <string>

#include "vernier/camera/board.hpp"

namespace vernier {

/// A marker of a dictionary.
struct MarkerPattern {
  int cells = 0;            ///< in a row, without the black border of one cell
  std::uint32_t white = 0;  ///< row by row, the first cell in the highest bit

  /// Whether a cell is white.
  bool is_white(int row, int column) const { return ((white >> (cells * cells - 1 - row * cells - column)) & 1u) != 0; }
};

/// A marker by its number.
/// @param dictionary DICT_4X4_50, _100 or _250, or DICT_5X5_50, _100 or _250
/// @param number     of the marker, from 0
/// @throws std::invalid_argument for another dictionary, or a number that it has not
VERNIER_API MarkerPattern marker_pattern(const std::string& dictionary, Index number);

/// Whether a place on a board is printed black: squares, and the markers in white squares, which are numbered row by
/// row.
/// @param board with its squares and markers
/// @param x,y   from the corner of the print, x along the columns [m]
VERNIER_API bool is_black(const Board& board, double x, double y);

/// A board as SVG, in its true size with a white margin of one square.
/// @throws std::invalid_argument for an unusable board, a dictionary that is not known, or one of too few markers
VERNIER_API std::string board_svg(const Board& board);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/camera/board_svg.ipp"
#endif
