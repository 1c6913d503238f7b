// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Several reflectors on one flange: poses of an arm as the positions of named points, each at an unknown place.

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/same_pose.hpp"

namespace vernier {

/// What was measured of one reflector.
template <int N>
struct ReflectorPoses {
  std::string point{};  ///< its name; empty for the only one
  Dataset<N> poses{};   ///< its positions
};

namespace detail {

/// Which rows each reflector has, in the order of their first rows.
struct ReflectorRows {
  std::vector<std::string> names{};
  std::vector<std::vector<Index>> rows{};
};
/// @throws std::invalid_argument for an empty name, or of several reflectors one at fewer than three poses
inline ReflectorRows rows_of_reflectors(const std::vector<std::string>& points, const std::vector<Index>& poses) {
  ReflectorRows out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    demand(!points[i].empty(), "reflectors: row ", i, " has no name of a reflector");
    const auto at =
        static_cast<std::size_t>(std::find(out.names.begin(), out.names.end(), points[i]) - out.names.begin());
    if (at == out.names.size()) {
      out.names.push_back(points[i]);
      out.rows.emplace_back();
    }
    out.rows[at].push_back(static_cast<Index>(i));
  }
  if (out.names.size() < 2) return out;
  for (std::size_t k = 0; k < out.names.size(); ++k) {
    std::set<Index> seen;
    for (const Index row : out.rows[k]) seen.insert(poses[static_cast<std::size_t>(row)]);
    demand(seen.size() >= 3, "reflectors: '", out.names[k], "' is measured at ", seen.size(),
           seen.size() == 1 ? " pose" : " poses", ", it needs three or more");
  }
  return out;
}
/// Joint values from which rows were approached: those measured one after another at one pose from the same ones.
inline MatrixX shared_approach(const ConstMatrixRef& joints, const ConstMatrixRef& previous,
                               const std::vector<std::string>& points, const std::vector<Index>& poses) {
  MatrixX out = previous;
  for (Index i = 1; i < joints.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    bool same = points[row] != points[row - 1] && poses[row] == poses[row - 1];
    for (Index j = 0; j < joints.cols() && same; ++j)
      same = !std::isfinite(out(i, j)) || same_value(out(i, j), joints(i - 1, j));
    for (Index j = 0; j < joints.cols() && same; ++j) out(i, j) = out(i - 1, j);
  }
  return out;
}

}  // namespace detail

/// Samples of which reflectors that were measured one after another at one pose were approached from the same one.
/// @param all    positions of all reflectors, in the order of measuring
/// @param points name of the reflector of each row
/// @param same   within which joint values rows are one pose
/// @throws std::invalid_argument for another number of names
template <int N>
Dataset<N> approached_together(const Dataset<N>& all, const std::vector<std::string>& points,
                               const SamePose& same = {}) {
  demand(static_cast<Index>(points.size()) == all.size(), "reflectors: ", points.size(), " names of ", all.size(),
         " rows");
  return all.approached_from(
      detail::shared_approach(all.joints(), all.previous(), points, pose_numbers(all.joints(), same)));
}

/// Samples of several reflectors as a set each, in the order of their first rows; see `approached_together`.
/// @param all    as above
/// @param points as above; none: one reflector without a name
/// @param same   as above
/// @throws std::invalid_argument for another number of names, an empty one, a reflector at fewer than three poses, and
///         several reflectors with orientations
template <int N>
std::vector<ReflectorPoses<N>> split_reflectors(const Dataset<N>& all, const std::vector<std::string>& points,
                                                const SamePose& same = {}) {
  if (points.empty()) return {{{}, all}};
  const Dataset<N> together = approached_together(all, points, same);
  const detail::ReflectorRows found = detail::rows_of_reflectors(points, pose_numbers(all.joints(), same));
  demand(found.names.size() == 1 || !all.has_orientations(), "reflectors: several have no orientations");
  std::vector<ReflectorPoses<N>> out;
  for (std::size_t k = 0; k < found.names.size(); ++k) out.push_back({found.names[k], together.rows(found.rows[k])});
  return out;
}

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
  return split_reflectors(detail::dataset_of<N>(columns), columns.points, {.joint_types = joint_types});
}

/// Writes positions of several reflectors as `read_reflectors` reads them, in the order of their times.
/// @param path        the file
/// @param reflectors  one at least; names without commas, quotation marks and ends of lines
/// @param joint_types of the arm's chain: columns of prismatic joints are q1_m ..; none: all joints are revolute
/// @param controller  whose joint values are written
/// @throws std::invalid_argument for a name that cannot be written, or where temperatures, payloads or covariances of
///         some reflectors alone are known
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
  const auto all_know = [&](const char* what, const auto& knows) {
    const auto count =
        std::count_if(reflectors.begin(), reflectors.end(), [&](const auto& one) { return knows(one.poses); });
    demand(count == 0 || count == static_cast<std::ptrdiff_t>(reflectors.size()), "write_reflectors: the ", what,
           " of ", count, " reflectors of ", reflectors.size(), " are known");
    return count > 0;
  };
  const bool warm = all_know("temperatures", [](const auto& poses) { return poses.temperatures().size() > 0; });
  const bool loaded = all_know("payloads", [](const auto& poses) { return poses.payloads().rows() > 0; });
  const bool weighed = all_know("covariances", [](const auto& poses) { return !poses.covariances().empty(); });
  JointRows<N> joints(n, N), previous(n, N);
  PointRows positions(n, 3);
  VectorX times(n), temperatures(warm ? n : 0);
  MatrixX payloads(loaded ? n : 0, 4);
  std::vector<Matrix6> covariances;
  std::vector<std::string> points;
  for (Index i = 0; i < n; ++i) {
    const auto& [of, row] = rows[static_cast<std::size_t>(i)];
    const Dataset<N>& poses = reflectors[of].poses;
    joints.row(i) = poses.joints().row(row);
    previous.row(i) = poses.previous().row(row);
    positions.row(i) = poses.positions().row(row);
    times(i) = poses.times()(row);
    if (warm) temperatures(i) = poses.temperatures()(row);
    if (loaded) payloads.row(i) = poses.payloads().row(row);
    if (weighed) covariances.push_back(poses.covariances()[static_cast<std::size_t>(row)]);
    points.push_back(reflectors[of].point);
  }
  write_file(path, detail::pose_text(joints, positions, PointRows(0, 3), previous, times, temperatures, payloads,
                                     joint_types, controller, covariances, points));
}

}  // namespace vernier
