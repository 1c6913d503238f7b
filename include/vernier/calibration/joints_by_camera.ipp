// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/calibration/joints_by_camera.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/least_squares/loss.hpp"

namespace vernier {

VERNIER_IMPL MatrixX covariance_with_shared_errors(const ErrorModelEstimate& estimate,
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

VERNIER_IMPL std::vector<SharedErrors> shared_errors(const CameraReport& report, const ImageRows& rows) {
  std::vector<SharedErrors> out;
  for (std::size_t base = 0; base < report.in_base.size(); ++base) {
    std::vector<Index> here;
    SharedErrors one;
    for (const ImagePose& pose : report.poses)
      if (pose.base == static_cast<Index>(base)) {
        here.push_back(pose.row);
        one.poses.push_back(pose.pose);
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

VERNIER_IMPL CameraOptions decided(CameraOptions options, const CameraReport& first) {
  options.choose = options.left_out = false;
  options.observer = {};
  for (std::size_t k = 0; k < Camera::names.size(); ++k)
    for (const VectorX& std : first.camera_std)
      if (std(static_cast<Index>(k)) > 0 &&
          std::find(options.free.begin(), options.free.end(), Camera::names[k]) == options.free.end())
        options.free.emplace_back(Camera::names[k]);
  for (const CameraBlock& block : first.blocks)
    options.bend = options.bend || (block.kept && block.name == "bent board");
  return options;
}

/// Standard deviations of intrinsics and scale by the covariance of what images share.
VERNIER_LOCAL void state_std(CameraReport& camera) {
  const MatrixX& covariance = camera.shared.covariance;
  Index at = 0;
  for (std::size_t c = 0; c < camera.cameras.size(); ++c) {
    std::vector<Index> row;  // of each intrinsic; below 0 for those that were held
    for (Index k = 0; k < Camera::num_parameters; ++k) row.push_back(camera.camera_std[c](k) > 0 ? at++ : -1);
    for (Index k = 0; k < Camera::num_parameters; ++k)
      for (Index j = 0; j < Camera::num_parameters; ++j) {
        const Index r = row[static_cast<std::size_t>(k)], s = row[static_cast<std::size_t>(j)];
        if (r < 0 || s < 0) continue;
        camera.camera_covariances[c](k, j) = covariance(r, s);
        if (k == j) camera.camera_std[c](k) = std::sqrt(camera.camera_covariances[c](k, k));
      }
  }
  if (!(camera.board_scale_std > 0)) return;
  const double std = std::sqrt(covariance(at, at));
  camera.scale_effect *= std / camera.board_scale_std;
  camera.board_scale_std = std;
}

VERNIER_IMPL void free_links(ErrorModelEstimate& estimate) {
  constexpr double wide = 0.03;  // [m, rad]; far more than links of real arms err
  VectorX precisions = estimate.arm.precisions();
  const VectorX scales = estimate.arm.scales();
  for (Index k = 0; k < static_cast<Index>(estimate.arm.geometric().size()); ++k) {
    const double ratio = scales(k) / wide;
    precisions(k) = (std::min)(precisions(k), estimate.residual_variance * ratio * ratio);
  }
  estimate.arm.set_precisions(precisions);
}

VERNIER_IMPL VectorX shared_step(const ErrorModelEstimate& estimate, const ImageRows& images, Loss loss,
                                 CameraReport& camera) {
  const ArmParameterisation& arm = estimate.arm;
  const Index shared = camera.shared.gradient.size();
  const std::vector<SharedErrors> stations = shared_errors(camera, images);
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
      MatrixX r = pose_difference(modelled[i], stations[s].poses[i]);
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
  information += camera.shared.information;
  VectorX out = -(camera.shared.gradient + slope.col(0));
  demand(cholesky(information), "calibrate_joints_by_camera: the images do not determine the intrinsics");
  camera.shared.covariance = inverse_from_cholesky(information);
  state_std(camera);
  solve_cholesky(information, out);
  return out;
}

VERNIER_IMPL double largest_step(const VectorX& step, const MatrixX& covariance) {
  double out = 0;
  for (Index k = 0; k < step.size(); ++k) out = (std::max)(out, std::abs(step(k)) / std::sqrt(covariance(k, k)));
  return out;
}

VERNIER_IMPL HeldCameras moved_cameras(const CameraReport& camera, const VectorX& step) {
  HeldCameras out{camera.cameras, camera.board_scale, camera.board_bend};
  Index at = 0;
  for (std::size_t c = 0; c < out.cameras.size(); ++c) {
    VectorX values = out.cameras[c].parameters();
    for (Index k = 0; k < values.size(); ++k)
      if (camera.camera_std[c](k) > 0) values(k) += step(at++);
    out.cameras[c] = out.cameras[c].with_parameters(values);
  }
  if (camera.board_scale_std > 0) out.board_scale += step(at++);
  for (Index k = 0; at < step.size(); ++k, ++at) out.board_bend(k) += step(at);
  return out;
}

VERNIER_IMPL void take_left_out(const CameraReport& first, CameraReport& later) {
  later.blocks = first.blocks;
  later.left_out_mean = first.left_out_mean;
  later.left_out_max = first.left_out_max;
  later.choices_repeated = first.choices_repeated;
  for (std::size_t k = 0; k < later.images.size(); ++k) {
    later.images[k].left_out_mean = first.images[k].left_out_mean;
    later.images[k].left_out_max = first.images[k].left_out_max;
  }
}

VERNIER_IMPL ImageRows with_joint_errors(ImageRows rows, const JointErrors& errors) {
  demand(errors.empty() || !errors.tilts(),
         "calibrate_joints_by_camera: joint errors with tilts or straightness, which are none of joint values");
  if (!errors.empty()) rows.joints = errors.effective_rows(rows.joints);
  return rows;
}

}  // namespace detail

}  // namespace vernier
