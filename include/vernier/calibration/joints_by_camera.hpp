// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Joint errors from images: geometry, joint errors, frames and intrinsics as one problem.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/least_squares/loss.hpp"

namespace vernier {

/// What a fit found from the poses that images show.
struct JointFit {
  JointErrors errors;           ///< of the joints
  ErrorModelEstimate estimate;  ///< of the same fit, one station a set of poses
};

/// An arm with joint errors that was calibrated by a camera.
template <class Chain>
struct JointsByCamera {
  CalibratedByCamera<Chain> camera;  ///< of the last round, with its intrinsics; `shared_covariance` is that of both
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
  std::vector<Matrix6> covariances{};  ///< of each pose, by what it shares with none [m, rad]
  std::vector<MatrixX> effects{};      ///< what unit values of the common errors do to each, 6 x common errors [m, rad]
};

/// The covariance of an estimate with that which errors bring that the poses of all stations share. Where it was fitted
/// with the covariances of poses as they are, and is linear, that of a fit which estimates these errors as well.
/// @param estimate of a fit
/// @param stations poses that it was fitted to, one set a station
/// @param common   covariance of the common errors
VERNIER_API inline MatrixX covariance_with_shared_errors(const ErrorModelEstimate& estimate,
                                                         const std::vector<SharedErrors>& stations,
                                                         const MatrixX& common) {
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
VERNIER_API inline std::vector<SharedErrors> shared_errors(const CameraReport& report, const ImageRows& rows) {
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

/// A step of intrinsics and the shape of the board, and their covariance.
struct SharedStep {
  VectorX step;        ///< in units of `CameraReport::shared_steps`
  MatrixX covariance;  ///< likewise
};

/// The Newton step of what all images share, of the least sum of squares over everything else: images by themselves,
/// and their poses about an arm that moves along.
/// @param estimate of the arm, fitted to the poses of `stations`
/// @param seen     those poses
VERNIER_API inline SharedStep shared_step(const ErrorModelEstimate& estimate, const std::vector<SharedErrors>& stations,
                                          const std::vector<std::vector<Isometry3>>& seen, const CameraReport& camera,
                                          Loss loss) {
  const ArmParameterisation& arm = estimate.arm;
  const Index shared = camera.own_gradient.size();
  std::vector<MatrixX> rows, effects, residuals;  // whitened
  std::vector<double> norms;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const auto n = static_cast<std::size_t>(stations[s].joints.rows());
    std::vector<RowBlock> linear(n);
    arm.linearise(static_cast<int>(s), stations[s].joints, MatrixX(), linear.data());
    const std::vector<Isometry3> modelled = arm.poses(static_cast<int>(s), stations[s].joints);
    for (std::size_t i = 0; i < n; ++i) {
      Rows6 expanded(6, arm.size());
      linear[i].expand(arm.group_sizes(), expanded);
      MatrixX factor = stations[s].covariances[i], j = expanded, g = stations[s].effects[i];
      MatrixX r = pose_difference(modelled[i], seen[s][i]);
      demand(cholesky(factor), "calibrate_joints_by_camera: a covariance is not positive definite");
      solve_lower(factor, j);
      solve_lower(factor, g);
      solve_lower(factor, r);
      norms.push_back(std::sqrt(r.squaredNorm() / 2));
      rows.push_back(std::move(j));
      effects.push_back(std::move(g));
      residuals.push_back(std::move(r));
    }
  }
  const double limit = robust_threshold(norms, 3);
  const double scatter = (std::max)(1.0, estimate.residual_variance);  // of poses about the arm
  MatrixX information = MatrixX::Zero(shared, shared), coupling = MatrixX::Zero(arm.size(), shared),
          slope = MatrixX::Zero(shared, 1), normal = MatrixX::Zero(arm.size(), arm.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double weight = (limit > 0 ? robust_weight(loss, norms[i], limit) : 1) / scatter;
    add_transposed_product(information, effects[i], effects[i], weight);
    add_transposed_product(coupling, rows[i], effects[i], weight);
    add_transposed_product(normal, rows[i], rows[i], weight);
    add_transposed_product(slope, effects[i], residuals[i], -weight);
  }
  const VectorX precisions = arm.precisions();
  for (Index k = 0; k < arm.size(); ++k) normal(k, k) += precisions(k) / scatter + 1e-9 * (1 + normal(k, k));
  demand(cholesky(normal), "calibrate_joints_by_camera: the poses do not determine the arm");
  solve_lower(normal, coupling);
  add_transposed_product(information, coupling, coupling, -1);  // what the arm absorbs
  information += camera.own_information;
  SharedStep out{-(camera.own_gradient + slope.col(0)), {}};
  demand(cholesky(information), "calibrate_joints_by_camera: the images do not determine the intrinsics");
  out.covariance = inverse_from_cholesky(information);
  solve_cholesky(information, out.step);
  return out;
}

/// Standard deviations of intrinsics and scale by a covariance of what images share.
VERNIER_API inline void state_std(const MatrixX& covariance, CameraReport& camera) {
  Index at = 0;
  for (std::size_t c = 0; c < camera.cameras.size(); ++c) {
    std::vector<Index> row;  // of each intrinsic; below 0 for those that were held
    for (Index k = 0; k < Camera::num_parameters; ++k) row.push_back(camera.camera_std[c](k) > 0 ? at++ : -1);
    for (Index k = 0; k < Camera::num_parameters; ++k)
      for (Index j = 0; j < Camera::num_parameters; ++j) {
        const Index r = row[static_cast<std::size_t>(k)], s = row[static_cast<std::size_t>(j)];
        if (r < 0 || s < 0) continue;
        camera.camera_covariances[c](k, j) = covariance(r, s) * camera.shared_steps(r) * camera.shared_steps(s);
        if (k == j) camera.camera_std[c](k) = std::sqrt(camera.camera_covariances[c](k, k));
      }
  }
  if ((covariance.rows() - at) % 3 == 1)
    camera.board_scale_std = std::sqrt(covariance(at, at)) * camera.shared_steps(at);
}

/// Intrinsics and shape of the board, moved.
VERNIER_API inline HeldCameras moved_cameras(const CameraReport& camera, const VectorX& step) {
  HeldCameras out{camera.cameras, camera.held_shape};
  Index at = 0;
  for (std::size_t c = 0; c < out.cameras.size(); ++c) {
    VectorX values = out.cameras[c].parameters();
    for (Index k = 0; k < values.size(); ++k)
      if (camera.camera_std[c](k) > 0) {
        values(k) += step(at) * camera.shared_steps(at);
        ++at;
      }
    out.cameras[c] = out.cameras[c].with_parameters(values);
  }
  const Index rest = step.size() - at;  // the scale, the bend, or both
  for (Index k = rest % 3 == 1 ? 0 : 1; at < step.size(); ++k, ++at)
    out.shape[static_cast<std::size_t>(k)] += step(at) * camera.shared_steps(at);
  return out;
}

/// Rows at the joint values that joint errors make of them.
VERNIER_API inline ImageRows with_joint_errors(ImageRows rows, const JointErrors& errors) {
  demand(errors.empty() || !errors.tilts(), "calibrate_joints_by_camera: joint errors with tilts");
  if (!errors.empty()) rows.joints = errors.effective_rows(rows.joints);
  return rows;
}

}  // namespace detail

/// Calibrates an arm with joint errors by a camera. `calibrate_by_camera` comes first, without joint errors and
/// then with those of a first fit, where left-out images decide. Then joint errors, links and frames are fitted to the
/// poses that images show. Intrinsics and the shape of the board take a Newton step of the
/// least sum of squares over all of these unknowns, images show other poses, and so on, until the step is small against
/// its standard deviation: there the gradient of the whole problem is zero. Poses stand for their corners by their
/// covariances, which are computed again in each round. Which joint errors there are, their priors, and the weights of
/// wrong corners are those of the last fit.
/// @param fit_joints a fit to poses: `JointFit(const Measurements<N>&)`. Tilts of joint frames are no errors of joint
///                   values, so it must find none; called once a round
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
  ImageRows effective = rows;
  const auto with_errors = [&](const CameraOptions& now) {
    return calibrate_by_camera(arm, board, views, effective, now);
  };
  JointsByCamera<ChainOf<Arm>> out{with_errors(rough), {}, {}};
  effective = detail::with_joint_errors(rows, fit_joints(measured_poses<N>(out.camera, rows)).errors);
  out.camera = with_errors(options);
  const CameraReport first = out.camera;
  CameraOptions again = detail::decided(options, first);
  for (int round = 0;; ++round) {
    out.poses = measured_poses<N>(out.camera, rows);
    const JointFit fit = fit_joints(std::as_const(out.poses));
    out.errors = fit.errors;
    effective = detail::with_joint_errors(rows, out.errors);
    if (out.camera.own_gradient.size() == 0) {  // nothing is shared
      out.converged = true;
      return out;
    }
    std::vector<std::vector<Isometry3>> seen(out.poses.poses().size());
    for (std::size_t base = 0, s = 0; base < out.camera.in_base.size() && s < seen.size(); ++base) {
      for (const ImagePose& pose : out.camera.poses)
        if (pose.base == static_cast<Index>(base)) seen[s].push_back(pose.pose);
      if (!seen[s].empty()) ++s;
    }
    const detail::SharedStep step =
        detail::shared_step(fit.estimate, shared_errors(out.camera, rows), seen, out.camera, options.loss);
    double largest = 0;
    for (Index k = 0; k < step.step.size(); ++k)
      largest = (std::max)(largest, std::abs(step.step(k)) / std::sqrt(step.covariance(k, k)));
    out.moved.push_back(largest);
    out.converged = largest < 0.1;
    out.camera.shared_covariance = step.covariance;
    detail::state_std(step.covariance, out.camera);
    if (out.converged || round == most) return out;
    again.held = detail::moved_cameras(out.camera, step.step);
    auto next = with_errors(again);
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
