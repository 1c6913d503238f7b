// SPDX-License-Identifier: BSD-3-Clause
// A camera on the flange and two printed boards calibrate an arm; nothing is known of the camera.

#include <cstdio>
#include <string>
#include <vector>
#include <vernier/calibration/camera_calibration.hpp>
#include <vernier/camera/board_view.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/views.hpp>
#include <vernier/simulation/virtual_robot.hpp>

namespace vn = vernier;

int main() {
  const vn::Robot<6> robot = vn::robots::ur10();
  const vn::DhChain<6> actual = vn::with_geometric_errors(robot.chain, {}, 4);  // the arm as it was made

  // what stands in the cell: the camera 80 mm before the flange, and boards where many configurations see them
  const vn::Camera camera{.fx = 1400, .fy = 1405, .cx = 810, .cy = 590, .k1 = -0.1, .width = 1600, .height = 1200};
  const vn::Board board{.rows = 10, .columns = 13, .square = 0.03, .scale_sigma = 1e-4};
  const vn::BoardView view{.camera = camera, .board = board};
  const vn::Isometry3 flange_T_camera(Eigen::Translation3d(0.05, 0, 0.08));
  const vn::JointRows<6> candidates = vn::sample_joints(robot.limits, 30000, 1);
  std::vector<vn::Isometry3> flanges;
  for (vn::Index i = 0; i < candidates.rows(); ++i) flanges.push_back(actual.pose(candidates.row(i).transpose()));
  const vn::BoardPlaces places = vn::propose_places(view, true, flange_T_camera, flanges, candidates, 2, 0);  // tables

  // 60 images, with the joint values that the controller shows
  const vn::CameraSetup setup{.cameras = {camera},
                              .camera_names = {"camera"},
                              .board = board,
                              .board_names = {"left table", "right table"},
                              .in_base = places.in_base,
                              .in_flange = {flange_T_camera}};
  std::vector<vn::Shot> shots;
  vn::ImageRows rows{.joints = vn::MatrixX(60, 6)};
  for (std::size_t i = 0; i < flanges.size() && shots.size() < 60; ++i) {
    if (places.place[i] < 0) continue;
    rows.joints.row(rows.size()) = candidates.row(static_cast<vn::Index>(i));
    shots.push_back({.flange = flanges[i], .board = places.place[i]});
    rows.images.push_back("image" + std::to_string(shots.size()) + ".png");
  }
  rows.joints.conservativeResize(rows.size(), 6);
  const vn::CornerViews views = vn::simulate_views(setup, shots, 0.1, 1);

  const auto found = vn::calibrate_by_camera(robot, board, views, rows);
  std::puts(found.summary().c_str());
  const vn::DhChain<6>& links = found.model.identified().model();
  std::printf("\nlink    a: designed, made, identified [mm]\n");
  for (int j = 1; j < 3; ++j)
    std::printf("  %d  %21.3f %8.3f %10.3f\n", j + 1, robot.chain.row(j).a * 1e3, actual.row(j).a * 1e3,
                links.row(j).a * 1e3);
}
