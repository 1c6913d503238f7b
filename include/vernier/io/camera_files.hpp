// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Boards and cameras as JSON files.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/camera/camera_setup.hpp"
#include "vernier/io/json.hpp"

namespace vernier {

/// A board file:
///
///     {"rows": 7, "columns": 5, "square_mm": 36, "marker_mm": 27, "dictionary": "DICT_5X5_250",
///      "measured_mm": 216.4, "measured_squares": 6, "sigma_mm": 0.1}
///
/// Rows and columns count squares. Without marker and dictionary it is a chessboard. Printers change lengths, so
/// measure one: `measured_mm` is the length of `measured_squares` squares (by default of the longer side), and
/// `sigma_mm` the standard deviation of that measurement. `legacy_pattern` (true or false) is OpenCV's.
/// @throws DataError naming file and key
VERNIER_API Board read_board(const std::string& path);

/// A camera file: fx, fy, cx, cy [px], optionally k1, k2, p1, p2, k3, width and height [px].
/// @throws DataError naming file and key
VERNIER_API Camera read_camera_json(const std::string& path);

/// A camera as `read_camera_json` reads it; callers include <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json camera_to_json(const Camera& camera);
/// A board as `read_board` reads it.
VERNIER_API nlohmann::ordered_json board_to_json(const Board& board);

namespace detail {

/// Cameras and board of a model file.
VERNIER_API nlohmann::ordered_json setup_to_json(const CameraSetup& setup);
/// @throws DataError naming file and key
VERNIER_API CameraSetup setup_from_json(const JsonNode& node);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/camera_files.ipp"
#endif
