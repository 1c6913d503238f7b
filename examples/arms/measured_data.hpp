// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measurements of an arm whose number of joints is known at run time.

#include <string>
#include <vector>

#include "data_instances.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/controller_map.hpp"
#include "vernier/data/contacts.hpp"
#include "vernier/data/csv_format.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/reflectors.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// Poses that were measured from one station; joint values are those of the controller.
struct MeasuredPoses {
  vernier::MatrixX joints{};                                   ///< n x joints [rad, m]
  vernier::PointRows positions = vernier::PointRows(0, 3);     ///< n x 3 [m]
  vernier::PointRows orientations = vernier::PointRows(0, 3);  ///< rotation vectors, n x 3 [rad]; none: not measured
  vernier::MatrixX previous{};                  ///< from which each was approached, NaN: unknown; none: the row before
  vernier::VectorX times{};                     ///< [s]; none: in the order of the rows
  vernier::VectorX temperatures{};              ///< [deg C]; none: not measured
  vernier::MatrixX payloads{};                  ///< n x 4, see `Dataset::payloads`; none: unknown
  std::vector<vernier::Matrix6> covariances{};  ///< of position and rotation vector; none: those of the sensor
  vernier::RowOrigin origin{};                  ///< lines in files; empty where they are from none
  std::string name{};                           ///< in messages
  std::vector<std::string> points{};            ///< reflector of each row; none: all rows are of one

  /// Number of poses.
  vernier::Index size() const { return joints.rows(); }
};

/// Distances from one fixed point.
struct MeasuredDistances {
  vernier::MatrixX joints{};    ///< n x joints of the controller [rad, m]
  vernier::VectorX lengths{};   ///< n [m]
  vernier::RowOrigin origin{};  ///< lines in files; empty where they are from none
  std::string name{};           ///< in messages
};

/// Everything that was measured.
struct MeasuredData {
  std::vector<MeasuredPoses> stations{};       ///< poses, a set a station
  std::vector<MeasuredDistances> distances{};  ///< a set a fixed point
  std::vector<vernier::Contact> contacts{};    ///< touches, in joints of the chain
};

/// Poses as the library has them: joints are those of the chain.
/// @throws std::invalid_argument on shapes that do not fit together or values that are not finite, naming the row
template <int N>
vernier::Dataset<N> dataset_of(const MeasuredPoses& from, const vernier::ControllerMap& controller) {
  const auto chain = [&](const vernier::MatrixX& joints) -> vernier::MatrixX {
    return controller.same() ? joints : controller.to_chain(joints);
  };
  vernier::Dataset<N> out(chain(from.joints), from.positions, from.orientations);
  if (from.previous.rows() > 0) out = out.approached_from(chain(from.previous));
  if (from.times.size() > 0) out = out.measured_at(from.times);
  if (from.temperatures.size() > 0) out = out.at_temperatures(from.temperatures);
  if (from.payloads.rows() > 0) out = out.carrying(from.payloads);
  if (!from.covariances.empty()) out = out.with_covariances(from.covariances);
  return from.origin.empty() ? out : out.from(from.origin);
}

/// The poses of each reflector, as the library has them; one without a name where there are no names.
/// @param same within which joint values of the chain rows are one pose
/// @throws std::invalid_argument as above, and as `split_reflectors`
template <int N>
std::vector<vernier::ReflectorPoses<N>> reflectors_of(const MeasuredPoses& from,
                                                      const vernier::ControllerMap& controller,
                                                      const vernier::SamePose& same = {}) {
  return vernier::split_reflectors(dataset_of<N>(from, controller), from.points, same);
}

/// Checks shapes and values, as data of the arm are checked when they are used.
/// @throws std::invalid_argument on shapes that do not fit together or values that are not finite, naming the row
void validate(const MeasuredPoses& poses);
/// The named rows, in the given order; each keeps the joint values from which it was approached.
/// @throws std::invalid_argument on a row that is not there
MeasuredPoses rows_of(const MeasuredPoses& poses, const std::vector<vernier::Index>& rows);

/// Measured poses of a file, columns as `read_reflectors` has them.
/// @throws vernier::DataError naming file, line and column
MeasuredPoses read_measured_poses(const std::string& path, const vernier::RobotDescription& robot,
                                  const vernier::CsvFormat& format = {});
/// Measured distances of a file.
/// @throws vernier::DataError naming file, line and column
MeasuredDistances read_measured_distances(const std::string& path, const vernier::RobotDescription& robot,
                                          const vernier::CsvFormat& format = {});
/// Touches of a file.
/// @throws vernier::DataError naming file, line and column
std::vector<vernier::Contact> read_measured_contacts(const std::string& path, const vernier::RobotDescription& robot,
                                                     const vernier::CsvFormat& format = {});
/// Writes poses as the programs read them; those of reflectors in the order of their times.
/// @throws std::runtime_error where the file cannot be written
void write_measured_poses(const std::string& path, const MeasuredPoses& poses, const vernier::RobotDescription& robot);

}  // namespace support
