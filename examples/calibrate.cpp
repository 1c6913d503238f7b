// SPDX-License-Identifier: BSD-3-Clause
// Measured poses in; a calibrated model and its errors at held-out poses out.

#include <fmt/format.h>

#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "calibration_figures.hpp"
#include "calibration_options.hpp"
#include "camera_calibration.hpp"
#include "camera_joints.hpp"
#include "cli.hpp"
#include "console.hpp"
#include "contact_calibration.hpp"
#include "distance_calibration.hpp"
#include "json_file.hpp"
#include "parameter_table.hpp"
#include "pose_calibration.hpp"
#include "progress.hpp"
#include "report_page.hpp"
#include "robot_choice.hpp"
#include "saved_model.hpp"
#include "vernier/io/audit_json.hpp"
#include "vernier/io/report_json.hpp"

namespace {

namespace vn = vernier;

/// Calls a calibration with the options of a fit that shows how far it is.
template <class F>
auto calibrate_with_progress(const support::Program& program, const vn::RobotDescription& robot,
                             support::CalibrationOptions& o, const F& calibrate) {
  o.calibrate.arm_name = robot.name;
  o.calibrate.remainder.on_geometry = true;
  const int swarms = 2 * (o.calibrate.remainder.iterations + 1);
  const vn::Index total = swarms + (o.priors == "default" ? 0 : support::prior_generations + 1);
  std::optional<support::Working> fitting(std::in_place, "fitting the error model");  // until something is searched
  std::optional<support::ProgressBar> searching;
  vn::Index generations = 0;
  const auto count = [&](const vn::Progress&) {
    fitting.reset();
    if (!searching) searching.emplace("searching", total);
    searching->update(++generations);
  };
  o.reached = [&](double share) {
    if (fitting) fitting->reach(share);
  };
  const auto step = [&](const vn::Progress& progress) { o.reached(support::share_of_fit(progress.generation)); };
  o.calibrate.errors.observer = step;
  const vn::ThreadExecutor executor(program.common().threads);
  auto found =
      calibrate(robot, o, vn::FitOptions{.seed = program.common().seed, .executor = executor, .observer = count});
  o.calibrate.errors.observer = {};
  o.reached = [](double) {};
  return found;
}

/// The verdict and the table of stages. On a terminal their title and the row of the deployed stage stand out.
std::string verdict_of(const vn::CalibrationReport& report) {
  std::istringstream lines(report.summary());
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    const bool strong = line == "Verdict" || line.starts_with(report.stage(report.chosen).title + "  ");
    out += (strong ? support::styled(line, support::Look::strong) : line) + "\n";
  }
  return out;
}

void print_measurements(const vn::RobotDescription& robot, const support::CalibrationOptions& o,
                        const support::PoseCalibration& found, const support::CameraJoints* camera) {
  const vn::CalibrationReport& report = found.report;
  fmt::print("{}: {} joints{}\n", robot.name, robot.dof(),
             robot.modified ? "; modified convention, parameters are those of the equal standard chain" : "");
  if (camera != nullptr)
    fmt::print("{}\n", camera->camera.counts());
  else if (o.data.size() > 1)
    fmt::print("{} stations: one arm, {} base frames{}\n", o.data.size(), o.data.size(),
               o.calibrate.errors.tool_per_station ? " and as many tools" : "");
  else if (found.sets.size() > 1)
    fmt::print("{} reflectors: one arm, one base frame, {} tools\n", found.sets.size(), found.sets.size());
  fmt::print("{} poses to learn from, {} held out: {}\n", report.train_poses, report.test_poses(), found.held_out);
  for (const vn::FittedSet& set : report.others)
    fmt::print("{} measurements ({}) to learn from: {}\n", set.measurements, set.kind, set.name);
}

void print_reflectors(const std::vector<support::FoundReflector>& reflectors) {
  if (reflectors.empty()) return;
  fmt::print("\nReflectors in the frame of the flange, with standard deviations [mm]\n");
  for (const support::FoundReflector& one : reflectors)
    fmt::print("  {:<40} {:>10.3f} {:>10.3f} {:>10.3f}   {:.3f} {:.3f} {:.3f}\n", one.name, one.offset.x() * 1e3,
               one.offset.y() * 1e3, one.offset.z() * 1e3, one.std.x() * 1e3, one.std.y() * 1e3, one.std.z() * 1e3);
}

void print_camera(const support::CameraJoints& found, const support::CalibrationOptions& o) {
  fmt::print("\n{}", support::camera_verdict(found.camera, "Images"));
  if (!found.moved.empty()) {
    std::string moved;
    for (const double one : found.moved) moved += fmt::format("{}{:.2f}", moved.empty() ? "" : ", ", one);
    fmt::print("- Beside joint errors, steps of the intrinsics were {} standard deviations{}\n", moved,
               found.converged ? "; they rest." : "; THEY DO NOT REST: take more images, or state --intrinsics.");
    fmt::print("- Errors above are of single images, whose own poses err by {:.3f} mm (rms).\n",
               found.image_error * 1e3);
  }
  fmt::print("{}", support::camera_details(found.camera, o));
}

/// Prints, draws and writes what was found.
/// @param camera what images told of the camera; null where there were none
int report_calibration(support::Program& program, const vn::RobotDescription& robot,
                       const support::CalibrationOptions& o, support::PoseCalibration& found,
                       const support::CameraJoints* camera) {
  const vn::CalibrationReport& report = found.report;
  fmt::print("{}\n", verdict_of(report));
  print_measurements(robot, o, found, camera);
  print_reflectors(found.reflectors);
  if (camera != nullptr) print_camera(*camera, o);
  if (o.parameters)
    fmt::print("\nFrames and links, as the stage geometry has them\n\n{}",
               support::parameter_table(report.identification));
  if (o.verbose) {
    fmt::print("\n{}\nDetails\n", report.identification.summary());
    for (const std::string& line : report.details()) fmt::print("- {}\n", line);
    fmt::print(
        "\nFrom poses to error model in {:.1f} s, and {:.1f} s more of leave-one-pose-out errors; a pose of the chosen "
        "stage with its Jacobian takes {:.2g} us\n",
        report.fit_seconds - report.leave_one_out_seconds, report.leave_one_out_seconds,
        report.evaluation_seconds * 1e6);
  }
  support::Json json = vn::to_json(report, robot.name);
  for (const support::FoundReflector& one : found.reflectors)
    json["reflectors"].push_back({{"measured", one.name},
                                  {"rows", one.rows},
                                  {"offset_mm", {one.offset.x() * 1e3, one.offset.y() * 1e3, one.offset.z() * 1e3}},
                                  {"std_mm", {one.std.x() * 1e3, one.std.y() * 1e3, one.std.z() * 1e3}}});
  if (camera != nullptr) {
    json["camera"] = support::camera_json(camera->camera);
    json["camera"]["moved_in_rounds"] = camera->moved;
    json["camera"]["converged"] = camera->converged;
    json["camera"]["error_of_images_mm"] = camera->image_error * 1e3;
  }
  for (const vn::DataAudit& audit : found.audits) json["audit"].push_back(vn::to_json(audit));
  if (!program.common().json.empty()) support::write_json(program.common().json, json);
  if (!o.report.empty()) {
    found.page.rule = found.held_out;
    found.page.results = json.dump(-1, ' ', false, support::Json::error_handler_t::replace);
    support::write_report(program, o.report, found.page, o.date, found.model);
  }
  const std::filesystem::path folder = program.output_folder();
  support::draw_calibration(folder, robot.name, report);
  if (camera != nullptr) support::draw_cameras(folder, camera->camera);
  fmt::print("\n");
  if (!o.verbose)
    fmt::print("Details behind the verdict: --verbose; frames and links: --parameters; all of it: --report FILE\n");
  fmt::print("Figures: {}\n", folder.string());
  if (!o.save.empty()) fmt::print("Calibrated model: {}\n", support::shown(o.save));
  for (std::size_t k = 0; k < found.further_models.size(); ++k)
    fmt::print("With the tool of {}: {}\n", support::shown(found.sets[k + 1]), support::shown(found.further_models[k]));
  if (!o.report.empty()) fmt::print("Report: {}\n", support::shown(o.report));
  return 0;
}

int calibrate_by_poses(support::Program& program, support::CalibrationOptions& o) {
  program.require_output_folder();
  const vn::RobotDescription robot = support::choose_robot(o.robot);
  o.csv.controller = robot.controller;
  if (o.corners.empty()) {
    support::PoseCalibration found = calibrate_with_progress(program, robot, o, support::calibrate_from_poses);
    return report_calibration(program, robot, o, found, nullptr);
  }
  support::CameraJoints found = calibrate_with_progress(program, robot, o, support::calibrate_joints_by_camera);
  return report_calibration(program, robot, o, found.poses, &found);
}

int run(support::Program& program) {
  support::CalibrationOptions o = support::read_calibration_options(program);
  if (o.reregister) return support::reregister_model(program, o);
  if (!o.corners.empty() && !o.joint_errors) return support::calibrate_by_camera(program, o);
  if (o.data.empty()) {
    const vn::RobotDescription robot = support::choose_robot(o.robot);
    o.csv.controller = robot.controller;
    return o.contacts.empty() ? support::calibrate_by_distances(program, robot, o)
                              : support::calibrate_by_contacts(program, robot, o);
  }
  return calibrate_by_poses(program, o);
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "calibrate",
      "Calibrates an arm from measured poses, contacts or images, and reports its accuracy at held-out poses.",
      {"calibrate --robot abb_irb120 --data measured.csv --test-every 5 --save model.json --report report.html",
       "calibrate --model model.json --free base --data fresh.csv --save moved.json"}};
  return support::run_program(about, argc, argv, run);
}
