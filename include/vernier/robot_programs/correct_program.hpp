// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A robot program corrected: new values for its literal targets, with which the real arm goes where the program means.

#include <concepts>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "vernier/compensation/concepts.hpp"
#include "vernier/core/check.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"
#include "vernier/robot_programs/corrected_program.hpp"
#include "vernier/robot_programs/detail/target_correction.hpp"

namespace vernier {

/// A calibrated arm of six joints whose programs can be corrected: `CalibratedRobot<6>`, or a type of one's own.
///
/// - `nominal()`: the arm as designed, a `DhChain` or one between frames, in the frames of the calibration
/// - `limits()`: of its commands, in joints of the controller
/// - `controller()`, if it has one: the `ControllerMap` by which the chain's joints follow from those of the controller
/// - `correct(target, seed, previous)`: the command that brings the arm to a pose in these frames, near the joint
///   values `seed`; it comes from the command `previous`, which is not finite where unknown
template <class R>
concept CalibratedArm = R::dof == 6 && requires(const R& robot, const Isometry3& target, const JointVector<6>& q) {
  requires NominalArm<std::remove_cvref_t<decltype(robot.nominal())>>;
  { robot.limits() } -> std::convertible_to<JointLimits<6>>;
  { robot.correct(target, q, q) } -> std::same_as<Correction<6>>;
};

/// The kinematics by which a controller reaches poses: a `DhChain`, one between frames, or a model with such a
/// `nominal()`, as a `CalibratedRobot<6>` is.
template <class M>
concept ControllerModel = KinematicModel<M> && M::dof == 6 && NominalArm<NominalOf<M>>;

namespace detail {

/// The joint values of an arm at a pose.
/// @throws std::invalid_argument with the reason for an arm without closed form
template <NominalArm Arm>
ClosedForm<6> program_roots(const Arm& nominal) {
  for (int j = 0; j < 6; ++j)
    demand(in_frames(nominal).model().row(j).joint == JointType::revolute, "joint ", j + 1,
           " is prismatic; programs are corrected for revolute joints");
  try {
    return ClosedForm<6>(nominal);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(message("programs are corrected for arms with a closed form: ", e.what()));
  }
}

/// @param controller model by which the controller reaches poses
/// @param its        the controller's nominal arm, in the frames of that model
/// @param poses      whether this is how the controller reaches poses; else those are refused
template <class Robot, class Controller, class Nominal>
CorrectedProgram correct_program(const RobotProgram& program, const Robot& robot, const Controller& controller,
                                 const Nominal& its, bool poses, const ProgramOptions& options) {
  const JointChange<6> change = [&] {
    if constexpr (requires { JointChange<6>(robot.controller()); }) return JointChange<6>(robot.controller());
    return JointChange<6>();
  }();
  const RootsInControllerJoints<ClosedForm<6>> roots(program_roots(its), change);
  const InControllerJoints<Controller> shown(controller, change);
  const auto frames = in_frames(its);
  const auto nominal = in_frames(robot.nominal());
  const JointLimits<6> limits = robot.limits();
  const ControllerArm arm = options.arm.value_or(ControllerArm{});
  const Isometry3 from_base = frames.base().inverse(), to_flange = frames.tool().inverse();
  const auto pose = [&](const JointVector<6>& q) { return Isometry3(from_base * shown.pose(q) * to_flange); };
  const auto joints = [&](const Isometry3& at, const std::vector<int>& configuration, const JointVector<6>& close_to) {
    return controller_joints(roots, shown, limits, program.language, arm, frames.base() * at * frames.tool(),
                             configuration, close_to);
  };
  const auto correct = [&](const Isometry3& at, const JointVector<6>& q, const JointVector<6>& previous) {
    Correction<6> out =
        robot.correct(Isometry3(nominal.base() * at * nominal.tool()), change.to_chain(q), change.to_chain(previous));
    out.command = change.to_controller(out.command);
    return out;
  };
  const auto branch = [&](const JointVector<6>& q) { return roots.distances(q).branch(); };
  return correct_targets(program, {pose, joints, correct, branch, poses, !change.same()}, options);
}

}  // namespace detail

/// Corrects a robot program for a controller that computes with the nominal arm. For each literal target it finds the
/// joint values to which the controller would move, and the command that brings the calibrated arm there. The new
/// target is the pose for which the controller sends that command. A target of joint values means the pose that the
/// controller shows there. Poses of URScript stay, because Universal Robots' controllers reach them by a factory
/// calibration; the overload with a controller corrects them.
///
/// A target that cannot be corrected is listed with the reason and stays as it is. Linear moves are corrected at their
/// ends alone.
///
///     const std::string text = read_file("part.mod");
///     const RobotProgram program = parse_program(program_language("part.mod"), text, "part.mod");
///     const CorrectedProgram corrected = correct_program(program, load<6>("model.json"));
///     write_file("corrected.mod", replace_targets(text, program, corrected.replaced()));
///
/// @param program as parsed
/// @param robot   the calibrated arm
/// @param options frames, approach
/// @throws std::invalid_argument for an arm with a prismatic joint or without closed form, frames that are no rigid
/// motions, and a Fanuc program with poses where `ProgramOptions::arm` is missing
/// @complexity    about 20 us a target
template <CalibratedArm Robot>
[[nodiscard]] CorrectedProgram correct_program(const RobotProgram& program, const Robot& robot,
                                               const ProgramOptions& options = {}) {
  const auto chain = in_frames(robot.nominal()).model();
  return detail::correct_program(program, robot, chain, chain, program.language != ProgramLanguage::urscript, options);
}

/// Corrects a robot program, in any language, for a controller that computes with kinematics of its own. That is a
/// factory calibration, as `read_ur_calibration` returns it, or another calibrated arm.
/// @param program    as parsed
/// @param robot      the calibrated arm
/// @param controller model by which the controller reaches poses: one with `nominal()`, in the frames of that, or a
///                   chain close to the nominal one of the robot
/// @param options    frames, approach
/// @throws std::invalid_argument for arms with a prismatic joint or without closed form, frames that are no rigid
/// motions, and a Fanuc program with poses where `ProgramOptions::arm` is missing
template <CalibratedArm Robot, ControllerModel Controller>
[[nodiscard]] CorrectedProgram correct_program(const RobotProgram& program, const Robot& robot,
                                               const Controller& controller, const ProgramOptions& options = {}) {
  const auto chain = in_frames(robot.nominal()).model();
  static_cast<void>(detail::program_roots(chain));
  if constexpr (requires { controller.nominal(); }) {
    return detail::correct_program(program, robot, controller, controller.nominal(), true, options);
  } else if constexpr (requires { controller.model(); }) {
    return detail::correct_program(program, robot, controller, controller.around(chain), true, options);
  } else {
    return detail::correct_program(program, robot, controller, chain, true, options);
  }
}

}  // namespace vernier
