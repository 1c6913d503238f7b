// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/camera/board_svg.hpp"

#include <cmath>
#include <cstdio>
#include <string_view>

#include "vernier/camera/detail/marker_patterns.hpp"
#include "vernier/core/check.hpp"

namespace vernier {

namespace detail {

/// Number of the marker in a square; -1 for a black square, or where the board has none.
VERNIER_LOCAL Index marker_in(const Board& board, Index row, Index column) {
  const Index shift = board.legacy_pattern && board.rows % 2 == 0 ? 1 : 0;
  if ((row + column + shift) % 2 == 0) return -1;
  Index number = 0;  // white squares before this one
  for (Index r = 0; r <= row; ++r)
    for (Index c = 0; c < (r == row ? column : board.columns); ++c) number += (r + c + shift) % 2;
  return board.marker > 0 ? number : -1;
}

/// Whether a square is black.
VERNIER_LOCAL bool is_black_square(const Board& board, Index row, Index column) {
  const Index shift = board.legacy_pattern && board.rows % 2 == 0 ? 1 : 0;
  return (row + column + shift) % 2 == 0;
}

/// A rectangle as a part of a path [mm].
VERNIER_LOCAL std::string svg_rectangle(double x, double y, double size) {
  char text[160];
  std::snprintf(text, sizeof text, "M%.4f %.4fh%.4fv%.4fh%.4fz", x, y, size, size, -size);
  return text;
}

}  // namespace detail

VERNIER_IMPL MarkerPattern marker_pattern(const std::string& dictionary, Index number) {
  for (const int cells : {4, 5})
    for (const Index size : {50, 100, 250}) {
      if (dictionary != message("DICT_", cells, 'X', cells, '_', size)) continue;
      demand(number >= 0 && number < size, "marker_pattern: ", dictionary, " has markers 0 to ", size - 1, ", not ",
             number);
      const auto k = static_cast<std::size_t>(number);
      return {cells, cells == 4 ? detail::markers_4x4[k] : detail::markers_5x5[k]};
    }
  demand(false, "marker_pattern: the dictionary '", dictionary,
         "' is not known; there are DICT_4X4_50, _100 and _250, and DICT_5X5_50, _100 and _250");
  return {};
}

VERNIER_IMPL bool is_black(const Board& board, double x, double y) {
  const auto column = static_cast<Index>(std::floor(x / board.square)),
             row = static_cast<Index>(std::floor(y / board.square));
  if (row < 0 || column < 0 || row >= board.rows || column >= board.columns) return false;
  if (detail::is_black_square(board, row, column)) return true;
  const Index number = detail::marker_in(board, row, column);
  if (number < 0) return false;
  const MarkerPattern pattern = marker_pattern(board.dictionary, number);
  const double margin = (board.square - board.marker) / 2, cell = board.marker / (pattern.cells + 2);
  const double across = (x - static_cast<double>(column) * board.square - margin) / cell,
               down = (y - static_cast<double>(row) * board.square - margin) / cell;
  const int c = static_cast<int>(std::floor(across)), r = static_cast<int>(std::floor(down));
  if (r < 0 || c < 0 || r >= pattern.cells + 2 || c >= pattern.cells + 2) return false;
  if (r == 0 || c == 0 || r == pattern.cells + 1 || c == pattern.cells + 1) return true;
  return !pattern.is_white(r - 1, c - 1);
}

VERNIER_IMPL std::string board_svg(const Board& board) {
  board.validate();
  const double square = board.square * 1e3, marker = board.marker * 1e3;
  const double width = static_cast<double>(board.columns + 2) * square,
               height = static_cast<double>(board.rows + 2) * square;
  char head[400];
  std::snprintf(
      head, sizeof head,
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.4fmm\" height=\"%.4fmm\" viewBox=\"0 0 %.4f %.4f\" "
      "shape-rendering=\"crispEdges\">\n<rect width=\"%.4f\" height=\"%.4f\" fill=\"white\"/>\n",
      width, height, width, height, width, height);
  std::string out = head, black, white;
  for (Index row = 0; row < board.rows; ++row)
    for (Index column = 0; column < board.columns; ++column) {
      const double x = static_cast<double>(column + 1) * square, y = static_cast<double>(row + 1) * square;
      if (detail::is_black_square(board, row, column)) {
        black += detail::svg_rectangle(x, y, square);
        continue;
      }
      const Index number = detail::marker_in(board, row, column);
      if (number < 0) continue;
      const MarkerPattern pattern = marker_pattern(board.dictionary, number);
      const double margin = (square - marker) / 2, cell = marker / (pattern.cells + 2);
      black += detail::svg_rectangle(x + margin, y + margin, marker);
      for (int r = 0; r < pattern.cells; ++r)
        for (int c = 0; c < pattern.cells; ++c)
          if (pattern.is_white(r, c))
            white += detail::svg_rectangle(x + margin + (c + 1) * cell, y + margin + (r + 1) * cell, cell);
    }
  out += "<path d=\"" + black + "\" fill=\"black\"/>\n";
  if (!white.empty()) out += "<path d=\"" + white + "\" fill=\"white\"/>\n";
  return out + "</svg>\n";
}

}  // namespace vernier
