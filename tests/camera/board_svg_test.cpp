// SPDX-License-Identifier: BSD-3-Clause
// Boards as SVG: their size, their squares and markers.

#include "vernier/camera/board_svg.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "complaint.hpp"

namespace vn = vernier;

namespace board_svg_test {
namespace {

TEST(BoardSvg, HasItsTrueSizeAndSquares) {
  const std::string svg = vn::board_svg({.rows = 4, .columns = 3, .square = 0.03});
  EXPECT_NE(svg.find("width=\"150.0000mm\" height=\"180.0000mm\""), std::string::npos);
  EXPECT_EQ(std::count(svg.begin(), svg.end(), 'M'), 6);  // black squares of 12
  EXPECT_NE(svg.find("M30.0000 30.0000h30.0000v30.0000h-30.0000z"), std::string::npos);
}

TEST(BoardSvg, HasAMarkerInEachWhiteSquare) {
  const vn::Board board{.rows = 4, .columns = 3, .square = 0.024, .marker = 0.018, .dictionary = "DICT_4X4_50"};
  // marker 0 of DICT_4X4_50 is 1011 0101 0011 0010, in the second square of the first row; cells of 3 mm
  const std::string first = "1011010100110010";
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      EXPECT_EQ(vn::is_black(board, 0.024 + 0.006 + 0.003 * c + 0.0015, 0.006 + 0.003 * r + 0.0015),
                first[static_cast<std::size_t>(4 * r + c)] == '0')
          << r << ", " << c;
  EXPECT_TRUE(vn::is_black(board, 0.012, 0.012));            // a square
  EXPECT_TRUE(vn::is_black(board, 0.024 + 0.0045, 0.0045));  // the border of a marker
  EXPECT_FALSE(vn::is_black(board, 0.024 + 0.0015, 0.012));  // the margin around it
  EXPECT_FALSE(vn::is_black(board, -0.001, 0.012));          // beside the board
}

TEST(BoardSvg, RefusesWhatItDoesNotKnow) {
  const vn::Board other{.rows = 4, .columns = 3, .square = 0.024, .marker = 0.018, .dictionary = "DICT_7X7_50"};
  EXPECT_NE(vernier_test::complaint([&] { (void)vn::board_svg(other); }).find("'DICT_7X7_50' is not known"),
            std::string::npos);
  const vn::Board large{.rows = 20, .columns = 20, .square = 0.024, .marker = 0.018, .dictionary = "DICT_4X4_50"};
  EXPECT_NE(vernier_test::complaint([&] { (void)vn::board_svg(large); }).find("has markers 0 to 49, not 50"),
            std::string::npos);
}

}  // namespace
}  // namespace board_svg_test
