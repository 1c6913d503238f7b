// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Small robot programs, with the traps that files from the field have: both kinds of line ends, other encodings in
// comments, numbers without leading zero, comments that look like targets.

#include <string>

#include "vernier/robot_programs/robot_program.hpp"

namespace vernier_test {

/// A program and its file's name.
struct ProgramSample {
  const char* name;                   ///< of the file
  vernier::ProgramLanguage language;  ///< of the text
  std::string text;                   ///< all of it
};

inline ProgramSample rapid_sample() {
  return {"part.mod", vernier::ProgramLanguage::rapid,
          "%%%\r\n  VERSION:1\r\n  LANGUAGE:ENGLISH\r\n%%%\r\n\r\nMODULE Part(SYSMODULE)\r\n"
          "  ! CONST robtarget old:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]; \xE4\xF6\xFC\r\n"
          "  PERS tooldata Gun:=[TRUE,[[10,20,30],[0.5,0.5,0.5,0.5]],[1,[0,0,1],[1,0,0,0],0,0,0]];\r\n"
          "  TASK PERS wobjdata Table:=[FALSE,TRUE,\"\",[[100,0,0],[0,0,0,1]],[[0,5,0],[1,0,0,0]]];\r\n"
          "  PERS wobjdata Turntable:=[FALSE,FALSE,\"STN_1\",[[100,0,0],[0,0,0,1]],[[0,5,0],[1,0,0,0]]];\r\n"
          "  VAR extjoint none:=[9E9,9E9,9E9,9E9,9E9,9E9];\r\n"
          "  CONST robtarget p10:=[[600.5,-.25,+7e2],[0.7071,0,0.7071,0],[0,-1,0,1],[9E+09,9E9,9E9,9E9,9E9,9E9]];\r\n"
          "  LOCAL CONST robtarget row{2}:=[[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],\r\n"
          "    [[4,5,6],[0,1,0,0],[0,0,0,0],none]];\r\n"
          "  CONST robtarget rail:=[[1,2,3],[1,0,0,0],[0,0,0,0],[500,9E9,9E9,9E9,9E9,9E9]];\r\n"
          "  CONST jointtarget home:=[[0,-10.5,20,0,30,-.5],[9E9,9E9,9E9,9E9,9E9,9E9]];\r\n"
          "  VAR robtarget here;\r\n  CONST string s:=\"MoveL [[1,2,3]\";\r\n"
          "  PROC main()\r\n    MoveAbsJ home\\NoEOffs,v100,z50,Gun;\r\n"
          "    MoveJ \\Conc,p10,v100,fine,Gun\\WObj:=Table;\r\n"
          "    IF x>1 MoveL Offs(p10,0,0,50),v100,fine,Gun\\WObj:=Table;\r\n"
          "    MoveC row{1}, [[7,8,9], [0.5,0.5,-0.5,0.5], [1,2,3,0], none],v100,fine,Gun\\WObj:=Table;\r\n"
          "    MoveL here,v100,fine,Gun;\r\n    MoveL elsewhere,v100,fine,Gun;\r\n"
          "    here:=CRobT();\r\n    here.trans.x:=here.trans.x+5;\r\n"
          "    MoveL [[x,8,9],[1,0,0,0],[0,0,0,0],none],v100,fine,Gun;\r\n"
          "  ENDPROC\r\nENDMODULE\r\n"};
}

inline ProgramSample krl_sample() {
  return {
      "part.dat", vernier::ProgramLanguage::krl,
      "&ACCESS RVP\n&REL 12\n&PARAM EDITMASK = *\nDEFDAT  PART PUBLIC\n;FOLD EXTERNAL DECLARATIONS;%{PE}%MKUKATPBASIS\n"
      ";DECL E6POS XOLD={X 1,Y 2,Z 3,A 4,B 5,C 6,S 2,T 2}\n"
      "DECL E6POS XP1={X 445.5,Y -0.25,Z 1.0E+02,A 90.0,B 45.0,C -30.0,S 6,T 50,E1 0.0,E2 0.0,E3 0.0,E4 0.0,E5 "
      "0.0,E6 0.0}\n"
      "DECL FDAT FP1={TOOL_NO 3,BASE_NO 2,IPO_FRAME #BASE,POINT2[] \" \",TQ_STATE FALSE}\n"
      "DECL FDAT FP2={TOOL_NO 1,BASE_NO 0,IPO_FRAME #TCP,POINT2[] \" \"}\n"
      "DECL E6POS XP2={X 1,Y 2,Z 3,A 4,B 5,C 6,S 'B010',T 'B110010'}\n"
      "DECL GLOBAL E6AXIS XHOME={A1 0.0,A2 -90.0,A3 90.0,A4 0.0,A5 .5,A6 0.0,E1 0.0}\n"
      "DECL E6POS XRAIL={X 1,Y 2,Z 3,A 4,B 5,C 6,S 2,T 2,E1 100}\n"
      "DECL FRAME offset={X 1,Y 2,Z 3,A 0,B 0,C 0}\n"
      "TOOL_DATA[3]={X 0,Y 0,Z 100,A 0,B 90,C 0}\nENDDAT\n"};
}

inline ProgramSample krl_source_sample() {
  return {"part.src", vernier::ProgramLanguage::krl,
          "&ACCESS RVP\r\nDEF part( )\r\nDECL POS P1\r\n;FOLD INI\r\nBAS (#INITMOV,0 )\r\n;ENDFOLD\r\n"
          "$TOOL=TOOL_DATA[3]\r\n$BASE={X 100,Y 0,Z 0,A 0,B 0,C 90}\r\n"
          "PTP {A1 1,A2 -90,A3 90,A4 0,A5 10,A6 0}\r\n"
          "PTP {E6POS: X 10,Y 20,Z 30,A 1,B 2,C 3,S 2,T 3} C_PTP\r\n"
          "LIN {X 11,Y 20,Z 30,A 1,B 2,C 3} C_DIS ; {X 1}\r\nLIN_REL {Z 10}\r\nPTP {A3 45}\r\nLIN XP7\r\n"
          "P1={X 1,Y 1,Z 1,A 0,B 0,C 0,S 2,T 2}\r\nCIRC P1, {X 12,Y 20,Z 30,A 1,B 2,C 3}\r\n"
          "P1.X = P1.X+1\r\nLIN P1:{X 0,Y 0,Z 1,A 0,B 0,C 0}\r\n$BASE=$NULLFRAME\r\n"
          "SLIN {X x0,Y 20,Z 30,A 1,B 2,C 3}\r\nEND\r\n"};
}

inline ProgramSample urscript_sample() {
  return {"part.script", vernier::ProgramLanguage::urscript,
          "\xEF\xBB\xBF"
          "def part():\n  # movel(p[1,2,3,0,0,0])\n  global a_p=p[.5, -0.25, 3e-1, 1.2, -1.2, 0.1]\n"
          "  global a_q=[0.1, -1.2, 1.3, -0.2, 1.1, 0.4]\n  feature=p[0,0,1,0,0,0]\n  tcp = p[0,0,0.1,0,0,1.5]\n"
          "  force=[0,0,1,0,0,0]\n  set_tcp(tcp)\n"
          "  movej(get_inverse_kin(a_p, qnear=a_q), a=1.4, v=1.05)\n"
          "  movel(p[0.4,0.1,0.2, 0,\n     3.1, 0], a=1.2, v=0.25, r=0)\n"
          "  movec(a_p, pose_trans(a_p, p[0,0,0.1,0,0,0]))\n  movej([0.1,-1.5,1.5,0,1.5,0], a=1.4)\n"
          "  movej(q_home)\n  moved = get_actual_tcp_pose()\n  movel(moved)\nend\n"};
}

inline ProgramSample fanuc_sample() {
  return {
      "PART.LS", vernier::ProgramLanguage::fanuc_tp,
      "/PROG  PART\r\n/ATTR\r\nOWNER\t\t= MNEDITOR;\r\nCOMMENT\t\t= \"it's\";\r\n/APPL\r\n/MN\r\n"
      "   1:  !L P[9] is no move ;\r\n   2:J P[1] 100% FINE    ;\r\n   3:L P[2:\"weld\"] 500mm/sec CNT100    ;\r\n"
      "   4:C P[3]\r\n    :  P[1] 100mm/sec FINE    ;\r\n   5:L PR[2] 100mm/sec FINE    ;\r\n"
      "   6:L P[2] 100mm/sec FINE Offset,PR[1]    ;\r\n   7:L P[5] 100mm/sec FINE INC    ;\r\n"
      "   8:J P[R[1]] 50% FINE    ;\r\n   9:  CALL P ;\r\n/POS\r\n"
      "P[1]{\r\n   GP1:\r\n\tUF : 0, UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\r\n\tX =   550.000  mm,\tY =     -.250  "
      "mm,\tZ =   600.000  mm,\r\n\tW =  -179.998 deg,\tP =      .083 deg,\tR =    30.000 deg\r\n};\r\n"
      "P[2:\"weld; here\"]{\r\n   GP1:\r\n\tUF : 2, UT : 1,\t\tCONFIG : 'F D B, 0, 0, -1',\r\n\tX =   1.000  mm,\tY = "
      "2.000  mm,\tZ =   3.000  mm,\r\n\tW =  1.0 deg,\tP =  2.0 deg,\tR =  3.0 deg,\r\n\tE1=   .000  mm\r\n};\r\n"
      "P[3]{\r\n   GP1:\r\n\tUF : 0, UT : 1,\t\r\n\tJ1=     0.000 deg,\tJ2=   -20.000 deg,\tJ3= 1.0 deg,\tJ4= 0 "
      "deg,\tJ5= -90 deg,\tJ6= 0 deg\r\n};\r\n"
      "P[4]{\r\n   GP1:\r\n\tUF : 0, UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\r\n\tX =  ********  mm,\tY = 2 mm,\tZ = 3 "
      "mm,\r\n\tW = 1 deg,\tP = 2 deg,\tR = 3 deg\r\n};\r\n"
      "P[5]{\r\n   GP1:\r\n\tUF : 0, UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\r\n\tX = 0 mm,\tY = 0 mm,\tZ = 3 "
      "mm,\r\n\tW = 0 deg,\tP = 0 deg,\tR = 0 deg\r\n};\r\n/END\r\n"};
}

}  // namespace vernier_test
