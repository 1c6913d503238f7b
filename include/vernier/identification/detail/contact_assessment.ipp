// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/detail/contact_assessment.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/detail/shared_touch_errors.hpp"
#include "vernier/identification/identifiable_parameters.hpp"
#include "vernier/least_squares/estimate_covariance.hpp"
#include "vernier/least_squares/loss.hpp"
#include "vernier/measurements/position_sensor.hpp"

namespace vernier::detail {

/// How many directions of the arm measured positions at the same joints determine, apart from its base.
VERNIER_LOCAL Index rank_by_positions(const ContactProblem& solved, const ArmGeometry& arm) {
  Index count = 0;
  for (const Contact& contact : solved.contacts) count += contact.size();
  MatrixX joints(count, arm.joints());
  count = 0;
  for (const Contact& contact : solved.contacts) {
    joints.middleRows(count, contact.size()) = contact.joints();
    count += contact.size();
  }
  const PointRows points = arm.positions(joints);
  const MeasuredSet ideal("positions", std::move(joints), PositionSensor(points, 1));
  std::vector<GeometricUnknown> unknowns;
  for (Index k = 0; k < 6; ++k) unknowns.push_back({k, -1, solved.plan.scales(k), 0});
  for (const GeometricUnknown& unknown : solved.unknowns_of_arm()) unknowns.push_back(unknown);
  const CalibrationProblem measured(ArmParameterisation({arm}, std::move(unknowns)), {ideal}, Loss::squared);
  const IdentifiableParameters columns(measured.stacked(true).jacobian);
  return static_cast<Index>(columns.base.size()) -
         static_cast<Index>(std::count_if(columns.base.begin(), columns.base.end(), [](Index k) { return k < 6; }));
}

/// Singular values of everything: base (which has no effect), objects, tool and chain.
VERNIER_LOCAL VectorX contact_singular_values(const ContactProblem& solved) {
  ArmParameterisation all = solved.problem.arm;
  std::vector<GeometricUnknown> unknowns = solved.unknowns_of_objects();
  for (const GeometricUnknown& unknown : solved.unknowns_of_arm()) unknowns.push_back(unknown);
  Index without_effect = 6;
  for (const Index k : solved.plan.candidates) without_effect += k >= solved.plan.chain_end + 3;
  all.set_geometric(unknowns);
  const MatrixX jacobian = solved.touching_jacobian(all);
  MatrixX padded = MatrixX::Zero((std::max)(jacobian.rows(), jacobian.cols()), jacobian.cols());
  padded.topRows(jacobian.rows()) = jacobian;
  const VectorX values = right_singular(triangular_factor(padded)).values;
  VectorX out = VectorX::Zero(values.size() + without_effect);
  out.head(values.size()) = values;
  return out;
}

/// Parameters as they were and are; those that touches do not determine with the reason.
VERNIER_LOCAL std::vector<ParameterEstimate> contact_parameters(const ContactProblem& solved,
                                                                const ArmGeometry& identified,
                                                                const ContactSelection& selection) {
  const IdentificationPlan& plan = solved.plan;
  const VectorX before = solved.nominal.parameters(), now = identified.parameters();
  std::vector<ParameterEstimate> out;
  for (Index k = 0; k < before.size(); ++k)
    out.push_back({plan.names[static_cast<std::size_t>(k)],
                   plan.kinds[static_cast<std::size_t>(k)],
                   before(k),
                   now(k),
                   0,
                   ParameterState::fixed,
                   {},
                   plan.scales(k)});
  const auto hide = [&](Index k, std::string remark) {
    ParameterEstimate& p = out[static_cast<std::size_t>(k)];
    p.state = ParameterState::not_identifiable;
    p.remark = std::move(remark);
  };
  for (Index k = 0; k < 6; ++k) hide(k, "contacts are relative to the arm");
  for (const Index k : plan.candidates)
    if (k >= plan.chain_end + 3) hide(k, "no effect on touches");
  const auto name = [&](const GeometricUnknown& unknown) {
    if (unknown.station >= 0) return message("the place of ", solved.contact(unknown.station).name());
    return plan.names[static_cast<std::size_t>(unknown.parameter)];
  };
  for (const auto& [unknown, absorbed_by] : selection.dependent) {
    if (unknown.station >= 0) continue;  // counted as missing
    std::vector<std::string> others;
    for (const GeometricUnknown& other : absorbed_by)
      if (const std::string text = name(other); std::find(others.begin(), others.end(), text) == others.end())
        others.push_back(text);
    std::string remark = others.empty() ? "no effect on touches" : "absorbed by ";
    for (std::size_t j = 0; j < others.size() && j < 4; ++j) remark += (j > 0 ? ", " : "") + others[j];
    hide(unknown.parameter, remark + (others.size() > 4 ? ", ..." : ""));
  }
  return out;
}

/// Adds the rows of a prior with correlations below those of measurements.
VERNIER_LOCAL void append_prior(const JointPrior& prior, MatrixX& stack) {
  const SymmetricEigen axes = symmetric_eigen(prior.precision);
  const Index n = axes.values.size();
  for (Index k = n - prior.unknowns; k < n; ++k)
    append_row(stack, std::sqrt((std::max)(axes.values(k), 0.0)) * VERNIER_LATER(axes.vectors).col(k));
}

/// Touches that are too far off, predicted without them.
/// @param inverse of the matrix of the normal equations
VERNIER_LOCAL std::vector<SuspectTouch> suspect_touches(const ContactProblem& solved, const MatrixX& inverse) {
  constexpr double limit = 5;  // standard deviations; chance exceeds it once in a million touches
  const CalibrationProblem& problem = solved.problem;
  CalibrationProblem unweighted = problem;
  unweighted.reset_weights();
  const StackedRows rows = problem.stacked(true), full = unweighted.stacked(false);
  std::vector<SuspectTouch> all;
  std::array<std::vector<double>, 2> kinds;  // of one value, and of three
  std::vector<std::size_t> kind_of;
  for (Index b = 0, row = 0; b < problem.num_blocks(); ++b) {
    const MeasuredSet& set = problem.set_of(b);
    const Index values = set.values();
    const MatrixX columns = VERNIER_LATER(rows.jacobian).middleRows(row, values);
    MatrixX kept = -1.0 * matrix_product(matrix_product(columns, inverse), columns.transpose());
    for (Index k = 0; k < values; ++k) kept(k, k) += 1;
    VectorX left_out = VERNIER_LATER(rows.residuals).segment(row, values);
    const double weighted = left_out.norm(), plain = VERNIER_LATER(full.residuals).segment(row, values).norm();
    solve_general(kept, left_out);
    const double error = weighted > 0 ? left_out.norm() * plain / weighted : 0;
    const Contact& contact = solved.contact(problem.station_index(b));
    all.push_back({contact.name(), problem.row_of(b), contact.origin().where(problem.row_of(b)), error});
    kind_of.push_back(values == 1 ? 0 : 1);
    kinds[kind_of.back()].push_back(error);
    row += values;
  }
  const std::array<double, 2> sigma{(std::max)(1.0, kinds[0].empty() ? 0 : robust_sigma(kinds[0], 1)),
                                    (std::max)(1.0, kinds[1].empty() ? 0 : robust_sigma(kinds[1], 3))};
  std::vector<SuspectTouch> out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].factor = all[k].error / sigma[kind_of[k]];
    all[k].error *= problem.set_of(static_cast<Index>(k)).sigma().length;
    if (all[k].factor > limit) out.push_back(std::move(all[k]));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const SuspectTouch& a, const SuspectTouch& b) { return a.factor > b.factor; });
  return out;
}

/// Adds the covariance of what was estimated, and what follows from it, to a report with parameters.
VERNIER_LOCAL void add_contact_covariance(const ContactProblem& solved, ContactReport& report) {
  const CalibrationProblem& problem = solved.problem;
  const auto& estimated = problem.arm.geometric();
  const StackedRows rows = problem.stacked(true);
  MatrixX stack = rows.jacobian;
  if (problem.prior) append_prior(*problem.prior, stack);
  const VectorX precisions = problem.arm.precisions();
  const VectorX ones = VectorX::Ones(stack.rows());
  VectorX variances(precisions.size());
  for (Index k = 0; k < variances.size(); ++k) variances(k) = 1 / (std::max)(precisions(k), 1e-300);
  const EstimateCovariance unit(stack, ones, precisions, variances);
  double explained = static_cast<double>(precisions.size());
  if (unit.inverse.size() > 0) explained -= diagonal_of(unit.inverse).dot(precisions);
  const double of_prior = problem.prior ? problem.prior->cost(problem.arm.steps()) : 0;
  const double freedom = static_cast<double>(rows.residuals.size()) - explained +
                         static_cast<double>(problem.prior ? problem.prior->unknowns : 0);
  const double variance = freedom >= 1 ? (rows.residuals.squaredNorm() + of_prior) / freedom : 1;
  if (unit.inverse.size() > 0) report.suspects = suspect_touches(solved, unit.inverse);
  SharedTouchErrors shared;
  if (unit.inverse.size() > 0 && freedom >= 1) shared = shared_touch_errors(solved, unit.inverse, variance);
  const bool known = shared.covariance.size() > 0;
  report.object_sigma = known ? shared.object : 0;
  report.joint_sigma = known ? shared.joint : 0;
  MatrixX covariance;
  if (known) {
    VectorX row_variance = VectorX::Constant(stack.rows(), shared.variance);
    for (Index k = rows.residuals.size(); k < stack.rows(); ++k) row_variance(k) = variance;  // of the prior
    covariance = EstimateCovariance(stack, row_variance, precisions, variance * variances).covariance;
    covariance += shared.covariance;
  } else if (unit.inverse.size() > 0) {
    covariance = variance * unit.inverse;
  }
  report.rank = unit.rank;
  report.condition = unit.condition;
  if (unit.singular_values.size() > 0)
    report.observability = Observability::of(unit.singular_values, problem.num_blocks());

  const ContactProblem::KnownUnknowns known_before = solved.known_unknowns();
  std::vector<Index> of_arm;
  for (std::size_t k = 0; k < estimated.size(); ++k)
    if (estimated[k].station < 0) of_arm.push_back(static_cast<Index>(k));
  if (unit.inverse.size() > 0)
    report.covariance.resize(static_cast<Index>(of_arm.size()), static_cast<Index>(of_arm.size()));
  report.independent_covariance = report.covariance;
  for (std::size_t i = 0; i < of_arm.size(); ++i) {
    const GeometricUnknown& u = estimated[static_cast<std::size_t>(of_arm[i])];
    ParameterEstimate& p = report.parameters[static_cast<std::size_t>(u.parameter)];
    report.free.push_back(u.parameter);
    p.state = ParameterState::identified;
    if (u.precision > 0) p.prior_std = u.scale * std::sqrt(variance / u.precision);
    for (std::size_t k = 0; k < known_before.unknowns.size(); ++k)
      if (known_before.unknowns[k] == of_arm[i])
        p.prior_std = u.scale * std::sqrt(known_before.covariance(static_cast<Index>(k), static_cast<Index>(k)));
    if (unit.inverse.size() == 0) continue;
    for (std::size_t j = 0; j < of_arm.size(); ++j) {
      const auto row = static_cast<Index>(i), column = static_cast<Index>(j);
      const double scale = u.scale * estimated[static_cast<std::size_t>(of_arm[j])].scale;
      report.covariance(row, column) = covariance(of_arm[i], of_arm[j]) * scale;
      report.independent_covariance(row, column) = variance * unit.inverse(of_arm[i], of_arm[j]) * scale;
    }
    p.std = std::sqrt(report.covariance(static_cast<Index>(i), static_cast<Index>(i)));
    if (p.std * p.std > 0.5 * p.prior_std * p.prior_std) p.state = ParameterState::weak;
  }
}

/// Status and message, of a report that has everything else about the arm.
VERNIER_LOCAL void add_contact_status(const ContactProblem& solved, const ArmGeometry& identified, bool converged,
                                      ContactReport& report) {
  const CalibrationProblem& problem = solved.problem;
  const auto estimated = static_cast<Index>(problem.arm.geometric().size()),
             of_arm = static_cast<Index>(report.free.size());
  report.missing = rank_by_positions(solved, identified.with_frames({}, identified.tool())) - of_arm;
  const Index touches = problem.num_blocks();
  report.message = message(touches, " touches of ", counted(solved.contacts.size(), "object", "objects"), " determine ",
                           counted(of_arm, "parameter of the arm", "parameters of the arm"));
  if (!converged) {
    report.status = IdentifyStatus::not_converged;
    report.message = message("the steps did not vanish within ", solved.options.max_iterations, " iterations");
  } else if (report.missing > 0 && solved.known == nullptr) {  // else an earlier calibration knows the rest
    report.status = IdentifyStatus::underdetermined;
    report.message += message("; measured positions at the same joints would determine ", report.missing, " more");
  } else if (problem.measured_values() + (problem.prior ? problem.prior->unknowns : 0) <= estimated) {
    report.status = IdentifyStatus::underdetermined;
    report.message = message(touches, " touches give ", problem.measured_values(), " measured values for ", estimated,
                             " unknowns of arm and objects");
  }
}

/// Where the objects are, in the frame of the base.
VERNIER_LOCAL std::vector<TouchedObject> touched_objects(const ContactProblem& solved) {
  std::vector<TouchedObject> out;
  for (int c = 0; c < static_cast<int>(solved.contacts.size()); ++c) {
    const Contact& contact = solved.contact(c);
    const ArmGeometry& arm = solved.problem.arm.geometry(c);
    const Isometry3 out_of = composed(solved.nominal.base().isometry(), inverse_of(arm.base().isometry()));
    Vector3 local = Vector3::Zero();
    if (contact.kind() == ContactKind::plane) {
      local = centroid(arm.positions(contact.joints()));
      local.z() = 0;
    }
    TouchedObject object{contact.name(),  contact.kind(),
                         contact.size(),  transformed(out_of, local),
                         Vector3::Zero(), ContactProblem::residual_rms(solved.problem, c)};
    const MeasuredSet& set = solved.problem.sets()[static_cast<std::size_t>(c)];
    if (frame_unknowns(set) != std::vector<Index>{0, 1, 2}) object.direction = rotation(out_of) * set.axis();
    out.push_back(std::move(object));
  }
  return out;
}

VERNIER_IMPL ContactReport contact_report(const ContactProblem& solved, const ArmGeometry& identified,
                                          const ContactSelection& selection, bool converged) {
  ContactReport out;
  out.scale_observable = solved.scale_observable;
  out.rms_after = solved.residual_rms();
  out.singular_values = contact_singular_values(solved);
  out.unobservable = std::count_if(out.singular_values.begin(), out.singular_values.end(),
                                   [&](double value) { return value <= 1e-9 * out.singular_values(0); });
  out.parameters = contact_parameters(solved, identified, selection);
  add_contact_covariance(solved, out);
  add_contact_status(solved, identified, converged, out);
  out.objects = touched_objects(solved);
  return out;
}

}  // namespace vernier::detail
