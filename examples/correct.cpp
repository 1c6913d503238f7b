// SPDX-License-Identifier: BSD-3-Clause
// A calibrated model and a file of targets in, corrected joint commands out.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "correction_report.hpp"
#include "csv_options.hpp"
#include "dispatch.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "payload_option.hpp"
#include "program_correction.hpp"
#include "progress.hpp"
#include "vernier/compensation/correct_path.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/json.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"
#include "with_branches.hpp"

namespace {

namespace vn = vernier;

/// In which frames a controller shows poses.
struct ControllerFrames {
  vn::Isometry3 base;  ///< in the base frame of the chain
  vn::Isometry3 tool;  ///< in the last frame of the chain
};

/// What the command line says.
struct Settings {
  std::string model, targets, out;
  support::CsvOptions csv;
  support::JointUnits units;
  std::optional<ControllerFrames> controller{};  ///< where targets are poses that it shows
  bool poses = false;                            ///< of a file with joints and poses, the poses are the targets
  bool approach = true;                          ///< commands are executed in their order
  bool linear = false;                           ///< all moves are linear
  bool branches = false;                         ///< all branches of each target instead of a path
  bool radius = true;                            ///< the radius of 95 % of each command
  std::optional<double> temperature{};
  support::PayloadOption payload{};
  double tolerance_mm = 0.05, max_step_deg = 30;
  std::vector<double> start{};
  std::vector<std::string> hold{};  ///< joints that stay, q1_m=1.2
};

const char* words(vn::PointStatus status) {
  switch (status) {
    case vn::PointStatus::met: return "converged";
    case vn::PointStatus::jump: return "jump";
    case vn::PointStatus::off_path: return "off_path";
    case vn::PointStatus::beyond_limits: return "beyond_limits";
    case vn::PointStatus::proven_out: return "proven_out";
    case vn::PointStatus::invalid_target: return "invalid_target";
    default: return "not_found";
  }
}

/// The targets of a file, their joints those of the controller.
/// @throws vn::DataError on a malformed file, or one without what the settings ask for
template <int N>
std::vector<vn::PathTarget<N>> read_targets(const Settings& settings, const vn::CalibratedRobot<N>& robot) {
  vn::CsvFormat format = settings.csv.format();
  format.controller = robot.controller();
  const auto file = vn::read_targets<N>(settings.targets, robot.nominal().chain().joint_types(), format);
  const vn::JointChange<N> change(robot.controller());
  const bool joints = file.joints.rows() > 0, poses = file.positions.rows() > 0 && (settings.poses || !joints);
  if (settings.poses && file.positions.rows() == 0)
    throw vn::DataError(settings.targets + ": no columns x_mm, y_mm, z_mm");
  if (settings.controller && !poses)
    throw vn::DataError(settings.targets + ": --frame base is of poses; there are joints, and no --poses");
  if (poses && (N >= 6 || settings.controller) && file.orientations.rows() == 0)
    throw vn::DataError(vn::message(settings.targets, ": no columns rx_rad, ry_rad, rz_rad; a pose of an arm of ", N,
                                    " joints has an orientation"));
  std::vector<vn::PathTarget<N>> out;
  for (vn::Index i = 0; i < file.size(); ++i) {
    vn::PathTarget<N> target{.pose = vn::Isometry3::Identity()};
    if (joints) {
      const vn::JointVector<N> chain = file.joints.row(i).transpose();
      target.joints = change.to_controller(chain);
      target.pose = robot.nominal().pose(chain);
    }
    if (poses) {
      target.pose.translation() = file.positions.row(i).transpose();
      if (file.orientations.rows() > 0)
        target.pose.linear() = vn::exp_so3(vn::Vector3(file.orientations.row(i).transpose()));
      if (settings.controller) {  // where the measured point is when the controller's tool is there
        const auto& [base, tool] = *settings.controller;
        target.pose = robot.nominal().base() * base * target.pose * tool.inverse() * robot.nominal().tool();
      }
    }
    const bool linear = file.linear.empty() ? settings.linear : file.linear[static_cast<std::size_t>(i)];
    target.motion = linear ? vn::Motion::linear : vn::Motion::joint;
    out.push_back(target);
  }
  return out;
}

/// The value of `--hold q1_m=1.2` in rad or m, and its joint, from 0.
/// @throws support::UsageError for what is no joint of the controller
std::pair<vn::Index, double> held_joint(const std::string& text, const std::vector<vn::JointType>& types) {
  static const std::map<std::string, std::pair<vn::JointType, double>> units{
      {"rad", {vn::JointType::revolute, 1}},     {"deg", {vn::JointType::revolute, std::numbers::pi / 180}},
      {"mrad", {vn::JointType::revolute, 1e-3}}, {"m", {vn::JointType::prismatic, 1}},
      {"mm", {vn::JointType::prismatic, 1e-3}},  {"um", {vn::JointType::prismatic, 1e-6}}};
  const std::size_t unit_at = text.find('_'), equals = text.find('=');
  const auto number = [&](std::size_t from, std::size_t to, auto& value) {
    const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
    return error == std::errc() && end == text.data() + to;
  };
  vn::Index joint = 0;
  double value = 0;
  if (text.size() < 2 || text[0] != 'q' || unit_at == std::string::npos || equals == std::string::npos ||
      equals < unit_at || !number(1, unit_at, joint) || !number(equals + 1, text.size(), value) ||
      !std::isfinite(value))
    throw support::UsageError(fmt::format("--hold {}: not like q1_m=1.2", vn::detail::quotable(text)));
  if (joint < 1 || joint > static_cast<vn::Index>(types.size()))
    throw support::UsageError(fmt::format("--hold {}: the controller has {} joints", text, types.size()));
  const auto unit = units.find(text.substr(unit_at + 1, equals - unit_at - 1));
  if (unit == units.end() || unit->second.first != types[static_cast<std::size_t>(joint - 1)])
    throw support::UsageError(fmt::format(
        "--hold {}: the unit of joint {} is {}", text, joint,
        types[static_cast<std::size_t>(joint - 1)] == vn::JointType::revolute ? "rad, deg or mrad" : "m, mm or um"));
  return {joint - 1, value * unit->second.second};
}

/// Targets that follow each other while all held joints stay.
template <int N>
struct Run {
  std::size_t first, count;
  vn::JointLimits<N> limits;  ///< equal ones hold a joint
};

/// The runs of targets: a rail that carries the arm stands where each target has it.
/// @throws support::UsageError where nobody says where it stands
template <int N>
std::vector<Run<N>> runs_of(const std::vector<vn::PathTarget<N>>& targets, const vn::CalibratedRobot<N>& robot,
                            const vn::JointLimits<N>& limits) {
  const int rail = robot.nominal().chain().row(0).joint == vn::JointType::prismatic
                       ? vn::JointChange<N>(robot.controller()).alone(0)
                       : -1;
  if (N != 7 || rail < 0 || vn::same_value(limits.lower(rail), limits.upper(rail)))
    return {{0, targets.size(), limits}};
  std::vector<Run<N>> out;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double at = targets[i].joints(rail);
    if (!std::isfinite(at))
      throw support::UsageError(fmt::format(
          "where is the rail at the poses? State joints q1_m .. beside them, or --hold q{}_m=..", rail + 1));
    if (out.empty() || !vn::same_value(out.back().limits.lower(rail), at)) {
      out.push_back({i, 0, limits});
      out.back().limits.lower(rail) = out.back().limits.upper(rail) = at;
    }
    ++out.back().count;
  }
  return out;
}

/// The values of the controller's joints, of which there may be fewer than joints of the chain.
template <int N>
std::vector<double> shown_joints(const vn::JointVector<N>& q, const vn::JointChange<N>& change) {
  return {q.data(), q.data() + change.moving()};
}

/// The pose that the controller shows at joint values of the chain.
template <int N>
std::optional<vn::Isometry3> commanded_pose(const Settings& settings, const vn::CalibratedRobot<N>& robot,
                                            const vn::JointVector<N>& chain) {
  if (!settings.controller || !chain.allFinite()) return std::nullopt;
  const auto& [base, tool] = *settings.controller;
  return base.inverse() * robot.nominal().chain().pose(chain) * tool;
}

/// The row of a target without any command.
support::CommandRow no_command(int joints, vn::Index target, vn::PointStatus status) {
  const double none = std::nan("");
  return {std::vector<double>(static_cast<std::size_t>(joints), none),
          target,
          "target",
          words(status),
          none,
          none,
          0,
          0,
          1,
          {}};
}

/// All branches of each target.
template <int N, class Roots>
void list_branches(const vn::InControllerJoints<vn::CalibratedRobot<N>>& arm, const Roots& roots,
                   const std::vector<vn::PathTarget<N>>& targets, std::size_t before, const vn::JointLimits<N>& limits,
                   support::CorrectionReport& report) {
  const vn::CalibratedRobot<N>& robot = arm.in_chain_joints();
  for (const auto& target : targets) {
    const vn::Index number = static_cast<vn::Index>(before) + (&target - targets.data()) + 1;
    vn::BranchOptions<N> options{.limits = limits};
    if (target.joints.allFinite()) options.close_to = target.joints;
    const vn::Branches<N> found = vn::all_branches(roots, arm, target.pose, options);
    std::vector<vn::Branch<N>> sorted(found.begin(), found.end());
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.singularities.branch() < b.singularities.branch(); });
    for (const auto& b : sorted) {
      const vn::JointVector<N> chain = arm.change().to_chain(b.joints);
      const auto links = robot.nominal().chain().links(chain);
      std::vector<vn::Vector3> points;
      for (int j = 0; j < N; ++j) points.push_back(robot.nominal().base() * vn::Vector3(links.point.col(j)));
      points.push_back(robot.nominal().position(chain));
      report.rows.push_back({shown_joints(b.joints, arm.change()), number,
                             vn::message("branch ", b.singularities.branch()),
                             words(b.within_limits ? vn::PointStatus::met : vn::PointStatus::beyond_limits),
                             b.position_error, b.rotation_error, 0, 0, arm.gate(b.joints), b.singularities, points});
    }
    if (found.count == 0)
      report.rows.push_back(no_command(arm.change().moving(), number,
                                       found.reach == vn::Reach::proven_out       ? vn::PointStatus::proven_out
                                       : found.reach == vn::Reach::invalid_target ? vn::PointStatus::invalid_target
                                                                                  : vn::PointStatus::not_found));
  }
}

/// Corrects all targets.
/// @throws vn::DataError on a malformed file
template <int N>
support::CorrectionReport correct_arm(const Settings& settings, const vn::SavedModel& model) {
  const vn::CalibratedRobot<N> saved = model.as<N>();
  const vn::CalibratedRobot<N> robot =
      support::carrying(settings.temperature ? saved.at_temperature(*settings.temperature) : saved, settings.payload);
  const std::vector<vn::PathTarget<N>> targets = read_targets(settings, robot);
  const vn::InControllerJoints<vn::CalibratedRobot<N>> arm = robot.in_controller_joints();
  support::CorrectionReport report{.robot = robot.name(),
                                   .joints = robot.controller().types(robot.nominal().chain().joint_types()),
                                   .targets = static_cast<vn::Index>(targets.size()),
                                   .expected_error = robot.provenance().expected_error(),
                                   .held_out = robot.provenance().held_out_error > 0};
  if (const vn::ThermalRates* thermal = robot.model().thermal()) {
    report.temperature = thermal->reference;
    report.clamped = settings.temperature && *settings.temperature != thermal->reference;
  } else if (settings.temperature) {
    report.clamped = true;
  }
  report.temperature_given = settings.temperature.has_value();
  report.branches = settings.branches;
  vn::PathOptions<N> options{.limits = robot.limits(),
                             .tolerance = settings.tolerance_mm * 1e-3,
                             .max_joint_step = settings.max_step_deg * std::numbers::pi / 180,
                             .approach = settings.approach};
  if (!settings.start.empty()) {
    if (settings.start.size() != report.joints.size())
      throw support::UsageError(fmt::format("--start needs {} values", report.joints.size()));
    options.start.setZero();
    std::copy(settings.start.begin(), settings.start.end(), options.start.begin());
  }
  for (const std::string& text : settings.hold) {
    const auto [joint, value] = held_joint(text, report.joints);
    if (value < options.limits.lower(joint) || value > options.limits.upper(joint))
      throw support::UsageError(fmt::format("--hold {}: beyond the limits of the joint", text));
    options.limits.lower(joint) = options.limits.upper(joint) = value;
  }
  vn::CorrectedPath<N> path;
  const auto correct_run = [&](const Run<N>& run, const std::vector<vn::PathTarget<N>>& part, const auto& roots) {
    vn::CorrectedPath<N> found;
    if constexpr (std::is_null_pointer_v<std::remove_cvref_t<decltype(roots)>>) {
      if (settings.branches)
        throw support::UsageError("--all-branches: needs an arm of six revolute joints that move; --hold the others");
      if (!part.front().joints.allFinite() && settings.start.empty())
        throw support::UsageError(fmt::format("poses of an arm of {} joints need joints q1_rad .. or --start", N));
      found = vn::correct_path(arm, part, options);
    } else if (settings.branches) {
      list_branches(arm, roots, part, run.first, run.limits, report);
    } else {
      found = vn::correct_path(arm, roots, part, options);
    }
    path.before = std::max(path.before, found.before);
    path.after = std::max(path.after, found.after);
    for (vn::PathPoint<N>& point : found.points) {
      // the rail moved before the first target of a further run, which is no linear move
      const bool first = run.first > 0 && point.target == 0;
      if (first && part.front().motion == vn::Motion::linear && point.status == vn::PointStatus::met)
        point.status = vn::PointStatus::jump;
      point.target += static_cast<vn::Index>(run.first);
      path.points.push_back(point);
    }
    if (!path.points.empty()) options.start = path.points.back().command;
  };
  support::Working working("correcting");
  vn::Index before_run = 0;
  const auto watch = [&](const vn::Progress& progress) {
    working.reach(static_cast<double>(before_run + progress.generation) / static_cast<double>(targets.size()));
  };
  options.observer = watch;
  for (const Run<N>& run : runs_of(targets, robot, options.limits)) {
    options.limits = run.limits;
    before_run = static_cast<vn::Index>(run.first);
    const auto begin = targets.begin() + static_cast<std::ptrdiff_t>(run.first);
    const std::vector<vn::PathTarget<N>> part(begin, begin + static_cast<std::ptrdiff_t>(run.count));
    support::with_branches(robot.nominal(), arm.change(), run.limits,
                           [&](const auto& roots) { correct_run(run, part, roots); });
  }
  working.finish();
  if (!settings.branches)
    for (const auto& target : targets) report.linear = report.linear || target.motion == vn::Motion::linear;
  report.before = path.before;
  report.after = path.after;
  vn::JointRows<N> commands(static_cast<vn::Index>(path.points.size()), N);
  for (const auto& p : path.points) {
    commands.row(static_cast<vn::Index>(report.rows.size())) = arm.change().to_chain(p.command).transpose();
    report.rows.push_back({shown_joints(p.command, arm.change()),
                           p.target + 1,
                           p.inserted ? "inserted" : "target",
                           words(p.status),
                           p.position_error,
                           p.rotation_error,
                           p.deviation,
                           p.ends_only,
                           p.gate,
                           p.singularities,
                           {}});
    if (p.command.allFinite()) report.rows.back().point = arm.position(p.command);
    report.rows.back().commanded = commanded_pose<N>(settings, robot, arm.change().to_chain(p.command));
  }
  if (settings.radius && !settings.branches && saved.estimate() != nullptr) {
    constexpr vn::Index block = 64;  // at a time, each command for itself
    support::ProgressBar bar("radii of 95 %", commands.rows());
    for (vn::Index first = 0; first < commands.rows(); first += block) {
      const vn::Index count = std::min(block, commands.rows() - first);
      const std::vector<double> radii = robot.radii_95(vn::JointRows<N>(commands.middleRows(first, count)));
      for (std::size_t i = 0; i < radii.size(); ++i) report.rows[static_cast<std::size_t>(first) + i].radius = radii[i];
      bar.update(first + count);
    }
  }
  return report;
}

int run(support::Program& program) {
  Settings settings;
  support::ProgramCorrection in_place;
  bool no_approach = false, no_radius = false;
  std::string frame = "measured";
  program.add_option("--model", settings.model, "calibrated model that calibrate saved", "FILE").required();
  program
      .add_option("--targets", settings.targets,
                  "joints q1_rad.. at which the nominal arm stands where the actual one is to go, or poses x_mm, y_mm, "
                  "z_mm, rx_rad, ry_rad, rz_rad in the frame of the measurements; a column move says how the arm goes "
                  "there: j (joint move) or l (linear move)",
                  "FILE")
      .required_without("--program");
  settings.csv.add_to(program, "", "--targets");
  settings.csv.add_euler_to(program);
  support::add_program_options(program, in_place);
  program.group(support::Group::input);
  program.add_flag("--poses", settings.poses,
                   "of a file with joints and poses, the poses are the targets; the joints choose the branch");
  program
      .add_setting(
          "--frame", frame,
          "of poses in --targets: that of the measurements, where the measured point goes, or the robot's base, "
          "as the pendant shows poses of the tool of --tool (by default the flange); then the commands are "
          "given as such poses, too",
          "measured|base")
      .one_of({"measured", "base"});
  program.group(support::Group::model);
  program.add_flag("--linear", settings.linear, "all moves are linear, where the file has no column move");
  program
      .add_setting("--tolerance-mm", settings.tolerance_mm,
                   "points are inserted in a linear move until the tool stays so near to the line", "MM")
      .positive();
  program
      .add_setting("--max-step-deg", settings.max_step_deg, "largest change of a joint between points of a linear move",
                   "DEG")
      .positive();
  program
      .add_option("--start", settings.start, "joint values before the first target [rad, m], separated by commas",
                  "Q1,..")
      .delimiter(',');
  program
      .add_option(
          "--hold", settings.hold,
          "a joint that stays, e.g. a rail: q1_m=1.2; of seven joints the others are then solved in closed form. "
          "Without it a rail stands where the joints of each target have it",
          "qN_UNIT=VALUE")
      .one_value_each();
  program.add_flag("--all-branches", settings.branches, "all joint values of each target, not a path");
  program.add_flag("--no-approach", no_approach,
                   "the commands are not executed in the order of the file: correct for the middle of both directions "
                   "of approach, not for the approach from the command before");
  program.add_flag("--no-radius", no_radius, "leave out the radius of 95 %, which takes longest");
  program.add_option("--temperature-c", settings.temperature,
                     "temperature of the arm [deg C], for a model that changes with it; by default the mean of its "
                     "measurements",
                     "T");
  settings.payload.add_to(program);
  program.group(support::Group::output);
  settings.units.add_to(program);
  program.parse("", "write the commands to this file", "FILE");
  settings.out = program.common().out;
  settings.approach = !no_approach;
  settings.radius = !no_radius;
  if (settings.targets.empty() == in_place.program.empty())
    throw support::UsageError("either --targets or --program is required");
  const bool base_frame = frame == "base";
  for (const char* option : {"--tool", "--robot-base", "--flange"})
    if (in_place.program.empty() && !base_frame && program.given(option))
      throw support::UsageError(fmt::format("{} is of a --program, or of poses with --frame base", option));
  for (const char* option : {"--poses", "--linear", "--tolerance-mm", "--max-step-deg", "--hold", "--all-branches",
                             "--no-radius", "--degrees", "--separator", "--decimal", "--columns", "--euler"})
    if (!in_place.program.empty() && program.given(option))
      throw support::UsageError(fmt::format("{} is of --targets, not of a --program", option));
  if (!in_place.program.empty() && base_frame) throw support::UsageError("--frame is of --targets");
  if (!in_place.program.empty())
    return support::correct_program(
        in_place, {settings.model, settings.out, program.common().json, settings.temperature, settings.payload,
                   settings.start, settings.approach});

  if (base_frame) {
    const auto frame_or_none = [](const std::string& text, const char* option) {
      return text.empty() ? vn::Isometry3(vn::Isometry3::Identity()) : support::frame_of(text, option);
    };
    if (settings.branches) throw support::UsageError("--frame base: not with --all-branches");
    if (in_place.tools.size() > 1) throw support::UsageError("--frame base: one --tool alone");
    settings.controller =
        ControllerFrames{frame_or_none(in_place.robot_base, "--robot-base"),
                         frame_or_none(in_place.flange, "--flange") *
                             frame_or_none(in_place.tools.empty() ? "" : in_place.tools.front(), "--tool")};
  }
  const vn::SavedModel model = vn::read_model(settings.model);
  const support::CorrectionReport report =
      support::dispatch_dof(model.dof(), [&](auto n) { return correct_arm<n()>(settings, model); });
  vn::write_file(settings.out, support::correction_csv(report, settings.units));

  const support::CorrectionTotals totals = support::totals(report);
  support::print_correction(report, totals);
  fmt::print("Commands: {}\n", support::shown(settings.out));
  if (!program.common().json.empty())
    support::write_json(program.common().json, support::correction_json(report, totals));
  const auto figure = std::filesystem::path(settings.out).replace_extension(".svg");
  if (figure != settings.out && support::has_room_beside(settings.out) && support::draw_correction(figure, report))
    fmt::print("Figure: {}\n", figure.string());
  if (const std::string failure = support::correction_failure(report, totals, support::shown(settings.out));
      !failure.empty())
    throw std::runtime_error(failure);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "correct",
      "Corrects targets or a robot program with a calibrated model, so that the real tool reaches them.",
      {"correct --model model.json --targets targets.csv --linear --out commands.csv",
       "correct --model model.json --program main.mod --out corrected.mod"},
      "every target is corrected",
      "not done, or a target is not met; one line on standard error says why"};
  return support::run_program(about, argc, argv, run);
}
