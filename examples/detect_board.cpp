// SPDX-License-Identifier: BSD-3-Clause
// Images in; corners of a printed board out.

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "board_detection.hpp"
#include "cli.hpp"
#include "progress.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/io/camera_files.hpp"

namespace {

namespace vn = vernier;

int run(support::Program& program) {
  std::string board_file, camera;
  std::vector<std::string> patterns, places;
  program.add_option("--board", board_file, "the printed board (JSON)", "FILE").required();
  program.add_option("--images", patterns, "images, or patterns in quotation marks: 'shots/*.png'", "FILE").required();
  program.add_option("--camera", camera, "name of the camera, where there are several", "NAME");
  program.add_option("--place", places,
                     "names of the places of the board, where there are several: one for each --images", "NAME");
  program.parse("corners.csv", "file for the corners", "FILE");

  if (places.size() > 1 && places.size() != patterns.size())
    throw support::UsageError(fmt::format("{} names of --place for {} of --images", places.size(), patterns.size()));
  const vn::Board board = vn::read_board(board_file);
  std::vector<std::pair<std::string, vn::Index>> files;  // with the number of the place
  for (std::size_t k = 0; k < patterns.size(); ++k)
    for (std::string& file : support::files_of(patterns[k]))
      files.emplace_back(std::move(file), places.size() > 1 ? static_cast<vn::Index>(k) : 0);
  if (files.empty()) throw support::UsageError("--images: no file is called so");
  vn::CornerViews out;
  if (!camera.empty()) out.cameras = {camera};
  if (!places.empty()) out.boards = places;
  std::set<std::string> names;
  support::ProgressBar bar("images", static_cast<vn::Index>(files.size()));
  vn::Index seen = 0;
  std::vector<std::string> without;
  for (const auto& [file, place] : files) {
    vn::View view = support::detect_board(board, file);
    view.board = place;
    if (!names.insert(view.image).second)
      throw support::UsageError("--images: two files are called " + view.image + ", in different folders");
    bar.update(++seen);
    if (view.corners.empty())
      without.push_back(file);
    else
      out.views.push_back(std::move(view));
  }
  bar.finish();
  for (const std::string& file : without) fmt::print("{}: no board\n", file);
  vn::write_file(program.common().out, vn::corners_text(out));
  fmt::print("{} corners in {} of {} images: {}\n", out.corners(), out.views.size(), files.size(),
             support::shown(program.common().out));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "detect_board",
      "Finds the corners of a printed board in images, for calibrate --corners.",
      {"detect_board --board board.json --images 'shots/*.png' --out corners.csv",
       "detect_board --board board.json --images 'floor/*.png' 'table/*.png' --place floor table --out corners.csv"}};
  return support::run_program(about, argc, argv, run);
}
