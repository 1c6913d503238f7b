// SPDX-License-Identifier: BSD-3-Clause
// The reduction of images to blocks of six rows against the dense problem, and its derivatives against differences.

#include "vernier/camera/detail/camera_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "projection.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::machine_camera;

namespace camera_problem_test {
namespace {

const vn::Board board{.rows = 7, .columns = 5, .square = 0.036};

/// Two cameras and two places; some images of 3 to 5 corners.
struct Images {
  explicit Images(bool mounted_on_flange) : on_flange(mounted_on_flange) {
    vn::Rng rng(11);
    state.arm = vn::ArmGeometry(vn::Framed(vn::robots::ur10().chain));
    state.cameras = {machine_camera(), machine_camera()};
    state.cameras[1].fx = 1300;
    state.shape.scale = 1e-3;
    state.shape.bend = vn::Vector3(1e-4, 2e-4, -1e-4);
    rows.joints.resize(6, 6);
    for (vn::Index k = 0; k < rows.joints.size(); ++k) rows.joints.data()[k] = rng.uniform(-1.5, 1.5);
    const std::vector<vn::Isometry3> flanges = state.arm->poses(rows.joints);
    // both frames differ by shifts alone, so that every combination is in view
    const vn::Isometry3 first = vernier_test::board_before_camera(board, 0.7, rng);
    const vn::Isometry3 nearly = vn::rigid_motion(vn::exp_so3(vn::Vector3(0.05, 0.02, 0.1)), {0.01, 0.02, 0.01});
    views.reserve(6);
    for (std::size_t i = 0; i < 6; ++i) {
      vn::View view = vernier_test::view_of(machine_camera(), board, first * nearly, 0.5, rng);
      view.camera = static_cast<vn::Index>(i % 2);
      view.board = static_cast<vn::Index>(i / 3);
      const std::size_t kept = i < 3 ? 3 + i : view.corners.size();
      view.corners.resize(kept);
      view.pixels.resize(kept);
      views.push_back(view);
    }
    state.bases.resize(2);
    state.tools.resize(2);
    const vn::Isometry3 seen = on_flange ? first.inverse() : first;
    state.tools[0] = vn::rigid_motion(vn::exp_so3(vn::Vector3(0.3, -0.2, 0.5)), {0.05, 0.02, 0.1});
    state.tools[1] = state.tools[0];
    for (std::size_t b = 0; b < 2; ++b) state.bases[b] = seen * (flanges[0] * state.tools[0]).inverse();
    for (std::size_t i = 0; i < 6; ++i) rows.joints.row(static_cast<vn::Index>(i)) = rows.joints.row(0);
    for (std::size_t i = 0; i < 6; ++i)
      for (vn::Index j = 0; j < 6; ++j) rows.joints(static_cast<vn::Index>(i), j) += rng.uniform(-0.01, 0.01);
    for (std::size_t i = 0; i < 6; ++i) {
      const vn::View& view = views[i];
      placed.push_back({&view, static_cast<vn::Index>(i), on_flange ? view.board : view.camera,
                        on_flange ? view.camera : view.board});
    }
    priors.cameras = state.cameras;
    priors.intrinsics = vn::VectorX::Constant(9, 10);
    priors.arm_means = state.arm->parameters();
    priors.arm_scales = vn::VectorX::Constant(state.arm->num_parameters(), 1e-3);
    for (vn::Index k = 6; k < 36; ++k) priors.arm.push_back(k);
  }

  vn::detail::CameraProblem problem() const {
    vn::detail::CameraProblem out(on_flange, board, placed, rows, state, priors);
    out.free.intrinsics.fill(true);
    out.free.scale = out.free.bend = out.free.arm = true;
    out.loss = vn::Loss::squared;
    return out;
  }

  bool on_flange;
  vn::detail::CameraState state;
  vn::detail::CameraPriors priors;
  vn::ImageRows rows;
  std::vector<vn::View> views;
  std::vector<vn::detail::PlacedView> placed;
};

class CameraProblemOf : public ::testing::TestWithParam<bool> {};

TEST_P(CameraProblemOf, ReducedImagesIsTheDenseProblem) {
  const Images images(GetParam());
  const vn::detail::CameraProblem problem = images.problem();
  const vn::MatrixX rows = problem.dense_rows();
  ASSERT_EQ(rows.rows(), problem.values());
  ASSERT_EQ(rows.cols(), problem.unknowns() + 1);
  ASSERT_EQ(problem.names().size(), static_cast<std::size_t>(problem.unknowns()));
  const vn::Index n = problem.unknowns();
  const vn::NormalEquations normal = problem.normal_equations();
  const vn::MatrixX square = rows.transpose() * rows;
  const double size = square.topLeftCorner(n, n).cwiseAbs().maxCoeff();
  EXPECT_LT((normal.matrix - square.topLeftCorner(n, n)).cwiseAbs().maxCoeff(), 1e-9 * size);
  EXPECT_LT((normal.gradient - square.col(n).head(n)).cwiseAbs().maxCoeff(),
            1e-9 * square.col(n).cwiseAbs().maxCoeff());
  EXPECT_NEAR(normal.cost, square(n, n), 1e-9 * square(n, n));
}

TEST_P(CameraProblemOf, ImagesHasTheDerivativesOfItsResiduals) {
  const Images images(GetParam());
  const vn::detail::CameraProblem problem = images.problem();
  const vn::MatrixX rows = problem.dense_rows();
  const vn::VectorX scales = problem.scales();
  const auto stacked = [&](const vn::detail::CameraState& state) {
    vn::detail::CameraProblem moved = problem;
    moved.state = state;
    const vn::MatrixX out = moved.dense_rows();
    return vn::VectorX(out.col(out.cols() - 1));
  };
  vn::Index column = 0;
  const auto check = [&](const auto& change, const char* what) {  // change(state, by): an unknown moved by `by`
    const double step = 1e-3 * scales(column);
    vn::detail::CameraState up = problem.state, down = problem.state;
    change(up, step);
    change(down, -step);
    const vn::VectorX slope = (stacked(up) - stacked(down)) / 2e-3;
    EXPECT_LT((slope - rows.col(column)).cwiseAbs().maxCoeff(), 1e-5 * (1 + rows.col(column).cwiseAbs().maxCoeff()))
        << what << ", " << problem.names()[static_cast<std::size_t>(column)];
    ++column;
  };
  for (const vn::Index k : problem.priors.arm)
    check(
        [&](vn::detail::CameraState& state, double by) {
          vn::VectorX values = state.arm->parameters();
          values(k) += by;
          state.arm = state.arm->with_parameters(values);
        },
        "chain");
  for (const bool base : {true, false})
    for (std::size_t frame = 0; frame < 2; ++frame)
      for (vn::Index axis = 0; axis < 6; ++axis)
        check(
            [&](vn::detail::CameraState& state, double by) {
              vn::Isometry3& pose = base ? state.bases[frame] : state.tools[frame];
              vn::Vector3 direction(0, 0, 0);
              direction(axis % 3) = by;
              if (axis < 3)
                pose.translation() += direction;
              else
                pose.linear() = vn::exp_so3(direction) * pose.linear();
            },
            "frame");
  for (std::size_t c = 0; c < 2; ++c)
    for (vn::Index k = 0; k < 9; ++k)
      check(
          [&](vn::detail::CameraState& state, double by) {
            vn::VectorX values = state.cameras[c].parameters();
            values(k) += by;
            state.cameras[c] = state.cameras[c].with_parameters(values);
          },
          "camera");
  check([](vn::detail::CameraState& state, double by) { state.shape.scale += by; }, "shape");
  for (vn::Index k = 0; k < 3; ++k)
    check([&](vn::detail::CameraState& state, double by) { state.shape.bend(k) += by; }, "shape");
  EXPECT_EQ(column, problem.unknowns());
}

TEST_P(CameraProblemOf, ImagesMeasuresOnTheBoard) {
  const Images images(GetParam());
  vn::detail::CameraProblem problem = images.problem();
  problem.state.shape = {};
  const vn::Isometry3 pose = problem.poses()[5];
  // pixels of points that are off by a known shift on the board
  vn::View shifted = images.views[5];
  const vn::Isometry3 to_camera = images.on_flange ? pose.inverse() : pose;
  for (std::size_t i = 0; i < shifted.corners.size(); ++i)
    shifted.pixels[i] = vernier_test::seen_at(
        problem.state.cameras[1], to_camera * (board.corner(shifted.corners[i]) + vn::Vector3(3e-4, -4e-4, 0)));
  const vn::detail::PlacedView view{&shifted, 5, images.placed[5].base, images.placed[5].tool};
  const vn::VectorX errors = problem.board_errors(view, pose);
  for (const double error : errors) EXPECT_NEAR(error, 5e-4, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(BothMounts, CameraProblemOf, ::testing::Bool());

}  // namespace
}  // namespace camera_problem_test
