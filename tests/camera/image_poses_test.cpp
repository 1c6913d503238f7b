// SPDX-License-Identifier: BSD-3-Clause
// Poses that single images show, with their covariances: as good as all pixels in one problem, and their covariances
// true.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulated_views.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/joints_by_camera.hpp"
#include "vernier/camera/detail/camera_problem.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"

namespace vn = vernier;
using vernier_test::ViewSetup;

namespace image_poses_test {
namespace {

/// The state behind simulated views, with intrinsics of which nothing is known beforehand.
struct TrueArm {
  TrueArm(const vn::Robot<6>& robot, const ViewSetup& setup, const vernier_test::SimulatedViews& simulated)
      : rows(simulated.rows) {
    rows.flanges = vn::ArmGeometry(vn::Framed(robot.chain)).poses(rows.joints);
    state.bases = simulated.bases;
    state.tools = {simulated.tool};
    state.cameras = priors.cameras = {setup.camera};
    priors.intrinsics = vn::VectorX::Constant(9, 1e6);
  }

  vn::ImageRows rows;
  vn::detail::CameraState state;
  vn::detail::CameraPriors priors;
};

class ImagePoses : public ::testing::TestWithParam<bool> {};

TEST_P(ImagePoses, HaveTrueCovariances) {
  ViewSetup setup;
  setup.on_flange = GetParam();
  setup.board = {.rows = 6, .columns = 7, .square = 0.03, .scale_sigma = 0};
  setup.images = 4;
  setup.places = 1;
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const auto simulated = vernier_test::simulated_views(robot.chain, robot.limits, setup, 12);
  const TrueArm arm(robot, setup, simulated);
  const vn::Isometry3 truth = simulated.bases[0] * arm.rows.flanges[2] * simulated.tool;
  vn::Rng rng(1);
  constexpr int draws = 12000;
  vn::Matrix6 spread = vn::Matrix6::Zero(), predicted = vn::Matrix6::Zero();
  for (int draw = 0; draw < draws; ++draw) {
    vn::View view =
        vernier_test::view_of(setup.camera, setup.board, setup.on_flange ? truth.inverse() : truth, setup.noise, rng);
    vn::detail::CameraProblem problem(setup.on_flange, setup.board, {{&view, 2, 0, 0}}, arm.rows, arm.state,
                                      arm.priors);
    problem.pixel_sigma = setup.noise;
    const auto seen = problem.seen_pose(0);
    ASSERT_TRUE(seen.has_value());
    const vn::Vector6 off = vn::pose_difference(seen->first, truth);
    spread += off * off.transpose() / draws;
    predicted += seen->second / draws;
  }
  for (vn::Index r = 0; r < 6; ++r)
    for (vn::Index c = 0; c < 6; ++c)
      EXPECT_NEAR(spread(r, c), predicted(r, c), 0.05 * std::sqrt(predicted(r, r) * predicted(c, c))) << r << ", " << c;
}

INSTANTIATE_TEST_SUITE_P(BothMounts, ImagePoses, ::testing::Bool());

TEST(ImagePosesOfAnArm, AreAsGoodAsAllPixels) {
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const auto actual = vn::with_geometric_errors(robot.chain, {}, 31);
  ViewSetup setup;
  setup.board = {.rows = 8, .columns = 11, .square = 0.03, .scale_sigma = 0};
  setup.places = 1;
  const auto simulated = vernier_test::simulated_views(actual, robot.limits, setup, 13);
  const auto found = vn::calibrate_by_camera(
      robot, setup.board, simulated.views, simulated.rows,
      {.cameras = {setup.camera}, .choose = false, .left_out = false, .loss = vn::Loss::squared});
  const auto measured = vn::measured_poses<6>(found, simulated.rows);
  ASSERT_EQ(measured.poses().size(), 1u);
  ASSERT_EQ(measured.poses()[0].size(), 60);
  const vn::SensorModel squared{.loss = vn::Loss::squared};
  const vn::IdentifyOptions options{.frames = vn::Frames::base_and_tool};
  const auto error = [&](const vn::Measurements<6>& poses) {
    const auto identified = vn::identify(robot, poses, options, squared, vn::own_solver);
    return vernier_test::error_after_registration(identified.model.identified().model(), actual, robot.limits, 7);
  };
  const double by_pixels =
      vernier_test::error_after_registration(found.model.identified().model(), actual, robot.limits, 7);
  const double by_poses = error(measured);
  EXPECT_NEAR(by_poses, by_pixels, 0.03 * by_pixels);
  const vn::Dataset<6>& with = measured.poses()[0];
  EXPECT_GT(error(vn::Dataset<6>(with.joints(), with.positions(), with.orientations())), 1.5 * by_poses);
}

// Frames by poses, with the errors that the intrinsics share among them, have the covariance of the problem that
// estimates frames and intrinsics together.
TEST(ImagePosesOfOneCamera, ShareTheErrorsOfItsIntrinsics) {
  ViewSetup setup;
  setup.board = {.rows = 6, .columns = 7, .square = 0.03, .scale_sigma = 0};
  setup.images = 20;
  setup.places = 1;
  setup.noise = 1e-3;
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const auto simulated = vernier_test::simulated_views(robot.chain, robot.limits, setup, 14);
  const TrueArm actual(robot, setup, simulated);
  const vn::MatrixX& joints = actual.rows.joints;
  std::vector<vn::detail::PlacedView> placed;
  for (std::size_t v = 0; v < simulated.views.views.size(); ++v)
    placed.push_back({&simulated.views.views[v], static_cast<vn::Index>(v), 0, 0});
  vn::detail::CameraProblem problem(true, setup.board, placed, actual.rows, actual.state, actual.priors);
  problem.free.intrinsics = {true, true, true, true, true, false, false, false, false};
  const vn::MatrixX joint = problem.covariance();
  const vn::VectorX steps = problem.scales();
  ASSERT_EQ(joint.rows(), 17);

  const vn::ArmGeometry arm(
      vn::Framed(robot.chain, vn::FrameParameters(simulated.bases[0]), vn::FrameParameters(simulated.tool)));
  std::vector<vn::GeometricUnknown> frames;
  for (vn::Index k = 0; k < 6; ++k) frames.push_back({k, -1, 1e-3, 0});
  for (vn::Index k = 0; k < 6; ++k) frames.push_back({vn::ArmParameters::chain_end(6) + k, -1, 1e-3, 0});
  vn::ErrorModelEstimate estimate{.arm = vn::ArmParameterisation({arm}, frames)};
  vn::SharedErrors shared{.joints = joints};
  std::vector<vn::RowBlock> linear(placed.size());
  estimate.arm.linearise(0, joints, vn::MatrixX(), linear.data());
  vn::MatrixX information = vn::MatrixX::Zero(12, 12);
  for (std::size_t v = 0; v < placed.size(); ++v) {
    const auto seen = problem.seen_pose(v);
    ASSERT_TRUE(seen.has_value());
    shared.covariances.push_back(seen->second);
    shared.effects.push_back(problem.effect_of_shared(v, seen->first));
    const vn::MatrixX columns = linear[v].dense;
    information += columns.transpose() * seen->second.inverse() * columns;
  }
  estimate.covariance = information.inverse();
  const vn::MatrixX with = vn::covariance_with_shared_errors(estimate, {shared}, joint.bottomRightCorner(5, 5));
  for (vn::Index k = 0; k < 3; ++k) {  // of the tool's place in the frame of the flange
    const double all = std::sqrt(joint(6 + k, 6 + k)) * steps(6 + k), poses = std::sqrt(with(6 + k, 6 + k)) * 1e-3,
                 alone = std::sqrt(estimate.covariance(6 + k, 6 + k)) * 1e-3;
    EXPECT_NEAR(poses, all, 0.01 * all) << k;
    EXPECT_GT(all, 1.03 * alone) << k;
  }
}

// Gears that err, intrinsics that are only roughly known: both are found, wherever the intrinsics start.
TEST(JointsByCameras, AreFoundWithTheIntrinsics) {
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const vn::JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0.4e-3, .harmonics = 2};
  const vn::WithJointErrors<vn::DhChain<6>> actual(vn::with_geometric_errors(robot.chain, {}, 31),
                                                   vn::draw_joint_errors(robot.chain, sizes, 32));
  ViewSetup setup;
  setup.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 0};
  setup.images = 100;
  const auto simulated = vernier_test::simulated_views(actual, robot.limits, setup, 15);
  vn::CalibrateOptions options;
  options.errors.tilt = options.errors.drift = options.errors.compliance = false;
  options.errors.harmonics = 3;
  options.remainder.on_error_model = false;
  const auto found = vn::calibrate_joints_by_camera(
      robot, setup.board, simulated.views, simulated.rows,
      {.cameras = {setup.camera}, .free = {"fx", "fy", "cx", "cy", "k2"}, .choose = false, .left_out = false},
      [&](const vn::Measurements<6>& poses) { return vn::JointFit{vn::calibrate(robot, poses, options).errors}; });
  EXPECT_TRUE(found.converged);
  ASSERT_FALSE(found.moved.empty());
  EXPECT_LT(found.moved.size(), 5u);
  ASSERT_FALSE(found.errors.empty());
  for (vn::Index k = 0; k < 6; ++k)
    EXPECT_LT(std::abs(found.camera.cameras[0].parameters()(k) - setup.camera.parameters()(k)),
              4 * found.camera.camera_std[0](k))
        << k;
  double reach = 0;
  for (const vn::Isometry3& flange : vn::poses(robot.chain, vn::JointRows<6>(simulated.rows.joints)))
    reach = (std::max)(reach, flange.translation().norm());
  EXPECT_NEAR(found.camera.scale_effect, found.camera.board_scale_std * reach, 0.01 * found.camera.scale_effect);
  // from elsewhere the same intrinsics are found
  vn::Camera other = setup.camera;
  other.fx += 20;
  other.cy -= 15;
  const auto again = vn::calibrate_joints_by_camera(
      robot, setup.board, simulated.views, simulated.rows,
      {.cameras = {other}, .free = {"fx", "fy", "cx", "cy", "k2"}, .choose = false, .left_out = false},
      [&](const vn::Measurements<6>& poses) { return vn::JointFit{vn::calibrate(robot, poses, options).errors}; });
  EXPECT_TRUE(again.converged);
  for (vn::Index k = 0; k < 6; ++k)
    EXPECT_LT(std::abs(again.camera.cameras[0].parameters()(k) - found.camera.cameras[0].parameters()(k)),
              found.camera.camera_std[0](k))
        << k;
  // and the camera is nearer to where it was than by geometry alone
  const vn::Framed<vn::WithJointErrors<vn::DhChain<6>>> truth(actual, simulated.bases[0], simulated.tool);
  const auto error = [&](const auto& model) {
    double sum = 0;
    for (vn::Index i = 0; i < simulated.rows.joints.rows(); ++i) {
      const vn::JointVector<6> q = simulated.rows.joints.row(i).transpose();
      sum += (model.position(q) - truth.position(q)).norm() / 100;
    }
    return sum;
  };
  const auto calibration = vn::calibrate(robot, found.poses, options);
  EXPECT_LT(error(calibration.model()), 0.5 * error(calibration.errors.models(vn::Stage::geometry).front()));
}

// Priors of links are about an arm that was identified with the same board: they say nothing of its scale.
TEST(JointsByCameras, DoNotTellTheScaleOfTheBoard) {
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const vn::JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0.4e-3, .harmonics = 2};
  const vn::WithJointErrors<vn::DhChain<6>> actual(vn::with_geometric_errors(robot.chain, {}, 31),
                                                   vn::draw_joint_errors(robot.chain, sizes, 32));
  ViewSetup setup;
  setup.board = {.rows = 7, .columns = 9, .square = 0.03 * 1.003, .scale_sigma = 3e-3};
  const auto simulated = vernier_test::simulated_views(actual, robot.limits, setup, 15);
  vn::Board printed = setup.board;
  printed.square = 0.03;
  vn::CalibrateOptions options;
  options.errors.tilt = options.errors.drift = options.errors.compliance = false;
  options.errors.harmonics = 3;
  options.remainder.on_error_model = false;
  const auto found = vn::calibrate_joints_by_camera(
      robot, printed, simulated.views, simulated.rows,
      {.cameras = {setup.camera}, .free = {"fx", "fy"}, .choose = false, .left_out = false},
      [&](const vn::Measurements<6>& poses) { return vn::JointFit{vn::calibrate(robot, poses, options).errors}; });
  EXPECT_TRUE(found.converged);
  EXPECT_GT(found.camera.board_scale_std, 1.5e-3);  // 0.5e-3 with the priors of an error model
  EXPECT_LT(found.camera.board_scale_std, 3e-3);
  EXPECT_LT(std::abs(found.camera.board_scale - 1.003), 2.5 * found.camera.board_scale_std);
}

}  // namespace
}  // namespace image_poses_test
