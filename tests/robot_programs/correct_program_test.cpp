// SPDX-License-Identifier: BSD-3-Clause
// Robot programs corrected by the library, for an arm of the test's own: a program of each language is written,
// corrected, parsed again and executed by the controller's kinematics, and the real arm must be where the program meant
// it to be.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "branch_helpers.hpp"
#include "complaint.hpp"
#include "replaced.hpp"
#include "vernier/compensation/compensated.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/robot_programs/correct_program.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"

namespace vernier::library_correct_program_test {
namespace {

using enum ProgramLanguage;
using Joints = JointVector<6>;
using Chain = DhChain<6>;

constexpr double degree = std::numbers::pi / 180;

Joints degrees(double a, double b, double c, double d, double e, double f) { return Joints{a, b, c, d, e, f} * degree; }

Isometry3 frame(double x, double y, double z, double rx, double ry, double rz) {
  return rigid_motion(exp_so3(Vector3(rx, ry, rz)), Vector3(x, y, z));
}

/// A calibrated arm without a library type: as designed and as made, between the same frames. Coming from somewhere,
/// its first joint stops short by 0.1 mrad.
class Arm {
 public:
  static constexpr int dof = 6;

  explicit Arm(const Robot<6>& robot, const Chain& made)
      : nominal_(robot.chain, frame(1, 2, 0.5, 0.1, 0.2, 1), frame(0.01, 0, 0.1, 0, 0.4, 0)),
        made_(nominal_.around(made)),
        limits_(robot.limits) {}

  const Framed<Chain>& nominal() const { return nominal_; }
  const Framed<Chain>& made() const { return made_; }
  const JointLimits<6>& limits() const { return limits_; }
  Correction<6> correct(const Isometry3& target, const Joints& seed, const Joints& previous) const {
    Correction<6> out = Compensated(made_, nominal_).within(limits_).correct(target, seed);
    if (previous.allFinite()) out.command(0) += out.command(0) > previous(0) ? 1e-4 : -1e-4;
    if (seed(0) < 0) out.gate = 0.5;
    return out;
  }

 private:
  Framed<Chain> nominal_, made_;
  JointLimits<6> limits_;
};
static_assert(CalibratedArm<Arm> && !CalibratedArm<Chain>);
static_assert(ControllerModel<Chain> && ControllerModel<Framed<Chain>>);

Arm arm_of(const Robot<6>& robot) {
  Rng rng(3);
  return Arm(robot, vernier_test::as_made(robot.chain, rng));
}

/// Joint values on several branches, away from singularities and from the ends of quadrants and turns.
std::vector<Joints> samples() {
  return {degrees(20, -40, 50, 30, 60, 40),    degrees(-70, 30, -60, -50, -50, 100),
          degrees(110, 20, 30, 100, 70, -130), degrees(-20, -50, 60, 70, -40, 20),
          degrees(40, 50, 20, -100, 50, -60),  degrees(70, -30, 40, -30, -70, -20)};
}

/// The configuration by which a controller goes from a pose to these joint values, found by trial.
std::vector<int> configuration_of(ProgramLanguage language, const Robot<6>& robot, const Joints& q) {
  const ClosedForm<6> roots(robot.chain);
  int turns = 0;
  for (int j = 0; j < 6; ++j) turns |= q(j) < 0 ? 1 << j : 0;
  const auto quadrant = [&](int j) { return static_cast<int>(std::floor(q(j) / degree / 90)); };
  for (int flags = 0; flags < 8; ++flags) {
    const std::vector<int> stated = language == rapid ? std::vector<int>{quadrant(0), quadrant(3), quadrant(5), flags}
                                    : language == krl
                                        ? std::vector<int>{flags, turns}
                                        : std::vector<int>{flags & 1, flags >> 1 & 1, flags >> 2 & 1, 0, 0, 0};
    const auto found = controller_joints(roots, robot.chain, robot.limits, language, {}, robot.chain.pose(q), stated,
                                         Joints::Constant(std::nan("")));
    if (found.joints && (*found.joints - q).norm() < 1e-6) return stated;
  }
  ADD_FAILURE() << "no configuration for " << q.transpose();
  return {};
}

/// Printed as `printf` does.
template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[500];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// A pose as a language writes it, without its brackets.
std::string pose_text(ProgramLanguage language, const Isometry3& pose, const std::vector<int>& c) {
  const Vector3 mm = 1e3 * translation(pose), turn = log_so3(rotation(pose)),
                zyx = detail::zyx_of_rotation(rotation(pose)) / degree;
  const Eigen::Quaterniond q(rotation(pose));
  switch (language) {
    case rapid:
      return format("[[%.6f,%.6f,%.6f],[%.9f,%.9f,%.9f,%.9f],[%d,%d,%d,%d],[9E9,9E9,9E9,9E9,9E9,9E9]]", mm(0), mm(1),
                    mm(2), q.w(), q.x(), q.y(), q.z(), c[0], c[1], c[2], c[3]);
    case krl:
      return format("{X %.6f,Y %.6f,Z %.6f,A %.7f,B %.7f,C %.7f,S %d,T %d}", mm(0), mm(1), mm(2), zyx(0), zyx(1),
                    zyx(2), c[0], c[1]);
    case urscript:
      return format("p[%.9f,%.9f,%.9f,%.9f,%.9f,%.9f]", 1e-3 * mm(0), 1e-3 * mm(1), 1e-3 * mm(2), turn(0), turn(1),
                    turn(2));
    default:
      return format("CONFIG : '%c %c %c, 0, 0, 0',\n X = %.6f mm, Y = %.6f mm, Z = %.6f mm,\n", c[0] != 0 ? 'F' : 'N',
                    c[1] != 0 ? 'U' : 'D', c[2] != 0 ? 'T' : 'B', mm(0), mm(1), mm(2)) +
             format(" W = %.7f deg, P = %.7f deg, R = %.7f deg", zyx(2), zyx(1), zyx(0));
  }
}

/// A program that moves a tool through joint values of a controller; its work object is the base.
std::string program_text(ProgramLanguage language, const Robot<6>& robot, const Chain& controller,
                         const Isometry3& tool, const std::vector<Joints>& joints) {
  std::string moves, points;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const std::vector<int> c = language == urscript ? std::vector<int>{} : configuration_of(language, robot, joints[k]);
    const std::string pose = pose_text(language, controller.pose(joints[k]) * tool, c);
    const auto n = static_cast<int>(k + 1);
    if (language == rapid) moves += "MoveL " + pose + ",v100,fine,gun;\n";
    if (language == krl)
      points += format("DECL E6POS XP%d=", n) + pose + format("\nDECL FDAT FP%d={TOOL_NO 3,BASE_NO 0}\n", n);
    if (language == urscript) {
      const Joints& q = joints[k];
      points += format("  global p%d=", n) + pose +
                format("\n  global q%d=[%.4f,%.4f,%.4f,%.4f,%.4f,%.4f]\n", n, q(0), q(1), q(2), q(3), q(4), q(5));
      moves += format("  movej(get_inverse_kin(p%d, qnear=q%d), a=1)\n", n, n);
    }
    if (language == fanuc_tp) {
      moves += format("%4d:L P[%d] 100mm/sec FINE ;\n", n, n);
      points += format("P[%d]{\n GP1:\n UF : 0, UT : 1, ", n) + pose + "\n};\n";
    }
  }
  switch (language) {
    case rapid: return "MODULE m\nPROC main()\n" + moves + "ENDPROC\nENDMODULE\n";
    case krl: return "DEFDAT m\n" + points + "ENDDAT\n";
    case urscript:
      return "def m():\n" + points + "  set_tcp(" + pose_text(urscript, tool, {}) + ")\n" + moves + "end\n";
    default: return "/PROG M\n/MN\n" + moves + "/POS\n" + points + "/END\n";
  }
}

/// Joint values to which a controller goes for each pose of a program.
std::vector<Joints> executed(const RobotProgram& program, const Robot<6>& robot, const Chain& controller,
                             const Isometry3& tool) {
  const ClosedForm<6> roots(robot.chain);
  std::vector<Joints> out;
  for (const ProgramTarget& target : program.targets) {
    const auto found = controller_joints(roots, controller, robot.limits, program.language, {},
                                         target.pose * tool.inverse(), target.configuration, target.joints);
    EXPECT_TRUE(found.joints) << found.reason;
    out.push_back(found.joints.value_or(Joints::Zero()));
  }
  return out;
}

class CorrectProgramOf : public ::testing::TestWithParam<ProgramLanguage> {};

TEST_P(CorrectProgramOf, TheRealArmGoesWhereTheProgramMeans) {
  const ProgramLanguage language = GetParam();
  const Robot<6> robot = language == urscript ? robots::ur10() : robots::abb_irb120();
  const Arm arm = arm_of(robot);
  Rng rng(8);
  const Chain controller = language == urscript ? vernier_test::as_made(robot.chain, rng) : robot.chain;
  const Isometry3 tool = frame(0.01, -0.02, 0.15, 0, 0, 1.5);
  const std::vector<Joints> joints = samples();
  const std::string text = program_text(language, robot, controller, tool, joints);
  const RobotProgram program = parse_program(language, text, "part");
  ASSERT_EQ(program.targets.size(), joints.size());
  ProgramOptions options{.arm = ControllerArm{}, .approach = false};
  options.tools.by_name = {{"GUN", tool}, {"3", tool}, {"1", tool}};
  const CorrectedProgram corrected = language == urscript ? correct_program(program, arm, controller, options)
                                                          : correct_program(program, arm, options);
  for (const Uncorrected& one : corrected.uncorrected) ADD_FAILURE() << one.line << ": " << one.reason;
  ASSERT_EQ(corrected.targets.size(), joints.size());
  EXPECT_GT(corrected.mean_correction(), 0.2e-3);
  EXPECT_GE(corrected.largest_correction(), corrected.mean_correction());
  EXPECT_LT(corrected.largest_predicted_error(), 1e-6);
  EXPECT_EQ(corrected.extrapolated(), 2u);  // those whose first joint is negative

  const RobotProgram again = parse_program(language, replace_targets(text, program, corrected.replaced()), "part");
  const std::vector<Joints> moved = executed(again, robot, controller, tool);
  ASSERT_EQ(moved.size(), joints.size());
  for (std::size_t k = 0; k < joints.size(); ++k) {
    EXPECT_EQ(corrected.targets[k].replaced.target, k);
    EXPECT_LT((moved[k] - corrected.commands().row(static_cast<Index>(k)).transpose()).norm(), 2e-6);
    const Isometry3 meant = arm.nominal().base() * controller.pose(joints[k]) * arm.nominal().tool();
    const Vector6 left = pose_difference(meant, arm.made().pose(moved[k]));
    EXPECT_LT(left.head<3>().norm(), 10e-6) << k;
    EXPECT_LT(left.tail<3>().norm(), 10e-6) << k;
  }
}

std::string name_of(const ::testing::TestParamInfo<ProgramLanguage>& language) {
  const char* const names[] = {"Rapid", "Krl", "UrScript", "FanucTp"};
  return names[language.index];
}

INSTANTIATE_TEST_SUITE_P(EachLanguage, CorrectProgramOf, ::testing::Values(rapid, krl, urscript, fanuc_tp), name_of);

/// A RAPID program of these statements, and what is corrected of it.
struct Corrected {
  RobotProgram program;
  CorrectedProgram outcome;

  /// What stays, a line each: number, text, reason.
  std::string uncorrected() const {
    std::string out;
    for (const Uncorrected& one : outcome.uncorrected) out += message(one.line, ' ', one.text, ": ", one.reason, "\n");
    return out;
  }
};

constexpr const char* axes = "[9E9,9E9,9E9,9E9,9E9,9E9]";

Corrected corrected_rapid(const std::string& statements, const ProgramOptions& options = {}) {
  static const Arm arm = arm_of(robots::abb_irb120());
  Corrected out{parse_program(rapid, "MODULE m\n" + statements + "ENDMODULE\n", "m.mod"), {}};
  out.outcome = correct_program(out.program, arm, options);
  return out;
}

/// A target of the IRB 120, as RAPID writes it.
std::string target(const Joints& q, const Isometry3& tool = Isometry3::Identity()) {
  const Robot<6> robot = robots::abb_irb120();
  return pose_text(rapid, robot.chain.pose(q) * tool, configuration_of(rapid, robot, q));
}

TEST(CorrectProgram, SaysWhatItRefusesAndWhy) {
  const std::string good = target(samples()[0]);
  const auto from = [&](const std::string& part, const std::string& to) {
    return vernier_test::replaced(good, part, to);
  };
  const std::string x = good.substr(2, good.find(',') - 2);
  const Corrected done = corrected_rapid(
      "PROC main()\nMoveL Offs(p1,0,0,50),v1,fine,tool0;\nMoveL " + good + ",v1,fine,tool0;\nMoveL " + good +
      ",v1,fine,Hand;\nMoveL " + good + ",v1,fine,tool0\\WObj:=table;\nMoveL " + from(x, "5000") +
      ",v1,fine,tool0;\nMoveL " + from("],[0,0,0,", "],[1,0,0,") + ",v1,fine,tool0;\nENDPROC\n");
  ASSERT_EQ(done.outcome.targets.size(), 1u);
  EXPECT_EQ(done.program.targets[done.outcome.targets[0].replaced.target].line, 4u);
  const std::string all = done.uncorrected();
  EXPECT_EQ(all.substr(0, all.find("7 target: ")),
            "3 MoveL Offs(p1,0,0,50): computed, not a literal\n5 target: the frame of its tool hand is not known\n"
            "6 target: the frame of its work object table is not known\n");
  EXPECT_EQ(all.substr(all.find("8 target: ")), "8 target: no joint values within the limits have its configuration\n");
  std::vector<MissingInput> missing;
  for (const Uncorrected& one : done.outcome.uncorrected) missing.push_back(one.missing);
  EXPECT_EQ(missing, (std::vector{MissingInput::none, MissingInput::tool, MissingInput::workobject, MissingInput::none,
                                  MissingInput::none}));
}

TEST(CorrectProgram, PosesOfUrScriptNeedTheController) {
  const Robot<6> robot = robots::ur10();
  const std::string text = program_text(urscript, robot, robot.chain, Isometry3::Identity(), {samples()[0]}) +
                           "def n():\n  movej([0.1,-1.2,1.3,-0.2,1.1,0.4], a=1)\nend\n";
  const RobotProgram program = parse_program(urscript, text, "part.script");
  const CorrectedProgram joints = correct_program(program, arm_of(robot));
  ASSERT_EQ(joints.uncorrected.size(), 1u);
  EXPECT_EQ(joints.uncorrected[0].line, 2u);
  EXPECT_EQ(joints.uncorrected[0].text, "p1");
  EXPECT_EQ(joints.uncorrected[0].reason, "poses are reached by the robot's factory calibration");
  EXPECT_EQ(joints.uncorrected[0].missing, MissingInput::controller);
  EXPECT_EQ(joints.targets.size(), 1u);
  EXPECT_EQ(correct_program(program, arm_of(robot), robot.chain).targets.size(), 2u);
}

TEST(CorrectProgram, WithoutConfigurationTheFirstTargetIsNearTheStart) {
  const Robot<6> robot = robots::ur10();
  const Joints q = samples()[0];
  const std::string text =
      "def m():\n  set_tcp(p[0,0,0,0,0,0])\n  movel(" + pose_text(urscript, robot.chain.pose(q), {}) + ", a=1)\nend\n";
  const RobotProgram program = parse_program(urscript, text, "part.script");
  const CorrectedProgram unknown = correct_program(program, arm_of(robot), robot.chain);
  ASSERT_EQ(unknown.uncorrected.size(), 1u);
  EXPECT_EQ(unknown.uncorrected[0].reason, "no configuration, and no joint values before it are known");
  const Joints start = q + Joints::Constant(0.1);
  const CorrectedProgram known = correct_program(program, arm_of(robot), robot.chain, {.start = start});
  ASSERT_EQ(known.targets.size(), 1u);
  EXPECT_LT((known.targets[0].replaced.joints - q).norm(), 0.02);
}

TEST(CorrectProgram, FramesOfTheOptionsReplaceThoseOfTheProgram) {
  const Isometry3 tool = frame(0.02, 0, 0.1, 0.3, 0, 0), object = frame(0.1, 0.05, 0, 0, 0, 0.2);
  const Joints q = samples()[0];
  const std::string flange = target(q, tool);
  const std::string text =
      "PERS tooldata gun:=[TRUE,[[0,0,500],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\nPROC main()\nMoveL " + flange +
      ",v1,fine,gun;\nENDPROC\n";
  const auto command = [&](const ProgramOptions& options) {
    const Corrected done = corrected_rapid(text, options);
    EXPECT_EQ(done.uncorrected(), "");
    return done.outcome.targets.empty() ? Joints(Joints::Zero()) : done.outcome.targets[0].replaced.joints;
  };
  ProgramOptions options;
  options.tools.by_name["Gun"] = tool;
  const Joints named = command(options);
  EXPECT_LT((named - q).norm(), 0.02);
  options = {};
  options.tools.others = tool;  // the program states a frame of this name, which holds
  EXPECT_EQ(corrected_rapid(text, options).outcome.targets.size(), 0u);
  const std::string without = text.substr(text.find("PROC"));
  const auto others = corrected_rapid(without, options).outcome.targets;
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(others[0].replaced.joints, named);
  // the same place, with another base of the controller and another flange
  ProgramOptions moved;
  moved.robot_base = object;
  moved.flange = frame(0, 0, 0.05, 0, 0.1, 0);
  moved.tools.by_name["gun"] = moved.flange.inverse() * tool;
  moved.workobjects.by_name["wobj0"] = object.inverse();
  EXPECT_LT((command(moved) - named).norm(), 1e-7);
}

TEST(CorrectProgram, ComesFromTheCommandBefore) {
  const auto move = [](const Joints& q) {
    const Joints d = q / degree;
    return format("MoveAbsJ [[%.4f,%.4f,%.4f,%.4f,%.4f,%.4f],", d(0), d(1), d(2), d(3), d(4), d(5)) + axes +
           "],v1,fine,tool0;\n";
  };
  const std::string text = "PROC main()\n" + move(samples()[0]) + move(samples()[2]) + move(samples()[1]) + "ENDPROC\n";
  const JointRows<6> ordered = corrected_rapid(text).outcome.commands(),
                     each = corrected_rapid(text, {.approach = false}).outcome.commands();
  ASSERT_EQ(ordered.rows(), 3);
  EXPECT_NEAR(ordered(0, 0) - each(0, 0), 0, 1e-12);
  EXPECT_NEAR(ordered(1, 0) - each(1, 0), 1e-4, 1e-12);
  EXPECT_NEAR(ordered(2, 0) - each(2, 0), -1e-4, 1e-12);
}

TEST(CorrectProgram, ChangesAConfigurationWhereAJointPassesTheEndOfAQuadrant) {
  const Arm arm = arm_of(robots::abb_irb120());
  Joints q = samples()[0];
  q(0) = 0;
  q(0) -= arm.correct(arm.nominal().pose(q), q, Joints::Constant(std::nan(""))).command(0) / 2;  // across 0
  const std::string text = "MODULE m\nPROC main()\nMoveL " + target(q) + ",v1,fine,tool0;\nENDPROC\nENDMODULE\n";
  const RobotProgram program = parse_program(rapid, text, "m.mod");
  const CorrectedProgram corrected = correct_program(program, arm);
  ASSERT_EQ(corrected.targets.size(), 1u);
  EXPECT_LT(q(0) * corrected.targets[0].replaced.joints(0), 0);
  EXPECT_TRUE(corrected.targets[0].reconfigured);
  const std::string written = replace_targets(text, program, corrected.replaced());
  EXPECT_EQ(parse_program(rapid, written, "m.mod").targets[0].configuration[0],
            corrected.targets[0].replaced.joints(0) < 0 ? -1 : 0);
}

TEST(CorrectProgram, AControllerMayBeAModelInFramesOfItsOwn) {
  const Robot<6> robot = robots::abb_irb120();
  const Arm arm = arm_of(robot);
  Rng rng(8);
  const Chain its = vernier_test::as_made(robot.chain, rng);
  const Isometry3 base = frame(3, 0, 0, 0, 0, 0.3), tool = frame(0, 0.2, 0, 0, 0, 0);
  const std::string text = program_text(rapid, robot, its, Isometry3::Identity(), samples());
  const RobotProgram program = parse_program(rapid, text, "m.mod");
  ProgramOptions options{.approach = false};
  options.tools.others = Isometry3::Identity();
  const CorrectedProgram chain = correct_program(program, arm, its, options),
                         framed = correct_program(program, arm, Framed(its, base, tool), options),
                         model = correct_program(program, arm,
                                                 Compensated(Framed(its, base, tool), Framed(robot.chain, base, tool)),
                                                 options);
  ASSERT_EQ(chain.targets.size(), samples().size());
  ASSERT_EQ(framed.targets.size(), samples().size());
  ASSERT_EQ(model.targets.size(), samples().size());
  for (Index k = 0; k < chain.commands().rows(); ++k) {
    EXPECT_LT((framed.commands().row(k) - chain.commands().row(k)).norm(), 1e-7);
    EXPECT_LT((model.commands().row(k) - chain.commands().row(k)).norm(), 1e-7);
    const Isometry3 meant =
        arm.nominal().base() * its.pose(samples()[static_cast<std::size_t>(k)]) * arm.nominal().tool();
    EXPECT_LT((translation(arm.made().pose(chain.commands().row(k).transpose())) - translation(meant)).norm(), 2e-6);
  }
}

TEST(CorrectProgram, RefusesWhatItCannotCorrectForAnyTarget) {
  const Robot<6> robot = robots::abb_irb120();
  const RobotProgram empty = parse_program(rapid, "MODULE m\nENDMODULE\n", "m.mod");
  const auto of = [&](const Chain& chain) { return Arm({chain, robot.limits, "another"}, chain); };
  const auto complaint = [&](auto&&... arguments) {
    return vernier_test::complaint([&] { static_cast<void>(correct_program(arguments...)); });
  };
  auto p = robot.chain.parameters();
  for (const int row : {0, 3, 4}) p(5 * row + 1) += 0.1;  // neither a spherical wrist nor parallel axes
  p(5 * 3) += 0.05;
  const Chain skew = robot.chain.with_parameters(p);
  const std::string words = "programs are corrected for arms with a closed form: ";
  EXPECT_EQ(complaint(empty, of(skew)).rfind(words, 0), 0u) << complaint(empty, of(skew));
  EXPECT_EQ(complaint(empty, of(skew), robot.chain).rfind(words, 0), 0u);
  std::array<DhRow, 6> rows;
  for (int j = 0; j < 6; ++j) rows[static_cast<std::size_t>(j)] = robot.chain.row(j);
  rows[2].joint = JointType::prismatic;
  EXPECT_EQ(complaint(empty, of(Chain::from_rows(rows))),
            "joint 3 is prismatic; programs are corrected for revolute joints");

  const Arm arm = arm_of(robot);
  ProgramOptions skewed;
  skewed.robot_base(0, 0) = 2;
  EXPECT_EQ(complaint(empty, arm, skewed), "correct_program: robot_base is no rigid motion");
  skewed = {};
  skewed.flange(0, 3) = std::nan("");
  EXPECT_EQ(complaint(empty, arm, skewed), "correct_program: flange is no rigid motion");
  skewed = {};
  skewed.tools.by_name["gun"].matrix().setZero();
  EXPECT_EQ(complaint(empty, arm, skewed), "correct_program: the frame of the tool gun is no rigid motion");
  skewed = {};
  skewed.workobjects.others = Isometry3::Identity();
  skewed.workobjects.others->linear() *= 1.1;
  EXPECT_EQ(complaint(empty, arm, skewed), "correct_program: a frame of work objects is no rigid motion");
  const std::string fanuc = program_text(fanuc_tp, robot, robot.chain, Isometry3::Identity(), {samples()[0]});
  EXPECT_EQ(
      complaint(parse_program(fanuc_tp, fanuc, "m.ls"), arm),
      "correct_program: a Fanuc program with poses needs ProgramOptions::arm, the sign of J5 at a position with N");
}

TEST(CorrectProgram, NothingToCorrect) {
  const Corrected done = corrected_rapid("");
  EXPECT_TRUE(done.outcome.targets.empty() && done.outcome.replaced().empty());
  EXPECT_EQ(done.outcome.commands().rows(), 0);
  EXPECT_EQ(done.outcome.mean_correction(), 0);
  EXPECT_EQ(done.outcome.largest_correction(), 0);
}

}  // namespace
}  // namespace vernier::library_correct_program_test
