// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// A simulated arm that carries a camera past boards that stand still, or a board past a camera.

#include <cmath>
#include <string>
#include <vector>

#include "projection.hpp"
#include "vernier/camera/corner_views.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier_test {

/// Images of a simulated arm.
struct SimulatedViews {
  vernier::CornerViews views;
  vernier::ImageRows rows;
  std::vector<vernier::Isometry3> bases;  ///< P = base flange tool, one a place of the board, or one of the camera
  vernier::Isometry3 tool;
};

/// What is simulated.
struct ViewSetup {
  vernier::Board board{.rows = 10, .columns = 13, .square = 0.03, .scale_sigma = 1e-5};  ///< 9 x 12 corners
  vernier::Camera camera = machine_camera();
  bool on_flange = true;
  int places = 2;      ///< of the board, where the camera is on the flange
  int images = 60;     ///< of all places together
  double noise = 0.2;  ///< [px]
};

/// Pose of what the flange carries, in its frame.
inline vernier::Isometry3 carried(const ViewSetup& setup) {
  using vernier::Vector3;
  const vernier::Matrix3 turn = vernier::exp_so3(Vector3(0.15, -0.1, 0.4));
  if (setup.on_flange) return vernier::rigid_motion(turn, Vector3(0.05, 0.03, 0.06));
  return vernier::rigid_motion(turn, Vector3(0.02, -0.03, 0.05) - turn * setup.board.middle());
}

/// Whether a board is well seen: most of it in the image, neither too near nor too far nor too flat.
inline bool well_seen(const ViewSetup& setup, const vernier::Isometry3& camera_T_board) {
  using vernier::Index;
  const vernier::Vector3 middle = camera_T_board * setup.board.middle();
  if (!(middle.z() > 0.35 && middle.z() < 1.2) || std::abs(camera_T_board(2, 2)) < 0.5) return false;
  int inside = 0;
  for (const Index k : {Index{0}, setup.board.columns - 2, setup.board.corners() - setup.board.columns + 1,
                        setup.board.corners() - 1, setup.board.corners() / 2}) {
    const vernier::Vector3 at = camera_T_board * setup.board.corner(k);
    if (!(at.z() > 0.1)) return false;
    const vernier::Vector2 pixel = seen_at(setup.camera, at);
    if (pixel(0) > 0 && pixel(1) > 0 && pixel(0) < static_cast<double>(setup.camera.width - 1) &&
        pixel(1) < static_cast<double>(setup.camera.height - 1))
      ++inside;
  }
  return inside >= 4;
}

/// Views of an arm at configurations drawn within limits.
template <class Chain>
SimulatedViews simulated_views(const Chain& actual, const vernier::JointLimits<Chain::dof>& limits,
                               const ViewSetup& setup, std::uint64_t seed) {
  using vernier::Index, vernier::Isometry3, vernier::JointVector, vernier::Vector3;
  vernier::Rng rng(seed);
  SimulatedViews out;
  out.tool = carried(setup);
  out.views.boards.clear();
  out.rows.joints.resize(setup.images, Chain::dof);
  const auto drawn = [&] {
    JointVector<Chain::dof> q;
    for (int j = 0; j < Chain::dof; ++j)
      q(j) = rng.uniform((std::max)(limits.lower(j), -3.0), (std::min)(limits.upper(j), 3.0));
    return q;
  };
  const int places = setup.on_flange ? setup.places : 1;
  const auto seen_from = [&](const Isometry3& base, const JointVector<Chain::dof>& q) {
    const Isometry3 pose = base * actual.pose(q) * out.tool;
    return setup.on_flange ? pose.inverse() : pose;
  };
  Index image = 0;
  for (int place = 0; place < places; ++place) {
    Isometry3 base;  // the place, of some, that most configurations see
    int most = -1;
    for (int trial = 0; trial < 12; ++trial) {
      const Isometry3 end = actual.pose(drawn()) * out.tool;
      const double about_y = rng.uniform(-0.3, 0.3), about_x = rng.uniform(-0.3, 0.3);
      const vernier::Matrix3 turn = vernier::exp_so3(Vector3(about_x, about_y, 0.2));
      const Isometry3 camera_T_board = vernier::rigid_motion(turn, Vector3(0, 0, 0.6) - turn * setup.board.middle());
      // on the flange: base_T_board is where the camera sees it; else the camera is where it sees the board
      const Isometry3 candidate = setup.on_flange ? (end * camera_T_board).inverse() : camera_T_board * end.inverse();
      int count = 0;
      for (int k = 0; k < 3000; ++k) count += well_seen(setup, seen_from(candidate, drawn())) ? 1 : 0;
      if (count > most) {
        most = count;
        base = candidate;
      }
    }
    out.bases.push_back(base);
    out.views.boards.push_back("place " + std::to_string(place + 1));
    const Index until = static_cast<Index>(setup.images) * (place + 1) / places;
    while (image < until) {
      const JointVector<Chain::dof> q = drawn();
      if (!well_seen(setup, seen_from(base, q))) continue;
      vernier::View view = view_of(setup.camera, setup.board, seen_from(base, q), setup.noise, rng);
      view.image = "image" + std::to_string(image) + ".png";
      view.board = place;
      view.width = setup.camera.width;
      view.height = setup.camera.height;
      out.views.views.push_back(std::move(view));
      out.rows.images.push_back("image" + std::to_string(image) + ".png");
      out.rows.joints.row(image++) = q.transpose();
    }
  }
  return out;
}

/// Mean position error of an identified chain at 1,000 random configurations, base and tool point registered [m].
template <class Chain>
double error_after_registration(const Chain& identified, const Chain& actual,
                                const vernier::JointLimits<Chain::dof>& limits, std::uint64_t seed) {
  vernier::JointLimits<Chain::dof> finite = limits;
  for (int j = 0; j < Chain::dof; ++j) {
    finite.lower(j) = (std::max)(limits.lower(j), -3.0);
    finite.upper(j) = (std::min)(limits.upper(j), 3.0);
  }
  const vernier::Framed<Chain> truth(actual, {}, vernier::Isometry3(Eigen::Translation3d(0.02, 0.03, 0.12)));
  const auto data = vernier::measure(truth, vernier::sample_joints(finite, 1000, seed), {.with_orientations = false});
  const auto registered = vernier::identify(vernier::Framed<Chain>(identified, {}, truth.tool_frame()), data,
                                            {.frames = vernier::Frames::base_and_tool, .geometry = false},
                                            {.loss = vernier::Loss::squared}, vernier::own_solver);
  return vernier::prediction_error(registered.model, data).mean;
}

}  // namespace vernier_test
