// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/detail/contact_assessment.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/detail/contact_identification.hpp"
#include "vernier/identification/detail/contact_problem.hpp"
#include "vernier/least_squares/evidence.hpp"
#include "vernier/least_squares/factorised_equations.hpp"

namespace vernier::detail {

/// @return whether the iteration converged
VERNIER_LOCAL bool solve_contacts(ContactProblem& contacts) {
  if (contacts.problem.arm.size() == 0) return true;
  return contacts.problem.solve(contacts.options.max_iterations);
}

/// Frames of the objects and the tool's point, links nominal: from the given tool, and where that does not fit, from
/// points around it, for many a tool is only roughly known.
VERNIER_LOCAL void register_objects(ContactProblem& contacts) {
  std::vector<GeometricUnknown> unknowns = contacts.unknowns_of_objects();
  for (const GeometricUnknown& unknown : contacts.unknowns_of_arm())
    if (unknown.parameter >= contacts.plan.chain_end) {
      unknowns.push_back(unknown);
      unknowns.back().precision = ContactProblem::tool_precision;
    }
  contacts.problem.arm.set_geometric(unknowns);
  solve_contacts(contacts);
  if (!contacts.options.tool_free() || contacts.residual_rms() < 5e-3) return;
  const Vector3 start = translation(contacts.nominal.tool().isometry());
  for (int k = 0; k < 12; ++k) {
    Vector3 tool_point = start;
    tool_point(k / 2 % 3) += (k < 6 ? 0.1 : 0.2) * (k % 2 == 0 ? 1 : -1);
    CalibrationProblem other = contacts.registered(tool_point);
    other.arm.set_geometric(unknowns);
    std::swap(contacts.problem, other);
    solve_contacts(contacts);
    if (!(contacts.residual_rms() < ContactProblem::residual_rms(other))) std::swap(contacts.problem, other);
  }
}

/// Gives the priors of the chain the common width of most evidence.
VERNIER_LOCAL void size_chain_priors(ContactProblem& contacts) {
  CalibrationProblem& problem = contacts.problem;
  UnknownGroup chain;
  const auto& unknowns = problem.arm.geometric();
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    if (contacts.plan.in_chain(unknowns[k].parameter) && unknowns[k].precision > 0)
      chain.push_back(static_cast<Index>(k));
  if (chain.empty()) return;
  const NormalEquations normal = problem.normal_equations();
  VectorX precisions =
      scale_priors(normal, problem.arm.precisions(), problem.arm.steps(), problem.measured_values(), chain);
  constexpr double widest = 10;  // expected sizes, where there is little evidence
  for (const Index k : chain) precisions(k) = (std::max)(precisions(k), 1 / (widest * widest));
  problem.arm.set_precisions(precisions);
}

/// How much of an earlier calibration has changed, by evidence, and the variance of the noise; the arm moves along.
VERNIER_LOCAL void size_change(ContactProblem& contacts) {
  CalibrationProblem& problem = contacts.problem;
  const auto at_change = [&](double change) {
    contacts.known_change = change;
    contacts.hold();
    return solve_contacts(contacts);
  };
  double best = contacts.known_change;
  for (int round = 0; round < 2; ++round) {
    at_change(best);
    const StackedRows rows = problem.stacked(false);
    const VectorX none = VectorX::Zero(problem.arm.size());
    const double prior_cost = problem.prior ? problem.prior->cost(problem.arm.steps()) : 0;
    const Index freedom = rows.residuals.size() + (problem.prior ? problem.prior->unknowns : 0) - none.size();
    if (freedom > 0) contacts.variance = (rows.residuals.squaredNorm() + prior_cost) / static_cast<double>(freedom);
    constexpr std::array changes{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0};
    std::array<double, changes.size()> evidences{};
    for (std::size_t k = 0; k < changes.size(); ++k) {
      at_change(changes[k]);
      const ContactProblem::KnownUnknowns known = contacts.known_unknowns();
      if (known.unknowns.empty()) return;
      MatrixX factor = known.covariance;
      demand(cholesky(factor), contacts.known->name, ": its covariance is not positive definite");
      const NormalEquations normal = problem.normal_equations();
      const VectorX precisions = problem.arm.precisions(), steps = problem.arm.steps();
      const FactorisedEquations solved(normal, precisions, steps);
      evidences[k] = log_evidence(normal, solved, precisions, steps, problem.measured_values()) -
                     0.5 * cholesky_log_determinant(factor);
    }
    constexpr double believed = 2;  // by how much the evidence of a larger change must be more, as a logarithm
    const double highest = *std::max_element(evidences.begin(), evidences.end());
    const auto first = std::find_if(evidences.begin(), evidences.end(),
                                    [&](double evidence) { return evidence >= highest - believed; });
    if (first != evidences.end()) best = changes[static_cast<std::size_t>(first - evidences.begin())];
  }
  at_change(best);
}

VERNIER_IMPL GeometryByContacts identify_geometry_by_contacts(const ArmGeometry& designed,
                                                              std::span<const Contact> contacts,
                                                              const IdentifyOptions& options,
                                                              const SensorModel& sensors, const KnownGeometry* known) {
  sensors.validate();
  demand(!contacts.empty(), "identify_by_contacts: no contacts");
  for (const Contact& contact : contacts)
    demand(contact.joints().cols() == designed.joints(), "contact ", contact.name(), ": ", contact.joints().cols(),
           " joints, the arm has ", designed.joints());
  ArmGeometry nominal = designed;
  if (known != nullptr) {
    demand(known->values.size() == designed.num_parameters(), known->name, ": ", known->values.size(),
           " parameters, the arm has ", designed.num_parameters());
    demand(known->covariance.rows() == static_cast<Index>(known->parameters.size()), known->name, ": a covariance of ",
           known->covariance.rows(), " parameters, ", known->parameters.size(), " are known");
    VectorX values = designed.parameters();
    for (Index k = ArmParameters::chain_begin; k < ArmParameters::chain_end(designed.joints()); ++k)
      values(k) = known->values(k);
    nominal = designed.with_parameters(values);
  }
  ContactProblem touches(nominal, contacts, options, sensors);
  touches.known = known;
  register_objects(touches);
  const double rms_before = touches.residual_rms();
  demand(std::isfinite(rms_before), "identify_by_contacts: no places of the objects fit the touches");
  for (int c = 0; c < static_cast<int>(contacts.size()); ++c)
    require_spread(touches.problem.arm.geometry(c), touches.problem.sets()[static_cast<std::size_t>(c)]);

  // What is dependent exactly at nominal may not be so at the solution.
  const double chain_precision = options.priors ? 1.0 / 9 : 0;
  std::vector<GeometricUnknown> order = touches.unknowns_of_objects();
  for (const GeometricUnknown& unknown : touches.unknowns_of_arm()) order.push_back(unknown);
  ContactSelection columns = touches.select(order);
  for (int round = 0; round < 3; ++round) {
    touches.estimate(columns.base, chain_precision);
    solve_contacts(touches);
    order = columns.base;
    for (const auto& [unknown, absorbed_by] : columns.dependent) order.push_back(unknown);
    ContactSelection again = touches.select(order);
    if (again.base.size() <= columns.base.size()) break;
    columns = std::move(again);
  }
  touches.estimate(columns.base, chain_precision);
  if (known != nullptr) size_change(touches);
  for (int round = 0; round < 3 && options.priors; ++round) {
    solve_contacts(touches);
    size_chain_priors(touches);
  }
  const bool converged = solve_contacts(touches);

  const ArmGeometry& found = touches.problem.arm.geometry(0);
  GeometryByContacts out{found.with_frames(nominal.base(), found.tool()), {}};
  out.report = contact_report(touches, out.arm, columns, converged);
  out.report.rms_before = rms_before;
  const VectorX by_design = designed.parameters();
  for (std::size_t k = 0; k < out.report.parameters.size(); ++k)
    out.report.parameters[k].nominal = by_design(static_cast<Index>(k));
  if (known != nullptr) {
    out.report.prior = known->name;
    out.report.prior_change = touches.known_change;
  }
  return out;
}

}  // namespace vernier::detail
