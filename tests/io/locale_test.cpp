// SPDX-License-Identifier: BSD-3-Clause
// Sentences, JSON, CSV, HTML, C and what is read have the same bits under any locale of the host program.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "foreign_locale.hpp"
#include "temporary_folder.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/io.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/registration/reregister.hpp"
#include "vernier/robot_programs/correct_program.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::locale_test {
namespace {

using vernier_test::ForeignLocale;
using vernier_test::TemporaryFolder;
using Chain = DhChain<6>;

const Robot<6> robot = robots::abb_irb120();

Dataset<6> measured(Index n, std::uint64_t seed) {
  const Framed<Chain> actual(with_geometric_errors(robot.chain, {}, 4),
                             FrameParameters(Vector6{1234.5e-3, -1, 0.5, 0.1, -0.2, 1.5}),
                             FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}));
  return measure(actual, abb_irb120_operating_region().sample(robot.chain, n, seed),
                 {.position = 0.03e-3, .orientation = 0.1e-3}, seed);
}

/// A calibration, made before any locale is set.
struct Made {
  Dataset<6> data = measured(80, 1), fresh = measured(20, 2);
  Calibration<Chain> calibration =
      calibrate(robot.chain, data, {.errors = {.harmonics = 0}, .remainder = {.learners = {Learner::ridge_elm}}});
  CalibratedRobot<6> arm = calibrated_robot(calibration, {.name = "arm", .limits = robot.limits});
};

/// All that the library writes about it, by kind.
std::map<std::string, std::string> texts_of(const Made& made) {
  std::map<std::string, std::string> out;
  const CalibrationReport report = evaluate(made.calibration, made.fresh, robot.limits);
  out["summary of a calibration"] = report.summary();
  out["results as JSON"] = to_json(report, "arm").dump();
  ReportInput page = report_input(report, "arm");
  page.provenance.inputs = {{"poses.csv", 12345, "hash"}};
  out["HTML"] = report_html(page);
  out["audit"] = audit_data(robot.chain, made.data).summary();
  out["identification"] = identify(robot.chain, made.data, {.frames = Frames::base_and_tool}, {}, own_solver).summary();
  const auto check = verify_calibration(made.arm.model(), *made.arm.estimate(), made.fresh, {.accept = 1.5e-3});
  out["summary of a check"] = check.summary() + stage_table(stages_of(check));
  out["check as JSON"] = to_json(check, "arm").dump();
  out["HTML of a check"] = report_html(report_input(check, "arm"));
  out["registration"] = reregister(made.arm.model(), made.fresh, {.tool = true, .offsets = true}).summary();
  Isometry3 far = robot.chain.pose(JointVector<6>::Zero());
  far.translation() += Vector3(1.2345, 0, 0);
  out["branches"] = all_branches(ClosedForm<6>(robot.chain), robot.chain, far).describe();
  out["C"] = c_source(made.arm, {.hash = "hash"});

  const TemporaryFolder folder("locale");
  write_dataset(folder / "poses.csv", made.data);
  out["CSV"] = read_file(folder / "poses.csv");
  out["hash of the model"] = save(folder / "model.json", made.arm);
  out["model"] = read_file(folder / "model.json");
  write_dataset(folder / "again.csv", read_dataset<6>(folder / "poses.csv"));
  out["CSV that was read"] = read_file(folder / "again.csv");
  (void)save(folder / "again.json", load<6>(folder / "model.json"));
  out["model that was read"] = read_file(folder / "again.json");
  write_file(folder / "robot.json", R"({"name": "a", "convention": "standard", "joints": [
    {"a_mm": 1234.5, "alpha_deg": -90.25, "d_mm": 0.125, "theta_deg": 0}, {"a_mm": 1, "alpha_deg": 0, "d_mm": 0,
    "theta_deg": 0}, {"a_mm": 1, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0}]})");
  const DhRow row = load_robot(folder / "robot.json").rows[0];
  out["robot that was read"] = message(row.a, ' ', row.alpha, ' ', row.d);
  try {
    write_file(folder / "bad.csv", "q1_rad,x_mm,y_mm,z_mm\n0.5,1234.5,1,1,1\n");
    (void)read_dataset<1>(folder / "bad.csv");
  } catch (const DataError& e) {
    out["message"] = std::string(e.what()).substr(folder.path().string().size());
  }
  const std::string text = "movej([0.1,-1.2345,1.5,-1.0,-1.2,0.3], a=1.4, v=1.05)\n";
  const RobotProgram program = parse_program(ProgramLanguage::urscript, text, "p.script");
  out["robot program"] = replace_targets(text, program, correct_program(program, made.arm).replaced());
  return out;
}

TEST(Locale, ChangesNoBit) {
  const Made made;
  const auto expected = texts_of(made);
  const ForeignLocale locale;
  std::ostringstream host;
  host << 1234.5;
  ASSERT_EQ(host.str(), "1.234,5") << "the host program has another locale";
  const auto under_locale = texts_of(made);
  ASSERT_EQ(under_locale.size(), expected.size());
  for (const auto& [kind, text] : expected) {
    EXPECT_FALSE(text.empty()) << kind;
    EXPECT_TRUE(under_locale.at(kind) == text) << kind << "\n" << under_locale.at(kind).substr(0, 2000);
  }
  RecordProperty("printf_has_commas", ForeignLocale::of_c() ? "yes" : "no");
}

}  // namespace
}  // namespace vernier::locale_test
