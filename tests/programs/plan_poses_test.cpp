// SPDX-License-Identifier: BSD-3-Clause
// Plans poses for an arm, measures them virtually, and chooses rows of measured files.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

#include "projection.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/io/camera_files.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::plan_poses_test {
namespace {

using vernier_test::CommandResult;

class PlanPoses : public ::testing::Test {
 protected:
  CommandResult run(const std::string& program, const std::string& arguments) {
    return vernier_test::run_command(
        "cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + program + "' " + arguments,
        folder_.path());
  }
  CommandResult plan(const std::string& arguments) { return run("plan_poses", "--robot abb_irb120 " + arguments); }
  nlohmann::json json(const std::string& name) { return nlohmann::json::parse(read_file(folder_ / name)); }

  /// A file of measured poses of some joints.
  void measure(Index n, const std::string& name) {
    const Robot<6> robot = robots::abb_irb120();
    write_dataset(folder_ / "joints.csv",
                  Dataset<6>(abb_irb120_operating_region().sample(robot.chain, n, 4), PointRows::Zero(n, 3)));
    const CommandResult done =
        run("simulate_measurements", "--robot abb_irb120 --poses joints.csv --seed 7 --out " + name);
    ASSERT_EQ(done.exit_code, 0) << done.errors;
  }

  vernier_test::TemporaryFolder folder_{"plan_poses"};
};

// Every pose sees the whole board at its place, by a projection of its own.
TEST_F(PlanPoses, ForACameraTheBoardIsInView) {
  const Board board{.rows = 7, .columns = 9, .square = 0.03};
  const Camera camera = vernier_test::machine_camera();
  write_file(folder_ / "board.json", board_to_json(board).dump());
  write_file(folder_ / "camera.json", camera_to_json(camera).dump());
  const CommandResult done = plan(
      "--count 25 --candidates 20000 --camera-mount flange --board board.json --intrinsics camera.json --carried "
      "50,30,60,10,-5,20 --table-mm 100 --distances-mm 250,700 --tilt-deg 45 --seed 3 --json p.json --out poses.csv");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("place2: "), std::string::npos) << done.output;
  const auto joints = read_joints<6>(folder_ / "poses.csv");
  const CsvText text = read_csv_text(folder_ / "poses.csv");
  const nlohmann::json places = json("p.json").at("places");
  ASSERT_EQ(places.size(), 2u);
  const double degree = std::numbers::pi / 180;
  const Isometry3 carried =
      rigid_motion(exp_so3(Vector3(10 * degree, -5 * degree, 20 * degree)), Vector3(0.05, 0.03, 0.06));
  std::set<std::string> used;
  for (Index i = 0; i < joints.rows(); ++i) {
    const std::string& name = text.rows[static_cast<std::size_t>(i)][6];
    used.insert(name);
    const nlohmann::json& place = places.at(name == "place1" ? 0 : 1);
    Vector3 at, turn;
    for (Index k = 0; k < 3; ++k) {
      at(k) = place.at("position_mm").at(static_cast<std::size_t>(k)).get<double>() * 1e-3;
      turn(k) = place.at("rotation_vector_rad").at(static_cast<std::size_t>(k)).get<double>();
    }
    EXPECT_NEAR(at.z(), 0.1, 1e-9);
    const Isometry3 flange = robots::abb_irb120().chain.pose(joints.row(i).transpose());
    const Isometry3 seen = (flange * carried).inverse() * rigid_motion(exp_so3(turn), at);
    const double distance = (seen * board.middle()).norm();
    EXPECT_GE(distance, 0.25);
    EXPECT_LE(distance, 0.7);
    EXPECT_GE(seen(2, 2), std::cos(45 * degree));
    for (Index k = 0; k < board.corners(); ++k) {
      const Vector2 pixel = vernier_test::seen_at(camera, seen * board.corner(k));
      EXPECT_TRUE(pixel(0) > 0 && pixel(0) < 1599 && pixel(1) > 0 && pixel(1) < 1199) << pixel.transpose();
    }
  }
  EXPECT_EQ(used.size(), 2u);
  EXPECT_EQ(plan("--count 5 --camera-mount flange --out poses.csv").exit_code, 2);
  const CommandResult few = plan(
      "--count 500 --candidates 600 --camera-mount flange --board board.json --intrinsics camera.json --carried "
      "50,30,60,10,-5,20 --out no.csv");
  EXPECT_EQ(few.exit_code, 2);
  EXPECT_NE(few.errors.find("candidates see the board, 500 are wanted"), std::string::npos) << few.errors;
}

TEST_F(PlanPoses, NewPosesWithinTheirConstraints) {
  const std::string arguments =
      "--count 25 --candidates 300 --box 100,600,-400,400,100,900 --tracker 2500,0,500 --acceptance-deg 80 "
      "--link-radius-mm 50 --orientations --seed 3 --json p.json --out ";
  const CommandResult done = plan(arguments + "poses.csv");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("abb_irb120: 25 poses of 300 candidates"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("tool out of its box"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("the first three register the tracker"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("These poses measure 150 values, fewer than the unknowns"), std::string::npos)
      << done.output;
  EXPECT_NE(done.output.find("Not covered by these poses: q1 in "), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("--cover 1 plans a pose"), std::string::npos) << done.output;
  const auto joints = read_joints<6>(folder_ / "poses.csv");
  const auto result = json("p.json");
  EXPECT_EQ(result.at("poses"), 25);
  ASSERT_EQ(joints.rows(), 27);  // the first again after 20, and at the end
  EXPECT_EQ(joints.row(0), joints.row(20));
  EXPECT_EQ(joints.row(0), joints.row(26));
  const Robot<6> robot = robots::abb_irb120();
  for (Index i = 0; i < joints.rows(); ++i) {
    const Isometry3 pose = robot.chain.pose(joints.row(i).transpose());
    EXPECT_TRUE(robot.limits.contains(joints.row(i).transpose()));
    EXPECT_GE(pose.translation().x(), 0.1);
    EXPECT_LE(std::abs(pose.translation().y()), 0.4);
    EXPECT_GE((Vector3(2.5, 0, 0.5) - pose.translation()).normalized().dot(pose.linear().col(2)),
              std::cos(80 * std::numbers::pi / 180) - 1e-12);
  }
  EXPECT_EQ(result.at("information_nats").size(), 26u);
  EXPECT_GT(result.at("rejected").at("tool out of its box"), 0);
  EXPECT_GT(result.at("unknowns"), 800);
  EXPECT_TRUE(result.at("bound_nats").is_null());
  ASSERT_EQ(plan(arguments + "again.csv").exit_code, 0);
  EXPECT_EQ(read_file(folder_ / "poses.csv"), read_file(folder_ / "again.csv"));
}

TEST_F(PlanPoses, AddsToWhatWasMeasured) {
  measure(20, "have.csv");
  const CommandResult done = plan("--data have.csv --add 10 --candidates 200 --out more.csv --json p.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_EQ(json("p.json").at("measured"), 20);
  EXPECT_EQ(json("p.json").at("poses"), 10);
  ASSERT_EQ(plan("--count 10 --orientations --candidates 200 --out first.csv --json f.json").exit_code, 0);
  EXPECT_LT(json("p.json").at("information_nats").back(), json("f.json").at("information_nats").back());
}

TEST_F(PlanPoses, ForARegion) {
  measure(15, "have.csv");
  const CommandResult done = plan("--count 8 --candidates 100 --region have.csv --out poses.csv --json p.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_EQ(json("p.json").at("criterion"), "region_variance");
}

// The chosen rows are measured ones with their approach, and nothing but their joints decides.
TEST_F(PlanPoses, ChoosesMeasuredRowsByTheirJointsAlone) {
  measure(120, "measured.csv");
  const std::string arguments =
      "--choose 15 --from measured.csv --test-every 5 --held-out held.csv --json p.json --out ";
  const CommandResult done = plan(arguments + "chosen.csv");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const auto all = read_dataset<6>(folder_ / "measured.csv");
  const auto chosen = read_dataset<6>(folder_ / "chosen.csv"), held = read_dataset<6>(folder_ / "held.csv");
  ASSERT_EQ(chosen.size(), 15);
  ASSERT_EQ(held.size(), 24);
  for (Index i = 0; i < 15; ++i) {
    const auto row = static_cast<Index>(chosen.times()(i));
    EXPECT_NE(row % 5, 0);
    EXPECT_EQ(chosen.joints(i), all.joints(row));
    EXPECT_LT((chosen.position(i) - all.position(row)).norm(), 1e-12);
    EXPECT_EQ(chosen.previous().row(i), all.previous().row(row));
  }
  for (Index i = 0; i < held.size(); ++i) EXPECT_EQ(held.joints(i), all.joints(5 * i));
  // other measurements at the same joints: the same choice
  write_dataset(folder_ / "measured.csv",
                Dataset<6>(all.joints(), 2 * all.positions(), PointRows(0.5 * all.orientations())));
  ASSERT_EQ(plan(arguments + "other.csv").exit_code, 0);
  EXPECT_EQ(read_joints<6>(folder_ / "other.csv"), chosen.joints());
}

TEST_F(PlanPoses, TheSameSeedIsTheSameVirtualArm) {
  measure(30, "measured.csv");
  const std::string arguments = "--robot abb_irb120 --poses joints.csv --noise-mm 0 --noise-mrad 0 --backlash-mrad 0 ";
  ASSERT_EQ(run("simulate_measurements", arguments + "--seed 7 --out exact.csv").exit_code, 0);
  ASSERT_EQ(run("simulate_measurements", arguments + "--seed 8 --out other.csv").exit_code, 0);
  const auto noisy = read_dataset<6>(folder_ / "measured.csv"), exact = read_dataset<6>(folder_ / "exact.csv"),
             other = read_dataset<6>(folder_ / "other.csv");
  const PointRows noise = noisy.positions() - exact.positions();
  const double rms = std::sqrt(noise.squaredNorm() / static_cast<double>(noise.size()));
  EXPECT_GT(rms, 0.02e-3);
  EXPECT_LT(rms, 0.05e-3);  // backlash is in it, too
  EXPECT_GT((other.positions() - exact.positions()).rowwise().norm().minCoeff(), 1e-3);
  ASSERT_EQ(run("simulate_measurements", arguments + "--positions-only --out points.csv").exit_code, 0);
  EXPECT_FALSE(read_dataset<6>(folder_ / "points.csv").has_orientations());
}

// The errors of gears, here of one seed, are proportional to their size; everything else stays as it was.
TEST_F(PlanPoses, GearsOfTheVirtualArmErrByTheirSize) {
  measure(30, "measured.csv");
  const auto seen = [&](const std::string& gears) {
    const std::string arguments = "--robot abb_irb120 --poses joints.csv --noise-mm 0 --noise-mrad 0 --out gears.csv ";
    EXPECT_EQ(run("simulate_measurements", arguments + gears).exit_code, 0);
    return read_dataset<6>(folder_ / "gears.csv").positions();
  };
  const PointRows none = seen("--gears-urad 0"), half = seen("--gears-urad 100"), whole = seen("--gears-urad 200");
  EXPECT_EQ(whole, seen(""));
  const double size = (whole - none).rowwise().norm().mean();
  EXPECT_GT(size, 0.05e-3);
  EXPECT_LT(size, 1e-3);
  EXPECT_LT((whole - 2 * half + none).rowwise().norm().maxCoeff(), 0.01 * size);
}

TEST_F(PlanPoses, RefusesWhatMakesNoSense) {
  measure(12, "measured.csv");
  const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
    const CommandResult done = plan(arguments);
    EXPECT_EQ(done.exit_code, code) << arguments << done.errors;
    EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
    EXPECT_NE(done.errors.find(words), std::string::npos) << arguments << ": " << done.errors;
  };
  refused("--out p.csv", 2, "one of --count, --add and --choose is required");
  refused("--count 10", 2, "--out is required");
  refused("--add 10 --out p.csv", 2, "--data");
  refused("--choose 5 --out p.csv", 2, "--from");
  refused("--choose 50 --from measured.csv --out p.csv", 1, "12 candidates for 50 measurements");
  refused("--count 10 --box 5,6,5,6,5,6 --candidates 50 --out p.csv", 1, "tool out of its box");
  refused("--count 10 --box 6,5,5,6,5,6 --out p.csv", 1, "lower corner of the tool box");
  refused("--count 10 --box 1,2,3 --out p.csv", 2, "--box");
  const CommandResult none = run("simulate_measurements", "--robot abb_irb120 --poses missing.csv --out m.csv");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.errors.find("missing.csv"), std::string::npos) << none.errors;
}

}  // namespace
}  // namespace vernier::plan_poses_test
