// SPDX-License-Identifier: BSD-3-Clause
// The blocks of code of the pages in docs/how-to and docs/reference. What a block takes for granted stands before it;
// the checks behind it are about what it made. The blocks on MPI, cameras and payloads are compiled and not run here:
// tests/mpi, tests/camera and tests/io run their like.

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "page_blocks.hpp"
#include "temporary_folder.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/ceres.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/correct_path.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/data/contacts.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/io/camera_files.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/registration/recursive_calibration.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/regression/var_pro_elm.hpp"
#include "vernier/robot_programs/correct_program.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/touches.hpp"
#ifdef VERNIER_DOCS_MPI
#include "vernier/mpi.hpp"
#endif

namespace vernier::guide_test {
namespace {

static_assert(calibrate_blocks == 5 && calibrate_by_contacts_blocks == 1 && calibration_in_code_blocks == 2 &&
                  calibrate_with_a_camera_blocks == 1 && check_data_blocks == 1 && compare_methods_blocks == 1 &&
                  correct_paths_blocks == 1 && correct_programs_blocks == 1 && correct_targets_blocks == 2 &&
                  describe_a_robot_blocks == 2 && find_branches_blocks == 1 && learn_errors_blocks == 3 &&
                  payload_blocks == 1 && reregister_blocks == 2 && run_in_parallel_blocks == 2 &&
                  use_an_earlier_calibration_blocks == 1,
              "a block of docs/ without a test");
// README and tutorials are programs, robot_files and your_own have tests of their own, and architecture.md sketches.
static_assert(all_blocks == 27 + architecture_blocks + README_blocks + first_program_blocks +
                                simulate_and_learn_blocks + robot_files_blocks + your_own_blocks,
              "a page with blocks of code, but without a test");

using namespace vernier::literals;
using Chain = DhChain<6>;

[[maybe_unused]] void calibrates_by_a_camera() {
  namespace vn = vernier;
#include "calibrate_with_a_camera_1.inc"
}

[[maybe_unused]] auto carries() {
  namespace vn = vernier;
#include "payload_1.inc"
  return loaded;
}

const Chain arm = robots::ur10().chain;

JointLimits<6> working_range() {
  JointLimits<6> out;
  out.lower = JointVector<6>(-2.5, -2.6, 0.3, -2.5, -2, -2.5);
  out.upper = JointVector<6>(2.5, -0.6, 2.4, 2.5, 2, 2.5);
  return out;
}

Isometry3 frame(double x, double y, double z, double rx, double ry, double rz) {
  return FrameParameters(Vector6{x, y, z, rx, ry, rz}).isometry();
}

const JointLimits<6> limits = working_range();
const Isometry3 base = frame(2, -1, 0.5, 0.1, -0.2, 1.5), tool = frame(0.02, 0.03, 0.11, 0, 0.1, 0);
const JointVector<6> q(0.3, -1.4, 1.2, 0.4, -0.7, 0.2);
const JointVector<6> previous(0.2, -1.1, 1.0, 0.4, -0.9, 0.6);

/// The real arm: off in its links by tenths of a millimetre and milliradians, with three harmonics in each joint.
Framed<WithJointErrors<Chain>> real_arm(const Isometry3& at = base) {
  const Chain off = with_geometric_errors(arm, {.length_min = 0.2e-3, .angle_min = 0.3e-3, .angle_max = 1e-3}, 4);
  return Framed(WithJointErrors<Chain>(off, draw_joint_errors(arm, {.gear_ratio = 0, .coupling = 0}, 5)), at, tool);
}

Dataset<6> measured(const Framed<WithJointErrors<Chain>>& real, Index poses, std::uint64_t seed) {
  return measure(real, sample_joints(limits, poses, seed), {.position = 0.03e-3, .orientation = 0.1e-3}, seed);
}

/// Mean position error of a model at poses that no fit has seen [m].
template <class Model>
double error(const Model& model, const Isometry3& at = base) {
  return prediction_error(model, measure(real_arm(at), sample_joints(limits, 200, 99))).mean;
}

/// A test runs in a folder of its own.
class Guide : public ::testing::Test {
 protected:
  Guide() { std::filesystem::current_path(folder_.path()); }
  ~Guide() override { std::filesystem::current_path(before_); }

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
  vernier_test::TemporaryFolder folder_{"guide"};
};

TEST_F(Guide, CalibratesSavesAndCorrects) {
  const Dataset<6> data = measured(real_arm(), 200, 1);
  ::testing::internal::CaptureStdout();
#include "calibrate_1.inc"
  EXPECT_GT(::testing::internal::GetCapturedStdout().size(), 100u);
  EXPECT_EQ(report.test_poses(), 40);
  EXPECT_EQ(report.train_poses, 160);
  const double geometry = report.stage(Stage::geometry).position.mean(),
               jointwise = report.stage(Stage::jointwise).position.mean();
  EXPECT_LT(jointwise, 0.1e-3);
  EXPECT_LT(jointwise, 0.6 * geometry);

  {
    ::testing::internal::CaptureStdout();
#include "calibration_in_code_2.inc"
    EXPECT_NE(::testing::internal::GetCapturedStdout().find("jointwise: "), std::string::npos);
    EXPECT_LT(error(model), 0.1e-3);
    EXPECT_GT(error(links_alone), 1.5 * error(model));
    EXPECT_EQ(&deployed, &report.stage(report.chosen));
    EXPECT_EQ(predicted.gate, 1);
    const double sigma = std::sqrt(predicted.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_LT((predicted.pose.translation() - real_arm().position(q)).norm(), 4 * sigma);
    EXPECT_LT(sigma, 0.2e-3);
  }
  {
#include "calibration_in_code_1.inc"
    EXPECT_LT(error(tuned.model()), 0.1e-3);
  }
  {
#include "correct_targets_1.inc"
    EXPECT_EQ(saved.name(), "cell 3");
    EXPECT_EQ(saved.limits().upper, limits.upper);
    EXPECT_EQ(saved.model().position(q), calibration.model().position(q));
    const Vector3 desired = saved.nominal().position(q);
    EXPECT_LT((real_arm().position(correction.command) - desired).norm(), 0.15e-3);
    EXPECT_GT((real_arm().position(q) - desired).norm(), 0.5e-3);
    EXPECT_LT((real_arm().position(next.command) - desired).norm(), 0.15e-3);
    EXPECT_EQ(warm.model().position(q), saved.model().position(q));  // it was measured at no temperature
  }
  {
#include "correct_targets_2.inc"
    EXPECT_LT((real_arm().position(command) - compensator.nominal().position(q)).norm(), 0.15e-3);
  }
  {
    const auto saved = load<6>("model.json");
    const Isometry3 target = saved.nominal().pose(q);
    ::testing::internal::CaptureStdout();
#include "find_branches_1.inc"
    EXPECT_NE(::testing::internal::GetCapturedStdout().find("within limits, alone within"), std::string::npos);
    EXPECT_EQ(branches.count, 8);
    EXPECT_LT((saved.position(branches.nearest(q)->joints) - target.translation()).norm(), 1e-9);

    Isometry3 further = target;
    further.translation().z() += 0.05;
    const JointRows<6> commands = data.joints().topRows(7);
    std::vector<JointVector<6>> sent;
    const auto send = [&](const JointVector<6>& command) { sent.push_back(command); };
#include "correct_paths_1.inc"
    EXPECT_EQ(corrected.first_failure(), nullptr);
    ASSERT_GE(sent.size(), 2u);
    EXPECT_LT((saved.position(sent.back()) - further.translation()).norm(), 0.05e-3);
    EXPECT_LE(corrected.after, 0.05e-3);
    EXPECT_EQ(radii.size(), 7u);
    for (const double radius : radii) EXPECT_LT(radius, 0.5e-3);

    write_file("part.mod",
               "MODULE part\nPROC main()\nMoveAbsJ [[10,-80,70,20,-40,10],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,fine,gun;\n"
               "MoveL Offs(p1,0,0,50),v1,fine,gun;\nENDPROC\nENDMODULE\n");
    ::testing::internal::CaptureStdout();
#include "correct_programs_1.inc"
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "line 4: computed, not a literal\n");
    ASSERT_EQ(outcome.targets.size(), 1u);
    const JointVector<6> meant = JointVector<6>(10, -80, 70, 20, -40, 10) * (std::numbers::pi / 180);
    EXPECT_LT((saved.position(outcome.targets[0].replaced.joints) - saved.nominal().position(meant)).norm(), 1e-6);
    EXPECT_NE(read_file("corrected.mod"), text);
    EXPECT_LT(expected.at(0), 0.5e-3);
  }
  {
    const Isometry3 elsewhere = frame(-1, 2, 0.3, 0, 0.1, -0.4) * base;
    const Dataset<6> six_poses = measured(real_arm(elsewhere), 6, 7);
    const SensorModel sensors{};
    ::testing::internal::CaptureStdout();
#include "reregister_1.inc"
    EXPECT_EQ(::testing::internal::GetCapturedStdout().rfind("Base moved by (", 0), 0u);
    EXPECT_TRUE(moved.determined);
    EXPECT_GT(moved.rms_before, 1);
    EXPECT_LT(error(moved.model, elsewhere), 0.15e-3);
    EXPECT_EQ(load<6>("moved.json").position(q), robot.with_model(moved.model, robot.provenance()).position(q));

    const Isometry3 drifted = frame(0.4e-3, -0.3e-3, 0.2e-3, 0, 0, 0) * base;
    const Dataset<6> drifting = measured(real_arm(drifted), 100, 8);
#include "reregister_2.inc"
    EXPECT_GT(error(robot.model(), drifted), 0.4e-3);
    EXPECT_LT(error(now, drifted), 0.15e-3);
  }
  {
    const Isometry3 elsewhere = frame(-1, 2, 0.3, 0, 0.1, -0.4) * base;
    const Dataset<6> a_dozen = measured(real_arm(elsewhere), 12, 9);
    ::testing::internal::CaptureStdout();
#include "use_an_earlier_calibration_1.inc"
    EXPECT_EQ(::testing::internal::GetCapturedStdout().rfind("joint errors changed by ", 0), 0u);
    EXPECT_LT(error(after.model(), elsewhere), 0.1e-3);
    EXPECT_LT(std::sqrt(covariance.topLeftCorner<3, 3>().trace()), 0.2e-3);
  }
  {
    const Dataset<6> a_dozen = measured(real_arm(), 12, 9);
    ::testing::internal::CaptureStdout();
#include "check_data_1.inc"
    ::testing::internal::GetCapturedStdout();
    EXPECT_TRUE(audit.findings.empty()) << audit.summary();
  }
}

TEST_F(Guide, SensorsAndKnownFrames) {
  const Dataset<6> data = measured(real_arm(), 120, 1);
#include "calibrate_2.inc"
  EXPECT_FALSE(by_tracker.oriented);
  EXPECT_EQ(by_tracker.sensors.position_sigma, 0.015e-3);
  EXPECT_LT(error(by_tracker.model()), 0.15e-3);
#include "calibrate_3.inc"
  EXPECT_EQ(with_free_tool.model().identified().base().matrix(), base.matrix());  // known: kept bit for bit
  EXPECT_NE(with_free_tool.model().identified().tool().matrix(), tool.matrix());
  EXPECT_LT(error(with_free_tool.model()), 0.15e-3);
  const auto all_known = calibrate(surveyed, data, {.geometry = {.frames = Frames::none}});
  EXPECT_EQ(all_known.model().identified().tool().matrix(), tool.matrix());
  EXPECT_LT(error(all_known.model()), 0.15e-3);
}

TEST_F(Guide, SeveralStations) {
  const Isometry3 other = frame(-3, 0.5, 0, 0, 0, -2.5);
  const Dataset<6> monday = measured(real_arm(), 60, 1), tuesday = measured(real_arm(other), 60, 2);
#include "calibrate_4.inc"
  EXPECT_LT(error(of_both.model()), 0.15e-3);
  EXPECT_LT(error(on_tuesday, other), 0.15e-3);
}

TEST_F(Guide, Distances) {
  const Dataset<6> data = measured(real_arm(), 60, 1);
  const JointRows<6> joints = sample_joints(limits, 300, 3);
  const auto lengths = measure_distances(real_arm(), {1, -1, 0.2}, joints, 0.1e-3, 4);
  std::string text = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,distance_mm\n";
  for (Index i = 0; i < lengths.size(); ++i) {
    for (int j = 0; j < 6; ++j) text += message(joints(i, j), ',');
    text += message(lengths.length(i) * 1e3, '\n');
  }
  write_file("wire.csv", text);
#include "calibrate_5.inc"
  ASSERT_EQ(with_poses.others.size(), 1u);
  EXPECT_EQ(with_poses.others[0].measurements, 300);
  EXPECT_LT(error(with_poses.model()), 0.2e-3);
  EXPECT_EQ(alone.poses, 0);
  const auto fresh = measure_distances(real_arm(), {1, -1, 0.2}, sample_joints(limits, 100, 5));
  for (Index i = 0; i < fresh.size(); ++i)
    EXPECT_NEAR(alone.model().position(fresh.joints(i)).norm(), fresh.length(i), 0.8e-3) << i;
}

TEST_F(Guide, DescribesARobot) {
#include "describe_a_robot_1.inc"
  const JointVector<3> zero = JointVector<3>::Zero();
  EXPECT_NEAR((gantry.position(zero) - Vector3(0.025 + 0.455, 0.01, 0.4)).norm(), 0, 1e-12);
  EXPECT_EQ(gantry.row(2).joint, JointType::prismatic);

  std::string text = R"({"name": "mine", "convention": "standard", "joints": [)";
  for (int i = 0; i < 6; ++i)
    text += message(i > 0 ? ", " : "", R"({"a_m": )", arm.row(i).a, R"(, "alpha_rad": )", arm.row(i).alpha,
                    R"(, "d_m": )", arm.row(i).d, R"(, "theta_rad": )", arm.row(i).theta, "}");
  write_file("my_arm.json", text + "]}");
  const Dataset<6> data = measured(real_arm(), 60, 1);
#include "describe_a_robot_2.inc"
  EXPECT_EQ(described.name, "mine");
  EXPECT_LT((described.arm.position(q) - arm.position(q)).norm(), 1e-4);  // numbers of six digits
  EXPECT_LT(error(identified.model), 0.5 * error(identified.model.nominal()));
}

TEST_F(Guide, Learns) {
  {
    const Dataset<6> data = measured(real_arm(), 100, 1);
#include "learn_errors_1.inc"
#include "learn_errors_2.inc"
    EXPECT_LT(error(learned), 1.05 * error(identified.model));  // what cannot be learned is not
    EXPECT_LT(error(learned), 0.2e-3);
  }
  const Dataset<6> data = measured(Framed(real_arm().model()), 100, 1);
#include "learn_errors_3.inc"
  EXPECT_LT(prediction_error(trained, data).mean, 0.2 * prediction_error(arm, data).mean);
}

TEST_F(Guide, ComparesALearnerOfOnesOwn) {
  using MyLearner = Elm;
  const Chain& model = arm;
  const Dataset<6> data = measured(Framed(real_arm().model()), 200, 1);
  ::testing::internal::CaptureStdout();
#include "compare_methods_1.inc"
  const double p = std::stod(::testing::internal::GetCapturedStdout().substr(4));
  EXPECT_GE(p, 0.001);  // printed by three digits; at least 2 / 2^10 of ten pairs
  EXPECT_LE(p, 1);
  EXPECT_EQ((mine - theirs).array().isNaN().count(), 0);
}

TEST_F(Guide, Contacts) {
  const auto real = real_arm(Isometry3::Identity());
  const Dataset<6> data = measured(real, 40, 1);
  std::string text = "contact_id,kind,offset_mm,radius_mm,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
  const std::vector<std::pair<const char*, VirtualObject>> objects{
      {"table", {ContactKind::plane, {0.6, 0.1, 0.3}, {0, 0, 1}, 0.3}},
      {"front", {ContactKind::plane, {0.7, 0.1, 0.5}, {1, 0, 0}, 0.3}},
      {"side", {ContactKind::plane, {0.5, 0.5, 0.5}, {0, 1, 0}, 0.3}}};
  for (const auto& [name, object] : objects) {
    VectorX known = VectorX::Zero(30);
    if (text.find("plane") == std::string::npos) known.tail(15).setConstant(0.1);
    const Contact contact = touch(real, object, name, known, limits, 0, 3);
    for (Index i = 0; i < 30; ++i) {
      text += message(name, ",plane,", known(i) * 1e3, ',');
      for (int j = 0; j < 6; ++j) text += message(',', contact.joints()(i, j));
      text += '\n';
    }
  }
  write_file("contacts.csv", text);
  ::testing::internal::CaptureStdout();
#include "calibrate_by_contacts_1.inc"
  EXPECT_GT(::testing::internal::GetCapturedStdout().size(), 100u);
  EXPECT_LT((corrected.correct(q).command - q).norm(), 0.1);
  ASSERT_EQ(of_both.others.size(), 3u);
  EXPECT_LT(error(of_both.model(), Isometry3::Identity()), 0.15e-3);
}

const CartesianCompensation compensation{Tuned{Elm{.hidden_nodes = 20}, Pso{.particles = 10, .iterations = 5}}};

TEST_F(Guide, ThreadsChangeNothing) {
  const Dataset<6> data = measured(Framed(real_arm().model()), 100, 1);
  ::testing::internal::CaptureStdout();
#include "run_in_parallel_1.inc"
  const std::string seen = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(std::count(seen.begin(), seen.end(), '\n'), 6);  // the first population and five iterations
  EXPECT_EQ(in_parallel.position(q), compensation.fit(arm, data, {.seed = 1}).position(q));
}

#ifdef VERNIER_DOCS_MPI
[[maybe_unused]] void over_several_machines(int argc, char** argv, const Dataset<6>& data, const Dataset<6>& test) {
#include "run_in_parallel_2.inc"
}
#endif

}  // namespace
}  // namespace vernier::guide_test
