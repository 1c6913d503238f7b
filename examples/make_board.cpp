// SPDX-License-Identifier: BSD-3-Clause
// A board to be printed, and the file that describes it.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli.hpp"
#include "vernier/camera/board_svg.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/io/camera_files.hpp"

namespace {

namespace vn = vernier;

int run(support::Program& program) {
  int rows = 0, columns = 0;
  double square_mm = 0, marker_mm = 0;
  std::string dictionary, svg, description;
  program.add_option("--rows", rows, "number of squares from top to bottom", "N").within(3, 100).required();
  program.add_option("--columns", columns, "number of squares from left to right", "N").within(3, 100).required();
  program.add_option("--square-mm", square_mm, "side of a square [mm]", "MM").within(0.1, 1e3).required();
  support::Option marker =
      program.add_option("--marker-mm", marker_mm, "side of a marker [mm]; without it the board is a chessboard", "MM")
          .within(0.05, 1e3);
  support::Option markers = program.add_option(
      "--dictionary", dictionary, "of the markers: DICT_4X4_50, _100, _250, DICT_5X5_50, _100, _250", "NAME");
  marker.needs(markers);
  markers.needs(marker);
  program.group(support::Group::output);
  program.add_output("--svg", svg, "the board to be printed, in its true size").required();
  program.add_output("--board", description, "its description, for detect_board and calibrate").required();
  program.parse("make_board_out");

  const vn::Board board{.rows = rows,
                        .columns = columns,
                        .square = square_mm * 1e-3,
                        .marker = marker_mm * 1e-3,
                        .dictionary = dictionary};
  vn::write_file(svg, vn::board_svg(board));
  nlohmann::ordered_json json{{"rows", rows}, {"columns", columns}, {"square_mm", square_mm}};
  if (marker_mm > 0) {
    json["marker_mm"] = marker_mm;
    json["dictionary"] = dictionary;
  }
  vn::write_file(description, json.dump(1) + "\n");
  const int longer = (std::max)(rows, columns);
  fmt::print(
      "Board to be printed without scaling: {}\nDescription: {}\n\nPrinters change lengths. Measure {} squares of the "
      "print ({:.1f} mm if it is true) and add to the description:\n  \"measured_mm\": ..., \"measured_squares\": {}, "
      "\"sigma_mm\": ...\nWithout them the scale is taken to be known to 0.3 %.\n",
      support::shown(svg), support::shown(description), longer, longer * square_mm, longer);
  if (marker_mm <= 0 && (rows + columns) % 2 == 0)
    fmt::print(
        "\nThis chessboard looks the same after half a turn, so its corners cannot be told apart. Take one row more or "
        "less, or markers.\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{"make_board",
                             "Draws a chessboard or ChArUco board to be printed, and writes its description.",
                             {"make_board --rows 8 --columns 11 --square-mm 20 --svg board.svg --board board.json",
                              "make_board --rows 8 --columns 11 --square-mm 20 --marker-mm 15 --dictionary DICT_4X4_50 "
                              "--svg charuco.svg --board charuco.json"}};
  return support::run_program(about, argc, argv, run);
}
