// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "vernier/calibration/data_audit.hpp"
#include "vernier/calibration/detail/audit_deviations.hpp"
#include "vernier/calibration/detail/audit_fit.hpp"
#include "vernier/calibration/detail/audit_hypotheses.hpp"
#include "vernier/calibration/detail/audit_rows.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/same_value.hpp"

namespace vernier {

VERNIER_IMPL std::string_view fault_name(FaultKind kind) {
  switch (kind) {
    case FaultKind::length_unit: return "length_unit";
    case FaultKind::joint_unit: return "joint_unit";
    case FaultKind::joint_sign: return "joint_sign";
    case FaultKind::joint_zero: return "joint_zero";
    case FaultKind::joint_coupling: return "joint_coupling";
    case FaultKind::unexplained: return "unexplained";
    case FaultKind::mirrored_frame: return "mirrored_frame";
    case FaultKind::orientation_convention: return "orientation_convention";
    case FaultKind::shifted_rows: return "shifted_rows";
    case FaultKind::swapped_rows: return "swapped_rows";
    case FaultKind::duplicate_rows: return "duplicate_rows";
    case FaultKind::outlier: return "outlier";
    case FaultKind::joints_read: return "joints_read";
    case FaultKind::approach_never_varies: return "approach_never_varies";
    case FaultKind::session_drift: return "session_drift";
  }
  return "";
}

VERNIER_IMPL bool DataAudit::has(FaultKind kind) const {
  return std::any_of(findings.begin(), findings.end(), [&](const DataFinding& f) { return f.kind == kind; });
}

VERNIER_IMPL std::string DataAudit::summary() const {
  std::string out = findings.empty() ? "data audit: nothing found\n" : "data audit:\n";
  for (const DataFinding& finding : findings) out += "  " + finding.message + "\n";
  if (registered.n > 0)
    out += message("  with registered frames the nominal arm is off by ", detail::brief(registered.median * 1e3),
                   " mm (median), ", detail::brief(registered.max * 1e3), " mm (largest), ", registered.n, " rows\n");
  return out;
}

namespace detail {

/// The findings of a fault of all rows, of signs and couplings one a joint.
VERNIER_LOCAL std::vector<DataFinding> global_findings(const HypothesisFit& found) {
  const AuditHypothesis& h = found.hypothesis;
  std::vector<DataFinding> out;
  const auto add = [&](FaultKind kind, int joint, double size, std::string words) {
    out.push_back({kind, joint, {}, size, "all rows: " + std::move(words)});
  };
  switch (*h.kind) {
    case FaultKind::length_unit:
      add(*h.kind, -1, h.factor,
          "measured positions are " + brief(h.factor) + " times as large as the arm's: correct the unit of x, y, z");
      break;
    case FaultKind::joint_unit:
      add(*h.kind, -1, h.factor,
          h.factor > 1 ? "joint angles look like degrees taken as radians: correct their unit"
                       : "joint angles look like radians taken as degrees: correct their unit");
      break;
    case FaultKind::joint_sign:
    case FaultKind::joint_coupling:
      for (int j = static_cast<int>(h.couplings.size()) - 1; j > 0; --j) {
        const double factor = h.couplings[static_cast<std::size_t>(j)];
        if (same_value(factor, 0)) continue;
        add(FaultKind::joint_coupling, j, factor,
            message("joint ", j + 1, factor > 0 ? " counts joint " : " counts against joint ", j,
                    " as well: ", factor > 0 ? "subtract the column of joint " : "add the column of joint ", j,
                    factor > 0 ? " from its own" : " to its own",
                    h.faults() > 1 ? " before other columns are changed" : ""));
      }
      for (const int joint : h.reversed)
        add(FaultKind::joint_sign, joint, 0,
            message("joint ", joint + 1, " counts in the other direction: reverse the sign of its column"));
      break;
    case FaultKind::mirrored_frame:
      add(*h.kind, -1, 0, "measured coordinates are left-handed: reverse one axis or exchange two");
      break;
    case FaultKind::orientation_convention:
      add(*h.kind, -1, h.convention,
          "orientations look like " + convention_name(h.convention) + ": convert them to rotation vectors in radians");
      break;
    default: break;
  }
  return out;
}

/// The finding that nothing makes the data plausible.
VERNIER_LOCAL DataFinding unexplained_finding(const ErrorStatistics& registered, bool oriented) {
  return {FaultKind::unexplained,
          -1,
          {},
          registered.median,
          message("all rows: nothing makes the data plausible, the nominal arm misses them by ",
                  brief(registered.median * 1e3),
                  " mm (median) in any frames, whichever units, signs, couplings or zeros of joints, shifted rows, "
                  "mirrored frames ",
                  oriented ? "or conventions of orientations " : "",
                  "are assumed: look for another arm, exchanged columns, poses of other joints, or several faults at "
                  "once")};
}

VERNIER_LOCAL DataFinding zero_finding(const ArmGeometry& arm, int joint, double zero) {
  DataFinding out{FaultKind::joint_zero, joint, {}, zero};
  const bool revolute = arm.chain().revolute(joint);
  out.message = message("all rows: joint ", joint + 1, " counts from a zero that is off by ",
                        revolute ? brief(zero * 180 / std::numbers::pi) + " deg" : brief(zero * 1e3) + " mm",
                        ": add that to its column, or correct the nominal ", revolute ? "theta" : "d");
  return out;
}

VERNIER_IMPL DataAudit audit_data(const ArmGeometry& nominal, const MeasuredSet& data,
                                  const PointRows& rotation_vectors, const DataAuditOptions& options) {
  demand(data.size() >= 10, "audit_data: ", data.size(), " poses, 10 or more are needed");
  for (const auto& [value, name] : {std::pair<double, const char*>{options.smallest_zero, "smallest_zero"},
                                    {options.outlier_factor, "outlier_factor"},
                                    {options.length_std, "length_std"},
                                    {options.angle_std, "angle_std"}})
    demand(value > 0 && std::isfinite(value), "audit_data: ", name, " is ", value, ", must be positive and finite");
  DataAudit out{.origin = data.origin};
  AuditRows rows{data.joints, *data.positions(), data.oriented() ? data.orientations() : std::vector<Matrix3>(),
                 rotation_vectors};
  std::vector<Index> numbers(static_cast<std::size_t>(rows.size()));  // of the rows, in the data
  std::iota(numbers.begin(), numbers.end(), Index{0});
  ArmGeometry arm = nominal;

  const AuditRows few = rows.rows(spread_rows(rows.size(), 200));
  HypothesisFit found = best_hypothesis(nominal, few, options.smallest_zero);
  const auto as_they_are = [&] {
    HypothesisFit fit = fit_hypothesis(nominal, rows.rows(spread_rows(rows.size(), 200)), {});
    fit.plausible = true;
    return fit;
  };
  if (found.hypothesis.kind && found.plausible_as_is &&
      !repair_needed(found, nominal, few,
                     audit_geometry_std(nominal, few.oriented(), options.length_std, options.angle_std)))
    found = as_they_are();
  const AuditResiduals all = audit_residuals(found.fit.arm, found.hypothesis.corrected(rows, nominal));
  Index wrong = 0;
  for (Index i = 0; i < rows.size(); ++i)
    if (point(all.position, i).norm() > 8 * found.fit.residuals.score()) ++wrong;
  Index wrong_zero = -1;  // the parameter of a joint's zero that is wrong
  const auto correct_zero = [&](Index parameter, double zero) {
    wrong_zero = parameter;
    VectorX values = nominal.parameters(), start = found.fit.arm.parameters();
    start(parameter) = values(parameter) += zero;  // at the prior's mean, not a whole turn from it
    arm = nominal.with_parameters(values);
    found.fit.arm = found.fit.arm.with_parameters(start);
  };
  std::optional<RowShift> shift;
  if (wrong >= 4 || found.fit.residuals.score() > 0.01 * point_scatter(rows.positions))
    shift = find_shift(nominal, rows, found.fit.residuals.score());
  if (shift) {
    AuditRows paired = rows.rows(shift->fitting);
    for (std::size_t k = 0; k < shift->fitting.size(); ++k) {
      const Index pose = shift->fitting[k] + shift->shifts[k];
      set_point(paired.positions, static_cast<Index>(k), point(rows.positions, pose));
      if (!rows.oriented()) continue;
      paired.orientations[k] = rows.orientations[static_cast<std::size_t>(pose)];
      set_point(paired.rotation_vectors, static_cast<Index>(k), point(rows.rotation_vectors, pose));
    }
    DataFinding finding{FaultKind::shifted_rows, -1, {}, static_cast<double>(shift->shift)};
    for (Index i = shift->first; i < shift->end; ++i) finding.rows.push_back(i);
    finding.message =
        message(data.origin.empty() ? message("rows ", shift->first, " to ", shift->end - 1)
                                    : data.origin.where(shift->first) + " to " + data.origin.where(shift->end - 1),
                ": the pose of a row lies ", counted(std::abs(shift->shift), "row", "rows"),
                shift->shift > 0 ? " below" : " above", " its joints: pair them again, a row was lost or added");
    out.findings.push_back(std::move(finding));
    rows = std::move(paired);
    numbers = shift->fitting;
    found = as_they_are();
  } else if (!found.plausible && rows.oriented()) {  // its positions may be
    AuditRows alone{rows.joints, rows.positions};
    HypothesisFit by_positions =
        best_hypothesis(nominal, alone.rows(spread_rows(rows.size(), 200)), options.smallest_zero);
    if (by_positions.plausible) {
      out.findings.push_back({FaultKind::orientation_convention,
                              -1,
                              {},
                              0,
                              "all rows: orientations are not those of the arm by any convention that is known, "
                              "positions are: convert the orientations, or leave them out"});
      rows = std::move(alone);
      found = std::move(by_positions);
    }
  }
  if (!found.plausible) {
    const HypothesisFit none = fit_hypothesis(nominal, rows, {});
    out.registered = ErrorStatistics::of(distances_from(none.fit.residuals.position, Vector3::Zero()));
    out.findings.push_back(unexplained_finding(out.registered, rows.oriented()));
    audit_duplicates(data, rotation_vectors, out.findings);
    audit_joint_values(rows.joints, out.findings);
    audit_approaches(data, out.findings);
    return out;
  }
  if (found.hypothesis.kind == FaultKind::joint_zero) {
    out.findings.push_back(zero_finding(nominal, found.hypothesis.joint, found.zero));
    correct_zero(zero_parameter(nominal, found.hypothesis.joint), found.zero);
  } else if (found.hypothesis.kind) {
    for (DataFinding& finding : global_findings(found)) out.findings.push_back(std::move(finding));
    rows = found.hypothesis.corrected(rows, nominal);
  }

  VectorX stds = audit_geometry_std(arm, rows.oriented(), options.length_std, options.angle_std);
  if (out.findings.empty()) {
    const auto [joint, zero] =
        small_zero(arm, found.fit, rows.rows(spread_rows(rows.size(), 300)), stds, options.smallest_zero);
    if (joint >= 0) {
      out.findings.push_back(zero_finding(nominal, joint, zero));
      correct_zero(zero_parameter(nominal, joint), zero);
    }
  }
  if (wrong_zero >= 0) stds(wrong_zero) = std::numeric_limits<double>::infinity();  // known by these rows alone
  const AuditFit frames = audit_fit(found.fit.arm, arm.parameters(), audit_frames_std(arm, rows.oriented()), rows, 10);
  out.registered = ErrorStatistics::of(distances_from(frames.residuals.position, Vector3::Zero()));
  AuditFit geometry = audit_fit(frames.arm, arm.parameters(), stds, rows, 12);
  if (data.times.size() > 0) {
    VectorX times(rows.size());
    for (Index i = 0; i < times.size(); ++i) times(i) = data.times(numbers[static_cast<std::size_t>(i)]);
    const BaseTrend trend = base_trend(geometry, stds, rows, times);
    if (trend.chi_square > 40 && trend.displacement > 0.3 * trend.scale) {
      out.findings.push_back(
          {FaultKind::session_drift,
           -1,
           {},
           trend.displacement,
           "all rows: base and sensor move against each other by " + brief(trend.displacement * 1e3) +
               " mm from the first row to the last: look for a loose mount or warm-up, measure again, or let the "
               "drift be estimated"});
      rows = without_trend(rows, trend, times);
      geometry = audit_fit(geometry.arm, arm.parameters(), stds, rows, 12);
    }
  }
  audit_single_rows(geometry, stds, rows, numbers, data.origin, options.outlier_factor, out.findings);
  audit_duplicates(data, rotation_vectors, out.findings);
  audit_joint_values(rows.joints, out.findings);
  audit_approaches(data, out.findings);
  return out;
}

}  // namespace detail
VERNIER_IMPL std::optional<ControllerMap> audited_controller(const DataAudit& audit, const ControllerMap& controller,
                                                             int chain_joints) {
  // couplings are those of the columns as they were read: the last joint comes first
  const Index joints = controller.joints(chain_joints);
  MatrixX factors(chain_joints, joints);
  VectorX zeros(chain_joints);
  for (Index i = 0; i < chain_joints; ++i) {
    for (Index j = 0; j < joints; ++j) factors(i, j) = controller.same() ? (i == j ? 1 : 0) : controller.square()(i, j);
    zeros(i) = controller.same() ? 0 : controller.zeros()(i);
  }
  bool found = false;
  for (const DataFinding& finding : audit.findings)  // a coupled joint is taken apart before signs are reversed
    if (finding.kind == FaultKind::joint_coupling) {
      for (Index j = 0; j < joints; ++j) factors(finding.joint, j) -= finding.size * factors(finding.joint - 1, j);
      zeros(finding.joint) -= finding.size * zeros(finding.joint - 1);
      found = true;
    }
  for (const DataFinding& finding : audit.findings)
    if (finding.kind == FaultKind::joint_sign) {
      for (Index j = 0; j < joints; ++j) factors(finding.joint, j) = -factors(finding.joint, j);
      zeros(finding.joint) = -zeros(finding.joint);
      found = true;
    }
  if (!found) return std::nullopt;
  return ControllerMap(factors, zeros).with_motor_errors(controller.motor_errors());
}

}  // namespace vernier
