// SPDX-License-Identifier: BSD-3-Clause
// A fit that follows small changes of its measurements, under a robust loss too.
#include "vernier/error_model/detail/refit.hpp"

#include <gtest/gtest.h>

#include "gauss_newton.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::refit_test {
namespace {

TEST(Refit, FollowsAShiftThatHardlyChangesTheSumOfSquares) {
  const auto robot = robots::abb_irb120();
  const JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0.4e-3, .harmonics = 2};
  const DhChain<6> links = with_geometric_errors(robot.chain, {}, 1);
  const WithJointErrors<DhChain<6>> actual(links, draw_joint_errors(links, sizes, 2));
  const Dataset<6> data =
      measure(actual, sample_joints(robot.limits, 80, 3), {.position = 0.03e-3, .orientation = 0.05e-3}, 4)
          .without_approach();
  for (const Loss loss : {Loss::squared, Loss::huber}) {
    const SensorModel sensors{.loss = loss};
    const auto start = vernier_test::identify_by_gauss_newton(Framed<DhChain<6>>(robot.chain), data,
                                                              {.frames = Frames::base_and_tool}, sensors);
    const ErrorModelEstimate fitted = fit_error_model(
        start, data, {.compliance = false, .harmonics = 3, .hysteresis = false, .tilt = false, .drift = false},
        sensors);
    ASSERT_TRUE(detail::can_refit(fitted));
    ASSERT_FALSE(fitted.arm.joint_errors().empty());
    ErrorModelEstimate same = fitted, moved = fitted;
    detail::refit(same, Measurements<6>(data).sets(sensors), sensors, {});
    const Vector3 shift(2e-8, -4e-8, 0);
    PointRows positions = data.positions();
    positions.rowwise() += shift.transpose();
    const Dataset<6> shifted = Dataset<6>(data.joints(), positions, data.orientations()).without_approach();
    detail::refit(moved, Measurements<6>(shifted).sets(sensors), sensors, {});
    EXPECT_TRUE(moved.converged);
    const auto before = same.arm.poses(0, data.joints()), after = moved.arm.poses(0, data.joints());
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_LT((after[i].translation() - before[i].translation() - shift).norm(), 0.05 * shift.norm());
  }
}

TEST(Refit, DoesNotStandForAFitWithDriftOrAnEarlierCalibration) {
  ErrorModelEstimate estimate{.arm = ArmParameterisation({ArmGeometry(Framed<DhChain<6>>(robots::ur5().chain))}, {})};
  EXPECT_TRUE(detail::can_refit(estimate));
  estimate.prior = PriorTransfer{.name = "last year", .used = false};
  EXPECT_TRUE(detail::can_refit(estimate));
  estimate.prior->used = true;
  EXPECT_FALSE(detail::can_refit(estimate));
  estimate.prior.reset();
  estimate.temperature_std = 1;
  EXPECT_FALSE(detail::can_refit(estimate));
  estimate.temperature_std = 0;
  estimate.drift.emplace_back();
  EXPECT_FALSE(detail::can_refit(estimate));
}

}  // namespace
}  // namespace vernier::refit_test
