// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Joint errors from images: geometry, joint errors, frames and intrinsics, each fitted with what the other fit found.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

/// An arm with joint errors that was calibrated by a camera.
template <class Chain>
struct JointsByCamera {
  CalibratedByCamera<Chain> camera;  ///< of the last round: intrinsics, frames and geometry beside the joint errors
  Measurements<Chain::dof> poses;    ///< that images show with these intrinsics; the last joint errors are from them
  JointErrors errors;                ///< of the joints
  /// How far each round moved the intrinsics: the largest change, in standard deviations.
  std::vector<double> moved{};
  bool converged = false;  ///< whether the last one moved them by less than a tenth
};

/// Measured poses of a station whose errors have parts in common with those of others: a camera that took all images
/// has one focal length.
struct SharedErrors {
  MatrixX joints;                      ///< n x joints [rad, m]
  std::vector<Matrix6> covariances{};  ///< of each pose, by what it shares with none [m, rad]
  std::vector<MatrixX> effects{};      ///< what unit values of the common errors do to each, 6 x common errors [m, rad]
};

/// The covariance of an estimate with that which errors bring that the poses of all stations share. Where it was fitted
/// with the covariances of poses as they are, and is linear, that of a fit which estimates these errors as well.
/// @param estimate of a fit
/// @param stations poses that it was fitted to, one set a station
/// @param common   covariance of the common errors
inline MatrixX covariance_with_shared_errors(const ErrorModelEstimate& estimate,
                                             const std::vector<SharedErrors>& stations, const MatrixX& common) {
  const ArmParameterisation& arm = estimate.arm;
  MatrixX out = estimate.covariance;
  if (common.size() == 0 || out.size() == 0) return out;
  MatrixX right = MatrixX::Zero(arm.size(), common.cols());  // J' W G
  Rows6 rows(6, arm.size());
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const SharedErrors& poses = stations[s];
    const auto n = static_cast<std::size_t>(poses.joints.rows());
    demand(poses.covariances.size() == n && poses.effects.size() == n,
           "covariance_with_shared_errors: ", poses.effects.size(), " effects and ", poses.covariances.size(),
           " covariances of ", n, " poses");
    std::vector<RowBlock> linear(n);
    arm.linearise(static_cast<int>(s), poses.joints, MatrixX(), linear.data());
    for (std::size_t i = 0; i < n; ++i) {
      linear[i].expand(arm.group_sizes(), rows);
      MatrixX factor = poses.covariances[i], weighted = poses.effects[i];
      demand(detail::cholesky(factor), "covariance_with_shared_errors: a covariance is not positive definite");
      detail::solve_cholesky(factor, weighted);
      detail::add_transposed_product(right, rows, weighted);
    }
  }
  const MatrixX moved = detail::matrix_product(out, right) / estimate.variance_factor;
  out += detail::matrix_product(detail::matrix_product(moved, common), moved.transpose());
  return out;
}

/// The errors that the poses of all images share, one set for each of `measured_poses`.
inline std::vector<SharedErrors> shared_errors(const CameraReport& report, const ImageRows& rows) {
  std::vector<SharedErrors> out;
  for (std::size_t base = 0; base < report.in_base.size(); ++base) {
    std::vector<Index> here;
    SharedErrors one;
    for (const ImagePose& pose : report.poses)
      if (pose.base == static_cast<Index>(base)) {
        here.push_back(pose.row);
        one.covariances.push_back(pose.covariance);
        one.effects.push_back(pose.by_shared);
      }
    if (here.empty()) continue;
    one.joints.resize(static_cast<Index>(here.size()), rows.joints.cols());
    for (std::size_t i = 0; i < here.size(); ++i) one.joints.row(static_cast<Index>(i)) = rows.joints.row(here[i]);
    out.push_back(std::move(one));
  }
  return out;
}

namespace detail {

/// Options of a round that keeps the decisions of the first.
VERNIER_API inline CameraOptions decided(CameraOptions options, const CameraReport& first) {
  options.choose = options.left_out = false;
  for (std::size_t k = 0; k < Camera::names.size(); ++k)
    for (const VectorX& std : first.camera_std)
      if (std(static_cast<Index>(k)) > 0 &&
          std::find(options.free.begin(), options.free.end(), Camera::names[k]) == options.free.end())
        options.free.emplace_back(Camera::names[k]);
  for (const CameraBlock& block : first.blocks)
    options.bend = options.bend || (block.kept && block.name == "bent board");
  return options;
}

/// The largest change of an intrinsic, in standard deviations.
VERNIER_API inline double change_of_intrinsics(const CameraReport& before, const CameraReport& after) {
  double out = 0;
  for (std::size_t c = 0; c < before.cameras.size(); ++c) {
    const VectorX change = after.cameras[c].parameters() - before.cameras[c].parameters();
    for (Index k = 0; k < change.size(); ++k)
      if (const double std = after.camera_std[c](k); std > 0) out = (std::max)(out, std::abs(change(k)) / std);
  }
  return out;
}

}  // namespace detail

/// Calibrates an arm with joint errors by a camera. The first round is `calibrate_by_camera`. Then joint errors are
/// found from the poses that images show, and intrinsics, frames and geometry again with these errors held, until the
/// intrinsics rest. Both fits minimise the same residuals of pixels, over unknowns that overlap in frames and geometry:
/// where they rest, no unknown of either can improve them. What differs are the priors of links and the weights of
/// wrong corners, which each fit chooses for itself.
/// @param fit_joints joint errors of poses: `JointErrors(const Measurements<N>&)`. Tilts of joint frames are no errors
/// of
///                   joint values, so it must find none; called once a round
/// @param most       rounds
/// @throws CalibrationFailure and DataError as `calibrate_by_camera` does
template <NominalArm Arm, class FitJoints>
JointsByCamera<ChainOf<Arm>> calibrate_joints_by_camera(const Arm& arm, const Board& board, const CornerViews& views,
                                                        const ImageRows& rows, const CameraOptions& options,
                                                        const FitJoints& fit_joints, int most = 5) {
  constexpr int N = ChainOf<Arm>::dof;
  JointsByCamera<ChainOf<Arm>> out{calibrate_by_camera(arm, board, views, rows, options), {}, {}};
  const CameraReport first = out.camera;
  const CameraOptions again = detail::decided(options, first);
  for (int round = 0;; ++round) {
    out.poses = measured_poses<N>(out.camera, rows);
    out.errors = fit_joints(std::as_const(out.poses));
    demand(out.errors.empty() || !out.errors.tilts(), "calibrate_joints_by_camera: joint errors with tilts");
    out.converged = out.errors.empty() || (!out.moved.empty() && out.moved.back() < 0.1);
    if (out.converged || round == most) return out;
    ImageRows effective = rows;
    effective.joints = out.errors.effective_rows(rows.joints);
    auto next = calibrate_by_camera(arm, board, views, effective, again);
    out.moved.push_back(detail::change_of_intrinsics(out.camera, next));
    next.blocks = first.blocks;
    next.left_out_mean = first.left_out_mean;
    next.left_out_max = first.left_out_max;
    next.choices_repeated = first.choices_repeated;
    for (std::size_t k = 0; k < next.images.size(); ++k) {
      next.images[k].left_out_mean = first.images[k].left_out_mean;
      next.images[k].left_out_max = first.images[k].left_out_max;
    }
    out.camera = std::move(next);
  }
}

}  // namespace vernier
