// SPDX-License-Identifier: BSD-3-Clause
// `calibrate` for arms of VERNIER_JOINTS joints.

#include <algorithm>
#include <string>
#include <utility>

#include "calibration_instances.hpp"
#include "calibration_task.hpp"
#include "data_instances.hpp"
#include "held_out.hpp"
#include "known_parts.hpp"
#include "model_instances.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/io/identified_robot.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

namespace {

namespace vn = vernier;
constexpr int N = VERNIER_JOINTS;

/// Training and held-out poses of all reflectors at all stations, and how they were chosen.
struct Stations {
  std::vector<vn::Split<N>> splits{};
  std::vector<std::string> names{};
  std::vector<std::size_t> station{};
  std::vector<std::string> points{};
  std::string rule{};

  /// Whether there are several reflectors.
  bool own_tools() const { return std::count(points.begin(), points.end(), points.front()) < std::ssize(points); }
};

/// The held-out poses of a reflector.
/// @param name of the set, for the message
const vn::Dataset<N>& of_point(const std::vector<vn::ReflectorPoses<N>>& tests, const std::string& point,
                               const std::string& name) {
  for (const vn::ReflectorPoses<N>& one : tests)
    if (one.point == point) return one.poses;
  throw vn::CalibrationFailure(name + ": there are no held-out poses of it");
}

/// Poses of one set, some held out.
vn::Split<N> split_set(const vn::Dataset<N>& all, const CalibrationTask& task, const vn::SamePose& same,
                       std::uint64_t seed, const std::string& name, std::string& rule) {
  if (all.size() < 2)
    throw vn::CalibrationFailure(name + ": a single row; a calibration needs many poses, and held-out ones");
  try {
    if (task.test_fraction > 0) {
      rule = vn::message(task.test_fraction * 100, " % of the rows, at random, seed ", seed);
      return vn::split(all, {.test_fraction = task.test_fraction, .seed = seed}, same);
    }
    rule = vn::message("every row i with i % ", task.test_every, " = 0, counted from 0");
    return vn::split_every(all, task.test_every, same);
  } catch (const std::invalid_argument& error) {
    throw vn::CalibrationFailure(name + ": " + error.what());
  }
}

Stations split_stations(const CalibrationTask& task, std::span<const vn::JointType> types, std::uint64_t seed) {
  const vn::SamePose same{.joint_types = types};
  const vn::ControllerMap& controller = task.robot.controller;
  Stations out;
  if (task.test)
    vn::demand(task.test->stations.size() == task.train.stations.size(), "calibrate: held-out poses of ",
               task.test->stations.size(), " stations, the others are of ", task.train.stations.size());
  for (std::size_t s = 0; s < task.train.stations.size(); ++s) {
    const MeasuredPoses& poses = task.train.stations[s];
    const std::string station = poses.name.empty() ? vn::message("station ", s + 1) : poses.name;
    const auto reflectors = reflectors_of<N>(poses, controller, same);
    std::vector<vn::ReflectorPoses<N>> tests;
    if (task.test) {
      tests = reflectors_of<N>(task.test->stations[s], controller, same);
      for (const vn::ReflectorPoses<N>& one : tests)
        if (std::none_of(reflectors.begin(), reflectors.end(), [&](const auto& of) { return of.point == one.point; }))
          throw vn::CalibrationFailure(station + ": held-out poses are of the reflector '" + one.point +
                                       "', the others are not");
      out.rule = "the poses given as held out";
    }
    for (const vn::ReflectorPoses<N>& one : reflectors) {
      out.names.push_back(reflectors.size() > 1 ? station + ", point " + one.point : station);
      out.station.push_back(s);
      out.points.push_back(one.point);
      if (task.test)
        out.splits.push_back({one.poses, of_point(tests, one.point, out.names.back())});
      else
        out.splits.push_back(split_set(one.poses, task, same, seed, out.names.back(), out.rule));
    }
  }
  const vn::Index apart = keep_poses_apart(out.splits, out.names, "", same);
  if (apart > 0) out.rule += vn::message("; ", apart, " training rows at held-out poses are left out");
  return out;
}

/// Held-out poses of a page, where the nominal arm is at their joints.
void add_held_out(vn::ReportInput& page, const vn::Framed<vn::DhChain<N>>& nominal, const vn::Measurements<N>& test) {
  vn::Index rows = 0;
  for (const auto& poses : test.poses()) rows += poses.size();
  page.poses.positions.resize(rows, 3);
  page.poses.joints.resize(rows, N);
  page.times.resize(rows);
  rows = 0;
  for (std::size_t s = 0; s < test.poses().size(); ++s) {
    const vn::Dataset<N>& poses = test.poses()[s];
    page.poses.files.push_back(test.sets()[s].name);
    for (vn::Index i = 0; i < poses.size(); ++i, ++rows) {
      page.poses.file.push_back(static_cast<int>(s));
      page.poses.line.push_back(poses.origin().empty() ? i : poses.origin().line[static_cast<std::size_t>(i)]);
      page.poses.positions.row(rows) = nominal.position(poses.joints(i)).transpose();
      page.poses.joints.row(rows) = poses.joints().row(i);
      page.times(rows) = poses.times()(i);
    }
  }
}

}  // namespace

template <>
CalibrationOutcome calibrate_of<N>(const CalibrationTask& task, const vn::FitOptions& fit) {
  const vn::DescribedRobot<N> robot = task.robot.arm<N>();
  const auto types = robot.arm.chain().joint_types();
  const vn::SamePose same{.joint_types = types};
  if (task.train.stations.empty()) throw vn::CalibrationFailure("calibrate: no measured poses");
  vn::demand(!task.robot.base_known || task.train.stations.size() == 1, known_base_of_stations);
  vn::CalibrateOptions options = task.calibrate;
  hold_known_parts(task.robot, options);
  options.arm_name = robot.name;
  options.errors.drives = robot.drives;
  options.errors.down = robot.down;
  options.errors.controller = robot.controller;
  options.fit = fit;
  std::optional<vn::ArmPrior> prior;
  if (task.prior != nullptr) {
    vn::demand(task.prior->dof() == N, "calibrate: the prior is a model of ", task.prior->dof(),
               " joints, the arm has ", N);
    prior = vn::arm_prior(task.prior->as<N>());
    options.errors.prior = &*prior;
  }

  Stations stations = split_stations(task, types, fit.seed);
  vn::Measurements<N> train, test;
  vn::RowFingerprints fitted_rows;  // before readings of a pose are joined
  for (std::size_t k = 0; k < stations.splits.size(); ++k) {
    const std::string place = std::to_string(stations.station[k]);
    fitted_rows.add({stations.splits[k].train.joints(), stations.splits[k].train.positions()});
    train.add(vn::readings_joined(stations.splits[k].train, same), stations.names[k], place, stations.points[k]);
    test.add(std::move(stations.splits[k].test), stations.names[k], place, stations.points[k]);
  }
  std::string files, hashes;
  for (const MeasuredPoses& poses : task.train.stations) {
    files += (files.empty() ? "" : ",") + poses.name;
    if (!poses.origin.hashes.empty()) hashes += (hashes.empty() ? "" : ",") + poses.origin.hashes.front();
  }
  for (const MeasuredDistances& distances : task.train.distances) {
    const vn::MatrixX joints =
        task.robot.controller.same() ? distances.joints : task.robot.controller.to_chain(distances.joints);
    vn::Distances<N> set(joints, distances.lengths);
    train.add(distances.origin.empty() ? set : set.from(distances.origin), distances.name);
  }
  for (const vn::Contact& contact : task.train.contacts) train.add(contact);

  const auto calibration = vn::calibrate(robot.arm, train, options);
  CalibrationOutcome out;
  out.report = evaluate_visits(calibration, test, robot.limits, robot.controller);
  const auto model_of = [&](std::size_t set) {
    const std::string& point = stations.points[set];
    const vn::RobotInfo<N> info{.name = robot.name,
                                .limits = robot.limits,
                                .data_file = files + (point.empty() ? "" : " (point " + point + ")"),
                                .date = task.date,
                                .held_out_error = out.report.stage(out.report.chosen).position.mean(),
                                .data_sha256 = hashes,
                                .controller = robot.controller,
                                .fitted_rows = fitted_rows};
    return calibrated_arm_of(vn::calibrated_robot(calibration, info, set));
  };
  out.model = model_of(0);
  if (stations.own_tools()) {
    out.reflectors = reflectors_of(calibration, train);
    out.models.push_back(out.model);
    for (std::size_t set = 1; set < stations.splits.size(); ++set) out.models.push_back(model_of(set));
  }
  out.page = vn::report_input(out.report, robot.name);
  add_held_out(out.page, robot.arm, test);
  if (!out.reflectors.empty()) out.page.tables.push_back(reflector_table(out.reflectors));
  out.page.rule = stations.rule;
  out.page.accept = task.accept;
  for (const MeasuredPoses& poses : task.train.stations)
    for (std::size_t k = 0; k < poses.origin.files.size(); ++k)
      out.page.provenance.inputs.push_back({poses.origin.files[k], poses.size(), poses.origin.hashes[k]});
  out.results = out.page.results;
  return out;
}

}  // namespace support
