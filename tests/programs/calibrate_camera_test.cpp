// SPDX-License-Identifier: BSD-3-Clause
// calibrate --corners: simulated images of an arm, poses of its flange, and what is refused.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "run_command.hpp"
#include "simulated_views.hpp"
#include "temporary_folder.hpp"
#include "vernier/io/camera_files.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"

namespace vernier::calibrate_camera_test {
namespace {

using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

class CalibrateCamera : public ::testing::Test {
 protected:
  void SetUp() override {
    setup_.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
    setup_.images = 30;
    actual_ = with_geometric_errors(robots::abb_irb120().chain, {}, 3);
    write_images(actual_);
  }
  /// Images that an arm takes, its joints and the poses of its flange, as files.
  template <class Actual>
  void write_images(const Actual& actual) {
    const auto simulated = vernier_test::simulated_views(actual, robots::abb_irb120().limits, setup_, 4);
    write_file(folder_ / "board.json", board_to_json(setup_.board).dump());
    write_file(folder_ / "camera.json", camera_to_json(setup_.camera).dump());
    std::string corners = "image,board,corner,u_px,v_px,width_px,height_px\n";
    for (const View& view : simulated.views.views)
      for (std::size_t i = 0; i < view.corners.size(); ++i)
        corners += message(view.image, ',', simulated.views.boards[static_cast<std::size_t>(view.board)], ',',
                           view.corners[i], ',', view.pixels[i](0), ',', view.pixels[i](1), ",1600,1200\n");
    write_file(folder_ / "corners.csv", corners);
    std::string joints = "image,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\nnowhere.png,0,0,0,0,0,0\n";
    std::string poses = "image,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n";
    for (Index i = 0; i < simulated.rows.size(); ++i) {
      const std::string& image = simulated.rows.images[static_cast<std::size_t>(i)];
      const JointVector<6> q = simulated.rows.joints.row(i).transpose();
      joints += image;
      for (const double value : q) joints += message(',', value);
      joints += '\n';
      const Isometry3 pose = actual.pose(q);
      const Vector3 turn = log_so3(rotation(pose));
      poses += image;
      for (Index k = 0; k < 3; ++k) poses += message(',', pose(k, 3) * 1e3);
      for (Index k = 0; k < 3; ++k) poses += message(',', turn(k));
      poses += '\n';
    }
    write_file(folder_ / "joints.csv", joints);
    write_file(folder_ / "poses.csv", poses);
    tool_ = simulated.tool;
  }
  CommandResult calibrate(const std::string& arguments) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR +
                                         "/calibrate' --date 2024-05-01 --out figures " + arguments,
                                     folder_.path());
  }
  nlohmann::json results() { return nlohmann::json::parse(read_file((folder_ / "r.json").string())); }

  TemporaryFolder folder_{"calibrate_camera"};
  vernier_test::ViewSetup setup_{};
  DhChain<6> actual_ = robots::abb_irb120().chain;
  Isometry3 tool_;
};

TEST_F(CalibrateCamera, IdentifiesAnArmAndKeepsCameraAndBoard) {
  const CommandResult result = calibrate(
      "--robot abb_irb120 --data joints.csv --corners corners.csv --board board.json --camera-mount flange --save "
      "m.json "
      "--json r.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("Rows without an image, not used: nowhere.png"), std::string::npos);
  const CalibratedRobot<6> robot = load<6>((folder_ / "m.json").string());
  const double error =
      vernier_test::error_after_registration(robot.identified().chain(), actual_, robots::abb_irb120().limits, 7);
  EXPECT_LT(error, 0.15e-3);
  const auto& kept = robot.provenance().camera;
  ASSERT_TRUE(kept.has_value());
  EXPECT_NEAR(kept->cameras.at(0).fx, setup_.camera.fx, 2);
  EXPECT_EQ(kept->board.rows, 7);
  EXPECT_EQ(kept->in_base.size(), 2u);
  const nlohmann::json found = results();
  EXPECT_EQ(found.at("images").size(), 30u);
  EXPECT_LT(found.at("left_out_mean_mm").get<double>(), 0.5);
  ASSERT_EQ(found.at("joints").size(), 6u);
  for (const nlohmann::json& joint : found.at("joints")) {
    EXPECT_GT(joint.at("share").get<double>(), 0.1);
    EXPECT_LT(joint.at("share").get<double>(), 1);
    EXPECT_LT(joint.at("from_deg").get<double>(), joint.at("to_deg").get<double>());
  }
  ASSERT_EQ(kept->covariances.size(), 1u);
  const MatrixX& covariance = kept->covariances[0];
  const nlohmann::json std = found.at("cameras").at(0).at("std");
  for (Index k = 0; k < Camera::num_parameters; ++k)
    EXPECT_NEAR(std::sqrt(covariance(k, k)), std.at(Camera::names[static_cast<std::size_t>(k)]).get<double>(), 1e-9);
  EXPECT_LT(std::abs(covariance(0, 2)), std::sqrt(covariance(0, 0) * covariance(2, 2)));
  if (std::system("command -v gnuplot > /dev/null") == 0) {
    EXPECT_NE(read_file((folder_ / "figures/residuals.svg").string()).find("where the model has it"),
              std::string::npos);
  }
}

TEST_F(CalibrateCamera, FindsJointErrorsInTheSameRun) {
  setup_.images = 80;
  const JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0.5e-3, .harmonics = 2};
  const WithJointErrors<DhChain<6>> geared(actual_, draw_joint_errors(actual_, sizes, 5));
  write_images(geared);
  const CommandResult result = calibrate(
      "--robot abb_irb120 --data joints.csv --corners corners.csv --board board.json --camera-mount flange "
      "--intrinsics "
      "camera.json --joint-errors --harmonics 3 --test-every 5 --threads 1 --save m.json --report r.html --json "
      "r.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("Beside joint errors, steps of the intrinsics were"), std::string::npos);
  EXPECT_NE(result.output.find("they rest"), std::string::npos) << result.output;
  const nlohmann::json found = results();
  EXPECT_EQ(found.at("camera").at("converged"), true);
  EXPECT_EQ(found.at("chosen"), "jointwise");
  EXPECT_GE(found.at("train_rows"), 62);  // an outlier may be left out
  EXPECT_EQ(found.at("test_rows"), 16);
  const CalibratedRobot<6> robot = load<6>((folder_ / "m.json").string());
  EXPECT_EQ(robot.provenance().measured, "images");
  ASSERT_TRUE(robot.provenance().camera.has_value());
  ASSERT_NE(robot.estimate(), nullptr);
  EXPECT_LT(robot.provenance().held_out_error, 0.3e-3);
  const auto stage = [&](const char* name) { return found.at("stages").at(name).at("mean_mm").get<double>(); };
  EXPECT_LT(stage("jointwise"), 0.8 * stage("geometry")) << found.at("stages");
  EXPECT_NE(read_file((folder_ / "r.html").string()).find("16 held-out poses"), std::string::npos);
}

TEST_F(CalibrateCamera, FindsBaseAndToolFromPosesOfTheFlange) {
  const CommandResult result = calibrate(
      "--flange-poses poses.csv --corners corners.csv --board board.json --camera-mount flange --intrinsics "
      "camera.json "
      "--json r.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const nlohmann::json tool = results().at("flange_T_camera").at(0).at("position_mm");
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(tool.at(k).get<double>(), tool_(static_cast<Index>(k), 3) * 1e3, 0.3);
}

// A fixed camera at two places, planned and simulated; the flange carries the board.
TEST_F(CalibrateCamera, TakesPlannedImagesOfAVirtualArm) {
  const auto program = [&](const std::string& line) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + line,
                                     folder_.path());
  };
  const std::string camera =
      " --robot abb_irb120 --board board.json --intrinsics camera.json --camera-mount fixed --carried 0,0,60,0,0,0";
  const CommandResult planned =
      program("plan_poses' --count 40 --candidates 20000 --json plan.json --out views.csv" + camera);
  ASSERT_EQ(planned.exit_code, 0) << planned.errors;
  EXPECT_EQ(planned.output.find("tracker"), std::string::npos) << planned.output;
  const std::string simulate = "simulate_measurements' --places plan.json --seed 3" + camera;
  const CommandResult taken =
      program(simulate + " --poses views.csv --gears-urad 0 --noise-px 0.1 --corners c.csv --out j.csv");
  ASSERT_EQ(taken.exit_code, 0) << taken.errors;
  EXPECT_NE(read_file((folder_ / "c.csv").string()).find("image,camera,corner,u_px,v_px,width_px,height_px\n"),
            std::string::npos);
  const CommandResult found = calibrate(
      "--robot abb_irb120 --data j.csv --corners c.csv --board board.json --camera-mount fixed --json r.json");
  ASSERT_EQ(found.exit_code, 0) << found.errors;
  EXPECT_TRUE(found.output.starts_with("Verdict\n- Distance on the board: ")) << found.output;
  EXPECT_EQ(results().at("cameras").size(), 2u);
  for (const nlohmann::json& one : results().at("cameras"))
    EXPECT_NEAR(one.at("intrinsics").at("fx").get<double>(), setup_.camera.fx,
                6 * one.at("std").at("fx").get<double>());

  const auto refused = [&](const std::string& arguments, const std::string& reason) {
    const CommandResult result = program(simulate + arguments);
    EXPECT_NE(result.exit_code, 0) << arguments;
    EXPECT_TRUE(result.one_line_of_errors()) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
  };
  refused(" --poses joints.csv --corners c.csv --out j.csv", "joints.csv: has no column board");
  refused(" --poses views.csv --out j.csv", "--corners");
  refused(" --poses views.csv --corners c.csv --out j.csv --points 3", "--points");
  write_file(folder_ / "plan.json", R"({"places": [{"name": "shelf", "position_mm": [0, 0, 0],
                                        "rotation_vector_rad": [0, 0, 0]}]})");
  refused(" --poses views.csv --corners c.csv --out j.csv", "views.csv: the place 'place");
  write_file(folder_ / "plan.json", R"({"places": [{"name": "shelf", "position_mm": [0, 0]}]})");
  refused(" --poses views.csv --corners c.csv --out j.csv", "plan.json: places[0].position_mm: not three numbers");
  write_file(folder_ / "plan.json", "{}");
  refused(" --poses views.csv --corners c.csv --out j.csv", "plan.json: has no list of places");
}

TEST_F(CalibrateCamera, RefusesWhatDoesNotBelongTogether) {
  const auto refused = [&](const std::string& arguments, int code, const std::string& reason) {
    const CommandResult result = calibrate(arguments);
    EXPECT_EQ(result.exit_code, code) << arguments;
    EXPECT_TRUE(result.one_line_of_errors()) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
  };
  refused("--robot abb_irb120 --data joints.csv --corners corners.csv --board board.json", 2, "--camera-mount");
  refused("--corners corners.csv --board board.json --camera-mount flange", 2, "--data");
  refused(
      "--robot abb_irb120 --data joints.csv --corners corners.csv --board board.json --camera-mount flange "
      "--test-every 3",
      2, "--test-every needs --joint-errors beside --corners");
  refused("--robot abb_irb120 --data joints.csv --corners corners.csv --board board.json --camera-mount fixed", 1,
          "do not agree with the poses of the arm");
  write_file(folder_ / "small.json", R"({"fx": 500, "fy": 500, "cx": 320, "cy": 240, "width": 640, "height": 480})");
  refused(
      "--robot abb_irb120 --data joints.csv --corners corners.csv --board board.json --camera-mount flange "
      "--intrinsics small.json",
      1, "the intrinsics are of 640 x 480");
}

}  // namespace
}  // namespace vernier::calibrate_camera_test
