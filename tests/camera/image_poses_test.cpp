// SPDX-License-Identifier: BSD-3-Clause
// Poses that single images show, with their covariances: as good as all pixels in one problem, and their covariances
// true.

#include <gtest/gtest.h>

#include <cmath>

#include "simulated_views.hpp"
#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/camera/detail/camera_problem.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::ViewSetup;

namespace image_poses_test {
namespace {

class ImagePoses : public ::testing::TestWithParam<bool> {};

TEST_P(ImagePoses, HaveTrueCovariances) {
  ViewSetup setup;
  setup.on_flange = GetParam();
  setup.board = {.rows = 6, .columns = 7, .square = 0.03, .scale_sigma = 0};
  setup.images = 4;
  setup.places = 1;
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const auto simulated = vernier_test::simulated_views(robot.chain, robot.limits, setup, 12);
  vn::ImageRows rows = simulated.rows;
  rows.flanges = vn::ArmGeometry(vn::Framed(robot.chain)).poses(rows.joints);
  vn::detail::CameraState state;
  state.bases = simulated.bases;
  state.tools = {simulated.tool};
  state.cameras = {setup.camera};
  vn::detail::CameraPriors priors;
  priors.cameras = state.cameras;
  priors.intrinsics = vn::VectorX::Ones(9);
  const vn::Isometry3 truth = simulated.bases[0] * rows.flanges[2] * simulated.tool;
  vn::Rng rng(1);
  constexpr int draws = 4000;
  vn::Matrix6 spread = vn::Matrix6::Zero(), predicted = vn::Matrix6::Zero();
  for (int draw = 0; draw < draws; ++draw) {
    vn::View view =
        vernier_test::view_of(setup.camera, setup.board, setup.on_flange ? truth.inverse() : truth, setup.noise, rng);
    vn::detail::CameraProblem problem(setup.on_flange, setup.board, {{&view, 2, 0, 0}}, rows, state, priors);
    problem.pixel_sigma = setup.noise;
    const auto seen = problem.seen_pose(0);
    ASSERT_TRUE(seen.has_value());
    const vn::Vector6 off = vn::pose_difference(seen->first, truth);
    spread += off * off.transpose() / draws;
    predicted += seen->second / draws;
  }
  for (vn::Index r = 0; r < 6; ++r)
    for (vn::Index c = 0; c < 6; ++c)
      EXPECT_NEAR(spread(r, c), predicted(r, c), 0.06 * std::sqrt(predicted(r, r) * predicted(c, c))) << r << ", " << c;
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
  EXPECT_NEAR(by_poses, by_pixels, 0.05 * by_pixels);
  const vn::Dataset<6>& with = measured.poses()[0];
  EXPECT_GT(error(vn::Dataset<6>(with.joints(), with.positions(), with.orientations())), 1.5 * by_poses);
}

}  // namespace
}  // namespace image_poses_test
