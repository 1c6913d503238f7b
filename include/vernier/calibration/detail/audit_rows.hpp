// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Checks of single rows, of time and of joint values, for the audit of data. Each appends what it finds.

#include "vernier/calibration/data_finding.hpp"
#include "vernier/calibration/detail/audit_fit.hpp"

namespace vernier::detail {

/// From which studentised residual on a row is an outlier: larger where the tails are longer than those of noise.
/// @param factors studentised residuals of all rows, three components each
/// @param least   the limit where the tails are those of noise
VERNIER_API double outlier_limit(const VectorX& factors, double least);

/// Rows whose pose is not that of their joints, and pairs of rows whose poses are exchanged.
/// @param geometry a robust fit of the geometry
/// @param stds      of its parameters
/// @param numbers  of the rows, in the data
/// @param origin   where the rows of the data stand
/// @param least_factor studentised residual from which on a row is an outlier, see `outlier_limit`
VERNIER_API void audit_single_rows(const AuditFit& geometry, const ConstVectorRef& stds, const AuditRows& rows,
                                   const std::vector<Index>& numbers, const RowOrigin& origin, double least_factor,
                                   std::vector<DataFinding>& findings);

/// Poses that occur again in all digits.
VERNIER_API void audit_duplicates(const MeasuredSet& data, const PointRows& rotation_vectors,
                                  std::vector<DataFinding>& findings);

/// Joint values that scatter about repeated commands.
VERNIER_API void audit_joint_values(const MatrixX& joints, std::vector<DataFinding>& findings);

/// Joints that always come from the same side.
VERNIER_API void audit_approaches(const MeasuredSet& data, std::vector<DataFinding>& findings);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/detail/audit_rows.ipp"
#endif
