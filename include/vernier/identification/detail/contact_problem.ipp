// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/detail/contact_problem.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identifiable_parameters.hpp"

namespace vernier::detail {

VERNIER_IMPL ContactProblem::ContactProblem(const ArmGeometry& nominal_arm, std::span<const Contact> touched,
                                            const IdentifyOptions& identify_options, const SensorModel& sensor_model)
    : options(identify_options),
      sensors(sensor_model),
      contacts(touched),
      plan(nominal_arm, identify_options),
      nominal(nominal_arm),
      problem(registered(translation(nominal_arm.tool().isometry()))) {
  problem.joint_columns = false;
}

VERNIER_IMPL CalibrationProblem ContactProblem::registered(const Vector3& tool_point) const {
  const Isometry3& tool = nominal.tool().isometry();
  const bool given = (tool_point - translation(tool)).norm() <= 0;
  const FrameParameters of_tool = given ? nominal.tool() : FrameParameters(rigid_motion(rotation(tool), tool_point));
  std::vector<MeasuredSet> sets;
  std::vector<ArmGeometry> arms;
  for (const Contact& contact : contacts) {
    sets.push_back(contact_set(contact).with(sensors));
    arms.push_back(placed(nominal.with_frames({}, of_tool), sets.back()));
  }
  return CalibrationProblem(ArmParameterisation(std::move(arms), {}), std::move(sets), sensors.loss,
                            sensors.joint_sigma);
}

VERNIER_IMPL std::vector<GeometricUnknown> ContactProblem::unknowns_of_objects() const {
  std::vector<GeometricUnknown> out;
  for (int c = 0; c < static_cast<int>(contacts.size()); ++c)
    for (const Index k : frame_unknowns(contact_set(contact(c)))) out.push_back({k, c, plan.scales(k), 0});
  return out;
}

VERNIER_IMPL std::vector<GeometricUnknown> ContactProblem::unknowns_of_arm() const {
  std::vector<GeometricUnknown> out;
  for (const bool of_chain : {false, true})
    for (const Index k : plan.candidates)
      if (of_chain ? plan.in_chain(k) : k >= plan.chain_end && k < plan.chain_end + 3)
        out.push_back({k, -1, plan.scales(k), 0});
  return out;
}

VERNIER_IMPL void ContactProblem::estimate(std::vector<GeometricUnknown> unknowns, double precision) {
  for (GeometricUnknown& u : unknowns) {
    u.precision = 0;
    if (plan.in_chain(u.parameter)) u.precision = precision;
    if (options.priors && u.parameter >= plan.chain_end) u.precision = tool_precision;
    if (known != nullptr &&
        std::find(known->parameters.begin(), known->parameters.end(), u.parameter) != known->parameters.end())
      u.precision = 0;
  }
  problem.arm.set_geometric(std::move(unknowns));
  hold();
}

VERNIER_IMPL ContactProblem::KnownUnknowns ContactProblem::known_unknowns() const {
  KnownUnknowns out;
  if (known == nullptr) return out;
  const auto& unknowns = problem.arm.geometric();
  std::vector<Index> source;
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    if (const auto at = std::find(known->parameters.begin(), known->parameters.end(), unknowns[k].parameter);
        at != known->parameters.end()) {
      out.unknowns.push_back(static_cast<Index>(k));
      source.push_back(at - known->parameters.begin());
    }
  const auto n = static_cast<Index>(source.size());
  out.covariance.resize(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
      const double scales = unknowns[static_cast<std::size_t>(out.unknowns[row])].scale *
                            unknowns[static_cast<std::size_t>(out.unknowns[column])].scale;
      out.covariance(i, j) =
          known->covariance(source[row], source[column]) / scales + (i == j ? known_change * known_change : 0);
    }
  return out;
}

VERNIER_IMPL void ContactProblem::hold() {
  problem.prior.reset();
  const Index size = problem.arm.size();
  if (const KnownUnknowns of = known_unknowns(); !of.unknowns.empty()) {
    MatrixX factor = of.covariance;
    demand(cholesky(factor), known->name, ": its covariance is not positive definite");
    const MatrixX precision = inverse_from_cholesky(factor);
    problem.prior = JointPrior{MatrixX::Zero(size, size), VectorX::Zero(size), static_cast<Index>(of.unknowns.size())};
    for (std::size_t j = 0; j < of.unknowns.size(); ++j)
      for (std::size_t i = 0; i < of.unknowns.size(); ++i)
        problem.prior->precision(of.unknowns[i], of.unknowns[j]) =
            variance * precision(static_cast<Index>(i), static_cast<Index>(j));
  }
  if (scale_observable) return;
  // Residuals of touches shrink with the arm, so its size has to be held: the lengths of its links, taken together.
  const VectorX scale = scale_direction(true);
  const double square = scale.squaredNorm();
  if (!(square > 0)) return;
  constexpr double share = 1e-6;
  const VectorX held = scale / (square * share);
  if (problem.prior && product(problem.prior->precision, scale).norm() > 0) return;  // known already
  if (!problem.prior) problem.prior = JointPrior{MatrixX::Zero(size, size), VectorX::Zero(size), 0};
  problem.prior->precision += matrix_product(held, held.transpose());
  ++problem.prior->unknowns;
}

VERNIER_IMPL VectorX ContactProblem::scale_direction(bool links_alone) const {
  const auto& unknowns = problem.arm.geometric();
  VectorX out = VectorX::Zero(static_cast<Index>(unknowns.size()));
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    const GeometricUnknown& u = unknowns[k];
    const bool of_chain = plan.in_chain(u.parameter);
    if (plan.kinds[static_cast<std::size_t>(u.parameter)] != ParameterKind::length || (links_alone && !of_chain))
      continue;
    out(static_cast<Index>(k)) =
        (links_alone ? nominal : problem.arm.geometry((std::max)(0, u.station))).parameters()(u.parameter) / u.scale;
  }
  return out;
}

VERNIER_IMPL MatrixX ContactProblem::touching_jacobian(const ArmParameterisation& arm) const {
  std::vector<MeasuredSet> sets = problem.sets();
  for (int c = 0; c < arm.stations(); ++c) {
    MeasuredSet& set = sets[static_cast<std::size_t>(c)];
    set.joints = touching_joints(arm.geometry(c), set);
  }
  CalibrationProblem touching(arm, std::move(sets), Loss::squared);
  touching.joint_columns = false;
  return touching.stacked(true).jacobian;
}

VERNIER_IMPL Index ContactProblem::first_block(int station) const {
  Index out = 0;
  for (int c = 0; c < station; ++c) out += contact(c).size();
  return out;
}

VERNIER_IMPL ContactSelection ContactProblem::select(const std::vector<GeometricUnknown>& candidates) {
  problem.arm.set_geometric(candidates);
  MatrixX jacobian = touching_jacobian(problem.arm);
  const VectorX scale = scale_direction(false);
  const double effect = product(jacobian, scale).norm();
  const double apart = std::sqrt(weighted_square(squared_column_norms(jacobian), scale));
  scale_observable = !(effect <= 1e-7 * apart);
  if (!scale_observable) {  // held, so known
    const VectorX held = scale_direction(true);
    const double size = jacobian.norm() / (std::max)(held.norm(), 1e-300);
    append_row(jacobian, size * held);
  }
  const IdentifiableParameters columns(jacobian);
  ContactSelection out;
  const auto unknown = [&](Index k) { return candidates[static_cast<std::size_t>(k)]; };
  for (const Index k : columns.base) out.base.push_back(unknown(k));
  for (const auto& d : columns.dependent) {
    std::vector<GeometricUnknown> absorbed_by;
    for (const Index k : d.absorbed_by) absorbed_by.push_back(unknown(k));
    out.dependent.emplace_back(unknown(d.column), std::move(absorbed_by));
  }
  return out;
}

VERNIER_IMPL double ContactProblem::residual_rms(const CalibrationProblem& of, int station) {
  CalibrationProblem unweighted = of;
  unweighted.reset_weights();
  const StackedRows rows = unweighted.stacked(false);
  double sum = 0, count = 0;
  for (Index i = 0; i < rows.residuals.size(); ++i) {
    const Index block = rows.block[static_cast<std::size_t>(i)];
    if (station >= 0 && unweighted.station_index(block) != station) continue;
    const double residual = rows.residuals(i) * unweighted.set_of(block).sigma().length;
    sum += residual * residual;
    ++count;
  }
  return std::sqrt(sum / (std::max)(count, 1.0));
}

}  // namespace vernier::detail
