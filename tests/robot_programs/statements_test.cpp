// SPDX-License-Identifier: BSD-3-Clause
// Statements between moves: which of them void the targets behind them, how far, and what ends that.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "read_program.hpp"
#include "vernier/core/check.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::robot_statements_test {
namespace {

using namespace vernier_test;
using enum ProgramLanguage;

/// The names of targets that are corrected, in their order.
std::string corrected(const RobotProgram& program) {
  std::string out;
  for (const ProgramTarget& target : program.targets) out += target.name;
  return out;
}

/// The remark about a target; empty where there is none.
std::string about(const RobotProgram& program, const std::string& name) {
  for (const Uncorrected& one : program.uncorrected)
    if (one.text == name) return one.reason;
  return "";
}

// ---- programs of targets a, b, c and lines between moves to them ----

const std::string rapid_value = "[[1,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n";

/// Line 1: MODULE; a, b, c, d and j in lines 2 to 6; PROC in line 7.
RobotProgram rapid_lines(const std::string& lines, const std::string& routines = "",
                         const std::vector<std::string>& harmless = {}) {
  std::string text = "MODULE m\n";
  for (const char* name : {"a", "b", "c", "d"}) text += message("CONST robtarget ", name, ":=", rapid_value);
  return parse_program(rapid,
                       text + "CONST jointtarget j:=[[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nPROC main()\n" +
                           lines + "ENDPROC\n" + routines + "ENDMODULE\n",
                       "m.mod", harmless);
}
std::string rapid_move(const std::string& target) { return "MoveJ " + target + ",v1,fine,tool0;\n"; }
std::string rapid_line(const std::string& target) { return "MoveL " + target + ",v1,fine,tool0;\n"; }

const std::string krl_value = "={X 1,Y 2,Z 3,A 0,B 0,C 0,S 2,T 2}\n";
RobotProgram krl_lines(const std::string& lines, const std::string& routines = "",
                       const std::vector<std::string>& harmless = {}) {
  std::string text = "DEF m()\n";
  for (const char* name : {"a", "b", "c", "d"}) text += name + krl_value;
  return parse_program(krl, text + lines + "END\n" + routines, "m.src", harmless);
}

RobotProgram ur_lines(const std::string& lines, const std::string& routines = "",
                      const std::vector<std::string>& harmless = {}) {
  std::string text = routines + "def m():\n";
  for (const char* name : {"a", "b", "c", "d"}) text += message(name, "=p[1,2,3,0,0,0]\n");
  return parse_program(urscript, text + lines + "end\n", "m.script", harmless);
}

RobotProgram tp_lines(const std::vector<std::string>& lines, const std::vector<std::string>& harmless = {}) {
  std::string text = "/PROG M\n/MN\n";
  for (const std::string& line : lines) text += "   1:" + line + " ;\n";
  text += "/POS\n";
  for (int k = 1; k <= 4; ++k)
    text +=
        message("P[", k,
                "]{\n GP1:\n UF : 1, UT : 2, CONFIG : 'N U T, 0, 0, 0',\n X = 1 mm, Y = 2 mm, Z = 3 mm,\n W = 10 deg, "
                "P = 20 deg, R = 30 deg\n};\n");
  return parse_program(fanuc_tp, text + "/END\n", "m.ls", harmless);
}
std::string tp_move(int k) { return message("J P[", k, "] 100% FINE"); }
/// A program with a statement in line 4, between moves: the first is corrected, the second is not.
RobotProgram voids_what_follows(const char* statement) {
  const RobotProgram program = tp_lines({tp_move(1), statement, tp_move(2)});
  EXPECT_NE(corrected(program).find("P[1]"), std::string::npos) << statement;
  EXPECT_EQ(corrected(program).find("P[2]"), std::string::npos) << statement;
  return program;
}

// ---- the class: a statement that can change what targets mean ----

TEST(StatementsRapid, VoidTheTargetsBehindThem) {
  for (const char* statement : {"ConfJ\\Off;",
                                "ConfJ \\Off;",
                                "confj\n\\off;",
                                "PDispSet d;",
                                "PDispOn\\Rot\\ExeP:=a,b,tool0;",
                                "EOffsSet e;",
                                "EOffsOn \\ExeP:=a,b;",
                                "SoftAct 1,50;",
                                "ActUnit STN_1;",
                                "DeactUnit STN_1;",
                                "SyncMoveOn s,t;",
                                "MToolTCPCalib j,j,j,j,gun,e,f;",
                                "SetSysData gun;",
                                "SetDataVal \"x\",v;",
                                "FCAct gun;",
                                "EGMActPose e,x;",
                                "WaitWObj w;",
                                "DropWObj w;",
                                "SoftElbow;",
                                "IndAMove STN_1,2\\ToAbsNum:=0,20;",
                                "WriteCfgData \"/MOC/MOTOR_CALIB/rob1_1\",\"cal_offset\",x;",
                                "Nobody;",
                                "Nobody x,y;",
                                "n:=nobody(1);",
                                "IF x>1 Nobody;",
                                "IF nobody(1) THEN\nENDIF",
                                "%\"nobody\"%;",
                                "CallByVar \"proc\",n;",
                                "FOR i FROM 1 TO nobody(2) DO\nENDFOR",
                                "TEST nobody(1)\nCASE 1:\nENDTEST",
                                "MoveWeld [1,2,3],v1;"}) {
    const RobotProgram program = rapid_lines(rapid_move("a") + statement + "\n" + rapid_move("b"));
    EXPECT_EQ(corrected(program).find('a'), 0u) << statement;
    EXPECT_EQ(corrected(program).find('b'), std::string::npos) << statement;
    EXPECT_EQ(about(program, "b").find("line 9, "), 0u) << statement << ": " << about(program, "b");
  }
  for (const char* statement : {"ConfL\\Off;", "SingArea\\Wrist;", "SingArea \\LockAxis4;"}) {
    const RobotProgram program = rapid_lines(rapid_line("a") + statement + "\n" + rapid_line("b") + rapid_move("c"));
    EXPECT_EQ(corrected(program), "acdj") << statement;  // joint moves are as they were
    EXPECT_EQ(about(program, "b").find("line 9, "), 0u) << statement;
  }
  EXPECT_EQ(about(rapid_lines("ConfJ\\Off;\n" + rapid_move("a")), "a"),
            "line 8, ConfJ\\Off: configurations of joint moves do not count");
}

TEST(StatementsRapid, AreHarmless) {
  for (const char* statement : {"AccSet 50,50;",
                                "VelSet 100,500;",
                                "WorldAccLim\\On:=3;",
                                "WaitTime 1;",
                                "SetDO do1,1;",
                                "TPWrite \"x\";",
                                "Stop;",
                                "GripLoad load1;",
                                "TriggIO t,0\\DOp:=do1,1;",
                                "n:=n+Sin(3)*Distance(a.trans,b.trans);",
                                "IF n>1 AND (m<2) SetDO do1,1;",
                                "WHILE n<3 DO\nIncr n;\nENDWHILE",
                                "TEST n\nCASE 1,2:\nSetDO do1,0;\nDEFAULT:\nENDTEST",
                                "GOTO end;\nend:",
                                "x.y{2}.z:=3;",
                                "VAR num q:=3;",
                                "IDelete i;",
                                "WaitUntil DI1=1 OR (n>2);",
                                "ConfJ\\On;",
                                "PDispOff;",
                                "SingArea\\Off;",
                                "ConfL;",
                                "MotionSup\\Off;",
                                "CorrClear;",
                                "SocketSend s\\Str:=\"x\";"}) {
    const RobotProgram program = rapid_lines(rapid_move("a") + statement + "\n" + rapid_line("b") + rapid_move("c"));
    EXPECT_EQ(corrected(program), "abcdj") << statement << remarks(program);
    EXPECT_EQ(remarks(program), "") << statement;
  }
}

// Instructions that use targets in ways of their own: those targets stay, the ones behind are corrected.
TEST(StatementsRapid, UseTargetsInWaysOfTheirOwn) {
  for (const char* statement :
       {"SearchL di1,a,b,v1,tool0;", "SearchC di1,a,b,c,v1,tool0;", "MoveExtJ b,v1,fine;", "CapL b,v1,c,w,fine,tool0;",
        "MoveL b,v1,fine,tool0\\Corr;", "MoveL b\\Nobody,v1,fine,tool0;", "ContactL b,v1,fine,tool0;"}) {
    const RobotProgram program = rapid_lines(std::string(statement) + "\n" + rapid_move("d"));
    EXPECT_NE(about(program, "b"), "") << statement;
    EXPECT_EQ(corrected(program).find('b'), std::string::npos) << statement;
    EXPECT_NE(corrected(program).find('d'), std::string::npos) << statement;
  }
  EXPECT_EQ(remarks(rapid_lines("StepBwdPath 30,1;\n")), "8 StepBwdPath 30,1: a move without a target of its own\n");
}

TEST(StatementsRapid, MeanNothingToJointValues) {
  const std::string move = "MoveAbsJ j,v1,fine,tool0;\n";
  for (const char* statement : {"ConfJ\\Off;\n", "PDispSet d;\n", "ActUnit STN_1;\n"})
    EXPECT_EQ(corrected(rapid_lines(statement + move)).substr(0, 1), "j") << statement;
  for (const char* statement : {"SoftAct 1,50;\n", "Nobody;\n"})
    EXPECT_EQ(corrected(rapid_lines(statement + move)).find('j'), std::string::npos) << statement;
}

TEST(StatementsKrl, VoidTheTargetsBehindThem) {
  for (const char* statement :
       {"$IPO_MODE=#TCP", "$ipo_mode = #tcp", "$ROBROOT={X 1,Y 0,Z 0,A 0,B 0,C 0}", "$WORLD.X=5", "$SOFT=1", "nobody()",
        "n=nobody(1)", "IF nobody(1) THEN\nENDIF", "WAIT FOR nobody(1)", "ASYPTP {E1 5}", "BAS(#NOBODY,1)",
        "INTERRUPT DECL 3 WHEN $IN[1] DO nobody()", "GLOBAL INTERRUPT DECL 3 WHEN $IN[1] DO $TOOL=TOOL_DATA[2]",
        "TRIGGER WHEN DISTANCE=0 DELAY=5 DO nobody() PRIO=-1", "nobody 5", "?x", "$SOFT.A=nobody(2)"}) {
    const RobotProgram program = krl_lines(std::string("BAS(#TOOL,1)\nPTP a\n") + statement + "\nPTP b\nLIN c\n");
    EXPECT_EQ(corrected(program).find('b'), std::string::npos) << statement;
    EXPECT_EQ(corrected(program).find('c'), std::string::npos) << statement;
    EXPECT_NE(about(program, "b"), "") << statement;
  }
  for (const char* statement : {"$ORI_TYPE=#CONSTANT", "$ORI_TYPE=n", "BAS(#CP_PARAMS,2)", "$TARGET_STATUS=#SOURCE"}) {
    const RobotProgram program = krl_lines(std::string("LIN a\n") + statement + "\nPTP b\nLIN c\n");
    EXPECT_EQ(corrected(program), "ab") << statement;
    EXPECT_EQ(about(program, "c").find("line 7, "), 0u) << statement;
  }
}

TEST(StatementsKrl, AreHarmless) {
  for (const char* statement : {"$VEL.CP=0.5",
                                "$ACC_AXIS[1]=50",
                                "$OUT[3]=TRUE",
                                "WAIT SEC 1",
                                "WAIT FOR $IN[1] AND ($IN[2])",
                                "HALT",
                                "PULSE($OUT[1],TRUE,0.5)",
                                "n=n+1",
                                "s.x[2]=sin(30)*abs(n)",
                                "IF $IN[1] THEN\nn=2\nELSE\nn=3\nENDIF",
                                "FOR i=1 TO 3 STEP 1\nn=i\nENDFOR",
                                "REPEAT\nn=1\nUNTIL n==1",
                                "SWITCH n\nCASE 1,2\nn=3\nDEFAULT\nENDSWITCH",
                                "GOTO ende\nende:",
                                "INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )",
                                "INTERRUPT ON 3",
                                "BAS(#VEL_PTP,100)",
                                "$LOAD=LOAD_DATA[2]",
                                "TRIGGER WHEN DISTANCE=0 DELAY=20 DO $OUT[5]=TRUE",
                                "CONTINUE",
                                "$IPO_MODE=#BASE",
                                "$ORI_TYPE=#VAR",
                                "PDAT_ACT=PDEFAULT",
                                "$TIMER[1]=0",
                                "$ADVANCE=3",
                                "DECL nobody x",
                                "CWRITE($CMD,stat,#SYNC,\"x\")",
                                "LOOP\nEXIT\nENDLOOP",
                                "WHILE (n<3)\nn=n+1\nENDWHILE",
                                "TIME_BLOCK START"}) {
    const RobotProgram program = krl_lines(std::string("PTP a\n") + statement + "\nPTP b\nLIN c\n");
    EXPECT_EQ(corrected(program), "abc") << statement << remarks(program);
    EXPECT_EQ(about(program, "b") + about(program, "c"), "") << statement;
  }
}

TEST(StatementsUrscript, VoidTheTargetsBehindThem) {
  for (const char* statement :
       {"force_mode(p[0,0,0,0,0,0],[0,0,1,0,0,0],[0,0,1,0,0,0],2,[1,1,1,1,1,1])", "path_offset_enable()",
        "path_offset_set(p[0,0,1,0,0,0],1)", "track_conveyor_linear(p[1,0,0,0,0,0],1)", "move_frame(\"x\",a)",
        "attach_frame(\"x\",\"y\")", "reset_revolution_counter()", "frame_tracking_enable(\"x\")", "nobody()",
        "x = nobody(1)", "if nobody(1):\nend", "while nobody():\nend", "nobody", "screw_driving(1,2)"}) {
    const RobotProgram program = ur_lines(std::string("movej(a)\n") + statement + "\nmovej(b)\nmovel(c)\n");
    EXPECT_EQ(corrected(program), "a") << statement;
    EXPECT_EQ(about(program, "c").find("line 7, "), 0u) << statement << about(program, "c");
  }
  EXPECT_EQ(remarks(ur_lines("speedl([0,0,1,0,0,0],1,1)\n")).substr(0, 4), "2 a:");
  for (const char* move : {"speedj([0,0,1,0,0,0],1,1)", "speedl([0,0,1,0,0,0],1,1)", "teach_mode()"})
    EXPECT_NE(remarks(ur_lines(std::string(move) + "\n")).find("a move without a target of its own"), std::string::npos)
        << move;
}

TEST(StatementsUrscript, AreHarmless) {
  for (const char* statement :
       {"set_payload(1.5)", "set_target_payload(1,[0,0,0])", "sleep(0.5)", "set_digital_out(1,True)",
        "x = get_actual_tcp_pose()", "if (x > 1) and not (y):\nsync()\nelif z:\nelse:\nend", "$ 3 \"Waypoint_1\"",
        "popup(\"x\")", "while True:\nbreak\nend", "textmsg(\"x\",norm(x))", "set_gravity([0,0,9.8])", "x[2]=3",
        "socket_open(\"h\",1)", "rpc.anything(a)", "global x=3", "local y = [1,2,3,4,5,6]", "stopj(2)",
        "set_base_acceleration([0,0,0])", "x = pose_trans(a, p[0,0,1,0,0,0])"}) {
    const RobotProgram program = ur_lines(std::string("movej(a)\n") + statement + "\nmovej(b)\nmovel(c)\n");
    EXPECT_EQ(corrected(program), "abc") << statement << remarks(program);
  }
}

TEST(StatementsFanuc, VoidTheTargetsBehindThem) {
  for (const char* statement : {"  UFRAME_NUM=2",
                                "  UTOOL_NUM=1",
                                "  UFRAME_NUM=R[1]",
                                "  UTOOL_NUM = AR[1]",
                                "  UFRAME[1]=PR[2]",
                                "  UTOOL[3:gun]=PR[1]",
                                "  $MNUFRAME[1,1]=PR[1]",
                                "  $SCR.$X=1",
                                "  CALL NOBODY",
                                "  CALL NOBODY(1,2)",
                                "  RUN NOBODY",
                                "  Nobody 1",
                                "  IF DI[1]=ON,CALL NOBODY",
                                "  IF (DI[1]),UFRAME_NUM=(2)",
                                "  SELECT R[1]=1,CALL NOBODY",
                                "         =2,CALL NOBODY",
                                "       ELSE,CALL NOBODY",
                                "  TRACK TAST[1]",
                                "  STOP_TRACKING",
                                "  SOFTFLOAT[1]",
                                "  Touch Offset PR[1]",
                                "  (UFRAME_NUM=(3))",
                                "  GROUP X",
                                "J P[4] 100% FINE TB .5sec,CALL NOBODY"}) {
    const RobotProgram program = voids_what_follows(statement);
    EXPECT_NE(about(program, "P[2]"), "") << statement;
  }
  for (const char* option : {"RTCP", "COORD", "COORD[R[1]]", "Wjnt", "MROT", "Nobody", "ACC80 RTCP", "Search[1]"}) {
    const RobotProgram program = tp_lines({std::string("L P[1] 100mm/sec FINE ") + option, tp_move(2)});
    EXPECT_EQ(corrected(program), "P[2]P[3]P[4]") << option;
    EXPECT_EQ(about(program, "P[1]").find("line 3, "), 0u) << option;
  }
  EXPECT_EQ(remarks(tp_lines({tp_move(1), "  P[1]=PR[2]"})), "4 P[1]=PR[2]: the program changes this target\n");
}

TEST(StatementsFanuc, AreHarmless) {
  for (const char* statement : {"  R[1]=R[1]+1",
                                "  DO[3]=ON",
                                "  RO[1]=PULSE,0.5sec",
                                "  PR[1,3]=50",
                                "  PR[2]=P[3]",
                                "  WAIT   1.00(sec)",
                                "  WAIT DI[1]=ON TIMEOUT,LBL[3]",
                                "  LBL[1:x]",
                                "  JMP LBL[1]",
                                "  IF R[1]=5,JMP LBL[2]",
                                "  IF (DI[1] AND !DI[2]) THEN",
                                "  FOR R[1]=1 TO 10",
                                "  MESSAGE[Part missing]",
                                "  UALM[1]",
                                "  TIMER[1]=START",
                                "  OVERRIDE=50%",
                                "  PAYLOAD[2]",
                                "  SKIP CONDITION DI[5]=ON",
                                "  OFFSET CONDITION PR[3]",
                                "  !L P[2] RTCP",
                                "  // CALL NOBODY",
                                "  --eg:CALL NOBODY",
                                "  PAUSE",
                                "  UFRAME_NUM=1",
                                "  UTOOL_NUM=2",
                                "  COL DETECT ON",
                                "  Arc Start[1]",
                                "  Weave Sine[1]",
                                "  F[1]=(DI[1])",
                                "  $WAITTMOUT=300",
                                "  LOCK PREG",
                                "  (DO[1]=(DI[2]))",
                                "",
                                "L P[4] 100mm/sec CNT50 ACC80 Skip,LBL[5] TA .1sec,DO[1]=ON",
                                "J P[4] R[10]% CNT100 PTH",
                                "L P[4] R[1:speed]mm/sec FINE",
                                "L P[4] WELD_SPEED CNT10"}) {
    const RobotProgram program = tp_lines({tp_move(1), statement, tp_move(2)});
    for (const char* name : {"P[1]", "P[2]", "P[4]"})
      EXPECT_NE(corrected(program).find(name), std::string::npos) << statement << remarks(program);
    EXPECT_EQ(about(program, "P[2]"), "") << statement;
  }
}

// A routine, and a macro, may have the name of a harmless instruction.
TEST(StatementsFanuc, NamesThatBeginAsInstructions) {
  for (const char* statement : {"  CALL WELD",
                                "  CALL VISION",
                                "  CALL ARC",
                                "  CALL WAIT",
                                "  CALL PAYLOAD(2)",
                                "  CALL SR[1]",
                                "  RUN WEAVE",
                                "  MONITOR LOCK",
                                "  IF R[1]=1,CALL ARC",
                                "         =2,CALL TIMER",
                                "       ELSE,CALL WELD",
                                "L P[4] 100mm/sec FINE TB .1sec,CALL WELD",
                                "L P[4] 100mm/sec FINE TA .1sec,CALL SR[2]",
                                "  GO HOME",
                                "  IF R[1]=3,GO HOME",
                                "  DO PICK",
                                "  F OPEN",
                                "  M 3",
                                "  P SHIFT",
                                "  PR SHIFT",
                                "  VR CALIB",
                                "  DI CHECK",
                                "  TIMER",
                                "  MESSAGE BOARD",
                                "  ARC WIRE CUT",
                                "  ARC START UP",
                                "  WELD SCHED CHANGE",
                                "  WEAVE SINE",
                                "  COL DETECTOR",
                                "  LOCK JIG",
                                "  WAIT PART",
                                "  WAIT 2",
                                "  END EFFECTOR CHANGE",
                                "  PAUSE LINE",
                                "  ABORT PICK",
                                "  VISION RUN",
                                "  SKIP CONDITIONING",
                                "  SOFTFLOAT ENDS",
                                "  IF JAM",
                                "  IF JAM THEN",
                                "  SELECT JIG",
                                "  FOR KLIFT",
                                "  ELSE WHERE",
                                "  ENDFOR X",
                                "  LBL PRINT",
                                "  JMP HOME",
                                "  Hand open 1"}) {
    const RobotProgram program = voids_what_follows(statement);
    EXPECT_EQ(about(program, "P[2]").find("line 4, "), 0u) << statement << remarks(program);
    EXPECT_NE(remarks(program).find("4 "), std::string::npos) << statement;
  }
  const RobotProgram own = tp_lines({"L P[1] 100mm/sec FINE TB .1sec,CALL WELD"});  // it may run during the move
  EXPECT_EQ(corrected(own), "P[2]P[3]P[4]");
  EXPECT_EQ(corrected(tp_lines({"  CALL WELD", "  GO HOME", tp_move(1)}, {"weld", "go"})), "P[1]P[2]P[3]P[4]");
  EXPECT_EQ(corrected(tp_lines({"  CALL SR[1]", tp_move(1)}, {"sr"})), "P[2]P[3]P[4]");
}

TEST(StatementsFanuc, ExactFormsAreHarmless) {
  for (const char* statement : {"  WAIT .50(sec)",
                                "  WAIT R[2](sec)",
                                "  WAIT (!DI[1])",
                                "  WAIT $X=1",
                                "  LOCK VREG",
                                "  COL DETECT OFF",
                                "  COL GUARD ADJUST 80",
                                "  Arc End[2]",
                                "  Arc Start E1[3]",
                                "  Weld Start[1,2]",
                                "  Weave Figure 8[1]",
                                "  Weave End",
                                "  VISION RUN_FIND 'A B'",
                                "  VISION GET_OFFSET 'A' VR[1] JMP LBL[2]",
                                "  MONITOR END CHK",
                                "  SKIP CONDITION (DI[1])",
                                "  SELECT R[1]=1,JMP LBL[1]",
                                "  FOR R[1]=R[2] DOWNTO 1",
                                "  TIMER[1:a b]=RESET",
                                "  PAYLOAD[GP1:2]",
                                "  DO[1: PICK UP]=ON",
                                "  ERROR_PROG=X"}) {
    const RobotProgram program = tp_lines({tp_move(1), statement, tp_move(2)});
    EXPECT_EQ(corrected(program), "P[1]P[2]P[3]P[4]") << statement << remarks(program);
  }
}

// What the text states is not what such moves reach, so it stays.
TEST(StatementsFanuc, PositionsThatAreChangedStay) {
  for (const char* change : {"  P[2]=PR[1]", "  IF DI[1]=ON,P[2]=LPOS", "  P[2:b]=P[2]+PR[1]", "  (P[2]=PR[3])"}) {
    const RobotProgram program = tp_lines({tp_move(1), change, tp_move(2), tp_move(3)});
    EXPECT_EQ(corrected(program), "P[1]P[3]P[4]") << change;
    EXPECT_NE(remarks(program).find("the program changes this target"), std::string::npos) << change;
    EXPECT_EQ(before(program, "P[3]"), "") << change;
  }
  const RobotProgram any = tp_lines({tp_move(1), "  P[R[1]]=PR[1]", tp_move(2)});
  EXPECT_EQ(corrected(any), "");
  for (const char* name : {"P[1]", "P[2]", "P[3]", "P[4]"}) EXPECT_NE(about(any, name), "") << name;
  for (const char* option : {"Offset,PR[1]", "Tool_Offset", "Tool_Offset,PR[R[2]]", "Offset", "VOFFSET,VR[1]"}) {
    const RobotProgram program = tp_lines({tp_move(1), std::string("L P[2] 100mm/sec FINE ") + option, tp_move(3)});
    EXPECT_EQ(corrected(program), "P[1]P[3]P[4]") << option;
    EXPECT_NE(about(program, "P[2]"), "") << option;
  }
  // one that another move uses as it is remains a target
  EXPECT_EQ(corrected(tp_lines({tp_move(1), "L P[1] 100mm/sec FINE Offset,PR[1]"})), "P[1]P[2]P[3]P[4]");
}

TEST(StatementsFanuc, OptionsMayFollowAnyBlank) {
  for (const char* option : {"FINE\tINC", "CNT10,INC", "FINE\n    :  INC", "FINE\tOffset,PR[1]", "FINE,Tool_Offset"}) {
    const RobotProgram program = tp_lines({std::string("L P[1] 100mm/sec ") + option, tp_move(2)});
    EXPECT_EQ(corrected(program), "P[2]P[3]P[4]") << option;
    EXPECT_EQ(about(program, "P[1]"), "moves use it as an increment or with an offset") << option;
  }
  const RobotProgram both = tp_lines({"C P[1]\n    :  P[2] 100mm/sec FINE INC"});
  EXPECT_EQ(corrected(both), "P[3]P[4]");
}

// P[R[n]] may be any position, so what holds there concerns all.
TEST(StatementsFanuc, PositionsWhoseNumberIsComputed) {
  const RobotProgram plain = tp_lines({"J P[R[1]] 100% FINE"});
  EXPECT_EQ(corrected(plain), "P[1]P[2]P[3]P[4]");
  EXPECT_EQ(remarks(plain), "3 J P[R[1]] 100% FINE: computed, not a literal\n");
  EXPECT_EQ(corrected(tp_lines({"  SOFTFLOAT[1]", "J P[R[1]] 100% FINE"})), "");
  EXPECT_EQ(corrected(tp_lines({"L P[R[1]] 100mm/sec FINE INC"})), "");
}

// Applications state in front of /MN what changes all positions.
TEST(StatementsFanuc, Headers) {
  const auto with_header = [](const std::string& header, const std::vector<std::string>& harmless = {}) {
    std::string text = "/PROG M\n/ATTR\nPROG_SIZE = 1;\n/APPL\n" + header + "/MN\n   1:L P[1] 1mm/sec FINE ;\n/POS\n";
    text +=
        "P[1]{\n GP1:\n UF : 1, UT : 2, CONFIG : 'N U T, 0, 0, 0',\n X = 1 mm, Y = 2 mm, Z = 3 mm,\n W = 1 deg, "
        "P = 2 deg, R = 3 deg\n};\n/END\n";
    return about(parse_program(fanuc_tp, text, "m.ls", harmless), "P[1]");
  };
  const std::string tracking = "LINE_TRACK;\n  LINE_TRACK_SCHEDULE_NUMBER      : 1;\n";
  EXPECT_EQ(with_header(tracking), "line 6, LINE_TRACK_SCHEDULE_NUMBER : 1: work objects move");
  EXPECT_EQ(with_header(tracking, {"LINE_TRACK_SCHEDULE_NUMBER"}), "");
  EXPECT_EQ(with_header("LINE_TRACK;\n  LINE_TRACK_SCHEDULE_NUMBER : 0;\n  CONTINUE_TRACK_AT_PROG_END : TRUE;\n"), "");
  EXPECT_EQ(with_header("  ENABLE_SINGULARITY_AVOIDANCE   : FALSE;\n PLTZ_MODE_ENABLE   : FALSE;\n"), "");
  EXPECT_NE(with_header("  ENABLE_SINGULARITY_AVOIDANCE   : TRUE;\n"), "");
  EXPECT_NE(with_header(" PLTZ_MODE_ENABLE   : TRUE;\n"), "");
  EXPECT_EQ(with_header("  ARC Welding Equipment : 1,*,*,*,*;\n"), "");
}

// The instructions end at the section of positions, whatever their comments say.
TEST(StatementsFanuc, InstructionsBehindTheNameOfASection) {
  EXPECT_EQ(corrected(tp_lines({"  !as in /POS", "  CALL NOBODY", tp_move(1)})), "P[2]P[3]P[4]");
}

TEST(StatementsFanuc, AxesBeyondTheSixth) {
  const auto joints = [](const std::string& more) {
    return remarks(parse_program(fanuc_tp,
                                 "/PROG M\n/MN\n   1:J P[1] 9% FINE ;\n/POS\nP[1]{\n GP1:\n UF : 1, UT : 2,\n J1 = 1 "
                                 "deg, J2 = 2 deg, J3 = 3 deg, J4 = 4 deg, J5 = 5 deg, J6 = 6 deg" +
                                     more + "\n};\n/END\n",
                                 "m.ls"));
  };
  for (const char* unused : {"", ", E1 = 0 mm", ", J7 = .000 deg"}) EXPECT_EQ(joints(unused), "") << unused;
  for (const char* used : {", E1 = 5 mm", ", J7 = 5 deg", ", J8 = -1 mm", ", J9 = ** deg"})
    EXPECT_EQ(joints(used), "5 P[1]: external axes are in use\n") << used;
}

// ---- targets and frames that a RAPID program changes ----

TEST(StatementsRapid, TargetsThatAreChangedStay) {
  const std::string variable = "VAR robtarget v:=" + rapid_value, two = rapid_value.substr(0, rapid_value.size() - 2);
  const auto left = [&](const std::string& lines) { return corrected(rapid_lines(lines, variable)); };
  for (const char* change : {"v.trans.z:=v.trans.z+10;\n", "v:=CRobT();\n", "v.trans:=[1,2,3];\n", "v.rot:=a.rot;\n"}) {
    EXPECT_EQ(left(rapid_move("a") + change + rapid_move("v")), "abcdj") << change;
    EXPECT_EQ(left(rapid_move("v") + change), "abcdj") << change;
  }
  EXPECT_EQ(corrected(rapid_lines("row{1}:=a;\n" + rapid_move("row{1}"),
                                  "VAR robtarget row{2}:=[" + two + "," + two + "];\n")),
            "abcdj");
  EXPECT_EQ(corrected(rapid_lines("a.trans:=[1,2,3];\n" + rapid_move("a"))), "bcdj");
  EXPECT_EQ(corrected(rapid_lines("VAR jointtarget k:=[[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
                                  "k.robax.rax_1:=5;\nMoveAbsJ k,v1,fine,tool0;\n")),
            "abcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "a.trans:=[1,2,3];\n")), "bcdj");
  const std::string rest = ",[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n";
  for (const char* position : {"a.trans", "[1,2,z]", "[1,2,3]+shift"})  // values that are no literals
    EXPECT_EQ(left(rapid_move("v") + "v:=[" + position + rest + rapid_move("v")), "abcdj") << position;
  EXPECT_EQ(left(rapid_move("v") + "v:=" + rapid_value), "vvabcdj");
}

// What is no literal in all its parts is listed at its move.
TEST(StatementsRapid, TargetsOfPartsAreComputed) {
  const std::string axes = ",[9E9,9E9,9E9,9E9,9E9,9E9]]";
  for (const std::string& target :
       {std::string("[a.trans,a.rot,a.robconf,a.extax]"), "[[1,2,3]+v,[1,0,0,0],[0,0,0,0]" + axes,
        "[v,[1,0,0,0],[0,0,0,0]" + axes, std::string("[j.robax,j.extax]")}) {
    const RobotProgram program = rapid_lines("MoveJ " + target + ",v1,fine,tool0;\n" + rapid_move("b"));
    EXPECT_EQ(remarks(program).find("8 MoveJ ["), 0u) << remarks(program);
    EXPECT_NE(remarks(program).find(": computed, not a literal"), std::string::npos) << target;
    EXPECT_EQ(before(program, "b"), "") << target;
  }
  for (const char* configuration : {"conf", "[0,n,0,0]", "a.robconf"})
    EXPECT_NE(remarks(rapid_lines(message("MoveJ [[1,2,3],[1,0,0,0],", configuration, axes, ",v1,fine,tool0;\n")))
                  .find("its configuration is no literal"),
              std::string::npos)
        << configuration;
}

// A routine of the file may have the name of a move or of a harmless statement.
TEST(StatementDetails, RoutinesNamedAsStatements) {
  const std::string off = "(num n)\nPDispSet d;\nENDPROC\n";
  for (const char* name : {"PaintL", "MoveWeld", "SetDO"})
    EXPECT_EQ(corrected(rapid_lines(message(name, " 1;\n") + rapid_move("b"), message("PROC ", name) + off)).find('b'),
              std::string::npos)
        << name;
  for (const char* name : {"movep", "set_tcp", "sleep"})
    EXPECT_EQ(corrected(ur_lines(message(name, "(a)\nmovel(b)\n"),
                                 message("def ", name, "(x):\npath_offset_enable()\nend\n"))),
              "")
        << name;
}

TEST(StatementsRapid, FunctionsThatWriteArguments) {
  const std::string frame = "[[1,2,3],[1,0,0,0]]", declared = "VAR robtarget v:=" + rapid_value +
                                                              "PERS tooldata gun:=[TRUE," + frame +
                                                              ",[1,[0,0,1],[1,0,0,0],0,0,0]];\n";
  for (const char* lines :
       {"ok:=StrToVal(rx,v);\nMoveJ v,v1,fine,tool0;\n", "IF StrToVal(rx,v) MoveJ v,v1,fine,tool0;\n",
        "WHILE StrToVal(rx,v.trans) DO\nMoveJ v,v1,fine,tool0;\nENDWHILE\n",
        "WaitUntil GetNextMechUnit(v.trans.x,s);\nMoveJ v,v1,fine,tool0;\n",
        "f:=DefAccFrame(x,y,3,v.trans.x,n);\nMoveJ v,v1,fine,tool0;\n",
        "k:=CalcJointT(a,tool0\\ErrorNumber:=v.trans.y);\nMoveJ v,v1,fine,tool0;\n"}) {
    const RobotProgram program = rapid_lines(lines, declared);
    EXPECT_EQ(corrected(program), "abcdj") << lines << remarks(program);
    EXPECT_NE(about(program, "v").find("the function may change it"), std::string::npos) << lines;
    EXPECT_EQ(program.tools.count("gun"), 1u);
  }
  EXPECT_EQ(rapid_lines("ok:=StrToVal(rx,gun);\n", declared).tools.count("gun"), 0u);
  // what they only read
  const RobotProgram read = rapid_lines(
      "k:=CalcJointT(v,gun);\nn:=StrToVal(ValToStr(v),n);\nf:=DefAccFrame(v,a,3,m,n);\nMoveJ v,v1,fine,gun;\n",
      declared);
  EXPECT_NE(corrected(read).find('v'), std::string::npos) << remarks(read);
  EXPECT_EQ(read.tools.count("gun"), 1u);
}

TEST(StatementsRapid, RoutinesThatMovesCallByName) {
  const std::string off = "PROC sub()\nPDispSet d;\nENDPROC\n";
  for (const char* move : {"MoveJSync a,v1,z10,tool0,\"sub\";\n", "MoveLSync a,v1,z10,tool0\\WObj:=w,\"SUB\";\n",
                           "MoveCSync a,d,v1,z10,tool0,\"sub\";\n"}) {
    const RobotProgram followed = rapid_lines(move + rapid_line("b"), off);
    EXPECT_EQ(corrected(followed).find('b'), std::string::npos) << move;
    EXPECT_NE(about(followed, "b").find("positions are displaced"), std::string::npos) << move;
    EXPECT_NE(corrected(rapid_lines(move + rapid_line("b"), "PROC sub()\nSetDO x,1;\nENDPROC\n")).find('b'),
              std::string::npos);
    const RobotProgram outside = rapid_lines(rapid_move("c") + move + rapid_line("b"));
    EXPECT_EQ(corrected(outside).find('b'), std::string::npos) << move;
    EXPECT_NE(corrected(outside).find('c'), std::string::npos) << move;
    EXPECT_NE(remarks(outside).find("9 Move"), std::string::npos) << move;
    EXPECT_NE(corrected(rapid_lines(move + rapid_line("b"), "", {"Sub"})).find('b'), std::string::npos) << move;
  }
  for (const char* name : {"name", "\"su\"+\"b\"", "\"SetDO\""})
    EXPECT_EQ(
        corrected(rapid_lines(message("MoveLSync a,v1,z10,tool0,", name, ";\n") + rapid_line("b"), off)).find('b'),
        std::string::npos)
        << name;
}

TEST(StatementsRapid, ExitCycleGoesBackToMain) {
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "ConfJ\\Off;\nIF n<5 ExitCycle;\n")), "bcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "ConfJ\\Off;\nConfJ\\On;\nIF n<5 ExitCycle;\n")), "abcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "sub;\n", "PROC sub()\nConfJ\\Off;\nExitCycle;\nENDPROC\n")),
            "bcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "PDispSet d;\nsub;\nPDispOff;\n",
                                  "PROC sub()\nIF n<5 ExitCycle;\nENDPROC\n")),
            "bcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "PDispSet d;\nPDispOff;\nERROR\nExitCycle;\n")), "bcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "ConfL\\Off;\nIF n<5 ExitCycle;\n")), "abcdj");
  // of a file without it any routine may be what main calls first
  const std::string text = "MODULE m\nPROC first()\nMoveJ " + rapid_value.substr(0, rapid_value.size() - 2) +
                           ",v1,fine,tool0;\nENDPROC\nPROC second()\nConfJ\\Off;\nExitCycle;\nENDPROC\nENDMODULE\n";
  EXPECT_TRUE(parse_program(rapid, text, "m.mod").targets.empty());
}

// Variables of routines hide those of the module.
TEST(StatementsRapid, VariablesOfRoutines) {
  const std::string use = "MoveL a,v1,fine,tool0;\nENDPROC\n";
  for (const char* local : {"VAR robtarget a;\nReadBlock dev,1,a;\n", "VAR robtarget a;\na:=CRobT();\n",
                            "VAR jointtarget a;\nGetJointData 1;\n"}) {
    const RobotProgram program = rapid_lines(rapid_move("a"), "PROC b()\n" + std::string(local) + use);
    EXPECT_EQ(corrected(program), "abcdj") << local << remarks(program);
    EXPECT_EQ(named(program, "a").move, TargetMove::joint) << local;
    EXPECT_NE(remarks(program).find("MoveL a: a variable without literal value"), std::string::npos) << local;
  }
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a"), "PROC b(INOUT robtarget a)\na.trans.x:=1;\nENDPROC\n")), "abcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a"), "PROC b()\nVAR num a;\na:=1;\nENDPROC\n")), "abcdj");
  const RobotProgram both =
      rapid_lines(rapid_move("a"), "PROC b()\nVAR robtarget a:=" + rapid_value + "a.trans.x:=1;\n" + use);
  EXPECT_EQ(corrected(both), "abcdj");
  EXPECT_EQ(named(both, "a").line, 2u);
  const std::string gun = "PERS tooldata gun:=[TRUE,[[1,2,3],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n";
  for (const char* local : {"VAR tooldata gun;\n", "VAR tooldata gun:=f();\n",
                            "VAR tooldata gun:=[FALSE,[[1,2,3],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n"})
    EXPECT_EQ(rapid_lines(local + std::string("MoveJ a,v1,fine,gun;\n"), gun, {"f"}).tools.count("gun"), 0u) << local;
}

TEST(StatementsRapid, CarriageReturnsEndLines) {
  std::string text = "MODULE m\r! targets \"\rCONST robtarget a:=" + rapid_value +
                     "PROC main()\rConfJ\\Off; ! off\rMoveJ a,v1,fine,tool0;\rNobody;\rENDPROC\rENDMODULE\r";
  std::replace(text.begin(), text.end(), '\n', '\r');
  const RobotProgram program = parse_program(rapid, text, "m.mod");
  EXPECT_EQ(remarks(program),
            "3 a: line 5, ConfJ\\Off: configurations of joint moves do not count\n"
            "7 Nobody: what it does to targets is not known\n");
  EXPECT_EQ(stamped(text, program, {}), "MODULE m\r! VERNIER-CORRECTED:\r" + text.substr(9));
  // one within a file of other line ends, and pairs
  EXPECT_NE(remarks(rapid_lines("! x\rNobody;\n")).find("9 Nobody"), std::string::npos);
  EXPECT_EQ(about(rapid_lines("! x\r\nConfJ\\Off;\r\n" + rapid_move("a")), "a").find("line 9, "), 0u);
}

// ---- how far ----

TEST(StatementsReach, UntilOneThatEndsThem) {
  EXPECT_EQ(corrected(rapid_lines("ConfJ\\Off;\n" + rapid_move("a") + "ConfJ\\On;\n" + rapid_move("b"))), "bcdj");
  EXPECT_EQ(corrected(rapid_lines("PDispSet x;\n" + rapid_line("a") + "PDispOff;\n" + rapid_line("b"))), "bcdj");
  EXPECT_EQ(corrected(rapid_lines("PDispSet x;\nConfJ;\n" + rapid_line("a"))), "bcdj");  // another one ends nothing
  EXPECT_EQ(corrected(krl_lines("$IPO_MODE=#TCP\nPTP a\n$IPO_MODE=#BASE\nPTP b\n")), "b");
  EXPECT_EQ(corrected(ur_lines("force_mode(1)\nmovej(a)\nend_force_mode()\nmovej(b)\n")), "b");
  EXPECT_EQ(corrected(tp_lines({"  UFRAME_NUM=3", tp_move(1), "  UFRAME_NUM=1", tp_move(2)})).substr(0, 4), "P[2]");
  EXPECT_EQ(corrected(rapid_lines("Nobody;\nConfJ\\On;\nPDispOff;\n" + rapid_move("a"))).find('a'), std::string::npos);
}

TEST(StatementsReach, BeyondConditions) {
  const std::string off = "ConfJ\\Off;\n", on = "ConfJ\\On;\n";
  const auto left = [](const std::string& lines) { return corrected(rapid_lines(lines)); };
  EXPECT_EQ(left("IF x THEN\n" + off + "ENDIF\n" + rapid_move("a")), "bcdj");
  EXPECT_EQ(left("IF x " + off + rapid_move("a")), "bcdj");
  EXPECT_EQ(left(off + "IF x " + on + rapid_move("a")), "bcdj");  // not on all ways
  EXPECT_EQ(left(off + "IF x THEN\n" + on + rapid_move("a") + "ENDIF\n" + rapid_move("b")), "acdj");
  EXPECT_EQ(left("IF x THEN\n" + off + "ELSE\n" + rapid_move("a") + "ENDIF\n" + on + rapid_move("b")), "abcdj");
  EXPECT_EQ(left("TEST x\nCASE 1:\n" + off + "CASE 2:\n" + rapid_move("a") + "ENDTEST\n" + rapid_move("b")), "acdj");
}

TEST(StatementsReach, BackToTheBeginningOfLoops) {
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "WHILE x DO\n" + rapid_move("b") + "ConfJ\\Off;\nENDWHILE\n")),
            "acdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "back:\n" + rapid_move("b") + "ConfJ\\Off;\nGOTO back;\n")),
            "acdj");
  EXPECT_EQ(corrected(krl_lines("PTP a\nLOOP\nPTP b\nnobody()\nENDLOOP\n")), "a");
  EXPECT_EQ(corrected(ur_lines("movej(a)\nwhile True:\nmovej(b)\nforce_mode(1)\nend\n")), "a");
  EXPECT_EQ(
      corrected(ur_lines("movej(a)\nwhile True:\nforce_mode(1)\nif x:\nbreak\nend\nend_force_mode()\nend\nmovej(b)\n")),
      "a");
  EXPECT_EQ(corrected(tp_lines({tp_move(1), "  LBL[1]", tp_move(2), "  CALL X", "  JMP LBL[1]"})).find("P[2]"),
            std::string::npos);
  EXPECT_EQ(
      corrected(tp_lines({tp_move(1), "  LBL[1]", tp_move(2), "  CALL X", "  IF R[1]=1,JMP LBL[R[2]]"})).find("P[2]"),
      std::string::npos);
  EXPECT_EQ(corrected(tp_lines({tp_move(1), "  FOR R[1]=1 TO 3", tp_move(2), "  CALL X", "  ENDFOR"})).find("P[2]"),
            std::string::npos);
}

TEST(StatementsReach, IntoRoutinesAndOut) {
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "off;\n" + rapid_move("b"), "PROC off()\nConfJ\\Off;\nENDPROC\n")),
            "acdj");
  EXPECT_EQ(corrected(rapid_lines("ConfJ\\Off;\non;\n" + rapid_move("a"), "PROC on()\nConfJ\\On;\nENDPROC\n")),
            "abcdj");
  EXPECT_EQ(
      corrected(rapid_lines(rapid_move("a") + "ConfJ\\Off;\nsub;\n", "PROC sub()\n" + rapid_move("b") + "ENDPROC\n")),
      "acdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "grip;\n" + rapid_move("b"), "PROC grip()\nSetDO x,1;\nENDPROC\n")),
            "abcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "one;\n", "PROC one()\nmain;\nENDPROC\n")).find('a'),
            std::string::npos);
  // a return in the middle
  EXPECT_EQ(corrected(rapid_lines("sub;\n" + rapid_move("a"),
                                  "PROC sub()\nConfJ\\Off;\nIF x RETURN;\nConfJ\\On;\nENDPROC\n")),
            "bcdj");
  // the tool of a routine is that of its calls
  const std::string sub = "DEF sub()\nPTP b\nEND\n";
  const RobotProgram once = krl_lines("BAS(#TOOL,4)\nsub()\nPTP a\n", sub);
  EXPECT_EQ(named(once, "b").tool + named(once, "a").tool, "44");
  const RobotProgram twice = krl_lines("BAS(#TOOL,4)\nsub()\nBAS(#TOOL,5)\nsub()\nPTP a\n", sub);
  EXPECT_EQ(corrected(twice), "a");
  EXPECT_EQ(about(twice, "b"), "line 8 sets the tool or work object, but not on all ways there");
}

TEST(StatementsReach, EverywhereFromWhatMayRunAtAnyTime) {
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a"), "TRAP t\nConfJ\\Off;\nENDTRAP\n")), "bcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "ERROR\nPDispSet x;\nRETRY;\n")), "bcdj");
  EXPECT_EQ(corrected(rapid_lines(rapid_move("a") + "ERROR\nTPWrite \"x\";\nRETRY;\n")), "abcdj");
  EXPECT_EQ(corrected(krl_lines("PTP a\nINTERRUPT DECL 3 WHEN $IN[1] DO sub()\n", "DEF sub()\n$IPO_MODE=#TCP\nEND\n")),
            "");
  EXPECT_EQ(corrected(ur_lines("movel(a)\n", "thread t():\nset_tcp(p[0,0,1,0,0,0])\nend\n")), "");
}

TEST(StatementsReach, ToolsThatAreSetOnSomeWays) {
  const RobotProgram program = krl_lines("$TOOL=TOOL_DATA[1]\nIF x THEN\n$TOOL=TOOL_DATA[2]\nPTP a\nENDIF\nPTP b\n");
  EXPECT_EQ(named(program, "a").tool, "2");
  EXPECT_EQ(about(program, "b"), "line 8 sets the tool or work object, but not on all ways there");
  EXPECT_EQ(corrected(ur_lines("set_tcp(p[0,0,1,0,0,0])\nif x:\nset_tcp(p[0,0,2,0,0,0])\nend\nmovel(a)\n")), "");
  EXPECT_EQ(corrected(krl_lines("IF x THEN\nTOOL_DATA[3]={X 0,Y 0,Z 1,A 0,B 0,C 0}\nENDIF\n")), "");
  EXPECT_EQ(krl_lines("IF x THEN\nTOOL_DATA[3]={X 0,Y 0,Z 1,A 0,B 0,C 0}\nENDIF\n").tools.count("3"), 0u);
  EXPECT_EQ(krl_lines("BAS(#TOOL,3)\nPTP a\nTOOL_DATA[3]={X 0,Y 0,Z 1,A 0,B 0,C 0}\n").tools.count("3"), 0u);
}

// ---- what users state ----

TEST(AssumedHarmless, StatementsAndRoutinesOfOtherFiles) {
  EXPECT_EQ(corrected(rapid_lines("Nobody x;\nn:=other(1);\n" + rapid_move("a"), "", {"NOBODY", "Other"})), "abcdj");
  EXPECT_EQ(corrected(rapid_lines("ConfJ\\Off;\n" + rapid_move("a"), "", {"confj"})), "abcdj");
  EXPECT_EQ(corrected(krl_lines("nobody(1)\nPTP a\n", "", {"nobody"})), "a");
  EXPECT_EQ(corrected(ur_lines("nobody(1)\nmovej(a)\n", "", {"nobody"})), "a");
  const RobotProgram program = tp_lines({"  CALL GRIP(1)", tp_move(1)}, {"Grip"});
  EXPECT_EQ(corrected(program), "P[1]P[2]P[3]P[4]");
  EXPECT_EQ(remarks(program), "");
}

// ---- details ----

TEST(StatementDetails, TargetsThatRoutinesGet) {
  const RobotProgram program = rapid_lines("pick a;\nn:=change(b);\nn:=look(c);\n",
                                           "PROC pick(robtarget p)\n" + rapid_move("p") +
                                               "ENDPROC\n"
                                               "FUNC num change(INOUT robtarget p)\nRETURN 1;\nENDFUNC\n"
                                               "FUNC num look(robtarget p)\nRETURN 1;\nENDFUNC\n");
  EXPECT_EQ(corrected(program), "cdj");
  EXPECT_NE(about(program, "a").find("pick a"), std::string::npos);
  // a parameter hides the target of its name
  EXPECT_EQ(corrected(rapid_lines("", "PROC pick(robtarget a)\n" + rapid_move("a") + "ENDPROC\n")), "abcdj");
  EXPECT_NE(remarks(rapid_lines("", "PROC pick(robtarget a)\n" + rapid_move("a") + "ENDPROC\n")).find("a parameter"),
            std::string::npos);
  EXPECT_NE(about(krl_lines("sub(a)\n", "DEF sub(p:OUT)\nEND\n"), "a"), "");
  EXPECT_NE(remarks(ur_lines("", "a=p[1,2,3,0,0,0]\ndef f(a):\nmovel(a)\nend\n")).find("movel(a): a parameter"),
            std::string::npos);
}

// What is given to an instruction or routine may be written there; constants are not.
TEST(StatementDetails, VariablesThatInstructionsGet) {
  const std::string frame = "[[1,2,3],[1,0,0,0]]", tool = "[TRUE," + frame + ",[1,[0,0,1],[1,0,0,0],0,0,0]];\n";
  const auto program = [&](const std::string& lines, const std::string& routines = "") {
    return rapid_lines(lines, routines + "VAR robtarget v:=" + rapid_value + "PERS tooldata gun:=" + tool);
  };
  for (const char* statement : {"GetDataVal \"x\",v;\n", "RMQGetMsgData m,v;\n", "TPReadNum v.trans.x,\"x\";\n"})
    EXPECT_EQ(corrected(program(statement)), "abcdj") << statement;
  EXPECT_EQ(corrected(program("TPWrite \"x\"\\Pos:=v.trans;\nGetDataVal \"x\",a;\n")), "abcdjv");
  EXPECT_EQ(program("GetSysData gun;\n").tools.count("gun"), 0u);
  EXPECT_EQ(program("SetDO x,1;\n").tools.count("gun"), 1u);
  EXPECT_EQ(program("bend gun;\n", "PROC bend(INOUT tooldata t)\nt.tframe.trans.z:=1;\nENDPROC\n").tools.count("gun"),
            0u);
  EXPECT_EQ(named(rapid_lines("use w;\n", "PROC use(PERS wobjdata w)\nMoveL a,v1,fine,tool0\\WObj:=w;\nENDPROC\n"), "a")
                .workobject,
            "?");
  EXPECT_NE(about(krl_lines("CAST_FROM(x[],0,a)\nPTP b\n"), "a"), "");
  EXPECT_NE(about(krl_lines("s=STRTOPOS(\"x\",a)\nPTP b\n"), "a"), "");
  const std::string data = "TOOL_DATA[3]={X 0,Y 0,Z 1,A 0,B 0,C 0}\n";
  EXPECT_EQ(krl_lines(data + "sub(TOOL_DATA[3])\n", "DEF sub(f:OUT)\nEND\n").tools.count("3"), 0u);
  EXPECT_EQ(named(krl_lines("BAS(#BASE,2)\nsub($BASE)\nPTP a\n", "DEF sub(f:OUT)\nEND\n"), "a").workobject, "?");
}

TEST(StatementDetails, FramesThatAreSetAgainAreTheSame) {
  const RobotProgram program =
      ur_lines("set_tcp(p[0,0,1,0,0,0])\nwhile True:\nmovel(a)\nset_tcp(p[0,0,1,0,0,0])\nmovel(b)\nend\n");
  EXPECT_EQ(named(program, "a").tool + named(program, "b").tool, "set_tcp of line 6set_tcp of line 6");
}

TEST(StatementDetails, InstructionsOverSeveralLines) {
  EXPECT_EQ(corrected(rapid_lines("ConfJ\n\\Off\n;\n" + rapid_move("a"))), "bcdj");
  EXPECT_EQ(remarks(rapid_lines("a.trans\n:=\n[1,2,3];\n")), "8 a.trans := [1,2,3]: the program changes this target\n");
  EXPECT_EQ(remarks(rapid_lines("VAR robtarget\nx\n:=\nOffs(a,1,2,3);\n")),
            "8 robtarget x := Offs(a,1,2,3): computed, not a literal\n");
}

TEST(StatementDetails, ToolsInFrontOfSignals) {
  const RobotProgram program = rapid_lines("MoveLDO a,v1,fine,gun\\WObj:=w,do1,1;\nMoveJSync b,v1,fine,gun,\"p\";\n");
  EXPECT_EQ(named(program, "a").tool + named(program, "a").workobject + named(program, "b").tool, "gunwgun");
}

TEST(StatementDetails, FramesOfOneMotion) {
  const RobotProgram program = krl_lines(
      "$TOOL=$NULLFRAME\n$BASE=BASE_DATA[1]\nSLIN a WITH $TOOL={X 0,Y 0,Z 100,A 0,B 0,C 0}, $VEL.CP=1 C_SPL\n"
      "SLIN b WITH $BASE=BASE_DATA[4]\nSLIN c\nSPLINE WITH $BASE=BASE_DATA[5]\nSPL d\nENDSPLINE\n");
  EXPECT_EQ(remarks(program), "");
  ASSERT_EQ(program.tools.count("$TOOL of line 8"), 1u);
  EXPECT_EQ(program.tools.at("$TOOL of line 8")(2, 3), 0.1);
  EXPECT_EQ(named(program, "a").tool + named(program, "a").workobject, "$TOOL of line 81");
  EXPECT_EQ(named(program, "b").tool + named(program, "b").workobject, "04");
  EXPECT_EQ(named(program, "c").tool + named(program, "c").workobject, "01");
  EXPECT_EQ(named(program, "d").tool + named(program, "d").workobject, "05");
  EXPECT_NE(about(krl_lines("SLIN a WITH $IPO_MODE=#TCP\nSLIN b\n"), "a"), "");
  EXPECT_EQ(corrected(krl_lines("SLIN a WITH $IPO_MODE=#TCP\nSLIN b\n")), "b");
  EXPECT_EQ(named(krl_lines("SLIN a WITH $TOOL=f\n", "", {}), "a").tool, "?");
}

TEST(StatementDetails, FramesByFlangeData) {
  const std::string data = "DECL FDAT FP1={TOOL_NO 3,BASE_NO 2,IPO_FRAME #BASE}\nDECL LDAT L1={VEL 2,ORI_TYP #VAR}\n";
  const RobotProgram program = krl_lines(data +
                                         "FDAT_ACT=FP1\nLDAT_ACT=L1\nBAS(#CP_PARAMS,2)\nLIN a\nFDAT_ACT=FP9\n"
                                         "BAS(#PTP_PARAMS,10)\nPTP b\nBAS(#INITMOV,0)\nPTP c\nPTP d\n");
  EXPECT_EQ(remarks(program), "");
  EXPECT_EQ(named(program, "a").tool + named(program, "a").workobject, "32");
  EXPECT_EQ(named(program, "b").tool + named(program, "b").workobject, "??");
  EXPECT_EQ(named(program, "c").tool + named(program, "c").workobject, "");
  EXPECT_NE(remarks(krl_lines("DECL LDAT L2={VEL 2,ORI_TYP #CONSTANT}\n")).find("need not reach their orientation"),
            std::string::npos);
}

TEST(StatementDetails, NamesThatBeginAsOptionsDo) {
  EXPECT_EQ(remarks(krl_lines("PTP a\nPTP b\nPTP c\nPTP d\nDECL E6POS C_HOME\nPTP C_HOME\n")),
            "11 PTP C_HOME: no literal of this file, perhaps of its data list\n");
  const RobotProgram program = krl_lines("C_HOME" + krl_value + "PTP C_HOME C_PTP\n");
  EXPECT_EQ(corrected(program), "c_home");
}

TEST(StatementDetails, MovesAndElementsOfUrscript) {
  const RobotProgram program = ur_lines("optimovej([0.2,-1.2,1.5,-1.0,-1.2,0.3], a=0.3, v=0.3)\noptimovel(a)\n");
  ASSERT_EQ(program.targets.size(), 2u);
  EXPECT_EQ(program.targets[0].move, TargetMove::joint);
  EXPECT_EQ(program.targets[0].joints(2), 1.5);
  EXPECT_EQ(named(program, "a").move, TargetMove::linear);
  EXPECT_EQ(remarks(ur_lines(
                "q1=[0,0,0,0,0,0]\nmovej(q1)\nq1[0] = 0.9\nmovej(q1)\nmovej(a)\nmovej(b)\nmovej(c)\nmovej(d)\n")),
            "8 q1[0] = 0.9: the program changes this target\n");
  EXPECT_EQ(remarks(ur_lines("movej(a)\nmovej(b)\nmovej(c)\nmovej(get_inverse_kin(d,qnear=x,tcp=y))\n")),
            "5 d: no move of this file uses it\n9 movej(get_inverse_kin(d,qnear=x,tcp=y)): a tool of its own\n");
}

// ---- what a program changes, and what need not be set ----

/// The names of targets that are corrected in a known tool and work object.
std::string in_known_frames(const RobotProgram& program) {
  std::string out;
  for (const ProgramTarget& target : program.targets)
    if (program.tools.count(target.tool) != 0 && program.workobjects.count(target.workobject) != 0) out += target.name;
  return out;
}

const std::string krl_numbers = "={X 1,Y 2,Z 3,A 0,B 0,C 0}";

TEST(KrlValues, OfExpressionsAreComputed) {
  for (const char* rest : {":{X 0,Y 0,Z 50,A 0,B 0,C 0}", "+XOFF", ":f(1)", " : XOFF"}) {
    const RobotProgram program = krl_lines("e" + krl_numbers + rest + "\nLIN e\n");
    EXPECT_EQ(corrected(program), "") << rest;
    EXPECT_NE(remarks(program).find("7 LIN e: computed, not a literal"), std::string::npos) << remarks(program);
  }
}

// Data of tools and bases hold where every way to their use has set them.
TEST(KrlFrameData, IsSetOnEveryWay) {
  const std::string base = "BASE_DATA[2]" + krl_numbers + "\n", tool = "TOOL_DATA[2]" + krl_numbers + "\n";
  const std::string use = "$TOOL=$NULLFRAME\n$BASE=BASE_DATA[2]\nLIN a\n", init = "DEF init()\n" + base + "END\n";
  const auto known = [](const std::string& lines, const std::string& routines = "") {
    return in_known_frames(krl_lines(lines, routines));
  };
  EXPECT_EQ(known(base + use), "a");
  EXPECT_EQ(known("init()\n" + use, init), "a");
  EXPECT_EQ(known(base + "sub()\n", "DEF sub()\n" + use + "END\n"), "a");
  EXPECT_EQ(known(tool + "BAS(#TOOL,2)\n$BASE=$NULLFRAME\nLIN a\n"), "a");
  EXPECT_EQ(known("GOTO L1\n" + base + "L1:\n" + use), "");
  EXPECT_EQ(known("IF x THEN\nGOTO L1\nENDIF\n" + base + "L1:\n" + use), "");
  EXPECT_EQ(known(use, init), "");
  EXPECT_EQ(known("IF $IN[1] THEN\ninit()\nENDIF\n" + use, init), "");
  EXPECT_EQ(known("sub()\n" + base, "DEF sub()\n" + use + "END\n"), "");
  EXPECT_EQ(known("BAS(#TOOL,2)\n$BASE=$NULLFRAME\nLIN a\n" + tool), "");
  EXPECT_EQ(known("LOOP\ninit()\nEXIT\nENDLOOP\n" + use, "DEF init()\nIF x THEN\nRETURN\nENDIF\n" + base + "END\n"),
            "");
  EXPECT_EQ(known("SLIN a WITH $BASE=BASE_DATA[2], $TOOL=$NULLFRAME\n" + base), "");
  const std::string data = "DECL FDAT FP1={TOOL_NO 2,BASE_NO 2,IPO_FRAME #BASE}\n";
  EXPECT_EQ(known(data + tool + base + "FDAT_ACT=FP1\nBAS(#FRAMES)\nLIN a\n"), "a");
  EXPECT_EQ(known(data + "FDAT_ACT=FP1\nBAS(#FRAMES)\nLIN a\n" + tool + base), "");
}

TEST(KrlFlangeData, ThatTheProgramChangesIsUnknown) {
  const std::string data = "DECL FDAT FP1={TOOL_NO 0,BASE_NO 0,IPO_FRAME #BASE}\nDECL LDAT L1={VEL 2,ORI_TYP #VAR}\n";
  const std::string use = "FDAT_ACT=FP1\nBAS(#FRAMES)\nLIN a\n", sub = "DEF sub(x:OUT)\nEND\n";
  EXPECT_EQ(in_known_frames(krl_lines(data + "n=FP1.TOOL_NO\nFDAT_ACT=FP1\nBAS(#FRAMES)\nLIN a\n")), "a");
  for (const char* change : {"FP1.TOOL_NO=5", "FP1={TOOL_NO 5,BASE_NO 0,IPO_FRAME #BASE}", "FP1=FP2", "sub(FP1)",
                             "CREAD(h,s,FP1)", "n=sub(FP1.BASE_NO)", "IF x THEN\nFP1.BASE_NO=n\nENDIF"}) {
    EXPECT_EQ(in_known_frames(krl_lines(data + change + "\n" + use, sub)), "") << change;
    EXPECT_EQ(in_known_frames(krl_lines(data + "LOOP\n" + use + change + "\nENDLOOP\n", sub)), "") << change;
  }
  EXPECT_EQ(in_known_frames(krl_lines(use)), "");  // declared elsewhere
  EXPECT_EQ(in_known_frames(krl_lines(data, "DEF other()\n" + use + "END\n")), "");
  EXPECT_EQ(in_known_frames(krl_lines(data, "DEF other(FP1:IN)\n" + use + "END\n")), "");
  EXPECT_EQ(in_known_frames(krl_lines(data + "FDAT_ACT=FP1\nn=sub(2)\nBAS(#FRAMES)\nLIN a\n", sub)), "");
  const std::string line = "LDAT_ACT=L1\nBAS(#CP_DAT)\nLIN a\n";
  EXPECT_EQ(corrected(krl_lines(data + line)), "a");
  for (const char* change : {"L1.ORI_TYP=#CONSTANT", "L1=L2", "sub(L1)"})
    EXPECT_EQ(corrected(krl_lines(data + change + "\n" + line, sub)), "") << change;
}

TEST(KrlParameters, AreNoTargetsOfTheFile) {
  const RobotProgram program =
      krl_lines("PTP a\nsub(XFOO)\n", "DEF sub(a:IN, c[]:OUT)\nLIN a\nLIN c[1]\na.X=5\nc" + krl_value + "END\n");
  EXPECT_EQ(corrected(program), "a");
  EXPECT_EQ(about(program, "LIN a"), "a parameter");
  EXPECT_EQ(about(program, "LIN c[1]"), "a parameter");
  EXPECT_EQ(corrected(krl_lines("", "DEFFCT INT f(a:IN)\nPTP a\nENDFCT\nDEF other()\nPTP a\nEND\n")), "a");
}

// What a routine declares is no variable of the others.
TEST(KrlVariables, OfRoutines) {
  for (const char* declared : {"DECL POS a", "POS b[2], a", "DECL FRAME b, a"}) {
    const RobotProgram program = krl_lines("PTP a\n", message("DEF sub()\n", declared, "\nLIN a\na.X=5\nEND\n"));
    EXPECT_EQ(corrected(program), "a") << declared;
    EXPECT_EQ(named(program, "a").move, TargetMove::joint) << declared;
    EXPECT_NE(about(program, "LIN a"), "") << declared;
  }
  const RobotProgram both =
      krl_lines("PTP a\n", "DEF sub()\nDECL POS a\na" + krl_value + "LIN a\nEND\nDEF other()\nLIN a\nEND\n");
  EXPECT_EQ(corrected(both), "aa");
  EXPECT_EQ(both.targets[0].line, 2u);
  EXPECT_EQ(both.targets[0].move, TargetMove::unknown);  // of the first routine and the third
}

TEST(KrlMoves, HaveNoOtherArguments) {
  for (const char* move : {"LIN a,5", "CIRC b,a,XY 90 C_DIS", "CIRC b,a,CA 90,5", "PTP a,,b"}) {
    const RobotProgram program = krl_lines(std::string(move) + "\nLIN c\n");
    EXPECT_EQ(corrected(program), "c") << move;
    EXPECT_EQ(about(program, "a").find("line 6, "), 0u) << move;
  }
  for (const char* move : {"LIN a C_DIS C_ORI", "CIRC b,a,CA 90 C_DIS", "SCIRC b,a,CA 90 WITH $VEL.CP=1", "PTP a"})
    EXPECT_NE(corrected(krl_lines(std::string(move) + "\nLIN c\n")).find('a'), std::string::npos) << move;
  EXPECT_NE(remarks(krl_lines("PTP {X 1,Y 2,Z 3,A 0,B 0,C 0,S 2}\n")).find("S without T"), std::string::npos);
}

// With other numbers the frame would be another one.
TEST(KrlFrameData, OfTargetsLeavesThemAsTheyAre) {
  for (const char* frame : {"$BASE=a", "$TOOL=a:f", "BASE_DATA[3]=a"})
    EXPECT_EQ(corrected(krl_lines(std::string(frame) + "\nPTP a\nPTP b\n")).find('a'), std::string::npos) << frame;
}

// A call of another file may have the name of a harmless statement.
TEST(KrlWords, AreHarmlessAsStatementsAlone) {
  for (const char* call :
       {"LOAD()", "STOP()", "SYNC()", "HALT()", "CONFIRM(1)", "n=REAL(1)", "EXIT()", "INTERRUPT()"}) {
    const RobotProgram program = krl_lines(std::string(call) + "\nLIN a\n");
    EXPECT_EQ(corrected(program), "") << call;
    EXPECT_EQ(about(program, "a").find("line 6, "), 0u) << call;
  }
  for (const char* statement :
       {"HALT", "BRAKE", "BRAKE F", "INT n", "SIGNAL s $IN[1]", "CONFIRM $x", "STOP WHEN PATH=1"})
    EXPECT_EQ(corrected(krl_lines(std::string(statement) + "\nLIN a\n")), "a") << statement;
}

TEST(ChangedTargets, StayAsTheyAre) {
  for (const char* change : {"a.Z=a.Z+100", "a=b", "a=inv_pos(b)"}) {
    const RobotProgram program = krl_lines("PTP a\n" + std::string(change) + "\nPTP a\nPTP b\n");
    EXPECT_EQ(corrected(program), "b") << change;
    EXPECT_EQ(about(program, change), "the program changes this target");
    EXPECT_EQ(before(program, "b"), "");
  }
  EXPECT_EQ(corrected(krl_lines("DECL E6AXIS H={A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\nH.A1=10\nPTP a\n")), "a");
  for (const char* change : {"a[0]=0.9", "a=get_actual_tcp_pose()", "a.remove(0)", "a.append(1)", "a.insert(0,0.9)",
                             "a.z=3", "n=a.pop()", "textmsg(a.pop())", "a.clear()"}) {
    const RobotProgram program = ur_lines("movej(a)\n" + std::string(change) + "\nmovej(a)\nmovej(b)\n");
    EXPECT_EQ(corrected(program).find('a'), std::string::npos) << change;
    EXPECT_NE(corrected(program).find('b'), std::string::npos) << change;
    EXPECT_NE(remarks(program).find("the program changes this target"), std::string::npos) << change;
  }
  EXPECT_EQ(corrected(ur_lines("movej(a)\nn=a.length()\nmovej(b)\nmovej(c)\nmovej(d)\n")), "abcd");
}

TEST(UrscriptScopes, NamesMeanWhatTheyDoThere) {
  const std::string tool = "p[0,0,0.1,0,0,0]\n", joints = "[1,1,1,1,1,1]\n";
  const auto tool_of_a = [](const std::string& lines, const std::string& routines = "") {
    return named(ur_lines(lines + "movel(a)\n", routines), "a").tool != "";
  };
  EXPECT_TRUE(tool_of_a("t=" + tool + "set_tcp(t)\n"));
  EXPECT_TRUE(tool_of_a("set_tcp(t)\n", "t=" + tool));
  EXPECT_TRUE(tool_of_a("t=" + tool + "def mount():\nset_tcp(t)\nend\nmount()\n"));
  EXPECT_NE(named(ur_lines("while x:\nt=" + tool + "set_tcp(t)\nmovel(b)\nend\n"), "b").tool, "");
  EXPECT_FALSE(tool_of_a("mount(x)\n", "t=" + tool + "def mount(t):\nset_tcp(t)\nend\n"));
  EXPECT_FALSE(tool_of_a("set_tcp(t)\n", "def f():\nlocal t=" + tool + "end\n"));
  EXPECT_FALSE(tool_of_a("set_tcp(t)\n", "def f():\nglobal t=" + tool + "end\n"));
  EXPECT_FALSE(tool_of_a("if x:\nt=" + tool + "end\nset_tcp(t)\n"));
  EXPECT_FALSE(tool_of_a("if x:\nt=" + tool + "else:\nset_tcp(t)\nend\n"));
  EXPECT_FALSE(tool_of_a("set_tcp(t)\nt=" + tool));
  EXPECT_FALSE(tool_of_a("t=" + tool + "t[2]=0.2\nset_tcp(t)\n"));
  const auto near_of_a = [](const std::string& lines, const std::string& routines = "") {
    const RobotProgram program = ur_lines(lines, routines);
    return corrected(program) == "a" && named(program, "a").joints.allFinite();
  };
  const std::string move = "movej(get_inverse_kin(a, qnear=q))\n";
  EXPECT_TRUE(near_of_a("q=" + joints + move));
  EXPECT_FALSE(near_of_a("def go(q):\n" + move + "end\ngo(x)\n", "q=" + joints));
  EXPECT_FALSE(near_of_a(move, "def f():\nq=" + joints + "end\n"));
  EXPECT_FALSE(near_of_a("if x:\nq=" + joints + "end\n" + move));
  EXPECT_FALSE(near_of_a("q=" + joints + move + "movej(get_inverse_kin(a, qnear=[2,2,2,2,2,2]))\n"));
  EXPECT_EQ(about(ur_lines(move), "a"), "line 6: the joint values near it are not known");
  for (const char* way : {"local q=", "q="})
    EXPECT_EQ(about(ur_lines("movej(q)\n", "def f():\n" + (way + joints) + "end\n"), "movej(q)"),
              "not assigned in this routine");
  EXPECT_EQ(corrected(ur_lines("movej(q)\n", "def f():\nglobal q=" + joints + "end\n")), "q");
  // the partner of a pose is that of its routine
  EXPECT_FALSE(named(ur_lines("w_p=p[1,2,3,0,0,0]\nmovel(w_p)\n", "def f():\nlocal w_q=" + joints + "end\n"), "w_p")
                   .joints.allFinite());
  EXPECT_FALSE(
      named(ur_lines("w_p=p[1,2,3,0,0,0]\nw_q=" + joints + "w_q[0]=2\nmovel(w_p)\n"), "w_p").joints.allFinite());
}

TEST(UrscriptMoves, HaveNoOtherArguments) {
  for (const char* move :
       {"movel(a, frame=\"x\")", "movel(a,1,1,0,0,5)", "movej(a,1,blend=3)", "movec(a,b,1,1,0,1,7)", "movep(a,1,1,0,1)",
        "movej(get_inverse_kin(a,[1,1,1,1,1,1]), profile=1)", "servoj(a,1,1,0.002,0.1,300,2)", "optimovel(a,t=3)"}) {
    const RobotProgram program = ur_lines(std::string(move) + "\nmovel(c)\n");
    EXPECT_EQ(corrected(program), "c") << move;
    EXPECT_EQ(about(program, "a").find("line 6, "), 0u) << move << about(program, "a");
  }
  for (const char* move :
       {"movel(a,1,1,0,0)", "movel(a,v=1,a=2,r=0.1,t=0)", "movec(b,a,1,1,0,mode=1)", "movep(a,1,1,r=0)",
        "servoj(a,1,1,0.002,lookahead_time=0.1,gain=300)", "movej(a, 1.4,\n v=f(1,2))"})
    EXPECT_NE(corrected(ur_lines(std::string(move) + "\n", "", {"f"})).find('a'), std::string::npos) << move;
}

// A carriage return alone ends a line, also behind a comment.
TEST(LineEnds, AreCarriageReturnsAlone) {
  const std::string value = "p[1,2,3,0,0,0]";
  const std::string script = "def m():\r# x\rmovel(" + value + ") # y\rforce_mode(1)\r movel(" + value + ")\rend\r";
  const RobotProgram program = parse_program(urscript, script, "m.script");
  ASSERT_EQ(program.targets.size(), 1u);
  EXPECT_EQ(program.targets[0].line, 3u);
  EXPECT_EQ(program.targets[0].column, 7u);
  EXPECT_NE(remarks(program).find("5 target: line 4, force_mode(1)"), std::string::npos) << remarks(program);
  EXPECT_EQ(program.end_of_line, "\r");
  EXPECT_EQ(stamped(script, program, {}), "# VERNIER-CORRECTED:\r" + script);
  const std::string krl_text =
      "DEF m() ; x\rPTP {A1 1,A2 2,A3 3,A4 4,A5 5,A6 6} ; y\rnobody()\rPTP {A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\rEND\r";
  const RobotProgram other = parse_program(krl, krl_text, "m.src");
  ASSERT_EQ(other.targets.size(), 1u);
  EXPECT_EQ(stamped(krl_text, other, {}).find("DEF m() ; x\r; VERNIER-CORRECTED:\rPTP"), 0u);
  const RobotProgram tp =
      parse_program(fanuc_tp, "/PROG M\r/MN\r\r  1:  CALL\r : X ;\r  2:  GO HOME ;\r/POS\r/END\r", "m.ls");
  EXPECT_EQ(remarks(tp),
            "4 CALL : X: what it does to targets is not known\n6 GO HOME: what it does to targets is not known\n");
  EXPECT_EQ(parse_program(krl, "DEF m()\r\nPTP {A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\r\nEND\r\n", "m.src").targets[0].line,
            2u);
}

}  // namespace
}  // namespace vernier::robot_statements_test
