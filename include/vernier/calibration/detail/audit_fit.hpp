// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Robust fits of an arm to measured poses, for the audit of data.

#include <span>
#include <vector>

#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::detail {

/// Joints and poses of an audit, as measured or corrected.
struct AuditRows {
  MatrixX joints;                       ///< n x dof [rad, m]
  PointRows positions;                  ///< n x 3 [m]
  std::vector<Matrix3> orientations{};  ///< n, or none
  PointRows rotation_vectors{};         ///< n x 3, the values that were taken as rotation vectors; or none

  Index size() const { return joints.rows(); }
  bool oriented() const { return !orientations.empty(); }
  /// As a set of measurements.
  VERNIER_API MeasuredSet measured() const;
  /// Named rows; the poses are those of rows `shift` further on.
  VERNIER_API AuditRows rows(std::span<const Index> indices, Index shift = 0) const;
};

/// Residuals of rows, and their robust scales per component.
struct AuditResiduals {
  PointRows position;         ///< measured - predicted [m]
  PointRows rotation;         ///< rotation vectors that lead from predicted to measured [rad]; or 0 x 3
  double position_scale = 0;  ///< [m]
  double rotation_scale = 0;  ///< [rad]

  /// Both scales as a length, that of orientations at a lever of 0.25 m [m].
  VERNIER_API double score() const;
};

/// Residuals of an arm.
VERNIER_API AuditResiduals audit_residuals(const ArmGeometry& arm, const AuditRows& rows);

/// A robust scale per component of rows of three: from the median of their norms.
VERNIER_API double robust_scale(const PointRows& residuals);

/// A robust fit.
struct AuditFit {
  ArmGeometry arm;           ///< as fitted
  AuditResiduals residuals;  ///< of all rows
};

/// A row left out of a fit.
struct LeftOut {
  double position = 0, rotation = 0;                ///< residuals [m, rad]
  double position_factor = 0, rotation_factor = 0;  ///< studentised norms of three components; median 1.54
  Matrix3 position_weight = Matrix3::Zero();        ///< inverse covariance of the prediction's error, scaled likewise
};

/// Which parameters of an arm are fitted: a standard deviation about the nominal value each, infinite for free ones,
/// 0 for those that are kept.
VERNIER_API VectorX audit_frames_std(const ArmGeometry& arm, bool oriented);
/// The fit with the parameters of the chain free about their nominal values.
VERNIER_API VectorX audit_geometry_std(const ArmGeometry& arm, bool oriented, double length_std, double angle_std);

/// Index of the parameter that moves a joint's zero.
VERNIER_API Index zero_parameter(const ArmGeometry& arm, int joint);

/// Iteratively reweighted least squares (Cauchy's loss) with priors.
/// @param start   where it starts
/// @param centre  nominal values of the parameters
/// @param stds     of each parameter, see `audit_frames_std`
VERNIER_API AuditFit audit_fit(const ArmGeometry& start, const ConstVectorRef& centre, const ConstVectorRef& stds,
                               const AuditRows& rows, int iterations);

/// Every row left out of a fit at its solution.
VERNIER_API std::vector<LeftOut> leave_out_rows(const AuditFit& fit, const ConstVectorRef& stds, const AuditRows& rows);

/// A trend of the base over time.
struct BaseTrend {
  Vector6 motion = Vector6::Zero();  ///< from the first to the last row, about the mean position [m, rad]
  Vector3 centre = Vector3::Zero();  ///< mean position [m]
  double chi_square = 0;             ///< of its six values
  double displacement = 0;           ///< root mean square over the measured positions [m]
  double scale = 0;                  ///< robust scale of what is left, per component [m]
};

/// A linear trend of the base over `times`, estimated together with the parameters of the fit and joint errors of low
/// orders: one a forty rows, at most eight.
VERNIER_API BaseTrend base_trend(const AuditFit& fit, const ConstVectorRef& stds, const AuditRows& rows,
                                 const ConstVectorRef& times);

/// The rows as if base and sensor had stood still.
VERNIER_API AuditRows without_trend(const AuditRows& rows, const BaseTrend& trend, const ConstVectorRef& times);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/detail/audit_fit.ipp"
#endif
