// SPDX-License-Identifier: BSD-3-Clause
// What is found in programs of each language, and what is not corrected there.

#include <gtest/gtest.h>

#include <numbers>

#include "complaint.hpp"
#include "read_program.hpp"
#include "robot_program_samples.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::robot_parse_test {
namespace {

using namespace vernier_test;

constexpr double degree = std::numbers::pi / 180;

RobotProgram parsed(const ProgramSample& sample) { return parse_program(sample.language, sample.text, sample.name); }

const ProgramTarget& at_line(const RobotProgram& program, std::size_t line) {
  for (const ProgramTarget& target : program.targets)
    if (target.line == line) return target;
  throw std::runtime_error("no target in line " + std::to_string(line));
}

Matrix3 by_rows(std::initializer_list<double> values) {
  Matrix3 out;
  std::size_t k = 0;
  for (const double v : values) {
    out(static_cast<Index>(k / 3), static_cast<Index>(k % 3)) = v;
    ++k;
  }
  return out;
}

TEST(ParseProgram, RapidTargets) {
  const RobotProgram program = parsed(rapid_sample());
  ASSERT_EQ(program.targets.size(), 5u);
  const ProgramTarget& p10 = at_line(program, 12);
  EXPECT_EQ(p10.name, "p10");
  EXPECT_EQ(p10.column, 24u);
  EXPECT_EQ(p10.tool, "gun");
  EXPECT_EQ(p10.workobject, "table");
  EXPECT_EQ(p10.move, TargetMove::joint);
  EXPECT_EQ(p10.configuration, (std::vector<int>{0, -1, 0, 1}));
  EXPECT_LT((p10.pose.translation() - Vector3(0.6005, -0.00025, 0.7)).norm(), 1e-15);
  // (0.7071, 0, 0.7071, 0), normalised: a quarter turn about y; scalar last it would be half a turn
  EXPECT_LT((p10.pose.linear() - by_rows({0, 0, 1, 0, 1, 0, -1, 0, 0})).norm(), 1e-12);
  EXPECT_EQ(at_line(program, 13).tool, "gun");
  EXPECT_EQ(at_line(program, 14).name, "row");
  const ProgramTarget& home = at_line(program, 16);
  EXPECT_EQ(home.kind, TargetKind::joints);
  EXPECT_LT((home.joints / degree - JointVector<6>{0, -10.5, 20, 0, 30, -0.5}).norm(), 1e-12);
  const ProgramTarget& inside = at_line(program, 23);
  EXPECT_EQ(inside.move, TargetMove::linear);
  EXPECT_EQ(inside.configuration, (std::vector<int>{1, 2, 3, 0}));
  // the arm comes to p10 from home; to the others from what nobody knows
  EXPECT_EQ(program.targets[0].name, "home");
  EXPECT_EQ(program.targets[1].name, "p10");
  EXPECT_EQ(program.targets[1].previous, std::optional<std::size_t>(0));
  EXPECT_FALSE(inside.previous);
  EXPECT_EQ(remarks(program),
            "15 [[1,2,3],[1,0,0,0],[0,0,0,0],[500,9E9,9E9,9E9,9E9,9E9]]: external axes are in use\n"
            "22 MoveL Offs(p10,0,0,50): computed, not a literal\n"
            "24 MoveL here: a variable without literal value\n"
            "25 MoveL elsewhere: declared in another file\n"
            "26 here:=CRobT(): the program changes this target\n"
            "27 here.trans.x:=here.trans.x+5: the program changes this target\n"
            "28 [[x,8,9],[1,0,0,0],[0,0,0,0],none]: position or orientation are no numbers\n");
  ASSERT_EQ(program.tools.count("gun"), 1u);
  EXPECT_LT((program.tools.at("gun").linear() - by_rows({0, 0, 1, 1, 0, 0, 0, 1, 0})).norm(), 1e-12);
  EXPECT_LT((program.tools.at("gun").translation() - Vector3(0.01, 0.02, 0.03)).norm(), 1e-15);
  // half a turn about z: the object's 5 mm in y are -5 mm there
  EXPECT_LT((program.workobjects.at("table").translation() - Vector3(0.1, -0.005, 0)).norm(), 1e-15);
  EXPECT_EQ(program.workobjects.count("turntable"), 0u);
  EXPECT_EQ(program.tools.count("tool0"), 1u);
}

TEST(ParseProgram, KrlDataList) {
  const RobotProgram program = parsed(krl_sample());
  ASSERT_EQ(program.targets.size(), 3u);
  const ProgramTarget& p1 = at_line(program, 7);
  EXPECT_EQ(p1.tool, "3");
  EXPECT_EQ(p1.workobject, "2");
  EXPECT_EQ(p1.configuration, (std::vector<int>{6, 50}));
  EXPECT_LT((p1.pose.translation() - Vector3(0.4455, -0.00025, 0.1)).norm(), 1e-15);
  // Rz(90) Ry(45) Rx(-30), multiplied by hand
  const double s = std::sqrt(0.5), h = std::sqrt(3.0) / 2;
  EXPECT_LT((p1.pose.linear() - by_rows({0, -h, -0.5, s, -s / 2, s * h, -s, -s / 2, s * h})).norm(), 1e-12);
  EXPECT_EQ(at_line(program, 10).configuration, (std::vector<int>{2, 50}));
  EXPECT_EQ(at_line(program, 10).tool, "external");
  EXPECT_LT((at_line(program, 11).joints / degree - JointVector<6>{0, -90, 90, 0, 0.5, 0}).norm(), 1e-12);
  EXPECT_EQ(remarks(program), "12 {X 1,Y 2,Z 3,A 4,B 5,C 6,S 2,T 2,E1 100}: external axes are in use\n");
  EXPECT_LT((program.tools.at("3").translation() - Vector3(0, 0, 0.1)).norm(), 1e-15);
}

TEST(ParseProgram, KrlSource) {
  const RobotProgram program = parsed(krl_source_sample());
  ASSERT_EQ(program.targets.size(), 4u);  // not P1, which the program changes
  EXPECT_EQ(at_line(program, 9).kind, TargetKind::joints);
  const ProgramTarget& ptp = at_line(program, 10);
  EXPECT_EQ(ptp.tool, "3");
  EXPECT_EQ(ptp.workobject, "$BASE of line 8");
  EXPECT_EQ(ptp.previous, std::optional<std::size_t>(0));
  const ProgramTarget& lin = at_line(program, 11);
  EXPECT_TRUE(lin.configuration.empty());
  EXPECT_EQ(lin.move, TargetMove::linear);
  EXPECT_EQ(lin.previous, std::optional<std::size_t>(1));
  EXPECT_FALSE(at_line(program, 16).previous);
  EXPECT_LT((program.workobjects.at("$BASE of line 8").linear() - by_rows({1, 0, 0, 0, 0, -1, 0, 1, 0})).norm(), 1e-12);
  EXPECT_EQ(remarks(program),
            "12 LIN_REL {Z 10}: a relative move\n"
            "13 {A3 45}: components are missing, those of the position before are kept\n"
            "14 LIN XP7: no literal of this file, perhaps of its data list\n"
            "17 P1.X = P1.X+1: the program changes this target\n"
            "18 LIN P1:{X 0,Y 0,Z 1,A 0,B 0,C 0}: computed, not a literal\n"
            "20 {X x0,Y 20,Z 30,A 1,B 2,C 3}: its components are no numbers\n");
}

TEST(ParseProgram, UrScript) {
  const RobotProgram program = parsed(urscript_sample());
  ASSERT_EQ(program.targets.size(), 3u);
  const ProgramTarget& a = at_line(program, 3);
  EXPECT_EQ(a.name, "a_p");
  EXPECT_LT((a.joints - JointVector<6>{0.1, -1.2, 1.3, -0.2, 1.1, 0.4}).norm(), 1e-15);
  EXPECT_EQ(a.tool, "set_tcp of line 8");
  // Rodrigues' formula written out
  const Vector3 r(1.2, -1.2, 0.1), n = r.normalized();
  const double angle = r.norm();
  Matrix3 k;
  k << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
  EXPECT_LT((a.pose.linear() - (Matrix3::Identity() + std::sin(angle) * k + (1 - std::cos(angle)) * k * k)).norm(),
            1e-12);
  EXPECT_LT((a.pose.translation() - Vector3(0.5, -0.25, 0.3)).norm(), 1e-15);
  const ProgramTarget& line = at_line(program, 10);
  EXPECT_EQ(line.move, TargetMove::linear);
  EXPECT_EQ(line.numbers.size(), 6u);
  EXPECT_EQ(at_line(program, 13).kind, TargetKind::joints);
  EXPECT_EQ(program.tools.size(), 1u);
  EXPECT_LT((program.tools.at("set_tcp of line 8").translation() - Vector3(0, 0, 0.1)).norm(), 1e-15);
  EXPECT_EQ(remarks(program),
            "5 feature: no move of this file uses it\n"
            "12 movec(pose_trans(a_p, p[0,0,0.1,0,0,0])): computed, not a literal\n"
            "14 movej(q_home): not assigned in this file\n"
            "16 movel(moved): computed, not a literal\n");
}

TEST(ParseProgram, FanucTp) {
  const RobotProgram program = parsed(fanuc_sample());
  ASSERT_EQ(program.targets.size(), 3u);
  const ProgramTarget& p1 = program.targets[0];
  EXPECT_EQ(p1.name, "P[1]");
  EXPECT_EQ(p1.line, 18u);
  EXPECT_EQ(p1.tool, "1");
  EXPECT_EQ(p1.workobject, "0");
  EXPECT_EQ(p1.configuration, (std::vector<int>{0, 1, 1, 0, 0, 0}));
  EXPECT_LT((p1.pose.translation() - Vector3(0.55, -0.00025, 0.6)).norm(), 1e-15);
  // turns about the fixed axes x, then y, then z
  const auto about = [](double angle, const Vector3& axis) {
    return Matrix3(Eigen::AngleAxisd(angle * degree, axis).toRotationMatrix());
  };
  Vector3 v(0.3, 0.4, 0.5);
  const Vector3 turned = p1.pose.linear() * v;
  v = about(-179.998, Vector3::UnitX()) * v;
  v = about(0.083, Vector3::UnitY()) * v;
  v = about(30, Vector3::UnitZ()) * v;
  EXPECT_LT((turned - v).norm(), 1e-14);
  EXPECT_EQ(program.targets[1].configuration, (std::vector<int>{1, 0, 0, 0, 0, -1}));
  EXPECT_EQ(program.targets[1].workobject, "2");
  EXPECT_EQ(program.targets[2].kind, TargetKind::joints);
  EXPECT_LT((program.targets[2].joints - degree * JointVector<6>{0, -20, 1, 0, -90, 0}).norm(), 1e-15);
  EXPECT_EQ(remarks(program),
            "12 L PR[2] 100mm/sec FINE: a position register\n"
            "13 L P[2] 100mm/sec FINE Offset,PR[1]: an offset that a register adds\n"
            "14 L P[5] 100mm/sec FINE INC: a relative move\n"
            "15 J P[R[1]] 50% FINE: computed, not a literal\n"
            "16 CALL P: what it does to targets is not known\n"
            "36 P[4]: a component is missing or no number\n"
            "42 P[5]: moves use it as an increment or with an offset\n");
}

TEST(ParseProgram, DamagedFanucPositionsAreListed) {
  const auto position = [](const std::string& config, const std::string& r) {
    return remarks(parse_program(ProgramLanguage::fanuc_tp,
                                 "/PROG A\n/MN\n/POS\nP[1]{\nGP1:\nUF : 0, UT : 1, CONFIG : " + config +
                                     ",\nX = 1 mm, Y = 2 mm, Z = 3 mm,\nW = 4 deg, P = 5 deg, R = " + r +
                                     "\n};\n/END\n",
                                 "a.ls"));
  };
  EXPECT_EQ(position("'N U T, 0, 0, 0'", "6 deg"), "");
  EXPECT_EQ(position("'N U T, 0, 0, 0'", "6M0 deg"), "4 P[1]: a component is missing or no number\n");
  EXPECT_EQ(position("'N U T, 0, 0, -1\n'", "6 deg"), "4 P[1]: its configuration is missing or of another kind\n");
}

TEST(ParseProgram, MovesWithSeveralToolsAreToldApart) {
  const RobotProgram program = parse_program(
      ProgramLanguage::rapid,
      "MODULE m\nCONST robtarget p:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nPROC main()\n"
      "MoveL p,v1,fine,tool0;\nMoveL p,v1,fine,gun;\nENDPROC\nENDMODULE\n",
      "m.mod");
  EXPECT_TRUE(program.targets.empty());
  EXPECT_EQ(remarks(program), "2 p: moves use it with different tools or work objects\n");
}

TEST(ParseProgram, LanguagesByTheEndingOfTheName) {
  EXPECT_EQ(program_language("a/B.MOD"), ProgramLanguage::rapid);
  EXPECT_EQ(program_language("a.prg"), ProgramLanguage::rapid);
  EXPECT_EQ(program_language("a.Src"), ProgramLanguage::krl);
  EXPECT_EQ(program_language("a.dat"), ProgramLanguage::krl);
  EXPECT_EQ(program_language("a.script"), ProgramLanguage::urscript);
  EXPECT_EQ(program_language("A.LS"), ProgramLanguage::fanuc_tp);
  EXPECT_EQ(complaint([] { (void)program_language("a.tp"); }), "a.tp: a binary program; export it as text (.ls)");
  EXPECT_NE(complaint([] { (void)program_language("a.txt"); }).find("a.txt: no robot program"), std::string::npos);
}

TEST(ParseProgram, DamageIsRefusedInOneLine) {
  using enum ProgramLanguage;
  const auto refused = [](ProgramLanguage language, const std::string& text) {
    std::string out = complaint([&] { (void)parse_program(language, text, "f"); });
    EXPECT_EQ(out.find('\n'), std::string::npos);
    return out;
  };
  EXPECT_EQ(refused(rapid, "PROC main()\nENDPROC\n"), "f: no MODULE, so this is no RAPID program");
  EXPECT_EQ(refused(krl, "XP1={X 1}\n"), "f: neither DEF nor DEFDAT, so this is no KRL program");
  EXPECT_EQ(refused(fanuc_tp, "/PROG A\n/MN\n"), "f: no sections /PROG, /MN and /POS, so this is no Fanuc program");
  EXPECT_EQ(refused(rapid, "MODULE m\nCONST robtarget p:=[[1,2;\nENDMODULE\n"), "f, line 2: a bracket [ is not closed");
  EXPECT_EQ(refused(rapid, "MODULE m\nPROC a()\nMoveL p,v1"), "f, line 3: an instruction is not ended by ;");
  EXPECT_EQ(refused(rapid, "MODULE m\nVAR num a:=" + std::string(40, '[')),
            "f, line 2: brackets nested deeper than 32");
  EXPECT_EQ(refused(krl, "DEF m()\nPTP {X 1\nEND\n"), "f, line 2: a brace { is not closed");
  EXPECT_EQ(refused(urscript, "def a():\n movel(p[1,2"), "f, line 2: a bracket [ is not closed");
  EXPECT_EQ(refused(fanuc_tp, "/PROG A\n/MN\n/POS\nP[1]{\n GP1:\n/END\n"), "f, line 4: a brace { is not closed");
  EXPECT_EQ(refused(fanuc_tp, "/PROG A\n/MN\n/POS\nP[1]{\n};\nP[1]{\n};\n/END\n"), "f, line 6: P[1] is there twice");
  EXPECT_EQ(refused(urscript, std::string("def a():\n\0", 10)), "f, line 2: binary data, not text");
  EXPECT_EQ(refused(urscript, std::string(100001, 'a')), "f, line 1: 100001 bytes in a line, at most 100000");
  EXPECT_EQ(refused(urscript, std::string((16u << 20) + 1, '\n')), "f: 16777217 bytes, at most 16777216");
}

}  // namespace
}  // namespace vernier::robot_parse_test
