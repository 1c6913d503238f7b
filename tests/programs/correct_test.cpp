// SPDX-License-Identifier: BSD-3-Clause
// Runs correct on a model made here, so that the answers are known exactly.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <utility>

#include "real_matrix.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::correct_test {
namespace {

using vernier_test::CommandResult;

class Correct : public ::testing::Test {
 protected:
  Correct() {
    save(folder_ / "model.json", robot_);
    targets_ = abb_irb120_operating_region().sample(robot_.nominal().chain(), 30, 12);
  }

  CommandResult correct(const std::string& arguments) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/correct' " +
                                         (arguments.starts_with("--model") ? "" : "--model model.json ") + arguments,
                                     folder_.path());
  }

  std::vector<std::string> lines(const std::string& name) {
    std::istringstream text(read_file(folder_ / name));
    std::vector<std::string> out;
    for (std::string line; std::getline(text, line);) out.push_back(line);
    return out;
  }

  vernier_test::TemporaryFolder folder_{"correct"};
  Robot<6> catalogue_ = robots::abb_irb120();
  using Model = CalibratedRobot<6>::Model;
  Model::Arm actual_{with_geometric_errors(catalogue_.chain, {}, 21), FrameParameters(Vector6{1, 2, 0.5, 0, 0, 1}),
                     FrameParameters(Vector6{0, 0, 0.1, 0, 0, 0})};
  CalibratedRobot<6> robot_{"simulated", Model(catalogue_.chain, actual_), catalogue_.limits, {}};
  JointRows<6> targets_;
};

TEST_F(Correct, TheActualArmGoesWhereTheNominalOneWould) {
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  const CommandResult done = correct("--targets targets.csv --out commands.csv");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("30 of 30 targets corrected; in the model the tool meets them within "), std::string::npos)
      << done.output;
  EXPECT_EQ(done.output.find("The model itself errs"), std::string::npos) << done.output;  // nobody measured it
  const auto said_with = [&](const Provenance& from) {
    save(folder_ / "known.json", robot_.with_model(robot_.model(), from));
    return correct("--model known.json --targets targets.csv --out known.csv").output;
  };
  EXPECT_NE(said_with({.left_out_error = 70e-6, .held_out_error = 51.3e-6})
                .find("The model itself errs by 0.0513 mm at poses it was not fitted to (mean of held-out poses)\n"),
            std::string::npos);
  EXPECT_NE(said_with({.left_out_error = 70e-6}).find("0.07 mm at poses it was not fitted to (rms of poses left out"),
            std::string::npos);
  EXPECT_EQ(lines("commands.csv").at(0),
            "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,status,predicted_error_mm,gate,target,point,"
            "predicted_rotation_mrad,deviation_mm,radius95_mm,singularity,singularity_deg");
  const auto commands = read_joints<6>(folder_ / "commands.csv");
  const auto after = positioning_errors(actual_, robot_.nominal(), commands, targets_);
  EXPECT_LT(after.position.maxCoeff(), 1e-6);
  EXPECT_LT(after.rotation.maxCoeff(), 1e-6);
  EXPECT_GT(positioning_errors(actual_, robot_.nominal(), targets_, targets_).position.minCoeff(), 1e-4);
}

TEST_F(Correct, ReadsTheModelThroughAPipe) {
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  write_file(folder_ / "a.mod",
             "MODULE a\nPROC main()\nMoveAbsJ [[10,20,-30,40,50,60],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,tool0;\n"
             "ENDPROC\nENDMODULE\n");
  const auto through_pipe = [&](const std::string& arguments) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; mkfifo p; cat model.json >p & '" +
                                         VERNIER_EXAMPLES_DIR + "/correct' --model p " + arguments + " && rm p",
                                     folder_.path());
  };
  ASSERT_EQ(correct("--targets targets.csv --out a.csv").exit_code, 0);
  const CommandResult commands = through_pipe("--targets targets.csv --out b.csv");
  ASSERT_EQ(commands.exit_code, 0) << commands.errors;
  EXPECT_EQ(read_file(folder_ / "a.csv"), read_file(folder_ / "b.csv"));
  const CommandResult program = through_pipe("--program a.mod --out b.mod");
  ASSERT_EQ(program.exit_code, 0) << program.errors;
  EXPECT_NE(read_file(folder_ / "b.mod").find("! sha256 " + sha256(read_file(folder_ / "model.json")) + "\n"),
            std::string::npos);
}

TEST_F(Correct, PosesAsTargetsGiveTheSameCommands) {
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  write_dataset(folder_ / "poses.csv", measure(robot_.nominal(), targets_));
  ASSERT_EQ(correct("--targets targets.csv --out a.csv").exit_code, 0);
  ASSERT_EQ(correct("--targets poses.csv --poses --out b.csv").exit_code, 0);
  EXPECT_LT(vernier_test::difference(read_joints<6>(folder_ / "a.csv"), read_joints<6>(folder_ / "b.csv")), 1e-9);
  write_dataset(folder_ / "points.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  const CommandResult points = correct("--targets points.csv --poses --out c.csv");
  EXPECT_EQ(points.exit_code, 1);
  EXPECT_NE(points.errors.find("points.csv: no columns rx_rad"), std::string::npos) << points.errors;
}

// A pose of the pendant and the joint values that it has there are the same target; the command is given as a pose,
// too.
TEST_F(Correct, PosesOfThePendantAreThoseOfItsTool) {
  const Isometry3 base = FrameParameters(Vector6{0.1, 0, -0.4, 0, 0, 0.3}).isometry(),
                  tool = FrameParameters(Vector6{0.02, -0.03, 0.15, 0.4, 0, 0}).isometry();
  const auto shown = [&](const JointVector<6>& q) {
    return Isometry3(base.inverse() * catalogue_.chain.pose(q) * tool);
  };
  PointRows positions(30, 3), orientations(30, 3);
  for (Index i = 0; i < 30; ++i) {
    const Isometry3 pose = shown(targets_.row(i).transpose());
    set_point(positions, i, translation(pose));
    set_point(orientations, i, log_so3(rotation(pose)));
  }
  write_dataset(folder_ / "pendant.csv", Dataset<6>(targets_, positions, orientations));
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  ASSERT_EQ(correct("--targets targets.csv --out a.csv").exit_code, 0);
  const std::string frames = " --robot-base 100,0,-400,0,0," + message(0.3 * 180 / std::numbers::pi) +
                             " --tool 20,-30,150," + message(0.4 * 180 / std::numbers::pi) + ",0,0";
  const CommandResult done = correct("--targets pendant.csv --poses --frame base --out b.csv" + frames);
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const auto joints = read_joints<6>(folder_ / "b.csv");
  EXPECT_LT(vernier_test::difference(read_joints<6>(folder_ / "a.csv"), joints), 1e-8);
  const auto commanded = read_dataset<6>(folder_ / "b.csv");
  for (Index i = 0; i < 30; ++i) {
    const Isometry3 pose = shown(joints.row(i).transpose());
    EXPECT_LT((commanded.position(i) - translation(pose)).norm(), 1e-9);
    EXPECT_LT(rotation_difference(rotation(pose), exp_so3(point(commanded.orientations(), i))).norm(), 1e-9);
  }
  EXPECT_EQ(lines("a.csv").at(0).find("x_mm"), std::string::npos);

  const auto refused = [&](const std::string& arguments, int code, const std::string& reason) {
    const CommandResult result = correct(arguments);
    EXPECT_EQ(result.exit_code, code) << result.errors;
    EXPECT_TRUE(result.one_line_of_errors()) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
  };
  refused("--targets pendant.csv --frame base --out c.csv", 1, "--frame base is of poses; there are joints");
  refused("--targets pendant.csv --poses --out c.csv" + frames, 2, "--tool is of a --program, or of poses");
  refused("--targets pendant.csv --noflip positive --out c.csv", 2, "--noflip requires --program");
  refused("--targets pendant.csv --poses --frame base --tool hand --out c.csv", 2, "--tool hand: not six numbers");
  refused("--targets pendant.csv --frame tool --out c.csv", 2, "--frame");
}

TEST_F(Correct, EachCommandComesFromTheOneBefore) {
  JointTerms terms(6);
  terms.hysteresis = {0.02};
  const JointErrors hysteresis(terms, VectorX::Constant(6, 1e-4));
  const Model model(catalogue_.chain,
                    Model::Arm({actual_.chain(), hysteresis}, actual_.base_frame(), actual_.tool_frame()));
  save(folder_ / "model.json", CalibratedRobot<6>("with hysteresis", model, catalogue_.limits, {}));
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  ASSERT_EQ(correct("--targets targets.csv --out ordered.csv").exit_code, 0);
  ASSERT_EQ(correct("--targets targets.csv --no-approach --out any.csv").exit_code, 0);
  const auto ordered = read_joints<6>(folder_ / "ordered.csv"), any = read_joints<6>(folder_ / "any.csv");
  // from the first target alone nobody knows where the arm comes from
  EXPECT_EQ(ordered.row(0), any.row(0));
  for (Index i = 1; i < 30; ++i) {
    const Vector3 target = robot_.nominal().position(targets_.row(i).transpose());
    const auto missed = [&](const JointRows<6>& commands) {
      const auto arm = model.approached_from(commands.row(i - 1).transpose());
      return (arm.position(commands.row(i).transpose()) - target).norm();
    };
    EXPECT_LT(missed(ordered), 1e-6);
    EXPECT_GT(missed(any), 1e-6);
  }
}

TEST_F(Correct, ForATemperature) {
  const Model model = Model(catalogue_.chain, actual_).with_thermal({22, 20, 25, VectorX::Constant(42, 2e-5)});
  save(folder_ / "model.json", CalibratedRobot<6>("thermal", model, catalogue_.limits, {}));
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  const auto lands = [&](const std::string& arguments, double celsius) {
    const CommandResult done = correct("--targets targets.csv --out commands.csv " + arguments);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    const auto arm = model.at_temperature(celsius).identified();
    EXPECT_LT(positioning_errors(arm, robot_.nominal(), read_joints<6>(folder_ / "commands.csv"), targets_)
                  .position.maxCoeff(),
              1e-6);
    return done.output;
  };
  EXPECT_NE(lands("", 22).find("Corrected for 22 deg C, the mean of the measurements"), std::string::npos);
  EXPECT_NE(lands("--temperature-c 24.5", 24.5).find("Corrected for 24.5 deg C\n"), std::string::npos);
  EXPECT_NE(lands("--temperature-c 50", 25).find("Corrected for 25 deg C, the nearest that was measured"),
            std::string::npos);
}

TEST_F(Correct, UnderAPayload) {
  JointTerms terms(6);
  terms.payload.emplace(detail::ChainTable(catalogue_.chain.view()), Vector3(0, 0, -1), Payload{1, Vector3(0, 0, 0.1)});
  const JointErrors springs(terms, VectorX::Constant(6, 2e-5));
  const Model model(catalogue_.chain,
                    Model::Arm({actual_.chain(), springs}, actual_.base_frame(), actual_.tool_frame()));
  save(folder_ / "model.json", CalibratedRobot<6>("with springs", model, catalogue_.limits, {}));
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  const auto lands = [&](const std::string& arguments, const Payload& payload) {
    const CommandResult done = correct("--targets targets.csv --out commands.csv " + arguments);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_LT(positioning_errors(model.carrying(payload).identified(), robot_.nominal(),
                                 read_joints<6>(folder_ / "commands.csv"), targets_)
                  .position.maxCoeff(),
              1e-6);
  };
  lands("", {1, Vector3(0, 0, 0.1)});
  lands("--payload-kg 4", {4});
  lands("--payload-kg 4 --payload-centre 10,-20,150", {4, Vector3(0.01, -0.02, 0.15)});
  save(folder_ / "model.json", CalibratedRobot<6>("stiff", Model(catalogue_.chain, actual_), catalogue_.limits, {}));
  const CommandResult refused = correct("--targets targets.csv --out commands.csv --payload-kg 4");
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_NE(refused.errors.find("--payload-kg: the measurements of the model state no payload"), std::string::npos);
}

TEST_F(Correct, ATargetOutOfReachIsARowThatSaysSo) {
  targets_.row(3)(1) = 170 * std::numbers::pi / 180;  // joint 2 ends at 110 degrees
  targets_.row(17)(2) = 2.5;                          // joint 3 at 70
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  const CommandResult done = correct("--targets targets.csv --out commands.csv --json r.json");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
  EXPECT_NE(done.errors.find("2 of 30 targets cannot be met, their rows in commands.csv say so: row 4, 18"),
            std::string::npos)
      << done.errors;
  const auto rows = lines("commands.csv");
  ASSERT_EQ(rows.size(), 31u);  // the output is whole all the same
  for (std::size_t i = 1; i < rows.size(); ++i)
    EXPECT_EQ(rows[i].find(",converged,") == std::string::npos, i == 4 || i == 18) << rows[i];
  const auto commands = read_joints<6>(folder_ / "commands.csv");
  for (Index i = 0; i < commands.rows(); ++i)
    EXPECT_TRUE(catalogue_.limits.contains(commands.row(i).transpose())) << "row " << i + 1;
  const auto report = nlohmann::json::parse(read_file(folder_ / "r.json"));
  EXPECT_EQ(report.at("targets"), 30);
  EXPECT_EQ(report.at("corrected"), 28);
  EXPECT_EQ(report.at("missed_rows"), (std::vector<int>{4, 18}));
  EXPECT_GT(report.at("predicted_error").at("max_mm"), 1);
}

// Poses alone: the branch is chosen; linear moves are filled with points until the actual arm stays on its line.
TEST_F(Correct, PosesAloneAndLinearMoves) {
  const Isometry3 corner = robot_.nominal().pose(targets_.row(0).transpose());
  std::string text = "x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad,move\n";
  const Vector3 rotation = log_so3(Matrix3(corner.linear()));
  const Vector3 end = corner.translation() + Vector3(-0.06, 0.06, 0);
  for (const auto& [point, move] : {std::pair(Vector3(corner.translation()), 'j'), std::pair(end, 'l')})
    text += message(point.x() * 1e3, ',', point.y() * 1e3, ',', point.z() * 1e3, ',', rotation.x(), ',', rotation.y(),
                    ',', rotation.z(), ',', move, '\n');
  write_file(folder_ / "line.csv", text);
  const CommandResult done =
      correct("--targets line.csv --tolerance-mm 0.001 --start 0,0,0,0,1,0 --out commands.csv --json r.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("Linear moves: the tool leaves their lines by"), std::string::npos) << done.output;
  const auto commands = read_joints<6>(folder_ / "commands.csv");
  const auto report = nlohmann::json::parse(read_file(folder_ / "r.json"));
  EXPECT_EQ(report.at("targets"), 2);
  EXPECT_EQ(report.at("met"), 2);
  EXPECT_EQ(report.at("points"), commands.rows());
  EXPECT_EQ(report.at("inserted"), commands.rows() - 2);
  EXPECT_EQ(report.at("jumps"), 0);
  EXPECT_GT(report.at("inserted"), 0);
  EXPECT_LE(report.at("path").at("after_max_mm"), 0.001);
  EXPECT_GT(report.at("path").at("before_max_mm"), 0.001);
  EXPECT_LT((actual_.position(commands.row(0).transpose()) - corner.translation()).norm(), 1e-6);
  EXPECT_LT((actual_.position(commands.bottomRows(1).transpose()) - end).norm(), 1e-6);
  EXPECT_NE(lines("commands.csv").at(2).find(",2,inserted,"), std::string::npos);

  if (std::system("gnuplot --version >/dev/null 2>&1") == 0) {
    EXPECT_NE(read_file(folder_ / "commands.svg").find("length of the path [mm]"), std::string::npos);
  }

  const CommandResult all = correct("--targets line.csv --all-branches --out all.csv");
  EXPECT_EQ(all.exit_code, 0) << all.errors;
  const auto branches = read_joints<6>(folder_ / "all.csv");
  EXPECT_GE(branches.rows(), 4);
  for (Index i = 0; i < branches.rows(); ++i)
    EXPECT_LT(std::min((actual_.position(branches.row(i).transpose()) - corner.translation()).norm(),
                       (actual_.position(branches.row(i).transpose()) - end).norm()),
              1e-8);
}

TEST_F(Correct, RefusesMovesAndStartsThatAreNone) {
  write_file(folder_ / "bad.csv", "x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad,move\n300,0,400,0,1,0,x\n");
  const CommandResult move = correct("--targets bad.csv --out c.csv");
  EXPECT_EQ(move.exit_code, 1);
  EXPECT_NE(move.errors.find("bad.csv, line 2, column move: 'x', must be j"), std::string::npos) << move.errors;
  write_dataset(folder_ / "targets.csv", Dataset<6>(targets_, PointRows::Zero(30, 3)));
  const CommandResult start = correct("--targets targets.csv --start 1,2 --out c.csv");
  EXPECT_EQ(start.exit_code, 2);
  EXPECT_NE(start.errors.find("--start needs 6 values"), std::string::npos) << start.errors;
  EXPECT_EQ(correct("--targets targets.csv --tolerance-mm 0 --out c.csv").exit_code, 2);
}

TEST_F(Correct, LinesThroughASingularityAreJumps) {
  JointRows<6> ends(2, 6);
  ends << 0.2, 0.3, 0.1, 0.4, -0.2, 0.1, 0.2, 0.3, 0.1, 0.4, 0.2, 0.1;  // joint 5 changes its sign
  write_dataset(folder_ / "targets.csv", Dataset<6>(ends, PointRows::Zero(2, 3)));
  const CommandResult done = correct("--targets targets.csv --linear --out commands.csv --json r.json");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_NE(done.errors.find("1 of 2 moves are not as asked"), std::string::npos) << done.errors;
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "r.json")).at("jumps"), 1);
  EXPECT_NE(lines("commands.csv").back().find(",jump,"), std::string::npos);
}

}  // namespace
}  // namespace vernier::correct_test
