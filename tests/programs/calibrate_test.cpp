// SPDX-License-Identifier: BSD-3-Clause
// Runs calibrate, and correct behind it, on simulated measurements and, where they are, on measured ones.

#include <gtest/gtest.h>
#include "vernier/core/sha256.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "replaced.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::calibrate_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

CommandResult run(const TemporaryFolder& folder, const std::string& program, const std::string& arguments) {
  return vernier_test::run_command(
      "cd '" + folder.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + program + "' " + arguments,
      folder.path());
}

Isometry3 frame(const Vector6& values) { return FrameParameters(values).isometry(); }

/// An IRB 120 with errors of 0.5 to 1 mm and 1 to 3 mrad, in the frame of a tracker, with a tool.
Framed<DhChain<6>> actual_arm() {
  return Framed<DhChain<6>>(with_geometric_errors(robots::abb_irb120().chain, {}, 7),
                            frame({2.1, -1.3, 0.4, 0.02, -0.03, 2.2}), frame({0.01, 0.02, 0.12, 0.3, 0, 0}));
}

Dataset<6> measured(Index n, std::uint64_t seed, bool oriented = true) {
  const auto arm = actual_arm();
  const JointRows<6> joints = abb_irb120_operating_region().sample(robots::abb_irb120().chain, n, seed);
  return measure(arm, joints, {.position = 0.03e-3, .orientation = 0.05e-3, .with_orientations = oriented}, seed);
}

/// One calibration that several tests look at.
struct Calibration {
  TemporaryFolder folder{"calibrate"};
  CommandResult command;
  Json json;

  Calibration() {
    write_dataset(folder / "poses.csv", measured(150, 1));
    command =
        run(folder, "calibrate",
            "--robot abb_irb120 --data poses.csv --test-every 5 --save model.json --json report.json --out figures "
            "--threads 1 --date 2024-05-01");
    if (command.exit_code == 0) json = Json::parse(read_file(folder / "report.json"));
  }
};

const Calibration& calibration() {
  static const Calibration made;
  return made;
}

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> out;
  for (const auto& [key, ignored] : object.items()) out.push_back(key);
  return out;
}

TEST(Calibrate, JsonHasTheStatedMembers) {
  const Calibration& c = calibration();
  ASSERT_EQ(c.command.exit_code, 0) << c.command.errors;
  EXPECT_EQ(c.command.errors, "");
  EXPECT_EQ(keys(c.json), (std::vector<std::string>{"robot",
                                                    "train_rows",
                                                    "test_rows",
                                                    "independent_test_poses",
                                                    "left_out_blocks_mm",
                                                    "outliers_kept",
                                                    "outliers",
                                                    "stages",
                                                    "chosen",
                                                    "mean_temperature_c",
                                                    "down",
                                                    "payload",
                                                    "blocks",
                                                    "learners",
                                                    "prior",
                                                    "parameters",
                                                    "identifiability",
                                                    "spectrum",
                                                    "drift",
                                                    "gated_rows",
                                                    "worst_harm_beside_geometry_mm",
                                                    "within_95_percent_ellipsoids",
                                                    "held_out_mean_mm",
                                                    "verdict",
                                                    "details",
                                                    "audit"}));
  EXPECT_DOUBLE_EQ(c.json.at("held_out_mean_mm").at("mean").get<double>(),
                   c.json.at("stages").at(c.json.at("chosen").get<std::string>()).at("mean_mm").get<double>());
  ASSERT_EQ(c.json.at("audit").size(), 1u);  // one file
  EXPECT_TRUE(c.json.at("audit").at(0).at("findings").empty());
  EXPECT_TRUE(c.json.at("prior").is_null());
  ASSERT_EQ(c.json.at("learners").size(), 6u);  // three on geometry, three on the error model
  for (const Json& learner : c.json.at("learners"))
    EXPECT_EQ(keys(learner), (std::vector<std::string>{"stage", "used", "left_out_without_mm", "left_out_with_mm"}));
  ASSERT_FALSE(c.json.at("blocks").empty());
  for (const Json& block : c.json.at("blocks"))
    EXPECT_EQ(keys(block), (std::vector<std::string>{"name", "used", "left_out_without_mm", "left_out_with_mm",
                                                     "answer", "look_alike", "p", "size_mm", "interval_mm",
                                                     "relevant_mm", "poses_to_decide", "tightness"}));
  ASSERT_EQ(c.json.at("spectrum").size(), 6u);
  for (const Json& joint : c.json.at("spectrum")) {
    EXPECT_EQ(joint.at("orders").size(), joint.at("amplitudes_urad").size());
    EXPECT_EQ(joint.at("orders").size(), joint.at("stds_urad").size());
  }
  EXPECT_EQ(c.json.at("robot"), "abb_irb120");
  EXPECT_EQ(c.json.at("train_rows"), 120);
  EXPECT_EQ(c.json.at("test_rows"), 30);
  EXPECT_EQ(keys(c.json.at("stages")), (std::vector<std::string>{"frames", "geometry", "geometry_pso_elm", "elastic",
                                                                 "jointwise", "jointwise_pso_elm"}));
  for (const auto& [name, stage] : c.json.at("stages").items()) {
    EXPECT_EQ(keys(stage), (std::vector<std::string>{"mean_mm", "rms_mm", "max_mm", "min_mm", "p95_mm", "mean_mrad"}))
        << name;
    EXPECT_LE(stage.at("min_mm"), stage.at("mean_mm"));
    EXPECT_LE(stage.at("mean_mm"), stage.at("rms_mm"));
    EXPECT_LE(stage.at("p95_mm"), stage.at("max_mm"));
  }
  ASSERT_EQ(c.json.at("parameters").size(), 42u);
  std::set<std::string> names;
  for (const auto& p : c.json.at("parameters")) {
    EXPECT_EQ(keys(p), (std::vector<std::string>{"name", "unit", "nominal", "identified", "std"}));
    names.insert(p.at("name").get<std::string>());
  }
  EXPECT_EQ(names.size(), 42u);
  const Json& a2 = c.json.at("parameters").at(6 + 5);
  EXPECT_EQ(a2.at("name"), "a2");
  EXPECT_EQ(a2.at("unit"), "mm");
  EXPECT_NEAR(a2.at("nominal"), 270, 1e-9);
  EXPECT_NEAR(a2.at("identified"), actual_arm().chain().row(1).a * 1e3, 0.1);
  const Json& known = c.json.at("identifiability");
  EXPECT_EQ(keys(known),
            (std::vector<std::string>{"rank", "free", "condition", "weak", "strongly_correlated", "observability"}));
  EXPECT_EQ(known.at("rank"), known.at("free"));
  EXPECT_EQ(known.at("free"), 30);  // all that a full pose determines of six revolute joints with their frames
  EXPECT_GT(known.at("condition"), 1);
}

TEST(Calibrate, HeldOutErrorsFallToTheNoise) {
  const Json& stages = calibration().json.at("stages");
  EXPECT_GT(stages.at("frames").at("mean_mm"), 0.5);
  const double geometry = stages.at("geometry").at("mean_mm");
  EXPECT_LT(geometry, 0.07);  // the noise of a held-out measurement alone has a mean of 0.048
  EXPECT_LE(stages.at("geometry_pso_elm").at("mean_mm"), 1.02 * geometry);
}

TEST(Calibrate, SaysWhatItDidAndWhereItIs) {
  const Calibration& c = calibration();
  for (const char* words :
       {"120 poses to learn from, 30 held out: every row i with i % 5 = 0", "frames", "geometry", "geometry + PSO-ELM",
        "joint-wise", "[mrad]", "Verdict\n- Position error of all 30 held-out poses: ", " mm mean (95 % interval ",
        "Details behind the verdict: --verbose", "Figures: figures", "model.json"})
    EXPECT_NE(c.command.output.find(words), std::string::npos) << words << " is not in\n" << c.command.output;
  const std::string& output = c.command.output;
  EXPECT_TRUE(output.starts_with("Verdict\n")) << output;
  EXPECT_LE(std::count(output.begin(), output.begin() + static_cast<std::ptrdiff_t>(output.find("\n\n")), '\n'), 7);
  EXPECT_EQ(output.find("theta2"), std::string::npos) << "parameters are for --parameters";
  const char* details[] = {"Converged: ", "\nDetails\n- ", "Measured joint ranges [deg, mm]: ", "Range of validity"};
  for (const char* words : details) EXPECT_EQ(c.command.output.find(words), std::string::npos) << c.command.output;
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) return;  // the figures need it, the rest does not
  for (const char* name :
       {"stages.svg", "distribution.svg", "poses.svg", "errors_along_joint_6.svg", "joint_ranges.svg"}) {
    EXPECT_GT(std::filesystem::file_size(c.folder.path() / "figures" / name), 1000u) << name;
  }
}

TEST(Calibrate, TheSavedModelPredictsFreshPoses) {
  const auto model = load<6>(calibration().folder / "model.json");
  const Provenance& from = model.provenance();
  EXPECT_EQ(from, (Provenance{"poses.csv",
                              120,
                              "2024-05-01",
                              "commanded",
                              "poses",
                              from.position_sigma,
                              from.left_out_error,
                              from.held_out_error,
                              sha256(read_file(calibration().folder / "poses.csv")),
                              {},
                              from.fitted_rows}));
  EXPECT_EQ(from.fitted_rows.values().size(), 120u);
  EXPECT_NEAR(from.left_out_error, from.held_out_error, from.held_out_error);
  EXPECT_GT(from.held_out_error, 0);
  EXPECT_NEAR(from.position_sigma, 0.03e-3, 0.01e-3);
  EXPECT_TRUE(model.nominal().chain() == robots::abb_irb120().chain);
  const auto fresh = measure(actual_arm(), measured(200, 99).joints());
  EXPECT_LT(prediction_error(model, fresh).mean, 0.04e-3);
  EXPECT_LT(rotation_errors(model, fresh).mean(), 0.1e-3);
}

TEST(Calibrate, CorrectBringsTheActualArmWithinTheNoise) {
  const Calibration& c = calibration();
  const JointRows<6> targets = abb_irb120_operating_region().sample(robots::abb_irb120().chain, 60, 31);
  write_dataset(c.folder / "targets.csv", Dataset<6>(targets, PointRows::Zero(60, 3)));
  const CommandResult corrected =
      run(c.folder, "correct", "--model model.json --targets targets.csv --out commands.csv --json correct.json");
  ASSERT_EQ(corrected.exit_code, 0) << corrected.errors;
  const JointRows<6> commands = read_joints<6>(c.folder / "commands.csv");
  const auto model = load<6>(c.folder / "model.json");
  const auto before = positioning_errors(actual_arm(), model.nominal(), targets, targets);
  const auto after = positioning_errors(actual_arm(), model.nominal(), commands, targets);
  EXPECT_GT(before.position.mean(), 0.5e-3);
  EXPECT_LT(after.position.mean(), 0.04e-3);
  EXPECT_LT(after.position.maxCoeff(), 0.15e-3);
  EXPECT_LT(after.rotation.mean(), 0.1e-3);
  const Json report = Json::parse(read_file(c.folder / "correct.json"));
  EXPECT_EQ(report.at("targets"), 60);
  EXPECT_EQ(report.at("corrected"), 60);
}

// The rows that are learned from are means of three readings, and so are those that the ellipsoids are to hold: of
// single readings a quarter is outside. 0.885 is three deviations below 0.95.
TEST(Calibrate, EllipsoidsHoldPosesOfThreeReadings) {
  const TemporaryFolder folder("calibrate");
  const JointRows<6> poses = abb_irb120_operating_region().sample(robots::abb_irb120().chain, 200, 5);
  JointRows<6> joints(600, 6);
  for (Index i = 0; i < 600; ++i) joints.row(i) = poses.row(i / 3);
  write_dataset(folder / "readings.csv",
                measure(actual_arm(), joints, {.position = 0.03e-3, .orientation = 0.05e-3}, 6));
  const CommandResult found =
      run(folder, "calibrate",
          "--robot abb_irb120 --data readings.csv --test-fraction 0.5 --json report.json --out figures --threads 1");
  ASSERT_EQ(found.exit_code, 0) << found.errors;
  const Json json = Json::parse(read_file(folder / "report.json"));
  EXPECT_GE(json.at("within_95_percent_ellipsoids").get<double>(), 0.885);
}

// A few new poses of the same arm, with the earlier calibration and without.
TEST(Calibrate, StartsFromAnEarlierCalibration) {
  const TemporaryFolder& folder = calibration().folder;
  write_dataset(folder / "later.csv", measured(15, 71));
  write_dataset(folder / "unseen.csv", measured(100, 72));
  const auto calibrated = [&](const std::string& prior, const std::string& name) {
    const CommandResult result = run(folder, "calibrate",
                                     "--robot abb_irb120 --data later.csv --test unseen.csv --threads 1 --out later "
                                     "--save " +
                                         name + ".json --json " + name + "_report.json" + prior);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return Json::parse(read_file(folder / (name + "_report.json")));
  };
  const Json alone = calibrated("", "alone"), with = calibrated(" --prior model.json", "with");
  ASSERT_EQ(with.at("prior").at("used"), true) << with.dump();
  EXPECT_EQ(with.at("prior").at("name"), "model.json");
  EXPECT_LE(with.at("prior").at("geometry_kappa"), 0.1);
  EXPECT_EQ(with.at("chosen"), "prior");
  const auto chosen = [](const Json& json) -> double {
    return json.at("stages").at(json.at("chosen").get<std::string>()).at("mean_mm");
  };
  EXPECT_LT(chosen(with), 0.03 * 1.6 * 1.15);  // the noise, a mean norm of three components
  EXPECT_LT(chosen(with), chosen(alone));
  const auto loaded = load<6>(folder / "with.json");  // what was saved is what was assessed
  ASSERT_NE(loaded.estimate(), nullptr);
  EXPECT_NEAR(position_errors(loaded, read_dataset<6>(folder / "unseen.csv")).mean() * 1e3, chosen(with), 1e-9);
}

TEST(Calibrate, SameBitsForAnyNumberOfThreads) {
  const Calibration& c = calibration();
  const CommandResult again =
      run(c.folder, "calibrate",
          "--robot abb_irb120 --data poses.csv --save model2.json --json report2.json --out f2 "
          "--threads 3 --date 2024-05-01 --verbose --parameters");  // every fifth row is the default
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  for (const char* words :
       {"Verdict\n- ", "Converged: ", "\ntheta2  ", "\ntool_x  ", "\nDetails\n- ",
        "Measured joint ranges [deg, mm]: ", "Range of validity [deg, mm]: ", "Gravity compliance: "})
    EXPECT_NE(again.output.find(words), std::string::npos) << words << " is not in\n" << again.output;
  EXPECT_EQ(again.output.find("--verbose"), std::string::npos);
  EXPECT_EQ(read_file(c.folder / "report.json"), read_file(c.folder / "report2.json"));
  EXPECT_EQ(read_file(c.folder / "model.json"), read_file(c.folder / "model2.json"));
}

// Orientations that say nothing leave what positions say.
TEST(Calibrate, SigmasWeightPositionsAndOrientations) {
  const Calibration& c = calibration();
  const auto parameters = [&](const std::string& options) {
    const CommandResult done =
        run(c.folder, "calibrate",
            "--robot abb_irb120 --data poses.csv --test-every 5 --out f3 --harmonics 0 --no-approach "
            "--parameters --save sigma.json " +
                options);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    const std::size_t begin = done.output.find("\ntheta2  ");
    return std::stod(done.output.substr(begin + 41, 9));  // the change [mrad]
  };
  const double positions = parameters("--positions-only"), heavy = parameters("--orientation-sigma 1000"),
               both = parameters("");
  EXPECT_NEAR(heavy, positions, 2e-3);
  EXPECT_GT(std::abs(both - positions), 5e-3) << "else this test says nothing";
}

TEST(Calibrate, TestFileFixedParametersAndRobustLoss) {
  const TemporaryFolder folder("calibrate");
  Dataset<6> train = measured(100, 3, false);
  PointRows positions = train.positions();
  for (const Index bad : {5, 40, 77}) positions.row(bad) += Eigen::RowVector3d(0.02, -0.01, 0.03);
  write_dataset(folder / "train.csv", Dataset<6>(train.joints(), positions));
  write_dataset(folder / "test.csv", measured(40, 4, false));
  const std::string arguments =
      "--robot abb_irb120 --data train.csv --test test.csv --keep-outliers --json r.json --threads 1 ";
  const CommandResult plain = run(folder, "calibrate", arguments + "--loss squared");
  ASSERT_EQ(plain.exit_code, 0) << plain.errors;
  EXPECT_NE(plain.output.find("3 training rows are outliers and kept, as asked: train.csv, lines 7, 42 and 79"),
            std::string::npos)
      << plain.output;
  const double squared = Json::parse(read_file(folder / "r.json")).at("stages").at("geometry").at("mean_mm");

  const CommandResult robust = run(folder, "calibrate", arguments + "--loss cauchy --fix d4 theta3");
  ASSERT_EQ(robust.exit_code, 0) << robust.errors;
  const Json report = Json::parse(read_file(folder / "r.json"));
  EXPECT_EQ(report.at("train_rows"), 100);
  EXPECT_EQ(report.at("test_rows"), 40);
  for (const auto& p : report.at("parameters"))
    if (p.at("name") == "d4" || p.at("name") == "theta3") {
      EXPECT_EQ(p.at("nominal"), p.at("identified"));
      EXPECT_EQ(p.at("std"), 0);
    }
  EXPECT_EQ(robust.output.find("[mrad]"), std::string::npos);  // positions alone

  const CommandResult all = run(folder, "calibrate", arguments + "--loss cauchy");
  ASSERT_EQ(all.exit_code, 0) << all.errors;
  const double cauchy = Json::parse(read_file(folder / "r.json")).at("stages").at("geometry").at("mean_mm");
  EXPECT_LT(cauchy, 0.09);
  EXPECT_GT(squared, 2 * cauchy);
}

// One point of a hundred is off by two metres: it is named, and the run goes on.
TEST(Calibrate, AnOutlierIsNamedAndLeftOutOrKept) {
  const TemporaryFolder folder("calibrate_outlier");
  const Dataset<6> data = measured(100, 5);
  PointRows positions = data.positions();
  positions(57, 1) += 2;
  write_dataset(folder / "poses.csv", Dataset<6>(data.joints(), positions, data.orientations()));
  const std::string arguments = "--robot abb_irb120 --data poses.csv --test-every 5 --json out.json --out figures ";
  const CommandResult left_out = run(folder, "calibrate", arguments);
  ASSERT_EQ(left_out.exit_code, 0) << left_out.output;
  EXPECT_NE(left_out.output.find("1 training row is an outlier and left out: poses.csv, line 59"), std::string::npos)
      << left_out.output;
  const Json json = Json::parse(read_file(folder / "out.json"));
  EXPECT_EQ(json.at("train_rows"), 79);
  EXPECT_EQ(json.at("outliers").at(0).at("line"), 59);
  EXPECT_LT(json.at("held_out_mean_mm").at("mean"), 0.1);
  const CommandResult kept = run(folder, "calibrate", arguments + "--keep-outliers");
  ASSERT_EQ(kept.exit_code, 0) << kept.output;
  EXPECT_EQ(Json::parse(read_file(folder / "out.json")).at("train_rows"), 80);
}

// Each file has a tool of its own, and a saved model.
TEST(Calibrate, OwnToolsHaveAModelEach) {
  const TemporaryFolder folder("calibrate_tools");
  write_dataset(folder / "a.csv", measured(60, 5));
  const auto arm = actual_arm();
  const Framed<DhChain<6>> other(arm.model(), arm.base(), frame({-0.1, 0.15, 0.2, 0, 0.4, 0.2}));
  const JointRows<6> joints = abb_irb120_operating_region().sample(robots::abb_irb120().chain, 60, 8);
  write_dataset(folder / "b.csv", measure(other, joints, {.position = 0.03e-3, .orientation = 0.05e-3}, 8));
  const CommandResult command = run(folder, "calibrate",
                                    "--robot abb_irb120 --data a.csv b.csv --own-tools --test-every 5 --save arm.json "
                                    "--json out.json --out figures");
  ASSERT_EQ(command.exit_code, 0) << command.output;
  for (const auto& [key, stage] : Json::parse(read_file(folder / "out.json")).at("stages").items())
    EXPECT_LT(stage.at("mean_mm"), 5) << key;
  const Dataset<6> fresh = measure(other, abb_irb120_operating_region().sample(robots::abb_irb120().chain, 50, 9));
  EXPECT_LT(prediction_error(load<6>((folder / "arm.2.json").string()).model(), fresh).mean, 0.1e-3);
  EXPECT_NE(command.output.find("With the tool of b.csv: arm.2.json"), std::string::npos) << command.output;
}

TEST(Calibrate, ARobotFromAFileWithAPrismaticJointInTheModifiedConvention) {
  const TemporaryFolder folder("calibrate");
  write_file(folder / "stanford.json", R"({"name": "a stanford arm", "convention": "modified", "joints": [
    {"a_mm": 0, "alpha_deg": 0, "d_mm": 400, "theta_deg": 0, "lower_deg": -150, "upper_deg": 150},
    {"a_mm": 0, "alpha_deg": -90, "d_mm": 150, "theta_deg": 0, "lower_deg": -80, "upper_deg": 80},
    {"type": "prismatic", "a_mm": 0, "alpha_deg": 90, "d_mm": 0, "theta_deg": 0, "lower_mm": 200, "upper_mm": 700},
    {"a_mm": 0, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "lower_deg": -170, "upper_deg": 170},
    {"a_mm": 0, "alpha_deg": -90, "d_mm": 0, "theta_deg": 0, "lower_deg": -100, "upper_deg": 100},
    {"a_mm": 0, "alpha_deg": 90, "d_mm": 100, "theta_deg": 0, "lower_deg": -170, "upper_deg": 170}]})");
  constexpr double quarter = 1.5707963267948966;
  const DhChain<6, ModifiedDh> nominal{{{
      {.d = 0.4},
      {.alpha = -quarter, .d = 0.15},
      {.alpha = quarter, .joint = JointType::prismatic},
      {},
      {.alpha = -quarter},
      {.alpha = quarter, .d = 0.1},
  }}};
  const Framed<DhChain<6, ModifiedDh>> actual(with_geometric_errors(nominal, {}, 2), frame({0.5, 0.2, 1, 0, 0.1, 0}),
                                              frame({0.03, 0.01, 0.02, 0, 0, 0}));
  JointLimits<6> limits;
  limits.lower << -2.6, -1.4, 0.2, -2.9, -1.7, -2.9;
  limits.upper << 2.6, 1.4, 0.7, 2.9, 1.7, 2.9;
  const auto data = measure(actual, sample_joints(limits, 200, 5), {.position = 0.02e-3, .orientation = 0.1e-3}, 6);
  write_dataset(folder / "poses.csv", data);
  std::string text = read_file(folder / "poses.csv");
  write_file(folder / "wrong.csv", text);
  text.replace(text.find("q3_rad"), 6, "q3_m");
  write_file(folder / "poses.csv", text);

  const CommandResult wrong = run(folder, "calibrate", "--robot stanford.json --data wrong.csv");
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_EQ(wrong.errors,
            "calibrate: wrong.csv, line 1: column q3_rad, but joint 3 is prismatic: a length is needed\n");

  const CommandResult done = run(
      folder, "calibrate", "--robot stanford.json --data poses.csv --test-fraction 0.25 --json r.json --save m.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const Json report = Json::parse(read_file(folder / "r.json"));
  EXPECT_EQ(report.at("robot"), "a stanford arm");
  EXPECT_EQ(report.at("test_rows"), 50);
  EXPECT_GT(report.at("stages").at("frames").at("mean_mm"), 0.3);
  EXPECT_LT(report.at("stages").at("geometry").at("mean_mm"), 0.05);
  const auto model = load<6>(folder / "m.json");
  EXPECT_EQ(model.nominal().chain().row(2).joint, JointType::prismatic);
  EXPECT_EQ(model.limits().upper(2), 0.7);
}

/// An arm with joint errors as well, seen from two places.
TEST(Calibrate, TwoStationsThenARemountedArm) {
  const TemporaryFolder folder("calibrate");
  const auto robot = robots::ur10();
  const WithJointErrors<DhChain<6>> off(
      with_geometric_errors(robot.chain, {.length_min = 2e-4, .angle_min = 2e-4, .angle_max = 1e-3}, 4),
      draw_joint_errors(robot.chain, {.gear_ratio = 0, .coupling = 0}, 5));
  JointLimits<6> region;
  region.lower = JointVector<6>(-2, -2.4, 0.4, -2, -1.8, -2);
  region.upper = JointVector<6>(2, -0.6, 2.2, 2, 1.8, 2);
  const Isometry3 tool = frame({0.01, 0.02, 0.12, 0.3, 0, 0});
  const auto seen = [&](const char* name, const Vector6& base, Index n, std::uint64_t seed) {
    write_dataset(folder / name, measure(Framed(off, FrameParameters(base), tool), sample_joints(region, n, seed),
                                         {.position = 0.03e-3, .orientation = 0.1e-3}, seed));
  };
  seen("a.csv", {2.1, -1.3, 0.4, 0.02, -0.03, 2.2}, 150, 1);
  seen("b.csv", {-1, 3, 0.4, 0, 0.1, -1}, 150, 2);
  const Vector6 elsewhere{4, -2, 1, 0.3, 0.2, 0.9};
  seen("few.csv", elsewhere, 6, 3);
  seen("fresh.csv", elsewhere, 100, 4);
  const CommandResult both =
      run(folder, "calibrate", "--robot ur10 --data a.csv b.csv --test-every 5 --json r.json --save m.json --out f");
  ASSERT_EQ(both.exit_code, 0) << both.errors;
  EXPECT_NE(both.output.find("2 stations: one arm, 2 base frames"), std::string::npos) << both.output;
  const Json fitted = Json::parse(read_file(folder / "r.json"));
  EXPECT_EQ(fitted.at("train_rows"), 240);
  const double jointwise = fitted.at("stages").at("jointwise").at("mean_mm");
  EXPECT_LT(jointwise, 0.5 * fitted.at("stages").at("geometry").at("mean_mm").get<double>());
  EXPECT_LT(jointwise, 0.1);
  EXPECT_GE(fitted.at("within_95_percent_ellipsoids"), 0.85);

  const CommandResult moved =
      run(folder, "calibrate",
          "--model m.json --data few.csv --free base --test fresh.csv --save moved.json --json s.json");
  ASSERT_EQ(moved.exit_code, 0) << moved.errors;
  const Json again = Json::parse(read_file(folder / "s.json"));
  EXPECT_GT(again.at("stages").at("as_fitted").at("mean_mm"), 1000);
  EXPECT_LT(again.at("stages").at("reregistered").at("mean_mm"), 0.12);
  EXPECT_LT(again.at("stages").at("reregistered").at("mean_mrad"), 0.4);
  const auto model = load<6>(folder / "moved.json");
  EXPECT_LT((model.nominal().base().translation() - elsewhere.head<3>()).norm(), 2e-3);
  EXPECT_EQ(again.at("probe").at("turned"), false);
  EXPECT_TRUE(again.at("remarks").empty());

  // the probe remounted as well: orientations are turned, positions are not
  const auto remounted = [&](const char* name, Index n, std::uint64_t seed) {
    const Framed turned(off, FrameParameters(elsewhere), tool * frame({0, 0, 0, 1e-3, -1e-3, 0.5e-3}));
    write_dataset(folder / name,
                  measure(turned, sample_joints(region, n, seed), {.position = 0.03e-3, .orientation = 0.1e-3}, seed));
  };
  remounted("turned.csv", 17, 5);
  remounted("turned_fresh.csv", 100, 6);
  const auto register_again = [&](const std::string& free) {
    const CommandResult done =
        run(folder, "calibrate",
            "--model m.json --data turned.csv --test turned_fresh.csv --save moved.json --json s.json --free " + free);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    return std::pair(done.output, Json::parse(read_file(folder / "s.json")));
  };
  const auto [said, noticed] = register_again("base");
  EXPECT_NE(said.find("was the probe remounted?"), std::string::npos) << said;
  EXPECT_EQ(noticed.at("probe").at("turned"), true);
  EXPECT_NEAR(noticed.at("probe").at("by_mrad").at(0).get<double>(), 1, 0.15);
  EXPECT_NEAR(noticed.at("probe").at("by_mrad").at(1).get<double>(), -1, 0.15);
  EXPECT_EQ(noticed.at("remarks").size(), 1U);
  EXPECT_LT(noticed.at("stages").at("reregistered").at("mean_mm"), 0.12);
  EXPECT_LT(noticed.at("stages").at("reregistered").at("mean_mrad"), 0.4);  // the rotation taken off
  const auto [of_tool, tool_moved] = register_again("base,another-tool");
  EXPECT_EQ(of_tool.find("remounted"), std::string::npos) << of_tool;
  EXPECT_NEAR(tool_moved.at("tool_change_m_rad").at(3).get<double>(), 1e-3, 0.15e-3);
}

TEST(Calibrate, DistancesBesidePosesAndTunedPriors) {
  const TemporaryFolder folder("calibrate");
  const auto arm = actual_arm();
  const auto region = abb_irb120_operating_region();
  const DhChain<6> chain = robots::abb_irb120().chain;
  write_dataset(folder / "poses.csv", measured(60, 1, false));
  const auto wire = measure_distances(arm, Vector3(2, 0.5, 1), region.sample(chain, 100, 2), 0.03e-3, 3);
  std::string text = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,distance_mm\n";
  for (Index i = 0; i < wire.size(); ++i) {
    for (int j = 0; j < 6; ++j) text += message(wire.joints()(i, j), ',');
    text += message(wire.length(i) * 1e3, '\n');
  }
  write_file(folder / "wire.csv", text);
  const auto geometry = [&](const std::string& options) {
    const CommandResult done =
        run(folder, "calibrate",
            "--robot abb_irb120 --data poses.csv --test-every 5 --harmonics 5 --json r.json --out f " + options);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_EQ(done.output.find("100 measurements (distances) to learn from") != std::string::npos,
              options.find("wire") != std::string::npos);
    return Json::parse(read_file(folder / "r.json"));
  };
  const double alone = geometry("").at("stages").at("geometry").at("mean_mm");
  const double both = geometry("--distances wire.csv").at("stages").at("geometry").at("mean_mm");
  EXPECT_LT(both, 1.1 * alone);
  EXPECT_NE(both, alone);
  const Json tuned = geometry("--priors ga");
  EXPECT_LE(tuned.at("stages").at("jointwise").at("mean_mm"), 0.1);
  const CommandResult refused = run(folder, "calibrate", "--robot abb_irb120 --data poses.csv --distances poses.csv");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(refused.one_line_of_errors()) << refused.errors;
  EXPECT_NE(refused.errors.find("no column distance_mm"), std::string::npos) << refused.errors;
  write_file(folder / "metres.csv", vernier_test::replaced(text, "distance_mm", "distance_m"));
  const CommandResult metres = run(folder, "calibrate", "--robot abb_irb120 --data poses.csv --distances metres.csv");
  EXPECT_EQ(metres.exit_code, 1);
  EXPECT_TRUE(metres.one_line_of_errors()) << metres.errors;
  EXPECT_NE(metres.errors.find("metres.csv: no fixed point is consistent"), std::string::npos) << metres.errors;
  const CommandResult both_ways =
      run(folder, "calibrate", "--model m.json --free base --data poses.csv --distances wire.csv");
  EXPECT_EQ(both_ways.exit_code, 2) << both_ways.output;
  EXPECT_TRUE(both_ways.one_line_of_errors()) << both_ways.errors;
}

TEST(Calibrate, FewRowsOfASeededShuffle) {
  const Calibration& c = calibration();
  const auto trained = [&](const std::string& seed) {
    const CommandResult done = run(c.folder, "calibrate",
                                   "--robot abb_irb120 --data poses.csv --split time --train 60 "
                                   "--json few.json --out few --seed " +
                                       seed);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    return Json::parse(read_file(c.folder / "few.json"));
  };
  const Json one = trained("1"), again = trained("1"), two = trained("2");
  EXPECT_EQ(one.at("train_rows"), 60);
  EXPECT_EQ(one.at("test_rows"), 30);
  EXPECT_EQ(one, again);
  EXPECT_NE(one.at("stages").at("geometry"), two.at("stages").at("geometry"));
}

/// What `--test-every 5` gives on a measured robot.
Json measured_robot(const std::string& robot, const std::string& file) {
  const char* data = std::getenv("VERNIER_DATA_DIR");
  if (data == nullptr || *data == '\0') return {};
  const TemporaryFolder folder("calibrate");
  const CommandResult done = run(folder, "calibrate",
                                 "--robot " + robot + " --data '" + std::string(data) + "/" + file +
                                     "' --test-every 5 --json r.json --report r.html");
  EXPECT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_LE(std::filesystem::file_size(folder / "r.html"), 600000u);
  return Json::parse(read_file(folder / "r.json")).at("stages");
}

TEST(CalibrateMeasured, Ur5) {
  const Json stages = measured_robot("ur5", "ur5_grid.csv");
  if (stages.is_null()) GTEST_SKIP() << "VERNIER_DATA_DIR names no folder of measured poses";
  const double geometry = stages.at("geometry").at("mean_mm");
  EXPECT_LE(geometry, 0.105);
  EXPECT_LE(stages.at("approach").at("mean_mm"), 0.047);
  EXPECT_LE(stages.at("geometry_pso_elm").at("mean_mm"), 1.02 * geometry);
}

TEST(CalibrateMeasured, BarrettWam) {
  const Json stages = measured_robot("barrett_wam", "wam_grid.csv");
  if (stages.is_null()) GTEST_SKIP() << "VERNIER_DATA_DIR names no folder of measured poses";
  const double geometry = stages.at("geometry").at("mean_mm");
  EXPECT_LE(geometry, 2.2);
  EXPECT_LE(stages.at("geometry_pso_elm").at("mean_mm"), 1.02 * geometry);
  EXPECT_LE(stages.at("approach").at("mean_mm"), 1.55);
  EXPECT_LE(stages.at("tilt").at("mean_mm"), 1.4);
}

}  // namespace
}  // namespace vernier::calibrate_test
