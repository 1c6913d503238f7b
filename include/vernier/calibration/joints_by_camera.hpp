// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Joint errors from images: geometry, joint errors, frames and intrinsics as one problem.

#include <utility>
#include <vector>

#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/core/executor.hpp"
#include "vernier/error_model/detail/refit.hpp"
#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// What a fit found from the poses that images show.
struct JointFit {
  ErrorModelEstimate estimate;  ///< of geometry and joint errors, one station a set of poses
  SensorModel sensors{};        ///< with which it was fitted
  ExecutorRef executor{};       ///< for fits to come
};

/// An arm with joint errors that was calibrated by a camera.
template <class Chain>
struct JointsByCamera {
  CalibratedByCamera<Chain> camera;  ///< of the last round, with its intrinsics; `shared.covariance` is that of both
  Measurements<Chain::dof> poses;    ///< that images show with these intrinsics
  JointErrors errors;                ///< of the joints, from these poses
  /// How far each round was to move the intrinsics: the largest step, in standard deviations.
  std::vector<double> moved{};
  bool converged = false;  ///< whether the last step was below a tenth, and was not taken
};

/// Measured poses of a station whose errors have parts in common with those of others: a camera that took all images
/// has one focal length.
struct SharedErrors {
  MatrixX joints;                      ///< n x joints [rad, m]
  std::vector<Isometry3> poses{};      ///< as measured; may be empty where covariances alone matter
  std::vector<Matrix6> covariances{};  ///< of each pose, by what it shares with none [m, rad]
  std::vector<MatrixX> effects{};      ///< what unit values of the common errors do to each, 6 x common errors [m, rad]
};

/// The covariance of an estimate with that which errors bring that the poses of all stations share. Where it was fitted
/// with the covariances of poses as they are, and is linear, that of a fit which estimates these errors as well.
/// @param estimate of a fit
/// @param stations poses that it was fitted to, one set a station
/// @param common   covariance of the common errors
/// @throws std::invalid_argument for a station with another number of effects or covariances than poses
VERNIER_API MatrixX covariance_with_shared_errors(const ErrorModelEstimate& estimate,
                                                  const std::vector<SharedErrors>& stations, const MatrixX& common);

/// The errors that the poses of all images share, one set for each of `measured_poses`.
VERNIER_API std::vector<SharedErrors> shared_errors(const CameraReport& report, const ImageRows& rows);

namespace detail {

/// Options of a round that keeps the decisions of the first.
VERNIER_API CameraOptions decided(CameraOptions options, const CameraReport& first);

/// Frees the links of an estimate to some centimetres. An error model holds them near the identified arm, whose lengths
/// follow the scale of the board: that is no knowledge of this scale.
VERNIER_API void free_links(ErrorModelEstimate& estimate);

/// The Newton step of what all images share, of the least sum of squares over everything else: images by themselves,
/// and their poses about an arm that moves along. The report takes its covariance, and standard deviations by it.
/// @param estimate of the arm, fitted to the poses that images show
/// @param rows     joints of the images
/// @param loss     how poses are weighted
/// @param camera   of the images; something must be shared
/// @return the step, in the order of `SharedUnknowns`
VERNIER_API VectorX shared_step(const ErrorModelEstimate& estimate, const ImageRows& rows, Loss loss,
                                CameraReport& camera);

/// The largest of some steps, in standard deviations.
VERNIER_API double largest_step(const VectorX& step, const MatrixX& covariance);

/// Intrinsics and shape of the board, moved.
VERNIER_API HeldCameras moved_cameras(const CameraReport& camera, const VectorX& step);

/// Gives a report of a later round what the first says of left-out images.
VERNIER_API void take_left_out(const CameraReport& first, CameraReport& later);

/// Rows at the joint values that joint errors make of them.
/// @throws std::invalid_argument for errors that are not of joint values: tilts, straightness
VERNIER_API ImageRows with_joint_errors(ImageRows rows, const JointErrors& errors);

}  // namespace detail

/// Calibrates an arm with joint errors by a camera. `calibrate_by_camera` comes first, without joint errors and
/// then with those of a first fit, where left-out images decide. Rounds follow:
///
/// 1. Joint errors, links and frames are fitted to the poses that images show. From the second round on, no more is
///    decided on which joint errors there are.
/// 2. Intrinsics and the shape of the board take a Newton step of the least sum of squares over all of these unknowns.
/// 3. With these intrinsics the images show other poses.
///
/// They end where the step is small against its standard deviation: there the gradient of the whole problem is zero.
/// Poses stand for their corners by their covariances, which are computed again in each round. Which joint errors there
/// are, their priors, and the weights of wrong corners are those of the first round. A calibration from the poses that
/// were found decides on them again.
/// @param fit_joints a fit to poses: `JointFit(const Measurements<N>&)`. Tilts of joint frames are no errors of joint
///                   values, so it must find none; called twice, and in each round if it has an earlier calibration as
///                   its prior
/// @param options    where the camera is, and what is known of it; the observer is told of the calibration by camera
///                   that decides, the longest one
/// @param most       rounds
/// @throws CalibrationFailure and DataError as `calibrate_by_camera` does
/// @cite Golub and Pereyra 1973
template <NominalArm Arm, class FitJoints>
JointsByCamera<ChainOf<Arm>> calibrate_joints_by_camera(const Arm& arm, const Board& board, const CornerViews& views,
                                                        const ImageRows& rows, const CameraOptions& options,
                                                        const FitJoints& fit_joints, int most = 6) {
  constexpr int N = ChainOf<Arm>::dof;
  CameraOptions rough = options;  // errors of the joints hide what left-out images would decide on
  rough.choose = rough.left_out = false;
  rough.observer = {};
  ImageRows effective = rows;
  const auto with_errors = [&](const CameraOptions& now) {
    return calibrate_by_camera(arm, board, views, effective, now);
  };
  JointsByCamera<ChainOf<Arm>> out{with_errors(rough), {}, {}};
  const JointFit rough_fit = fit_joints(measured_poses<N>(out.camera, rows));
  effective = detail::with_joint_errors(rows, rough_fit.estimate.arm.joint_errors());
  out.camera = with_errors(options);
  const CameraReport first = out.camera;
  CameraOptions again = detail::decided(options, first);
  out.poses = measured_poses<N>(out.camera, rows);
  JointFit fit = fit_joints(std::as_const(out.poses));
  const bool may_refit = detail::can_refit(fit.estimate);
  const auto refit = [&] { detail::refit(fit.estimate, out.poses.sets(fit.sensors), fit.sensors, fit.executor); };
  if (may_refit) {
    detail::free_links(fit.estimate);
    refit();
  }
  for (int round = 0;; ++round) {
    out.errors = fit.estimate.arm.joint_errors();
    effective = detail::with_joint_errors(rows, out.errors);
    out.converged = out.camera.shared.gradient.size() == 0;  // nothing is shared
    if (out.converged) return out;
    const VectorX step = detail::shared_step(fit.estimate, rows, options.loss, out.camera);
    out.moved.push_back(detail::largest_step(step, out.camera.shared.covariance));
    out.converged = out.moved.back() < 0.1;
    if (out.converged || round == most) return out;
    again.held = detail::moved_cameras(out.camera, step);
    out.camera = with_errors(again);
    detail::take_left_out(first, out.camera);
    out.poses = measured_poses<N>(out.camera, rows);
    if (may_refit)
      refit();
    else
      fit = fit_joints(std::as_const(out.poses));
  }
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/joints_by_camera.ipp"
#endif
