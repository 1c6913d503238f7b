// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An audit of measured poses before any geometric fit: units, signs and zeros of joints, mirrored frames, rows that
/// are swapped, shifted, duplicate or wrong, and a session that drifts.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/calibration/data_finding.hpp"
#include "vernier/core/controller_map.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

/// A word for each kind, as in its name: `joint_sign`.
VERNIER_API std::string_view fault_name(FaultKind kind);

/// Options of `audit_data`.
struct DataAuditOptions {
  double smallest_zero = 0.017453292519943295;  ///< smallest error of a revolute joint's zero that is reported [rad]
  double outlier_factor = 9;  ///< of a studentised residual (3 components), from where on a row is an outlier
  double length_std = 2e-3;   ///< expected deviation of a length from its nominal value [m]
  double angle_std = 3e-3;    ///< expected deviation of an angle from its nominal value [rad]
};

/// What an audit found.
struct DataAudit {
  std::vector<DataFinding> findings{};  ///< faults of all rows first
  /// Position errors [m] of the nominal arm in robustly registered frames, after the correction of what was found.
  ErrorStatistics registered{};
  RowOrigin origin{};  ///< where the audited rows stand in files

  /// Whether there is a finding of a kind.
  VERNIER_API bool has(FaultKind kind) const;
  /// The findings as text, a line each.
  VERNIER_API std::string summary() const;
};

namespace detail {

/// `vernier::audit_data` for an arm whose number of joints is known at run time.
VERNIER_API DataAudit audit_data(const ArmGeometry& nominal, const MeasuredSet& data, const PointRows& rotation_vectors,
                                 const DataAuditOptions& options);

}  // namespace detail

/// Looks for faults in measured poses before anything is fitted to them. Base and tool are registered robustly under
/// each hypothesis on all rows (another unit, a reversed joint, ...), and the one with the smallest robust residuals
/// is taken where it halves them. Rows are then assessed by leave-one-out residuals of a robust fit of the geometry,
/// kept near its nominal values.
///
/// What frames absorb is not reported: the zero of the first joint, the zero of the last one and, where positions alone
/// were measured by a tool on the last axis, its sign. Signs of several joints and one coupled joint are found
/// together; other faults one at a time. A repair is advised only if the data become plausible by it.
/// @param nominal the arm as designed; its frames are where the search starts, and may be wrong
/// @param data    10 or more poses in the order of measuring
/// @param options sizes of what is reported
/// @throws std::invalid_argument for fewer poses or an unusable option
/// @cite Rousseeuw and Leroy 1987
template <NominalArm Arm>
DataAudit audit_data(const Arm& nominal, const Measurements<ChainOf<Arm>::dof>& data,
                     const DataAuditOptions& options = {}) {
  demand(data.poses().size() == 1, "audit_data: ", data.poses().size(), " sets of poses; it looks at one at a time");
  return detail::audit_data(ArmGeometry(in_frames(nominal)), data.sets().front(), data.poses().front().orientations(),
                            options);
}

/// The map with which the faults of an audit in signs and couplings of joints vanish; none where it found no such
/// fault.
/// @param audit        of poses whose joints were read by `controller`
/// @param controller   the map of before
/// @param chain_joints number of joints of the chain
/// @throws std::invalid_argument for a map of another number of joints
VERNIER_API std::optional<ControllerMap> audited_controller(const DataAudit& audit, const ControllerMap& controller,
                                                            int chain_joints);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/data_audit.ipp"
#endif
