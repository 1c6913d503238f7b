// SPDX-License-Identifier: BSD-3-Clause
// Measured poses or touches in; the arm's calibrated geometry out, as its URDF file or as the kinematics file of
// Universal Robots' driver, with what it loses against the full model.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <optional>
#include <utility>

#include "cli.hpp"
#include "contact_calibration.hpp"
#include "csv_options.hpp"
#include "file_name.hpp"
#include "json_file.hpp"
#include "pose_calibration.hpp"
#include "progress.hpp"
#include "robot_choice.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/urdf.hpp"

namespace {

namespace vn = vernier;

struct Settings {
  support::RobotOptions robot;
  support::CsvOptions csv;
  support::SensorOptions sensor;
  std::string data, contacts, urdf, ur_kinematics, ur_hash = "calib_unknown", date;
  vn::Index test_every = 5;
  bool holds_out = false;
  double contact_sigma_mm = 0.03;
  bool with_base = false, with_tool = false, positions_only = false;
};

/// A file to be written.
struct ExportedFile {
  std::string path, text;
  vn::ErrorStatistics error;  ///< of held-out poses [m]
};

struct Outcome {
  vn::Index learned = 0;     ///< poses or touches that it was fitted to
  vn::Index assessed = 0;    ///< those that errors are of
  std::string rule{};        ///< which those are, in words
  bool held_out = true;      ///< whether they are others
  std::string what{};        ///< what they are: poses, touches
  std::string full_model{};  ///< key of the chosen stage
  std::vector<ExportedFile> files{};
  vn::ErrorStatistics designed{}, full{};  ///< errors as designed and by the chosen stage [m]
};

support::CalibrationOptions calibration_options(const Settings& o, const vn::RobotDescription& robot) {
  support::CalibrationOptions out;
  if (!o.data.empty()) out.data = {o.data};
  out.contacts = o.contacts;
  out.holds_out = o.holds_out;
  out.calibrate.sensors.contact_sigma = o.contact_sigma_mm * 1e-3;
  if (!o.contacts.empty()) out.calibrate.sensors.loss = vn::Loss::huber;
  out.csv = o.csv;
  out.csv.controller = robot.controller;
  out.test_every = o.test_every;
  out.calibrate.arm_name = robot.name;
  out.sensor = o.sensor;
  o.sensor.apply(out.calibrate.sensors);
  out.calibrate.sensors.use_orientations = !o.positions_only;
  out.calibrate.remainder.on_geometry = true;
  return out;
}

/// An arm that was calibrated, and how well other descriptions of it do.
struct Calibrated {
  vn::ArmGeometry nominal, identified;
  std::function<vn::ErrorStatistics(const vn::RobotDescription&)> error_of;
  Outcome outcome;  ///< without files
};

Calibrated by_poses(const Settings& o, const vn::RobotDescription& robot, const vn::FitOptions& fit,
                    support::Working& working) {
  constexpr double of_errors = 0.75;  // share of the time that the error model takes; the rest is for the remainder
  const auto watch = [&](const vn::Progress& progress) {
    working.reach(of_errors * support::share_of_fit(progress.generation));
  };
  support::CalibrationOptions options = calibration_options(o, robot);
  options.calibrate.errors.observer = watch;
  support::PoseCalibration found = support::calibrate_from_poses(robot, options, fit);
  const vn::CalibrationReport& report = found.report;
  return {found.nominal,
          found.identified,
          std::move(found.error_of),
          {.learned = report.train_poses,
           .assessed = report.test_poses(),
           .rule = found.held_out,
           .what = "poses",
           .full_model = report.chosen.key(),
           .designed = vn::ErrorStatistics::of(report.stage(vn::Stage::frames).position),
           .full = vn::ErrorStatistics::of(report.stage(report.chosen).position)}};
}

Calibrated by_contacts(const Settings& o, const vn::RobotDescription& robot, const vn::FitOptions& fit) {
  support::ContactCalibration found = support::identify_from_contacts(robot, calibration_options(o, robot), fit.seed);
  const vn::VectorX errors = support::touch_errors(found.found);
  return {found.nominal,
          found.identified,
          std::move(found.error_of),
          {.learned = found.touches,
           .assessed = errors.size(),
           .rule = found.held_out,
           .held_out = !found.held_out.empty(),
           .what = "touches",
           .full_model = "geometry",
           .designed = vn::ErrorStatistics::of(support::touch_errors(found.designed)),
           .full = vn::ErrorStatistics::of(errors)}};
}

Outcome export_arm(const Settings& o, const vn::RobotDescription& robot, const std::optional<vn::UrdfChain>& chain,
                   const vn::FitOptions& fit, support::Working& working) {
  const Calibrated calibration = o.contacts.empty() ? by_poses(o, robot, fit, working) : by_contacts(o, robot, fit);
  Outcome out = calibration.outcome;
  const vn::ArmGeometry &nominal = calibration.nominal, &identified = calibration.identified;
  const vn::ArmGeometry geometry = identified.with_frames(o.with_base ? identified.base() : nominal.base(),
                                                          o.with_tool ? identified.tool() : nominal.tool());
  vn::ExportNote note{.robot = robot.name,
                      .data = support::file_name(o.contacts.empty() ? o.data : o.contacts),
                      .date = o.date,
                      .fitted_poses = out.learned,
                      .full_model = out.full_model,
                      .error_full = out.full,
                      .error_exported = {},
                      .what = out.what,
                      .held_out = out.held_out};
  if (!o.urdf.empty()) {
    const auto as_file = [&] { return vn::export_urdf(*chain, geometry, note); };
    note.error_exported =
        calibration.error_of(vn::parse_urdf(as_file(), o.urdf, chain->base_link, chain->tip_link).robot);
    out.files.push_back({o.urdf, as_file(), note.error_exported});
  }
  if (!o.ur_kinematics.empty()) {
    const vn::UrKinematics kinematics =
        chain ? vn::UrKinematics::of(*chain, geometry, o.ur_hash) : vn::UrKinematics::of(geometry, o.ur_hash);
    note.error_exported = calibration.error_of(kinematics.robot(robot.name));
    out.files.push_back({o.ur_kinematics, kinematics.text(note), note.error_exported});
  }
  return out;
}

void print(const Settings& o, const vn::RobotDescription& robot, const Outcome& out) {
  fmt::print("{}: {} joints\n{} {} to learn from", robot.name, robot.dof(), out.learned, out.what);
  if (out.held_out) fmt::print(", {} held out: {}", out.assessed, out.rule);
  fmt::print("\n\n{:<42} {:>8} {:>8} {:>8}\n",
             fmt::format("Position errors of {}{} [mm]", out.held_out ? "held-out " : "these ", out.what), "mean",
             "95 %", "max");
  const auto row = [](const std::string& name, const vn::ErrorStatistics& e) {
    fmt::print("{:<42} {:>8.3f} {:>8.3f} {:>8.3f}\n", name, e.mean * 1e3, e.p95 * 1e3, e.max * 1e3);
  };
  row("as designed", out.designed);
  for (const ExportedFile& file : out.files) row(support::shown(file.path), file.error);
  row(fmt::format("full model ({})", out.full_model), out.full);
  const double exported = out.files.front().error.mean;
  if (out.full.mean < 0.9 * exported)
    fmt::print(
        "\nThe files hold geometry alone. With the full model (calibrate --save, then correct) the mean error is "
        "{:.1f} times smaller.\n",
        exported / out.full.mean);
  fmt::print(
      "\nThe base frame is {}, the tool frame is {}. Base and tool of these errors are registered by the training "
      "{}.\nWho uses these files must not be sent commands corrected by the full model: they would be "
      "corrected twice.\n",
      o.with_base ? "the fitted one, that of the sensor" : "as it was",
      o.with_tool ? "the fitted one, what was measured" : "as it was", out.what);
  if (!o.ur_kinematics.empty())
    fmt::print("{}: hash {}; the controller keeps its own calibration, and computes joint values by that.\n",
               support::shown(o.ur_kinematics), o.ur_hash);
  for (const ExportedFile& file : out.files) fmt::print("Written: {}\n", support::shown(file.path));
}

/// A robot that no URDF file describes, as one.
/// @param file for messages
vn::UrdfChain plain_chain(const vn::RobotDescription& robot, const std::string& file) {
  try {
    return vn::parse_urdf(vn::urdf_text(robot), file);
  } catch (const std::invalid_argument& error) {
    throw support::UsageError(std::string("--urdf: ") + error.what());
  }
}

/// A robot with the rows and frames of its URDF file.
vn::RobotDescription between_its_links(const vn::RobotDescription& robot, const vn::UrdfChain& chain) {
  vn::RobotDescription out = robot;
  out.modified = false;
  out.rows = chain.robot.rows;
  out.base = chain.robot.base;
  out.tool = chain.robot.tool;
  out.down = out.base.linear().transpose() * robot.geometry().base().isometry().linear() * robot.chain_down();
  return out;
}

/// What a URDF file cannot say of a robot.
void print_conventions(const vn::RobotDescription& robot) {
  if (!robot.controller.same())
    fmt::print("The joints of the URDF file are those of the chain: {}, of the controller's J1 ..\n",
               fmt::join(robot.controller.formulas(robot.joint_types()), ", "));
  const vn::Vector3 down = robot.base.linear() * robot.down;
  if ((down + vn::Vector3::UnitZ()).norm() > 1e-6)
    fmt::print(
        "Gravity acts along ({:.3g}, {:.3g}, {:.3g}) of base_link; give it with --down where the file is used.\n",
        down.x(), down.y(), down.z());
}

support::Json to_json(const vn::ErrorStatistics& e) {
  return {{"mean_mm", e.mean * 1e3}, {"p95_mm", e.p95 * 1e3}, {"max_mm", e.max * 1e3}};
}

int run(support::Program& program) {
  Settings o;
  o.date = support::today();
  o.robot.add_to(program).required();
  support::Option data = program.add_option("--data", o.data, "measured poses, columns as for calibrate", "FILE")
                             .required_without("--contacts");
  const support::Option contacts = program.add_option(
      "--contacts", o.contacts, "touches of objects in place of poses, columns as for calibrate", "FILE");
  data.excludes(contacts);
  program.add_setting("--contact-sigma", o.contact_sigma_mm, "standard deviation of a touch [mm]", "MM")
      .within(1e-6, 1e3)
      .needs(contacts);
  o.csv.add_to(program);
  o.csv.add_euler_to(program);
  o.sensor.add_to(program);
  program.add_flag("--positions-only", o.positions_only, "ignore measured orientations");
  program.group(support::Group::validation);
  program
      .add_setting("--test-every", o.test_every,
                   "hold out every K-th row of the data; of contacts every K-th object, and none by default", "K")
      .within(2, 1000000);
  program.group(support::Group::output);
  program.add_output("--urdf", o.urdf,
                     "write a URDF file with the calibrated origins of its joints: that of --robot, or a plain one of "
                     "links without shape");
  const support::Option kinematics = program.add_output(
      "--ur-kinematics", o.ur_kinematics, "write the kinematics file of Universal Robots' driver to this file");
  program
      .add_setting("--ur-hash", o.ur_hash,
                   "of the controller's kinematics, as in the file that ur_calibration wrote; the driver warns of "
                   "another",
                   "HASH")
      .needs(kinematics);
  program.add_flag("--with-base", o.with_base, "write the base frame, too: that of the sensor");
  program.add_flag("--with-tool", o.with_tool,
                   "write the tool frame, too: the point that was measured becomes the tip link");
  program.add_setting("--date", o.date, "date written into the files", "DATE");
  program.parse("", nullptr);
  o.sensor.note(program);

  o.holds_out = program.given("--test-every");
  if (o.data.empty() == o.contacts.empty()) throw support::UsageError("--data is required (or --contacts)");
  for (const char* of_poses : {"--positions-only", "--position-sigma", "--orientation-sigma"})
    if (!o.contacts.empty() && program.given(of_poses))
      throw support::UsageError(std::string(of_poses) + " needs --data");
  if (!o.contacts.empty() && o.with_base)
    throw support::UsageError("--with-base: contacts do not show where the base stands");
  if (o.urdf.empty() && o.ur_kinematics.empty())
    throw support::UsageError("nothing to write: one of --urdf and --ur-kinematics is required");
  if (o.with_tool && !o.ur_kinematics.empty())
    throw support::UsageError("--with-tool: the kinematics file of --ur-kinematics ends at the flange, it has no tool");
  if (o.ur_hash.empty() || o.ur_hash.size() > 64 ||
      o.ur_hash.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") !=
          std::string::npos)
    throw support::UsageError("--ur-hash takes up to 64 letters, digits and underscores, like calib_1234");

  vn::UrdfChain read;
  vn::RobotDescription robot = support::choose_robot(o.robot, &read);
  std::optional<vn::UrdfChain> chain;
  if (o.robot.is_urdf()) chain = std::move(read);
  if (!o.urdf.empty() && !chain) {
    chain = plain_chain(robot, o.urdf);
    robot = between_its_links(robot, *chain);
  }
  if (o.with_tool && chain && chain->moving.back() + 1 == static_cast<int>(chain->joints.size()))
    throw support::UsageError("--with-tool: link '" + chain->tip_link +
                              "' is behind no fixed joint, which could hold the tool");
  const vn::ThreadExecutor executor(program.common().threads);
  const vn::FitOptions fit{.seed = program.common().seed, .executor = executor};
  support::Working working("calibrating");
  const Outcome out = export_arm(o, robot, chain, fit, working);
  working.finish();
  for (const ExportedFile& file : out.files) vn::write_file(file.path, file.text);
  print(o, robot, out);
  if (!o.urdf.empty() && !o.robot.is_urdf()) print_conventions(robot);
  if (!program.common().json.empty()) {
    support::Json json{{"robot", robot.name},
                       {"train_rows", out.learned},
                       {"test_rows", out.held_out ? out.assessed : 0},
                       {"chosen", out.full_model},
                       {"as_designed", to_json(out.designed)},
                       {"full", to_json(out.full)},
                       {"files", support::Json::array()}};
    for (const ExportedFile& file : out.files) {
      json["files"].push_back(to_json(file.error));
      json["files"].back()["file"] = support::shown(file.path);
    }
    support::write_json(program.common().json, json);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{"export_robot",
                             "Writes the calibrated geometry of an arm as its URDF file or as the kinematics file of "
                             "Universal Robots' driver.",
                             {"export_robot --robot my_arm.urdf --data measured.csv --urdf calibrated.urdf",
                              "export_robot --robot ur10 --data measured.csv --ur-kinematics my_ur10.yaml"}};
  return support::run_program(about, argc, argv, run);
}
