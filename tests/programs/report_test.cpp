// SPDX-License-Identifier: BSD-3-Clause
// calibrate --report and the yearly check, on simulated measurements.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::report_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

CommandResult run(const TemporaryFolder& folder, const std::string& program, const std::string& arguments) {
  return vernier_test::run_command(
      "cd '" + folder.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + program + "' " + arguments,
      folder.path());
}

/// An IRB 120 with geometric errors and zeros that moved by so much.
Framed<DhChain<6>> arm(const JointVector<6>& zeros = JointVector<6>::Zero()) {
  auto p = with_geometric_errors(robots::abb_irb120().chain, {}, 7).parameters();
  for (int i = 0; i < 6; ++i) p(5 * i + 3) += zeros(i);
  return Framed<DhChain<6>>(robots::abb_irb120().chain.with_parameters(p),
                            FrameParameters(Vector6{2.1, -1.3, 0.4, 0.02, -0.03, 2.2}),
                            FrameParameters(Vector6{0.01, 0.02, 0.12, 0.3, 0, 0}));
}

Dataset<6> seen(const Framed<DhChain<6>>& actual, Index n, std::uint64_t seed) {
  const JointRows<6> joints = abb_irb120_operating_region().sample(robots::abb_irb120().chain, n, seed);
  return measure(actual, joints, {.position = 0.03e-3, .orientation = 0.1e-3}, seed);
}

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return "";
  return text.substr(begin + from.size(), text.find(to, begin + from.size()) - begin - from.size());
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// One calibration of an arm with a harmful name, which several tests look at.
struct Reported {
  TemporaryFolder folder{"report"};
  CommandResult command;
  std::string page;

  Reported() {
    write_dataset(folder / "poses.csv", seen(arm(), 150, 1));
    Json robot{{"name", "<script>alert(1)</script>"}, {"convention", "standard"}, {"joints", Json::array()}};
    const DhChain<6> chain = robots::abb_irb120().chain;
    for (int i = 0; i < 6; ++i)
      robot["joints"].push_back({{"a_mm", chain.row(i).a * 1e3},
                                 {"alpha_rad", chain.row(i).alpha},
                                 {"d_mm", chain.row(i).d * 1e3},
                                 {"theta_rad", chain.row(i).theta}});
    write_file(folder / "robot.json", robot.dump());
    command = calibrate("page.html");
    if (command.exit_code == 0) page = read_file(folder / "page.html");
  }
  CommandResult calibrate(const std::string& page_name) const {
    return run(folder, "calibrate",
               "--robot robot.json --data poses.csv --save model.json --json report.json --out figures --threads 1 "
               "--date 2024-05-01 --accept-mm 0.2 --report " +
                   page_name);
  }
};
const Reported& reported() {
  static const Reported made;
  return made;
}

TEST(Report, SaysWhatTheJsonSays) {
  const Reported& r = reported();
  ASSERT_EQ(r.command.exit_code, 0) << r.command.errors;
  EXPECT_TRUE(has(r.command.output, "Report: page.html"));
  const Json json = Json::parse(read_file(r.folder / "report.json"));
  EXPECT_EQ(Json::parse(between(r.page, "id=\"data\">", "</script>")), json);
  const Json& chosen = json.at("stages").at(json.at("chosen").get<std::string>());
  EXPECT_EQ(std::stod(between(r.page, "data-value=\"", "\"")), chosen.at("mean_mm"));
  EXPECT_TRUE(has(r.page, "Accepted up to 0.2 mm: <strong>yes"));
  EXPECT_TRUE(has(r.page, sha256(read_file(r.folder / "poses.csv"))));
  EXPECT_TRUE(has(r.page, sha256(read_file(r.folder / "model.json"))));
  EXPECT_TRUE(has(r.page, "calibrate --robot robot.json --data poses.csv"));
  // lines of the file: every fifth row is held out
  const Json points = Json::parse(between(r.page, "id=\"points\">", "</script>"));
  ASSERT_EQ(points.at("line").size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(points.at("line").at(i), 5 * i + 2);  // behind the header
  EXPECT_FALSE(has(r.page, "<script>alert"));
  EXPECT_TRUE(has(r.page, "Calibration: &lt;script&gt;alert(1)&lt;/script&gt;"));
}

TEST(Report, SameBitsButForItsName) {
  const Reported& r = reported();
  ASSERT_EQ(r.calibrate("again.html").exit_code, 0);
  std::string again = read_file(r.folder / "again.html");
  const std::size_t at = again.find("again.html");
  ASSERT_NE(at, std::string::npos);
  EXPECT_TRUE(again.replace(at, 10, "page.html") == r.page);
}

/// Runs a program by bash, which gives it pipes: `<(cat poses.csv)`.
CommandResult run_with_pipes(const TemporaryFolder& folder, const std::string& program, const std::string& arguments) {
  write_file(folder / "command.sh", "'" + std::string(VERNIER_EXAMPLES_DIR) + "/" + program + "' " + arguments + "\n");
  return vernier_test::run_command("cd '" + folder.path().string() + "'; bash command.sh", folder.path());
}

// A pipe can be read once; an output may be a pipe, too, and an input may be replaced by an output.
TEST(Report, HashesAreOfTheBytesThatWereReadAndWritten) {
  const TemporaryFolder folder("report_pipes");
  const Reported& r = reported();
  for (const char* file : {"robot.json", "poses.csv", "model.json"})
    std::filesystem::copy_file(r.folder / file, folder / file);
  write_dataset(folder / "fresh.csv", seen(arm(), 30, 2));
  std::string wire = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,distance_mm\n";
  const auto poses = read_dataset<6>(folder / "poses.csv");
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 0; j < 6; ++j) wire += message(poses.joints()(i, j), ',');
    wire += message(1e3 * (point(poses.positions(), i) - Vector3(1, 1, 0)).norm(), '\n');
  }
  write_file(folder / "wire.csv", wire);
  const std::string prior = read_file(folder / "model.json");
  const CommandResult result =
      run_with_pipes(folder, "calibrate",
                     "--robot <(cat robot.json) --data <(cat poses.csv) --test <(cat fresh.csv) --distances <(cat "
                     "wire.csv) --prior model.json --save model.json --report page.html --out figures --harmonics 0");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_file(folder / "page.html");
  for (const char* file : {"robot.json", "poses.csv", "fresh.csv", "wire.csv", "model.json"})
    EXPECT_TRUE(has(page, sha256(read_file(folder / file)))) << file;
  EXPECT_NE(read_file(folder / "model.json"), prior);
  EXPECT_TRUE(has(page, sha256(prior))) << "the earlier model, before it was replaced";
  EXPECT_FALSE(has(page, sha256("")));

  const CommandResult through = run_with_pipes(
      folder, "calibrate",
      "--robot robot.json --data <(cat poses.csv) --save - --report page.html --out figures --harmonics 0 >saved.json");
  ASSERT_EQ(through.exit_code, 0) << through.errors;
  EXPECT_TRUE(
      has(read_file(folder / "page.html"), "standard output, SHA-256 " + sha256(read_file(folder / "saved.json"))));
  EXPECT_TRUE(read_model(folder / "saved.json").provenance().data_file.starts_with("/dev/fd/"));

  const CommandResult check = run_with_pipes(folder, "verify_calibration",
                                             "--model <(cat model.json) --data <(cat fresh.csv) --report check.html");
  EXPECT_EQ(check.errors, "");
  for (const char* file : {"model.json", "fresh.csv"})
    EXPECT_TRUE(has(read_file(folder / "check.html"), sha256(read_file(folder / file)))) << file;
}

TEST(Report, RefusesWrongUsage) {
  const Reported& r = reported();
  const CommandResult alone = run(r.folder, "calibrate", "--robot robot.json --data poses.csv --accept-mm 0.2");
  EXPECT_EQ(alone.exit_code, 2) << alone.errors;
  const CommandResult folder = run(r.folder, "calibrate", "--robot robot.json --data poses.csv --report figures");
  EXPECT_EQ(folder.exit_code, 1);
  EXPECT_TRUE(folder.one_line_of_errors()) << folder.errors;
}

TEST(VerifyCalibrationProgram, AnUnchangedArmIsValidWhereverItStands) {
  const Reported& r = reported();
  const Framed<DhChain<6>> same = arm(),
                           elsewhere(same.model(), FrameParameters(Vector6{0.3, 1.2, -0.4, 0.1, 0.2, 1}).isometry(),
                                     same.tool());
  write_dataset(r.folder / "check.csv", seen(elsewhere, 25, 31));
  const CommandResult checked =
      run(r.folder, "verify_calibration",
          "--model model.json --data check.csv --json check.json --report check.html --date 2025-05-01");
  EXPECT_EQ(checked.exit_code, 0) << checked.output << checked.errors;
  EXPECT_TRUE(has(checked.output, "The calibration is still valid: errors are as predicted (chi-square "));
  EXPECT_TRUE(has(checked.output, "Base moved by"));
  EXPECT_TRUE(has(checked.output, "calibrate --model MODEL --free base"));
  const Json json = Json::parse(read_file(r.folder / "check.json"));
  EXPECT_EQ(json.at("valid"), true);
  EXPECT_EQ(json.at("dof"), 6 * 25 - 6);
  EXPECT_FALSE(json.at("registration").is_null());
  const std::string page = read_file(r.folder / "check.html");
  EXPECT_EQ(Json::parse(between(page, "id=\"data\">", "</script>")), json);
  EXPECT_TRUE(has(page, "The calibration is still valid"));
  EXPECT_TRUE(has(page, "Joint by joint"));
  EXPECT_FALSE(has(page, "<script>alert"));
  // where it stands is not where it stood
  const CommandResult held = run(r.folder, "verify_calibration", "--model model.json --data check.csv --registered");
  EXPECT_EQ(held.exit_code, 1);
  EXPECT_EQ(held.errors, "");
  EXPECT_TRUE(has(held.output, "The calibration is no longer valid"));
}

TEST(VerifyCalibrationProgram, TheFileOfTheCalibrationConfirmsNothing) {
  const Reported& r = reported();
  const CommandResult checked = run(r.folder, "verify_calibration", "--model model.json --data poses.csv");
  // every fifth was held out
  EXPECT_TRUE(has(checked.output, "120 poses that it was fitted to are left out.")) << checked.output << checked.errors;
  EXPECT_TRUE(has(checked.output, "30 poses of poses.csv"));
  write_dataset(r.folder / "fresh.csv", seen(arm(), 25, 34));
  const CommandResult fresh = run(r.folder, "verify_calibration", "--model model.json --data fresh.csv");
  EXPECT_FALSE(has(fresh.output, "confirms nothing")) << fresh.output;
}

// In another order, in other units, cut: poses of the fit are recognised.
TEST(VerifyCalibrationProgram, RowsOfTheCalibrationConfirmNothingInWhicheverFile) {
  const Reported& r = reported();
  const auto poses = read_dataset<6>(r.folder / "poses.csv");
  std::vector<Index> fitted;
  for (Index i = poses.size(); i-- > 0;)
    if (i % 5 != 0) fitted.push_back(i);
  std::string text = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm\n";
  for (const Index i : fitted) {
    for (const double q : poses.joints(i)) text += message(q * (180 / std::numbers::pi), ',');
    const Vector3 at = poses.position(i) * 1e3;
    text += message(at.x(), ',', at.y(), ',', at.z(), '\n');
  }
  write_file(r.folder / "other_units.csv", text);
  fitted.resize(25);
  write_dataset(r.folder / "some.csv", poses.rows(fitted));
  for (const char* file : {"other_units.csv", "some.csv"}) {
    const CommandResult checked =
        run(r.folder, "verify_calibration", message("--positions-only --model model.json --data ", file));
    EXPECT_TRUE(has(checked.output, "The poses are those that it was fitted to, so that this confirms nothing."))
        << checked.output << checked.errors;
  }
}

// The fit joins readings of one pose; the file has them one by one.
TEST(VerifyCalibrationProgram, ReadingsOfOnePoseAreRecognisedEach) {
  const Reported& r = reported();
  const auto once = seen(arm(), 100, 41);
  PointRows positions(200, 3);
  JointRows<6> joints(200, 6);
  for (Index i = 0; i < 100; ++i)
    for (Index reading = 0; reading < 2; ++reading) {
      joints.row(2 * i + reading) = once.joints().row(i);
      const Vector3 moved(1e-5 * static_cast<double>(reading), 0, 0);
      set_point(positions, 2 * i + reading, Vector3(once.position(i) + moved));
    }
  write_dataset(r.folder / "twice.csv", Dataset<6>(joints, positions));
  ASSERT_EQ(run(r.folder, "calibrate",
                "--robot robot.json --data twice.csv --save twice.json --out figures --threads 1 --harmonics 0")
                .exit_code,
            0);
  const CommandResult checked = run(r.folder, "verify_calibration", "--model twice.json --data twice.csv");
  EXPECT_TRUE(has(checked.output, "160 poses that it was fitted to are left out.")) << checked.output << checked.errors;
}

TEST(VerifyCalibrationProgram, NamesTheJointWhoseZeroMoved) {
  const Reported& r = reported();
  write_dataset(r.folder / "moved.csv", seen(arm(0.3e-3 * JointVector<6>::Unit(2)), 25, 32));
  const CommandResult checked =
      run(r.folder, "verify_calibration", "--model model.json --data moved.csv --json moved.json");
  EXPECT_EQ(checked.exit_code, 1) << checked.output;
  EXPECT_EQ(checked.errors, "");
  EXPECT_TRUE(has(checked.output, "no longer valid: the zero of joint 3 moved by")) << checked.output;
  EXPECT_TRUE(has(checked.output, "--free base,offsets"));
  const Json joint = Json::parse(read_file(r.folder / "moved.json")).at("joints").at(2);
  EXPECT_EQ(joint.at("zero_changed"), true);
  EXPECT_NEAR(joint.at("zero_change"), 0.3, 0.1);
  const CommandResult loose =
      run(r.folder, "verify_calibration", "--model model.json --data moved.csv --accept-mm 0.5");
  EXPECT_EQ(loose.exit_code, 0) << loose.output;
}

TEST(VerifyCalibrationProgram, RefusesWhatItCannotCheck) {
  const Reported& r = reported();
  write_dataset(r.folder / "two.csv", seen(arm(), 2, 33));
  const CommandResult few = run(r.folder, "verify_calibration", "--model model.json --data two.csv");
  EXPECT_EQ(few.exit_code, 1);
  EXPECT_TRUE(few.one_line_of_errors()) << few.errors;
  EXPECT_TRUE(has(few.errors, "2 poses, at least 3 are needed")) << few.errors;
  const CommandResult both =
      run(r.folder, "verify_calibration", "--model model.json --data poses.csv --registered --tool-remounted");
  EXPECT_EQ(both.exit_code, 2);
  const CommandResult none = run(r.folder, "verify_calibration", "--model nowhere.json --data poses.csv");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_TRUE(none.one_line_of_errors()) << none.errors;
}

}  // namespace
}  // namespace vernier::report_test
