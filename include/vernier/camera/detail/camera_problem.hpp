// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Images of a board, the cameras that took them and the arm between both, as one least-squares problem.

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "vernier/camera/corner_views.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/least_squares/damped_iteration.hpp"
#include "vernier/least_squares/loss.hpp"

namespace vernier::detail {

/// A board that may be of another size and bent.
struct BoardShape {
  double scale = 0;       ///< by which share all lengths are larger
  Vector3 bend{0, 0, 0};  ///< height at half a diagonal from the middle: along x, along both, along y [m]
  /// Place of a corner [m], and its derivatives by scale and bend.
  VERNIER_API Vector3 corner(const Board& board, Index k, Eigen::Matrix<double, 3, 4>* by_shape = nullptr) const;
};

/// The values of all unknowns. P = base * flange * tool is the pose that an image sees: of the board in the camera's
/// frame where the camera stands still, of the camera in the board's frame where the flange carries it.
struct CameraState {
  std::optional<ArmGeometry> arm{};  ///< chain without frames; none where poses of the flange are given
  std::vector<Isometry3> bases{};    ///< of each camera that stands still, or of each place of the board
  std::vector<Isometry3> tools{};    ///< of each board, or of each camera
  std::vector<Camera> cameras{};
  BoardShape shape{};
};

/// Which unknowns there are beside base and tool.
struct CameraFreedom {
  std::array<bool, 9> intrinsics{};  ///< in the order of `Camera::names`
  bool scale = false;                ///< of the board
  bool bend = false;                 ///< of the board
  bool arm = false;                  ///< the parameters of the chain
};

/// A view of which the least-squares problem knows where the flange was.
struct PlacedView {
  const View* view;
  Index row;   ///< of the joints or poses
  Index base;  ///< whose base
  Index tool;  ///< whose tool
};

/// Means and standard deviations of the priors.
struct CameraPriors {
  std::vector<Camera> cameras{};  ///< means
  VectorX intrinsics{};           ///< standard deviations, in the order of `Camera::names`; infinite for none
  double bend = 0.5e-3;           ///< standard deviation [m]
  VectorX arm_means{};            ///< of the parameters of the chain, as `ArmGeometry` counts them
  std::vector<Index> arm{};       ///< parameters of the chain that may be estimated
  VectorX arm_scales{};           ///< standard deviations of all parameters
};

/// The problem. Views outside of it are predicted.
class CameraProblem {
 public:
  /// @param mounted_on_flange whether the flange carries the camera
  /// @param nominal_board     flat
  /// @param placed            the views
  /// @param rows_of_images    joints or poses of the flange; outlives this
  /// @param start             values of the unknowns
  VERNIER_API CameraProblem(bool mounted_on_flange, const Board& nominal_board, std::vector<PlacedView> placed,
                            const ImageRows& rows_of_images, CameraState start, CameraPriors prior_values);

  CameraState state;
  CameraFreedom free;
  CameraPriors priors;
  double pixel_sigma = 0.2;  ///< standard deviation of a pixel's coordinate
  Loss loss = Loss::huber;

  const std::vector<PlacedView>& views() const { return views_; }
  const Board& board() const { return board_; }
  bool on_flange() const { return on_flange_; }
  /// Number of unknowns.
  VERNIER_API Index unknowns() const;
  /// Their names.
  VERNIER_API std::vector<std::string> names() const;
  /// Their scales, in which steps are counted.
  VERNIER_API VectorX scales() const;
  /// Number of values measured.
  VERNIER_API Index values() const;
  /// Modelled poses P of all views.
  VERNIER_API std::vector<Isometry3> poses() const;

  /// Weighted rows of a view at a pose: columns of a small motion of P (6), intrinsics that are free, shape of the
  /// board that is free, and the residual; two rows a corner.
  /// @return no rows where a corner is not in front of the camera
  VERNIER_API MatrixX view_rows(std::size_t view, const Isometry3& pose) const;
  /// Rows of the whole problem without reduction, residual last: for tests.
  VERNIER_API MatrixX dense_rows() const;
  /// The problem with every view reduced to blocks of six rows, at the present values.
  VERNIER_API NormalEquations normal_equations() const;
  /// Precisions of the priors of the unknowns, and present values relative to their means, in steps.
  VERNIER_API std::pair<VectorX, VectorX> prior_terms() const;

  /// Minimises from the present values.
  VERNIER_API IterationEnd solve(int max_iterations = 60);
  /// Inverse of the normal equations with priors: the covariance of the unknowns in steps, for a unit of noise.
  VERNIER_API MatrixX covariance() const;
  /// How images scatter about the model.
  struct Scatter {
    double pixels = 0;  ///< standard deviation of a coordinate about the pose that its image shows best [px]
    double poses =
        1;  ///< variance of these poses about the arm, in multiples of what `pixel_sigma` explains; at least 1
  };
  /// At the present values.
  VERNIER_API Scatter scatter() const;
  /// Covariance of the unknowns in steps by the jackknife over images: errors that the corners of an image share count.
  /// @cite Efron 1982
  VERNIER_API MatrixX jackknife() const;
  /// All weights one.
  VERNIER_API void reset_weights();
  /// Present weight of a corner of a view.
  double weight(std::size_t view, std::size_t corner) const { return weights_[view][corner]; }

  /// Residuals (modelled minus found) of the corners of a view at a pose [px]; not finite behind the camera.
  VERNIER_API std::vector<Vector2> residuals(const PlacedView& view, const Isometry3& pose) const;
  /// Distances on the board from where a pixel says a corner is to where it is [m].
  VERNIER_API VectorX board_errors(const PlacedView& view, const Isometry3& pose) const;
  /// The pose P that a view alone shows, by least squares from the modelled one, and its covariance: of shifts [m] and
  /// rotations [rad] of P, in the frame in which P is.
  /// @return nothing where its corners do not determine a pose
  VERNIER_API std::optional<std::pair<Isometry3, Matrix6>> seen_pose(std::size_t view) const;
  /// What intrinsics and the shape of the board do to the pose that a view alone shows, at that pose: 6 x those of all
  /// cameras and the board that are free, in steps, in their order.
  VERNIER_API MatrixX effect_of_shared(std::size_t view, const Isometry3& pose) const;
  /// What a view alone says of intrinsics and shape, at the pose that it shows: adds to information and gradient of the
  /// sum of squares, of these unknowns in their order, for a unit of noise.
  VERNIER_API void add_own(std::size_t view, const Isometry3& pose, MatrixX& information, VectorX& gradient) const;
  /// Modelled pose of any view.
  VERNIER_API Isometry3 pose_of(const PlacedView& view) const;

 private:
  /// Every view reduced to blocks of six rows, as many each.
  VERNIER_API std::vector<RowBlock> reduced_blocks() const;
  /// Changes the unknowns.
  VERNIER_API void move(const VectorX& steps);
  /// Columns of P by the chain, the bases and the tools, in steps, for each view.
  VERNIER_API std::vector<MatrixX> motion_columns(std::vector<Isometry3>& poses) const;
  /// Poses of the flange of all rows, and the derivatives by the parameters of the chain where these are free.
  VERNIER_API void flanges(std::vector<Isometry3>& out, PosesAndJacobians* derivatives) const;
  /// New weights of the loss; sums of squares with the old ones and the new ones.
  VERNIER_API std::array<double, 2> reweight(const std::vector<Isometry3>& poses);
  VERNIER_API std::vector<Index> free_intrinsics() const;
  /// Columns of the shape of the board: scale, three of the bend.
  VERNIER_API std::vector<Index> free_shape() const;

  bool on_flange_;
  Board board_;
  std::vector<PlacedView> views_;
  const ImageRows* rows_;
  std::vector<std::vector<double>> weights_;
};

/// Improves intrinsics and the poses of boards by images alone, wherever the arm was.
/// @param problem whose views, cameras and freedom of intrinsics count; the cameras are changed
/// @param poses   camera_T_board of each view
/// @return        whether the iteration came to an end
VERNIER_API bool refine_cameras(CameraProblem& problem, std::vector<Isometry3>& poses);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/camera/detail/camera_problem.ipp"
#endif
