// SPDX-License-Identifier: BSD-3-Clause
// Rules of the files that are read and written, one by one: limits, options and what a model file says.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "json_parts.hpp"
#include "temporary_folder.hpp"
#include "ur_published.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/io/json.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/io/ur_calibration.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::file_rules_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::complaint;

class FileRules : public ::testing::Test {
 protected:
  std::string file(const std::string& text) const {
    write_file(path_, text);
    return path_;
  }
  /// What is said of a file, without its name.
  template <class Read>
  std::string refused(const std::string& text, const Read& read) const {
    const std::string told = complaint([&] { (void)read(file(text)); });
    return told.empty() ? "" : told.substr(std::min(told.size(), path_.size() + 2));
  }

  vernier_test::TemporaryFolder folder_{"file_rules"};
  std::string path_ = (folder_ / "f").string();
};

/// A robot of three joints, some keys of its second joint replaced or added.
std::string robot_text(const Json& changes) {
  const Json row{{"a_mm", 100}, {"alpha_deg", 90}, {"d_mm", 10}, {"theta_deg", 0}};
  Json changed = row;
  changed.update(changes);
  return Json{{"name", "arm"}, {"convention", "standard"}, {"joints", {row, changed, row}}}.dump();
}

TEST_F(FileRules, JointsOfRobots) {
  const auto told = [&](const Json& changes) {
    return refused(robot_text(changes), [](const std::string& path) { return load_robot(path); });
  };
  EXPECT_EQ(told(Json::object()), "");
  EXPECT_EQ(told({{"a_mm", -100001}}), "joints[1]: a length of -100.001 m; is the unit right?");
  EXPECT_EQ(told({{"d_mm", 100001}}), "joints[1]: a length of 100.001 m; is the unit right?");
  EXPECT_EQ(told({{"d_mm", 99999}}), "");
  for (const char* angle : {"alpha_deg", "theta_deg", "beta_deg"}) {
    EXPECT_NE(told({{angle, 6000}}).find("joints[1]: an angle of 104.7"), std::string::npos) << angle;
    EXPECT_EQ(told({{angle, 5000}}), "") << angle;
  }
  EXPECT_EQ(told({{"gear_ratio", 0.5}}), "joints[1].gear_ratio: must be at least 1");
  EXPECT_EQ(told({{"gear_ratio", 1}}), "");
  EXPECT_EQ(told({{"encoder_periods", 0}}), "joints[1].encoder_periods: must lie in 1..100000");
  EXPECT_EQ(told({{"type", "prismatic"}, {"gear_ratio", 100}}),
            "joints[1]: gear_ratio and encoder_periods are those of a revolute joint");
  EXPECT_EQ(told({{"lower_deg", 10}, {"upper_deg", 10}}).substr(0, 27), "joints[1]: lower limit 0.17");
  const RobotDescription robot = load_robot(file(robot_text({{"gear_ratio", 101}, {"encoder_periods", 128}})));
  EXPECT_EQ(robot.drives[1].gear_ratio, 101);
  EXPECT_EQ(robot.drives[1].encoder_periods, 128);
  EXPECT_EQ(robot.drives[0], JointDrive{});
}

// The first row of a modified chain moves its base, behind the base that the arm stands on.
TEST_F(FileRules, AModifiedChainStandsOnItsBase) {
  Json text = Json::parse(robot_text({{"a_mm", 50}, {"theta_deg", 20}}));
  text["convention"] = "modified";
  RobotDescription robot = load_robot(file(text.dump()));
  robot.base = rigid_motion(exp_so3(Vector3(0.4, -0.3, 0.2)), Vector3(1, 2, 3));
  std::array<DhRow, 3> rows{};
  std::copy(robot.rows.begin(), robot.rows.end(), rows.begin());
  const JointVector<3> q(0.1, -0.7, 1.2);
  MatrixX joints(1, 3);
  for (Index j = 0; j < 3; ++j) joints(0, j) = q(j);
  const Isometry3 expected = robot.base * DhChain<3, ModifiedDh>::from_rows(rows).pose(q);
  EXPECT_LT((robot.geometry().poses(joints).front().matrix() - expected.matrix()).norm(), 1e-13);
}

TEST_F(FileRules, FactoryCalibrations) {
  const RobotDescription nominal = RobotDescription::of(robots::ur10());
  const auto conf = [](const std::string& theta, const std::string& d) {
    return "[mounting]\ndelta_theta = " + theta + "\ndelta_a = [0, 0, 0, 0, 0, 0]\ndelta_d = " + d +
           " # by the controller\ndelta_alpha = [0, 0, 0, 0, 0, 0]\n";
  };
  const auto told = [&](const std::string& text) {
    return refused(text, [&](const std::string& path) { return read_ur_calibration(path, nominal); });
  };
  const std::string none = "[0, 0, 0, 0, 0, 0]";
  EXPECT_EQ(told(conf(none, none)), "");
  // an arm as it was made is off by millimetres: a tenth of a metre or three tenths of a radian is another arm
  EXPECT_EQ(told(conf(none, "[0.09, 0, 0, 0, 0, 0]")), "");
  EXPECT_NE(told(conf(none, "[0.11, 0, 0, 0, 0, 0]")).find("d1 becomes"), std::string::npos);
  EXPECT_EQ(told(conf("[0, 0, 0, 0, 0, -0.29]", none)), "");
  EXPECT_NE(told(conf("[0, 0, 0, 0, 0, -0.31]", none)).find("theta6 becomes"), std::string::npos);
  EXPECT_NE(told(conf("[0, 0, -1e6, 0, 0, 0]", none)).find("-1e+06 is beyond any length or angle"), std::string::npos);
  RobotDescription bent = nominal;
  bent.rows[1].beta = 1e-3;
  EXPECT_NE(complaint([&] { (void)read_ur_calibration(file(conf(none, none)), bent); }).find("without beta"),
            std::string::npos);
  // whole turns of a design stay
  RobotDescription turned = nominal;
  turned.rows[5].theta += 2 * std::numbers::pi;
  EXPECT_NEAR(read_ur_calibration(file(conf(none, none)), turned).rows[5].theta, turned.rows[5].theta, 1e-14);
}

TEST_F(FileRules, JsonValues) {
  const auto told = [](const std::string& text, const auto& use) {
    return complaint([&] {
      const nlohmann::json document = parse_json(text, "f");
      (void)use(JsonNode(document, "f").at("a"));
    });
  };
  const auto number = [](const JsonNode& node) { return node.number(); };
  for (const char* large : {"2e9", "-2e9"})
    EXPECT_NE(told(std::string("{\"a\": ") + large + "}", number).find("is beyond any angle or length (1e9)"),
              std::string::npos);
  EXPECT_EQ(told("{\"a\": -1e9}", number), "");
  const auto integer = [](const JsonNode& node) { return node.integer(-3, 3); };
  for (const char* outside : {"4", "-4", "18446744073709551615"})
    EXPECT_EQ(told(std::string("{\"a\": ") + outside + "}", integer), "f: a: must lie in -3..3");
  EXPECT_EQ(told("{\"a\": 3}", integer) + told("{\"a\": -3}", integer), "");
  EXPECT_EQ(told("{\"a\": 3.0}", integer), "f: a: must be a whole number, is a number");
  const auto text = [](const JsonNode& node) { return node.text(3); };
  EXPECT_EQ(told("{\"a\": \"abc\"}", text), "");
  EXPECT_EQ(told("{\"a\": \"abcd\"}", text), "f: a: must have 1 to 3 characters, has 4");
  EXPECT_EQ(told("{\"a\": \"\"}", text), "f: a: must have 1 to 3 characters, has 0");
  for (const char* control : {"{\"a\": \"a\x7f\"}", "{\"a\": \"\\u001f\"}"})
    EXPECT_EQ(told(control, text), "f: a: has a character that cannot be printed");
  EXPECT_EQ(told("{\"a\": \"x\"}", [](const JsonNode& node) { return node.at("b"); }),
            "f: a: must be an object, is a text");
  const auto entry = [](std::size_t index) {
    return [index](const JsonNode& node) { return node.at(index).number(); };
  };
  EXPECT_EQ(told("{\"a\": [1, 2]}", entry(1)), "");
  EXPECT_EQ(told("{\"a\": [1, 2]}", entry(2)), "f: a: has 2 entries, entry 2 is missing");
  EXPECT_EQ(told("{\"a\": [1, \"x\"]}", entry(1)), "f: a[1]: must be a number, is a text");
  // lengths and angles in either unit, in digits that a compiled table has
  const nlohmann::json units =
      nlohmann::json::parse(R"({"a_mm": 612.7, "b_m": 0.6127, "c_deg": 90, "d_rad": 1.5, "e_mm": 1, "e_m": 1})");
  const JsonNode node(units, "f");
  EXPECT_EQ(node.length("a"), 0.6127);
  EXPECT_EQ(node.length("b"), 0.6127);
  EXPECT_EQ(node.angle("c"), std::numbers::pi / 2);
  EXPECT_EQ(node.angle("d"), 1.5);
  EXPECT_EQ(complaint([&] { (void)node.length("e"); }), "f: keys 'e_mm' and 'e_m' both give e");
  // where the text is wrong
  const auto where = [](const std::string& wrong) { return complaint([&] { (void)parse_json(wrong, "f"); }); };
  EXPECT_EQ(where("}"), "f, line 1, column 1: not valid JSON");
  EXPECT_EQ(where("\n}"), "f, line 2, column 1: not valid JSON");
  EXPECT_EQ(where("{\n  }}"), "f, line 2, column 4: not valid JSON");
}

using Model = CalibratedRobot<6>::Model;

// What is not the default: it stands in the file, and comes back.
TEST_F(FileRules, ModelsSayWhatTheyAre) {
  const auto robot = robots::abb_irb120();
  JointTerms terms(6);
  terms.transmission[1] = Fourier::up_to(2);
  const Model::Arm arm({robot.chain, JointErrors(terms, VectorX::Constant(terms.size(), 1e-4))});
  JointCoverage<6> gate;
  gate.margin.setConstant(0.5);
  for (auto& ranges : gate.ranges) ranges = {{-1, 1}};
  gate.ranges[3] = {{0.25, 0.25}};  // a joint held still
  gate.periodic[5] = true;
  const HiddenLayer layer{.nodes = 4,
                          .activation = Activation::sine,
                          .input_map = InputMap::raw,
                          .input_scaling = Scaling::standard,
                          .weight_limit = 2.5};
  const Eigen::Matrix<double, Eigen::Dynamic, 3> beta = Eigen::Matrix<double, Eigen::Dynamic, 3>::Constant(4, 3, 1e-4);
  const ElmPredictor<6, 3> network(layer, {VectorX::Zero(6), VectorX::Ones(6)}, layer.draw(6, 2), beta,
                                   Vector3(1e-4, 2e-4, 3e-4));
  Provenance from{"poses.csv", 30, "2024-05-01", "encoder", "positions", 1e-5, 2e-5, 3e-5};
  for (int file = 0; file < 40; ++file) {  // of a calibration from many files
    from.data_file += message(",session_", file, ".csv");
    from.data_sha256 += (file > 0 ? "," : "") + std::string(64, 'a');
  }
  std::vector<std::uint32_t> rows{0, 4294967295u};
  for (std::uint32_t i = 1; i < 3000; ++i) rows.push_back(i * 1000003u);
  from.fitted_rows = RowFingerprints(std::move(rows));
  const CalibratedRobot<6> plain(
      "arm",
      Model(robot.chain, arm, Model::Arm(robot.chain), gate).with_thermal({22, 20, 24, VectorX::Constant(42, 1e-6)}),
      robot.limits, from);
  ErrorModelEstimate estimate{.arm = detail::parameterised(FittedArm::of(arm), {{7, -1, 1e-3, 1}},
                                                           VectorX::Ones(terms.size()), VectorX::Ones(terms.size()),
                                                           VectorX())};
  estimate.covariance = MatrixX::Identity(terms.size() + 1, terms.size() + 1);
  save(path_, plain.with_estimate(estimate).with_learned(network, gate));
  const Json json = Json::parse(read_file(path_));
  vernier_test::expect_parts(json, R"({
    "learned": {"activation": "sine", "input_map": "raw", "input_scaling": "standard", "weight_limit": 2.5,
                "output_offset_m": [1e-4, 2e-4, 3e-4]},
    "coverage": [{}, {}, {}, {"ranges": [[0.25, 0.25]]}, {"periodic": false}, {"periodic": true}],
    "thermal": {"measured_c": [20, 24], "reference_c": 22},
    "provenance": {"left_out_error_m": 2e-5, "held_out_error_m": 3e-5, "joints": "encoder"},
    "arm": {"joint_errors": {"transmission": [{}, {"orders": [1, 2]}, {}, {}, {}, {}]}}})");

  const auto loaded = load<6>(path_);
  EXPECT_EQ(loaded.provenance(), from);
  EXPECT_EQ(loaded.model().coverage()->periodic, gate.periodic);
  EXPECT_EQ(loaded.model().thermal()->lower, 20);
  EXPECT_EQ(loaded.model().thermal()->upper, 24);
  EXPECT_TRUE(loaded.estimate()->converged);
  // whose errors are not known does not say zero
  from.left_out_error = from.held_out_error = 0;
  save(path_, CalibratedRobot<6>("arm", plain.model(), robot.limits, from));
  EXPECT_FALSE(Json::parse(read_file(path_)).at("provenance").contains("left_out_error_m"));
  EXPECT_FALSE(Json::parse(read_file(path_)).at("provenance").contains("held_out_error_m"));
}

// Every parameter and its change with temperature: twice as many unknowns as parameters.
TEST_F(FileRules, EstimatesOfAllParametersAndTheirRates) {
  const auto robot = robots::abb_irb120();
  const Model model = Model(robot.chain, Model::Arm(robot.chain)).with_thermal({22, 20, 24, VectorX::Zero(42)});
  std::vector<GeometricUnknown> unknowns;
  for (Index k = 0; k < 42; ++k) {
    unknowns.push_back({k, -1, 1e-3, 4});
    unknowns.push_back({k, -1, 1e-4, 0, true});
  }
  ErrorModelEstimate estimate{.arm = detail::parameterised(FittedArm::of(model.identified()), unknowns, VectorX(0),
                                                           VectorX(0), model.thermal()->parameters)};
  ASSERT_EQ(estimate.arm.size(), 84);
  estimate.covariance = MatrixX::Identity(84, 84);
  save(path_, CalibratedRobot<6>("arm", model, robot.limits, {}).with_estimate(estimate));
  const Json json = Json::parse(read_file(path_)).at("estimate").at("geometric");
  ASSERT_EQ(json.size(), 84u);
  EXPECT_EQ(json.at(0).at("prior_std"), 0.5);  // a precision of 4
  EXPECT_EQ(json.at(1).at("prior_std"), 0);
  EXPECT_EQ(json.at(1).at("per_kelvin"), true);
  EXPECT_FALSE(json.at(0).contains("per_kelvin"));
  const auto loaded = load<6>(path_);
  EXPECT_EQ(loaded.estimate()->arm.size(), 84);
  EXPECT_EQ(loaded.estimate()->covariance, estimate.covariance);
}

TEST_F(FileRules, EstimatesWithoutUnknowns) {
  const auto robot = robots::abb_irb120();
  const Model model(robot.chain, Model::Arm(robot.chain));
  ErrorModelEstimate estimate{
      .arm = detail::parameterised(FittedArm::of(model.identified()), {}, VectorX(0), VectorX(0), VectorX())};
  estimate.position_sigma = 2e-5;
  save(path_, CalibratedRobot<6>("arm", model, robot.limits, {}).with_estimate(estimate));
  const auto loaded = load<6>(path_);
  ASSERT_TRUE(loaded.estimate());
  EXPECT_EQ(loaded.estimate()->arm.size(), 0);
  EXPECT_EQ(loaded.estimate()->covariance.size(), 0);
  EXPECT_EQ(loaded.estimate()->position_sigma, 2e-5);
}

}  // namespace
}  // namespace vernier::file_rules_test
