// SPDX-License-Identifier: BSD-3-Clause
// Runs export_robot on measurements of a virtual arm that is described by a URDF file.

#include <gtest/gtest.h>

#ifdef VERNIER_HAS_URDF

#include <nlohmann/json.hpp>

#include "random_chains.hpp"
#include "replaced.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "ur_published.hpp"
#include "urdf_samples.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/simulation/touches.hpp"
#include "vernier/simulation/virtual_robot.hpp"
#include "vernier/urdf.hpp"

namespace vernier::export_robot_test {
namespace {

const std::string from_urdf = "--robot arm.urdf --base-link base_link --tip-link tool0 ";

/// Eighty poses of a virtual arm, measured in a tracker's frame with a tool.
class ExportRobot : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new vernier_test::TemporaryFolder("export_robot");
    write_file(*folder_ / "arm.urdf", vernier_test::ur_like_urdf());
    write_file(*folder_ / "calibration.conf", vernier_test::ur_delta_sets()[0].conf());
    Rng rng(1);
    std::string poses = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
    for (int i = 0; i < 80; ++i)
      for (int j = 0; j < 6; ++j) poses += message(rng.uniform(-2.5, 2.5), j < 5 ? "," : "\n");
    write_file(*folder_ / "poses.csv", poses);
    measured_ = run("simulate_measurements", from_urdf +
                                                 "--poses poses.csv --noise-mm 0.01 --noise-mrad 0.02 "
                                                 "--backlash-mrad 0 --out measured.csv --seed 3");
  }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override { ASSERT_EQ(measured_.exit_code, 0) << measured_.errors; }

  static vernier_test::CommandResult run(const std::string& program, const std::string& arguments) {
    return vernier_test::run_command(
        "cd '" + folder_->path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + program + "' " + arguments,
        folder_->path());
  }
  static nlohmann::json results() { return nlohmann::json::parse(read_file(*folder_ / "out.json")); }
  static std::string path(const std::string& name) { return (*folder_ / name).string(); }

  static vernier_test::TemporaryFolder* folder_;
  static vernier_test::CommandResult measured_;
};
vernier_test::TemporaryFolder* ExportRobot::folder_ = nullptr;
vernier_test::CommandResult ExportRobot::measured_{};

// With base and tool in it, the file alone says where the tracker saw the arm.
TEST_F(ExportRobot, AUrdfWithItsFramesPredictsHeldOutPoses) {
  const auto done =
      run("export_robot", from_urdf + "--data measured.csv --urdf whole.urdf --with-base --with-tool --json out.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const auto arm = read_urdf(path("whole.urdf"), "base_link", "tool0").robot.arm<6>().arm;
  const Split<6> split = split_every(read_dataset<6>(path("measured.csv")), 5);
  const ErrorStatistics error = prediction_error(arm, split.test);
  const nlohmann::json json = results();
  EXPECT_EQ(json["train_rows"], 64);
  EXPECT_EQ(json["test_rows"], 16);
  // what the virtual arm has beside geometry is in the full model alone
  EXPECT_LT(error.mean * 1e3, 0.5 * json["as_designed"]["mean_mm"].get<double>());
  EXPECT_LT(json["full"]["mean_mm"].get<double>(), error.mean * 1e3);
  EXPECT_LT(rotation_errors(arm, split.test).mean(), 2e-3);
  EXPECT_NEAR(json["files"][0]["mean_mm"].get<double>(), error.mean * 1e3, 1e-3);
  EXPECT_NE(done.output.find("The base frame is the fitted one"), std::string::npos) << done.output;
}

TEST_F(ExportRobot, BothFilesHoldTheSameGeometryAndItsErrors) {
  const auto done =
      run("export_robot", from_urdf +
                              "--data measured.csv --urdf out.urdf --ur-kinematics out.yaml --ur-hash calib_77 "
                              "--date 2026-02-03 --json out.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const std::string urdf = read_file(path("out.urdf")), yaml = read_file(path("out.yaml"));
  const nlohmann::json json = results();
  const auto mm = [&](const char* stage) {
    return message(std::round(json[stage]["mean_mm"].get<double>() * 1e3) / 1e3);
  };
  EXPECT_NEAR(json["files"][0]["mean_mm"].get<double>(), json["files"][1]["mean_mm"].get<double>(), 1e-6);
  for (const std::string& text : {urdf, yaml}) {
    EXPECT_NE(text.find("geometry of ur_like, calibrated by Vernier"), std::string::npos);
    EXPECT_NE(text.find("2026-02-03"), std::string::npos);
    EXPECT_NE(text.find("fitted to 64 poses of measured.csv; position errors of 16 held-out poses:"),
              std::string::npos);
    EXPECT_NE(text.find("full model (" + json["chosen"].get<std::string>() + "): mean " + mm("full") + " mm"),
              std::string::npos)
        << text;
  }
  EXPECT_NE(yaml.find("  hash: calib_77\n"), std::string::npos);
  EXPECT_NE(urdf.find("<geometry><mesh filename=\"package://arm/base.dae\"/></geometry>"), std::string::npos);

  // frames are nominal: the first joint stands where it stood
  const UrdfChain chain = parse_urdf(urdf, "out.urdf", "base_link_inertia", "tool0");
  EXPECT_EQ(chain.origins[0].translation(), Vector3(0, 0, 0.1273));
  EXPECT_EQ(chain.origins[7].matrix(),
            parse_urdf(vernier_test::ur_like_urdf(), "in", "base_link_inertia", "tool0").origins[7].matrix());
  const auto arm = chain.robot.arm<6>().arm, same = read_ur_kinematics(path("out.yaml")).robot("ur").arm<6>().arm;
  Rng rng(2);
  for (int i = 0; i < 100; ++i) {
    const JointVector<6> q = vernier_test::random_joints<6>(rng);
    EXPECT_LE((arm.pose(q).matrix() - same.pose(q).matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// Touches of three planes, one with a gauge block, by the arm as made.
TEST_F(ExportRobot, ContactsCalibrateAUrdf) {
  const auto designed = read_urdf(path("arm.urdf"), "base_link", "tool0").robot.arm<6>().arm;
  const Framed<DhChain<6>> made(with_geometric_errors(designed.chain(), {}, 7), designed.base_frame(),
                                designed.tool_frame());
  JointLimits<6> limits;
  limits.lower.setConstant(-2);
  limits.upper.setConstant(2);
  VectorX heights = VectorX::Zero(30);
  heights.tail(15).setConstant(0.2);
  const VirtualObject table{ContactKind::plane, {0.5, 0.3, 0.1}, {0, 0, 1}, 0.5},
      front{ContactKind::plane, {0.7, 0.2, 0.3}, {1, 0, 0}, 0.5},
      side{ContactKind::plane, {0.2, 0.7, 0.3}, {0, 1, 0}, 0.5};
  const std::vector<Contact> contacts{touch(made, table, "table", heights, limits, 0.02e-3, 1),
                                      touch(made, front, "front", VectorX::Zero(30), limits, 0.02e-3, 2),
                                      touch(made, side, "side", VectorX::Zero(30), limits, 0.02e-3, 3)};
  std::string text = "contact_id,kind,offset_mm,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
  for (const Contact& contact : contacts)
    for (Index i = 0; i < contact.size(); ++i) {
      text += message(contact.name(), ",plane,", contact.known()(i) * 1e3);
      for (Index j = 0; j < 6; ++j) text += message(',', contact.joints()(i, j));
      text += '\n';
    }
  write_file(path("contacts.csv"), text);
  const auto done =
      run("export_robot", from_urdf + "--contacts contacts.csv --urdf touched.urdf --with-tool --json out.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const nlohmann::json json = results();
  EXPECT_EQ(json["train_rows"], 90);
  EXPECT_EQ(json["test_rows"], 0);
  EXPECT_LT(json["files"][0]["mean_mm"].get<double>(), 0.05);
  EXPECT_GT(json["as_designed"]["mean_mm"].get<double>(), 0.3);
  EXPECT_NE(
      read_file(path("touched.urdf")).find("fitted to 90 touches of contacts.csv; position errors of these touches:"),
      std::string::npos);
  const auto exported = read_urdf(path("touched.urdf"), "base_link", "tool0").robot.arm<6>().arm;
  Rng rng(4);
  PointRows points(100, 3), by_design(100, 3), actual(100, 3);
  for (Index i = 0; i < 100; ++i) {
    const JointVector<6> q = vernier_test::random_joints<6>(rng);
    set_point(points, i, exported.position(q));
    set_point(by_design, i, designed.position(q));
    set_point(actual, i, made.position(q));
  }
  const auto registered = [&](const PointRows& of) {
    const Isometry3 base = register_points(of, actual);
    double sum = 0;
    for (Index i = 0; i < 100; ++i) sum += (transformed(base, point(of, i)) - point(actual, i)).norm() / 100;
    return sum;
  };
  EXPECT_LT(registered(points), 0.3 * registered(by_design));
}

TEST_F(ExportRobot, TheFactoryCalibrationIsANominalArm) {
  const auto done = run("export_robot",
                        "--robot ur10 --ur-calibration calibration.conf --data measured.csv --ur-kinematics "
                        "factory.yaml --json out.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const nlohmann::json json = results();
  EXPECT_LT(json["files"][0]["mean_mm"].get<double>(), 0.5 * json["as_designed"]["mean_mm"].get<double>());
  EXPECT_EQ(read_ur_kinematics(path("factory.yaml")).hash, "calib_unknown");
  const auto again = run("simulate_measurements", "--robot factory.yaml --poses poses.csv --out again.csv");
  EXPECT_EQ(again.exit_code, 0) << again.errors;
}

// An arm that no URDF file describes: as its controller counts its joints, and hung from the ceiling.
TEST_F(ExportRobot, OtherRobotsAsAPlainFile) {
  for (const char* kind : {"fanuc", "ceiling", "scara", "positioner"}) {
    const std::string robot = std::string("--robot ") + VERNIER_ROBOT_FILES + "/" + kind + ".json ";
    for (const char* step : {"plan_poses:--count 40 --candidates 300 --orientations --out plan.csv",
                             "simulate_measurements:--poses plan.csv --seed 2 --out seen.csv"}) {
      const std::string text = step;
      const auto done = run(text.substr(0, text.find(':')), robot + text.substr(text.find(':') + 1));
      ASSERT_EQ(done.exit_code, 0) << kind << done.errors;
    }
    const auto done = run("export_robot", robot + "--data seen.csv --urdf plain.urdf --json out.json");
    ASSERT_EQ(done.exit_code, 0) << kind << done.errors;
    const nlohmann::json json = results();
    EXPECT_LT(json["files"][0]["mean_mm"].get<double>(), 0.5 * json["as_designed"]["mean_mm"].get<double>()) << kind;
    EXPECT_EQ(done.output.find("The joints of the URDF file are those of the chain") != std::string::npos,
              kind == std::string("fanuc"));
    EXPECT_EQ(done.output.find("Gravity acts along (0, 0, 1) of base_link") != std::string::npos,
              kind == std::string("ceiling"))
        << done.output;
    // a robot like any other
    const auto described = run("describe_robot", "--robot plain.urdf --out .");
    EXPECT_EQ(described.exit_code, 0) << described.errors;
  }
}

TEST_F(ExportRobot, MisuseIsOneLine) {
  const auto expect = [&](const std::string& program, const std::string& arguments, int code, const std::string& what) {
    const auto done = run(program, arguments);
    EXPECT_EQ(done.exit_code, code) << arguments << done.errors;
    EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
    EXPECT_NE(done.errors.find(what), std::string::npos) << done.errors;
  };
  const std::string data = "--data measured.csv ", both = from_urdf + data;
  write_file(path("few.csv"), "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,x_mm,y_mm,z_mm\n0,0,0,0,0,0,1,2,3\n");
  write_file(path("half.urdf"), vernier_test::ur_like_urdf().substr(0, 1000));
  expect("export_robot", both, 2, "one of --urdf and --ur-kinematics is required");
  expect("export_robot", from_urdf + "--urdf o.urdf", 2, "--data is required (or --contacts)");
  expect("export_robot", from_urdf + "--contacts c.csv --with-base --urdf o.urdf", 2, "contacts do not show where");
  write_file(path("endless.json"), R"({"name": "endless", "convention": "standard",
    "joints": [{"type": "prismatic", "a_mm": 0, "alpha_deg": 90, "d_mm": 0, "theta_deg": 0},
               {"a_mm": 500, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0}]})");
  expect("export_robot", "--robot endless.json --urdf o.urdf " + data, 2, "joint 1 slides and has no limits");
  expect("export_robot", "--robot ur10 --base-link base --ur-kinematics o.yaml " + data, 2, "are of a URDF file");
  expect("export_robot", both + "--ur-calibration calibration.conf --urdf o.urdf", 2, "--ur-calibration is for arms");
  expect("export_robot", "--robot arm.urdf --urdf o.urdf " + data, 1,
         "which link is the tip? There are 'base', 'tool0'");
  expect("export_robot", "--robot half.urdf --urdf o.urdf " + data, 1, "half.urdf, line ");
  expect("export_robot", both + "--ur-kinematics o.yaml --with-tool", 2, "it has no tool");
  expect("export_robot", both + "--ur-kinematics o.yaml --ur-hash 'a: b'", 2, "--ur-hash takes up to 64 letters");
  expect("export_robot", both + "--urdf no/such/folder.urdf", 1, "cannot be written");
  expect("export_robot", from_urdf + "--data few.csv --urdf o.urdf", 1, "few.csv: a single row");
  expect("export_robot",
         "--robot arm.urdf --base-link base_link --tip-link wrist_3_link --with-tool --urdf o.urdf " + data, 2,
         "link 'wrist_3_link' is behind no fixed joint");
  expect("calibrate", "--robot other.urdf " + data, 1, "other.urdf");
  EXPECT_FALSE(std::filesystem::exists(path("o.urdf")));
  EXPECT_FALSE(std::filesystem::exists(path("o.yaml")));
}

}  // namespace
}  // namespace vernier::export_robot_test

#endif
