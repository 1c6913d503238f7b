#include "program_correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "json_file.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/core/version.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/ur_calibration.hpp"
#include "vernier/robot_programs/configuration.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace support {
namespace {

namespace vn = vernier;

using Joints = vn::JointVector<6>;

/// x,y,z in mm and a rotation vector in degrees.
/// @throws UsageError naming the option
vn::Isometry3 frame_of(const std::string& text, const char* option) {
  vn::Vector6 values;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (vn::Index k = 0; k < 6; ++k) {
    while (at != end && *at == ' ') ++at;
    const auto [next, error] = std::from_chars(at, end, values(k));
    const bool last = k == 5;
    if (error != std::errc() || !std::isfinite(values(k)) || (last ? next != end : next == end || *next != ','))
      throw UsageError(fmt::format("{} {}: not six numbers x,y,z,rx,ry,rz [mm, deg]", option, text));
    at = last ? next : next + 1;
  }
  vn::Isometry3 out = vn::Isometry3::Identity();
  out.translation() = values.head<3>() * 1e-3;
  out.linear() = vn::exp_so3(vn::Vector3(values.tail<3>() * std::numbers::pi / 180));
  return out;
}

std::string lower_case(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// The frames of tools, or of work objects: those of the file, and those of the command line.
class Frames {
 public:
  Frames(const std::map<std::string, vn::Isometry3>& of_file, const std::vector<std::string>& given, const char* option)
      : frames_(of_file) {
    for (const std::string& text : given) {
      const std::size_t equals = text.find('=');
      if (equals != std::string::npos) {
        frames_[lower_case(text.substr(0, equals))] = frame_of(text.substr(equals + 1), option);
      } else if (const auto named = frames_.find(lower_case(text)); named != frames_.end()) {
        others_ = named->second;
      } else {
        others_ = frame_of(text, option);
      }
    }
  }

  /// The frame of this name; null where it is unknown.
  const vn::Isometry3* find(const std::string& name) const {
    if (const auto named = frames_.find(name); named != frames_.end()) return &named->second;
    return others_ ? &*others_ : nullptr;
  }

 private:
  std::map<std::string, vn::Isometry3> frames_;
  std::optional<vn::Isometry3> others_{};
};

/// What became of the targets.
struct Outcome {
  std::vector<vn::ReplacedTarget> replaced{};
  std::vector<vn::Uncorrected> uncorrected{};
  std::vector<std::pair<std::size_t, std::string>> remarks{};  ///< by line
  vn::JointRows<6> commands{};
  double mean = 0, largest = 0;      ///< correction of the flange [m]
  double error = 0;                  ///< largest error that the model predicts [m]
  int extrapolated = 0, linear = 0;  ///< targets outside the measured joint ranges; linear moves
};

/// Everything that all targets have in common.
template <class Controller>
struct Task {
  const vn::RobotProgram& program;
  const vn::CalibratedRobot<6>& robot;
  const vn::ClosedForm<6>& roots;  ///< of the nominal arm, in the frames of the controller's model
  const Controller& controller;
  vn::Isometry3 base, tool;  ///< frames of the controller's model around its chain
  vn::Isometry3 robot_base, flange;
  Frames tools, workobjects;
  vn::ControllerArm arm;
  Joints start;
  bool approach, poses;
};

/// Corrects every target of a program.
template <class Controller>
Outcome correct_targets(const Task<Controller>& task) {
  const auto& targets = task.program.targets;
  Outcome out;
  out.uncorrected = task.program.uncorrected;
  std::vector<Joints> stands(targets.size(), task.start), commands(targets.size(), Joints::Constant(std::nan("")));
  for (Joints& q : stands) q.setConstant(std::nan(""));
  const Joints unknown = Joints::Constant(std::nan(""));
  std::vector<Joints> rows;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const vn::ProgramTarget& target = targets[k];
    const auto refuse = [&](const std::string& reason) {
      out.uncorrected.push_back({target.line, target.name.empty() ? "target" : target.name, reason});
    };
    const bool pose = target.kind == vn::TargetKind::pose;
    const vn::Isometry3 *tool = nullptr, *workobject = nullptr;
    Joints q = target.joints;
    vn::Isometry3 wanted;  // of the chain's last frame in its first
    if (pose) {
      if (!task.poses) {
        refuse("poses are reached by the robot's factory calibration; name it with --controller");
        continue;
      }
      tool = task.tools.find(target.tool);
      workobject = task.workobjects.find(target.workobject);
      if (tool == nullptr || workobject == nullptr) {
        const std::string& name = tool == nullptr ? target.tool : target.workobject;
        refuse(fmt::format("the frame of its {}{} is not known; name it with --{}",
                           tool == nullptr ? "tool" : "work object", name.empty() || name == "?" ? "" : " " + name,
                           tool == nullptr ? "tool" : "workobject"));
        continue;
      }
      wanted = task.robot_base * *workobject * target.pose * tool->inverse() * task.flange.inverse();
      Joints near = target.joints;
      if (!near.allFinite() && target.previous) near = stands[*target.previous];
      if (!near.allFinite() && k == 0) near = task.start;
      const vn::ControllerJoints found =
          vn::controller_joints(task.roots, task.controller, task.robot.limits(), task.program.language, task.arm,
                                task.base * wanted * task.tool, target.configuration, near);
      if (!found.joints) {
        refuse(found.reason);
        continue;
      }
      q = *found.joints;
    } else {
      wanted = task.base.inverse() * task.controller.pose(q) * task.tool.inverse();
    }
    stands[k] = q;
    const Joints& previous = task.approach && target.previous ? commands[*target.previous] : unknown;
    const vn::Isometry3 measured = task.robot.nominal().base() * wanted * task.robot.nominal().tool();
    const vn::Correction<6> corrected = task.robot.correct(measured, q, previous);
    if (corrected.status != vn::IkStatus::converged) {
      refuse(fmt::format("the calibrated arm does not reach it, by {:.2g} mm", corrected.predicted_error * 1e3));
      continue;
    }
    if (task.roots.distances(corrected.command).branch() != task.roots.distances(q).branch()) {
      refuse("so near to a singularity that its correction changes the configuration");
      continue;
    }
    const vn::Isometry3 reached = task.base.inverse() * task.controller.pose(corrected.command) * task.tool.inverse();
    vn::ReplacedTarget replaced{k, vn::Isometry3::Identity(), corrected.command};
    if (pose) {
      replaced.pose = workobject->inverse() * task.robot_base.inverse() * reached * task.flange * *tool;
      // Would the controller move there for what is written?
      const std::vector<int> configuration =
          vn::updated_configuration(task.program.language, target.configuration, corrected.command);
      const vn::ControllerJoints back =
          vn::controller_joints(task.roots, task.controller, task.robot.limits(), task.program.language, task.arm,
                                task.base * reached * task.tool, configuration, configuration.empty() ? q : unknown);
      if (!back.joints || (*back.joints - corrected.command).cwiseAbs().maxCoeff() > 1e-6) {
        refuse("its corrected pose has several joint values with its configuration");
        continue;
      }
      if (configuration != target.configuration)
        out.remarks.push_back({target.line,
                               "a joint passes the end of its quadrant or turn; its configuration is "
                               "changed"});
    }
    commands[k] = corrected.command;
    rows.push_back(corrected.command);
    const double moved = (reached.translation() - wanted.translation()).norm();
    out.mean += moved;
    out.largest = std::max(out.largest, moved);
    out.error = std::max(out.error, corrected.predicted_error);
    out.extrapolated += corrected.gate < 1 ? 1 : 0;
    out.linear += target.move == vn::TargetMove::linear ? 1 : 0;
    out.replaced.push_back(replaced);
  }
  out.mean /= std::max(1.0, static_cast<double>(out.replaced.size()));
  out.commands.resize(static_cast<vn::Index>(rows.size()), 6);
  for (std::size_t k = 0; k < rows.size(); ++k) out.commands.row(static_cast<vn::Index>(k)) = rows[k].transpose();
  std::vector<std::size_t> order(out.uncorrected.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(out.uncorrected[a].line, a) < std::pair(out.uncorrected[b].line, b);
  });
  std::vector<vn::Uncorrected> sorted;
  for (const std::size_t k : order) sorted.push_back(out.uncorrected[k]);
  out.uncorrected = std::move(sorted);
  return out;
}

/// Corrects for the controller that the options name.
Outcome correct_for_controller(const ProgramCorrection& options, const CorrectionInput& input,
                               const vn::RobotProgram& program, const vn::CalibratedRobot<6>& robot) {
  const auto& chain = robot.nominal().chain();
  std::optional<vn::ClosedForm<6>> roots;
  try {
    roots.emplace(chain);
  } catch (const std::invalid_argument& e) {
    throw std::runtime_error(
        fmt::format("{}: programs are corrected for arms with a closed form: {}", input.model, e.what()));
  }
  Joints start = Joints::Constant(std::nan(""));
  if (!input.start.empty()) {
    if (input.start.size() != 6) throw UsageError("--start needs 6 values");
    start = Eigen::Map<const Joints>(input.start.data());
  }
  const bool any_pose = std::any_of(program.targets.begin(), program.targets.end(),
                                    [](const auto& target) { return target.kind == vn::TargetKind::pose; });
  vn::ControllerArm arm;
  if (program.language == vn::ProgramLanguage::fanuc_tp) {
    if (options.noflip.empty() && any_pose)
      throw UsageError("a Fanuc program needs --noflip: the sign of J5 at a position with N");
    arm.negative_noflip = options.noflip != "positive";
  }
  const vn::Isometry3 identity = vn::Isometry3::Identity();
  const vn::Isometry3 robot_base = options.robot_base.empty() ? identity : frame_of(options.robot_base, "--robot-base");
  const vn::Isometry3 flange = options.flange.empty() ? identity : frame_of(options.flange, "--flange");
  const bool poses = program.language != vn::ProgramLanguage::urscript || !options.controller.empty();
  const auto correct = [&](const auto& controller, const vn::ClosedForm<6>& its_roots, const vn::Isometry3& base,
                           const vn::Isometry3& tool) {
    using Controller = std::remove_cvref_t<decltype(controller)>;
    return correct_targets(Task<Controller>{program, robot, its_roots, controller, base, tool, robot_base, flange,
                                            Frames(program.tools, options.tools, "--tool"),
                                            Frames(program.workobjects, options.workobjects, "--workobject"), arm,
                                            start, input.approach, poses});
  };
  if (options.controller.empty() || options.controller == "nominal") return correct(chain, *roots, identity, identity);
  if (lower_case(options.controller).ends_with(".conf")) {
    vn::RobotDescription nominal{.name = robot.name()};
    for (int i = 0; i < 6; ++i) {
      nominal.rows.push_back(chain.row(i));
      nominal.limits.emplace_back(robot.limits().lower(i), robot.limits().upper(i));
    }
    const vn::RobotDescription calibrated = vn::read_ur_calibration(options.controller, nominal);
    return correct(calibrated.arm<6>().arm.model(), *roots, identity, identity);
  }
  if (const int dof = vn::saved_arm(options.controller).dof; dof != 6)
    throw std::runtime_error(fmt::format("{}: an arm of {} joints", options.controller, dof));
  const vn::CalibratedRobot<6> controller = vn::load<6>(options.controller);
  return correct(controller, vn::ClosedForm<6>(controller.nominal()), controller.nominal().base(),
                 controller.nominal().tool());
}

}  // namespace

void add_program_options(Program& program, ProgramCorrection& to) {
  program.add_option(
      "--program", to.program,
      "robot program whose literal targets are corrected in place: RAPID (.mod, .prg), KRL (.src, .dat), URScript "
      "(.script), Fanuc (.ls)",
      "FILE");
  program.add_option(
      "--controller", to.controller,
      "kinematics by which the controller reaches the poses of a program: nominal, a model, or calibration.conf of a "
      "Universal Robots arm; by default nominal, and URScript poses stay as they are",
      "nominal|FILE");
  program
      .add_option("--tool", to.tools,
                  "tool frame of a program's poses, in the flange's: position [mm] and rotation vector [deg], or the "
                  "name of one "
                  "in the file; NAME=... gives that of one name or number",
                  "[NAME=]X,Y,Z,RX,RY,RZ")
      .one_value_each();
  program
      .add_option("--workobject", to.workobjects,
                  "likewise the frame in which the poses are, in the robot's base frame", "[NAME=]X,Y,Z,RX,RY,RZ")
      .one_value_each();
  program.add_option("--robot-base", to.robot_base,
                     "the controller's base frame in that of the model's chain, where they differ (KUKA, Fanuc)",
                     "X,Y,Z,RX,RY,RZ");
  program.add_option("--flange", to.flange,
                     "the controller's flange frame in the last one of the model's chain, where they differ",
                     "X,Y,Z,RX,RY,RZ");
  program
      .add_option("--noflip", to.noflip, "Fanuc: sign of J5 at a position whose configuration has N",
                  "negative|positive")
      .one_of({"negative", "positive"});
  program.add_option("--date", to.date, "date written into the corrected program; by default today's", "DATE");
  program.add_flag("--allow-uncorrected", to.allow_uncorrected,
                   "write the program although some of its targets cannot be corrected and stay as they are");
}

int correct_program(const ProgramCorrection& options, const CorrectionInput& input) {
  const vn::ProgramLanguage language = vn::program_language(options.program);
  std::string text;
  try {
    text = vn::read_file(options.program);
  } catch (const std::invalid_argument& e) {
    throw vn::DataError(e.what());
  }
  const vn::RobotProgram program = vn::parse_program(language, text, options.program);
  if (const int dof = vn::saved_arm(input.model).dof; dof != 6)
    throw std::runtime_error(
        fmt::format("{}: an arm of {} joints; programs are corrected for arms of 6", input.model, dof));
  const vn::CalibratedRobot<6> saved = vn::load<6>(input.model);
  const vn::CalibratedRobot<6> robot = input.temperature ? saved.at_temperature(*input.temperature) : saved;
  for (int j = 0; j < 6; ++j)
    if (robot.nominal().chain().row(j).joint != vn::JointType::revolute)
      throw std::runtime_error(
          fmt::format("{}: joint {} is prismatic; programs are corrected for revolute joints", input.model, j + 1));

  const Outcome outcome = correct_for_controller(options, input, program, robot);
  double radius = std::nan("");
  if (saved.estimate() != nullptr)
    for (const double r : robot.radii_95(outcome.commands)) radius = std::isfinite(radius) ? std::max(radius, r) : r;

  fmt::print("{}: {} targets corrected, by {:.2g} mm (mean), {:.2g} mm (largest)\n", options.program,
             outcome.replaced.size(), outcome.mean * 1e3, outcome.largest * 1e3);
  if (std::isfinite(radius))
    fmt::print("The model expects errors below {:.2g} mm at 95 % of visits (target with the largest)\n", radius * 1e3);
  if (outcome.extrapolated > 0)
    fmt::print("{} of them lie outside the measured joint ranges, where the learned part fades out\n",
               outcome.extrapolated);
  if (outcome.linear > 0)
    fmt::print("{} end linear moves, which are corrected at their ends alone; --targets inserts points\n",
               outcome.linear);
  for (const auto& [line, remark] : outcome.remarks) fmt::print("line {}: {}\n", line, remark);
  for (const vn::Uncorrected& one : outcome.uncorrected)
    fmt::print("line {}: not corrected: {}: {}\n", one.line, one.text, one.reason);

  if (!input.json.empty()) {
    nlohmann::ordered_json json{{"program", options.program},
                                {"robot", robot.name()},
                                {"corrected", outcome.replaced.size()},
                                {"correction", {{"mean_mm", outcome.mean * 1e3}, {"max_mm", outcome.largest * 1e3}}},
                                {"predicted_error", {{"max_mm", outcome.error * 1e3}}},
                                {"extrapolated", outcome.extrapolated},
                                {"uncorrected", nlohmann::ordered_json::array()}};
    for (const vn::Uncorrected& one : outcome.uncorrected)
      json["uncorrected"].push_back({{"line", one.line}, {"text", one.text}, {"reason", one.reason}});
    write_json(input.json, json);
  }
  if (!outcome.uncorrected.empty() && !options.allow_uncorrected)
    throw std::runtime_error(
        fmt::format("{}: {} of its targets or moves {} not corrected, the first in line {}; with "
                    "--allow-uncorrected it is written all the same",
                    options.program, outcome.uncorrected.size(), outcome.uncorrected.size() == 1 ? "is" : "are",
                    outcome.uncorrected.front().line));

  const std::string hash = vn::sha256(vn::read_file(input.model));
  std::vector<std::string> stamp{"do not correct this program twice",
                                 fmt::format("model {}", std::filesystem::path(input.model).filename().string()),
                                 fmt::format("sha256 {}", hash),
                                 fmt::format("robot {}, {} targets", robot.name(), outcome.replaced.size()),
                                 fmt::format("{} by Vernier {}.{}.{}", options.date.empty() ? today() : options.date,
                                             VERNIER_VERSION_MAJOR, VERNIER_VERSION_MINOR, VERNIER_VERSION_PATCH)};
  if (const double error = saved.provenance().held_out_error; error > 0)
    stamp.push_back(fmt::format("held-out error {:.3f} mm (mean)", error * 1e3));
  if (std::isfinite(radius)) stamp.push_back(fmt::format("errors < {:.3f} mm (95 %)", radius * 1e3));
  if (!outcome.uncorrected.empty()) stamp.push_back(fmt::format("{} not corrected", outcome.uncorrected.size()));
  vn::write_file(input.out, vn::stamped(vn::replace_targets(text, program, outcome.replaced), program, stamp));
  fmt::print("Program: {}\n", input.out);
  return 0;
}

}  // namespace support
