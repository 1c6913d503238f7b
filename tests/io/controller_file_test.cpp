// SPDX-License-Identifier: BSD-3-Clause
// Robot files and model files of arms whose controllers count joints differently; frames and gravity in robot files.
#include <gtest/gtest.h>

#include <filesystem>

#include "complaint.hpp"
#include "laws.hpp"
#include "real_matrix.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/testing/kinematic_laws.hpp"

namespace vernier::controller_file_test {
namespace {

const std::string rows = R"("joints": [{"a_mm": 312, "alpha_deg": -90, "d_mm": 0, "theta_deg": 0},
  {"a_mm": 1075, "alpha_deg": 0, "d_mm": 0, "theta_deg": -90}, {"a_mm": 225, "alpha_deg": -90, "d_mm": 0, "theta_deg": 0}])";

class ControllerFile : public ::testing::Test {
 protected:
  RobotDescription load_file(const std::string& keys) const {
    write_file(path_, R"({"name": "arm", "convention": "standard", )" + rows + keys + "}");
    return load_robot(path_.string());
  }
  std::string complaint(const std::string& keys) const {
    const std::string out = vernier_test::complaint([&] { static_cast<void>(load_file(keys)); });
    const std::string file = path_.string() + ": ";
    return out.substr(0, file.size()) == file ? out.substr(file.size()) : out;
  }
  vernier_test::TemporaryFolder folder_{"controller_file"};
  std::filesystem::path path_ = folder_ / "arm.json";
};

const std::string controller = R"(, "controller": {"chain": ["J1", "J2 + 5 deg", "-J2 - J3"],
  "limits": [{"lower_deg": -180, "upper_deg": 180}, {"upper_rad": 1.5}, {}]})";

TEST_F(ControllerFile, LimitsAreThoseOfTheController) {
  const RobotDescription robot = load_file(controller);
  EXPECT_EQ(robot.controller_joints(), 3);
  const DescribedRobot<3> arm = robot.arm<3>();
  EXPECT_EQ(arm.limits.upper(1), 1.5);
  EXPECT_EQ(arm.limits.upper(2), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(arm.controller == robot.controller);
  EXPECT_NEAR(arm.controller.zeros()(1), 0.0872664625997, 1e-12);
}

TEST_F(ControllerFile, ComplaintsOfTheController) {
  EXPECT_EQ(complaint(R"(, "controller": {"chain": ["J1", "J2"]})"), "controller.chain: has 2 entries, must have 3");
  EXPECT_EQ(complaint(R"(, "controller": {"chain": ["J1", "J2", "J3 + 2"]})"),
            "controller.chain: formula 'J3 + 2': a number needs its unit: deg, rad, mm or m");
  EXPECT_EQ(complaint(R"(, "controller": {"chain": ["J1", "J2", "J3"], "limits": [{}, {"upper_mm": 3}, {}]})"),
            "controller.limits[1]: key 'upper_mm' is unknown");
  EXPECT_EQ(complaint(R"(, "controller": {"chain": ["J1", "J2", "J3"], "signs": [1]})"),
            "controller: key 'signs' is unknown");
}

TEST_F(ControllerFile, GearsErrAtTheChainUnlessTheFileSaysMotors) {
  const std::string chain = R"(, "controller": {"chain": ["J1", "J2", "J3 - J2"])";
  EXPECT_FALSE(load_file(chain + "}").controller.motor_errors());
  EXPECT_FALSE(load_file(chain + R"(, "errors": "chain"})").controller.motor_errors());
  const RobotDescription robot = load_file(chain + R"(, "errors": "motors", "drives": [{}, {"gear_ratio": 171}, {}]})");
  EXPECT_TRUE(robot.controller.motor_errors());
  EXPECT_FALSE(robot.controller == robot.controller.with_motor_errors(false));
  EXPECT_TRUE(robot.arm<3>().controller == robot.controller);
  EXPECT_EQ(robot.drives[1].gear_ratio, 171);
  EXPECT_EQ(robot.drives[2].gear_ratio, 0);
  EXPECT_EQ(complaint(chain + R"(, "errors": "gears"})"), "controller.errors: 'gears' is neither chain nor motors");
  EXPECT_EQ(complaint(chain + R"(, "drives": [{}, {}, {}]})"),
            "controller.drives: needs errors: motors; else drives are those of the rows");
  EXPECT_EQ(complaint(chain + R"(, "errors": "motors", "drives": [{}]})"),
            "controller.drives: has 1 entries, must have 3");
  write_file(path_, R"({"name": "arm", "convention": "standard", "joints": [
    {"a_mm": 312, "alpha_deg": -90, "d_mm": 0, "theta_deg": 0, "gear_ratio": 121}],
    "controller": {"chain": ["-J1"], "errors": "motors"}})");
  EXPECT_EQ(vernier_test::complaint([&] { static_cast<void>(load_robot(path_.string())); }),
            path_.string() +
                ": controller.errors: a row has gear_ratio or encoder_periods; those of motors are in "
                "controller.drives");
}

TEST_F(ControllerFile, LimitsStandInOnePlace) {
  write_file(path_, R"({"name": "arm", "convention": "standard", "joints": [
    {"a_mm": 312, "alpha_deg": -90, "d_mm": 0, "theta_deg": 0, "lower_deg": -9}], "controller": {"chain": ["-J1"]}})");
  EXPECT_EQ(vernier_test::complaint([&] { static_cast<void>(load_robot(path_.string())); }),
            path_.string() + ": joints[0]: limits are those of the controller's joints, in controller.limits");
}

TEST_F(ControllerFile, FramesByRotationVectorOrQuaternion) {
  const RobotDescription robot = load_file(R"(, "base": {"x_mm": 1, "y_mm": 2, "z_m": 3, "rz_deg": 90, "known": true},
    "tool": {"qw": -0.5, "qx": 0.5, "qy": 0.5, "qz": 0.5}, "down": [0, 0, 2])");
  EXPECT_TRUE(robot.base_known);
  EXPECT_FALSE(robot.tool_known);
  EXPECT_LT((Vector3(robot.base.translation()) - Vector3(0.001, 0.002, 3)).norm(), 1e-15);
  EXPECT_LT((robot.base.linear() * Vector3(1, 0, 0) - Vector3(0, 1, 0)).norm(), 1e-15);
  // (-1 + i + j + k) / 2 turns by -120 deg about (1, 1, 1): x to z, y to x, z to y
  EXPECT_LT((robot.tool.linear() * Vector3(1, 2, 3) - Vector3(2, 3, 1)).norm(), 1e-14);
  EXPECT_EQ(robot.down, Vector3(0, 0, 1));
  const auto arm = robot.arm<3>().arm;
  EXPECT_LT((Isometry3(robot.base.inverse() * arm.pose(JointVector<3>::Zero()) * robot.tool.inverse()).matrix() -
             arm.model().pose(JointVector<3>::Zero()).matrix())
                .norm(),
            1e-13);
}

TEST_F(ControllerFile, ComplaintsOfFrames) {
  EXPECT_EQ(complaint(R"(, "base": {"x_mm": 1})"), "base: a position has x, y and z");
  EXPECT_EQ(complaint(R"(, "tool": {"rx_deg": 1, "qw": 1, "qx": 0, "qy": 0, "qz": 0})"),
            "tool: a rotation vector and a quaternion both give its orientation");
  EXPECT_EQ(complaint(R"(, "tool": {"qw": 1, "qx": 1, "qy": 0, "qz": 0})"),
            "tool: the quaternion has the norm 1.4142135623730951, must be 1");
  EXPECT_EQ(complaint(R"(, "base": {"x": 1})"), "base: key 'x' is unknown");
  EXPECT_EQ(complaint(R"(, "down": [0, 0, 0])"), "down: has no direction");
}

TEST(RobotFiles, TheExamplesAreReadAndStandAsTheirMakersSay) {
  const std::filesystem::path folder = VERNIER_ROBOT_FILES;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const RobotDescription robot = load_robot(entry.path().string());
    EXPECT_EQ(robot.geometry().joints(), robot.dof()) << entry.path();
    EXPECT_EQ(static_cast<int>(robot.limits.size()), robot.controller_joints());
    for (const auto& [lower, upper] : robot.limits) EXPECT_TRUE(std::isfinite(lower) && std::isfinite(upper));
    ++files;
  }
  EXPECT_EQ(files, 10);
  const auto of = [&](const char* name) { return load_robot((folder / name).string()); };
  const auto rows_of = [](const RobotDescription& robot) { return robot.arm<6>().arm.model(); };
  EXPECT_TRUE(rows_of(of("fanuc.json")) == robots::fanuc_r2000ib_165f().chain);
  EXPECT_TRUE(of("fanuc.json").controller == robots::fanuc_r2000ib_165f().controller);
  EXPECT_TRUE(rows_of(of("kuka.json")) == robots::kuka_kr6_r900().chain);
  EXPECT_TRUE(of("kuka.json").controller == robots::kuka_kr6_r900().controller);
  EXPECT_EQ(of("fanuc.json").arm<6>().limits.upper, robots::fanuc_r2000ib_165f().limits.upper);
  const auto at = [](const RobotDescription& robot, const VectorX& q) {
    const MatrixX chain = robot.controller.to_chain(q.transpose());
    return Vector3(robot.geometry().positions(chain).row(0).transpose());
  };
  // by hand: the wrist of a palletiser is 1150 sin 20 + 1250 cos 10 + 220 + 260 mm in front, and its flange points down
  VectorX q = VectorX::Zero(4);
  q(1) = 20 * 3.14159265358979 / 180;
  q(2) = 10 * 3.14159265358979 / 180;
  EXPECT_NEAR(at(of("palletiser.json"), q).x(), 0.26 + 1.15 * std::sin(q(1)) + 1.25 * std::cos(q(2)) + 0.22, 1e-12);
  EXPECT_NEAR(at(of("palletiser.json"), q).z(), 0.814 + 1.15 * std::cos(q(1)) - 1.25 * std::sin(q(2)) - 0.25, 1e-12);
  // a rail along y carries the arm of six_axis.json, upright
  VectorX rail = VectorX::Zero(7);
  rail(0) = 1.5;
  EXPECT_LT((at(of("rail.json"), rail) - at(of("six_axis.json"), VectorX::Zero(6)) - Vector3(0, 1.5, 0)).norm(), 1e-12);
  EXPECT_LT((at(of("positioner.json"), VectorX::Zero(2)) - Vector3(0, -0.15, 0)).norm(), 1e-12);
}

TEST_F(ControllerFile, GravityOfAModifiedChainTurnsWithItsConversion) {
  RobotDescription robot{.name = "m", .modified = true};
  robot.rows = {{.alpha = 0.7}, {.a = 0.3}, {.a = 0.2}};
  robot.limits.assign(3, {-1, 1});
  robot.down = Vector3(0.6, 0, -0.8);
  const DescribedRobot<3> arm = robot.arm<3>();
  EXPECT_LT((arm.arm.base().linear() * arm.down - robot.down).norm(), 1e-15);
}

/// A palletiser, of which the wrist is passive.
CalibratedRobot<5> palletiser() {
  const std::array<DhRow, 5> chain{
      {{.a = 0.3, .alpha = -1.5, .d = 0.8}, {.a = 1.2}, {.a = 1.3}, {.a = 0.25, .alpha = 1.5}, {.d = 0.2}}};
  std::array<DhRow, 5> real = chain;
  real[1].a += 0.002;
  real[2].theta += 0.003;
  using Chain = DhChain<5>;
  const std::array<std::string, 5> law{"J1", "J2", "J3 - J2", "-J3", "J4"};
  JointLimits<5> limits;
  limits.lower << -1, -1, -1, -1, 0;
  limits.upper << 1, 1, std::numeric_limits<double>::infinity(), 1, 0;
  const Framed<WithJointErrors<Chain>> arm{WithJointErrors<Chain>(Chain::from_rows(real))};
  return CalibratedRobot<5>("palletiser", ErrorModel<Chain>(Chain::from_rows(chain), arm), limits,
                            {.joints = "commanded", .measured = "poses"})
      .with_controller(ControllerMap(law));
}

TEST_F(ControllerFile, ModelFilesKeepTheController) {
  const CalibratedRobot<5> robot = palletiser();
  save(path_.string(), robot);
  const auto back = vernier::load<5>(path_.string());
  EXPECT_TRUE(back.controller() == robot.controller());
  EXPECT_EQ(back.limits().lower, robot.limits().lower);
  EXPECT_EQ(back.limits().upper, robot.limits().upper);
  const std::string first = read_file(path_);
  save(path_.string(), back);
  EXPECT_EQ(read_file(path_), first);
  std::string broken = first;
  const std::string factors = "\"zero_rad\": 0.0";
  broken.replace(broken.find(factors), factors.size(), "\"zero_mm\": 0.0");
  write_file(path_, broken);
  EXPECT_EQ(vernier_test::complaint([&] { static_cast<void>(read_model(path_.string())); }),
            path_.string() + ": controller.chain[0]: key 'zero_rad' is missing");
}

/// The palletiser with harmonics of its motors within ranges of these.
CalibratedRobot<5> with_erring_motors() {
  using Model = CalibratedRobot<5>::Model;
  const CalibratedRobot<5> robot = palletiser();
  const ControllerMap map = robot.controller().with_motor_errors();
  JointTerms terms(5), few(5);
  terms.motors = few.motors = MotorAngles(map);
  few.hysteresis = terms.hysteresis = {0.05};
  terms.transmission.assign(5, Fourier::up_to(2));
  const auto chain = robot.identified().chain();
  VectorX values(terms.size());
  for (Index k = 0; k < values.size(); ++k) values(k) = 1e-4 * static_cast<double>(k % 7 - 3);
  const Framed<WithJointErrors<DhChain<5>>> near{{chain, JointErrors(terms, values)}},
      far{{chain, JointErrors(few, VectorX::Constant(few.size(), 5e-5))}};
  const JointRows<5> measured = JointRows<5>::Random(50, 5);
  return robot
      .with_model(Model(robot.nominal().model(), near, far, JointCoverage<5>::covering(measured, terms.motors)),
                  robot.provenance())
      .with_controller(map);
}

TEST_F(ControllerFile, ModelFilesKeepWhereGearsErr) {
  const CalibratedRobot<5> robot = with_erring_motors();
  save(path_.string(), robot);
  const auto back = vernier::load<5>(path_.string());
  EXPECT_TRUE(back.controller() == robot.controller());
  EXPECT_EQ(back.controller().motor_errors(), true);
  JointRows<5> all(20, 5);
  Rng rng(3);
  for (Index i = 0; i < all.rows(); ++i) {
    JointVector<5> q;
    for (int j = 0; j < 5; ++j) all(i, j) = q(j) = 1.3 * rng.normal();
    EXPECT_EQ(back.model().pose(q).matrix(), robot.model().pose(q).matrix());
  }
  EXPECT_TRUE(vernier_test::no_violations(testing::kinematic_model_violations(robot.model(), all)));
  const std::string text = read_file(path_);
  save(path_.string(), back);
  EXPECT_EQ(read_file(path_), text);
  EXPECT_NE(text.find("\"schema_version\": 6"), std::string::npos);
  // a controller that says otherwise than the fit is refused
  EXPECT_EQ(vernier_test::complaint([&] { save(path_.string(), robot.with_controller(palletiser().controller())); }),
            "save: gears of the model err at other joints than its controller says: give the fit the same controller");
}

TEST_F(ControllerFile, CommandsOfAPassiveJointKeepItsLaw) {
  const CalibratedRobot<5> robot = palletiser();
  const JointVector<5> at{0.2, 0.5, 0.3, -0.4, 0};
  const JointVector<5> q = robot.in_controller_joints().change().to_chain(at);
  const Correction<5> found = robot.correct(q);
  EXPECT_EQ(found.status, IkStatus::converged);
  EXPECT_LT((robot.position(found.command) - robot.nominal().position(q)).norm(), 1e-6);
  EXPECT_GT((robot.position(q) - robot.nominal().position(q)).norm(), 1e-3);
  EXPECT_NEAR(found.command(1) + found.command(2) + found.command(3), 0, 1e-15);
  JointVector<5> beyond = at;
  beyond(1) = 1.2;  // beyond the limit of J2
  const Correction<5> held = robot.correct(robot.in_controller_joints().change().to_chain(beyond));
  EXPECT_LE(robot.in_controller_joints().change().to_controller(held.command)(1), 1 + 1e-12);
}

}  // namespace
}  // namespace vernier::controller_file_test
