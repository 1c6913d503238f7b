// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a calibration by cameras found: intrinsics, frames, errors of images and decisions.

#include <optional>
#include <string>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// Where the camera is: on the flange, with a board that stands still, or standing still, with a board on the flange.
enum class CameraMount { flange, fixed };

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

/// What is left of a corner.
struct CornerResidual {
  Index image = 0;        ///< number of the view in `CameraReport::images`
  double u = 0;           ///< column where it was found [px]
  double v = 0;           ///< row where it was found [px]
  double residual_u = 0;  ///< modelled minus found, across [px]
  double residual_v = 0;  ///< likewise, down [px]
};

/// What one view alone says of the arm, with the intrinsics that were found.
struct ImagePose {
  Index row = 0;        ///< of the joints, or of the poses of the flange
  Index base = 0;       ///< whose base: P = base * flange * tool
  Index tool = 0;       ///< whose tool
  Isometry3 pose;       ///< P
  Matrix6 covariance;   ///< of shifts and rotations of P, rotations from the left [m, rad], by pixels alone
  MatrixX by_shared{};  ///< what unit errors of `SharedUnknowns` do to it, 6 x these [m, rad]
};

/// What all images share: the intrinsics of each camera that were estimated [px, 1], then the scale of the board [1]
/// and its bend [m].
struct SharedUnknowns {
  MatrixX covariance{};   ///< of their errors, which the poses of all images have in common
  MatrixX information{};  ///< what images and priors say of them, wherever the arm was: inverse of a covariance
  VectorX gradient{};     ///< of half the sum of squares behind that, at the present values
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
  std::vector<MatrixX> camera_covariances{};  ///< of the nine intrinsics of each camera; 0 for those that were held
  SharedUnknowns shared{};                    ///< empty where nothing is shared, or its covariance is not known
  Board board{};                              ///< as stated
  double board_scale = 1;                     ///< lengths of the board in those that were stated
  double board_scale_std = 0;                 ///< its standard deviation
  Vector3 board_bend{0, 0, 0};                ///< heights at half a diagonal from the middle: xx, xy, yy [m]
  /// What stands still, in the arm's base frame: base_T_camera of each camera, or base_T_board of each place.
  std::vector<Isometry3> in_base{};
  std::vector<Vector6> in_base_std{};  ///< standard deviations of shifts [m] and rotations [rad]
  /// What the flange carries, in its frame: flange_T_board, or flange_T_camera of each camera.
  std::vector<Isometry3> in_flange{};
  std::vector<Vector6> in_flange_std{};        ///< likewise
  std::vector<ImageError> images{};            ///< in the order of the file
  std::vector<CornerResidual> residuals{};     ///< of the corners of all images
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

  /// Number of images and of corners, and where the camera is, in words.
  VERNIER_API std::string counts() const;
  /// The error first, then how sure it is, and what was not used: at most seven lines.
  VERNIER_API std::vector<std::string> verdict() const;
  /// Frames and intrinsics with their standard deviations, as lines.
  VERNIER_API std::string frames_and_intrinsics() const;
  /// A text of a screen: the verdict, frames and intrinsics.
  VERNIER_API std::string summary() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/camera_report.ipp"
#endif
