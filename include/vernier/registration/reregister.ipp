#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/kinematics/frame_parameters.hpp"
#include "vernier/least_squares/marquardt_damping.hpp"
#include "vernier/least_squares/normal_equations.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier {

VERNIER_IMPL void ReregisterOptions::validate() const {
  require(base || tool || offsets, "ReregisterOptions: nothing is to be estimated");
  require(offset_prior_std > 0, "ReregisterOptions: offset_prior_std ", offset_prior_std, " must be positive");
}

VERNIER_IMPL std::string ReregistrationReport::summary() const {
  std::string out;
  char line[160];
  const auto frame = [&](const char* name, const Isometry3& by) {
    const Vector6 v = 1e3 * FrameParameters(by).values();
    std::snprintf(line, sizeof line, "%s moved by (%.3f, %.3f, %.3f) mm, turned by (%.3f, %.3f, %.3f) mrad\n", name,
                  v(0), v(1), v(2), v(3), v(4), v(5));
    out += line;
  };
  if (estimated.base) frame("Base", motion.base);
  if (estimated.tool) frame("Tool", motion.tool);
  for (Index i = 0; estimated.offsets && i < motion.offsets.size(); ++i) {
    const bool revolute = joint_types[static_cast<std::size_t>(i)] == JointType::revolute;
    std::snprintf(line, sizeof line, "Zero of joint %d moved by %+.4f %s\n", static_cast<int>(i + 1),
                  motion.offsets(i) * 1e3, revolute ? "mrad" : "mm");
    out += line;
  }
  return out;
}

namespace detail {

/// Rotation of the tool when base and tool both were moved: from `measured_i = X modelled_i Y` the sum over i of the
/// Kronecker products of `modelled_i` and `measured_i` has X, as a vector, for its dominant left singular vector; Y
/// follows.
/// @cite Shah 2013
VERNIER_API Isometry3 tool_rotation(const std::vector<Isometry3>& modelled, const std::vector<Matrix3>& measured) {
  MatrixX sum = MatrixX::Zero(9, 9);
  for (std::size_t i = 0; i < modelled.size(); ++i)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) sum.block<3, 3>(3 * r, 3 * c) += modelled[i].linear()(r, c) * measured[i];
  const VectorX x = right_singular(sum.transpose()).vectors.col(0);
  Matrix3 base = Eigen::Map<const Matrix3>(x.data());
  if (base.col(0).cross(base.col(1)).dot(base.col(2)) < 0) base = -base;
  base = nearest_rotation(base);
  Matrix3 turned = Matrix3::Zero();
  for (std::size_t i = 0; i < modelled.size(); ++i) turned += (base * modelled[i].linear()).transpose() * measured[i];
  Isometry3 out = Isometry3::Identity();
  out.linear() = nearest_rotation(turned);
  return out;
}

/// Base motion that brings modelled poses to the measured ones, in closed form.
VERNIER_API Isometry3 base_motion(const std::vector<Isometry3>& modelled, const Station& data) {
  PointRows points(data.size(), 3);
  for (Index i = 0; i < data.size(); ++i)
    points.row(i) = modelled[static_cast<std::size_t>(i)].translation().transpose();
  if (!data.oriented()) return register_points(points, *data.positions);
  Matrix3 sum = Matrix3::Zero();
  for (std::size_t i = 0; i < modelled.size(); ++i) sum += data.orientations[i] * modelled[i].linear().transpose();
  Isometry3 out = Isometry3::Identity();
  out.linear() = nearest_rotation(sum);
  const Vector3 from = points.colwise().mean().transpose(), to = data.positions->colwise().mean().transpose();
  out.translation() = to - out.linear() * from;
  return out;
}

VERNIER_IMPL FrameMotion reregister(const MovedPoses& evaluate, const Station& data, const ReregisterOptions& options,
                                    const SensorModel& sensors, ReregistrationReport& report) {
  options.validate();
  sensors.validate();
  require(data.size() >= 1, "reregister: no samples");
  const int joints = data.dof;
  const FrameUpdate update{options.base, options.offsets, options.tool, joints};
  FrameMotion motion;
  motion.offsets = VectorX::Zero(joints);
  std::vector<Isometry3> poses;
  MatrixX jacobians;
  const auto rms = [&] {
    double sum = 0;
    for (Index i = 0; i < data.size(); ++i)
      sum += (poses[static_cast<std::size_t>(i)].translation() - data.position(i)).squaredNorm();
    return std::sqrt(sum / static_cast<double>(data.size()));
  };
  evaluate(motion, poses, jacobians);
  report.rms_before = rms();
  if (options.base) {  // the arm may be anywhere: a closed-form start
    if (data.oriented() && options.tool) motion.tool = tool_rotation(poses, data.orientations);
    evaluate(motion, poses, jacobians);
    motion.base = base_motion(poses, data);
    evaluate(motion, poses, jacobians);
  }

  const auto rows = [&](Index first, Index count, RowBlock* out) {
    for (Index b = 0; b < count; ++b) {
      const Index i = first + b;
      const Isometry3& pose = poses[static_cast<std::size_t>(i)];
      out[b].residual.setZero();
      out[b].residual.head<3>() = (pose.translation() - data.position(i)) / sensors.position_sigma;
      out[b].dense = update.columns(pose, jacobians.data() + 6 * joints * i);
      out[b].dense.topRows<3>() /= sensors.position_sigma;
      if (data.oriented()) {
        out[b].residual.tail<3>() =
            log_so3(pose.linear() * data.orientations[static_cast<std::size_t>(i)].transpose()) /
            sensors.orientation_sigma;
        out[b].dense.bottomRows<3>() /= sensors.orientation_sigma;
      } else {
        out[b].dense.bottomRows<3>().setZero();
      }
    }
  };
  const BlockSystem system{data.size(), data.size(), update.size(), {}, rows};
  VectorX precisions = VectorX::Zero(update.size()), total = precisions;
  if (options.offsets)
    precisions.segment(update.offsets_begin(), joints)
        .setConstant(1 / (options.offset_prior_std * options.offset_prior_std));
  MarquardtDamping damping;
  FrameMotion accepted = motion;
  VectorX accepted_total = total;
  double reached = std::numeric_limits<double>::infinity(), predicted = 0;
  for (int iteration = 0; iteration < 50 && !report.converged; ++iteration) {
    const NormalEquations normal(system);
    const double sum = normal.cost + precisions.dot(total.cwiseAbs2());
    if (sum > (1 + 1e-9) * reached) {  // the step failed, by more than rounding
      damping.reject();
      motion = accepted;
      total = accepted_total;
      evaluate(motion, poses, jacobians);
      continue;
    }
    if (iteration > 0 && damping.value() > 0) damping.accept(std::max(reached - sum, 0.0), predicted);
    accepted = motion;
    accepted_total = total;
    reached = sum;
    MatrixX information = normal.matrix;
    information.diagonal() += precisions;
    // eigenvalues are squares of singular values
    const VectorX spectrum = right_singular(information).values;
    report.determined = spectrum(spectrum.size() - 1) > 1e-14 * spectrum(0);
    if (!report.determined) break;
    const FactorisedEquations solved(normal, precisions, total, {}, eigen_sparse_solver, damping.value());
    if (!solved.usable()) break;
    const VectorX slope = normal.gradient + precisions.cwiseProduct(total);
    predicted = damping.value() * solved.step().cwiseAbs2().dot(information.diagonal()) - solved.step().dot(slope);
    total += solved.step();
    motion = update.apply(motion, solved.step());
    evaluate(motion, poses, jacobians);
    report.converged = solved.step().cwiseAbs().maxCoeff() < 1e-10;
    report.change_std = FactorisedEquations(normal, precisions, accepted_total).inverse().diagonal().cwiseSqrt();
  }
  report.rms_after = rms();
  report.motion = motion;
  report.estimated = options;
  return motion;
}

}  // namespace detail
}  // namespace vernier
