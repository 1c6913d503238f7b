#pragma once

/// @file
/// Reading and writing measured poses and joint targets as comma-separated values, units in the column names.

#include <span>
#include <string>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"

namespace vernier {

namespace detail {

VERNIER_API MatrixX read_joint_columns(const std::string& path, int joints, std::span<const JointType> types);
/// Joints, then the positions [m], then the orientations [rad] if the file has them.
VERNIER_API MatrixX read_pose_columns(const std::string& path, int joints, std::span<const JointType> types);
/// Joints, then the distances [m].
VERNIER_API MatrixX read_distance_columns(const std::string& path, int joints, std::span<const JointType> types);
VERNIER_API std::string pose_text(const ConstMatrixRef& joints, const PointRows& positions,
                                  const PointRows& orientations);

}  // namespace detail

/// Measured poses from a CSV file: columns q1_rad .. qN_rad (or _deg; _mm or _m for prismatic joints), x_mm, y_mm, z_mm
/// (or _m), optionally rx_rad, ry_rad, rz_rad (rotation vector, or _deg). Any column order; other columns are ignored;
/// blank lines, CRLF and a byte-order mark are accepted.
/// @param path        the file
/// @param joint_types where given, the columns of revolute joints must be angles and those of prismatic ones lengths
/// @throws DataError naming file, line and column
template <int N>
Dataset<N> read_dataset(const std::string& path, std::span<const JointType> joint_types = {}) {
  const MatrixX values = detail::read_pose_columns(path, N, joint_types);
  return Dataset<N>(values.leftCols<N>(), values.middleCols<3>(N),
                    values.cols() > N + 3 ? PointRows(values.rightCols<3>()) : PointRows(0, 3));
}

/// Measured distances from a CSV file: columns q1 .. qN as in `read_dataset`, and distance_mm (or _m, _um).
/// @throws DataError naming file, line and column
template <int N>
Distances<N> read_distances(const std::string& path, std::span<const JointType> joint_types = {}) {
  const MatrixX values = detail::read_distance_columns(path, N, joint_types);
  return Distances<N>(values.leftCols<N>(), values.col(N));
}

/// Joint rows from a CSV file: the q columns of `read_dataset`.
/// @throws DataError naming file, line and column
template <int N>
JointRows<N> read_joints(const std::string& path, std::span<const JointType> joint_types = {}) {
  return detail::read_joint_columns(path, N, joint_types);
}

/// Writes measured poses as `read_dataset` reads them, joints in rad, positions in mm, in digits that read back exactly
/// (positions to the last bit or two, for the change of unit). Atomic: the file is whole, or as it was before.
/// @throws std::runtime_error when the file cannot be written
template <int N>
void write_dataset(const std::string& path, const Dataset<N>& data) {
  write_file(path, detail::pose_text(data.joints(), data.positions(), data.orientations()));
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/csv.ipp"
#endif
