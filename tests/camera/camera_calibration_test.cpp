// SPDX-License-Identifier: BSD-3-Clause
// Calibrations by cameras: simulated arms, several cameras and places, wrong corners, and refusals.

#include "vernier/calibration/camera_calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "simulated_views.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"

namespace vn = vernier;
using vernier_test::error_after_registration;
using vernier_test::simulated_views;
using vernier_test::SimulatedViews;
using vernier_test::ViewSetup;

namespace camera_calibration_test {
namespace {

double apart(const vn::Isometry3& a, const vn::Isometry3& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

/// Images of an arm as designed; the poses of its flange are known.
SimulatedViews exact_arm(const ViewSetup& setup, std::uint64_t seed) {
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  SimulatedViews out = simulated_views(robot.chain, robot.limits, setup, seed);
  out.rows.flanges = vn::ArmGeometry(vn::Framed(robot.chain)).poses(out.rows.joints);
  return out;
}

class HandEyeByCamera : public ::testing::TestWithParam<bool> {};

TEST_P(HandEyeByCamera, FindsFramesAndIntrinsics) {
  ViewSetup setup;
  setup.on_flange = GetParam();
  setup.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
  setup.images = 24;
  const SimulatedViews simulated = exact_arm(setup, 5);
  const vn::CameraReport found = vn::calibrate_hand_eye(
      setup.board, simulated.views, simulated.rows,
      {.mount = setup.on_flange ? vn::CameraMount::flange : vn::CameraMount::fixed, .left_out = false});
  EXPECT_NEAR(found.pixel_sigma, 0.2, 0.02);
  EXPECT_LT(found.pose_excess, 1.2);
  ASSERT_EQ(found.in_base.size(), simulated.bases.size());
  for (std::size_t k = 0; k < found.in_base.size(); ++k) {
    const vn::Isometry3 truth = simulated.bases[k].inverse();
    EXPECT_LT(apart(found.in_base[k], truth), 1.5e-3);
    for (vn::Index axis = 0; axis < 3; ++axis)
      EXPECT_LT(std::abs(found.in_base[k](axis, 3) - truth(axis, 3)), 4.5 * found.in_base_std[k](axis)) << axis;
  }
  EXPECT_LT(apart(found.in_flange[0], simulated.tool), 1.5e-3);
  for (vn::Index axis = 0; axis < 3; ++axis)
    EXPECT_LT(std::abs(found.in_flange[0](axis, 3) - simulated.tool(axis, 3)), 4.5 * found.in_flange_std[0](axis));
  const vn::VectorX off = found.cameras[0].parameters() - setup.camera.parameters();
  for (vn::Index k = 0; k < 6; ++k) EXPECT_LT(std::abs(off(k)), 4.5 * found.camera_std[0](k)) << k;
}

TEST_P(HandEyeByCamera, ToleratesWrongCorners) {
  ViewSetup setup;
  setup.on_flange = GetParam();
  setup.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
  setup.images = 24;
  SimulatedViews simulated = exact_arm(setup, 6);
  vn::CameraOptions options{.mount = setup.on_flange ? vn::CameraMount::flange : vn::CameraMount::fixed,
                            .cameras = {setup.camera},
                            .choose = false,
                            .left_out = false};
  const auto error = [&] {
    const vn::CameraReport found = vn::calibrate_hand_eye(setup.board, simulated.views, simulated.rows, options);
    return (found.in_flange[0].translation() - simulated.tool.translation()).norm();
  };
  const double clean = error();
  vn::Rng rng(2);
  for (vn::View& view : simulated.views.views)
    for (vn::Vector2& pixel : view.pixels)
      if (rng.uniform() < 0.05) pixel += vn::Vector2(rng.uniform(-30, 30), rng.uniform(-30, 30));
  EXPECT_LT(error(), clean + 0.15e-3);
}

INSTANTIATE_TEST_SUITE_P(BothMounts, HandEyeByCamera, ::testing::Bool());

TEST(HandEyeByCameras, TellHowFarTheyAre) {
  ViewSetup setup;
  setup.board = {.rows = 6, .columns = 7, .square = 0.03, .scale_sigma = 1e-4};
  setup.places = 1;
  for (const int images : {8, 22}) {  // of few, each is left out and everything decided again
    setup.images = images;
    const SimulatedViews simulated = exact_arm(setup, 7);
    std::vector<vn::Index> steps;
    const auto watch = [&](const vn::Progress& progress) { steps.push_back(progress.generation); };
    vn::calibrate_hand_eye(setup.board, simulated.views, simulated.rows,
                           {.cameras = {setup.camera}, .observer = watch});
    EXPECT_TRUE(std::is_sorted(steps.begin(), steps.end()));
    EXPECT_GT(steps.size(), 20U);
    EXPECT_LT(steps.front(), vn::camera_steps / 10);
    EXPECT_EQ(steps.back(), vn::camera_steps);
    const auto before_the_last = steps.rbegin()[1];
    EXPECT_LT(before_the_last, vn::camera_steps);
  }
}

TEST(HandEyeByCameras, StateTrueStandardDeviationsForAnInexactArm) {
  ViewSetup setup;
  setup.board = {.rows = 6, .columns = 7, .square = 0.03, .scale_sigma = 1e-4};
  setup.images = 16;
  setup.places = 1;
  double squares = 0;
  constexpr int arms = 20;
  for (int arm = 0; arm < arms; ++arm) {
    SimulatedViews simulated = exact_arm(setup, 40 + static_cast<std::uint64_t>(arm));
    vn::Rng rng(static_cast<std::uint64_t>(arm));
    const auto drawn = [&]() -> vn::Vector3 {
      return 0.3e-3 * vn::Vector3(rng.normal_pair()[0], rng.normal_pair()[0], rng.normal_pair()[0]);
    };
    for (vn::Isometry3& flange : simulated.rows.flanges) {
      const vn::Vector3 shift = drawn(), turn = drawn();
      flange = vn::rigid_motion(vn::exp_so3(turn) * flange.linear(), flange.translation() + shift);
    }
    const vn::CameraReport found = vn::calibrate_hand_eye(
        setup.board, simulated.views, simulated.rows, {.cameras = {setup.camera}, .choose = false, .left_out = false});
    EXPECT_GT(found.pose_excess, 1.2);
    EXPECT_NEAR(found.pixel_sigma, setup.noise, 0.1 * setup.noise);
    for (vn::Index axis = 0; axis < 3; ++axis) {
      const double off = (found.in_flange[0](axis, 3) - simulated.tool(axis, 3)) / found.in_flange_std[0](axis);
      squares += off * off / (3 * arms);
    }
  }
  EXPECT_GT(std::sqrt(squares), 0.65);
  EXPECT_LT(std::sqrt(squares), 1.4);
}

TEST(HandEyeByCameras, OfTwoCamerasOnTheFlangeHasEach) {
  ViewSetup setup;
  setup.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
  setup.images = 20;
  setup.places = 1;
  SimulatedViews simulated = exact_arm(setup, 8);
  // a second camera beside the first takes every other image
  const vn::Isometry3 beside = simulated.tool * vn::rigid_motion(vn::exp_so3(vn::Vector3(0, 0.05, 0)), {0.03, 0, 0});
  vn::Rng rng(3);
  simulated.views.cameras = {"first", "second"};
  for (std::size_t i = 1; i < simulated.views.views.size(); i += 2) {
    vn::View& view = simulated.views.views[i];
    const vn::Isometry3 pose = simulated.bases[0] * simulated.rows.flanges[i] * beside;
    vn::View other = vernier_test::view_of(setup.camera, setup.board, pose.inverse(), setup.noise, rng);
    view.corners = other.corners;
    view.pixels = other.pixels;
    view.camera = 1;
  }
  const vn::CameraReport found =
      vn::calibrate_hand_eye(setup.board, simulated.views, simulated.rows,
                             {.cameras = {setup.camera, setup.camera}, .choose = false, .left_out = false});
  ASSERT_EQ(found.in_flange.size(), 2u);
  EXPECT_LT(apart(found.in_flange[0], simulated.tool), 1e-3);
  EXPECT_LT(apart(found.in_flange[1], beside), 1e-3);
}

TEST(CalibrateByCamera, IdentifiesTheGeometryOfArms) {
  // three tracker positions of 0.03 mm cost a thousand times as much
  const vn::Robot<6> robot = vn::robots::ur10();
  for (const std::uint64_t seed : {1u, 2u}) {
    const auto actual = vn::with_geometric_errors(robot.chain, {}, 100 + seed);
    ViewSetup setup;
    const SimulatedViews simulated = simulated_views(actual, robot.limits, setup, seed);
    const auto found =
        vn::calibrate_by_camera(robot, setup.board, simulated.views, simulated.rows, {.left_out = false});
    EXPECT_GT(error_after_registration(robot.chain, actual, robot.limits, 7), 1e-3);
    EXPECT_LT(error_after_registration(found.model.identified().model(), actual, robot.limits, 7), 0.08e-3) << seed;
    EXPECT_NEAR(found.pixel_sigma, 0.2, 0.02);
    EXPECT_GT(found.scale_effect, 0);
  }
}

TEST(CalibrateByCamera, FindsABentBoard) {
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  ViewSetup setup;
  setup.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
  setup.images = 30;
  SimulatedViews simulated = exact_arm(setup, 9);
  vn::Rng rng(4);
  for (std::size_t i = 0; i < simulated.views.views.size(); ++i) {
    vn::View& view = simulated.views.views[i];
    const vn::Isometry3 pose =
        simulated.bases[static_cast<std::size_t>(view.board)] * simulated.rows.flanges[i] * simulated.tool;
    for (std::size_t k = 0; k < view.corners.size(); ++k) {
      vn::Vector3 corner = setup.board.corner(view.corners[k]);
      const double x = (corner(0) - setup.board.middle()(0)) / setup.board.half_diagonal();
      corner(2) = 0.5e-3 * x * x;
      const auto [a, b] = rng.normal_pair();
      view.pixels[k] = vernier_test::seen_at(setup.camera, pose.inverse() * corner) + 0.2 * vn::Vector2(a, b);
    }
  }
  const vn::CameraReport found =
      vn::calibrate_hand_eye(setup.board, simulated.views, simulated.rows, {.left_out = false});
  EXPECT_TRUE(found.blocks.back().kept);
  EXPECT_NEAR(found.board_bend(0), 0.5e-3, 0.06e-3);
  EXPECT_NEAR(found.board_bend(2), 0, 0.06e-3);
}

// Neither lens nor board errs; joints do, which no model of the arm has here.
TEST(CalibrateByCamera, FindsNoEffectThatIsNotThere) {
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  ViewSetup setup;
  setup.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
  setup.camera = {.fx = 1400, .fy = 1405, .cx = 810, .cy = 590, .width = 1600, .height = 1200};
  setup.images = 40;
  int kept = 0, tried = 0;
  for (std::uint64_t arm = 0; arm < 8; ++arm) {
    const vn::JointErrorSizes sizes{.harmonic = arm % 2 == 0 ? 0.2e-3 : 0, .harmonics = 10};
    const vn::WithJointErrors<vn::DhChain<6>> actual(vn::with_geometric_errors(robot.chain, {}, arm),
                                                     vn::draw_joint_errors(robot.chain, sizes, 50 + arm));
    const SimulatedViews simulated = simulated_views(actual, robot.limits, setup, 100 + arm);
    const auto found =
        vn::calibrate_by_camera(robot, setup.board, simulated.views, simulated.rows, {.left_out = false});
    for (const vn::CameraBlock& block : found.blocks) kept += block.kept ? 1 : 0;
    tried += static_cast<int>(found.blocks.size());
  }
  EXPECT_GE(tried, 20);
  EXPECT_LE(kept, 1);  // at 1 % each, more have a probability of 2 %
}

TEST(CalibrateByCamera, FindsTangentialDistortion) {
  ViewSetup setup;  // whose camera has p1 = 4e-4, p2 = -6e-4
  setup.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
  setup.images = 30;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SimulatedViews simulated = exact_arm(setup, seed);
    const vn::CameraReport found =
        vn::calibrate_hand_eye(setup.board, simulated.views, simulated.rows, {.left_out = false});
    for (const vn::CameraBlock& block : found.blocks)
      EXPECT_EQ(block.kept, block.name == "tangential distortion") << block.name;
    EXPECT_NEAR(found.cameras[0].p1, setup.camera.p1, 4.5 * found.camera_std[0](6));
  }
}

TEST(CalibrateByCamera, RefusesWhatImagesDoNotDetermine) {
  ViewSetup setup;
  setup.board = {.rows = 7, .columns = 9, .square = 0.03};
  setup.images = 12;
  setup.places = 1;
  const SimulatedViews simulated = exact_arm(setup, 10);
  const auto complaint_of = [&](const SimulatedViews& of, const vn::CameraOptions& options) {
    try {
      (void)vn::calibrate_hand_eye(setup.board, of.views, of.rows, options);
    } catch (const std::exception& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  SimulatedViews few = simulated;
  few.views.views.resize(3);
  EXPECT_NE(complaint_of(few, {}).find("3 images of a known pose of the arm; at least 4"), std::string::npos);
  vn::Camera other = setup.camera;
  other.width = 640;
  EXPECT_NE(complaint_of(simulated, {.cameras = {other}}).find("has 1600 x 1200 pixels, the intrinsics are of 640"),
            std::string::npos);
  SimulatedViews shuffled = simulated;
  std::rotate(shuffled.rows.flanges.begin(), shuffled.rows.flanges.begin() + 5, shuffled.rows.flanges.end());
  EXPECT_NE(complaint_of(shuffled, {.cameras = {setup.camera}}).find("do not agree with the poses of the arm"),
            std::string::npos);
  EXPECT_NE(complaint_of(simulated, {.free = {"k4"}}).find("no intrinsic is called 'k4'"), std::string::npos);
  EXPECT_NE(complaint_of(simulated, {.choose = false, .held = vn::HeldCameras{}, .left_out = false})
                .find("0 held cameras for 1 of the corners"),
            std::string::npos);
  EXPECT_NE(complaint_of(simulated, {.choose = false, .held = vn::HeldCameras{{setup.camera}}})
                .find("held cameras beside choose or left_out"),
            std::string::npos);
}

}  // namespace
}  // namespace camera_calibration_test
