// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/kinematics/frame_parameters.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier {

VERNIER_IMPL void ReregisterOptions::validate() const {
  demand(base || tool || offsets, "ReregisterOptions: nothing is to be estimated");
  const auto positive = [](const char* name, double value) {
    demand(value > 0, "ReregisterOptions: ", name, " ", value, " must be positive");
  };
  positive("offset_prior_std", offset_prior_std);
  positive("tool_position_prior_std", tool_position_prior_std);
  positive("tool_rotation_prior_std", tool_rotation_prior_std);
  positive("contradiction_threshold", contradiction_threshold);
  demand(expected_error >= 0 && std::isfinite(expected_error), "ReregisterOptions: expected_error ", expected_error,
         " must be finite and not negative");
}

namespace detail {

/// The components of a vector with some decimals: "(1.00, -0.20, 0.03)".
VERNIER_LOCAL std::string components(const Vector3& values, int decimals) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "(" : ", ") + fixed_digits(value, decimals);
  return out + ")";
}

VERNIER_IMPL std::string excess_remark(double left, double expected) {
  constexpr double factor = 10;
  if (!(expected > 0) || left < factor * expected) return {};
  return message("After registration ", fixed_digits(1e3 * left, 3), " mm are left, ", fixed_digits(left / expected, 0),
                 " times the error of the calibration at held-out poses (", fixed_digits(1e3 * expected, 3),
                 " mm): are these poses of this arm, with joints in its order and units?");
}

VERNIER_IMPL std::string outside_remark(const std::vector<Index>& outside, const RowOrigin& origin, Index poses) {
  if (outside.empty()) return {};
  return message(outside.size(), " of ", poses, " poses (", origin.where(outside), ")",
                 outside.size() == 1 ? " lies" : " lie",
                 " outside the measured joint ranges, where the model knows less: register by poses inside.");
}

}  // namespace detail

VERNIER_IMPL std::vector<std::string> ReregistrationReport::remarks() const {
  using detail::components;
  using detail::fixed_digits;
  std::vector<std::string> out;
  for (const std::string& remark :
       {detail::excess_remark(rms_after, estimated.expected_error), detail::outside_remark(outside, origin, poses)})
    if (!remark.empty()) out.push_back(remark);
  if (probe_turned)
    out.push_back(message(
        "Measured orientations are turned by ", fixed_digits(1e3 * motion.probe.norm(), 2), " mrad against the tool, ",
        components(1e3 * motion.probe, 2), " +- ", components(1e3 * probe_std, 2), " in its frame (statistic ",
        fixed_digits(contradiction, 0), ", by chance up to ", fixed_digits(estimated.contradiction_threshold, 1),
        "): was the probe remounted? The rotation is taken off the orientations; the model's tool is kept."));
  for (const std::string& what : held) out.push_back("The poses do not determine " + what + ": held where it was.");
  std::string zeros;
  const Index zeros_begin = estimated.base ? 6 : 0, count = change_std.size() > 0 ? motion.offsets.size() : 0;
  for (Index i = 0; estimated.offsets && i < count; ++i)
    if (change_std(zeros_begin + i) > 0.5 * estimated.offset_prior_std) zeros += " " + std::to_string(i + 1);
  if (!zeros.empty())
    out.push_back("The poses tell little about the zeros of joints" + zeros + ": held near where they were.");
  const auto far_off = [&](const char* how, double moved, double prior, const char* unit) {
    if (moved > 3 * prior)
      out.push_back(message("The tool has ", how, " by ", fixed_digits(1e3 * moved, 2), " ", unit, ", where ",
                            fixed_digits(1e3 * prior, 2),
                            " are expected of one remounted: if it is another tool, register it as such (with infinite "
                            "priors)."));
  };
  far_off("moved", translation(motion.tool).norm(), estimated.tool_position_prior_std, "mm");
  far_off("turned", log_so3(rotation(motion.tool)).norm(), estimated.tool_rotation_prior_std, "mrad");
  const auto vague = [&](const char* what, double sigma, double prior, const char* unit) {
    if (std::isinf(prior) && sigma > 1e-3)
      out.push_back(message("The poses determine the ", what, " of the tool to ", fixed_digits(1e3 * sigma, 1), " ",
                            unit, " only."));
  };
  if (!estimated.tool || change_std.size() == 0) return out;
  const auto largest = [&](Index begin) {
    return (std::max)({change_std(begin), change_std(begin + 1), change_std(begin + 2)});
  };
  vague("position", largest(change_std.size() - 6), estimated.tool_position_prior_std, "mm");
  vague("rotation", largest(change_std.size() - 3), estimated.tool_rotation_prior_std, "mrad");
  return out;
}

VERNIER_IMPL std::string ReregistrationReport::summary() const {
  std::string out;
  Index at = 0;
  const bool known = change_std.size() > 0;
  const auto frame = [&](const char* name, const Isometry3& by) {
    const Vector6 v = FrameParameters(by).values();
    const auto three = [](const auto& values, Index k) {
      return detail::components(Vector3(1e3 * values(k), 1e3 * values(k + 1), 1e3 * values(k + 2)), 3);
    };
    for (const Index k : {0, 3}) {
      out += k == 0 ? std::string(name) + " moved by " : ", turned by ";
      out += three(v, k);
      if (known) out += " +- " + three(change_std, at + k);
      out += k == 0 ? " mm" : " mrad\n";
    }
    at += 6;
  };
  if (estimated.base) frame("Base", motion.base);
  for (Index i = 0; estimated.offsets && i < motion.offsets.size(); ++i, ++at) {
    const bool revolute = joint_types[static_cast<std::size_t>(i)] == JointType::revolute;
    out += message("Zero of joint ", i + 1, " moved by ", detail::signed_digits(motion.offsets(i) * 1e3, 4));
    if (known) out += " +- " + detail::fixed_digits(change_std(at) * 1e3, 4);
    out += revolute ? " mrad\n" : " mm\n";
  }
  if (estimated.tool) frame("Tool", motion.tool);
  out += "Weighted for residuals of " + detail::fixed_digits(1e3 * position_sigma, 3) + " mm";
  if (orientation_sigma > 0) out += " and " + detail::fixed_digits(1e3 * orientation_sigma, 3) + " mrad";
  out += " a component\n";
  for (const std::string& remark : remarks()) out += remark + "\n";
  return out;
}

namespace detail {

/// Rotation of the tool when base and tool both were moved: from `measured_i = X modelled_i Y` the sum over i of the
/// Kronecker products of `modelled_i` and `measured_i` has X, as a vector, for its dominant left singular vector; Y
/// follows.
/// @cite Shah 2013
VERNIER_LOCAL Isometry3 tool_rotation(const std::vector<Isometry3>& modelled, const std::vector<Matrix3>& measured) {
  MatrixX sum = MatrixX::Zero(9, 9);
  for (std::size_t i = 0; i < modelled.size(); ++i)
    for (Index r = 0; r < 9; ++r)
      for (Index c = 0; c < 9; ++c) sum(r, c) += modelled[i](r / 3, c / 3) * measured[i](r % 3, c % 3);
  const VectorX x = right_singular(VERNIER_LATER(sum).transpose()).vectors.col(0);
  Matrix3 base;
  for (Index k = 0; k < 9; ++k) base(k % 3, k / 3) = x(k);
  if (base.determinant() < 0) base *= -1;
  const Matrix3 nearest = nearest_rotation(base), back = VERNIER_LATER(nearest).transpose();
  Matrix3 turned = Matrix3::Zero();
  for (std::size_t i = 0; i < modelled.size(); ++i) {
    const Matrix3 in_base = back * measured[i];
    turned += rotation(inverse_of(modelled[i])) * in_base;
  }
  return rigid_motion(nearest_rotation(turned), Vector3::Zero());
}

/// Base motion that brings modelled poses to the measured ones, in closed form; its rotation by the orientations or by
/// the positions.
VERNIER_LOCAL Isometry3 base_motion(const std::vector<Isometry3>& modelled, const MeasuredSet& data,
                                    bool by_orientations) {
  PointRows points(data.size(), 3);
  for (Index i = 0; i < data.size(); ++i) set_point(points, i, translation(modelled[static_cast<std::size_t>(i)]));
  if (!by_orientations) return register_points(points, *data.positions());
  Matrix3 sum = Matrix3::Zero();
  for (std::size_t i = 0; i < modelled.size(); ++i) sum += data.orientations()[i] * rotation(inverse_of(modelled[i]));
  const Matrix3 turn = nearest_rotation(sum);
  const Vector3 turned = turn * centroid(points);
  return rigid_motion(turn, centroid(*data.positions()) - turned);
}

/// Base and the point of a tool of which nothing is known, from positions: the base in closed form with the tool as it
/// is, the tool's point as a mean in its frame, alternating.
VERNIER_LOCAL void start_of_another_tool(const MovedPoses& evaluate, const MeasuredSet& data, FrameFit& fit,
                                         MatrixX& jacobians) {
  for (int round = 0; round < 50; ++round) {
    fit.motion.base = Isometry3::Identity();
    evaluate(fit.motion, fit.poses, jacobians);
    fit.motion.base = base_motion(fit.poses, data, false);
    evaluate(fit.motion, fit.poses, jacobians);
    Vector3 sum = Vector3::Zero();
    for (Index i = 0; i < data.size(); ++i)
      sum += transformed(inverse_of(fit.poses[static_cast<std::size_t>(i)]), data.position(i));
    const Vector3 shift = sum / static_cast<double>(data.size());
    fit.motion.tool = composed(fit.motion.tool, rigid_motion(Matrix3::Identity(), shift));
    if (shift.norm() < 1e-6) break;
  }
  evaluate(fit.motion, fit.poses, jacobians);
}

VERNIER_IMPL Vector3 probe_rotation(const std::vector<Isometry3>& modelled, const std::vector<Matrix3>& measured) {
  Matrix3 sum = Matrix3::Zero();
  for (std::size_t i = 0; i < modelled.size(); ++i) sum += rotation(inverse_of(modelled[i])) * measured[i];
  return log_so3(nearest_rotation(sum));
}

/// Prior standard deviations of what is estimated.
VERNIER_LOCAL VectorX prior_std_of(const FrameUpdate& update, const ReregisterOptions& options, double probe_std) {
  VectorX out = VectorX::Constant(update.size(), std::numeric_limits<double>::infinity());
  if (update.offsets)
    VERNIER_LATER(out).segment(update.offsets_begin(), update.joints).setConstant(options.offset_prior_std);
  if (update.tool) {
    VERNIER_LATER(out).segment(update.tool_begin(), 3).setConstant(options.tool_position_prior_std);
    VERNIER_LATER(out).segment(update.tool_begin() + 3, 3).setConstant(options.tool_rotation_prior_std);
  }
  if (update.probe) VERNIER_LATER(out).segment(update.probe_begin(), 3).setConstant(probe_std);
  return out;
}

/// Holds what the poses tell little about: directions of the tool's position and rotation of which more than half of
/// the prior's standard deviation is left. They would follow errors of the model by as much as a prior allows.
/// @return what is held, in words
VERNIER_LOCAL std::vector<std::string> hold_undetermined_tool(FrameFit& fit) {
  std::vector<std::string> out;
  for (const Index part : {0, 3}) {
    const Index begin = fit.update.tool_begin() + part;
    const double least = std::pow(0.5 * fit.prior_std(begin), 2);
    const RightSingular axes = right_singular(fit.covariance_of(begin, 3));  // in descending order
    const Index count = std::count_if(axes.values.begin(), axes.values.end(), [&](double v) { return v > least; });
    if (count == 0) continue;
    std::string what = part == 0 ? "the position of the tool" : "the rotation of the tool";
    for (Index k = 0; k < count; ++k) {
      Vector3 axis = VERNIER_LATER(axes.vectors).col(k);
      VectorX held = VectorX::Zero(fit.update.size());
      VERNIER_LATER(held).segment(begin, 3) = axis;
      fit.held.conservativeResize(held.size(), fit.held.cols() + 1);
      VERNIER_LATER(fit.held).col(fit.held.cols() - 1) = held;
      const double largest =
          *std::max_element(axis.begin(), axis.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
      if (largest < 0) axis *= -1;
      for (double& value : axis)
        if (std::abs(value) < 0.005) value = 0;  // no -0.00
      if (count < 3) what += message(k == 0 ? (part == 0 ? " along " : " about ") : " and ", components(axis, 2));
    }
    out.push_back(count < 3 ? what + " of its frame" : what);
  }
  return out;
}

/// Decides whether the orientations are turned against the tool, from a fit in which they are free to, and solves again
/// where they are not.
VERNIER_LOCAL void judge_probe(const MovedPoses& evaluate, const MeasuredSet& data, const ReregisterOptions& options,
                               const SensorModel& sensors, FrameFit& fit, ReregistrationReport& report) {
  const Index begin = fit.update.probe_begin();
  // A mean error of the model's orientations is no remounted probe: it may be as large as their scatter.
  const double own =
      fit.orientation_sigma * fit.orientation_sigma - sensors.orientation_sigma * sensors.orientation_sigma;
  MatrixX by_chance = fit.covariance_of(begin, 3);
  for (Index k = 0; k < 3; ++k) {
    report.probe_std(k) = std::sqrt(by_chance(k, k));
    by_chance(k, k) += own;
  }
  MatrixX whitened = fit.motion.probe;
  cholesky(by_chance);
  solve_lower(by_chance, whitened);
  // Wald's statistic; few values make their own scale uncertain, so that it may be larger by chance (as F is)
  const double redundancy = fit.position_redundancy + fit.orientation_redundancy;
  report.contradiction = redundancy < 1 ? 0 : redundancy * std::log1p(whitened.squaredNorm() / redundancy);
  report.probe_turned = report.contradiction > options.contradiction_threshold;
  if (report.probe_turned) return;
  // What orientations tell about the base is worth no more than that mean error allows.
  report.probe_std.setZero();
  fit.motion.probe.setZero();
  fit.update.probe = own > 1e-18;
  fit.total.conservativeResize(fit.update.size());
  if (fit.update.probe) VERNIER_LATER(fit.total).tail(3).setZero();
  fit.prior_std = prior_std_of(fit.update, options, std::sqrt(own));
  solve_frames(evaluate, data, fit);
}

VERNIER_IMPL FrameMotion reregister(const MovedPoses& evaluate, const MeasuredSet& data,
                                    const ReregisterOptions& options, const SensorModel& sensors,
                                    ReregistrationReport& report) {
  options.validate();
  sensors.validate();
  demand(data.size() >= 1, "reregister: no samples");
  const int joints = static_cast<int>(data.joints.cols());
  // a tool that is freed follows the orientations by itself
  const FrameUpdate update{options.base, options.offsets, options.tool, joints, data.oriented() && !options.tool};
  // The probe may be mounted any way round; a prior this wide keeps one pose from asking for both base and probe.
  constexpr double any_rotation = 1;
  ReregisterOptions priors = options;
  if (!data.oriented())  // positions do not see how a tool is turned: it is held where it was
    priors.tool_rotation_prior_std = (std::min)(options.tool_rotation_prior_std, any_rotation);
  FrameFit fit{.update = update,
               .prior_std = prior_std_of(update, priors, any_rotation),
               .motion = {.offsets = VectorX::Zero(joints)},
               .position_sigma = sensors.position_sigma,
               .orientation_sigma = sensors.orientation_sigma,
               .total = VectorX::Zero(update.size())};
  MatrixX jacobians;
  const auto rms = [&] {
    double sum = 0;
    for (Index i = 0; i < data.size(); ++i)
      sum += (translation(fit.poses[static_cast<std::size_t>(i)]) - data.position(i)).squaredNorm();
    return std::sqrt(sum / static_cast<double>(data.size()));
  };
  evaluate(fit.motion, fit.poses, jacobians);
  report.rms_before = rms();
  if (options.base) {  // the arm may be anywhere: a closed-form start
    if (data.oriented() && options.tool && std::isinf(options.tool_rotation_prior_std))
      fit.motion.tool = tool_rotation(fit.poses, data.orientations());
    evaluate(fit.motion, fit.poses, jacobians);
    fit.motion.base = base_motion(fit.poses, data, data.oriented());
    if (update.probe) {  // a probe mounted another way round would put the arm somewhere else
      const std::vector<Isometry3> before = fit.poses;
      evaluate(fit.motion, fit.poses, jacobians);
      if (rms() > 0.02) {
        fit.motion.base = base_motion(before, data, false);
        evaluate(fit.motion, fit.poses, jacobians);
        fit.motion.probe = probe_rotation(fit.poses, data.orientations());
        VERNIER_LATER(fit.total).tail(3) = fit.motion.probe;
      }
    }
    if (!data.oriented() && options.tool && std::isinf(options.tool_position_prior_std))
      start_of_another_tool(evaluate, data, fit, jacobians);
  }
  solve_frames_and_weights(evaluate, data, fit);
  if (update.probe && fit.covariance.size() > 0) judge_probe(evaluate, data, options, sensors, fit, report);
  if (!report.probe_turned) fit.motion.probe.setZero();  // that much is the model's own error
  if (fit.covariance.size() > 0)
    report.change_std = diagonal_of(fit.covariance_of(0, update.probe_begin())).cwiseSqrt();
  if (options.tool && fit.covariance.size() > 0) report.held = hold_undetermined_tool(fit);
  if (!report.held.empty()) solve_frames(evaluate, data, fit);
  report.poses = data.size();
  report.determined = fit.determined;
  report.converged = fit.converged;
  report.rms_after = rms();
  report.motion = fit.motion;
  report.estimated = options;
  report.position_sigma = fit.position_sigma;
  report.orientation_sigma = data.oriented() ? fit.orientation_sigma : 0;
  return fit.motion;
}

}  // namespace detail
}  // namespace vernier
