// SPDX-License-Identifier: BSD-3-Clause
// Rules of the languages one by one, in programs of a few lines.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "read_program.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/robot_programs/configuration.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::robot_rules_test {
namespace {

using namespace vernier_test;
using enum ProgramLanguage;

constexpr double degree = std::numbers::pi / 180;
const double unknown = std::nan("");

// ---- configurations ----

// The joint values at which the makers' flags are zero or N U T.
TEST(ReferenceJointsWhiteBox, AreTheMakers) {
  const auto apart = [](ProgramLanguage language, bool negative, const JointVector<6>& expected) {
    return (detail::reference_joints(language, {.negative_noflip = negative}) - expected).norm();
  };
  EXPECT_EQ(apart(rapid, false, {0, 0, 0, 0, 0.5, 0}), 0);
  EXPECT_EQ(apart(rapid, true, {0, 0, 0, 0, 0.5, 0}), 0);
  EXPECT_LT(apart(krl, false, {0, -90 * degree, 90 * degree, 0, 0.5, 0}), 1e-15);
  EXPECT_EQ(apart(fanuc_tp, false, {0, 0, 0, 0, 0.5, 0}), 0);
  EXPECT_EQ(apart(fanuc_tp, true, {0, 0, 0, 0, -0.5, 0}), 0);
  EXPECT_EQ(detail::binding_bits(rapid), 0);  // cfx depends on the type of robot
  EXPECT_EQ(detail::binding_bits(krl), 3);    // the sign of A5 is in T
  EXPECT_EQ(detail::binding_bits(fanuc_tp), 7);
  EXPECT_EQ(detail::binding_bits(urscript), 0);
}

// Bits in which signs differ.
TEST(BranchWhiteBox, IsRelativeToTheReference) {
  EXPECT_EQ(detail::branch_from({-1, 1, -1}, {-1, -1, 1}), 0b110);
  EXPECT_EQ(detail::branch_from({-1, 1, -1}, {-1, 1, -1}), 0);
}

/// In degrees; limits of 400 unless stated.
double turned(ProgramLanguage language, const std::vector<int>& configuration, int joint, double angle,
              double near = unknown, double lower = -400, double upper = 400) {
  return detail::stated_turn(language, configuration, joint, angle * degree, near * degree, lower * degree,
                             upper * degree) /
         degree;
}

TEST(StatedTurnWhiteBox, QuadrantsOfRapid) {
  const std::vector<int> stated{1, -1, 3, 0};  // of joints 1, 4 and 6
  EXPECT_NEAR(turned(rapid, stated, 0, 100), 100, 1e-9);
  EXPECT_NEAR(turned(rapid, stated, 0, -260), 100, 1e-9);
  EXPECT_NEAR(turned(rapid, stated, 3, -10, 350), -10, 1e-9);  // whatever is near
  EXPECT_NEAR(turned(rapid, stated, 5, -60), 300, 1e-9);
  EXPECT_NEAR(turned(rapid, stated, 0, 89.96), 89.96, 1e-9);  // a twentieth of a degree for rounded numbers
  EXPECT_TRUE(std::isnan(turned(rapid, stated, 0, 89.9)));
  EXPECT_TRUE(std::isnan(turned(rapid, stated, 0, 10)));
  // the other joints have none: the nearest
  EXPECT_NEAR(turned(rapid, stated, 1, 10), 10, 1e-9);
  EXPECT_NEAR(turned(rapid, stated, 1, 10, 350), 370, 1e-9);
}

TEST(StatedTurnWhiteBox, SignsOfKrl) {
  const std::vector<int> stated{2, 0b000010};  // A2 is negative
  EXPECT_NEAR(turned(krl, stated, 1, 100), -260, 1e-9);
  EXPECT_NEAR(turned(krl, stated, 0, -100), 260, 1e-9);
  EXPECT_NEAR(turned(krl, stated, 1, 1.9, unknown, -180, 180), 1.9, 1e-9);  // two degrees either way
  EXPECT_TRUE(std::isnan(turned(krl, stated, 1, 2.1, unknown, -180, 180)));
  EXPECT_NEAR(turned(krl, stated, 0, -1.9, unknown, -180, 180), -1.9, 1e-9);
  // of two that are equally near, the one that is really positive
  EXPECT_NEAR(turned(krl, stated, 0, -1, 179), 359, 1e-9);
}

TEST(StatedTurnWhiteBox, TurnNumbersOfFanuc) {
  const std::vector<int> stated{0, 1, 1, 0, 0, 1};
  EXPECT_NEAR(turned(fanuc_tp, stated, 5, -170), 190, 1e-9);
  for (const int joint : {0, 3}) EXPECT_NEAR(turned(fanuc_tp, stated, joint, 170, 530, -600, 600), 170, 1e-9);
  for (const int joint : {1, 2, 4}) EXPECT_NEAR(turned(fanuc_tp, stated, joint, 10, 370), 370, 1e-9);
}

TEST(StatedTurnWhiteBox, WithinTheLimits) {
  EXPECT_NEAR(turned(urscript, {}, 0, 170, 170, -170, 170), 170, 1e-9);
  EXPECT_NEAR(turned(urscript, {}, 0, -170, -170, -170, 170), -170, 1e-9);
  EXPECT_TRUE(std::isnan(turned(urscript, {}, 0, 170.001, 170, -170, 170)));
  EXPECT_NEAR(turned(urscript, {}, 0, 10, 1440, -2000, 2000), 1450, 1e-9);
  EXPECT_NEAR(turned(urscript, {}, 0, 10, -1440, -2000, 2000), -1430, 1e-9);
}

// ---- rotations and texts ----

TEST(AnglesOfRotations, AlsoWhereTheSecondIsAQuarterTurn) {
  const auto again = [](double a, double b, double c) {
    return detail::zyx_of_rotation(detail::rotation_of_zyx(a, b, c));
  };
  EXPECT_LT((again(0.7, -0.4, 0.3) - Vector3(0.7, -0.4, 0.3)).norm(), 1e-14);
  for (const double b : {std::numbers::pi / 2, -std::numbers::pi / 2})
    EXPECT_LT((again(0.7, b, 0) - Vector3(0.7, b, 0)).norm(), 1e-14);
  const double nearly = std::numbers::pi / 2 - 1e-5;
  EXPECT_LT((again(0.7, nearly, 0.3) - Vector3(0.7, nearly, 0.3)).norm(), 1e-9);
}

TEST(FrameOfQuaternion, TakesRoundedOnes) {
  const auto frame = [](double w, double z) { return detail::frame_of_quaternion({1, 2, 3}, {w, 0, 0, z}); };
  ASSERT_TRUE(frame(1.005, 0));
  EXPECT_LT((frame(1.005, 0)->linear() - Matrix3::Identity()).norm(), 1e-15);
  EXPECT_LT((frame(1, 0)->translation() - Vector3(1e-3, 2e-3, 3e-3)).norm(), 1e-18);
  EXPECT_LT((frame(0.71, 0.71)->linear() - exp_so3(Vector3(0, 0, std::numbers::pi / 2))).norm(), 1e-14);
  EXPECT_FALSE(frame(1.02, 0));
  EXPECT_FALSE(frame(0.98, 0));
}

TEST(Excerpts, AreShortAndPrintable) {
  EXPECT_EQ(detail::excerpt(std::string(60, 'a')), std::string(60, 'a'));
  EXPECT_EQ(detail::excerpt(std::string(61, 'a')), std::string(60, 'a') + "...");
  EXPECT_EQ(detail::excerpt(" a \t\r\n b\xff "), "a b?");
}

TEST(Places, CountBytesFromTheBeginningOfTheLine) {
  const detail::ProgramText text{"ab\ncd\n", "m", {}};
  ProgramTarget target;
  const auto column = [&](std::size_t byte) {
    detail::place(text, byte, 7, target);
    return target.column;
  };
  EXPECT_EQ(column(0), 1u);
  EXPECT_EQ(column(1), 2u);
  EXPECT_EQ(column(3), 1u);
  EXPECT_EQ(column(4), 2u);
  EXPECT_EQ(target.line, 7u);
}

TEST(ProgramLanguages, AMarkOfTheEncodingIsNoPartOfAWord) {
  EXPECT_EQ(complaint([] { (void)parse_program(rapid, "\xEF\xBB\xBFMODULE m\nENDMODULE\n", "m.mod"); }), "");
}

TEST(ProgramLanguages, ByEveryEnding) {
  for (const char* name : {"a.mod", "a.modx", "a.prg", "a.sys"}) EXPECT_EQ(program_language(name), rapid) << name;
}

TEST(CorrectedPrograms, AreNamedWithTheLineOfTheStamp) {
  EXPECT_EQ(complaint([] { (void)parse_program(krl, "DEF m()\n;\n; VERNIER-CORRECTED:\nEND\n", "m.src"); }),
            "m.src, line 3: this program was corrected before; correct the original one");
}

// ---- what moves say about targets ----

/// A module of targets p, q, r and s, 1 to 4 mm along x, that runs these instructions from line 8 on.
RobotProgram rapid_program(const std::string& instructions, const std::string& declarations = "\n") {
  std::string text = "MODULE m\n";
  for (const char* name : {"p", "q", "r", "s"})
    text += message("CONST robtarget ", name, ":=[[", name[0] - 'p' + 1,
                    ",0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n");
  return parse_program(rapid, text + declarations + "PROC main()\n" + instructions + "ENDPROC\nENDMODULE\n", "m.mod");
}

TEST(UsesOfTargets, OneUsedTwiceHasNoPrevious) {
  const RobotProgram program =
      rapid_program("MoveL p,v1,fine,gun;\nMoveL q,v1,fine,gun;\nMoveJ p,v1,fine,gun;\nMoveL r,v1,fine,gun;\n");
  EXPECT_EQ(before(program, "p"), "");
  EXPECT_EQ(before(program, "q"), "p");
  EXPECT_EQ(before(program, "r"), "p");
  EXPECT_EQ(named(program, "p").move, TargetMove::unknown);  // by both kinds
  EXPECT_EQ(named(program, "q").move, TargetMove::linear);
  EXPECT_EQ(named(program, "s").move, TargetMove::unknown);
  EXPECT_EQ(program.targets.back().name, "s");  // no move uses it
  EXPECT_EQ(program.end_of_line, "\n");
  EXPECT_EQ(remarks(program), "");
  const RobotProgram again =
      rapid_program("MoveL q,v1,fine,gun;\nMoveL p,v1,fine,gun;\nMoveL r,v1,fine,gun;\nMoveL p,v1,fine,gun;\n");
  EXPECT_EQ(before(again, "p"), "");
  EXPECT_EQ(before(again, "r"), "p");
}

TEST(UsesOfTargets, AnUnknownToolContradictsNone) {
  const RobotProgram program = rapid_program("MoveL p,v1,fine,gun;\nMoveL p,v1,fine,guns{2};\nMoveL q,v1,fine,(x);\n");
  EXPECT_EQ(remarks(program), "");
  EXPECT_EQ(named(program, "p").tool, "gun");
  EXPECT_EQ(named(program, "q").tool, "");
}

TEST(UsesOfTargets, DifferentWorkObjectsContradictEachOther) {
  const RobotProgram program = rapid_program("MoveL p,v1,fine,gun\\WObj:=a;\nMoveL p,v1,fine,gun\\WObj:=b;\nn:=n+1;\n");
  EXPECT_EQ(program.targets.size(), 3u);
  EXPECT_EQ(remarks(program), "2 p: moves use it with different tools or work objects\n");  // n is none of its targets
}

TEST(UsesOfTargets, JointValuesHaveNoTool) {
  const RobotProgram program = rapid_program("MoveAbsJ home,v1,fine,gun;\nMoveAbsJ home,v1,fine,tool0;\n",
                                             "CONST jointtarget home:=[[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n");
  EXPECT_EQ(remarks(program), "");
  EXPECT_EQ(named(program, "home").move, TargetMove::joint);
}

// ---- RAPID ----

TEST(RapidRules, KindsOfMoves) {
  const RobotProgram program =
      rapid_program("MoveJDO p,v1,fine,gun\\WObj:=table;\nTriggJ q,v1,e,fine,gun;\nMoveC r,s,v1,fine,gun;\n");
  EXPECT_EQ(named(program, "p").move, TargetMove::joint);
  EXPECT_EQ(named(program, "p").workobject, "table");
  EXPECT_EQ(named(program, "q").move, TargetMove::joint);
  EXPECT_EQ(named(program, "q").workobject, "wobj0");
  for (const char* name : {"r", "s"}) {
    EXPECT_EQ(named(program, name).move, TargetMove::linear);
    EXPECT_EQ(named(program, name).tool, "gun");
  }
  EXPECT_EQ(before(program, "s"), "r");
  const RobotProgram more = rapid_program("TriggC p,q,v1,e,fine,gun\\WObj:=(w);\nArcC r,s,v1,sm,wd,fine,gun;\n");
  EXPECT_EQ(before(more, "q"), "p");
  EXPECT_EQ(before(more, "s"), "r");
  EXPECT_EQ(named(more, "p").workobject, "?");
  EXPECT_EQ(remarks(more), "");
}

TEST(RapidRules, CirclesWithSignalsHaveTwoTargets) {
  const RobotProgram program = rapid_program("MoveCDO p,q,v1,fine,gun,do1,1;\nMoveL r,v1,fine,gun;\n");
  EXPECT_EQ(before(program, "q"), "p");
  EXPECT_EQ(before(program, "r"), "q");
}

TEST(RapidRules, EachRoutineBeginsAnew) {
  const RobotProgram program = rapid_program(
      "MoveL p,v1,fine,gun;\nENDPROC\nFUNC num f()\nMoveL q,v1,fine,gun;\nENDFUNC\nTRAP t\nMoveL r,v1,fine,gun;\n"
      "MoveL s,v1,fine,gun;\nENDTRAP\nPROC other()\n");
  EXPECT_EQ(before(program, "q"), "");
  EXPECT_EQ(before(program, "r"), "");
  EXPECT_EQ(before(program, "s"), "r");
}

// Which element of an array a move uses is not known, so nothing is known of what comes before and after.
TEST(RapidRules, ElementsOfArraysHaveNoOrder) {
  const RobotProgram program =
      rapid_program("MoveL p,v1,fine,gun;\nMoveL row{i},v1,fine,gun;\nMoveL q,v1,fine,gun;\n",
                    "CONST robtarget row{2}:=[[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],"
                    "[[4,5,6],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]];\n");
  EXPECT_EQ(before(program, "q"), "");
  for (const ProgramTarget& target : program.targets) EXPECT_FALSE(target.previous) << target.name;
  EXPECT_EQ(named(program, "row").move, TargetMove::linear);
}

TEST(RapidRules, WhatIsRefused) {
  EXPECT_EQ(remarks(rapid_program("",
                                  "VAR extjoint rail:=[100,9E9,9E9,9E9,9E9,9E9];\n"
                                  "CONST robtarget a:=[[1,2,3],[1,0,0,0],[0,0,0,0],rail];\n"
                                  "CONST robtarget b:=[[1,2,3],[0.9,0,0,0],[0,0,0,0],"
                                  "[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
                                  "CONST robtarget d:=[[1,2,3],[1,0,0,0],5,[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
                                  "CONST robtarget c:=[[1,2,3],[1,0,0,0],[0,0,0,1000],"
                                  "[9E9,9E9,9E9,9E9,9E9,9E9]];\n")),
            "7 [[1,2,3],[1,0,0,0],[0,0,0,0],rail]: external axes are in use\n"
            "8 [[1,2,3],[0.9,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]: its orientation is no unit quaternion\n"
            "9 robtarget d:=[[1,2,3],[1,0,0,0],5,[9E9,9E9,9E9,9E9,9E9,9E9]]: no literal of this type\n"
            "10 [[1,2,3],[1,0,0,0],[0,0,0,1000],[9E9,9E9,9E9,9E9,9E9,9E9]]: its configuration is out of range\n");
}

// Tools that stand still and work objects that the robot holds, or that move, are no constant frames.
TEST(RapidRules, FramesThatDoNotMove) {
  const std::string frame = "[[1,2,3],[1,0,0,0]]", load = "[1,[0,0,1],[1,0,0,0],0,0,0]";
  const RobotProgram program = rapid_program(
      "", "PERS tooldata held:=[TRUE," + frame + "," + load + "];\nPERS tooldata still:=[FALSE," + frame + "," + load +
              "];\nPERS wobjdata fixed:=[FALSE,TRUE,\"\"," + frame + "," + frame +
              "];\nPERS wobjdata carried:=[TRUE,TRUE,\"\"," + frame + "," + frame +
              "];\nPERS wobjdata bent:=[FALSE,TRUE,\"\"," + frame +
              ",[[1,2,3],[0.5,0,0,0]]];\nPERS wobjdata moved:=[FALSE,FALSE,\"u\"," + frame + "," + frame + "];\n");
  EXPECT_EQ(program.tools.count("held"), 1u);
  EXPECT_EQ(program.tools.count("still"), 0u);
  ASSERT_EQ(program.workobjects.count("fixed"), 1u);
  EXPECT_LT((program.workobjects.at("fixed").translation() - Vector3(2e-3, 4e-3, 6e-3)).norm(), 1e-15);
  EXPECT_EQ(program.workobjects.count("carried"), 0u);
  EXPECT_EQ(program.workobjects.count("moved"), 0u);
  EXPECT_EQ(program.workobjects.count("bent"), 0u);  // its quaternion is none
}

// A correction by a frame that does not hold where the target is used would be wrong: better none is known.
TEST(RapidRules, FramesThatTheProgramChangesAreUnknown) {
  const std::string frame = "[[1,2,3],[1,0,0,0]]", tool = "[TRUE," + frame + ",[1,[0,0,1],[1,0,0,0],0,0,0]]";
  const std::string declared = "PERS tooldata gun:=" + tool + ";\nPERS tooldata other:=" + tool +
                               ";\nPERS wobjdata tab:=[FALSE,TRUE,\"\"," + frame + "," + frame + "];\n";
  for (const std::string change :
       {"gun.tframe.trans.z:=120;", "gun:=other;", "gun:=[TRUE,[[1,2,4],[1,0,0,0]],load];"}) {
    const RobotProgram program = rapid_program(change + "\n", declared);
    EXPECT_EQ(program.tools.count("gun"), 0u) << change;
    EXPECT_EQ(program.tools.count("other"), 1u) << change;
    EXPECT_EQ(program.workobjects.count("tab"), 1u) << change;
  }
  EXPECT_EQ(rapid_program("tab.uframe.trans.x:=50;\n", declared).workobjects.count("tab"), 0u);
}

// ---- KRL ----

RobotProgram krl_program(const std::string& lines) {
  return parse_program(krl, "DEF m()\n" + lines + "END\n", "m.src", {"new"});
}

TEST(KrlRules, ToolsAndBases) {
  const std::string at = "={X 1,Y 2,Z 3,A 0,B 0,C 0}\n";
  const RobotProgram program = krl_program(
      "p1" + at + "p2" + at + "p3" + at + "p4" + at + "p5" + at + "p6" + at + "PTP p1\nBAS(#TOOL,4)\nBAS (#BASE, n)\n" +
      "PTP p2\n$BASE=$NULLFRAME\n$TOOL={X x0,Y 0,Z 0,A 0,B 0,C 0}\nLIN p3\n$TOOL=TOOL_DATA[n]\n$BASE=BASE_DATA[7]\n" +
      "SPTP p4\nTOOL_DATA[1]={X 0,Y 0,Z 1,A 0,B 0,C 0}\nTOOL_DATA[2]={X 0,Y 0,Z 1,A 0,B 0,C 0}\n" +
      "TOOL_DATA[1]={X x0,Y 0,Z 1,A 0,B 0,C 0}\nTOOL_DATA[2]=new()\nBASE_DATA[2]={X 9,Y 0,Z 1,A 0,B 0,C 0}\n" +
      "$TOOL=TOOL_DATA[2]\nEND\nDEF n()\nPTP p5\nSLIN p6 WITH $VEL.CP=1\n");
  const auto frames = [&](const char* name) {
    return named(program, name).tool + "/" + named(program, name).workobject;
  };
  EXPECT_EQ(frames("p1"), "/");
  EXPECT_EQ(frames("p2"), "4/?");
  EXPECT_EQ(frames("p3"), "?/0");
  EXPECT_EQ(frames("p4"), "?/7");
  EXPECT_EQ(frames("p5"), "/");  // another routine
  EXPECT_EQ(program.tools.count("1"), 0u);
  EXPECT_EQ(program.tools.count("2"), 0u);
  EXPECT_LT((program.workobjects.at("2").translation() - Vector3(9e-3, 0, 1e-3)).norm(), 1e-15);
  EXPECT_EQ(named(program, "p3").move, TargetMove::linear);
  EXPECT_EQ(named(program, "p4").move, TargetMove::joint);
  EXPECT_EQ(named(program, "p6").move, TargetMove::linear);
  EXPECT_EQ(before(program, "p4"), "p3");
  EXPECT_EQ(before(program, "p5"), "");
  EXPECT_EQ(before(program, "p6"), "p5");
  EXPECT_FALSE(named(program, "p1").joints.allFinite());
  EXPECT_EQ(remarks(program), "");
}

// A correction by a frame that does not hold where the target is used would be wrong: better none is known.
TEST(KrlRules, FramesThatTheProgramChangesAreUnknown) {
  const std::string at = "={X 1,Y 2,Z 3,A 0,B 0,C 0}\n", frame = "={X 0,Y 0,Z 100,A 0,B 0,C 0}\n";
  const std::string stated = "TOOL_DATA[3]" + frame + "TOOL_DATA[4]" + frame + "BASE_DATA[3]" + frame;
  const auto count = [&](const std::string& lines, const char* number) {
    return krl_program(stated + lines).tools.count(number);
  };
  EXPECT_EQ(count("TOOL_DATA[3]" + frame, "3"), 1u);  // the same again
  EXPECT_EQ(count("TOOL_DATA[3]={X 0,Y 0,Z 200,A 0,B 0,C 0}\n", "3"), 0u);
  EXPECT_EQ(count("TOOL_DATA[3].Z=250\n", "3"), 0u);
  EXPECT_EQ(count("TOOL_DATA[3].Z=250\nTOOL_DATA[3]" + frame, "3"), 0u);
  EXPECT_EQ(count("TOOL_DATA[3].Z=250\n", "4"), 1u);
  EXPECT_EQ(count("TOOL_DATA[n].Z=250\n", "4"), 0u);  // any
  EXPECT_EQ(count("BASE_DATA[3].Z=250\n", "3"), 1u);
  EXPECT_EQ(krl_program(stated + "BASE_DATA[3].Z=250\n").workobjects.count("3"), 0u);
  EXPECT_EQ(krl_program(stated + "TOOL_DATA[n].Z=250\n").workobjects.count("3"), 1u);
  EXPECT_EQ(krl_program(stated + "TOOL_DATA[n].Z=250\n").tools.count("0"), 1u);  // the flange
  const RobotProgram program = krl_program("p" + at + "q" + at + "$TOOL=TOOL_DATA[3]\n$BASE=BASE_DATA[3]\nPTP p\n" +
                                           "$TOOL.Z=120\n$BASE.X=5\nPTP q\n$BASE=$NULLFRAME:f\n");
  EXPECT_EQ(named(program, "p").tool + named(program, "p").workobject, "33");
  EXPECT_EQ(named(program, "q").tool + named(program, "q").workobject, "??");
}

TEST(KrlRules, AssignmentsAndWhatNoMoveUses) {
  const RobotProgram program = krl_program(
      "DECL E6POS kept\nINT n\nn=n+1\nother.x=3\nkept={X 1,Y 2,Z 3,A 0,B 0,C 0}\nloose={X 1,Y 2,Z 3,A 0,B 0,C 0}\n"
      "twice={X 1,Y 2,Z 3,A 0,B 0,C 0}\ntwice={X 4,Y 2,Z 3,A 0,B 0,C 0}\nlast={X 4,Y 2,Z 3,A 0,B 0,C 0}\nPTP "
      "kept\nPTP twice\nPTP last\n");
  EXPECT_EQ(remarks(program), "7 loose: no move of this file uses it\n");
  EXPECT_EQ(program.targets.size(), 4u);
  EXPECT_EQ(before(program, "twice"), "");  // which of both is not known
  EXPECT_EQ(before(program, "last"), "");
  const std::string declared = "DECL E6POS unused={X 1,Y 2,Z 3,A 0,B 0,C 0}\nDECL E6POS a[2]\n";
  EXPECT_EQ(remarks(krl_program(declared)), "2 unused: no move of this file uses it\n");
  const RobotProgram list = parse_program(ProgramLanguage::krl, "DEFDAT m\n" + declared + "ENDDAT\n", "m.dat");
  EXPECT_EQ(list.targets.size(), 1u);  // another file may use it
  EXPECT_EQ(remarks(list), "");
}

TEST(KrlRules, BitsAndNumbers) {
  const auto configuration = [](const std::string& state) {
    const RobotProgram program = krl_program("PTP {X 1,Y 2,Z 3,A 4,B 5,C 6," + state + "}\n");
    return program.targets.empty() ? std::vector<int>{-1} : program.targets[0].configuration;
  };
  EXPECT_EQ(configuration("S 'H2',T 'H32'"), (std::vector<int>{2, 50}));
  EXPECT_EQ(configuration("S 'b110',T 'hFF'"), (std::vector<int>{6, 255}));
  for (const char* wrong : {"S 2", "T 50", "S 2.5,T 3", "S 2000,T 3", "S -1,T 3", "S x,T 3", "E1 x", "E1 5", "E6 -5"})
    EXPECT_EQ(configuration(wrong), std::vector<int>{-1}) << wrong;
  EXPECT_EQ(remarks(krl_program("PTP {X 1,Y 2,Z 3,A 4,B 5,C 6,S 2.5,T 3}\n")),
            "2 {X 1,Y 2,Z 3,A 4,B 5,C 6,S 2.5,T 3}: S or T is no number of bits\n");
  EXPECT_EQ(remarks(krl_program("LIN {X 1+2,Y 2,Z 3,A 4,B 5,C 6}\nPTP_REL {X 1}\nSLIN_REL {X 1}\n")),
            "2 {X 1+2,Y 2,Z 3,A 4,B 5,C 6}: its components are no numbers\n"
            "3 PTP_REL {X 1}: a relative move\n4 SLIN_REL {X 1}: a relative move\n");
  // joint values have neither tool nor base, whatever the data list says
  const RobotProgram axes = parse_program(krl,
                                          "DEFDAT m\nDECL E6AXIS XHOME={A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\n"
                                          "DECL FDAT FHOME={TOOL_NO 3,BASE_NO 2,IPO_FRAME #BASE}\nENDDAT\n",
                                          "m.dat");
  EXPECT_EQ(named(axes, "xhome").tool, "");
  EXPECT_EQ(named(axes, "xhome").workobject, "");
}

// ---- URScript ----

RobotProgram ur_program(const std::string& lines) {
  return parse_program(urscript, "def m():\n" + lines + "end\n", "m.script", {"f"});
}

TEST(UrscriptRules, MovesAndTools) {
  const RobotProgram program = ur_program(
      "t=p[0,0,0.1,0,0,0]\ntwo=p[0,0,0.1,0,0,0]\ntwo=p[0,0,0.2,0,0,0]\nq=[0,0,0,0,0,0]\na=p[1,0,0,0,0,0]\n"
      "b=p[2,0,0,0,0,20]\nc=p[3,0,0,0,0,0]\nd=p[4,0,0,0,0,0]\ne=p[5,0,0,0,0,0]\nf=p[6,0,0,0,0,0]\n"
      "set_tcp(t)\nmovel(a, a=1.2, v=0.25)\nset_tcp(p[0,0,0.3,0,0,0], \"x\")\nservoj(b, 0, 0)\nset_tcp(two)\nmovep(c)\n"
      "set_tcp(q)\nmovec(d, e)\nset_tcp(p[0,0,0.3,0,0,0]+x)\nmovel(f)\n");
  EXPECT_EQ(named(program, "a").tool, "set_tcp of line 12");
  EXPECT_EQ(named(program, "b").tool, "set_tcp of line 14");
  for (const char* name : {"c", "d", "e", "f"}) EXPECT_EQ(named(program, name).tool, "") << name;
  EXPECT_NEAR(program.tools.at("set_tcp of line 14")(2, 3), 0.3, 1e-15);
  EXPECT_EQ(program.tools.size(), 2u);
  EXPECT_EQ(named(program, "a").move, TargetMove::linear);
  EXPECT_EQ(named(program, "b").move, TargetMove::joint);
  EXPECT_EQ(named(program, "e").move, TargetMove::linear);
  EXPECT_LT((named(program, "b").pose.linear() - exp_so3(Vector3(0, 0, 20))).norm(), 1e-12);  // several turns
  EXPECT_EQ(named(program, "a").workobject, "base");
  std::string order;
  for (const char* name : {"b", "c", "d", "e", "f"}) order += before(program, name);
  EXPECT_EQ(order, "abcde");
  EXPECT_EQ(remarks(program), "3 two: no move of this file uses it\n4 two: no move of this file uses it\n");
}

TEST(UrscriptRules, ValuesThatTheProgramChanges) {
  const RobotProgram program = ur_program(
      "a=p[1,0,0,0,0,0]\nb=p[2,0,0,0,0,0]\nc=p[3,0,0,0,0,0]\nunused=p[4,0,0,0,0,0]\nunused=f()\nmovel(a)\nmovel(b)\n"
      "b=pose_trans(b, a)\nmovel(c)\nmovel(p[5,0,0,0,0,0] , 1)\nmovel(p[5,0,0,0,0,101])\n");
  EXPECT_EQ(remarks(program),
            "5 unused: no move of this file uses it\n9 b=pose_trans(b, a): the program changes this target\n"
            "12 movel(p[5,0,0,0,0,101]): computed, not a literal\n");
  EXPECT_EQ(program.targets.size(), 3u);  // b stays as it is
  EXPECT_EQ(before(program, "c"), "");
  EXPECT_EQ(before(program, ""), "c");
}

TEST(UrscriptRules, JointsNearby) {
  const RobotProgram program = ur_program(
      "a_p=p[1,0,0,0,0,0]\na_q=[1,1,1,1,1,1]\nb_p=p[2,0,0,0,0,0]\nb_q=[2,2,2,2,2,2]\nc_p=p[3,0,0,0,0,0]\nd=[4,4,4,4,4,"
      "4]\n"
      "e=p[5,0,0,0,0,0]\nmovej(get_inverse_kin(a_p, qnear=[9,9,9,9,9,9]))\nmovej(get_inverse_kin(b_p))\n"
      "movej(get_inverse_kin(c_p, d))\nmovej(get_inverse_kin(e, [1,1,1,1,1,1]+d))\n");
  EXPECT_EQ(named(program, "a_p").joints(0), 9);
  EXPECT_EQ(named(program, "b_p").joints(0), 2);
  EXPECT_EQ(named(program, "c_p").joints(0), 4);
  EXPECT_EQ(before(program, "c_p"), "b_p");
  EXPECT_EQ(program.targets.size(), 3u);  // joints nearby are no targets
  EXPECT_EQ(remarks(program), "8 e: line 12: the joint values near it are not known\n");
}

TEST(UrscriptRules, ThreadsBeginAnewAndMarksStayInFront) {
  const std::string text =
      "\xEF\xBB\xBF"
      "a=p[1,0,0,0,0,0]\nb=p[2,0,0,0,0,0]\ndef m():\nmovel(a)\nend\nthread t():\nmovel(b)\nend\n";
  const RobotProgram program = parse_program(urscript, text, "m.script");
  EXPECT_EQ(before(program, "b"), "");
  EXPECT_EQ(stamped(text, program, {}).find("\xEF\xBB\xBF# VERNIER-CORRECTED:\na=p["), 0u);
}

TEST(UrscriptRules, NumbersAsTheControllerWritesThem) {
  const std::string text = "def m():\nmovej([1,2,3,4,5,6])\nmovel(p[1,2,3,0,0,0])\nend\n";
  const RobotProgram program = parse_program(urscript, text, "m.script");
  std::vector<ReplacedTarget> replaced(2, {0, Isometry3::Identity(), JointVector<6>::Constant(0.123456789)});
  replaced[0].joints(1) = -1e-10;
  replaced[1].target = 1;
  replaced[1].pose.translation() = Vector3(0.123456789, -1, 2);
  replaced[1].pose.linear() = exp_so3(Vector3(0, 0, 0.123456789));
  EXPECT_EQ(replace_targets(text, program, replaced),
            "def m():\nmovej([0.12345679,0.00000000,0.12345679,0.12345679,0.12345679,0.12345679])\n"
            "movel(p[0.1234568,-1.0000000,2.0000000,0.00000000,0.00000000,0.12345679])\nend\n");
}

// ---- Fanuc ----

std::string fanuc_position(int number, const std::string& configuration, const std::string& values,
                           const std::string& more = "") {
  return message("P[", number, "]{\n GP1:\n UF : 1, UT : 2, CONFIG : '", configuration, "',\n ", values, "\n", more,
                 "};\n");
}
const std::string fanuc_values = "X = 1 mm, Y = 2 mm, Z = 3 mm,\n W = 10 deg, P = 20 deg, R = 30 deg";

RobotProgram fanuc_program(const std::string& moves, const std::string& positions) {
  return parse_program(fanuc_tp, "/PROG A\n/MN\n" + moves + "/POS\n" + positions + "/END\n", "a.ls",
                       {"INCOUNT", "INC_A"});
}

TEST(FanucRules, PositionsThatAreRefused) {
  const auto told = [](const std::string& position) {
    return remarks(fanuc_program("   1:J P[1] 100% FINE ;\n", position));
  };
  const std::string usual = "N U T, 0, 0, 0";
  EXPECT_EQ(told(fanuc_position(1, usual, fanuc_values)), "");
  EXPECT_EQ(told(fanuc_position(1, usual, fanuc_values + ",\n E1 = 0 mm")), "");
  EXPECT_EQ(told(fanuc_position(1, usual, fanuc_values + ",\n E1 = 5 mm")), "5 P[1]: external axes are in use\n");
  EXPECT_EQ(told(fanuc_position(1, usual, fanuc_values, " GP2:\n UF : 0, UT : 1,\n J1 = 1 deg\n")),
            "5 P[1]: a second motion group\n");
  for (const char* turns : {"N U T, 1, 0, 0", "N U T, 0, 1, 0"})
    EXPECT_EQ(told(fanuc_position(1, turns, fanuc_values)),
              "5 P[1]: turn numbers whose axes depend on the type of robot\n");
  EXPECT_EQ(told(fanuc_position(1, "N U T, 0, 0, -100", fanuc_values)), "");
  EXPECT_EQ(told(fanuc_position(1, "N U T, 0, 0, 101", fanuc_values)),
            "5 P[1]: its configuration is missing or of another kind\n");
  for (const char* wrong : {"X = 1 deg, Y = 2 mm, Z = 3 mm, W = 4 deg, P = 5 deg, R = 6 deg",
                            "X = 1 mm, Y = 2 mm, Z = 3 mm, W = 4 deg, P = 5 deg, R = 6 mm"})
    EXPECT_EQ(told(fanuc_position(1, usual, wrong)), "5 P[1]: a component is missing or no number\n");
}

// A position that one move uses as an increment is not corrected for another; `zinc` is no option.
TEST(FanucRules, IncrementalMoves) {
  const std::string position = fanuc_position(1, "N U T, 0, 0, 0", fanuc_values);
  const RobotProgram program =
      fanuc_program("   1:L P[1] 100mm/sec FINE ;\n   2:L P[1] 100mm/sec FINE INC ;\n", position);
  EXPECT_TRUE(program.targets.empty());
  EXPECT_EQ(remarks(program),
            "4 L P[1] 100mm/sec FINE INC: a relative move\n6 P[1]: moves use it as an increment or with an offset\n");
  for (const std::string option : {"TA .1sec,DO[3:zinc]=ON", "TB .10sec,CALL INCOUNT", "TB .1sec,CALL INC_A"}) {
    const RobotProgram other = fanuc_program("   1:L P[1] 100mm/sec FINE " + option + " ;\n", position);
    EXPECT_EQ(other.targets.size(), 1u) << option;
    EXPECT_EQ(remarks(other), "") << option;
  }
  EXPECT_TRUE(fanuc_program("   1:L P[1] 100mm/sec FINE TB .1sec,CALL INC_A INC ;\n", position).targets.empty());
}

TEST(FanucRules, AllSectionsAreThere) {
  for (const char* text : {"/MN\n/POS\n/END\n", "/PROG A\n/POS\n/END\n", "/PROG A\n/POS\n/MN\n/END\n"})
    EXPECT_NE(complaint([&] { (void)parse_program(fanuc_tp, text, "a.ls"); }), "") << text;
  EXPECT_EQ(complaint([] { (void)parse_program(fanuc_tp, "/PROG A\n/MN\n/POS\n/END\n", "a.ls"); }), "");
}

TEST(FanucRules, OrderOfMoves) {
  std::string positions;
  for (const int k : {1, 2, 4, 5, 6}) positions += fanuc_position(k, "N U T, 0, 0, 0", fanuc_values);
  positions +=
      "P[3]{\n GP1:\n UF : 1, UT : 2,\n J1 = 0 deg, J2 = 1 deg, J3 = 2 deg, J4 = 3 deg, J5 = 4 deg, J6 = 5 deg\n};\n";
  const RobotProgram program = fanuc_program(
      "   1:J P[1] 100% FINE ;\n   2:L P[2] 100mm/sec FINE ;\n   3:J P[3] 100% FINE ;\n   4:L P[4] 100mm/sec FINE ;\n"
      "   5:C P[5]\n    :  P[6] 100mm/sec FINE ;\n",
      positions);
  EXPECT_EQ(before(program, "P[2]"), "P[1]");
  EXPECT_EQ(before(program, "P[4]"), "P[3]");
  EXPECT_EQ(before(program, "P[5]"), "P[4]");
  EXPECT_EQ(before(program, "P[6]"), "P[5]");
  EXPECT_EQ(named(program, "P[1]").move, TargetMove::joint);
  for (const char* name : {"P[2]", "P[5]", "P[6]"}) EXPECT_EQ(named(program, name).move, TargetMove::linear) << name;
  EXPECT_EQ(named(program, "P[1]").workobject, "1");
  EXPECT_EQ(named(program, "P[1]").tool, "2");
  EXPECT_EQ(remarks(program), "");
  EXPECT_EQ(named(program, "P[3]").kind, TargetKind::joints);
  EXPECT_NEAR(named(program, "P[3]").joints(2), 0.0349065850399, 1e-12);
}

}  // namespace
}  // namespace vernier::robot_rules_test
