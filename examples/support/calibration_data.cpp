// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "data_instances.hpp"
#include "dispatch.hpp"
#include "held_out.hpp"
#include "held_out_rows.hpp"
#include "report_page.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/calibration/controller_search.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/reflectors.hpp"
#include "vernier/data/same_pose.hpp"
#include "vernier/data/split.hpp"

namespace support {

namespace vn = vernier;

namespace {

/// Rows of a file to learn from and to hold out.
/// @param name for messages
/// @param rule becomes the choice in words
template <int N>
vn::Split<N> hold_out(const vn::Dataset<N>& data, const CalibrationOptions& o, const vn::SamePose& same,
                      std::uint64_t seed, const std::string& name, std::string& rule) {
  vn::detail::SplitRows rows;
  if (o.split.starts_with("region")) {
    using vn::Face;
    const bool far = seed % 2 == 1, along_x = o.split == "region-x";
    const Face face = along_x ? (far ? Face::x_high : Face::x_low) : (far ? Face::z_high : Face::z_low);
    rule = fmt::format("{:.3g} % of the rows, {} {}", o.test_fraction * 100, far ? "largest" : "smallest",
                       along_x ? 'x' : 'z');
    rows = vn::detail::region_rows(data.positions(), {.test_fraction = o.test_fraction, .face = face});
  } else {
    rows = held_out_rows(data.size(), o, seed, name, "row", rule);
  }
  rows = whole_poses(rows, data.joints(), same, rule);
  return {data.rows(rows.train), data.rows(rows.test)};
}

/// The poses of one reflector in a file.
/// @param file for the message
template <int N>
vn::Dataset<N> poses_of(const std::vector<vn::ReflectorPoses<N>>& reflectors, const std::string& point,
                        const std::string& file) {
  for (const vn::ReflectorPoses<N>& one : reflectors)
    if (one.point == point) return one.poses;
  throw vn::CalibrationFailure(file + (point.empty()
                                           ? ": its rows are of named reflectors, those of the other file are not"
                                           : ": has no rows of the reflector " + point));
}

/// Training and held-out poses of a set.
/// @param name of the set, for messages
/// @param test its held-out poses, if a file has them
template <int N>
vn::Split<N> split_station(const vn::Dataset<N>& file, const CalibrationOptions& o, const std::string& name,
                           const std::optional<vn::Dataset<N>>& test, std::span<const vn::JointType> types,
                           std::uint64_t seed, std::string& rule) {
  vn::Split<N> out{o.no_approach ? file.without_approach() : file, {}};
  if (test) {
    out.test = o.no_approach ? test->without_approach() : *test;
  } else {
    if (out.train.size() < 2)
      throw vn::CalibrationFailure(name + ": a single row; a calibration needs many poses, and held-out ones");
    try {
      out = hold_out(vn::Dataset<N>(out.train), o, {.joint_types = types}, seed, name, rule);
    } catch (const std::invalid_argument& error) {
      throw vn::CalibrationFailure(name + ": " + error.what());
    }
  }
  if (o.train_rows > 0) out.train = out.train.rows(training_rows(out.train.size(), o, seed, name, "rows"));
  return out;
}

/// Names of sets of poses, where each was measured from, and which reflector.
struct SetNames {
  std::vector<std::string> names, places, points;
};

/// Adds training and held-out poses, no pose among both.
template <int N>
void add_split(MeasuredFiles<N>& out, std::vector<vn::Split<N>>& stations, const SetNames& sets,
               const CalibrationOptions& o, const vn::SamePose& same) {
  const std::string advice = o.test.empty() ? "" : "; --test needs poses that --data has not";
  if (const vn::Index apart = keep_poses_apart(stations, sets.names, advice, same); apart > 0)
    out.held_out += fmt::format("; {} training row{} at held-out poses {} left out", apart, apart == 1 ? "" : "s",
                                apart == 1 ? "is" : "are");
  for (std::size_t s = 0; s < stations.size(); ++s) {
    out.fitted_rows.add({stations[s].train.joints(), stations[s].train.positions()});
    out.train.add(vn::readings_joined(stations[s].train, same), sets.names[s], sets.places[s], sets.points[s]);
    out.test.add(std::move(stations[s].test), sets.names[s], sets.places[s], sets.points[s]);
  }
}

}  // namespace

std::string controller_key(const vn::ControllerMap& map, std::span<const vn::JointType> types) {
  std::string formulas;
  for (const std::string& formula : map.formulas(types)) formulas += (formulas.empty() ? "\"" : ", \"") + formula + '"';
  return fmt::format("\"controller\": {{\"chain\": [{}]}}", formulas);
}

template <int N>
std::string passive_joint_advice(const vn::DescribedRobot<N>& robot, const CalibrationOptions& o) {
  if constexpr (N > 1) {
    if (!robot.controller.same()) return {};
    std::optional<vn::FoundController> found;
    try {
      const vn::CsvText text = vn::read_csv_text(o.data.front(), o.csv.format());
      for (const std::string& name : text.header)
        if (name.starts_with(fmt::format("q{}_", N))) return {};  // all joints are there
      const vn::Dataset<N - 1> data = vn::read_dataset<N - 1>(o.data.front(), {}, o.csv.format());
      if (data.size() < 10) return {};
      found = vn::find_passive_joint(vn::ArmGeometry(robot.arm), data.joints(), data.positions(), data.orientations());
    } catch (const vn::DataError&) {
      return {};  // another fault, which has been said
    }
    if (!found) return {};
    return fmt::format(
        "; its {} joints are plausible (median {:.3g} mm) with a passive joint: add {} to the robot file", N - 1,
        found->median * 1e3, controller_key(found->map, robot.arm.chain().joint_types()));
  }
  return {};
}

template <int N>
vn::Dataset<N> read_poses(const std::string& file, const CalibrationOptions& o, std::span<const vn::JointType> types) {
  const vn::Dataset<N> data = vn::read_dataset<N>(file, types, o.csv.format());
  o.sensor.remark(file, !data.covariances().empty());
  return o.no_approach ? data.without_approach() : data;
}

template <int N>
MeasuredFiles<N> read_measurements(const CalibrationOptions& o, std::span<const vn::JointType> types,
                                   std::uint64_t seed) {
  MeasuredFiles<N> out;
  const vn::SamePose same{.joint_types = types};
  std::vector<vn::Split<N>> stations;
  std::vector<std::string> places, points;
  for (std::size_t f = 0; f < o.data.size(); ++f) {
    const auto reflectors = vn::read_reflectors<N>(o.data[f], types, o.csv.format());
    std::vector<vn::ReflectorPoses<N>> tests;
    if (!o.test.empty()) {
      tests = vn::read_reflectors<N>(o.test[f], types, o.csv.format());
      out.held_out += (f == 0 ? "the rows of " : ", ") + o.test[f];
    }
    for (const vn::ReflectorPoses<N>& one : tests) (void)poses_of(reflectors, one.point, o.data[f]);
    o.sensor.remark(o.data[f], !reflectors.front().poses.covariances().empty());
    out.inputs.push_back(file_of(reflectors.front().poses.origin()));
    for (std::size_t k = 1; k < reflectors.size(); ++k) out.inputs.back().rows += reflectors[k].poses.size();
    if (!tests.empty()) out.inputs.push_back(file_of(tests.front().poses.origin()));
    for (std::size_t k = 1; k < tests.size(); ++k) out.inputs.back().rows += tests[k].poses.size();
    for (const vn::ReflectorPoses<N>& one : reflectors) {
      const bool several = reflectors.size() > 1;
      out.names.push_back(several ? fmt::format("{}, point {}", o.data[f], one.point) : o.data[f]);
      places.push_back(o.data[f]);
      points.push_back(one.point);
      std::optional<vn::Dataset<N>> test;
      if (!tests.empty()) test = poses_of(tests, one.point, o.test[f]);
      out.files.push_back(one.poses);
      stations.push_back(split_station(one.poses, o, out.names.back(), test, types, seed, out.held_out));
    }
  }
  add_split(out, stations, {out.names, places, points}, o, same);
  for (const std::string& file : o.distances) {
    const vn::Distances<N> distances = vn::read_distances<N>(file, types, o.csv.format());
    out.inputs.push_back(file_of(distances.origin()));
    out.train.add(distances, file);
  }
  if (o.contacts.empty()) return out;
  const std::vector<vn::Contact> contacts = vn::read_contacts(o.contacts, N, types, o.csv.format());
  for (const vn::Contact& contact : contacts) out.train.add(contact);
  out.inputs.push_back(file_of(contacts.front().origin()));
  out.inputs.back().rows = 0;  // of several objects
  return out;
}

template <int N>
MeasuredFiles<N> hold_out_poses(const vn::Measurements<N>& poses, const CalibrationOptions& o,
                                std::span<const vn::JointType> types, std::uint64_t seed) {
  MeasuredFiles<N> out;
  const vn::SamePose same{.joint_types = types};
  std::vector<vn::Split<N>> stations;
  for (std::size_t s = 0; s < poses.poses().size(); ++s) {
    out.names.push_back(poses.sets()[s].name);
    out.files.push_back(poses.poses()[s]);
    stations.push_back(split_station(poses.poses()[s], o, out.names.back(), std::optional<vn::Dataset<N>>{}, types,
                                     seed, out.held_out));
  }
  out.inputs.push_back(file_of(out.files.front().origin()));
  for (std::size_t s = 1; s < out.files.size(); ++s) out.inputs.back().rows += out.files[s].size();
  const std::vector<std::string> none(out.names.size());
  add_split(out, stations, {out.names, none, none}, o, same);
  return out;
}

template <int N>
std::vector<vn::DataAudit> audit_files(const vn::DescribedRobot<N>& robot, const MeasuredFiles<N>& measured) {
  constexpr vn::Index fewest = 10;
  std::vector<vn::DataAudit> out;
  for (std::size_t s = 0; s < measured.files.size(); ++s) {
    out.push_back(measured.files[s].size() < fewest ? vn::DataAudit{} : vn::audit_data(robot.arm, measured.files[s]));
    if (!out.back().findings.empty()) fmt::print("{}: {}\n", measured.names[s], out.back().summary());
    if (const auto map = vn::audited_controller(out.back(), robot.controller, N))
      fmt::print(
          "In place of other columns, add the joints of the controller to the robot file, or give their formulas to "
          "--controller-joints:\n  {}\n\n",
          controller_key(*map, robot.arm.chain().joint_types()));
  }
  return out;
}

#define VERNIER_INSTANTIATE(N)                                                                              \
  template vn::Dataset<N> read_poses<N>(const std::string&, const CalibrationOptions&,                      \
                                        std::span<const vn::JointType>);                                    \
  template MeasuredFiles<N> read_measurements<N>(const CalibrationOptions&, std::span<const vn::JointType>, \
                                                 std::uint64_t);                                            \
  template MeasuredFiles<N> hold_out_poses<N>(const vn::Measurements<N>&, const CalibrationOptions&,        \
                                              std::span<const vn::JointType>, std::uint64_t);               \
  template std::string passive_joint_advice<N>(const vn::DescribedRobot<N>&, const CalibrationOptions&);    \
  template std::vector<vn::DataAudit> audit_files<N>(const vn::DescribedRobot<N>&, const MeasuredFiles<N>&);
VERNIER_FOR_ALL_DOF(VERNIER_INSTANTIATE)
#undef VERNIER_INSTANTIATE

}  // namespace support
