// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/calibration/detail/audit_hypotheses.hpp"
#include "vernier/calibration/detail/audit_rows.hpp"
#include "vernier/calibration/detail/outlier_screening.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"

namespace vernier::detail {

/// An outlier, named.
VERNIER_LOCAL OutlyingRow named_row(const MeasuredSet& data, std::size_t station, Index row) {
  OutlyingRow out{.station = station, .row = row};
  if (data.origin.empty()) return out;
  const auto i = static_cast<std::size_t>(row);
  out.file = data.origin.files[static_cast<std::size_t>(data.origin.file[i])];
  out.line = data.origin.line[i];
  return out;
}

VERNIER_IMPL std::vector<OutlyingRow> outlying_rows(const ArmGeometry& nominal, const MeasuredSet& data,
                                                    std::size_t station) {
  constexpr Index fewest = 10;
  constexpr double least_sigmas = 4;  // of the sensor, which residuals of exact data do not reach
  if (data.size() < fewest || data.positions() == nullptr) return {};
  const AuditRows rows{data.joints, *data.positions(), data.oriented() ? data.orientations() : std::vector<Matrix3>(),
                       PointRows::Zero(data.oriented() ? data.size() : 0, 3)};
  const HypothesisFit registered = fit_hypothesis(nominal, rows, {});
  if (!plausible_residuals(nominal, rows, registered.fit.residuals)) return {};
  const VectorX stds = audit_geometry_std(nominal, rows.oriented(), 2e-3, 3e-3);
  const AuditFit geometry = audit_fit(registered.fit.arm, nominal.parameters(), stds, rows, 12);
  const std::vector<LeftOut> left = leave_out_rows(geometry, stds, rows);
  VectorX by_position(rows.size()), by_rotation(rows.size());
  for (Index i = 0; i < rows.size(); ++i) {
    by_position(i) = left[static_cast<std::size_t>(i)].position_factor;
    by_rotation(i) = left[static_cast<std::size_t>(i)].rotation_factor;
  }
  const double position_limit = outlier_limit(by_position, least_outlier),
               rotation_limit = outlier_limit(by_rotation, least_outlier);
  std::vector<OutlyingRow> out;
  for (Index i = 0; i < rows.size(); ++i) {
    const LeftOut& row = left[static_cast<std::size_t>(i)];
    const bool off = row.position_factor > position_limit && row.position > least_sigmas * data.sigma().length;
    const bool turned = row.rotation_factor > rotation_limit && row.rotation > least_sigmas * data.sigma().angle;
    if (!off && !turned) continue;
    out.push_back(named_row(data, station, i));
    out.back().position = row.position;
    out.back().rotation = row.rotation;
    out.back().factor = (std::max)(row.position_factor, row.rotation_factor);
  }
  return out;
}

VERNIER_IMPL std::vector<OutlyingRow> outlying_rows(const MeasuredSet& data, std::size_t station,
                                                    const PointRows& errors, const VectorX& factors) {
  std::vector<OutlyingRow> out;
  const double limit = outlier_limit(factors, least_outlier);
  for (Index i = 0; i < factors.size(); ++i) {
    if (!(factors(i) > limit)) continue;
    out.push_back(named_row(data, station, i));
    out.back().position = point(errors, i).norm();
    out.back().factor = factors(i);
  }
  return out;
}

VERNIER_IMPL std::vector<Index> other_rows(const std::vector<OutlyingRow>& outliers, std::size_t station, Index rows) {
  std::vector<Index> out;
  for (Index i = 0; i < rows; ++i)
    if (std::none_of(outliers.begin(), outliers.end(),
                     [&](const OutlyingRow& one) { return one.station == station && one.row == i; }))
      out.push_back(i);
  return out;
}

VERNIER_IMPL void require_few(const std::vector<OutlyingRow>& outliers, Index rows) {
  const auto found = static_cast<Index>(outliers.size());
  if (found <= (std::max<Index>)(1, rows / 20)) return;
  throw CalibrationFailure(message(where(outliers), ": ", found, " of ", rows,
                                   " training rows are outliers, more than 5 %: check the entries and the pairing of "
                                   "joints and poses, or keep them (keep-outliers)"));
}

}  // namespace vernier::detail
