// SPDX-License-Identifier: BSD-3-Clause
// `calibrate` for arms of VERNIER_JOINTS joints.

#include <utility>

#include "calibration_task.hpp"
#include "held_out.hpp"
#include "instances.hpp"
#include "known_parts.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/io/identified_robot.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

namespace {

namespace vn = vernier;
constexpr int N = VERNIER_JOINTS;

/// Training and held-out poses of all stations, and how they were chosen.
struct Stations {
  std::vector<vn::Split<N>> splits{};
  std::string rule{};
};

Stations split_stations(const CalibrationTask& task, std::span<const vn::JointType> types, std::uint64_t seed) {
  const vn::SamePose same{.joint_types = types};
  Stations out;
  std::vector<std::string> names;
  if (task.test)
    vn::demand(task.test->stations.size() == task.train.stations.size(), "calibrate: held-out poses of ",
               task.test->stations.size(), " stations, the others are of ", task.train.stations.size());
  for (std::size_t s = 0; s < task.train.stations.size(); ++s) {
    const MeasuredPoses& poses = task.train.stations[s];
    names.push_back(poses.name.empty() ? vn::message("station ", s + 1) : poses.name);
    const vn::Dataset<N> all = dataset_of<N>(poses, task.robot.controller);
    if (task.test) {
      out.splits.push_back({all, dataset_of<N>(task.test->stations[s], task.robot.controller)});
      out.rule = "the poses given as held out";
      continue;
    }
    if (all.size() < 2)
      throw vn::CalibrationFailure(names.back() + ": a single row; a calibration needs many poses, and held-out ones");
    try {
      if (task.test_fraction > 0) {
        out.splits.push_back(vn::split(all, {.test_fraction = task.test_fraction, .seed = seed}, same));
        out.rule = vn::message(task.test_fraction * 100, " % of the rows, at random, seed ", seed);
      } else {
        out.splits.push_back(vn::split_every(all, task.test_every, same));
        out.rule = vn::message("every row i with i % ", task.test_every, " = 0, counted from 0");
      }
    } catch (const std::invalid_argument& error) {
      throw vn::CalibrationFailure(names.back() + ": " + error.what());
    }
  }
  const vn::Index apart = keep_poses_apart(out.splits, names, "", same);
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
  std::string files, hashes;
  for (std::size_t s = 0; s < stations.splits.size(); ++s) {
    const std::string& name = task.train.stations[s].name;
    const vn::RowOrigin& origin = task.train.stations[s].origin;
    files += (s > 0 ? "," : "") + name;
    if (!origin.hashes.empty()) hashes += (hashes.empty() ? "" : ",") + origin.hashes.front();
    train.add(vn::readings_joined(stations.splits[s].train, same), name);
    test.add(std::move(stations.splits[s].test), name);
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
  out.report = vn::evaluate(calibration, test, robot.limits, robot.controller);
  const vn::RobotInfo<N> info{.name = robot.name,
                              .limits = robot.limits,
                              .data_file = files,
                              .date = task.date,
                              .held_out_error = out.report.stage(out.report.chosen).position.mean(),
                              .data_sha256 = hashes,
                              .controller = robot.controller};
  out.model = calibrated_arm_of(vn::calibrated_robot(calibration, info));
  out.page = vn::report_input(out.report, robot.name);
  add_held_out(out.page, robot.arm, test);
  out.page.rule = stations.rule;
  out.page.accept = task.accept;
  for (const MeasuredPoses& poses : task.train.stations)
    for (std::size_t k = 0; k < poses.origin.files.size(); ++k)
      out.page.provenance.inputs.push_back({poses.origin.files[k], poses.size(), poses.origin.hashes[k]});
  out.results = out.page.results;
  return out;
}

}  // namespace support
