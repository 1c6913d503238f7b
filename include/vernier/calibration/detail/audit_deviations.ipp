// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vernier/calibration/detail/audit_deviations.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::detail {

/// What a robust fit of the geometry leaves and how far it goes from the nominal values, as minus two log likelihoods.
/// @param nominal values of the parameters
/// @param free    a parameter without a prior, or -1
/// @param sigma   of a position, per component [m]
/// @param turn    of an orientation, likewise [rad]
VERNIER_LOCAL double geometry_cost(const AuditFit& fit, const VectorX& nominal, const VectorX& stds, Index free,
                                   double sigma, double turn) {
  double sum = 0;
  const VectorX values = fit.arm.parameters();
  for (Index k = 6; k < values.size() - 6; ++k)
    if (k != free && stds(k) > 0) sum += std::pow((values(k) - nominal(k)) / stds(k), 2);
  for (Index i = 0; i < fit.residuals.position.rows(); ++i)
    sum += 16 * std::log1p(point(fit.residuals.position, i).squaredNorm() / (16 * sigma * sigma));
  for (Index i = 0; i < fit.residuals.rotation.rows(); ++i)
    sum += 16 * std::log1p(point(fit.residuals.rotation, i).squaredNorm() / (16 * turn * turn));
  return sum;
}

VERNIER_IMPL std::pair<int, double> small_zero(const ArmGeometry& nominal, const AuditFit& frames,
                                               const AuditRows& rows, const VectorX& stds, double smallest_zero) {
  const VectorX centre = nominal.parameters();
  const AuditFit plain = audit_fit(frames.arm, centre, stds, rows, 12);
  std::vector<AuditFit> fits;
  std::vector<int> joints;
  for (int j = 1; j + 1 < nominal.joints(); ++j) {
    VectorX freed = stds;
    freed(zero_parameter(nominal, j)) = std::numeric_limits<double>::infinity();
    fits.push_back(audit_fit(plain.arm, centre, freed, rows, 12));
    joints.push_back(j);
  }
  double sigma = plain.residuals.position_scale, turn = plain.residuals.rotation_scale;
  for (const AuditFit& fit : fits) {
    sigma = (std::min)(sigma, fit.residuals.position_scale);
    turn = (std::min)(turn, fit.residuals.rotation_scale);
  }
  const double none = geometry_cost(plain, centre, stds, -1, sigma, turn);
  double best = std::numeric_limits<double>::infinity(), zero = 0;
  int joint = -1;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const Index parameter = zero_parameter(nominal, joints[k]);
    if (const double now = geometry_cost(fits[k], centre, stds, parameter, sigma, turn); now < best) {
      best = now;
      joint = joints[k];
      zero = fits[k].arm.parameters()(parameter) - centre(parameter);
    }
  }
  if (joint < 0 || none - best < 15 || !nominal.chain().revolute(joint) || std::abs(zero) < smallest_zero)
    return {-1, 0};
  return {joint, zero};
}

VERNIER_IMPL bool repair_needed(const HypothesisFit& repair, const ArmGeometry& nominal, const AuditRows& rows,
                                const VectorX& stds) {
  const VectorX centre = nominal.parameters();
  const AuditFit plain = audit_fit(starting_frames(nominal, rows.measured(), true, true), centre, stds, rows, 12);
  VectorX freed = stds;
  const bool zero = repair.hypothesis.kind == FaultKind::joint_zero;
  const Index parameter = zero ? zero_parameter(nominal, repair.hypothesis.joint) : -1;
  if (zero) freed(parameter) = std::numeric_limits<double>::infinity();
  const AuditFit with = audit_fit(repair.fit.arm, centre, freed, repair.hypothesis.corrected(rows, nominal), 12);
  const double sigma = (std::min)(plain.residuals.position_scale, with.residuals.position_scale),
               turn = (std::min)(plain.residuals.rotation_scale, with.residuals.rotation_scale);
  const double none = geometry_cost(plain, centre, stds, -1, sigma, turn),
               repaired = geometry_cost(with, centre, stds, parameter, sigma, turn);
  return none - repaired >= 15;
}

}  // namespace vernier::detail
