// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Plans of poses for a camera: what is to be seen, and where boards should stand.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "carried_camera.hpp"
#include "cli.hpp"
#include "json_file.hpp"
#include "vernier/camera/board_view.hpp"
#include "vernier/core/so3.hpp"

namespace support {

/// What a command line says of a camera.
struct CameraPlan : CarriedCamera {
  std::vector<double> distances{300, 1000};                    ///< least and largest [mm]
  double tilt_deg = 50;                                        ///< largest
  int places = 2;                                              ///< number of them
  double table_mm = std::numeric_limits<double>::quiet_NaN();  ///< height of a table

  /// Adds its options to a command line.
  void add_to(Program& program) {
    const Option where = CarriedCamera::add_to(
        program, "plan images of a printed board: the flange carries the camera (flange) or the board (fixed)");
    program
        .add_option("--distances-mm", distances,
                    "range of distances from the camera to the middle of the board; 300,1000 without it", "MIN,MAX")
        .delimiter(',')
        .expected(2)
        .needs(where);
    program.add_setting("--tilt-deg", tilt_deg, "largest angle between the view and the board's normal", "DEG")
        .within(5.0, 80.0);
    program.add_setting("--places", places, "places of the board, or of a fixed camera, that are proposed", "N")
        .within(1, 20);
    program
        .add_option("--table-mm", table_mm,
                    "the board lies on a table of this height in the base frame; else it may stand anywhere", "Z")
        .within(-1e5, 1e5)
        .needs(where);
  }

  /// What is seen well.
  /// @throws UsageError for a camera without the size of its images, and distances that are no range
  vernier::BoardView view() const {
    if (!(distances[0] > 0 && distances[0] < distances[1]))
      throw UsageError(fmt::format("--distances-mm: {} to {} is no range", distances[0], distances[1]));
    return {.camera = camera(),
            .board = printed(),
            .nearest = distances[0] * 1e-3,
            .farthest = distances[1] * 1e-3,
            .largest_tilt = tilt_deg * std::numbers::pi / 180};
  }
};

/// The name of a place in files.
inline std::string place_name(std::size_t place) { return fmt::format("place{}", place + 1); }

/// Places in words.
inline std::string describe_places(const vernier::BoardPlaces& places, const std::string& mount) {
  std::string out =
      fmt::format("Places of the {} in the base frame of the arm\n", mount == "flange" ? "board" : "camera");
  for (std::size_t k = 0; k < places.in_base.size(); ++k) {
    const vernier::Vector3 at = 1e3 * vernier::translation(places.in_base[k]),
                           turn = vernier::log_so3(vernier::rotation(places.in_base[k])) * (180 / std::numbers::pi);
    vernier::Index seen = 0;
    for (const int place : places.place) seen += place == static_cast<int>(k) ? 1 : 0;
    out += fmt::format(
        "  {}: ({:.0f}, {:.0f}, {:.0f}) mm, rotation vector ({:.0f}, {:.0f}, {:.0f}) deg; {} candidates see it\n",
        place_name(k), at.x(), at.y(), at.z(), turn.x(), turn.y(), turn.z(), seen);
  }
  return out;
}

/// Places as JSON.
inline Json to_json(const vernier::BoardPlaces& places) {
  Json out = Json::array();
  for (std::size_t k = 0; k < places.in_base.size(); ++k) {
    const vernier::Vector3 at = 1e3 * vernier::translation(places.in_base[k]),
                           turn = vernier::log_so3(vernier::rotation(places.in_base[k]));
    out.push_back({{"name", place_name(k)},
                   {"position_mm", {at.x(), at.y(), at.z()}},
                   {"rotation_vector_rad", {turn.x(), turn.y(), turn.z()}}});
  }
  return out;
}

}  // namespace support
