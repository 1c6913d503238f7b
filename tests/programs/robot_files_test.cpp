// SPDX-License-Identifier: BSD-3-Clause
// Each kind of arm of examples/robots on the whole way, its joints as its controller counts them.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "program_runs.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/robot_file.hpp"

namespace vernier::robot_files_test {
namespace {

class RobotFiles : public ::testing::TestWithParam<const char*>, protected vernier_test::ProgramRuns {
 protected:
  RobotFiles() : ProgramRuns("robot_files") {}
  std::string file(const std::string& name) const { return std::string(VERNIER_ROBOT_FILES) + "/" + name + ".json"; }
  nlohmann::json results(const std::string& name) const { return nlohmann::json::parse(read_file(folder_ / name)); }
  /// Simulated measurements of planned poses.
  void measure(const std::string& robot, int poses, int seed, const std::string& out) const {
    done(message("plan_poses' --robot ", robot, " --count ", poses, " --candidates 500 --orientations --seed ", seed,
                 " --out plan_", out));
    done(message("simulate_measurements' --robot ", robot, " --poses plan_", out, " --seed 2 --out ", out));
  }
};

TEST_P(RobotFiles, PlanSimulateCalibrateVerifyCorrectExport) {
  const std::string robot = file(GetParam());
  const RobotDescription arm = load_robot(robot);
  const std::string described = done("describe_robot' --robot " + robot + " --json arm.json --out .");
  EXPECT_NE(described.find("Compare with the pendant"), std::string::npos);
  EXPECT_EQ(results("arm.json")["moves"].size(), static_cast<std::size_t>(arm.controller_joints()));

  measure(robot, 60, 1, "measured.csv");
  const CsvText columns = read_csv_text((folder_ / "measured.csv").string());
  EXPECT_EQ(columns.header[static_cast<std::size_t>(arm.controller_joints())], "x_mm");
  done("calibrate' --robot " + robot + " --data measured.csv --test-every 5 --save model.json --json results.json");
  const nlohmann::json found = results("results.json");
  const double designed = found["stages"]["frames"]["mean_mm"],
               chosen = found["stages"][found["chosen"].get<std::string>()]["mean_mm"];
  EXPECT_LT(chosen, 0.25 * designed);
  EXPECT_TRUE(read_model((folder_ / "model.json").string()).dof() == arm.dof());

  measure(robot, 15, 7, "fresh.csv");
  const auto checked = run("verify_calibration' --model model.json --data fresh.csv");
  EXPECT_NE(checked.output.find(" poses of fresh.csv"), std::string::npos) << checked.output << checked.errors;

  // the command brings the arm where the nominal one would be: its measured pose there says so
  const auto corrected = run("correct' --model model.json --targets plan_fresh.csv --out commands.csv");
  EXPECT_NE(corrected.output.find(" targets corrected"), std::string::npos) << corrected.errors;
  const CsvText commands = read_csv_text((folder_ / "commands.csv").string());
  EXPECT_EQ(commands.header[static_cast<std::size_t>(arm.controller_joints())], "status");
  const bool closed = arm.controller_joints() >= 6 && GetParam() != std::string("seven_axis");
  const auto singularity =
      std::find(commands.header.begin(), commands.header.end(), "singularity") - commands.header.begin();
  EXPECT_EQ(commands.rows.front()[static_cast<std::size_t>(singularity)].empty(), !closed);
  const std::string source = done("export_c' --model model.json --out arm.h");
  EXPECT_NE(read_file(folder_ / "arm.h").find(message("#define ARM_JOINTS ", arm.controller_joints(), "\n")),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Kinds, RobotFiles,
                         ::testing::Values("six_axis", "fanuc", "kuka", "palletiser", "scara", "rail", "positioner",
                                           "ceiling", "seven_axis", "parallelogram"),
                         [](const auto& kind) { return std::string(kind.param); });

class ControllerRuns : public RobotFiles {
 protected:
  /// The file of a robot without its controller, and measurements with the joints of the chain.
  template <int N>
  void in_chain_joints(const std::string& robot, const std::string& measured) const {
    nlohmann::json json = nlohmann::json::parse(read_file(robot));
    json.erase("controller");
    write_file(folder_ / "chain.json", json.dump());
    const RobotDescription arm = load_robot(robot);
    const auto data = read_dataset<N>((folder_ / measured).string(), {}, {.controller = arm.controller});
    write_dataset((folder_ / "chain.csv").string(), data);
  }

  /// A calibration in joints of the controller finds the arm that one in joints of the chain finds from the same poses.
  /// @param ranges how the report calls the first joint of the chain
  template <int N>
  void expect_the_same_arm(const std::string& robot, const std::string& ranges) const {
    measure(robot, 60, 1, "measured.csv");
    in_chain_joints<N>(robot, "measured.csv");
    const std::string said =
        done("calibrate' --robot " + robot + " --data measured.csv --test-every 5 --save counted.json --verbose");
    // what a passive joint hides is held there; a chain of independent joints does not know that
    std::string held;
    const std::string before = "do not move by themselves: ";
    if (const auto at = said.find(before); at != std::string::npos) {
      held = said.substr(at + before.size(), said.find('\n', at) - at - before.size());
      std::erase(held, ',');
      held = " --fix " + held;
    }
    done("calibrate' --robot chain.json --data chain.csv --test-every 5 --save chain_model.json" + held);
    const auto counted = load<N>((folder_ / "counted.json").string()),
               chain = load<N>((folder_ / "chain_model.json").string());
    EXPECT_NE(said.find("Measured joint ranges [deg, mm]: " + ranges), std::string::npos) << said;
    EXPECT_TRUE(chain.controller().same());
    EXPECT_FALSE(counted.controller().same());
    const auto poses = read_dataset<N>((folder_ / "chain.csv").string());
    for (Index i = 0; i < poses.size(); ++i)
      EXPECT_LT((counted.model().pose(poses.joints(i)).matrix() - chain.model().pose(poses.joints(i)).matrix()).norm(),
                1e-9);
  }
};

TEST_F(ControllerRuns, TheArmIsThatOfACalibrationInChainJoints) {
  expect_the_same_arm<6>(file("fanuc"), "q1 ");
  expect_the_same_arm<6>(file("kuka"), "-J1: ");
  expect_the_same_arm<5>(file("palletiser"), "q1 ");
}

// Gears that err with the angles of motors are found where the robot file says so, and else leave errors behind.
TEST_F(ControllerRuns, GearsErrAtMotorsWhereTheFileSaysSo) {
  const std::string robot = file("parallelogram");
  nlohmann::json json = nlohmann::json::parse(read_file(robot));
  json["controller"].erase("errors");
  write_file(folder_ / "chain.json", json.dump());
  done("plan_poses' --robot " + robot + " --count 150 --candidates 500 --orientations --seed 1 --out plan.csv");
  done("simulate_measurements' --robot " + robot + " --poses plan.csv --seed 2 --gears-urad 400 --out measured.csv");
  const auto error = [&](const std::string& arm, const std::string& more) {
    done("calibrate' --robot " + arm + " --data measured.csv --test-every 3 --json results.json" + more);
    const nlohmann::json found = results("results.json");
    return found["stages"][found["chosen"].get<std::string>()]["mean_mm"].get<double>();
  };
  EXPECT_LT(error(robot, " --save model.json"), 0.6 * error("chain.json", " --save other.json"));
  // what an earlier calibration knows of motors says nothing of joints
  const auto refused =
      run("calibrate' --robot chain.json --data measured.csv --test-every 3 --prior model.json --save x.json");
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_NE(refused.errors.find("err at motors, those of this robot at joints of the chain"), std::string::npos)
      << refused.errors;
}

// A file of four joints for a chain of five: the passive joint that makes it plausible is named as a key to be pasted.
TEST_F(ControllerRuns, TheMapOfAPassiveJointIsNamed) {
  const std::string robot = file("palletiser");
  measure(robot, 40, 1, "measured.csv");
  nlohmann::json json = nlohmann::json::parse(read_file(robot));
  const nlohmann::json controller = json["controller"];
  json.erase("controller");
  write_file(folder_ / "chain.json", json.dump());
  const auto refused = run("calibrate' --robot chain.json --data measured.csv --test-every 5");
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_NE(refused.errors.find("q5_"), std::string::npos) << refused.errors;
  const std::string key = R"("controller": {"chain": ["J1", "J2", "-J2 + J3", "-J3", "J4"]})";
  EXPECT_NE(refused.errors.find(key), std::string::npos) << refused.errors;
  json.update(nlohmann::json::parse("{" + key + "}"));
  json["controller"]["limits"] = controller["limits"];
  write_file(folder_ / "pasted.json", json.dump());
  done("calibrate' --robot pasted.json --data measured.csv --test-every 5");
}

// Planned, simulated, calibrated, verified and corrected under payloads.
TEST_F(ControllerRuns, PayloadsGoTheWholeWay) {
  const std::string robot = file("six_axis");
  done("plan_poses' --robot " + robot + " --count 60 --candidates 300 --orientations --seed 1 --out plan.csv");
  const CsvText plan = read_csv_text((folder_ / "plan.csv").string());
  std::string text = "payload_kg";
  for (int j = 0; j < 6; ++j) text += "," + plan.header[static_cast<std::size_t>(j)];
  for (std::size_t i = 0; i < plan.rows.size(); ++i) {
    text += i % 2 == 0 ? "\n0" : "\n6";
    for (int j = 0; j < 6; ++j) text += "," + plan.rows[i][static_cast<std::size_t>(j)];
  }
  write_file(folder_ / "loaded.csv", text + "\n");
  const std::string simulate = "simulate_measurements' --robot " + robot + " --seed 2 --poses ";
  done(simulate + "loaded.csv --out measured.csv");
  done(simulate + "plan.csv --out fresh.csv --payload-kg 3");
  const auto both = run(simulate + "loaded.csv --out x.csv --payload-kg 3");
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_NE(both.errors.find("loaded.csv states payload_kg"), std::string::npos) << both.errors;
  done("calibrate' --robot " + robot + " --data measured.csv --test-every 5 --save model.json");
  EXPECT_NE(done("verify_calibration' --model model.json --data fresh.csv").find("still valid"), std::string::npos);
  run("correct' --model model.json --targets plan.csv --out at0.csv --payload-kg 0");  // near limits some are not met
  run("correct' --model model.json --targets plan.csv --out at6.csv --payload-kg 6");
  EXPECT_NE(read_file(folder_ / "at0.csv"), read_file(folder_ / "at6.csv"));
}

TEST_F(ControllerRuns, FormulasOfTheCommandLineAreThoseOfTheFile) {
  nlohmann::json json = nlohmann::json::parse(read_file(file("kuka")));
  json.erase("controller");
  write_file(folder_ / "chain.json", json.dump());
  done("describe_robot' --robot " + file("kuka") + " --json a.json --out .");
  done("describe_robot' --robot chain.json --controller-joints=-J1,J2,J3,-J4,J5,-J6 --json b.json --out .");
  EXPECT_EQ(results("a.json")["moves"], results("b.json")["moves"]);
  const auto twice = run("describe_robot' --robot " + file("kuka") + " --controller-joints=J1,J2,J3,J4,J5,J6 --out .");
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_NE(twice.errors.find("states the joints of its controller itself"), std::string::npos) << twice.errors;
}

TEST_F(ControllerRuns, ARailIsHeldOrStandsWhereTargetsHaveIt) {
  const std::string robot = file("rail");
  measure(robot, 60, 1, "measured.csv");
  done("calibrate' --robot " + robot + " --data measured.csv --test-every 5 --save model.json");
  run("correct' --model model.json --targets plan_measured.csv --out moved.csv");  // near limits some are not met
  const CsvText targets = read_csv_text((folder_ / "plan_measured.csv").string()),
                moved = read_csv_text((folder_ / "moved.csv").string());
  for (std::size_t i = 0; i < targets.rows.size(); ++i) EXPECT_EQ(moved.rows[i][0], targets.rows[i][0]);

  // a pose, with the rail held: all branches of the six joints, and a path
  write_file(folder_ / "pose.csv",
             "q1_m,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,q7_deg\n1.2,20,-40,50,30,60,40\n1.2,-70,30,-60,-50,-50,100\n");
  done("correct' --model model.json --targets pose.csv --hold q1_m=1.2 --all-branches --out branches.csv");
  const CsvText branches = read_csv_text((folder_ / "branches.csv").string());
  EXPECT_GE(branches.rows.size(), 8u);
  for (const auto& row : branches.rows) EXPECT_EQ(row[0], "1.2");
  done("correct' --model model.json --targets pose.csv --hold q1_mm=1200 --out path.csv");
  for (const auto& row : read_csv_text((folder_ / "path.csv").string()).rows) {
    EXPECT_EQ(row[0], "1.2");
    EXPECT_EQ(row[7], "converged");
  }
  for (const auto& [hold, said] : {std::pair{"q1_deg=3", "the unit of joint 1 is m, mm or um"},
                                   {"q9_m=3", "the controller has 7 joints"},
                                   {"q1_m", "not like q1_m=1.2"},
                                   {"q1_m=7", "beyond the limits"}}) {
    const auto refused = run(message("correct' --model model.json --targets pose.csv --out x.csv --hold ", hold));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.errors.find(said), std::string::npos) << refused.errors;
  }
}

TEST_F(ControllerRuns, AKnownFrameStays) {
  nlohmann::json json = nlohmann::json::parse(read_file(file("six_axis")));
  measure(file("six_axis"), 60, 1, "measured.csv");
  done("calibrate' --robot " + file("six_axis") + " --data measured.csv --test-every 5 --save model.json");
  const auto free = load<6>((folder_ / "model.json").string());
  const Vector6 base = free.identified().base_frame().values();
  const char* const keys[] = {"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"};
  const Vector3 turn = log_so3(Matrix3(free.identified().base().linear()));
  for (int k = 0; k < 6; ++k) json["base"][keys[k]] = k < 3 ? base(k) : turn(k - 3);
  json["base"]["known"] = true;
  write_file(folder_ / "known.json", json.dump());
  done("calibrate' --robot known.json --data measured.csv --test-every 5 --save known_model.json");
  const auto known = load<6>((folder_ / "known_model.json").string());
  EXPECT_LT((known.identified().base().matrix() - free.identified().base().matrix()).norm(), 1e-12);
  const auto stations =
      run("calibrate' --robot known.json --data measured.csv measured.csv --test-every 5 --save x.json");
  EXPECT_EQ(stations.exit_code, 2) << stations.output;
}

}  // namespace
}  // namespace vernier::robot_files_test
