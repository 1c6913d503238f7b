// SPDX-License-Identifier: BSD-3-Clause
// Statements of robot programs that nearly are something else: each is read as what it is, and what cannot be read says
// so.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "complaint.hpp"
#include "read_program.hpp"
#include "vernier/core/check.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::robot_near_misses_test {
namespace {

using namespace vernier_test;
using enum ProgramLanguage;

// ---- Fanuc ----

const std::string tp_frames = " UF : 1, UT : 2, CONFIG : 'N U T, 0, 0, 0',\n";
const std::string tp_place = " X = 1 mm, Y = 2 mm, Z = 3 mm,\n W = 10 deg, P = 20 deg, R = 30 deg";
std::string tp_position(int number, const std::string& more = "", const std::string& frames = tp_frames) {
  return message("P[", number, "]{\n GP1:\n", frames, tp_place, more, "\n};\n");
}
RobotProgram tp(const std::string& moves, const std::string& positions) {
  return parse_program(fanuc_tp, "/PROG A\n/MN\n" + moves + "/POS\n" + positions + "/END\n", "a.ls");
}

TEST(FanucNearMisses, Sections) {
  EXPECT_NE(complaint([] { (void)parse_program(fanuc_tp, "/PROG A\n/POS\n/MN\n/END\n", "f"); }), "");
  const std::string text = "/PROG A\nA MN\n/MN\n   1:  ;\n/POS\n/END\n";
  EXPECT_EQ(stamped(text, parse_program(fanuc_tp, text, "f"), {}),
            "/PROG A\nA MN\n/MN\n   :  !VERNIER-CORRECTED: ;\n   1:  ;\n/POS\n/END\n");
}

TEST(FanucNearMisses, WordsOfPositions) {
  // words that begin as joints and external axes do
  EXPECT_EQ(remarks(tp("", tp_position(1, ",\n JOG = 1 mm, EXT = 5 mm, UFO = 3"))), "");
  for (const char* axes : {", E1 = 5 mm, E2 = 0 mm", ", E1 = F, E2 = 0 mm"})
    EXPECT_EQ(remarks(tp("", tp_position(1, axes))), "4 P[1]: external axes are in use\n") << axes;
  const auto frames = [](const std::string& stated) {
    const RobotProgram program = tp("", tp_position(1, "", stated));
    return named(program, "P[1]").workobject + "/" + named(program, "P[1]").tool;
  };
  EXPECT_EQ(frames(" UF : 3, UT : F, CONFIG : 'N U T, 0, 0, 0',\n"), "3/?");
  EXPECT_EQ(frames(" UF = 3, UT : 2, CONFIG : 'N U T, 0, 0, 0',\n"), "/2");
  for (const char* none : {"CONFIG = 'N U T, 0, 0, 0'", "CONFIG : N", "OTHER : 'N U T, 0, 0, 0'"})
    EXPECT_EQ(remarks(tp("", tp_position(1, "", " UF : 1, UT : 2, " + std::string(none) + ",\n"))),
              "4 P[1]: its configuration is missing or of another kind\n")
        << none;
  EXPECT_EQ(named(tp("", tp_position(1, "", " CONFIG : 'N U T, 0, 0, 9',\n")), "P[1]").configuration.back(), 9);
}

TEST(FanucNearMisses, MovesToSeveralPositions) {
  const std::string both = tp_position(1) + tp_position(2) + tp_position(3);
  const RobotProgram circle = tp("1:C P[1]\n :  P[2] 100mm/sec FINE ;\n", both);
  EXPECT_EQ(before(circle, "P[2]"), "P[1]");
  for (const char* move : {"C P[1]\n :  P[2] 100mm/sec FINE X P[3]", "J P[1] 100% FINE X P[3]"})  // no target there
    EXPECT_EQ(named(tp("1:" + std::string(move) + " ;\n", both), "P[3]").move, TargetMove::unknown) << move;
  // from where nobody knows: a register, a position that is not read, one of another file
  for (const char* move : {"PR[1]", "P[9]", "P[4]"}) {
    const std::string refused = "P[4]{\n GP1:\n UF : 0, UT : 1,\n J1 = 1 deg\n};\n";
    const RobotProgram program =
        tp("1:L P[1] 5mm/sec FINE ;\n2:L " + std::string(move) + " 5mm/sec FINE ;\n3:L P[2] 5mm/sec FINE ;\n",
           both + refused);
    EXPECT_EQ(before(program, "P[2]"), "") << move;
  }
  EXPECT_EQ(remarks(tp("1:L PR[2] 100mm/sec FINE;\n", "")), "3 L PR[2] 100mm/sec FINE: a position register\n");
}

TEST(FanucNearMisses, StampsHoldPrintableCharacters) {
  const std::string text = "/PROG A\n/MN\n/POS\n/END\n";
  EXPECT_EQ(stamped(text, parse_program(fanuc_tp, text, "f"), {"a~ !\x7F\x1F;"}),
            "/PROG A\n/MN\n   :  !VERNIER-CORRECTED: ;\n   :  !a~ !??? ;\n/POS\n/END\n");
}

// ---- KRL ----

RobotProgram krl_lines(const std::string& lines) {
  return parse_program(krl, "DEF m()\n" + lines + "END\n", "m.src", {"f"});
}
const std::string krl_place = "{X 1,Y 2,Z 3,A 0,B 0,C 0}";

TEST(KrlNearMisses, ToolsOfWhichNothingIsKnown) {
  const auto tool = [](const std::string& line) {
    const RobotProgram program =
        krl_lines("TOOL_DATA[3]=" + krl_place + "\nBAS(#TOOL,3)\n" + line + "\nPTP " + krl_place + "\n");
    return program.targets.empty() ? "none" : program.targets[0].tool;
  };
  EXPECT_EQ(tool("$TOOL=$NULLFRAME"), "0");
  EXPECT_EQ(tool("$TOOL=TOOL_DATA[5]"), "5");
  EXPECT_EQ(tool("BAS(#TOOL,5)"), "5");
  for (const char* unknown : {"$TOOL=f()", "$TOOL=mine", "$TOOL=$NULLFRAME:mine", "$TOOL=TOOL_DATA[5]:mine",
                              "$TOOL=TOOL_DATA[n]", "$TOOL=TOOL_DATA[5,1]", "$TOOL=BASE_DATA[5]", "BAS(#TOOL,n)"})
    EXPECT_EQ(tool(unknown), "?") << unknown;
  for (const char* other : {"BAS(#BASE,5)", "BAS(#VEL_CP,5)", "$LOAD=f()"}) EXPECT_EQ(tool(other), "3") << other;
  for (const char* wrong : {"BAS(#TOOL)", "BAS(TOOL,5)", "BAS #TOOL,5", "BAS(#TOOL 5)", "$TOOLS=f()"})
    EXPECT_EQ(tool(wrong), "none") << wrong;
}

TEST(KrlNearMisses, RoutinesBeginWithoutToolAndOrder) {
  for (const char* routine : {"DEF b()", "GLOBAL DEFFCT INT b()"}) {
    const RobotProgram program = parse_program(
        krl, "DEF a()\nBAS(#TOOL,3)\nPTP " + krl_place + "\nEND\n" + routine + "\np=" + krl_place + "\nPTP p\nEND\n",
        "m.src");
    EXPECT_EQ(named(program, "p").tool, "") << routine;
    EXPECT_EQ(before(program, "p"), "") << routine;
  }
}

TEST(KrlNearMisses, ComponentsThatAreNoNumbers) {
  for (const char* x : {"f(1,2)", "a[1,2]", "{1,2}", "1+2", "n"})
    EXPECT_EQ(remarks(krl_lines("PTP {X " + std::string(x) + ",Y 2,Z 3,A 0,B 0,C 0}\n")),
              "2 {X " + std::string(x) + ",Y 2,Z 3,A 0,B 0,C 0}: its components are no numbers\n");
  EXPECT_EQ(remarks(krl_lines("PTP {X 1,Y 2,Z 3,A 0,B 0,C 0,S 'B1'+1,T 2}\n")),
            "2 {X 1,Y 2,Z 3,A 0,B 0,C 0,S 'B1'+1,T 2}: S or T is no number of bits\n");
  const auto axes = [](const std::string& more) {
    return remarks(krl_lines("PTP {X 1,Y 2,Z 3,A 0,B 0,C 0," + more + "}\n"));
  };
  for (const char* used : {"E1 1", "E6 0.5", "E3 n"})
    EXPECT_EQ(axes(used), message("2 {X 1,Y 2,Z 3,A 0,B 0,C 0,", used, "}: external axes are in use\n"));
  for (const char* unused : {"E1 0,E6 0", "E7 1", "E0 1", "EX 1"}) EXPECT_EQ(axes(unused), "") << unused;
}

TEST(KrlNearMisses, ValuesOfOtherKinds) {
  for (const char* other : {"o={A10 5,V 1}", "o={S 2,T 3}", "o={B 5}", "PTP=5", "FDAT F1", "DECL E6POS", "LIN {S 2}"})
    EXPECT_EQ(remarks(krl_lines(std::string(other) + "\n")), "") << other;
  for (const char* turn : {"{B 5}", "{C 6}"})
    EXPECT_EQ(remarks(krl_lines("LIN " + std::string(turn) + "\n")),
              message("2 ", turn, ": components are missing, those of the position before are kept\n"));
  EXPECT_EQ(remarks(krl_lines("CIRC " + krl_place + "\n")), "");  // its second point is in the next line, or nowhere
}

TEST(KrlNearMisses, MovesToWhatIsComputed) {
  for (const char* argument : {"p:q", "f(p)", "row[1].x", "{X 1}:p"})
    EXPECT_EQ(remarks(krl_lines("LIN " + std::string(argument) + "\n")),
              message("2 LIN ", argument, ": computed, not a literal\n"));
  EXPECT_EQ(remarks(krl_lines("LIN other\n")), "2 LIN other: no literal of this file, perhaps of its data list\n");
  EXPECT_EQ(remarks(krl_lines("LIN other[3]\n")),
            "2 LIN other[3]: no literal of this file, perhaps of its data list\n");
  // from where the arm comes after such a move nobody knows
  const RobotProgram program =
      krl_lines("p=" + krl_place + "\nq=" + krl_place + "\nLIN p\nLIN p:d\nLIN q\nLIN_REL {X 1}\n");
  EXPECT_EQ(before(program, "q"), "");
}

// ---- RAPID ----

const std::string no_axes = "[9E9,9E9,9E9,9E9,9E9,9E9]";
const std::string rapid_value = "[[1,0,0],[1,0,0,0],[0,0,0,0]," + no_axes + "]";
RobotProgram rapid_module(const std::string& declarations, const std::string& instructions) {
  return parse_program(rapid,
                       "MODULE m\nCONST robtarget p:=" + rapid_value + ";\nCONST robtarget q:=" + rapid_value + ";\n" +
                           declarations + "PROC main()\n" + instructions + "ENDPROC\nENDMODULE\n",
                       "m.mod", {"f"});
}

TEST(RapidNearMisses, ArgumentsAndPartsAreNoChanges) {
  for (const char* other : {"f\\p:=5;", "f \\q:=[1,2];", "r.p:=5;", "n:=p.trans.x;"})
    EXPECT_EQ(remarks(rapid_module("", "MoveL p,v1,fine,gun;\n" + std::string(other) + "\n")), "") << other;
  EXPECT_EQ(remarks(rapid_module("", "p\n:=q;\n")), "5 p :=q: the program changes this target\n");
}

TEST(RapidNearMisses, RoutinesBeginWithoutOrder) {
  for (const char* routine : {"PROC b()", "FUNC num b()", "TRAP b"}) {
    const RobotProgram program =
        rapid_module("", "MoveL p,v1,fine,gun;\n" + std::string(routine) + "\nMoveL q,v1,fine,gun;\n");
    EXPECT_EQ(before(program, "q"), "") << routine;
  }
}

TEST(RapidNearMisses, ToolsThatTheRobotDoesNotHold) {
  const auto known = [](const std::string& data) {
    return rapid_module("PERS tooldata t:=" + data + ";\n", "").tools.count("t") > 0;
  };
  const std::string load = "[1,[0,0,1],[1,0,0,0],0,0,0]";
  EXPECT_TRUE(known("[TRUE,[[1,2,3],[1,0,0,0]]," + load + "]"));
  for (const char* first : {"FALSE", "[TRUE]", "1", "held", "\"TRUE\""})
    EXPECT_FALSE(known("[" + std::string(first) + ",[[1,2,3],[1,0,0,0]]," + load + "]")) << first;
  for (const char* frame : {"[[1,2],[1,0,0,0]]", "[[1,2,3],[1,0,0]]", "[[1,2,3]]", "[[1,2,3],[1,0,0,0],[1]]", "f",
                            "[[1,2,x],[1,0,0,0]]", "[[1,2,3],[2,0,0,0]]"})
    EXPECT_FALSE(known("[TRUE," + std::string(frame) + "," + load + "]")) << frame;
  EXPECT_FALSE(known("[TRUE,[[1,2,3],[1,0,0,0]]]"));

  const auto object = [](const std::string& head) {
    return rapid_module("PERS wobjdata w:=[" + head + ",\"\",[[1,0,0],[1,0,0,0]],[[0,1,0],[1,0,0,0]]];\n", "")
               .workobjects.count("w") > 0;
  };
  EXPECT_TRUE(object("FALSE,TRUE"));
  for (const char* moving : {"TRUE,TRUE", "FALSE,FALSE", "x,TRUE", "FALSE,x"}) EXPECT_FALSE(object(moving)) << moving;
  EXPECT_EQ(rapid_module("PERS wobjdata w:=[FALSE,TRUE,[[1,0,0],[1,0,0,0]],[[0,1,0],[1,0,0,0]]];\n", "")
                .workobjects.count("w"),
            0u);
}

TEST(RapidNearMisses, ExternalAxesByName) {
  const auto told = [](const std::string& axes) {
    return remarks(rapid_module("VAR extjoint none:=" + no_axes +
                                    ";\nVAR extjoint some:=[1,9E9,9E9,9E9,9E9,9E9];\nVAR num other:=" + no_axes +
                                    ";\nVAR robtarget c:=[[1,2,3],[1,0,0,0],[0,0,0,0]," + axes + "];\n",
                                ""));
  };
  EXPECT_EQ(told("none"), "");
  EXPECT_EQ(told("NONE"), "");
  for (const char* used : {"some", "other", "[1,2,3,4,5,6]", "[9E9,9E9,9E9,9E9,9E9,x]"})
    EXPECT_NE(told(used).find("external axes are in use"), std::string::npos) << used;
}

TEST(RapidNearMisses, ArgumentsThatGoOnBehindALiteral) {
  const RobotProgram program = rapid_module("", "MoveL " + rapid_value +
                                                    ",v1,fine,gun;\nMoveL Offs(p,1,2,3),v1,fine,gun\\WObj:=w;\n"
                                                    "MoveL q\\ID:=5,v1,fine,gun;\n");
  EXPECT_EQ(program.targets[0].tool, "gun");
  EXPECT_EQ(named(program, "q").tool, "gun");
  EXPECT_EQ(remarks(program), "6 MoveL Offs(p,1,2,3): computed, not a literal\n");
}

// However many moves use it so.
TEST(RapidNearMisses, ATargetInSeveralToolsIsListedOnce) {
  const RobotProgram program =
      rapid_module("", "MoveL p,v1,fine,gun;\nMoveL p,v1,fine,tool0;\nMoveL p,v1,fine,other;\n");
  EXPECT_EQ(remarks(program), "2 p: moves use it with different tools or work objects\n");
}

// ---- URScript ----

RobotProgram ur_lines(const std::string& lines) {
  return parse_program(urscript, "def m():\n" + lines + "end\n", "m.script", {"f"});
}

TEST(UrscriptNearMisses, Moves) {
  for (const char* joint : {"movej", "servoj"})
    EXPECT_EQ(named(ur_lines("a=[1,1,1,1,1,1]\n" + std::string(joint) + "(a)\n"), "a").move, TargetMove::joint)
        << joint;
  EXPECT_EQ(remarks(ur_lines("movel(f[1,2], 3)\n")), "2 movel(f[1,2]): computed, not a literal\n");
  EXPECT_EQ(remarks(ur_lines("movel(f{1,2}, 3)\n")), "2 movel(f{1,2}): computed, not a literal\n");
}

TEST(UrscriptNearMisses, JointsNearbyAndPartners) {
  const auto joints_known = [](const std::string& lines) { return named(ur_lines(lines), "a").joints.allFinite(); };
  const std::string pose = "a=p[1,0,0,0,0,0]\n", near = "n=[1,1,1,1,1,1]\n";
  EXPECT_TRUE(joints_known(pose + near + "movej(get_inverse_kin(a, n))\n"));
  EXPECT_FALSE(joints_known(pose + near + "movej(get_inverse_kin(a))\n"));
  EXPECT_FALSE(joints_known(pose + near + "movej(get_inverse_kin(a), n)\n"));  // of the move, not of the function
  // names of a pair end with _p and _q
  EXPECT_TRUE(named(ur_lines("b_p=p[1,0,0,0,0,0]\nb_q=[1,1,1,1,1,1]\nmovel(b_p)\n"), "b_p").joints.allFinite());
  EXPECT_FALSE(named(ur_lines("bp=p[1,0,0,0,0,0]\nbq=[1,1,1,1,1,1]\nmovel(bp)\n"), "bp").joints.allFinite());
}

TEST(UrscriptNearMisses, ToolsThatAreComputed) {
  const auto tool = [](const std::string& argument) {
    const RobotProgram program =
        ur_lines("t=p[0,0,0.1,0,0,0]\na=p[1,0,0,0,0,0]\nset_tcp(" + argument + ")\nmovel(a)\n");
    return named(program, "a").tool;
  };
  for (const char* known : {"t", "p[0,0,0.1,0,0,0]", "t, \"gun\"", "p[0,0,0.1,0,0,0], \"gun\""})
    EXPECT_EQ(tool(known), "set_tcp of line 4") << known;
  for (const char* unknown : {"t+d", "f(t)", "other", "[1,1,1,1,1,1]", "p[0,0,0.1,0,0,0]+d", "p[0,0,z,0,0,0]"})
    EXPECT_EQ(tool(unknown), "") << unknown;
}

}  // namespace
}  // namespace vernier::robot_near_misses_test
