// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Several reflectors on one flange: poses of an arm as the positions of named points, each at an unknown place.

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vernier/data/csv.hpp"

namespace vernier {

/// What was measured of one reflector.
template <int N>
struct ReflectorPoses {
  std::string point{};  ///< its name; empty for the only one
  Dataset<N> poses{};   ///< its positions
};

/// Positions of one reflector or several from a CSV file: the columns of `read_dataset`, and `point`, a name or a
/// number of the reflector of the row. Or all reflectors in one line, as the columns x1_mm, y1_mm, z1_mm, x2_mm ..
/// zK_mm, of which three empty cells are a reflector that was not seen. Reflectors that are measured one after another
/// at one configuration were approached from the same one. A column `point` whose names stand at one pose each
/// (`SamePose`) names poses, and is not read.
/// @param path        the file
/// @param joint_types as in `read_dataset`
/// @param format      how the file is written
/// @return            in the order of their first rows; one without a name where the file names none
/// @throws DataError naming file, line and column; for a reflector at fewer than three configurations, and for several
///         reflectors with orientations
template <int N>
std::vector<ReflectorPoses<N>> read_reflectors(const std::string& path, std::span<const JointType> joint_types = {},
                                               const CsvFormat& format = {}) {
  const detail::PoseColumns columns = detail::read_pose_columns(path, N, joint_types, format);
  const Dataset<N> all = detail::dataset_of<N>(columns);
  if (columns.points.empty()) return {{{}, all}};
  std::vector<std::string> names;
  std::vector<std::vector<Index>> rows;
  for (std::size_t i = 0; i < columns.points.size(); ++i) {
    const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), columns.points[i]) - names.begin());
    if (at == names.size()) {
      names.push_back(columns.points[i]);
      rows.emplace_back();
    }
    rows[at].push_back(static_cast<Index>(i));
  }
  std::vector<ReflectorPoses<N>> out;
  for (std::size_t k = 0; k < names.size(); ++k) out.push_back({names[k], all.rows(rows[k])});
  return out;
}

/// Writes positions of several reflectors as `read_reflectors` reads them, in the order of their times.
/// @param path        the file
/// @param reflectors  one at least; names without commas, quotation marks and ends of lines
/// @param joint_types of the arm's chain: columns of prismatic joints are q1_m ..; none: all joints are revolute
/// @param controller  whose joint values are written
/// @throws std::invalid_argument for a name that cannot be written
/// @throws std::runtime_error when the file cannot be written
template <int N>
void write_reflectors(const std::string& path, const std::vector<ReflectorPoses<N>>& reflectors,
                      std::span<const JointType> joint_types = {}, const ControllerMap& controller = {}) {
  std::vector<std::pair<std::size_t, Index>> rows;
  for (std::size_t k = 0; k < reflectors.size(); ++k) {
    demand(reflectors[k].point.find_first_of(",\"\r\n") == std::string::npos && !reflectors[k].point.empty(),
           "write_reflectors: the name '", reflectors[k].point, "' cannot be written");
    for (Index i = 0; i < reflectors[k].poses.size(); ++i) rows.emplace_back(k, i);
  }
  const auto time = [&](const auto& row) { return reflectors[row.first].poses.times()(row.second); };
  std::stable_sort(rows.begin(), rows.end(), [&](const auto& a, const auto& b) { return time(a) < time(b); });
  const auto n = static_cast<Index>(rows.size());
  JointRows<N> joints(n, N), previous(n, N);
  PointRows positions(n, 3);
  VectorX times(n);
  std::vector<std::string> points;
  bool loaded = n > 0;  // rows of all of them
  for (const ReflectorPoses<N>& one : reflectors) loaded = loaded && one.poses.payloads().rows() == one.poses.size();
  MatrixX payloads(loaded ? n : 0, 4);
  for (Index i = 0; i < n; ++i) {
    const auto& [of, row] = rows[static_cast<std::size_t>(i)];
    const Dataset<N>& poses = reflectors[of].poses;
    joints.row(i) = poses.joints().row(row);
    previous.row(i) = poses.previous().row(row);
    positions.row(i) = poses.positions().row(row);
    times(i) = poses.times()(row);
    if (loaded) payloads.row(i) = poses.payloads().row(row);
    points.push_back(reflectors[of].point);
  }
  write_file(path, detail::pose_text(joints, positions, PointRows(0, 3), previous, times, VectorX(), payloads,
                                     joint_types, controller, {}, points));
}

}  // namespace vernier
