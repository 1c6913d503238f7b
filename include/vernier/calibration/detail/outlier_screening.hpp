// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which training rows are outliers: before anything is fitted, beside a robust fit of the geometry; and beside the
/// fitted error model.

#include <vector>

#include "vernier/calibration/outlying_row.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::detail {

/// Of a studentised residual (three components): how many spreads an outlier is off at least. Noise reaches it in one
/// of 1e16 rows, and one of 1e6 where its tails are those of Student's distribution with 8 degrees of freedom.
inline constexpr double least_outlier = 9;

/// Rows of one station that are outliers by studentised residuals of a robust fit of frames and geometry, see
/// `leave_out_rows`. None where there are fewer than 10 rows, or where the arm as designed misses most rows: then the
/// data are not of this arm.
/// @param nominal the arm as designed, in the frames where a search starts
/// @param data    poses of the station
/// @param station its number
VERNIER_API std::vector<OutlyingRow> outlying_rows(const ArmGeometry& nominal, const MeasuredSet& data,
                                                   std::size_t station);

/// Rows of one station that are outliers beside a fitted model.
/// @param errors  position errors of the rows, n x 3 [m]
/// @param factors norms of these errors in standard deviations of their predicted ellipsoids, n
VERNIER_API std::vector<OutlyingRow> outlying_rows(const MeasuredSet& data, std::size_t station,
                                                   const PointRows& errors, const VectorX& factors);

/// Rows that are not among the outliers of a station, ascending.
VERNIER_API std::vector<Index> other_rows(const std::vector<OutlyingRow>& outliers, std::size_t station, Index rows);

/// Requires that at most 5 % of all rows, or one, are outliers.
/// @throws CalibrationFailure naming them otherwise
VERNIER_API void require_few(const std::vector<OutlyingRow>& outliers, Index rows);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/detail/outlier_screening.ipp"
#endif
