#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/least_squares/marquardt_damping.hpp"
#include "vernier/least_squares/normal_equations.hpp"
#include "vernier/registration/detail/frame_fit.hpp"

namespace vernier::detail {

/// Residual and derivatives of a sample, divided by the standard deviations.
VERNIER_API void frame_rows(const Station& data, const FrameFit& fit, const MatrixX& jacobians, Index i,
                            RowBlock& out) {
  const Isometry3& pose = fit.poses[static_cast<std::size_t>(i)];
  out.residual.setZero();
  out.residual.head<3>() = (pose.translation() - data.position(i)) / fit.position_sigma;
  out.dense = fit.update.columns(pose, jacobians.data() + 6 * fit.update.joints * i);
  out.dense.topRows<3>() /= fit.position_sigma;
  if (!data.oriented()) {
    out.dense.bottomRows<3>().setZero();
    return;
  }
  const Matrix3 seen = pose.linear() * exp_so3(fit.motion.probe);
  out.residual.tail<3>() =
      log_so3(seen * data.orientations[static_cast<std::size_t>(i)].transpose()) / fit.orientation_sigma;
  out.dense.bottomRows<3>() /= fit.orientation_sigma;
}

/// Adds priors so tight that the held directions stay where they are.
VERNIER_API void hold(const FrameFit& fit, const VectorX& total, NormalEquations& normal) {
  for (Index k = 0; k < fit.held.cols(); ++k) {
    const VectorX axis = fit.held.col(k);
    const double precision = 1e8 / axis.cwiseAbs2().dot(fit.prior_std.cwiseMin(1).cwiseAbs2());
    const double at = axis.dot(total);
    normal.matrix += precision * axis * axis.transpose();
    normal.gradient += precision * at * axis;
    normal.cost += precision * at * at;
  }
}

VERNIER_IMPL void solve_frames(const MovedPoses& evaluate, const Station& data, FrameFit& fit) {
  MatrixX jacobians;
  evaluate(fit.motion, fit.poses, jacobians);
  const auto rows = [&](Index first, Index count, RowBlock* out) {
    for (Index b = 0; b < count; ++b) frame_rows(data, fit, jacobians, first + b, out[b]);
  };
  const BlockSystem system{data.size(), data.size(), fit.update.size(), {}, rows};
  const VectorX precisions = fit.prior_std.cwiseAbs2().cwiseInverse();
  fit.determined = fit.converged = false;
  fit.covariance.resize(0, 0);
  MarquardtDamping damping;
  VectorX total = fit.total, accepted_total = total;
  FrameMotion accepted = fit.motion;
  double reached = std::numeric_limits<double>::infinity(), predicted = 0;
  for (int iteration = 0; iteration < 50 && !fit.converged; ++iteration) {
    NormalEquations normal(system);
    hold(fit, total, normal);
    const double sum = normal.cost + precisions.dot(total.cwiseAbs2());
    if (sum > (1 + 1e-9) * reached) {  // the step failed, by more than rounding
      damping.reject();
      fit.motion = accepted;
      total = accepted_total;
      evaluate(fit.motion, fit.poses, jacobians);
      continue;
    }
    if (iteration > 0 && damping.value() > 0) damping.accept(std::max(reached - sum, 0.0), predicted);
    accepted = fit.motion;
    accepted_total = total;
    reached = sum;
    MatrixX information = normal.matrix;
    information.diagonal() += precisions;
    // eigenvalues are squares of singular values
    const VectorX spectrum = right_singular(information).values;
    fit.determined = spectrum(spectrum.size() - 1) > 1e-14 * spectrum(0);
    if (!fit.determined) break;
    const FactorisedEquations solved(normal, precisions, total, {}, eigen_sparse_solver, damping.value());
    if (!solved.usable()) break;
    const VectorX slope = normal.gradient + precisions.cwiseProduct(total);
    predicted = damping.value() * solved.step().cwiseAbs2().dot(information.diagonal()) - solved.step().dot(slope);
    total += solved.step();
    fit.motion = fit.update.apply(fit.motion, solved.step());
    evaluate(fit.motion, fit.poses, jacobians);
    fit.converged = solved.step().cwiseAbs().maxCoeff() < 1e-10;
    fit.covariance = FactorisedEquations(normal, precisions, accepted_total).inverse();
  }
  fit.total = total;
  if (fit.covariance.size() == 0) return;
  // what is left over, and how many values of each kind the unknowns left to it
  fit.position_squares = fit.orientation_squares = 0;
  fit.position_redundancy = static_cast<double>(3 * data.size());
  fit.orientation_redundancy = data.oriented() ? fit.position_redundancy : 0;
  RowBlock block;
  for (Index i = 0; i < data.size(); ++i) {
    frame_rows(data, fit, jacobians, i, block);
    const Matrix6 taken = block.dense.lazyProduct(fit.covariance).eval().lazyProduct(block.dense.transpose());
    fit.position_squares += block.residual.head<3>().squaredNorm();
    fit.orientation_squares += block.residual.tail<3>().squaredNorm();
    fit.position_redundancy -= taken.diagonal().head<3>().sum();
    fit.orientation_redundancy -= taken.diagonal().tail<3>().sum();
  }
}

VERNIER_IMPL void solve_frames_and_weights(const MovedPoses& evaluate, const Station& data, FrameFit& fit) {
  const double least_position = fit.position_sigma, least_orientation = fit.orientation_sigma;
  const auto improve = [](double& sigma, double least, double squares, double redundancy) {
    // less than a value over tells nothing about its size
    const double now = redundancy < 1 ? least : std::max(least, sigma * std::sqrt(squares / redundancy));
    const bool differs = std::abs(now - sigma) > 1e-3 * sigma;
    if (differs) sigma = now;
    return differs;
  };
  for (int round = 0; round < 50; ++round) {
    solve_frames(evaluate, data, fit);
    if (fit.covariance.size() == 0) return;
    const bool position = improve(fit.position_sigma, least_position, fit.position_squares, fit.position_redundancy);
    const bool orientation =
        improve(fit.orientation_sigma, least_orientation, fit.orientation_squares, fit.orientation_redundancy);
    if (!position && !orientation) return;
  }
}

}  // namespace vernier::detail
