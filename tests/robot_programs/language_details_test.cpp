// SPDX-License-Identifier: BSD-3-Clause
// Details of the languages that files from the field show now and then: what is read, what is refused, and where.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "read_program.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::robot_language_details_test {
namespace {

using namespace vernier_test;
using enum ProgramLanguage;

// ---- the stamp ----

std::string stamp_in(ProgramLanguage language, const std::string& text, const std::vector<std::string>& lines = {}) {
  return stamped(text, parse_program(language, text, "f"), lines);
}

// It stands where a comment may: behind the head of a program, at the beginning of one without a head.
TEST(StampsOfLanguages, StandBehindTheHead) {
  EXPECT_EQ(stamp_in(rapid, "%%%\nMODULE m(SYSMODULE,\nNOSTEPIN)\nENDMODULE\n"),
            "%%%\nMODULE m(SYSMODULE,\nNOSTEPIN)\n! VERNIER-CORRECTED:\nENDMODULE\n");
  EXPECT_EQ(stamp_in(rapid, "MODULE m\r\nENDMODULE\r\n"), "MODULE m\r\n! VERNIER-CORRECTED:\r\nENDMODULE\r\n");
  for (const std::string head : {"DEF m()", "GLOBAL DEFFCT INT m()", "DEFDAT m PUBLIC"})
    EXPECT_EQ(stamp_in(krl, "&REL 1\n" + head + "\nn=1\n"), "&REL 1\n" + head + "\n; VERNIER-CORRECTED:\nn=1\n");
  EXPECT_EQ(stamp_in(urscript, "def m():\nend\n"), "# VERNIER-CORRECTED:\ndef m():\nend\n");
  // the name of a section in the middle of a line is none
  EXPECT_EQ(stamp_in(fanuc_tp, "/PROG A\nX = /MN\n/ATTR\n/MN\n   1:  ;\n/POS\n/END\n"),
            "/PROG A\nX = /MN\n/ATTR\n/MN\n   :  !VERNIER-CORRECTED: ;\n   1:  ;\n/POS\n/END\n");
}

TEST(StampsOfLanguages, BeginALineOfTheirOwn) {
  EXPECT_EQ(stamp_in(krl, "DEF m()"), "DEF m()\n; VERNIER-CORRECTED:\n");
  EXPECT_EQ(stamp_in(rapid, "MODULE m"), "MODULE m\n! VERNIER-CORRECTED:\n");
}

TEST(StampsOfLanguages, BreakLongLines) {
  const std::string a(100, 'a'), b(31, 'b');
  EXPECT_EQ(stamp_in(urscript, "x=1\n", {a, a + "c", ""}),
            "# VERNIER-CORRECTED:\n# " + a + "\n# " + a + "\n# c\nx=1\n");
  EXPECT_EQ(stamp_in(fanuc_tp, "/PROG A\n/MN\n/POS\n/END\n", {b + "c;d"}),
            "/PROG A\n/MN\n   :  !VERNIER-CORRECTED: ;\n   :  !" + b + " ;\n   :  !c?d ;\n/POS\n/END\n");
}

// ---- texts ----

TEST(TextsOfPrograms, BinaryDataIsFoundEverywhere) {
  for (const std::string in : {"a\001b", "# a\001b", "\"a\001b\""}) {
    std::string text = "def a():\n" + in + "\nend\n";
    EXPECT_EQ(complaint([&] { (void)parse_program(urscript, text, "f"); }), "") << in;
    text[text.find('\001')] = '\0';
    EXPECT_EQ(complaint([&] { (void)parse_program(urscript, text, "f"); }), "f, line 2: binary data, not text") << in;
  }
}

TEST(TextsOfPrograms, LongLinesAreRefusedAlsoInFrontOfOthers) {
  const auto told = [](std::size_t length) {
    return complaint([&] { (void)parse_program(urscript, "a=1\n" + std::string(length, 'a') + "\nb=1\n", "f"); });
  };
  EXPECT_EQ(told(100000), "");
  EXPECT_EQ(told(100001), "f, line 2: 100001 bytes in a line, at most 100000");
}

TEST(TextsOfPrograms, AQuoteThatIsNotClosedEndsWithItsLine) {
  const std::string text = "def m():\nmovel(p[1,2,3,0,0,0])\nx=\"a(\nmovel(p[4,2,3,0,0,0])\n";
  EXPECT_EQ(parse_program(urscript, text, "f").targets.size(), 2u);
  EXPECT_EQ(parse_program(urscript, text + "\"abc", "f").targets.size(), 2u);
}

TEST(TextsOfPrograms, NamesHoldEveryLetterAndDigit) {
  const std::string name = "_aAzZ0189";
  const RobotProgram program = parse_program(urscript, name + "=p[1,2,3,0,0,0]\nmovel(" + name + ")\n", "f");
  EXPECT_EQ(remarks(program), "");
  EXPECT_EQ(named(program, name).move, TargetMove::linear);
}

TEST(ReplacedTexts, HoldAllNumbers) {
  const std::string text = "movej([1,2,3,4,5,6])";
  const RobotProgram program = parse_program(urscript, text, "f");
  ASSERT_EQ(program.targets.size(), 1u);
  const ReplacedTarget one{0, Isometry3::Identity(), JointVector<6>::Ones()};
  const std::size_t end = text.find('6') + 1;
  EXPECT_TRUE(replace_targets(text.substr(0, end), program, std::span(&one, 1)).ends_with(",1.00000000"));
  EXPECT_NE(complaint([&] { (void)replace_targets(text.substr(0, end - 1), program, std::span(&one, 1)); }), "");
}

// ---- RAPID ----

const std::string no_axes = "[9E9,9E9,9E9,9E9,9E9,9E9]";

/// A module of targets p and q in lines 2 and 3, with declarations from line 4 on and instructions behind PROC. The
/// routine f of another file is harmless.
RobotProgram rapid_module(const std::string& declarations, const std::string& instructions) {
  const std::string value = ":=[[1,0,0],[1,0,0,0],[0,0,0,0]," + no_axes + "];\n";
  return parse_program(rapid,
                       "MODULE m\nCONST robtarget p" + value + "CONST robtarget q" + value + declarations +
                           "PROC main()\n" + instructions + "ENDPROC\nENDMODULE\n",
                       "m.mod", {"f", "spotl"});
}

// Variables, functions and parts of records may have the names of moves.
TEST(RapidDetails, NamesOfMovesThatAreNone) {
  for (const char* other :
       {"spotl:=1;", "spotl.x:=1;", "spotl(1);", "n:=arcl;", "n.arcl:=2;", "f \\ArcL;", "f x,arcl;"}) {
    const RobotProgram program =
        rapid_module("", "MoveL p,v1,fine,gun;\n" + std::string(other) + "\nMoveL q,v1,fine,gun;\n");
    EXPECT_EQ(before(program, "q"), "p") << other;
    EXPECT_EQ(remarks(program), "") << other;
  }
}

TEST(RapidDetails, EveryMoveIsKnown) {
  for (const char* joint : {"MoveJ", "MoveAbsJ", "MoveJDO", "MoveJAO", "MoveJGO", "MoveJSync", "TriggJ"})
    EXPECT_EQ(named(rapid_module("", std::string(joint) + " p,v1,fine,gun;\n"), "p").move, TargetMove::joint) << joint;
  for (const char* linear : {"MoveL", "MoveLDO", "MoveLAO", "MoveLGO", "MoveLSync", "TriggL", "ArcL", "ArcLStart",
                             "ArcLEnd", "SpotL", "DispL", "PaintL"})
    EXPECT_EQ(named(rapid_module("", std::string(linear) + " p,v1,fine,gun;\n"), "p").move, TargetMove::linear)
        << linear;
  for (const char* circle :
       {"MoveC", "MoveCDO", "MoveCAO", "MoveCGO", "MoveCSync", "TriggC", "ArcC", "ArcCStart", "ArcCEnd"}) {
    const RobotProgram program = rapid_module("", std::string(circle) + " p,q,v1,fine,gun;\n");
    EXPECT_EQ(before(program, "q"), "p") << circle;
    EXPECT_EQ(named(program, "q").move, TargetMove::linear) << circle;
  }
}

TEST(RapidDetails, ArgumentsOnSeveralLines) {
  const RobotProgram program = rapid_module("", "MoveL\n p\n,v1,fine,gun;\nMoveL\nelsewhere\n,v1,fine,gun;\n");
  EXPECT_EQ(named(program, "p").move, TargetMove::linear);
  EXPECT_EQ(named(program, "p").tool, "gun");
  EXPECT_EQ(remarks(program), "9 MoveL elsewhere: declared in another file\n");
}

TEST(RapidDetails, ToolAndWorkObject) {
  EXPECT_EQ(named(rapid_module("", "MoveL p;\n"), "p").tool, "");  // its only argument is no tool
  EXPECT_EQ(named(rapid_module("", "MoveL p,gun;\n"), "p").tool, "gun");
  EXPECT_EQ(named(rapid_module("", "MoveL p,v1,fine,gun\\WObj;\n"), "p").workobject, "?");
  // an option of a function is none of the move
  const RobotProgram program = rapid_module("", "MoveL p,f(1\\WObj:=a,2),fine,gun;\n");
  EXPECT_EQ(named(program, "p").workobject, "wobj0");
  EXPECT_EQ(named(program, "p").tool, "gun");
}

TEST(RapidDetails, ChangesOfPartsOfTargets) {
  EXPECT_EQ(remarks(rapid_module("", "p.trans:=[1,2,3];\nq.robconf.cf1:=1;\nq:=p;\nr.trans.x:=1;\n")),
            "5 p.trans:=[1,2,3]: the program changes this target\n"
            "6 q.robconf.cf1:=1: the program changes this target\n7 q:=p: the program changes this target\n");
  const std::string element = "[[1,2,3],[1,0,0,0],[0,0,0,0]," + no_axes + "]";
  EXPECT_EQ(remarks(rapid_module("VAR robtarget row{2}:=[" + element + "," + element + "];\n",
                                 "row{i+1}.trans.x:=5;\nrow{2}:=p;\n")),
            "6 row{i+1}.trans.x:=5: the program changes this target\n7 row{2}:=p: the program changes this target\n");
}

TEST(RapidDetails, Declarations) {
  const auto told = [](const std::string& value) {
    return remarks(rapid_module("VAR robtarget c:=" + value + ";\n", ""));
  };
  const std::string rest = "[1,0,0,0],[0,0,0,0]," + no_axes + "]";
  EXPECT_EQ(told("Offs(p,0,0,1)"), "4 robtarget c:=Offs(p,0,0,1): computed, not a literal\n");
  for (const char* part : {"[f(1,2),8,9]", "[a{1,2},8,9]", "[-x,8,9]", "[1 2,8,9]"})
    EXPECT_EQ(told("[" + std::string(part) + ",[1,0,0,0],[0,0,0,0],none]").find("4 [["), 0u) << part;
  for (const char* part : {"[f(1,2),8,9]", "[a{1,2},8,9]", "[-x,8,9]", "[1 2,8,9]"})
    EXPECT_NE(told("[" + std::string(part) + "," + rest).find("position or orientation are no numbers"),
              std::string::npos)
        << part;
  EXPECT_NE(told("[[1,2,3]+v," + rest).find("no literal of this type"), std::string::npos);
  EXPECT_EQ(told("[[1),2,3]," + rest).find("4 [[1),2,3]"), 0u);  // a bracket too many closes nothing
  EXPECT_NE(told("[[1,2,3],[1,0,0,0],[0,0,0,0],[8.8E8,9E9,9E9,9E9,9E9,9E9]]").find("external axes are in use"),
            std::string::npos);
  EXPECT_EQ(told("[[1,2,3],[1,0,0,0],[0,0,0,0],[9E8,9E9,9E9,9E9,9E9,9E9]]"), "");
  // in another configuration other joint values err otherwise
  EXPECT_EQ(told("[[1,2,3],[1,0,0,0],conf," + no_axes + "]"),
            "4 [[1,2,3],[1,0,0,0],conf," + no_axes + "]: its configuration is no literal\n");
  // joint values
  EXPECT_EQ(remarks(rapid_module("VAR jointtarget j:=[[1,2,x,4,5,6]," + no_axes + "];\n", "")),
            "4 [[1,2,x,4,5,6]," + no_axes + "]: joint values are no numbers\n");
  // a value of another type that looks like a target is none
  EXPECT_EQ(rapid_module("VAR other o:=[[1,2,3]," + rest + ";\n", "").targets.size(), 2u);
}

// ---- KRL ----

RobotProgram krl_lines(const std::string& lines) {
  return parse_program(krl, "DEF m()\n" + lines + "END\n", "m.src", {"f", "p"});
}
const std::string krl_value = "={X 1,Y 2,Z 3,A 0,B 0,C 0}\n";

TEST(KrlDetails, EveryMoveIsKnown) {
  for (const char* name : {"PTP", "SPTP", "LIN", "SLIN", "SPL"}) {
    const RobotProgram program = krl_lines("p" + krl_value + name + " p C_DIS\n");
    EXPECT_EQ(named(program, "p").move, std::string(name).ends_with("PTP") ? TargetMove::joint : TargetMove::linear)
        << name;
  }
  for (const char* name : {"CIRC", "SCIRC"}) {
    const RobotProgram program = krl_lines("p" + krl_value + "q" + krl_value + name + " p, q, CA 30 C_DIS\n");
    EXPECT_EQ(before(program, "q"), "p") << name;
    EXPECT_EQ(named(program, "p").move, TargetMove::linear) << name;
    EXPECT_EQ(remarks(program), "") << name;
  }
  for (const char* name : {"PTP_REL", "LIN_REL", "SPTP_REL", "SLIN_REL", "SPL_REL"})
    EXPECT_EQ(remarks(krl_lines(std::string(name) + " {X 1}\n")), message("2 ", name, " {X 1}: a relative move\n"));
  for (const char* name : {"CIRC_REL", "SCIRC_REL"})
    EXPECT_EQ(remarks(krl_lines(std::string(name) + " {X 1},{X 2}\n")),
              message("2 ", name, " {X 1}: a relative move\n2 ", name, " {X 1},{X 2}: a relative move\n"));
}

TEST(KrlDetails, AnyComponentMakesAPositionAndOthersDoNot) {
  for (const char* one : {"{X 1}", "{Y 1}", "{Z 1}", "{A1 1}", "{A6 1}", "{A 90}", "{B 5,C 6}"})
    EXPECT_EQ(remarks(krl_lines("PTP " + std::string(one) + "\n")),
              message("2 ", one, ": components are missing, those of the position before are kept\n"));
  for (const char* other : {"{V1 1,B2 3}", "{A7 1}", "{A0 1}", "{VEL 1}", "{A 1}"})
    EXPECT_EQ(remarks(krl_lines("o=" + std::string(other) + "\n")), "") << other;
}

TEST(KrlDetails, SeveralNamesInADeclaration) {
  const RobotProgram program =
      krl_lines("DECL GLOBAL E6POS a, b[2], c" + krl_value + "a" + krl_value + "b[1]" + krl_value + "d" + krl_value);
  EXPECT_EQ(program.targets.size(), 3u);  // of those another file may move to a, b and c
  EXPECT_EQ(remarks(program), "5 d: no move of this file uses it\n");
}

TEST(KrlDetails, ElementsOfArrays) {
  const RobotProgram program = krl_lines("p" + krl_value + "row[1]" + krl_value + "row[2]" + krl_value + "q" +
                                         krl_value + "one[1]" + krl_value + "PTP p\nPTP row[i+1]\nPTP q\nLIN one[1]\n");
  EXPECT_EQ(before(program, "q"), "");
  EXPECT_EQ(before(program, "one"), "q");
  EXPECT_EQ(named(program, "row").move, TargetMove::joint);
  EXPECT_EQ(named(program, "one").move, TargetMove::linear);
  EXPECT_EQ(remarks(program), "");
}

TEST(KrlDetails, WhatChangesATarget) {
  const std::string used = "p" + krl_value + "PTP p\n";
  for (const char* nothing : {"p(1)", "p==q", "n=p", "WAIT SEC 1", "q.x=1"})
    EXPECT_EQ(remarks(krl_lines(used + nothing + "\n")), "") << nothing;
  for (const char* change : {"p=q", "p.x=1", "p[1]=q", "p[1].x=1", "p=f({X 1})"})
    EXPECT_EQ(remarks(krl_lines(used + change + "\n")), message("4 ", change, ": the program changes this target\n"));
}

TEST(KrlDetails, NumbersOfBits) {
  const auto configuration = [](const std::string& status) {
    const RobotProgram program = krl_lines("PTP {X 1,Y 2,Z 3,A 4,B 5,C 6,S " + status + ",T 'B11'}\n");
    return program.targets.empty() ? std::vector<int>{} : program.targets[0].configuration;
  };
  EXPECT_EQ(configuration("'B1'"), (std::vector<int>{1, 3}));
  EXPECT_EQ(configuration("0"), (std::vector<int>{0, 3}));
  EXPECT_EQ(configuration("1023"), (std::vector<int>{1023, 3}));
  for (const char* wrong : {"1024", "\"H2\"", "'X12'", "'B12'", "'B'", "'HFFFFFFFFFFF'", "'12'"})
    EXPECT_EQ(configuration(wrong), std::vector<int>{}) << wrong;
}

TEST(KrlDetails, FlangeData) {
  const auto frames = [](const std::string& fdat) {
    const RobotProgram program =
        parse_program(krl, "DEFDAT m\nDECL E6POS XP" + krl_value + "DECL FDAT FP={" + fdat + "}\nENDDAT\n", "m.dat");
    return named(program, "xp").tool + "/" + named(program, "xp").workobject;
  };
  EXPECT_EQ(frames("TOOL_NO 3,BASE_NO 2,IPO_FRAME #BASE"), "3/2");
  EXPECT_EQ(frames("TOOL_NO n,BASE_NO 2"), "?/2");
  EXPECT_EQ(frames("TOOL_NO 3,BASE_NO n+1"), "3/?");
  EXPECT_EQ(frames("BASE_NO 2"), "/2");
}

TEST(KrlDetails, OtherCallsOfBasKeepToolAndBase) {
  const RobotProgram program =
      krl_lines("BAS(#TOOL,4)\nBAS(#BASE,5)\nBAS(#VEL_PTP,100)\nPTP {X 1,Y 2,Z 3,A 0,B 0,C 0}\n");
  ASSERT_EQ(program.targets.size(), 1u);
  EXPECT_EQ(program.targets[0].tool + program.targets[0].workobject, "45");
}

// ---- URScript ----

RobotProgram ur_lines(const std::string& lines) {
  return parse_program(urscript, "def m():\n" + lines + "end\n", "m.script", {"f"});
}

TEST(UrscriptDetails, ArgumentsOfMoves) {
  const std::string assigned = "a=p[1,0,0,0,0,0]\n";
  for (const char* call :
       {"movel(\na\n, 1)", "movel(a)", "movep(\n a)", "movel(get_inverse_kin(a))", "servoc(a,f(1,2))"}) {
    const RobotProgram program = ur_lines(assigned + call + "\n");
    EXPECT_EQ(named(program, "a").move, TargetMove::linear) << call;
    EXPECT_EQ(remarks(program), "") << call;
  }
  const auto told = [](const std::string& call) { return remarks(ur_lines("movel(p[1,0,0,0,0,0])\n" + call + "\n")); };
  EXPECT_EQ(told("movel()"), "3 movel(): no target\n");
  EXPECT_EQ(told("movel( , 1)"), "3 movel(): no target\n");
  EXPECT_EQ(told("movec(p[1,0,0,0,0,0])"), "3 movec(): no target\n");
  EXPECT_EQ(told("movel(get_inverse_kin)"), "3 movel(get_inverse_kin): not assigned in this file\n");
  for (const char* computed : {"get_inverse_kin(p[1,0,0,0,0,0])+d", "[a[0],2,3,4,5,6]", "[1,2,3,4,5]", "f(a)",
                               "get_inverse_kin(get_inverse_kin(a))", "p[1,2,3,0,0,0]+x"})
    EXPECT_EQ(told("movel(" + std::string(computed) + ")"),
              message("3 movel(", computed, "): computed, not a literal\n"));
}

TEST(UrscriptDetails, Assignments) {
  const auto told = [](const std::string& lines) { return remarks(ur_lines(lines + "movel(a)\n")); };
  EXPECT_EQ(told("a=p[1,0,0,0,0,0];b=1\n"), "");
  EXPECT_EQ(told("if x: a=p[1,0,0,0,0,0]: end\n"), "");
  EXPECT_EQ(told("a=p[1,0,0,0,0,0]+x\n"), "3 movel(a): computed, not a literal\n");
  EXPECT_EQ(told("a=p [1,0,0,0,0,0]\n"), "3 movel(a): computed, not a literal\n");
  EXPECT_EQ(told("if a==p[1,0,0,0,0,0]:\n"), "3 movel(a): not assigned in this file\n");
  EXPECT_EQ(told("f(a=p[1,0,0,0,0,0])\n"), "3 movel(a): not assigned in this file\n");  // a named argument
}

TEST(UrscriptDetails, JointsNearbyThatAreNotKnown) {
  const auto known = [](const std::string& near) {
    const RobotProgram program = ur_lines(
        "e=p[5,0,0,0,0,0]\nd=[4,4,4,4,4,4]\nc=[3,3,3,3,3,3]\nc=f()\nmovej(get_inverse_kin(e, " + near + "))\n");
    return program.targets.size() == 1 && named(program, "e").joints.allFinite();
  };
  EXPECT_TRUE(known("d"));
  EXPECT_TRUE(known("qnear=d"));
  EXPECT_TRUE(known("[1,1,1,1,1,1]"));
  for (const char* other : {"d+d", "qnear=d*2", "c", "x", "d[0]"}) EXPECT_FALSE(known(other)) << other;
  // of two values of the partner of a pose nobody knows which
  EXPECT_FALSE(named(ur_lines("a_p=p[5,0,0,0,0,0]\na_q=[1,1,1,1,1,1]\na_q=[2,2,2,2,2,2]\nmovel(a_p)\n"), "a_p")
                   .joints.allFinite());
}

// ---- Fanuc ----

std::string tp_position(const std::string& body) { return "P[1]{\n" + body + "\n};\n"; }
const std::string tp_values = "X = 1 mm, Y = 2 mm, Z = 3 mm,\n W = 10 deg, P = 20 deg, R = 30 deg";

RobotProgram tp_program(const std::string& moves, const std::string& positions) {
  return parse_program(fanuc_tp, "/PROG A\n/MN\n" + moves + "/POS\n" + positions + "/END\n", "a.ls");
}

TEST(FanucDetails, Configurations) {
  const auto told = [](const std::string& configuration) {
    return remarks(
        tp_program("", tp_position(" GP1:\n UF : 1, UT : 2, CONFIG : '" + configuration + "',\n " + tp_values)));
  };
  for (const char* good : {"N U T, 0, 0, 0", "F D B, 0, 0, 100", "NUT,0,0,-100", "N,U,T,0,0,0"})
    EXPECT_EQ(told(good), "") << good;
  for (const char* wrong : {"U T, 0, 0, 0", "N T, 0, 0, 0", "N U, 0, 0, 0", "N U T, 0, 0", "N U T, 0, 0, 0, 0",
                            "N U T, 0, 0, -", "N U T, 0, 0, 99999999999", "N U T, 0, 0, -101", "N U T, 0, 0, 101", ""})
    EXPECT_EQ(told(wrong), "4 P[1]: its configuration is missing or of another kind\n") << wrong;
}

TEST(FanucDetails, GroupsAndFrames) {
  const std::string state = " UF : 1, UT : 2, CONFIG : 'N U T, 0, 0, 0',\n ";
  EXPECT_EQ(remarks(tp_program("", tp_position(state + tp_values))), "4 P[1]: no group 1\n");
  EXPECT_EQ(remarks(tp_program("", tp_position(" GP2:\n" + state + tp_values))), "4 P[1]: no group 1\n");
  const RobotProgram program =
      tp_program("", tp_position(" GP1:\n UF : F, UT : 12, CONFIG : 'N U T, 0, 0, 0',\n " + tp_values));
  EXPECT_EQ(named(program, "P[1]").workobject, "?");
  EXPECT_EQ(named(program, "P[1]").tool, "12");
  // frames and tools 0 are the robot's own
  for (const auto& frames : {program.tools, program.workobjects}) {
    ASSERT_EQ(frames.count("0"), 1u);
    EXPECT_TRUE(frames.at("0").isApprox(Isometry3::Identity(), 0));
  }
}

TEST(FanucDetails, HeadsOfPositions) {
  const std::string body = "{\n GP1:\n UF : 1, UT : 2, CONFIG : 'N U T, 0, 0, 0',\n " + tp_values + "\n};\n";
  const RobotProgram program =
      tp_program("", "P[7] is no position\nP[x]" + body + "P[3]\n\n" + body + "p[4:\"a\"]" + body);
  EXPECT_EQ(program.targets.size(), 2u);
  EXPECT_EQ(named(program, "P[3]").line, 11u);
  EXPECT_EQ(named(program, "P[4]").tool, "2");
  EXPECT_EQ(remarks(program), "");
}

TEST(FanucDetails, Instructions) {
  const std::string position = tp_position(" GP1:\n UF : 1, UT : 2, CONFIG : 'N U T, 0, 0, 0',\n " + tp_values);
  for (const char* move : {"1:J P[1] 100% FINE ;", "\t 1:J P[1] 100% FINE ;", "1 : J P[1] 100% FINE ;",
                           ":J P[1] 100% FINE ;", "1:J\tP[1] 100% FINE ;", "1:  ;\n\n2:J P[1] 5% FINE ;"})
    EXPECT_EQ(named(tp_program(std::string(move) + "\n", position), "P[1]").move, TargetMove::joint) << move;
  for (const char* none : {"1:!J P[1] 100% FINE ;", "1:JP[1] 100% FINE ;", "1:X P[1] 100% FINE ;",
                           "x:J P[1] 100% FINE ;", "J P[1] 100% FINE ;"})
    EXPECT_EQ(named(tp_program(std::string(none) + "\n", position), "P[1]").move, TargetMove::unknown) << none;
  // what follows the speed are options; a comment of a position is none
  for (const char* speed : {"900mm/sec", "100mm/sec", "50cm/min"}) {
    const std::string move = "   1:L P[1:\"my offset\"] " + std::string(speed) + " FINE";
    EXPECT_EQ(remarks(tp_program(move + " ;\n", position)), "") << speed;
    EXPECT_NE(remarks(tp_program(move + " Offset,PR[1] ;\n", position)).find("an offset that a register adds"),
              std::string::npos)
        << speed;
  }
  for (const char* comment : {"weld inc", "Offset pos", "seam 2 inc", "'9 offset'"})
    for (const char* move : {"J P[1:", "L P[1:"}) {
      const std::string text =
          "   1:" + std::string(move) + comment + (move[0] == 'J' ? "] 90% FINE" : "] 90mm/sec FINE");
      EXPECT_EQ(remarks(tp_program(text + " ;\n", position)), "") << text;
      EXPECT_NE(remarks(tp_program(text + " Offset,PR[1] ;\n", position)).find("an offset that a register adds"),
                std::string::npos)
          << text;
      EXPECT_NE(remarks(tp_program(text + " INC ;\n", position)).find("a relative move"), std::string::npos) << text;
    }
  // lines of remarks
  EXPECT_EQ(
      remarks(tp_program("1:  ;\n2:C P[1]\n:  P[9] 100mm/sec FINE ;\n\n3:L PR[2] 100mm/sec FINE ;\n", position)),
      "4 C P[1] : P[9] 100mm/sec FINE: no position of this file\n7 L PR[2] 100mm/sec FINE: a position register\n");
}

}  // namespace
}  // namespace vernier::robot_language_details_test
