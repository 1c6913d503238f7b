// SPDX-License-Identifier: BSD-3-Clause
#include "program_correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "file_name.hpp"
#include "json_file.hpp"
#include "model_instances.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/core/version.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/ur_calibration.hpp"
#include "vernier/robot_programs/correct_program.hpp"

namespace support {
namespace {

namespace vn = vernier;

std::string lower_case(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// The frames of tools, or of work objects, that the command line states.
/// @param of_file those of the program, which the command line may name
/// @throws UsageError naming the option
vn::ProgramFrames frames_of(const std::vector<std::string>& given, const std::map<std::string, vn::Isometry3>& of_file,
                            const char* option) {
  vn::ProgramFrames out;
  for (const std::string& text : given) {
    const std::size_t equals = text.find('=');
    if (equals != std::string::npos) {
      out.by_name[lower_case(text.substr(0, equals))] = frame_of(text.substr(equals + 1), option);
    } else if (const auto named = out.by_name.find(lower_case(text)); named != out.by_name.end()) {
      out.others = named->second;
    } else if (const auto stated = of_file.find(lower_case(text)); stated != of_file.end()) {
      out.others = stated->second;
    } else {
      out.others = frame_of(text, option);
    }
  }
  return out;
}

/// What the command line says, for the library.
/// @throws UsageError for options that do not fit the program
vn::ProgramOptions program_options(const ProgramCorrection& options, const CorrectionInput& input,
                                   const vn::RobotProgram& program) {
  vn::ProgramOptions out{.approach = input.approach};
  if (!input.start.empty()) {
    if (input.start.size() != 6) throw UsageError("--start needs 6 values");
    out.start = Eigen::Map<const vn::JointVector<6>>(input.start.data());
  }
  if (program.language == vn::ProgramLanguage::fanuc_tp) {
    const bool any_pose = std::any_of(program.targets.begin(), program.targets.end(),
                                      [](const auto& target) { return target.kind == vn::TargetKind::pose; });
    if (options.noflip.empty() && any_pose)
      throw UsageError("a Fanuc program needs --noflip: the sign of J5 at a position with N");
    out.arm = vn::ControllerArm{.negative_noflip = options.noflip != "positive"};
  }
  if (!options.robot_base.empty()) out.robot_base = frame_of(options.robot_base, "--robot-base");
  if (!options.flange.empty()) out.flange = frame_of(options.flange, "--flange");
  out.tools = frames_of(options.tools, program.tools, "--tool");
  out.workobjects = frames_of(options.workobjects, program.workobjects, "--workobject");
  return out;
}

/// Corrects for the controller that the command line names.
/// @param model file of the robot, for messages
vn::CorrectedProgram correct_for_controller(const std::string& named, const std::string& model,
                                            const vn::RobotProgram& program, const vn::CalibratedRobot<6>& robot,
                                            const vn::ProgramOptions& options) {
  const auto correct = [&](const auto&... controller) {
    try {
      return vn::correct_program(program, robot, controller..., options);
    } catch (const std::invalid_argument& e) {  // the geometry of the arm
      throw std::runtime_error(fmt::format("{}: {}", model, e.what()));
    }
  };
  if (named.empty()) return correct();
  const auto& chain = robot.nominal().chain();
  if (named == "nominal") return correct(chain);
  if (lower_case(named).ends_with(".conf")) {
    vn::RobotDescription nominal{.name = robot.name()};
    for (int i = 0; i < 6; ++i) {
      nominal.rows.push_back(chain.row(i));
      nominal.limits.emplace_back(robot.limits().lower(i), robot.limits().upper(i));
    }
    nominal.controller = robot.controller();
    return correct(vn::read_ur_calibration(named, nominal).arm<6>().arm.model());
  }
  const vn::SavedModel its = vn::read_model(named);
  if (its.dof() != 6) throw std::runtime_error(fmt::format("{}: an arm of {} joints", named, its.dof()));
  return correct(its.as<6>());
}

/// The option that gives a target what it lacks, as the end of a sentence.
const char* remedy(vn::MissingInput missing) {
  switch (missing) {
    case vn::MissingInput::controller: return "; name it with --controller";
    case vn::MissingInput::tool: return "; name it with --tool";
    case vn::MissingInput::workobject: return "; name it with --workobject";
    case vn::MissingInput::controller_joints: return "; its robot file states the controller's joints";
    case vn::MissingInput::effect: return "; if nothing, name it with --assume-harmless";
    default: return "";
  }
}

/// Whether a text has a name, in letters of either case.
bool names(const std::string& text, const std::string& name) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return !name.empty() && std::search(text.begin(), text.end(), name.begin(), name.end(), same) != text.end();
}

}  // namespace

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

void add_program_options(Program& program, ProgramCorrection& to) {
  const Option of_program = program.add_option(
      "--program", to.program,
      "robot program whose literal targets are corrected in place: RAPID (.mod, .prg), KRL (.src, .dat), URScript "
      "(.script), Fanuc (.ls)",
      "FILE");
  program
      .add_option("--controller", to.controller,
                  "kinematics by which the controller reaches the poses of a program: nominal, a model, or "
                  "calibration.conf of a "
                  "Universal Robots arm; by default nominal, and URScript poses stay as they are",
                  "nominal|FILE")
      .needs(of_program);
  program
      .add_option(
          "--tool", to.tools,
          "tool frame of a program's poses, or of those of --frame base, in the flange's: position [mm] and rotation "
          "vector [deg], or the name of one in the program; NAME=... gives that of one name or number",
          "[NAME=]X,Y,Z,RX,RY,RZ")
      .one_value_each();
  program
      .add_option("--workobject", to.workobjects,
                  "frame in which a program's poses are, in the robot's base frame; written as that of --tool",
                  "[NAME=]X,Y,Z,RX,RY,RZ")
      .one_value_each()
      .needs(of_program);
  program.add_option("--robot-base", to.robot_base,
                     "the controller's base frame in that of the model's chain, where they differ (KUKA, Fanuc)",
                     "X,Y,Z,RX,RY,RZ");
  program.add_option("--flange", to.flange,
                     "the controller's flange frame in the last one of the model's chain, where they differ",
                     "X,Y,Z,RX,RY,RZ");
  program
      .add_option("--noflip", to.noflip, "Fanuc: sign of J5 at a position whose configuration has N",
                  "negative|positive")
      .one_of({"negative", "positive"})
      .needs(of_program);
  program
      .add_option("--assume-harmless", to.assume_harmless,
                  "statement, or routine of another file, that changes no tool, work object or configuration; may be "
                  "given several times",
                  "NAME")
      .one_value_each()
      .needs(of_program);
  program.group(Group::output);
  program.add_option("--date", to.date, "date written into the corrected program; by default today's", "DATE")
      .needs(of_program);
  program
      .add_flag("--allow-uncorrected", to.allow_uncorrected,
                "write the program although some of its targets cannot be corrected and stay as they are")
      .needs(of_program);
}

int correct_program(const ProgramCorrection& options, const CorrectionInput& input) {
  const vn::ProgramLanguage language = vn::program_language(options.program);
  std::string text;
  try {
    text = vn::read_file(options.program);
  } catch (const std::invalid_argument& e) {
    throw vn::DataError(e.what());
  }
  for (const std::string& name : options.assume_harmless)
    if (!names(text, name))
      throw UsageError(fmt::format("--assume-harmless '{}': {} does not name it", name, options.program));
  const vn::RobotProgram program = vn::parse_program(language, text, options.program, options.assume_harmless);
  const vn::SavedModel model = vn::read_model(input.model);
  if (model.dof() != 6)
    throw std::runtime_error(
        fmt::format("{}: an arm of {} joints; programs are corrected for arms of 6", input.model, model.dof()));
  const vn::CalibratedRobot<6> saved = model.as<6>();
  const vn::CalibratedRobot<6> robot =
      carrying(input.temperature ? saved.at_temperature(*input.temperature) : saved, input.payload);
  vn::CorrectedProgram outcome =
      correct_for_controller(options.controller, input.model, program, robot, program_options(options, input, program));
  for (vn::Uncorrected& one : outcome.uncorrected) one.reason += remedy(one.missing);
  double radius = std::nan("");
  if (saved.estimate() != nullptr)
    for (const double r : robot.radii_95(robot.controller().to_chain(outcome.commands())))
      radius = std::isfinite(radius) ? std::max(radius, r) : r;

  fmt::print("{}: {} targets corrected, by {:.2g} mm (mean), {:.2g} mm (largest)\n", options.program,
             outcome.targets.size(), outcome.mean_correction() * 1e3, outcome.largest_correction() * 1e3);
  if (std::isfinite(radius))
    fmt::print("The model expects errors below {:.2g} mm at 95 % of visits (target with the largest)\n", radius * 1e3);
  if (outcome.extrapolated() > 0)
    fmt::print("{} of them lie outside the measured joint ranges, where the learned part fades out\n",
               outcome.extrapolated());
  const auto of_program = [&](const vn::CorrectedTarget& target) -> const vn::ProgramTarget& {
    return program.targets[target.replaced.target];
  };
  const auto linear = std::count_if(outcome.targets.begin(), outcome.targets.end(), [&](const auto& target) {
    return of_program(target).move == vn::TargetMove::linear;
  });
  if (linear > 0)
    fmt::print("{} end linear moves, which are corrected at their ends alone; --targets inserts points\n", linear);
  for (const vn::CorrectedTarget& target : outcome.targets)
    if (target.reconfigured)
      fmt::print("line {}: a joint passes the end of its quadrant or turn; its configuration is changed\n",
                 of_program(target).line);
  for (const vn::Uncorrected& one : outcome.uncorrected)
    fmt::print("line {}: not corrected: {}: {}\n", one.line, one.text, one.reason);

  if (!input.json.empty()) {
    nlohmann::ordered_json json{
        {"program", options.program},
        {"robot", robot.name()},
        {"corrected", outcome.targets.size()},
        {"correction", {{"mean_mm", outcome.mean_correction() * 1e3}, {"max_mm", outcome.largest_correction() * 1e3}}},
        {"predicted_error", {{"max_mm", outcome.largest_predicted_error() * 1e3}}},
        {"extrapolated", outcome.extrapolated()},
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

  std::vector<std::string> stamp{"do not correct this program twice", fmt::format("model {}", file_name(input.model)),
                                 fmt::format("sha256 {}", model.hash()),
                                 fmt::format("robot {}, {} targets", robot.name(), outcome.targets.size()),
                                 fmt::format("{} by Vernier {}.{}.{}", options.date.empty() ? today() : options.date,
                                             VERNIER_VERSION_MAJOR, VERNIER_VERSION_MINOR, VERNIER_VERSION_PATCH)};
  if (const double error = saved.provenance().held_out_error; error > 0)
    stamp.push_back(fmt::format("held-out error {:.3f} mm (mean)", error * 1e3));
  if (std::isfinite(radius)) stamp.push_back(fmt::format("errors < {:.3f} mm (95 %)", radius * 1e3));
  if (!outcome.uncorrected.empty()) stamp.push_back(fmt::format("{} not corrected", outcome.uncorrected.size()));
  const std::string corrected = vn::replace_targets(text, program, outcome.replaced());
  vn::write_file(input.out, outcome.targets.empty() ? corrected : vn::stamped(corrected, program, stamp));
  fmt::print("Program: {}\n", shown(input.out));
  return 0;
}

}  // namespace support
