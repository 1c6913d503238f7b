// SPDX-License-Identifier: BSD-3-Clause
// Robots read from JSON files.
#include "vernier/io/robot_file.hpp"

#include <gtest/gtest.h>

#include "real_matrix.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::robot_file_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

class RobotFile : public ::testing::Test {
 protected:
  RobotDescription load(const std::string& text) const {
    write_file(path_, text);
    return load_robot(path_);
  }
  std::string complaint(const std::string& text) const {
    try {
      load(text);
    } catch (const DataError& e) {
      return e.what();
    }
    return "none";
  }
  vernier_test::TemporaryFolder folder_{"robot_file"};
  std::filesystem::path path_ = folder_ / "robot.json";
};

const std::string irb120 = R"({"name": "my irb120", "convention": "standard", "joints": [
  {"type": "revolute", "a_mm": 0,   "alpha_deg": -90, "d_mm": 290, "theta_deg": 0,   "lower_deg": -165, "upper_deg": 165},
  {"type": "revolute", "a_mm": 270, "alpha_deg": 0,   "d_mm": 0,   "theta_deg": -90, "lower_deg": -110, "upper_deg": 110},
  {"a_mm": 70,  "alpha_deg": -90, "d_mm": 0,   "theta_deg": 0,   "lower_deg": -110, "upper_deg": 70},
  {"a_mm": 0,   "alpha_deg": 90,  "d_mm": 302, "theta_deg": 0,   "lower_deg": -160, "upper_deg": 160},
  {"a_mm": 0,   "alpha_deg": -90, "d_m": 0,    "theta_rad": 0,   "lower_deg": -120, "upper_deg": 120},
  {"a_mm": 0,   "alpha_deg": 0,   "d_mm": 72,  "theta_deg": 180}]})";

TEST_F(RobotFile, ATableInAFileEqualsTheCatalogue) {
  const RobotDescription robot = load(irb120);
  ASSERT_EQ(robot.dof(), 6);
  const DescribedRobot<6> described = robot.arm<6>();
  EXPECT_EQ(described.name, "my irb120");
  ASSERT_EQ(robot.files.size(), 1u);
  EXPECT_EQ(robot.files[0].name, path_);
  EXPECT_EQ(robot.files[0].hash, sha256(irb120));
  EXPECT_TRUE(described.arm.model() ==
              robots::abb_irb120().chain);  // bit for bit: units are converted as the literals do
  EXPECT_NEAR(described.limits.upper(2), 70 * 3.14159265358979 / 180, 1e-12);
  EXPECT_EQ(described.limits.upper(5), std::numeric_limits<double>::infinity());
  EXPECT_THROW(robot.arm<7>(), std::invalid_argument);
}

TEST_F(RobotFile, LimitsOfOneSide) {
  const auto limits = load(R"({"name": "p", "convention": "standard", "joints": [
    {"a_mm": 10, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "lower_deg": -90},
    {"a_mm": 10, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "upper_rad": 0.5},
    {"type": "prismatic", "a_mm": 0, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "upper_mm": 300}]})")
                          .arm<3>()
                          .limits;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(limits.lower(0), -3.14159265358979 / 2, 1e-12);
  EXPECT_EQ(limits.upper(0), infinity);
  EXPECT_EQ(limits.lower(1), -infinity);
  EXPECT_EQ(limits.upper(1), 0.5);
  EXPECT_EQ(limits.lower(2), -infinity);
  EXPECT_EQ(limits.upper(2), 0.3);
}

TEST_F(RobotFile, TheModifiedConventionGivesTheSamePoses) {
  const RobotDescription robot = load(R"({"name": "p", "convention": "modified", "joints": [
    {"a_mm": 10, "alpha_deg": 20, "d_mm": 5, "theta_deg": 3, "beta_deg": 1},
    {"a_mm": 0, "alpha_deg": 90, "d_mm": 0, "theta_deg": 0},
    {"type": "prismatic", "a_mm": 431.8, "alpha_deg": 0, "d_mm": 150.05, "theta_deg": 0, "beta_deg": -2, "lower_mm": -100, "upper_mm": 300},
    {"a_mm": 20.3, "alpha_deg": -90, "d_mm": 431.8, "theta_deg": 0}]})");
  EXPECT_TRUE(robot.modified);
  const DescribedRobot<4> described = robot.arm<4>();
  std::array<DhRow, 4> rows{};
  std::copy(robot.rows.begin(), robot.rows.end(), rows.begin());
  const auto modified = DhChain<4, ModifiedDh>::from_rows(rows);
  EXPECT_EQ(described.limits.lower(2), -0.1);
  Rng rng(1);
  for (int k = 0; k < 50; ++k) {
    JointVector<4> q;
    for (auto& value : q) value = rng.uniform(-3, 3);
    EXPECT_LT(difference(described.arm.pose(q), modified.pose(q)), 1e-14 * 10);
  }
}

TEST_F(RobotFile, TheCatalogueSurvivesTheDescription) {
  const Framed<DhChain<6>> arm = RobotDescription::of(robots::puma560_modified()).arm<6>().arm;
  const auto standard = robots::puma560();
  const JointRows<6> samples = sample_joints(standard.limits, 50, 4);
  for (Index i = 0; i < samples.rows(); ++i) {
    const JointVector<6> q = configuration(samples, i);
    EXPECT_LT(difference(arm.pose(q), standard.chain.pose(q)), 1e-14);
  }
  EXPECT_TRUE(RobotDescription::of(robots::barrett_wam()).arm<7>().arm.model() == robots::barrett_wam().chain);
}

TEST_F(RobotFile, ComplaintsNameFileAndKey) {
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = irb120;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string file = path_.string();
  EXPECT_EQ(complaint(with("\"d_mm\": 290", "\"d_mm\": \"290\"")),
            file + ": joints[0].d_mm: must be a number, is a text");
  EXPECT_EQ(complaint(with("\"d_mm\": 290, ", "")), file + ": joints[0]: key 'd_mm' is missing");
  EXPECT_EQ(complaint(with("\"d_mm\": 290", "\"d_mm\": 290, \"d_m\": 0.29")),
            file + ": joints[0]: keys 'd_mm' and 'd_m' both give d");
  EXPECT_EQ(complaint(with("standard", "classic")), file + ": convention: 'classic' is neither standard nor modified");
  EXPECT_EQ(complaint(with("\"upper_deg\": 165", "\"uper_deg\": 165")),
            file + ": joints[0]: key 'uper_deg' is unknown");
  EXPECT_EQ(complaint(with("\"upper_deg\": 165", "\"upper_mm\": 165")),
            file + ": joints[0]: key 'upper_deg' is missing");
  EXPECT_EQ(complaint(with("270", "270,,")), file + ", line 3, column 36: not valid JSON");
  EXPECT_EQ(complaint("{\"name\": \"x\",\n\"joints\": ["),
            file + ", line 2, column 12: the file ends here, but its JSON does not");
  EXPECT_EQ(complaint("{\"name\": \"x\", \"name\": \"y\"}"), file + ": key 'name' is given twice");
}

TEST(RobotDescriptionFrames, AreAroundTheChain) {
  const Isometry3 base = rigid_motion(exp_so3(Vector3(0.4, 0, 0)), Vector3(1, 2, 3)),
                  tool = rigid_motion(exp_so3(Vector3(0, -0.7, 0)), Vector3(0.1, 0, 0.2));
  const JointVector<6> q{0.1, -1.2, 1.3, -0.4, 0.5, 0.6};
  for (RobotDescription robot :
       {RobotDescription::of(robots::puma560()), RobotDescription::of(robots::puma560_modified())}) {
    const RealMatrix framed = RealMatrix(base) * robot.arm<6>().arm.pose(q) * tool;
    robot.base = base;
    robot.tool = tool;
    EXPECT_LE((RealMatrix(robot.arm<6>().arm.pose(q)) - framed).norm(), 1e-14);
    EXPECT_LE((RealMatrix(robot.geometry().poses(RealMatrix(q).transpose()).front()) - framed).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace vernier::robot_file_test
