// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Calibration by cameras and a printed board: intrinsics, base, tool and the arm's geometry from images alone.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/calibration/camera_report.hpp"
#include "vernier/camera/corner_views.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/calibrated.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/least_squares/loss.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

/// Intrinsics and a shape of the board that stay as they are.
struct HeldCameras {
  std::vector<Camera> cameras{};  ///< one for each camera of the views
  double board_scale = 1;         ///< as in `CameraReport`
  Vector3 board_bend{0, 0, 0};    ///< likewise [m]
};

/// Parts of the work of a calibration by cameras, of which an observer is told.
inline constexpr Index camera_steps = 100;

/// Options of a calibration by cameras.
struct CameraOptions {
  CameraMount mount = CameraMount::flange;  ///< where the camera is
  /// Intrinsics, one for each camera of the views, which then stay; none: they are unknown, and so are their starts.
  std::vector<Camera> cameras{};
  /// Intrinsics, by name, that are estimated from the start on, with priors around those that are given. Radial
  /// distortion of an order brings that of lower orders along.
  std::vector<std::string> free{};
  /// Whether left-out images decide on further unknowns: radial and tangential distortion, focal lengths, principal
  /// point, radial distortion of sixth order, a bent board. They are estimated if a test at 1 % finds them, they
  /// explain a tenth of the error, and left-out images are not predicted worse.
  bool choose = true;
  /// Values that intrinsics and board keep, without `choose` and `left_out`. What is free is reported all the same: how
  /// well it is known, and what its errors do to poses.
  std::optional<HeldCameras> held{};
  bool bend = false;           ///< whether a bend of the board is estimated from the start on
  bool left_out = true;        ///< whether images are left out in turn to report errors at them
  Loss loss = Loss::huber;     ///< how residuals are weighted; huber tolerates wrong corners
  IdentifyOptions geometry{};  ///< which parameters of the arm are estimated, with which priors
  /// Who watches; must outlive the call. Told after each fit how many of `camera_steps` are done
  /// (`Progress::generation`), as far as that can be foreseen. It cannot stop the calibration.
  ObserverRef observer{};
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
    Dataset<N> poses =
        Dataset<N>(joints, positions, orientations).without_approach().with_covariances(std::move(covariances));
    if (!rows.origin.empty()) {
      std::vector<Index> origins;
      for (const ImagePose* pose : here) origins.push_back(pose->row);
      poses = poses.from(rows.origin.rows(origins));
    }
    out.add(std::move(poses), names[base]);
  }
  return out;
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/camera_calibration.ipp"
#endif
