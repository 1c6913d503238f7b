// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/chi_square.hpp"
#include "vernier/evaluation/mean_interval.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/least_squares/row_block.hpp"

namespace vernier {

VERNIER_IMPL void VerifyOptions::validate() const {
  demand(level > 0 && level < 1, "VerifyOptions: level ", level, " must lie in (0, 1)");
  demand(!accept || (*accept > 0 && std::isfinite(*accept)), "VerifyOptions: accept ", accept.value_or(0),
         " must be positive");
  demand(expected_error >= 0 && std::isfinite(expected_error), "VerifyOptions: expected_error ", expected_error,
         " must be finite and not negative");
  sensors.validate();
}

namespace detail {

/// A change is not determined where registration takes more than all but this share of its effect.
inline constexpr double least_informative = 0.02;
/// Probability of changes so small that the poses may be those of the fit, see `VerificationReport::closeness`.
inline constexpr double too_close = 1e-6;

/// Residuals that are whitened, and what was registered taken off: a test of further columns is a projection.
struct WhitenedResiduals {
  VectorX residual;     ///< m
  MatrixX columns;      ///< m x k: of changes to be tested, whitened alike
  VectorX informative;  ///< k: share of each column that what was registered leaves over
  Index dof = 0;        ///< of the residual
};

/// Takes off what columns explain, by modified Gram-Schmidt, twice; columns that depend on others are left out.
/// @return number of columns that were taken off
VERNIER_LOCAL Index take_off(const ConstMatrixRef& nuisance, VectorX& residual, MatrixX& columns) {
  std::vector<VectorX> axes;
  for (Index k = 0; k < nuisance.cols(); ++k) {
    VectorX axis = VERNIER_LATER(nuisance).col(k);
    const double before = axis.norm();
    for (int pass = 0; pass < 2; ++pass)
      for (const VectorX& other : axes) axis -= other.dot(axis) * other;
    if (!(axis.norm() > 1e-7 * before)) continue;
    axis /= axis.norm();
    residual -= axis.dot(residual) * axis;
    const VectorX along = transposed_product(columns, axis);
    for (Index c = 0; c < columns.cols(); ++c) VERNIER_LATER(columns).col(c) -= along(c) * axis;
    axes.push_back(std::move(axis));
  }
  return static_cast<Index>(axes.size());
}

/// Chi-square of some columns together, and how many of them are independent.
struct ColumnTest {
  double chi_square = 0;
  Index rank = 0;
};
VERNIER_LOCAL ColumnTest test_columns(const WhitenedResiduals& of, const std::vector<Index>& which) {
  MatrixX columns(of.residual.size(), static_cast<Index>(which.size())), none(of.residual.size(), 0);
  Index used = 0;
  for (const Index k : which)
    if (of.informative(k) > least_informative) VERNIER_LATER(columns).col(used++) = VERNIER_LATER(of.columns).col(k);
  VectorX residual = of.residual;
  const Index rank = take_off(VERNIER_LATER(columns).leftCols(used), residual, none);
  return {of.residual.squaredNorm() - residual.squaredNorm(), rank};
}

/// The part of a covariance by which it exceeds independent noise of one variance, along its axes.
VERNIER_LOCAL MatrixX excess_over(const MatrixX& covariance, double variance) {
  const SymmetricEigen axes = symmetric_eigen(covariance);
  MatrixX out = MatrixX::Zero(covariance.rows(), covariance.cols());
  for (Index k = 0; k < axes.values.size(); ++k) {
    const VectorX axis = VERNIER_LATER(axes.vectors).col(k);
    add_product(out, axis, VERNIER_LATER(axis).transpose(), (std::max)(0.0, axes.values(k) - variance));
  }
  return out;
}

/// Adds the noise of a row by which it is worse than the rows of the calibration, whose noise is in that of a visit.
VERNIER_LOCAL void add_row_noise(const VerificationInput& input, Index row, Index values, Matrix6& visit) {
  const MeasuredSet& data = input.data;
  const Matrix6 relative = data.relative_covariance(row);
  const auto sigma = [&](Index k) { return k < 3 ? data.sigma().length : data.sigma().angle; };
  const auto then = [&](Index k) {  // in its units that noise is one; none of orientations that were not measured
    return (std::max)(k < 3 ? input.estimate.position_sigma : input.estimate.orientation_sigma, 1e-9);
  };
  MatrixX own(values, values);
  for (Index c = 0; c < values; ++c)
    for (Index r = 0; r < values; ++r) own(r, c) = relative(r, c) * sigma(r) * sigma(c) / (then(r) * then(c));
  own = excess_over(own, 1);
  for (Index c = 0; c < values; ++c)
    for (Index r = 0; r < values; ++r) visit(r, c) += own(r, c) * then(r) * then(c);
}

/// Covariance of the residuals of some poses: that of the calibration's unknowns, which they share, and of each visit.
VERNIER_LOCAL MatrixX residual_covariance(const VerificationInput& input, const VerifyOptions& options, Index values,
                                          std::vector<Matrix6>& visits) {
  const MeasuredSet& data = input.data;
  const Index n = data.size(), unknowns = input.estimate.arm.size();
  const VectorX& temperatures = data.temperatures;
  visits = input.estimate.visit_covariances(data.joints, input.gates, 0, data.previous, temperatures, data.payloads);
  std::vector<RowBlock> blocks(static_cast<std::size_t>(n));
  VectorX warmer = VectorX::Zero(n);
  if (temperatures.size() > 0 && !same_value(input.estimate.mean_temperature, 0))
    for (Index i = 0; i < n; ++i) warmer(i) = temperatures(i) - input.estimate.mean_temperature;
  input.estimate.arm.linearise(0, data.joints, data.previous, blocks.data(), true, warmer, data.payloads);
  MatrixX effects(unknowns, values * n);
  Rows6 one(6, unknowns);
  for (Index i = 0; i < n; ++i) {
    blocks[static_cast<std::size_t>(i)].expand(input.estimate.arm.group_sizes(), one);
    for (Index v = 0; v < values; ++v)
      for (Index k = 0; k < unknowns; ++k) effects(k, values * i + v) = one(v, k);
  }
  MatrixX out = matrix_product(transposed_matrix_product(effects, input.estimate.covariance), effects);
  // a sensor worse than that of the calibration, whose noise is in that of a visit
  const auto excess = [](double now, double then) { return (std::max)(0.0, now * now - then * then); };
  const double position = excess(options.sensors.position_sigma, input.estimate.position_sigma),
               orientation = excess(options.sensors.orientation_sigma, input.estimate.orientation_sigma);
  for (Index i = 0; i < n; ++i) {
    Matrix6& visit = visits[static_cast<std::size_t>(i)];
    for (Index v = 0; v < 6 && !data.correlated(); ++v) visit(v, v) += v < 3 ? position : orientation;
    if (data.correlated()) add_row_noise(input, i, values, visit);
    for (Index c = 0; c < values; ++c)
      for (Index r = 0; r < values; ++r) out(values * i + r, values * i + c) = visit(r, c);
  }
  return out;
}

/// Tests of everything and of each joint, some rows left out.
VERNIER_LOCAL void test_all(const VerificationInput& input, const MatrixX& covariance, const VectorX& residual,
                            const MatrixX& registered, const MatrixX& changes, Index values, VerificationReport& out) {
  const Index n = input.data.size(), joints = static_cast<Index>(out.joint_types.size());
  std::vector<Index> kept;
  for (Index i = 0; i < n; ++i)
    if (std::find(out.aside.begin(), out.aside.end(), i) == out.aside.end())
      for (Index k = 0; k < values; ++k) kept.push_back(values * i + k);
  const auto rows = static_cast<Index>(kept.size());
  MatrixX factor = rows_of(covariance, kept);
  for (Index c = 0; c < rows; ++c)
    VERNIER_LATER(factor).col(c) = VERNIER_LATER(factor).col(kept[static_cast<std::size_t>(c)]);  // in ascending order
  factor.conservativeResize(rows, rows);
  demand(cholesky(factor), "verify_calibration: the predicted covariance is not positive definite");
  MatrixX all(rows, 1 + registered.cols() + changes.cols());
  VERNIER_LATER(all).col(0) = rows_of(residual, kept);
  VERNIER_LATER(all).middleCols(1, registered.cols()) = rows_of(registered, kept);
  VERNIER_LATER(all).rightCols(changes.cols()) = rows_of(changes, kept);
  solve_lower(factor, all);
  WhitenedResiduals whitened{VERNIER_LATER(all).col(0), VERNIER_LATER(all).rightCols(changes.cols()), {}, 0};
  const VectorX before_registration = squared_column_norms(whitened.columns);
  const Index rank = take_off(VERNIER_LATER(all).middleCols(1, registered.cols()), whitened.residual, whitened.columns);
  whitened.informative = squared_column_norms(whitened.columns);
  for (Index k = 0; k < whitened.informative.size(); ++k)
    whitened.informative(k) = std::sqrt(whitened.informative(k) / (std::max)(before_registration(k), 1e-300));
  out.chi_square = whitened.residual.squaredNorm();
  out.dof = rows - rank;
  out.p_value = out.dof > 0 ? chi_square_tail(out.chi_square, static_cast<double>(out.dof)) : 1;

  out.joints.assign(static_cast<std::size_t>(joints), {});
  const auto columns_of = [&](Index j, bool once) {
    return once ? std::vector<Index>{joints + 2 * j, joints + 2 * j + 1} : std::vector<Index>{j};
  };
  Index tests = 0;
  out.explained = 0;
  for (Index j = 0; j < joints; ++j) {
    JointCheck& joint = out.joints[static_cast<std::size_t>(j)];
    joint.determined = whitened.informative(j) > least_informative;
    const bool revolute = out.joint_types[static_cast<std::size_t>(j)] == JointType::revolute;
    if (joint.determined) {
      ++tests;
      const VectorX column = VERNIER_LATER(whitened.columns).col(j);
      const double information = column.squaredNorm();
      joint.zero_change = -column.dot(whitened.residual) / information;
      joint.zero_std = 1 / std::sqrt(information);
      const double explained = std::pow(joint.zero_change / joint.zero_std, 2);
      joint.zero_p = chi_square_tail(explained, 1);
      out.explained = (std::max)(out.explained, explained);
    }
    if (!revolute) continue;
    const ColumnTest once = test_columns(whitened, columns_of(j, true));
    if (once.rank == 0) continue;
    ++tests;
    joint.once_p = chi_square_tail(once.chi_square, static_cast<double>(once.rank));
    out.explained = (std::max)(out.explained, once.chi_square);
  }
  std::vector<Index> everything(static_cast<std::size_t>(whitened.columns.cols()));
  std::iota(everything.begin(), everything.end(), Index{0});
  const ColumnTest changes_of_all = test_columns(whitened, everything);
  const auto others = static_cast<double>(out.dof - changes_of_all.rank);
  const double scatter = others >= 1 ? (out.chi_square - changes_of_all.chi_square) / others : 0;
  out.closeness = scatter > 0 && changes_of_all.rank > 0 ? 1 - chi_square_tail(changes_of_all.chi_square / scatter,
                                                                               static_cast<double>(changes_of_all.rank))
                                                         : 1;
  // Forward selection: the most significant change first, the others beside those that were named. Nothing has changed
  // where all residuals together are smaller than predicted.
  std::vector<Index> named;
  const double limit = 0.5 * out.options.level / static_cast<double>(std::max<Index>(tests, 1));
  for (Index round = 0; round < joints && out.p_value < 0.5; ++round) {
    const ColumnTest before = test_columns(whitened, named);
    double best = limit;
    Index joint = -1;
    bool once = false;
    for (Index j = 0; j < joints; ++j)
      for (const bool turn : {false, true}) {
        JointCheck& joint_check = out.joints[static_cast<std::size_t>(j)];
        if (joint_check.zero_changed || joint_check.transmission_changed) continue;
        if (turn && out.joint_types[static_cast<std::size_t>(j)] != JointType::revolute) continue;
        std::vector<Index> together = named;
        for (const Index k : columns_of(j, turn)) together.push_back(k);
        const ColumnTest with = test_columns(whitened, together);
        if (with.rank == before.rank) continue;
        const double p = chi_square_tail((std::max)(0.0, with.chi_square - before.chi_square),
                                         static_cast<double>(with.rank - before.rank));
        if (!(p < best)) continue;
        best = p;
        joint = j;
        once = turn;
      }
    if (joint < 0) break;
    JointCheck& joint_check = out.joints[static_cast<std::size_t>(joint)];
    (once ? joint_check.transmission_changed : joint_check.zero_changed) = true;
    for (const Index k : columns_of(joint, once)) named.push_back(k);
  }
  out.consistent = out.p_value >= 0.5 * out.options.level && named.empty();
}

VERNIER_IMPL VerificationReport verified(const VerificationInput& input, const VerifyOptions& options) {
  const MeasuredSet& data = input.data;
  const Index n = data.size(), joints = data.joints.cols(), values = data.oriented() ? 6 : 3;
  VerificationReport out;
  out.poses = n;
  out.origin = data.origin;
  out.joint_types = input.joint_types;
  out.options = options;
  out.registration = input.registration;
  const Vector3 probe = input.registration ? input.registration->motion.probe : Vector3(Vector3::Zero());
  const FrameUpdate update{options.base, false, options.tool, static_cast<int>(joints),
                           data.oriented() && input.registration && input.registration->probe_turned};
  VectorX residual(values * n);
  MatrixX registered(values * n, update.size()), changes(values * n, 3 * joints);
  const MotorAngles& motors = input.estimate.arm.terms().motors;
  const MatrixX angles = motors.angles(data.joints);
  MatrixX erring = input.jacobians;  // columns of the joints, or of the motors that err
  for (Index i = 0; i < n && !motors.none(); ++i) motors.to_motors(erring.data() + 6 * joints * i, 6);
  out.as_fitted.resize(n);
  if (values == 6) out.rotations_as_fitted.resize(n);
  for (Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const Isometry3& pose = input.poses[row];
    const Vector3 shift = translation(pose) - data.position(i);
    Vector3 turn = Vector3::Zero();
    if (values == 6) turn = rotation_difference(rotation(pose) * exp_so3(probe), data.orientations()[row]);
    const double* jacobian = input.jacobians.data() + 6 * joints * i;
    const Rows6 frames = update.columns(pose, jacobian);
    for (Index v = 0; v < values; ++v) {
      const Index k = values * i + v;
      residual(k) = v < 3 ? shift(v) : turn(v - 3);
      for (Index c = 0; c < registered.cols(); ++c) registered(k, c) = frames(v, c);
      for (Index j = 0; j < joints; ++j) {
        const double q = angles(i, j), effect = erring(v, joints * i + j);
        changes(k, j) = effect;
        changes(k, joints + 2 * j) = std::cos(q) * effect;
        changes(k, joints + 2 * j + 1) = std::sin(q) * effect;
      }
    }
    const Isometry3& fitted = input.poses_as_fitted[row];
    out.as_fitted(i) = (translation(fitted) - data.position(i)).norm();
    if (values == 6)
      out.rotations_as_fitted(i) = rotation_difference(rotation(fitted), data.orientations()[row]).norm();
  }
  std::vector<Matrix6> visits;
  const MatrixX covariance = residual_covariance(input, options, values, visits);

  // Each position by itself, in the frames where most of them agree.
  out.errors.resize(n);
  out.normalised.resize(n);
  if (values == 6) out.rotations.resize(n);
  for (Index i = 0; i < n; ++i) {
    const VectorX error = VERNIER_LATER(residual).segment(values * i, 3);
    const MatrixX visit = visits[static_cast<std::size_t>(i)];
    MatrixX factor = VERNIER_LATER(visit).topLeftCorner(3, 3);
    VectorX whitened = error;
    demand(cholesky(factor), "verify_calibration: the predicted covariance is not positive definite");
    solve_lower(factor, whitened);
    out.errors(i) = error.norm();
    out.normalised(i) = whitened.norm();
    if (values == 6) out.rotations(i) = VectorX(VERNIER_LATER(residual).segment(values * i + 3, 3)).norm();
  }
  test_all(input, covariance, residual, registered, changes, values, out);
  if (!out.consistent) {  // a reflector that was bumped is no change of the arm
    const double typical = quantile(out.normalised, 0.5);
    std::vector<Index> distant;
    for (Index i = 0; i < n; ++i)
      if (out.normalised(i) > (std::max)(4.5, 6 * typical)) distant.push_back(i);
    if (!distant.empty() && static_cast<Index>(distant.size()) <= std::max<Index>(1, n / 10) &&
        n - static_cast<Index>(distant.size()) >= 3) {
      out.aside = distant;
      test_all(input, covariance, residual, registered, changes, values, out);
    }
  }
  std::vector<double> counted;
  for (Index i = 0; i < n; ++i)
    if (std::find(out.aside.begin(), out.aside.end(), i) == out.aside.end()) counted.push_back(out.errors(i));
  const MeanInterval mean =
      MeanInterval::of(Eigen::Map<const VectorX>(counted.data(), static_cast<Index>(counted.size())));
  out.mean_error = mean.mean;
  out.mean_upper = mean.upper;
  out.valid = options.accept ? mean.upper <= *options.accept : out.consistent;
  return out;
}

VERNIER_IMPL VerificationReport better_reading(VerificationReport probe, VerificationReport arm) {
  // the probe has three values, a change of a joint one or two: it must explain more than chance would
  const bool turned = probe.chi_square + ReregisterOptions().contradiction_threshold < arm.chi_square - arm.explained;
  return turned ? probe : arm;
}

/// The joints that are named, and how far their zeros moved.
VERNIER_LOCAL std::string named_changes(const VerificationReport& report) {
  std::string out;
  for (std::size_t j = 0; j < report.joints.size(); ++j) {
    const JointCheck& joint = report.joints[j];
    if (!joint.zero_changed && !joint.transmission_changed) continue;
    out += out.empty() ? "" : "; ";
    if (joint.zero_changed)
      out +=
          message("the zero of joint ", report.joint_name(j), " moved by ", brief(joint.zero_change * 1e3), " +- ",
                  brief(1.96 * joint.zero_std * 1e3), report.joint_types[j] == JointType::revolute ? " mrad" : " mm");
    else
      out += message("the transmission of joint ", report.joint_name(j), " changed");
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL std::string VerificationReport::joint_name(std::size_t joint) const {
  return options.controller.same() ? message(joint + 1) : options.controller.erring_joints(joint_types)[joint];
}

VERNIER_IMPL std::string VerificationReport::verdict() const {
  using detail::brief;
  const std::string changes = detail::named_changes(*this),
                    chi = message("chi-square ", brief(chi_square), " of ", dof, " degrees of freedom, p = ",
                                  p_value < 1e-4 ? std::string("below 0.0001") : brief(p_value));
  std::string out = valid        ? "The calibration is still valid"
                    : consistent ? "The calibration does not reach the accepted error"
                                 : "The calibration is no longer valid";
  if (options.accept)
    out += message(": mean error ", brief(mean_error * 1e3), " mm, at most ", brief(mean_upper * 1e3),
                   " mm, accepted up to ", brief(*options.accept * 1e3), " mm");
  if (consistent) {
    out += message(options.accept ? "; " : ": ", "errors are as predicted (", chi, ')');
  } else {
    out += message(options.accept ? "; " : ": ",
                   changes.empty() ? std::string("errors are larger than predicted, of no single joint") : changes,
                   " (", chi, ')');
  }
  if (!aside.empty()) {
    out += ", " + origin.where(aside) + " set aside";
  }
  out += ".";
  if (known > 0)
    out += message(" ", known, known == 1 ? " pose" : " poses", " that it was fitted to ", known == 1 ? "is" : "are",
                   " left out.");
  if (options.fitted_poses) out += " The poses are those that it was fitted to, so that this confirms nothing.";
  return out;
}

VERNIER_IMPL std::vector<std::string> VerificationReport::advice() const {
  std::vector<std::string> out;
  if (options.fitted_poses)
    out.push_back("Check with fresh poses: residuals of poses that a model was fitted to are small by construction.");
  else if (closeness < detail::too_close)
    out.push_back(
        "The joints agree with the calibration more closely than fresh poses would: if these poses are those of the "
        "calibration, check with fresh ones.");
  if (std::string excess = detail::excess_remark(mean_error, options.expected_error); !excess.empty())
    out.push_back(std::move(excess));
  if (!aside.empty()) out.push_back("Measure the rows again that were set aside: they contradict all others.");
  if (valid && registration && options.base)
    out.push_back(
        "Commands in the frame of this measurement need the base as it is now: calibrate --model MODEL "
        "--free base.");
  if (!valid) {
    bool zeros_alone = false, transmission = false;
    for (const JointCheck& joint : joints) {
      zeros_alone = zeros_alone || joint.zero_changed;
      transmission = transmission || joint.transmission_changed;
    }
    if (zeros_alone && !transmission)
      out.push_back(
          "Estimate the zeros of the joints again: calibrate --model MODEL --free base,offsets; then check "
          "again.");
    else
      out.push_back("Calibrate again, with the earlier model as the prior: calibrate --prior MODEL.");
    if (!registration || !(registration->estimated.base || registration->estimated.tool))
      out.push_back("If the sensor or the arm was set up anew, check without --registered.");
    else if (!options.tool)
      out.push_back("If the tool was remounted, check again with --tool-remounted.");
  }
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (!joints[j].determined)
      out.push_back(message("These poses cannot tell a change of the zero of joint ", joint_name(j),
                            " from a motion of base or tool."));
  return out;
}

VERNIER_IMPL std::string VerificationReport::summary() const {
  using detail::brief;
  std::size_t widest = 5;
  for (std::size_t j = 0; j < joints.size(); ++j) widest = (std::max)(widest, joint_name(j).size());
  const auto column = [](const std::string& text, std::size_t width) { return detail::at_right(text, width); };
  std::string out =
      verdict() + "\n\n" + column("joint", widest) + "  zero moved by  +- (95 %)         p  p once a turn\n";
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointCheck& joint = joints[j];
    out += column(joint_name(j), widest);
    if (joint.determined)
      out += column(detail::fixed_digits(joint.zero_change * 1e3, 4), 12) +
             (joint_types[j] == JointType::revolute ? " mrad" : " mm  ") +
             column(detail::fixed_digits(1.96 * joint.zero_std * 1e3, 4), 11) +
             column(detail::significant_digits(joint.zero_p, 2), 10);
    else
      out += detail::at_left("  not determined", 35);
    out += column(detail::significant_digits(joint.once_p, 2), 15);
    const bool changed = (joint.determined && joint.zero_changed) || joint.transmission_changed;
    out += changed ? "  changed\n" : "\n";
  }
  out += "\n";
  for (const std::string& sentence : advice()) out += sentence + "\n";
  return out;
}

}  // namespace vernier
