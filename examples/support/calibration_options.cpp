// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace support {

namespace {

namespace vn = vernier;

/// Values whose units or words differ from those of the options that they are turned into.
struct TypedValues {
  std::string loss = "huber";
  double distance_sigma_mm = 0.03, contact_sigma_mm = 0.03;
  double relevant_mm = 0;
  bool positions_only = false, no_tilt = false, no_temperature = false, no_drift = false;
};

void add_measurements(Program& program, CalibrationOptions& o, TypedValues& typed) {
  program
      .add_option("--data", o.data,
                  "measured poses: q1_rad.., x_mm, y_mm, z_mm, optionally rx_rad, ry_rad, rz_rad, time_s (or "
                  "time_ms), temperature_c, segment (a new number: the approach is unknown) or from_q1_rad.. (where "
                  "each pose was approached from), point (which of several reflectors; or all in one line, "
                  "x1_mm .. zK_mm); one file a sensor station",
                  "FILE")
      .required_without("--contacts, --distances or --flange-poses");
  const Option contacts =
      program.add_option("--contacts", o.contacts,
                         "what the tool point touched, beside the poses or, without --data, in their place: "
                         "contact_id, kind (plane, ball, socket), q1_rad.., radius_mm (of balls), offset_mm (known "
                         "distance from the first face or socket of the same contact)",
                         "FILE");
  program.add_setting("--contact-sigma", typed.contact_sigma_mm, "standard deviation of a touch [mm]", "MM")
      .within(1e-6, 1e3)
      .needs(contacts);
  program.add_option("--distances", o.distances,
                     "measured distances from a fixed point (draw-wire, ball-bar), beside the poses or, without "
                     "--data, in their place: q1_rad.., distance_mm; one file a fixed point",
                     "FILE");
  o.csv.add_to(program);
  o.csv.add_euler_to(program);
  o.sensor.add_to(program);
  program.add_setting("--distance-sigma", typed.distance_sigma_mm, "standard deviation of a distance [mm]", "MM")
      .within(1e-6, 1e3);
}

void add_cameras(Program& program, CalibrationOptions& o) {
  program.group(Group::input);
  Option corners = program.add_option(
      "--corners", o.corners,
      "corners of a printed board in images, with --data (columns image, q1_rad..) or --flange-poses: image, corner, "
      "u_px, v_px, optionally camera and board (names, where there are several cameras or places of the board)",
      "FILE");
  Option board =
      program.add_option("--board", o.board, "the printed board (JSON: rows, columns, square_mm, ...)", "FILE");
  Option mount = program
                     .add_option("--camera-mount", o.camera_mount,
                                 "flange: the flange carries the camera; fixed: it carries the board", "WHERE")
                     .one_of({"flange", "fixed"});
  corners.needs(board).needs(mount);
  board.needs(corners);
  mount.needs(corners);
  const Option intrinsics =
      program
          .add_option("--intrinsics", o.intrinsics,
                      "the camera's intrinsics (JSON, or YAML of OpenCV or ROS); unknown where this is not given; "
                      "several: one file a camera, in the order in which the corners name them",
                      "FILE")
          .needs(corners);
  program
      .add_option("--free-intrinsics", o.free_intrinsics,
                  "intrinsics that are estimated although they are given, joined by commas: fx, fy, cx, cy, k1, k2, "
                  "p1, p2, k3; left-out images decide on the others",
                  "NAMES")
      .delimiter(',')
      .needs(intrinsics);
  Option seen =
      program
          .add_option("--save-poses", o.save_poses,
                      "write the poses that the images show, with their covariances, to a file that --data takes (for "
                      "joint errors, plans, reports); of several places of the board to poses.csv, poses.2.csv, ...",
                      "FILE")
          .needs(corners);
  const Option joints = program
                            .add_flag("--joint-errors", o.joint_errors,
                                      "find the errors of the joints as well, from the poses that the images show, and "
                                      "assess all at held-out images, as without --corners")
                            .needs(corners);
  Option poses =
      program.add_option("--flange-poses", o.flange_poses,
                         "poses of the flange in place of joints, for base and tool alone: image, x_mm, y_mm, "
                         "z_mm, rx_rad, ry_rad, rz_rad",
                         "FILE");
  poses.needs(corners);
  poses.excludes(seen).excludes(joints);
  seen.excludes(joints);
  for (const char* other : {"--data", "--robot", "--save"}) poses.excludes(program.option(other));
  for (const char* other : {"--distances", "--contacts", "--test", "--own-tools", "--model"})
    corners.excludes(program.option(other));
}

void add_split(Program& program, CalibrationOptions& o) {
  program.group(Group::validation);
  Option test = program.add_option("--test", o.test,
                                   "held-out measured poses, as many files as --data; without --data, held-out "
                                   "contacts, or distances, likewise",
                                   "FILE");
  Option every =
      program
          .add_setting(
              "--test-every", o.test_every,
              "hold out every K-th row of the data; of contacts without --data, every K-th object, and none by default",
              "K")
          .within(2, 1000000);
  const Option split =
      program
          .add_option("--split", o.split,
                      "hold out a fraction of the rows: random, region-x or region-z (largest values for odd seeds, "
                      "smallest for even), time (the last rows), block (the first of 1/F contiguous blocks for seed "
                      "1, and so on)",
                      "HOW")
          .one_of({"random", "region-x", "region-z", "time", "block"});
  const Option fraction =
      program.add_setting("--test-fraction", o.test_fraction, "that fraction; random where --split is not given", "F")
          .within(0.001, 0.999);
  test.excludes(every).excludes(fraction).excludes(split);
  every.excludes(fraction).excludes(split);
  program.add_option("--train", o.train_rows, "learn from the first N rows of a seeded shuffle of the others", "N")
      .within(1, 100000000);
}

void add_results(Program& program, CalibrationOptions& o) {
  program.group(Group::output);
  program.add_output("--save", o.save, "write the calibrated model to this file, for correct");
  program.add_flag("--verbose", o.verbose,
                   "print the details behind the verdict: identification, decisions, ranges, drift, lines, advice");
  program.add_flag("--parameters", o.parameters, "print the identified frames and links, with standard deviations");
  program.add_setting("--date", o.date, "date written into the model", "DATE");
  const Option report =
      program.add_output("--report", o.report, "write the results as one HTML page that needs nothing else");
  program
      .add_option("--accept-mm", o.accept_mm, "with --report: the largest mean held-out error that is accepted [mm]",
                  "MM")
      .within(1e-6, 1e3)
      .needs(report);
}

void add_estimation(Program& program, CalibrationOptions& o, TypedValues& typed) {
  program.group(Group::model);
  program.add_setting("--loss", typed.loss, "squared, or huber or cauchy, which tolerate outliers", "LOSS")
      .one_of({"squared", "huber", "cauchy"});
  program.add_option("--fix", o.calibrate.geometry.fixed,
                     "parameters that stay nominal, by name (d1, theta6, tool_z, ...)", "NAME");
  program.add_flag("--no-approach", o.no_approach,
                   "rows are not in the order of measuring: no hysteresis by the direction of approach");
  program.add_flag("--no-tilt", typed.no_tilt, "no tilts of the joints' frames under gravity");
  program.add_flag("--estimate-down", o.calibrate.errors.estimate_down,
                   "estimate the direction of gravity too, from --down on, if compliance is found");
  program.add_flag("--no-temperature", typed.no_temperature, "no change of the geometry with temperature");
  program.add_flag("--no-drift", typed.no_drift, "no drift of base and joints during the session");
  program
      .add_option("--relevant-mm", typed.relevant_mm,
                  "from which size on an effect matters, as displacement of the tool point [mm]; by default a tenth of "
                  "the left-out error, at least the sensor's standard deviation",
                  "MM")
      .within(1e-6, 1e3);
  program
      .add_setting("--harmonics", o.calibrate.errors.harmonics,
                   "highest order of the joint-wise harmonics, at most 60 below 400 measurements; 0: none", "K")
      .within(0, 500);
  program
      .add_setting("--priors", o.priors,
                   "sizes of the joint errors: by default those of most evidence, or optimised by pso or ga on "
                   "left-out poses (takes a minute)",
                   "HOW")
      .one_of({"default", "pso", "ga"});
  program.add_flag("--own-tools", o.calibrate.errors.tool_per_station,
                   "every file of --data has its own tool, not only its own base");
  program.add_flag("--keep-outliers", o.calibrate.keep_outliers,
                   "learn from training rows that are outliers, too; by default they are named and left out");
  program.add_flag("--positions-only", typed.positions_only, "ignore measured orientations");
  program.add_option("--prior", o.prior,
                     "a calibrated model to start from: of this arm, earlier, or of another of its type; used as far "
                     "as left-out poses support it",
                     "FILE");
}

void add_reregistration(Program& program, CalibrationOptions& o) {
  Option model = program.add_option("--model", o.model,
                                    "a calibrated model: registered again from the data, the rest is kept", "FILE");
  Option free = program.add_option("--free", o.free,
                                   "with --model: what may move: base, tool (remounted: by millimetres), another-tool "
                                   "(by any amount), offsets, joined by commas",
                                   "WHAT");
  for (const char* of_calibration :
       {"--distances", "--contacts", "--robot", "--test-every", "--split", "--train", "--prior", "--report"})
    model.excludes(program.option(of_calibration));
  model.needs(free);
  free.needs(model);
}

/// Refuses what cannot be used together.
void require_consistent(const Program& program, const CalibrationOptions& o) {
  if (!o.corners.empty()) {
    for (const char* of_poses :
         {"--test-every", "--split", "--test-fraction", "--train", "--report", "--prior", "--priors"})
      if (!o.joint_errors && program.given(of_poses))
        throw UsageError(std::string(of_poses) + " needs --joint-errors beside --corners");
    if (!o.flange_poses.empty()) return;
    if (o.data.size() != 1)
      throw UsageError("--corners takes one file of --data, the joints of the images, or --flange-poses");
    if (!program.given("--robot")) throw UsageError("--robot is required (or --flange-poses in place of --data)");
    return;
  }
  if (o.data.empty() && (o.reregister || (o.contacts.empty() && o.distances.empty())))
    throw UsageError("--data is required (or --contacts or --distances, to calibrate without measured poses)");
  if (o.reregister) {
    if (o.data.size() != 1) throw UsageError("--model takes one file of --data");
    return;
  }
  if (!program.given("--robot")) throw UsageError("--robot is required (or --model, to register a fitted arm again)");
  if (!o.data.empty()) return;
  if (!o.contacts.empty() && !o.distances.empty())
    throw UsageError("--contacts beside --distances needs --data: neither shows where the base stands for the other");
  for (const char* of_poses : {"--position-sigma", "--orientation-sigma", "--positions-only", "--own-tools"})
    if (program.given(of_poses)) throw UsageError(std::string(of_poses) + " needs --data");
  if (o.contacts.empty()) return;
  for (const char* of_joints : {"--harmonics", "--priors", "--estimate-down", "--relevant-mm"})
    if (program.given(of_joints))
      throw UsageError(std::string(of_joints) + " needs --data: contacts alone identify the geometry");
}

}  // namespace

CalibrationOptions read_calibration_options(Program& program) {
  CalibrationOptions o;
  TypedValues typed;
  o.date = today();
  o.robot.add_to(program).required_without("--model or --flange-poses");
  add_measurements(program, o, typed);
  add_split(program, o);
  add_results(program, o);
  add_estimation(program, o, typed);
  add_reregistration(program, o);
  add_cameras(program, o);
  program.parse("calibrate_out");

  if (o.date.size() > 40 || std::any_of(o.date.begin(), o.date.end(), [](char c) { return c < ' '; }))
    throw UsageError("--date takes up to 40 plain characters");
  const std::size_t measured = !o.data.empty() ? o.data.size() : !o.contacts.empty() ? 1 : o.distances.size();
  if (!o.test.empty() && o.test.size() != measured)
    throw UsageError(fmt::format("{} files of --test for {} of {}", o.test.size(), measured,
                                 !o.data.empty()       ? "--data"
                                 : !o.contacts.empty() ? "--contacts"
                                                       : "--distances"));
  if (program.given("--test-fraction") && o.split.empty()) o.split = "random";
  o.holds_out = program.given("--test-every") || !o.split.empty();
  o.reregister = program.given("--model");
  require_consistent(program, o);

  const std::map<std::string, vn::Loss> losses{
      {"squared", vn::Loss::squared}, {"huber", vn::Loss::huber}, {"cauchy", vn::Loss::cauchy}};
  vn::SensorModel& sensors = o.calibrate.sensors;
  o.sensor.note(program);
  o.sensor.apply(sensors);
  sensors.loss = losses.at(typed.loss);
  sensors.distance_sigma = typed.distance_sigma_mm * 1e-3;
  sensors.contact_sigma = typed.contact_sigma_mm * 1e-3;
  sensors.use_orientations = !typed.positions_only;
  o.calibrate.errors.hysteresis = !o.no_approach;
  o.calibrate.errors.tilt = !typed.no_tilt;
  o.calibrate.errors.temperature = !typed.no_temperature;
  o.calibrate.errors.drift = !typed.no_drift;
  o.calibrate.errors.relevant_size = typed.relevant_mm * 1e-3;
  return o;
}

}  // namespace support
