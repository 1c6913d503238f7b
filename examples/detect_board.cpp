// SPDX-License-Identifier: BSD-3-Clause
// Images in; corners of a printed board out.

#include <fmt/format.h>

#include <set>
#include <string>
#include <vector>

#include "board_detection.hpp"
#include "cli.hpp"
#include "progress.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/io/camera_files.hpp"

namespace {

namespace vn = vernier;

int run(support::Program& program) {
  std::string board_file, camera, place;
  std::vector<std::string> patterns;
  program.add_option("--board", board_file, "the printed board (JSON)", "FILE").required();
  program.add_option("--images", patterns, "images, or a pattern in quotation marks: 'shots/*.png'", "FILE").required();
  program.add_option("--camera", camera, "name of the camera, where there are several", "NAME");
  program.add_option("--place", place, "name of the place of the board, where there are several", "NAME");
  program.parse("corners.csv", "file for the corners", "FILE");

  const vn::Board board = vn::read_board(board_file);
  std::vector<std::string> files;
  for (const std::string& pattern : patterns)
    for (std::string& file : support::files_of(pattern)) files.push_back(std::move(file));
  if (files.empty()) throw support::UsageError("--images: no file is called so");
  std::string out = "image,corner,u_px,v_px,width_px,height_px";
  if (!camera.empty()) out += ",camera";
  if (!place.empty()) out += ",board";
  out += '\n';
  std::set<std::string> names;
  std::size_t found = 0;
  vn::Index corners = 0;
  support::ProgressBar bar("images", static_cast<vn::Index>(files.size()));
  vn::Index seen = 0;
  std::vector<std::string> without;
  for (const std::string& file : files) {
    const vn::View view = support::detect_board(board, file);
    if (!names.insert(view.image).second)
      throw support::UsageError("--images: two files are called " + view.image + ", in different folders");
    if (view.corners.empty()) without.push_back(file);
    bar.update(++seen);
    found += view.corners.empty() ? 0 : 1;
    corners += static_cast<vn::Index>(view.corners.size());
    for (std::size_t i = 0; i < view.corners.size(); ++i)
      out += fmt::format("{},{},{:.4f},{:.4f},{},{}{}{}\n", view.image, view.corners[i], view.pixels[i](0),
                         view.pixels[i](1), view.width, view.height, camera.empty() ? "" : "," + camera,
                         place.empty() ? "" : "," + place);
  }
  bar.finish();
  for (const std::string& file : without) fmt::print("{}: no board\n", file);
  vn::write_file(program.common().out, out);
  fmt::print("{} corners in {} of {} images: {}\n", corners, found, files.size(), support::shown(program.common().out));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{"detect_board",
                             "Finds the corners of a printed board in images, for calibrate --corners.",
                             {"detect_board --board board.json --images 'shots/*.png' --out corners.csv",
                              "detect_board --board board.json --images 'left/*.png' --camera left --out left.csv"}};
  return support::run_program(about, argc, argv, run);
}
