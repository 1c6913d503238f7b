// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Reading and writing measured poses and joint targets as comma-separated values, units in the column names.

#include <algorithm>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/data/contacts.hpp"
#include "vernier/data/csv_format.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"

namespace vernier {

namespace detail {

/// What stands beside the joints of planned poses.
struct VisitColumns {
  MatrixX payloads{};                 ///< n x 4, as `Dataset::payloads` has them; no rows where that is not stated
  std::vector<std::string> boards{};  ///< name of the place of the board; none where that is not stated
};
/// @param visits where wanted, becomes what stands beside the joints
VERNIER_API MatrixX read_joint_columns(const std::string& path, int joints, std::span<const JointType> types,
                                       const CsvFormat& format, VisitColumns* visits = nullptr);
/// The columns of a file of poses.
struct PoseColumns {
  MatrixX values;        ///< joints, then the positions [m], then the orientations [rad] if the file has them
  MatrixX previous;      ///< joint values from which each pose was approached; NaN where unknown
  VectorX times;         ///< of measuring
  VectorX temperatures;  ///< [deg C]; none where the file has none
  MatrixX payloads;      ///< n x 4 [kg, m], see `Dataset::payloads`; no rows where the file has none
  RowOrigin origin;      ///< lines of the rows
  std::vector<Matrix6> covariances{};  ///< [m, rad]; none where the file has none
  std::vector<std::string> points{};   ///< reflector of each row; none where the file names none
};
VERNIER_API PoseColumns read_pose_columns(const std::string& path, int joints, std::span<const JointType> types,
                                          const CsvFormat& format);
/// The rows of a file as samples.
template <int N>
Dataset<N> dataset_of(const PoseColumns& from) {
  return Dataset<N>(from.values.leftCols<N>(), from.values.middleCols<3>(N),
                    from.values.cols() > N + 3 ? PointRows(from.values.rightCols<3>()) : PointRows(0, 3))
      .approached_from(from.previous)
      .measured_at(from.times)
      .at_temperatures(from.temperatures)
      .carrying(from.payloads)
      .with_covariances(from.covariances)
      .from(from.origin);
}
/// The columns of a file of targets; what it lacks has no rows.
struct TargetColumns {
  MatrixX joints;            ///< n x joints [rad, m]
  MatrixX poses;             ///< positions [m], then orientations as rotation vectors if the file has them [rad]
  std::vector<bool> linear;  ///< whether the move to each is a linear one
};
VERNIER_API TargetColumns read_target_columns(const std::string& path, int joints, std::span<const JointType> types,
                                              const CsvFormat& format);
/// The columns of a file of distances.
struct DistanceColumns {
  MatrixX values;    ///< joints, then the distances [m]
  RowOrigin origin;  ///< lines of the rows
};
VERNIER_API DistanceColumns read_distance_columns(const std::string& path, int joints, std::span<const JointType> types,
                                                  const CsvFormat& format);
VERNIER_API std::string pose_text(const ConstMatrixRef& joints, const PointRows& positions,
                                  const PointRows& orientations, const ConstMatrixRef& previous, const VectorX& times,
                                  const VectorX& temperatures, const MatrixX& payloads,
                                  std::span<const JointType> types, const ControllerMap& controller,
                                  const std::vector<Matrix6>& covariances, const std::vector<std::string>& points = {});
/// @throws DataError for rows of several reflectors
VERNIER_API void require_one_point(const PoseColumns& columns, const std::string& path);

}  // namespace detail

/// Measured poses from a CSV file: columns q1_rad .. qN_rad (or _deg, _mrad; _mm, _m or _um for prismatic joints),
/// x_mm, y_mm, z_mm (or _m, _um), optionally rx_rad, ry_rad, rz_rad (rotation vector, or _deg, _mrad), or a
/// quaternion qw, qx, qy, qz, or a rotation matrix r11, r12 .. r33, or Euler angles as `format.euler` says. Any column
/// order; other columns are not read, and `format.remark` is told their names; without it, a name like
/// `X_mm` or `time_min` is refused. Accepted are blank lines, lines that end
/// with CRLF or CR, a byte-order mark, and quotation marks around a cell. A column that is there twice, or in two
/// units, is refused. All CSV files: at most 256 MiB, 1,000 columns, a million rows.
///
/// Rows are taken to be in the order of measuring, each approached from the row before; where a column `segment` (a
/// number) changes, or the time goes back, the approach is unknown. Columns from_q1_rad .. from_qN_rad state the joint
/// values from which each pose was approached; `segment` is ignored then. A column `time_s` or `time_ms` states the
/// time of measuring [s], Unix time or any other; else that is the row's number, from 0. A column `temperature_c`
/// states the temperature of the arm. A column `payload_kg` states what it carries; payload_x_mm, payload_y_mm and
/// payload_z_mm its centre in the frame of the flange, else that is the tool point. Columns sx_mm, sy_mm, sz_mm (or _m,
/// _um) and, for orientations, srx_rad, sry_rad, srz_rad (or _mrad, _deg) are standard deviations of each row; or the
/// 21 entries cov_11 .. cov_66 (row not above column) are its covariance in mm and rad: of (x, y, z, rotation vector)
/// in the sensor's frame, shifts added and rotations multiplied from the left. Where `format.controller` says so,
/// columns q1 .. qM are the joints of the controller; the rows that are returned have those of the chain.
/// @param path        the file
/// @param joint_types where given, the columns of revolute joints must be angles and those of prismatic ones lengths
/// @param format      how the file is written
/// @throws DataError naming file, line and column; for several reflectors, see `read_reflectors`
template <int N>
Dataset<N> read_dataset(const std::string& path, std::span<const JointType> joint_types = {},
                        const CsvFormat& format = {}) {
  const detail::PoseColumns columns = detail::read_pose_columns(path, N, joint_types, format);
  detail::require_one_point(columns, path);
  return detail::dataset_of<N>(columns);
}

/// Measured distances from a CSV file: columns q1 .. qN as in `read_dataset`, and distance_mm (or _m, _um).
/// @throws DataError naming file, line and column
template <int N>
Distances<N> read_distances(const std::string& path, std::span<const JointType> joint_types = {},
                            const CsvFormat& format = {}) {
  const auto [values, origin] = detail::read_distance_columns(path, N, joint_types, format);
  return Distances<N>(values.leftCols<N>(), values.col(N)).from(origin);
}

/// Joint rows from a CSV file: the q columns of `read_dataset`.
/// @throws DataError naming file, line and column
template <int N>
JointRows<N> read_joints(const std::string& path, std::span<const JointType> joint_types = {},
                         const CsvFormat& format = {}) {
  return detail::read_joint_columns(path, N, joint_types, format);
}

/// Configurations to visit, and what the arm carries there.
template <int N>
struct PlannedVisits : detail::VisitColumns {
  JointRows<N> joints{};  ///< n x N [rad, m]
};

/// Joint rows from a CSV file as `read_joints` has them, with the columns payload_kg, payload_x_mm, payload_y_mm and
/// payload_z_mm of `read_dataset`, and the column board of plans for a camera.
/// @throws DataError naming file, line and column
template <int N>
PlannedVisits<N> read_visits(const std::string& path, std::span<const JointType> joint_types = {},
                             const CsvFormat& format = {}) {
  PlannedVisits<N> out;
  out.joints = detail::read_joint_columns(path, N, joint_types, format, &out);
  return out;
}

/// Targets of a path, as a file states them.
template <int N>
struct TargetRows {
  JointRows<N> joints{};       ///< of each target [rad, m]; no rows where the file has none
  PointRows positions{};       ///< likewise [m]
  PointRows orientations{};    ///< likewise, rotation vectors [rad]
  std::vector<bool> linear{};  ///< whether the move to each is a linear one; empty where the file does not say

  /// Number of targets.
  Index size() const { return (std::max)(joints.rows(), positions.rows()); }
};

/// Targets from a CSV file: columns q1_rad .. or poses x_mm, y_mm, z_mm, rx_rad, ry_rad, rz_rad, or both, in the units
/// of `read_dataset`; an optional column `move` says how the arm moves there: j joint by joint, l along a line.
/// @throws DataError naming file, line and column
template <int N>
TargetRows<N> read_targets(const std::string& path, std::span<const JointType> joint_types = {},
                           const CsvFormat& format = {}) {
  auto [joints, poses, linear] = detail::read_target_columns(path, N, joint_types, format);
  TargetRows<N> out;
  if (joints.rows() > 0) out.joints = joints;
  if (poses.rows() > 0) out.positions = poses.leftCols<3>();
  if (poses.cols() > 3) out.orientations = poses.rightCols<3>();
  out.linear = std::move(linear);
  return out;
}

/// A file of comma-separated values as text, e.g. to add columns to it.
struct CsvText {
  std::string file{};                            ///< its name
  std::vector<std::string> header{};             ///< names of the columns
  std::vector<std::vector<std::string>> rows{};  ///< cells, as many in each row as the header has
  std::vector<Index> lines{};                    ///< number of the line of each row, from 1
};

/// Header and cells of a CSV file, blank lines left out, without quotation marks; numbers of columns
/// with a unit have a decimal point.
/// @throws DataError naming file and line
VERNIER_API CsvText read_csv_text(const std::string& path, const CsvFormat& format = {});

/// Poses that a file labels by whole numbers, e.g. repeated visits.
struct LabelledPoses {
  Eigen::MatrixXi labels{};        ///< n x labels
  VectorX times{};                 ///< of measuring [s]; NaN where unknown
  std::vector<Isometry3> poses{};  ///< n
  bool oriented = false;           ///< whether the file has orientations; else they are the identity
};

/// Poses from a CSV file: columns x_mm, y_mm, z_mm, optionally rx_rad, ry_rad, rz_rad, in the units of `read_dataset`,
/// whole numbers in the columns `labels` and `optional` (0 where there is no such column), optionally time_s or
/// time_ms.
/// @throws DataError naming file, line and column
VERNIER_API LabelledPoses read_labelled_poses(const std::string& path, std::initializer_list<const char*> labels,
                                              std::initializer_list<const char*> optional = {},
                                              const CsvFormat& format = {});

/// Contacts from a CSV file, a row a touch: columns q1 .. qN as in `read_dataset`; `contact_id`, which of the objects
/// is touched (any text); `kind`, plane, ball or socket; of balls radius_mm (of the ball and the probe's tip together);
/// optionally offset_mm, for planes and sockets: the height of a face above the first one of the same contact, or the
/// distance of a socket from the first one along a bar. A cell of a length may be empty where it does not apply.
/// @param path        the file
/// @param joints      number of joints
/// @param joint_types as in `read_dataset`
/// @param format      how the file is written
/// @return            in the order of their first touches
/// @throws DataError naming file, and line and column or the contact
VERNIER_API std::vector<Contact> read_contacts(const std::string& path, int joints,
                                               std::span<const JointType> joint_types = {},
                                               const CsvFormat& format = {});

/// Writes measured poses as `read_dataset` reads them, joints in rad or m, positions in mm, in digits that read back
/// exactly (positions to the last bit or two, for the change of unit). Columns from_q1_rad .. and time_s are written
/// where they do not follow from the order of the rows; a row whose approach is unknown is then written as one that did
/// not move. Atomic: the file is whole, or as it was before.
/// @param path        the file
/// @param data        the poses
/// @param joint_types of the arm's chain: columns of prismatic joints are q1_m ..; none: all joints are revolute
/// @param controller  whose joint values are written
/// @throws std::runtime_error when the file cannot be written
template <int N>
void write_dataset(const std::string& path, const Dataset<N>& data, std::span<const JointType> joint_types = {},
                   const ControllerMap& controller = {}) {
  write_file(path,
             detail::pose_text(data.joints(), data.positions(), data.orientations(), data.previous(), data.times(),
                               data.temperatures(), data.payloads(), joint_types, controller, data.covariances()));
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/csv.ipp"
#endif
