// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/detail/branch_refinement.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/target_correction.hpp"

namespace vernier::detail {

/// The frames that a program states, with those of the options in their place and beside them.
/// @param kind of the frames, for messages
/// @throws std::invalid_argument naming a frame that is no rigid motion
VERNIER_LOCAL ProgramFrames known_frames(const std::map<std::string, Isometry3>& stated, const ProgramFrames& given,
                                         std::string_view kind);

VERNIER_IMPL ProgramFrames known_frames(const std::map<std::string, Isometry3>& stated, const ProgramFrames& given,
                                        std::string_view kind) {
  ProgramFrames out{stated, given.others};
  demand(!given.others || is_pose(*given.others), "correct_program: a frame of ", kind, "s is no rigid motion");
  for (const auto& [name, frame] : given.by_name) {
    demand(is_pose(frame), "correct_program: the frame of the ", kind, " ", name, " is no rigid motion");
    out.by_name[lower_case(name)] = frame;
  }
  return out;
}

/// The frame of this name; null where it is unknown.
VERNIER_LOCAL const Isometry3* frame_named(const ProgramFrames& frames, const std::string& name);

VERNIER_IMPL const Isometry3* frame_named(const ProgramFrames& frames, const std::string& name) {
  if (const auto named = frames.by_name.find(name); named != frames.by_name.end()) return &named->second;
  return frames.others ? &*frames.others : nullptr;
}

/// A length [m] in mm, with two significant digits.
VERNIER_LOCAL std::string rounded_mm(double length);

VERNIER_IMPL std::string rounded_mm(double length) { return significant_digits(length * 1e3, 2); }

/// Corrects the targets of a program one after another.
class TargetCorrection {
 public:
  /// @param program  its targets
  /// @param arm      the controller and the calibrated arm
  /// @param options  checked
  /// @param tools    all frames of tools that are known
  /// @param objects  all frames of work objects that are known
  TargetCorrection(const RobotProgram& program, const ProgramArm& arm, const ProgramOptions& options,
                   const ProgramFrames& tools, const ProgramFrames& objects)
      : program_(program),
        arm_(arm),
        options_(options),
        tools_(tools),
        objects_(objects),
        stands_(program.targets.size(), unknown()),
        commands_(program.targets.size(), unknown()) {}

  VERNIER_LOCAL CorrectedProgram run();

 private:
  /// Frames around the pose of a target.
  struct Frames {
    const Isometry3 *tool = nullptr, *object = nullptr;
  };

  static JointVector<6> unknown() { return JointVector<6>::Constant(std::numeric_limits<double>::quiet_NaN()); }

  void refuse(const ProgramTarget& target, std::string reason, MissingInput missing = MissingInput::none) {
    out_.uncorrected.push_back({target.line, target.name.empty() ? "target" : target.name, std::move(reason), missing});
  }

  VERNIER_LOCAL bool find_frames(const ProgramTarget& target, Frames& frames);
  VERNIER_LOCAL JointVector<6> joints_near(std::size_t k) const;
  VERNIER_LOCAL void correct(std::size_t k);

  const RobotProgram& program_;
  const ProgramArm& arm_;
  const ProgramOptions& options_;
  const ProgramFrames &tools_, &objects_;
  std::vector<JointVector<6>> stands_, commands_;  // of each target: as programmed, and corrected
  CorrectedProgram out_{};
};

/// The frames of a pose; false, and the target is refused, where one is unknown.
VERNIER_IMPL bool TargetCorrection::find_frames(const ProgramTarget& target, Frames& frames) {
  if (!arm_.poses) {
    refuse(target, "poses are reached by the robot's factory calibration", MissingInput::controller);
    return false;
  }
  frames = {frame_named(tools_, target.tool), frame_named(objects_, target.workobject)};
  if (frames.tool != nullptr && frames.object != nullptr) return true;
  const bool tool = frames.tool == nullptr;
  const std::string& name = tool ? target.tool : target.workobject;
  refuse(target,
         message("the frame of its ", tool ? "tool" : "work object", name.empty() || name == "?" ? "" : " " + name,
                 " is not known"),
         tool ? MissingInput::tool : MissingInput::workobject);
  return false;
}

/// Joint values near those of a target: its own, else those before it.
VERNIER_IMPL JointVector<6> TargetCorrection::joints_near(std::size_t k) const {
  const ProgramTarget& target = program_.targets[k];
  JointVector<6> out = target.joints;
  if (!out.allFinite() && target.previous) out = stands_[*target.previous];
  if (!out.allFinite() && k == 0) out = options_.start;
  return out;
}

/// Corrects a target, or refuses it.
VERNIER_IMPL void TargetCorrection::correct(std::size_t k) {
  const ProgramTarget& target = program_.targets[k];
  const bool pose = target.kind == TargetKind::pose;
  Frames frames;
  JointVector<6> joints = target.joints;
  Isometry3 meant;
  if (pose) {
    if (!find_frames(target, frames)) return;
    meant = options_.robot_base * *frames.object * target.pose * frames.tool->inverse() * options_.flange.inverse();
    const ControllerJoints found = arm_.joints(meant, target.configuration, joints_near(k));
    if (!found.joints) return refuse(target, found.reason);
    joints = *found.joints;
  } else {
    if (program_.language == ProgramLanguage::fanuc_tp && !arm_.mapped)
      return refuse(target, "joint values, in which J2 and J3 depend on each other", MissingInput::controller_joints);
    meant = arm_.pose(joints);
  }
  stands_[k] = joints;
  const bool coming = options_.approach && target.previous;
  const Correction<6> corrected = arm_.correct(meant, joints, coming ? commands_[*target.previous] : unknown());
  if (corrected.status != IkStatus::converged)
    return refuse(target, "the calibrated arm does not reach it, by " + rounded_mm(corrected.predicted_error) + " mm");
  if (arm_.branch(corrected.command) != arm_.branch(joints))
    return refuse(target, "so near to a singularity that its correction changes the configuration");

  const Isometry3 reached = arm_.pose(corrected.command);
  CorrectedTarget out{{k, Isometry3::Identity(), corrected.command},
                      (translation(reached) - translation(meant)).norm(),
                      corrected.predicted_error,
                      corrected.gate,
                      false};
  if (pose) {
    out.replaced.pose =
        frames.object->inverse() * options_.robot_base.inverse() * reached * options_.flange * *frames.tool;
    // The controller must move there for the numbers that are written.
    const std::vector<int> configuration =
        updated_configuration(program_.language, target.configuration, corrected.command);
    const ControllerJoints back = arm_.joints(reached, configuration, configuration.empty() ? joints : unknown());
    if (!back.joints || (*back.joints - corrected.command).cwiseAbs().maxCoeff() > 1e-6)
      return refuse(target, "its corrected pose has several joint values with its configuration");
    out.reconfigured = configuration != target.configuration;
  }
  commands_[k] = corrected.command;
  out_.targets.push_back(out);
}

VERNIER_IMPL CorrectedProgram TargetCorrection::run() {
  out_.uncorrected = program_.uncorrected;
  for (std::size_t k = 0; k < program_.targets.size(); ++k) correct(k);
  sort_by_line(out_.uncorrected);
  return std::move(out_);
}

VERNIER_IMPL CorrectedProgram correct_targets(const RobotProgram& program, const ProgramArm& arm,
                                              const ProgramOptions& options) {
  demand(is_pose(options.robot_base), "correct_program: robot_base is no rigid motion");
  demand(is_pose(options.flange), "correct_program: flange is no rigid motion");
  if (program.language == ProgramLanguage::fanuc_tp && !options.arm)
    for (const ProgramTarget& target : program.targets)
      demand(target.kind != TargetKind::pose,
             "correct_program: a Fanuc program with poses needs ProgramOptions::arm, the sign of J5 at a position "
             "with N");
  const ProgramFrames tools = known_frames(program.tools, options.tools, "tool"),
                      objects = known_frames(program.workobjects, options.workobjects, "work object");
  return TargetCorrection(program, arm, options, tools, objects).run();
}

}  // namespace vernier::detail
