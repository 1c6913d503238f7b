// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Corners of a printed board in images, by OpenCV. No other file knows OpenCV, or its versions.

#include <string>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/corner_views.hpp"

namespace support {

/// Finds a board in an image of 8-bit grey values.
/// @param board  as printed
/// @param pixels row by row, width x height
/// @return       no corners where the board is not found; the centre of the first pixel is (0, 0)
/// @throws std::invalid_argument for a board that cannot be told from itself after half a turn, or a dictionary that
///         OpenCV does not have
vernier::View detect_board(const vernier::Board& board, const std::vector<unsigned char>& pixels, vernier::Index width,
                           vernier::Index height);

/// Finds a board in an image file.
/// @return its name is that of the file, without folder
/// @throws std::runtime_error for a file that is no image
vernier::View detect_board(const vernier::Board& board, const std::string& file);

/// Files that a pattern with * names, in alphabetical order; the name itself where it has none.
std::vector<std::string> files_of(const std::string& pattern);

/// A board as OpenCV draws it, 8-bit grey values of some pixels a square; for comparisons.
std::vector<unsigned char> drawn_by_opencv(const vernier::Board& board, int pixels_per_square);

}  // namespace support
