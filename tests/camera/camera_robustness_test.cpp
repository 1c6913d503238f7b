// SPDX-License-Identifier: BSD-3-Clause
// What a bent board, a wrong scale, wrong corners and flipped boards cost the geometry of arms, in shares of what is
// left without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "simulated_views.hpp"
#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/camera/planar_pose.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::SimulatedViews;
using vernier_test::ViewSetup;

namespace camera_robustness_test {
namespace {

/// Changes an image, which shows the board at a pose.
using Change = std::function<void(vn::View& view, const vn::Isometry3& camera_T_board, vn::Rng& rng)>;

class ImagesOfArms : public ::testing::Test {
 protected:
  ImagesOfArms() {
    setup_.board = {.rows = 7, .columns = 9, .square = 0.03, .scale_sigma = 1e-4};
    setup_.images = 60;
  }
  /// Root mean square over arms of the errors after a calibration [m].
  /// @param stated the board that the calibration is told of
  double error(const vn::Board& stated, const Change& change = {}, int arms = 2) {
    double squares = 0;
    for (std::uint64_t arm = 1; arm <= static_cast<std::uint64_t>(arms); ++arm) {
      const auto actual = vn::with_geometric_errors(robot_.chain, {}, 200 + arm);
      SimulatedViews simulated = vernier_test::simulated_views(actual, robot_.limits, setup_, arm);
      vn::Rng rng(arm);
      for (std::size_t i = 0; i < simulated.views.views.size() && change; ++i) {
        vn::View& view = simulated.views.views[i];
        const vn::JointVector<6> q = simulated.rows.joints.row(static_cast<vn::Index>(i)).transpose();
        const vn::Isometry3 pose =
            simulated.bases[static_cast<std::size_t>(view.board)] * actual.pose(q) * simulated.tool;
        change(view, pose.inverse(), rng);
      }
      const auto found = vn::calibrate_by_camera(robot_, stated, simulated.views, simulated.rows, {.left_out = false});
      last_ = found;
      const double one =
          vernier_test::error_after_registration(found.model.identified().model(), actual, robot_.limits, 7);
      squares += one * one / arms;
    }
    return std::sqrt(squares);
  }

  vn::Robot<6> robot_ = vn::robots::abb_irb120();
  ViewSetup setup_{};
  std::optional<vn::CameraReport> last_{};
};

TEST_F(ImagesOfArms, OfABentBoardAreNearlyAsGood) {
  const double flat = error(setup_.board);
  EXPECT_LT(flat, 0.08e-3);
  const double bent = error(setup_.board, [&](vn::View& view, const vn::Isometry3& camera_T_board, vn::Rng& rng) {
    for (std::size_t k = 0; k < view.corners.size(); ++k) {
      vn::Vector3 corner = setup_.board.corner(view.corners[k]);
      const double x = (corner(0) - setup_.board.middle()(0)) / setup_.board.half_diagonal();
      corner(2) = 0.5e-3 * x * x;
      const auto [a, b] = rng.normal_pair();
      view.pixels[k] = vernier_test::seen_at(setup_.camera, camera_T_board * corner) + setup_.noise * vn::Vector2(a, b);
    }
  });
  EXPECT_LT(bent, 1.3 * flat);
  EXPECT_NEAR(last_->board_bend(0), 0.5e-3, 0.1e-3);
}

TEST_F(ImagesOfArms, OfAPrintTooLargeAreAsGoodIfALengthWasMeasured) {
  setup_.board.square *= 1.003;
  vn::Board measured = setup_.board, known = setup_.board, nominal = setup_.board;
  known.scale_sigma = 0;
  const double best = error(known);
  EXPECT_LT(error(measured), 1.3 * best);
  const double effect = last_->scale_effect;
  measured.square *= 1 + measured.scale_sigma;  // no image tells that the length is off by its standard deviation
  EXPECT_LT(error(measured), std::hypot(best, 1.2 * effect));
  nominal.square /= 1.003;
  nominal.scale_sigma = 3e-3;  // without a length the report carries what lengths of the arm do not tell
  const double unmeasured = error(nominal);
  EXPECT_LT(unmeasured, 2 * last_->scale_effect);
  EXPECT_LT(std::abs(last_->board_scale - 1.003), 3 * last_->board_scale_std);
  EXPECT_GT(last_->scale_effect, 3 * effect);
}

TEST_F(ImagesOfArms, WithWrongCornersOrFlippedBoardsAreNearlyAsGood) {
  constexpr int arms = 4;
  const double clean = error(setup_.board, {}, arms);
  EXPECT_LT(error(
                setup_.board,
                [](vn::View& view, const vn::Isometry3&, vn::Rng& rng) {
                  for (vn::Vector2& pixel : view.pixels)
                    if (rng.uniform() < 0.05) pixel += vn::Vector2(rng.uniform(-30, 30), rng.uniform(-30, 30));
                },
                arms),
            1.1 * clean);
  // every twentieth image shows the board in the other pose that its corners allow
  EXPECT_LT(error(
                setup_.board,
                [&, count = 0](vn::View& view, const vn::Isometry3&, vn::Rng& rng) mutable {
                  if (count++ % 20 != 7) return;
                  const auto poses = vn::board_poses(setup_.camera, setup_.board, view.corners, view.pixels);
                  if (!std::isfinite(poses[1].rms)) return;
                  for (std::size_t k = 0; k < view.corners.size(); ++k) {
                    const auto [a, b] = rng.normal_pair();
                    view.pixels[k] = vernier_test::seen_at(setup_.camera, poses[1].camera_T_board *
                                                                              setup_.board.corner(view.corners[k])) +
                                     setup_.noise * vn::Vector2(a, b);
                  }
                },
                arms),
            1.1 * clean);
}

}  // namespace
}  // namespace camera_robustness_test
