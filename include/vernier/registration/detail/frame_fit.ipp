// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/least_squares/damped_iteration.hpp"
#include "vernier/least_squares/factorised_equations.hpp"
#include "vernier/registration/detail/frame_fit.hpp"

namespace vernier::detail {

/// Residual and derivatives of a sample, divided by the standard deviations, which are those of the row if it has some:
/// the fit's own multiply them.
VERNIER_LOCAL void frame_rows(const MeasuredSet& data, const FrameFit& fit, const MatrixX& jacobians, Index i,
                              RowBlock& out) {
  const Isometry3& pose = fit.poses[static_cast<std::size_t>(i)];
  out.residual.setZero();
  VERNIER_LATER(out.residual).template head<3>() = (translation(pose) - data.position(i)) / fit.position_sigma;
  out.dense = fit.update.columns(pose, jacobians.data() + 6 * fit.update.joints * i);
  const double angular = data.oriented() ? 1 / fit.orientation_sigma : 0;
  for (Index c = 0; c < out.dense.cols(); ++c)
    for (Index r = 0; r < 6; ++r) out.dense(r, c) *= r < 3 ? 1 / fit.position_sigma : angular;
  if (data.oriented()) {
    const Matrix3 seen = rotation(pose) * exp_so3(fit.motion.probe);
    VERNIER_LATER(out.residual).template tail<3>() =
        rotation_difference(seen, data.orientations()[static_cast<std::size_t>(i)]) / fit.orientation_sigma;
  }
  if (!data.correlated()) return;
  Matrix6 factor = data.relative_covariance(i);
  cholesky(factor);
  solve_lower(factor, out.residual);
  solve_lower(factor, out.dense);
}

/// Adds priors so tight that the held directions stay where they are.
VERNIER_LOCAL void hold(const FrameFit& fit, const VectorX& total, NormalEquations& normal) {
  for (Index k = 0; k < fit.held.cols(); ++k) {
    const VectorX axis = VERNIER_LATER(fit.held).col(k);
    double variance = 0;
    for (Index r = 0; r < axis.size(); ++r) variance += std::pow(axis(r) * (std::min)(fit.prior_std(r), 1.0), 2);
    const double precision = 1e8 / variance, at = axis.dot(total);
    add_product(normal.matrix, axis, VERNIER_LATER(axis).transpose(), precision);
    normal.gradient += precision * at * axis;
    normal.cost += precision * at * at;
  }
}

VERNIER_IMPL void solve_frames(const MovedPoses& evaluate, const MeasuredSet& data, FrameFit& fit) {
  MatrixX jacobians;
  evaluate(fit.motion, fit.poses, jacobians);
  const auto rows = [&](Index first, Index count, RowBlock* out) {
    for (Index b = 0; b < count; ++b) frame_rows(data, fit, jacobians, first + b, out[b]);
  };
  const BlockSystem system{data.size(), data.size(), fit.update.size(), {}, rows};
  VectorX precisions(fit.prior_std.size());
  for (Index k = 0; k < precisions.size(); ++k) precisions(k) = 1 / (fit.prior_std(k) * fit.prior_std(k));
  VectorX total = fit.total, accepted_total = total;
  FrameMotion accepted = fit.motion;
  fit.determined = true;
  const auto linearise = [&] {
    LinearisedProblem out{NormalEquations(system), precisions, total};
    hold(fit, total, out.normal);
    out.with_old_weights = out.with_new_weights = out.normal.cost + weighted_square(precisions, total);
    MatrixX information = out.normal.matrix;
    for (Index k = 0; k < precisions.size(); ++k) information(k, k) += precisions(k);
    const VectorX spectrum = right_singular(information).values;  // eigenvalues are squares of singular values
    fit.determined = fit.determined && spectrum(spectrum.size() - 1) > 1e-14 * spectrum(0);
    return out;
  };
  const auto move_to = [&](const FrameMotion& motion) {
    fit.motion = motion;
    evaluate(fit.motion, fit.poses, jacobians);
  };
  const auto move = [&](const VectorX& step, const VectorX&) {
    if (!fit.determined) return;
    total += step;
    move_to(fit.update.apply(fit.motion, step));
  };
  const auto keep = [&] {
    accepted = fit.motion;
    accepted_total = total;
  };
  const auto restore = [&] {
    total = accepted_total;
    move_to(accepted);
  };
  constexpr double exact = std::numeric_limits<double>::infinity();  // sums of exact poses are rounding errors
  const IterationEnd end = minimise({linearise, move, keep, restore}, {50, 1e-10, 0, exact});
  fit.determined = fit.determined && end.usable;
  fit.converged = fit.determined && end.converged;
  fit.covariance.resize(0, 0);
  if (fit.determined) {
    const LinearisedProblem at = linearise();
    fit.covariance = VERNIER_LATER(FactorisedEquations(at.normal, precisions, total)).inverse();
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
    for (Index r = 0; r < 6; ++r) {
      const VectorX row = row_of(block.dense, r);
      (r < 3 ? fit.position_squares : fit.orientation_squares) += block.residual(r) * block.residual(r);
      (r < 3 ? fit.position_redundancy : fit.orientation_redundancy) -= row.dot(product(fit.covariance, row));
    }
  }
}

VERNIER_IMPL void solve_frames_and_weights(const MovedPoses& evaluate, const MeasuredSet& data, FrameFit& fit) {
  const double least_position = fit.position_sigma, least_orientation = fit.orientation_sigma;
  const auto improve = [](double& sigma, double least, double squares, double redundancy) {
    // less than a value over tells nothing about its size
    const double now = redundancy < 1 ? least : (std::max)(least, sigma * std::sqrt(squares / redundancy));
    const bool differs = std::abs(now - sigma) > 1e-3 * sigma;
    if (differs) sigma = now;
    return differs;
  };
  for (int round = 0; round < 50; ++round) {
    solve_frames(evaluate, data, fit);
    if (fit.covariance.size() == 0) return;
    if (data.correlated() && data.oriented()) {  // one scale: with two, errors that go together would no longer do so
      const double before = fit.position_sigma;
      const bool differs = improve(fit.position_sigma, least_position, fit.position_squares + fit.orientation_squares,
                                   fit.position_redundancy + fit.orientation_redundancy);
      fit.orientation_sigma *= fit.position_sigma / before;
      if (!differs) return;
      continue;
    }
    const bool position = improve(fit.position_sigma, least_position, fit.position_squares, fit.position_redundancy);
    const bool orientation =
        improve(fit.orientation_sigma, least_orientation, fit.orientation_squares, fit.orientation_redundancy);
    if (!position && !orientation) return;
  }
}

}  // namespace vernier::detail
