// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Calibration by cameras and a printed board: intrinsics, base, tool and the arm's geometry from images alone.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/camera/corner_views.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/calibrated.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/least_squares/loss.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

/// Where the camera is: on the flange, with a board that stands still, or standing still, with a board on the flange.
enum class CameraMount { flange, fixed };

/// Options of a calibration by cameras.
struct CameraOptions {
  CameraMount mount = CameraMount::flange;  ///< where the camera is
  /// Intrinsics, one for each camera of the views, which then stay; none: they are unknown, and so are their starts.
  std::vector<Camera> cameras{};
  /// Intrinsics, by name, that are estimated from the start on, with priors around those that are given. Radial
  /// distortion of an order brings that of lower orders along.
  std::vector<std::string> free{};
  /// Whether left-out images decide on further unknowns: radial and tangential distortion, focal lengths, principal
  /// point, radial distortion of sixth order, a bent board.
  bool choose = true;
  bool left_out = true;        ///< whether images are left out in turn to report errors at them
  double pixel_sigma = 0.2;    ///< standard deviation of a corner, per coordinate, where the iteration starts [px]
  Loss loss = Loss::huber;     ///< how residuals are weighted; huber tolerates wrong corners
  IdentifyOptions geometry{};  ///< which parameters of the arm are estimated, with which priors
};

/// Errors of one view.
struct ImageError {
  std::string image;         ///< its name
  Index camera = 0;          ///< of which camera
  Index board = 0;           ///< of which place of the board
  Index corners = 0;         ///< number that were found
  double pixel_rms = 0;      ///< of the distances in the image [px]
  double board_mean = 0;     ///< mean distance on the board [m]
  double left_out_mean = 0;  ///< mean distance on the board, predicted without this image [m]; 0 if not asked for
  double left_out_max = 0;   ///< largest one [m]
  double distance = 0;       ///< from camera to the middle of the board [m]
  double tilt = 0;           ///< between the view and the board's normal [rad]
};

/// What one view alone says of the arm, with the intrinsics that were found.
struct ImagePose {
  Index row = 0;       ///< of the joints, or of the poses of the flange
  Index base = 0;      ///< whose base: P = base * flange * tool
  Index tool = 0;      ///< whose tool
  Isometry3 pose;      ///< P
  Matrix6 covariance;  ///< of shifts and rotations of P, rotations from the left [m, rad]
};

/// Unknowns on which left-out images decided.
struct CameraBlock {
  std::string name;    ///< "radial distortion"
  double without = 0;  ///< mean over images of the median distance on the board, left out [m]
  double with = 0;     ///< the same with the block
  bool kept = false;   ///< whether it is estimated
};

/// What a calibration by cameras found.
struct CameraReport {
  CameraMount mount = CameraMount::flange;  ///< where the camera is
  std::vector<std::string> camera_names{};  ///< as the file of corners has them
  std::vector<std::string> board_names{};   ///< of the places of the board
  std::vector<Camera> cameras{};            ///< estimated, or as given
  std::vector<VectorX> camera_std{};        ///< standard deviations of the nine intrinsics; 0 for those that were held
  Board board{};                            ///< as stated
  double board_scale = 1;                   ///< lengths of the board in those that were stated
  double board_scale_std = 0;               ///< its standard deviation
  Vector3 board_bend{0, 0, 0};              ///< heights at half a diagonal from the middle: xx, xy, yy [m]
  /// What stands still, in the arm's base frame: base_T_camera of each camera, or base_T_board of each place.
  std::vector<Isometry3> in_base{};
  std::vector<Vector6> in_base_std{};  ///< standard deviations of shifts [m] and rotations [rad]
  /// What the flange carries, in its frame: flange_T_board, or flange_T_camera of each camera.
  std::vector<Isometry3> in_flange{};
  std::vector<Vector6> in_flange_std{};        ///< likewise
  std::vector<ImageError> images{};            ///< in the order of the file
  std::vector<ImagePose> poses{};              ///< of the views that determine one
  std::vector<CameraBlock> blocks{};           ///< in the order in which they were tried
  std::vector<std::string> without_row{};      ///< images without joints or pose of the flange
  std::vector<std::string> without_corners{};  ///< rows without an image
  Index ambiguous = 0;                         ///< number of views whose better fitting pose was the wrong one of two
  Index downweighted = 0;                      ///< number of corners that count less than half
  double pixel_sigma = 0;         ///< standard deviation of a corner about the pose that its image shows best [px]
  double pose_excess = 1;         ///< scatter of the images' poses about the arm, in multiples of what pixels explain
  double mean = 0;                ///< distance on the board, mean of all corners [m]
  double left_out_mean = 0;       ///< the same of left-out images; 0 where none were left out
  double left_out_max = 0;        ///< largest one
  bool choices_repeated = false;  ///< whether all decisions were made again without each left-out image
  std::optional<ArmGeometry> arm{};  ///< chain between base and tool; none where only poses were given
  /// Parameters of the chain that were estimated: name, value less nominal, standard deviation [m, rad].
  struct Parameter {
    std::string name;     ///< as in `--fix`
    double change = 0;    ///< value less nominal
    double std = 0;       ///< standard deviation
    bool length = false;  ///< whether it is in metres; else in radians
  };
  std::vector<Parameter> parameters{};  ///< of the chain, those that were estimated
  double scale_effect = 0;              ///< what one standard deviation of the board's scale is at the arm's reach [m]

  /// A text of a screen.
  VERNIER_API std::string summary() const;
};

namespace detail {

VERNIER_API CameraReport calibrate_cameras(const std::optional<ArmGeometry>& nominal, const Board& board,
                                           const CornerViews& views, const ImageRows& rows,
                                           const CameraOptions& options);

}  // namespace detail

/// Base and tool, and intrinsics if they are unknown, from poses of the flange.
/// @param board   the printed board
/// @param views   its corners in images
/// @param rows    poses of the flange
/// @param options where the camera is, and what is known of it
/// @throws CalibrationFailure for images that do not determine it, with the reason
/// @throws DataError for images of another size than the intrinsics are of
inline CameraReport calibrate_hand_eye(const Board& board, const CornerViews& views, const ImageRows& rows,
                                       const CameraOptions& options = {}) {
  return detail::calibrate_cameras(std::nullopt, board, views, rows, options);
}

/// An arm that was calibrated by cameras.
template <class Chain>
struct CalibratedByCamera : CameraReport {
  Calibrated<Chain> model;  ///< in base and tool frame of the first camera and place: P = base * FK * tool

  /// Joins the two.
  CalibratedByCamera(CameraReport report, const Calibrated<Chain>& calibrated)
      : CameraReport(std::move(report)), model(calibrated) {}
};

/// The geometry of an arm, base, tool and intrinsics in one least-squares problem.
///
///     const Board board = read_board("board.json");
///     const CornerViews views = read_corners("corners.csv", board);
///     const auto found = calibrate_by_camera(robots::ur10(), board, views, read_image_joints("joints.csv", 6));
///     std::puts(found.summary().c_str());
/// @param arm     as designed
/// @param board   the printed board
/// @param views   its corners in images
/// @param rows    joint values
/// @param options where the camera is, and what is known of it
/// @throws CalibrationFailure for images that do not determine it, with the reason
/// @throws DataError for images of another size than the intrinsics are of
/// @cite Zhang 2000; Strobl and Hirzinger 2006
template <NominalArm Arm>
CalibratedByCamera<ChainOf<Arm>> calibrate_by_camera(const Arm& arm, const Board& board, const CornerViews& views,
                                                     const ImageRows& rows, const CameraOptions& options = {}) {
  const Framed<ChainOf<Arm>> nominal = in_frames(arm);
  CameraReport report = detail::calibrate_cameras(ArmGeometry(nominal), board, views, rows, options);
  const Calibrated<ChainOf<Arm>> model(report.arm->framed(nominal.model()), nominal.model());
  return {std::move(report), model};
}

/// Poses that single images show, with their covariances: measurements for `calibrate`, which finds joint errors, too.
/// One set for each place of the board, or for each camera that stands still.
/// @param report of one camera on the flange, or of one board there
/// @param rows   the joint values that it was made from
/// @throws std::invalid_argument where the flange carries several
template <int N>
Measurements<N> measured_poses(const CameraReport& report, const ImageRows& rows) {
  demand(report.in_flange.size() == 1, "measured_poses: the flange carries ", report.in_flange.size(),
         " cameras or boards, each is a tool of its own");
  Measurements<N> out;
  const auto& names = report.mount == CameraMount::flange ? report.board_names : report.camera_names;
  for (std::size_t base = 0; base < report.in_base.size(); ++base) {
    std::vector<const ImagePose*> here;
    for (const ImagePose& pose : report.poses)
      if (pose.base == static_cast<Index>(base)) here.push_back(&pose);
    const auto n = static_cast<Index>(here.size());
    if (n == 0) continue;
    JointRows<N> joints(n, N);
    PointRows positions(n, 3), orientations(n, 3);
    std::vector<Matrix6> covariances;
    for (Index i = 0; i < n; ++i) {
      const ImagePose& pose = *here[static_cast<std::size_t>(i)];
      for (Index j = 0; j < N; ++j) joints(i, j) = rows.joints(pose.row, j);
      set_point(positions, i, translation(pose.pose));
      set_point(orientations, i, log_so3(rotation(pose.pose)));
      covariances.push_back(pose.covariance);
    }
    out.add(Dataset<N>(joints, positions, orientations).without_approach().with_covariances(std::move(covariances)),
            names[base]);
  }
  return out;
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/camera_calibration.ipp"
#endif
