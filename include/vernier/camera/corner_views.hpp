// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Corners of a board as cameras saw them, by image, and the joint values or flange poses that belong to the images.

#include <span>
#include <string>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/data/csv_format.hpp"
#include "vernier/data/row_origin.hpp"

namespace vernier {

/// One board in one image of one camera.
struct View {
  std::string image;              ///< its name
  Index camera = 0;               ///< number of the camera
  Index board = 0;                ///< number of the board's place
  std::vector<Index> corners{};   ///< numbers of the corners that were found
  std::vector<Vector2> pixels{};  ///< where each was found
  Index line = 0;                 ///< of its first corner in the file
  Index width = 0;                ///< of the image [px]; 0 where the file does not state it
  Index height = 0;               ///< of the image [px]; likewise
};

/// All images of a calibration.
struct CornerViews {
  std::vector<std::string> cameras{"camera"};  ///< their names
  std::vector<std::string> boards{"board"};    ///< names of the places where the board was
  std::vector<View> views{};                   ///< in the order of the file
  std::string file{};                          ///< its name
  std::string hash{};                          ///< SHA-256 of the file

  /// Number of corners of all views.
  VERNIER_API Index corners() const;
};

/// Corners from a CSV file, a row a corner: `image` (any text), `corner` (its number, see `Board`), u_px, v_px; the
/// centre of the first pixel is (0, 0). Optional: `camera` and `board` (any text) where there are several cameras or
/// places of the board, width_px and height_px of the image, and board_x_mm and board_y_mm, which must agree with the
/// board.
/// @throws DataError naming file, line and column, also for a corner that is there twice
VERNIER_API CornerViews read_corners(const std::string& path, const Board& board, const CsvFormat& format = {});

/// The file that `read_corners` reads, to a ten-thousandth of a pixel. It has a column `camera` unless there is one
/// alone that is called so, `board` likewise, and the size of the images where all state it.
VERNIER_API std::string corners_text(const CornerViews& views);

/// Rows of a file that names the image that was taken there.
struct ImageRows {
  std::vector<std::string> images{};  ///< of each row
  MatrixX joints{};                   ///< n x joints [rad, m]; no rows where the file is of poses
  std::vector<Isometry3> flanges{};   ///< base_T_flange; none where the file is of joints
  RowOrigin origin{};                 ///< where the rows stand

  /// Number of rows.
  Index size() const { return static_cast<Index>(images.size()); }
};

/// Joint values with a column `image`, as `read_dataset` reads them.
/// @throws DataError naming file, line and column, also for an image that is there twice
VERNIER_API ImageRows read_image_joints(const std::string& path, int joints, std::span<const JointType> types = {},
                                        const CsvFormat& format = {});
/// The file that `read_image_joints` reads.
/// @param types of the joints; none: all are revolute
/// @throws std::invalid_argument for a name that no cell can have
VERNIER_API std::string image_joints_text(const ImageRows& rows, std::span<const JointType> types = {});
/// Poses of the flange with a column `image`: x_mm, y_mm, z_mm, rx_rad, ry_rad, rz_rad.
/// @throws DataError naming file, line and column, also for an image that is there twice
VERNIER_API ImageRows read_flange_poses(const std::string& path, const CsvFormat& format = {});

/// Views and the rows of their images.
struct MatchedViews {
  std::vector<std::size_t> views{};            ///< those that have a row
  std::vector<Index> rows{};                   ///< the row of each
  std::vector<std::string> without_row{};      ///< images of views that have none
  std::vector<std::string> without_corners{};  ///< images of rows that no view is of
};
/// Finds the row of each view by the name of its image.
/// @throws DataError where no name matches, with a name of each file
VERNIER_API MatchedViews match_images(const CornerViews& views, const ImageRows& rows);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/camera/corner_views.ipp"
#endif
