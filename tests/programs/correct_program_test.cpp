// SPDX-License-Identifier: BSD-3-Clause
// Runs correct on robot programs made here, and lets a simulated controller execute what it writes: it finds the joint
// values of each pose by inverse kinematics from many starts, keeps those with the configuration that the program
// states, by definitions of its own, and moves the real arm there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <vector>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/ur_calibration.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::correct_program_test {
namespace {

using vernier_test::CommandResult;
using Joints = JointVector<6>;
using Model = CalibratedRobot<6>::Model;

constexpr double degree = std::numbers::pi / 180;

/// A KUKA of 0.7 m in its maker's joint values; its chain stands on its head in the robot's base.
Robot<6> kuka() {
  using namespace literals;
  constexpr DhChain<6> chain{{{
      {.a = 25_mm, .alpha = 90_deg, .d = -400_mm},
      {.a = 315_mm, .alpha = 0_deg, .d = 0_mm},
      {.a = 35_mm, .alpha = 90_deg, .d = 0_mm, .theta = -90_deg},
      {.a = 0_mm, .alpha = -90_deg, .d = -365_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 180_deg, .d = -80_mm, .theta = 180_deg},
  }}};
  return {chain, detail::limits_deg<6>({-170, -190, -120, -185, -120, -350}, {170, 45, 156, 185, 120, 350}), "kuka"};
}

/// A Fanuc of 0.7 m, its third joint measured from the second link.
Robot<6> fanuc() {
  using namespace literals;
  constexpr DhChain<6> chain{{{
      {.a = 50_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 330_mm, .alpha = 180_deg, .d = 0_mm, .theta = -90_deg},
      {.a = 35_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = -335_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
      {.a = 0_mm, .alpha = 180_deg, .d = -80_mm},
  }}};
  return {chain, detail::limits_deg<6>({-170, -100, -70, -190, -125, -360}, {170, 145, 205, 190, 125, 360}), "fanuc"};
}

/// Side of the wrist centre, bend of the elbow and angle of the wrist by the positions of the links; each changes its
/// sign in its singularity.
Vector3 sides(const DhChain<6>& chain, const Joints& q) {
  const auto links = chain.links(q);
  const auto point = [&](int j) { return Vector3(links.point.col(j)); };
  const auto axis = [&](int j) { return Vector3(links.axis.col(j)); };
  const Vector3 wrist = point(4), forward = axis(0).cross(axis(1));
  return {(wrist - point(0)).dot(forward), (point(2) - point(1)).cross(wrist - point(2)).dot(axis(1)), std::sin(q(4))};
}

std::vector<double> numbers_in(const std::string& text) {
  static const std::regex number("[-+]?[0-9]*\\.?[0-9]+([eE][-+]?[0-9]+)?");
  std::vector<double> out;
  for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it)
    out.push_back(std::stod(it->str()));
  return out;
}

class CorrectProgram : public ::testing::Test {
 protected:
  void make_model(const Robot<6>& catalogue, std::uint64_t seed) {
    nominal_ = catalogue.chain;
    limits_ = catalogue.limits;
    const Model::Arm actual{with_geometric_errors(catalogue.chain, {}, seed),
                            FrameParameters(Vector6{1, 2, 0.5, 0.1, 0.2, 1}),
                            FrameParameters(Vector6{0.01, 0, 0.1, 0, 0.4, 0})};
    robot_.emplace("simulated", Model(catalogue.chain, actual), catalogue.limits, Provenance{.held_out_error = 8.6e-5});
    save(folder_ / "model.json", *robot_);
  }

  CommandResult correct(const std::string& arguments) {
    return vernier_test::run_command(
        "cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/correct' --model model.json " + arguments,
        folder_.path());
  }

  /// Joint values away from singularities, on all branches.
  std::vector<Joints> sample(int n, std::uint64_t seed, double elbow) {
    Rng rng(seed);
    std::vector<Joints> out;
    while (static_cast<int>(out.size()) < n) {
      Joints q;
      for (int j = 0; j < 6; ++j)
        q(j) = limits_.lower(j) + (0.03 + 0.94 * rng.uniform()) * (limits_.upper(j) - limits_.lower(j));
      const Vector3 at = sides(nominal_, q);
      if (std::abs(at(0)) > 0.08 && std::abs(at(1)) > elbow && std::abs(at(2)) > 0.2) out.push_back(q);
    }
    return out;
  }

  /// Joint values with which a controller's arm is at a pose, as the program's configuration tells them apart.
  Joints executed(const DhChain<6>& controller, const Isometry3& flange,
                  const std::function<bool(const Joints&)>& fits) {
    Rng rng(5);
    std::vector<Joints> found;
    for (int start = 0; start < 400; ++start) {
      Joints seed;
      for (int j = 0; j < 6; ++j) seed(j) = limits_.lower(j) + rng.uniform() * (limits_.upper(j) - limits_.lower(j));
      const IkResult<6> result =
          inverse_kinematics(controller, flange, seed, {.limits = limits_, .max_iterations = 60});
      if (result.status != IkStatus::converged) continue;
      for (int turn = -1; turn <= 1; ++turn) {  // of joint 6, whose range is wider than a turn
        Joints q = result.joints;
        q(5) += 2 * std::numbers::pi * turn;
        if (!limits_.contains(q) || !fits(q)) continue;
        if (std::none_of(found.begin(), found.end(), [&](const Joints& f) { return (f - q).norm() < 1e-4; }))
          found.push_back(q);
      }
    }
    EXPECT_EQ(found.size(), 1u);
    return found.empty() ? Joints(Joints::Zero()) : found.front();
  }

  /// Distance of the real arm at joint values from where the nominal arm would be at others [m], and angle [rad].
  void expect_met(const Joints& command, const Isometry3& chain_pose) {
    const Isometry3 wanted = robot_->nominal().base() * chain_pose * robot_->nominal().tool();
    const Vector6 left = pose_difference(wanted, robot_->identified().pose(command));
    EXPECT_LT(left.head<3>().norm(), 10e-6);
    EXPECT_LT(left.tail<3>().norm(), 10e-6);
  }

  vernier_test::TemporaryFolder folder_{"correct_program"};
  DhChain<6> nominal_ = robots::abb_irb120().chain;
  JointLimits<6> limits_{};
  std::optional<CalibratedRobot<6>> robot_{};
};

Isometry3 frame(const Vector3& mm, const Matrix3& rotation) {
  Isometry3 out = Isometry3::Identity();
  out.translation() = mm * 1e-3;
  out.linear() = rotation;
  return out;
}

Matrix3 turn(double degrees, const Vector3& axis) {
  return Eigen::AngleAxisd(degrees * degree, axis).toRotationMatrix();
}

TEST_F(CorrectProgram, Rapid) {
  make_model(robots::abb_irb120(), 21);
  const Isometry3 tool = frame({10, -20, 150}, turn(90, Vector3::UnitZ()));
  const Isometry3 object = frame({100, 50, 20}, turn(30, Vector3::UnitX()));
  const std::vector<Joints> joints = sample(24, 3, 0.01);
  const auto flags = [&](const Joints& q) {
    const Vector3 at = sides(nominal_, q), home = sides(nominal_, Joints{0, 0, 0, 0, 0.5, 0});
    return std::array<int, 4>{
        static_cast<int>(std::floor(q(0) / degree / 90)), static_cast<int>(std::floor(q(3) / degree / 90)),
        static_cast<int>(std::floor(q(5) / degree / 90)),
        (at(2) * home(2) < 0 ? 1 : 0) + (at(1) * home(1) < 0 ? 2 : 0) + (at(0) * home(0) < 0 ? 4 : 0)};
  };
  std::string text =
      "%%%\r\n  VERSION:1\r\n%%%\r\nMODULE part\r\n! weld \xE4\xF6\r\n"
      "PERS tooldata gun:=[TRUE,[[10,-20,150],[0.707106781,0,0,0.707106781]],[1,[0,0,10],[1,0,0,0],0,0,0]];\r\n"
      "PERS wobjdata table:=[FALSE,TRUE,\"\",[[100,50,20],[0.965925826,0.258819045,0,0]],[[0,0,0],[1,0,0,0]]];\r\n"
      "PROC main()\r\n";
  for (const Joints& q : joints) {
    const Isometry3 x = object.inverse() * nominal_.pose(q) * tool;
    const Eigen::Quaterniond r(Matrix3(x.linear()));
    const auto c = flags(q);
    char line[400];
    std::snprintf(line, sizeof line,
                  "  MoveJ [[%.6f,%.6f,%.6f],[%.9f,%.9f,%.9f,%.9f],[%d,%d,%d,%d],[9E9,9E9,9E9,9E9,9E+09,9E9]],v100,"
                  "fine,gun\\WObj:=table;\r\n",
                  x.translation().x() * 1e3, x.translation().y() * 1e3, x.translation().z() * 1e3, r.w(), r.x(), r.y(),
                  r.z(), c[0], c[1], c[2], c[3]);
    text += line;
  }
  text += "  MoveAbsJ [[10,20,-30,40,50,60],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,gun;\r\nENDPROC\r\nENDMODULE\r\n";
  write_file(folder_ / "part.mod", text);
  const CommandResult done = correct("--program part.mod --out out.mod --json r.json --date 2026-02-03 --no-approach");
  ASSERT_EQ(done.exit_code, 0) << done.errors << done.output;
  EXPECT_NE(done.output.find("part.mod: 25 targets corrected"), std::string::npos) << done.output;
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "r.json")).at("corrected"), 25);

  const std::string out = read_file(folder_ / "out.mod");
  const std::size_t stamp = out.find("! VERNIER-CORRECTED");
  ASSERT_NE(stamp, std::string::npos);
  EXPECT_EQ(out.substr(0, stamp), text.substr(0, stamp));
  EXPECT_NE(out.find("! sha256 " + sha256(read_file(folder_ / "model.json")) + "\r\n"), std::string::npos);
  EXPECT_NE(out.find("! 2026-02-03 by Vernier"), std::string::npos);
  EXPECT_NE(out.find("! do not correct this program twice\r\n"), std::string::npos);
  EXPECT_NE(out.find("! held-out error 0.086 mm (mean)\r\n"), std::string::npos);
  EXPECT_NE(out.find("! weld \xE4\xF6\r\n"), std::string::npos);
  std::size_t k = 0;
  for (std::size_t at = out.find("MoveJ"); at != std::string::npos; at = out.find("MoveJ", at + 1), ++k) {
    const std::vector<double> v = numbers_in(out.substr(at + 5, out.find(";", at) - at));
    EXPECT_NEAR(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6], 1, 5e-9);
    const Isometry3 x = frame({v[0], v[1], v[2]}, Eigen::Quaterniond(v[3], v[4], v[5], v[6]).toRotationMatrix());
    const Joints q = executed(nominal_, object * x * tool.inverse(), [&](const Joints& candidate) {
      const auto c = flags(candidate);
      return c[0] == v[7] && c[1] == v[8] && c[2] == v[9] && c[3] == v[10];
    });
    expect_met(q, nominal_.pose(joints[k]));
  }
  EXPECT_EQ(k, joints.size());
  const std::vector<double> v = numbers_in(out.substr(out.find("MoveAbsJ") + 8));
  const Joints absolute = Eigen::Map<const Joints>(v.data()) * degree;
  expect_met(absolute, nominal_.pose(Joints{10, 20, -30, 40, 50, 60} * degree));

  const CommandResult again = correct("--program out.mod --out twice.mod");
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.errors.find("out.mod, line 5: this program was corrected before"), std::string::npos) << again.errors;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "twice.mod"));
}

TEST_F(CorrectProgram, Krl) {
  make_model(kuka(), 22);
  // The maker's position at zero, and the orientation in its home position: A 0, B 90, C 0.
  const Isometry3 root = frame(Vector3::Zero(), turn(180, Vector3::UnitX()));
  EXPECT_LT(((root.inverse() * nominal_.pose(Joints::Zero())).translation() - Vector3(0.785, 0, 0.435)).norm(), 1e-12);
  EXPECT_LT((Matrix3((root.inverse() * nominal_.pose(Joints{0, -90, 90, 0, 0, 0} * degree)).linear()) -
             turn(90, Vector3::UnitY()))
                .norm(),
            1e-12);
  const Isometry3 tool = frame({0, 30, 120}, turn(45, Vector3::UnitY()));
  const auto flags = [&](const Joints& q) {
    const Vector3 at = sides(nominal_, q), home = sides(nominal_, Joints{0, -90, 90, 0, 30, 0} * degree);
    int turns = 0;
    for (int j = 0; j < 6; ++j) turns |= q(j) < 0 ? 1 << j : 0;
    return std::array<int, 2>{(at(0) * home(0) < 0 ? 1 : 0) + (at(1) * home(1) > 0 ? 2 : 0) + (q(4) < 0 ? 4 : 0),
                              turns};
  };
  std::vector<Joints> joints = sample(24, 4, 0.01);
  std::erase_if(joints, [](const Joints& q) { return (q.array().abs() < 3 * degree).any(); });
  std::string text = "&ACCESS RVP\n&REL 1\nDEFDAT  part PUBLIC\n;FOLD EXTERNAL DECLARATIONS;%{PE}\n;ENDFOLD\n";
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const Isometry3 x = root.inverse() * nominal_.pose(joints[k]) * tool;
    const auto& r = x.linear();
    const auto c = flags(joints[k]);
    char line[400];
    std::snprintf(line, sizeof line,
                  "DECL E6POS XP%zu={X %.6f,Y %.6f,Z %.6f,A %.7f,B %.7f,C %.7f,S %d,T %d,E1 0.0,E2 0.0,E3 0.0,E4 0.0,"
                  "E5 0.0,E6 0.0}\nDECL FDAT FP%zu={TOOL_NO 3,BASE_NO 0,IPO_FRAME #BASE,POINT2[] \" \"}\n",
                  k, x.translation().x() * 1e3, x.translation().y() * 1e3, x.translation().z() * 1e3,
                  std::atan2(r(1, 0), r(0, 0)) / degree, std::asin(-r(2, 0)) / degree,
                  std::atan2(r(2, 1), r(2, 2)) / degree, c[0], c[1], k);
    text += line;
  }
  text += "DECL E6AXIS XHOME={A1 10,A2 -80,A3 70,A4 5,A5 20,A6 -5,E1 0}\nENDDAT\n";
  write_file(folder_ / "part.dat", text);
  const CommandResult unknown = correct("--program part.dat --robot-base 0,0,0,180,0,0 --out out.dat");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(
      unknown.output.find("line 6: not corrected: xp0: the frame of its tool 3 is not known; name it with --tool"),
      std::string::npos)
      << unknown.output;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.dat"));
  const CommandResult done =
      correct("--program part.dat --robot-base 0,0,0,180,0,0 --tool 3=0,30,120,0,45,0 --out out.dat");
  ASSERT_EQ(done.exit_code, 0) << done.errors << done.output;
  const std::string out = read_file(folder_ / "out.dat");
  std::size_t k = 0;
  for (std::size_t at = out.find("={X"); at != std::string::npos; at = out.find("={X", at + 1), ++k) {
    const std::vector<double> v = numbers_in(out.substr(at, out.find("E1", at) - at));
    ASSERT_EQ(v.size(), 8u);
    const Isometry3 x = frame(
        {v[0], v[1], v[2]}, turn(v[3], Vector3::UnitZ()) * turn(v[4], Vector3::UnitY()) * turn(v[5], Vector3::UnitX()));
    const Joints q = executed(nominal_, root * x * tool.inverse(), [&](const Joints& candidate) {
      const auto c = flags(candidate);
      return c[0] == v[6] && c[1] == v[7];
    });
    expect_met(q, nominal_.pose(joints[k]));
  }
  EXPECT_EQ(k, joints.size());
  const std::string home = out.substr(out.find("XHOME"));
  const std::vector<double> v = numbers_in(std::regex_replace(home, std::regex("A[1-6] "), " "));
  expect_met(Eigen::Map<const Joints>(v.data()) * degree, nominal_.pose(Joints{10, -80, 70, 5, 20, -5} * degree));
}

TEST_F(CorrectProgram, FanucTp) {
  make_model(fanuc(), 23);
  EXPECT_LT((nominal_.position(Joints::Zero()) - Vector3(0.465, 0, 0.365)).norm(), 1e-12);
  const auto flags = [&](const Joints& q) {
    const Vector3 at = sides(nominal_, q), home = sides(nominal_, Joints{0, 0, 0, 0, -0.5, 0});
    return std::array<int, 4>{q(4) < 0 ? 0 : 1, at(1) * home(1) > 0 ? 1 : 0, at(0) * home(0) > 0 ? 1 : 0,
                              static_cast<int>(std::floor((q(5) / degree + 180) / 360))};
  };
  std::vector<Joints> joints = sample(24, 6, 0.01);
  std::erase_if(joints, [](const Joints& q) { return std::abs(q(3)) > 179 * degree || std::abs(q(0)) > 179 * degree; });
  std::string moves, positions;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const Isometry3 x = nominal_.pose(joints[k]);
    const auto& r = x.linear();
    const auto c = flags(joints[k]);
    char line[500];
    std::snprintf(line, sizeof line, "%4zu:J P[%zu] 100%% FINE    ;\n", k + 1, k + 1);
    moves += line;
    std::snprintf(
        line, sizeof line,
        "P[%zu%s]{\n   GP1:\n\tUF : 0, UT : 0,\t\tCONFIG : '%c %c %c, 0, 0, %d',\n\tX = %9.4f  mm,\tY = %9.4f  "
        "mm,\tZ = %9.4f  mm,\n\tW = %9.6f deg,\tP = %9.6f deg,\tR = %9.6f deg\n};\n",
        k + 1, k == 0 ? ":\"start; here\"" : "", c[0] != 0 ? 'F' : 'N', c[1] != 0 ? 'U' : 'D', c[2] != 0 ? 'T' : 'B',
        c[3], x.translation().x() * 1e3, x.translation().y() * 1e3, x.translation().z() * 1e3,
        std::atan2(r(2, 1), r(2, 2)) / degree, std::asin(-r(2, 0)) / degree, std::atan2(r(1, 0), r(0, 0)) / degree);
    positions += line;
  }
  write_file(folder_ / "PART.LS",
             "/PROG  PART\n/ATTR\nCOMMENT\t\t= \"\";\n/MN\n" + moves + "/POS\n" + positions + "/END\n");
  const CommandResult which = correct("--program PART.LS --out out.ls");
  EXPECT_EQ(which.exit_code, 2);
  EXPECT_NE(which.errors.find("a Fanuc program needs --noflip"), std::string::npos) << which.errors;
  const CommandResult done = correct("--program PART.LS --noflip negative --out out.ls");
  ASSERT_EQ(done.exit_code, 0) << done.errors << done.output;
  const std::string out = read_file(folder_ / "out.ls");
  EXPECT_NE(out.find("/MN\n   :  !VERNIER-CORRECTED: ;\n"), std::string::npos);
  EXPECT_NE(out.find("   :  !held-out error 0.086 mm (mean) ;\n"), std::string::npos);
  std::size_t k = 0;
  for (std::size_t at = out.find("CONFIG"); at != std::string::npos; at = out.find("CONFIG", at + 1), ++k) {
    const std::string config = out.substr(at, out.find("X =", at) - at);
    const std::vector<double> turns = numbers_in(config);
    const std::vector<double> v = numbers_in(out.substr(out.find("X =", at), out.find("}", at) - out.find("X =", at)));
    ASSERT_EQ(v.size(), 6u);
    const Isometry3 x = frame(
        {v[0], v[1], v[2]}, turn(v[5], Vector3::UnitZ()) * turn(v[4], Vector3::UnitY()) * turn(v[3], Vector3::UnitX()));
    const Joints q = executed(nominal_, x, [&](const Joints& candidate) {
      const auto c = flags(candidate);
      return std::abs(candidate(3)) <= 180 * degree && config.find(c[0] != 0 ? "'F" : "'N") != std::string::npos &&
             config.find(c[1] != 0 ? " U" : " D") != std::string::npos &&
             config.find(c[2] != 0 ? " T," : " B,") != std::string::npos && c[3] == turns[2];
    });
    expect_met(q, nominal_.pose(joints[k]));
  }
  EXPECT_EQ(k, joints.size());
}

TEST_F(CorrectProgram, UrScript) {
  make_model(robots::ur10(), 24);
  const char* calibration =
      "[mounting]\n"
      "delta_theta = [ 1.59613525316931737e-07, -0.917209621528830232, 7.12936131346499469, 0.0710299029424392298, "
      "-1.64258976526054923e-06, 9.17286101034808787e-08]\n"
      "delta_a = [ 3.12246947568e-05, 0.0121796888294, 0.00202478480424, 6.13384378e-05, -6.2e-05, 0]\n"
      "delta_d = [ 5.33192291e-05, 0, 0, 1e-4, 9.98e-06, -4.8e-05]\n"
      "delta_alpha = [ -0.00027, 0.00152, 0.00018, 0.00038, 0.00012, 0]\n";
  // Nearly parallel axes need d of their own; take deltas that keep them small.
  std::string small(calibration);
  small = std::regex_replace(small, std::regex("-0.917209621528830232, 7.12936131346499469, 0.0710299029424392298"),
                             "-0.000917, 0.00071, 0.000071");
  small = std::regex_replace(small, std::regex("0.0121796888294, 0.00202478480424"), "0.000121, 0.000202");
  write_file(folder_ / "calibration.conf", small);
  RobotDescription described = RobotDescription::of(robots::ur10());
  const DhChain<6> controller = read_ur_calibration(folder_ / "calibration.conf", described).arm<6>().arm.model();
  ASSERT_GT(
      (controller.position(Joints{0.1, -1, 1, 0.2, 1, 0}) - nominal_.position(Joints{0.1, -1, 1, 0.2, 1, 0})).norm(),
      1e-4);
  const Isometry3 tool = frame({0, 0, 100}, Matrix3::Identity());
  Rng rng(8);
  std::vector<Joints> joints;
  std::string points, moves = "  set_tcp(p[0,0,0.1,0,0,0])\n";
  const auto row = [](const char* head, const auto& v, int decimals) {
    std::string out = head;
    for (Index j = 0; j < 6; ++j) {
      char number[40];
      std::snprintf(number, sizeof number, "%s%.*f", j != 0 ? ", " : "", decimals, v(j));
      out += number;
    }
    return out + "]\n";
  };
  for (int k = 0; k < 12; ++k) {
    Joints q;
    for (int j = 0; j < 6; ++j) q(j) = (rng.uniform() - 0.5) * 4;
    q(2) = 0.5 + rng.uniform();
    q(4) = 0.5 + rng.uniform();
    joints.push_back(q);
    const Isometry3 x = controller.pose(q) * tool;
    Vector6 v;
    v << x.translation(), log_so3(Matrix3(x.linear()));
    const std::string name = message("  global point_", k);
    points += row((name + "_p=p[").c_str(), v, 9) + row((name + "_q=[").c_str(), q, 4);
    moves += message("  movej(get_inverse_kin(point_", k, "_p, qnear=point_", k, "_q), a=1.4, v=1.05)\n");
  }
  moves += "  movej([0.1,-1.2,1.3,-0.2,1.1,0.4], a=1)\n";
  write_file(folder_ / "part.script", "def part():\n" + points + moves + "end\n");
  const CommandResult nominal = correct("--program part.script --out out.script --allow-uncorrected");
  EXPECT_EQ(nominal.exit_code, 0) << nominal.errors;
  EXPECT_NE(
      nominal.output.find("line 2: not corrected: point_0_p: poses are reached by the robot's factory calibration"),
      std::string::npos)
      << nominal.output;
  EXPECT_NE(nominal.output.find("1 targets corrected"), std::string::npos);
  const CommandResult done = correct("--program part.script --controller calibration.conf --out out.script");
  ASSERT_EQ(done.exit_code, 0) << done.errors << done.output;
  const std::string out = read_file(folder_ / "out.script");
  EXPECT_EQ(out.find("# VERNIER-CORRECTED"), 0u);
  EXPECT_NE(out.find(moves.substr(0, moves.find("  movej(["))), std::string::npos);
  std::size_t at = 0;
  for (const Joints& q : joints) {
    at = out.find("=p[", at) + 3;
    const std::vector<double> v = numbers_in(out.substr(at, out.find("]", at) - at));
    const Isometry3 x = frame(Vector3(v[0], v[1], v[2]) * 1e3, exp_so3(Vector3(v[3], v[4], v[5])));
    // the controller's solution is the nearest to qnear
    const IkResult<6> found = inverse_kinematics(controller, x * tool.inverse(), q);
    ASSERT_EQ(found.status, IkStatus::converged);
    EXPECT_LT((found.joints - q).norm(), 0.1);
    expect_met(found.joints, controller.pose(q));
  }
  const std::vector<double> v = numbers_in(out.substr(out.find("movej([") + 7));
  expect_met(Eigen::Map<const Joints>(v.data()), controller.pose(Joints{0.1, -1.2, 1.3, -0.2, 1.1, 0.4}));
}

TEST_F(CorrectProgram, AnotherModelAsController) {
  make_model(robots::abb_irb120(), 21);
  const Model::Arm other{with_geometric_errors(nominal_, {}, 77), FrameParameters(Vector6{3, 0, 0, 0, 0, 0.3}),
                         FrameParameters(Vector6{0, 0.2, 0, 0, 0, 0})};
  save(folder_ / "controller.json", CalibratedRobot<6>("factory", Model(nominal_, other), limits_, {}));
  write_file(folder_ / "a.mod",
             "MODULE a\nPROC main()\nMoveL [[374,50,500],[0.5,0,0.866025404,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],"
             "v1,fine,tool0;\nMoveAbsJ [[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;\nENDPROC\nENDMODULE\n");
  const CommandResult done = correct("--program a.mod --controller controller.json --out b.mod --allow-uncorrected");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const std::string out = read_file(folder_ / "b.mod");
  const std::vector<double> v = numbers_in(out.substr(out.find("MoveAbsJ") + 8));
  expect_met(Eigen::Map<const Joints>(v.data()) * degree,
             other.model().chain().pose(Joints{1, 2, 3, 4, 5, 6} * degree));
}

TEST_F(CorrectProgram, EachTargetInAMoveComesFromTheOneBefore) {
  make_model(robots::abb_irb120(), 21);
  JointTerms terms(6);
  terms.hysteresis = {0.02};
  const Model model(nominal_, Model::Arm({robot_->identified().chain(), JointErrors(terms, VectorX::Constant(6, 1e-4))},
                                         robot_->identified().base_frame(), robot_->identified().tool_frame()));
  const CalibratedRobot<6> robot("with hysteresis", model, limits_, {});
  save(folder_ / "model.json", robot);
  const Joints first = Joints{10, 20, -30, 40, 50, 60} * degree, second = Joints{20, 10, -20, 30, 60, 50} * degree;
  write_file(folder_ / "a.mod",
             "MODULE a\nCONST jointtarget home:=[[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9]];\nPROC main()\n"
             "MoveAbsJ [[10,20,-30,40,50,60],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;\n"
             "MoveAbsJ [[20,10,-20,30,60,50],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;\nENDPROC\nENDMODULE\n");
  for (const bool ordered : {true, false}) {
    ASSERT_EQ(correct(std::string("--program a.mod --out b.mod") + (ordered ? "" : " --no-approach")).exit_code, 0);
    const std::string out = read_file(folder_ / "b.mod");
    const std::vector<double> v = numbers_in(out.substr(out.rfind("MoveAbsJ") + 8));
    const Joints from = ordered ? robot.correct(first).command : Joints::Constant(std::nan(""));
    EXPECT_LT((Eigen::Map<const Joints>(v.data()) * degree - robot.correct(second, from).command).norm(), 5e-8);
  }
}

TEST_F(CorrectProgram, WhatIsNotCorrectedIsListed) {
  make_model(robots::abb_irb120(), 21);
  write_file(
      folder_ / "a.mod",
      "MODULE a\nCONST robtarget p1:=[[374,50,500],[0.5,0,0.866025404,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
      "PROC main()\nMoveJ Offs(p1,0,0,50),v1,fine,tool0;\nMoveL p1,v1,fine,tool0;\nMoveL p9,v1,fine,tool0;\n"
      "MoveL [[374,50,5000],[0.5,0,0.866025404,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;\n"
      "MoveL [[374,50,500],[0.5,0,0.866025404,0],[1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;\n"
      "MoveL [[374,50,500],[0.5,0,0.866025404,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,hand;\n"
      "ENDPROC\nENDMODULE\n");
  const CommandResult done = correct("--program a.mod --out b.mod");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
  EXPECT_NE(done.errors.find("a.mod: 5 of its targets or moves are not corrected, the first in line 4"),
            std::string::npos)
      << done.errors;
  for (const char* remark :
       {"line 4: not corrected: MoveJ Offs(p1,0,0,50): computed, not a literal",
        "line 6: not corrected: MoveL p9: declared in another file", "line 7: not corrected: target: ",
        "line 8: not corrected: target: no joint values within the limits have its configuration",
        "line 9: not corrected: target: the frame of its tool hand is not known; name it with --tool"})
    EXPECT_NE(done.output.find(remark), std::string::npos) << remark << "\n" << done.output;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.mod"));
  const CommandResult allowed = correct("--program a.mod --out b.mod --allow-uncorrected --tool hand=0,0,10,0,0,0");
  EXPECT_EQ(allowed.exit_code, 0) << allowed.errors;
  EXPECT_NE(read_file(folder_ / "b.mod").find("! 4 not corrected\n"), std::string::npos);
}

// What changes the meaning of a target is named with its line; a routine of another file may be stated to change
// nothing.
TEST_F(CorrectProgram, StatementsThatVoidTargetsAreNamed) {
  make_model(robots::abb_irb120(), 21);
  const std::string target =
      "[[374,50,500],[0.5,0,0.866025404,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;\n";
  write_file(folder_ / "a.mod", "MODULE a\nPROC main()\nMoveJ " + target + "ConfJ\n\\Off;\nMoveJ " + target + "MoveL " +
                                    target + "GripOpen;\nMoveL " + target + "ENDPROC\nENDMODULE\n");
  const CommandResult done = correct("--program a.mod --out b.mod");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_NE(done.output.find("a.mod: 2 targets corrected"), std::string::npos) << done.output;
  for (const char* remark :
       {"line 6: not corrected: target: line 4, ConfJ \\Off: configurations of joint moves do not count\n",
        "line 8: not corrected: GripOpen: what it does to targets is not known; if nothing, name it with "
        "--assume-harmless\n",
        "line 9: not corrected: target: line 8, GripOpen: what it does to targets is not known\n"})
    EXPECT_NE(done.output.find(remark), std::string::npos) << remark << "\n" << done.output;
  const CommandResult stated =
      correct("--program a.mod --out b.mod --assume-harmless gripopen --assume-harmless ConfJ");
  EXPECT_EQ(stated.exit_code, 0) << stated.errors;
  EXPECT_NE(stated.output.find("a.mod: 4 targets corrected"), std::string::npos) << stated.output;
}

TEST_F(CorrectProgram, KeepsEveryByteWhereNothingIsCorrected) {
  make_model(robots::abb_irb120(), 21);
  const std::string text = "MODULE a\nPROC main()\nMoveL Offs(p1,0,0,5),v100,z10,tool0;\nENDPROC\nENDMODULE\n";
  write_file(folder_ / "a.mod", text);
  const CommandResult done = correct("--program a.mod --out b.mod --allow-uncorrected");
  EXPECT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_EQ(read_file(folder_ / "b.mod"), text);
}

TEST_F(CorrectProgram, WrongUseIsRefusedInOneLine) {
  make_model(robots::abb_irb120(), 21);
  write_file(folder_ / "a.mod", "MODULE a\nENDMODULE\n");
  write_file(folder_ / "a.txt", "MODULE a\nENDMODULE\n");
  write_file(folder_ / "cut.mod", "MODULE a\nCONST robtarget p1:=[[374,50;\nENDMODULE\n");
  const auto expect = [&](const std::string& arguments, int exit_code, const std::string& words) {
    const CommandResult done = correct(arguments);
    EXPECT_EQ(done.exit_code, exit_code) << arguments;
    EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
    EXPECT_NE(done.errors.find(words), std::string::npos) << done.errors;
  };
  expect("--out b.mod", 2, "either --targets or --program is required");
  expect("--program a.mod --targets a.mod --out b.mod", 2, "either --targets or --program is required");
  expect("--program a.txt --out b.mod", 1, "a.txt: no robot program");
  expect("--program none.mod --out b.mod", 1, "none.mod");
  expect("--program cut.mod --out b.mod", 1, "cut.mod, line 2: a bracket [ is not closed");
  expect("--program a.mod --tool 1,2,3 --out b.mod", 2, "--tool 1,2,3: not six numbers");
  for (const std::string option : {"--degrees", "--linear", "--poses", "--hold q1_deg=1", "--columns q1_deg=A1"})
    expect("--program a.mod --out b.mod " + option, 2,
           option.substr(0, option.find(' ')) + " is of --targets, not of a --program");
  expect("--program a.mod --assume-harmless nosuch --out b.mod", 2,
         "--assume-harmless 'nosuch': a.mod does not name it");
  expect("--program a.mod --controller none.conf --out b.mod", 1, "none.conf");
  save(folder_ / "model.json",
       CalibratedRobot<7>("seven",
                          CalibratedRobot<7>::Model(robots::barrett_wam().chain,
                                                    CalibratedRobot<7>::Model::Arm(robots::barrett_wam().chain)),
                          robots::barrett_wam().limits, {}));
  expect("--program a.mod --out b.mod", 1, "model.json: an arm of 7 joints; programs are corrected for arms of 6");
}

}  // namespace
}  // namespace vernier::correct_program_test
