// SPDX-License-Identifier: BSD-3-Clause
// What a fit estimated, seen from elsewhere: many visits at once, another arm with the same unknowns.

#include "vernier/error_model/error_model_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::error_model_estimate_test {
namespace {

using vernier_test::RealMatrix;
using vernier_test::vector;
using Chain = DhChain<6>;

const Chain chain = robots::abb_irb120().chain;
const FrameParameters here(Vector6{0.4, -0.3, 0.2, 0.3, -0.4, 0.6}), there(Vector6{-1, 0.7, 0.1, -0.5, 0.2, 2});
const FrameParameters tool(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5});

/// a a'
RealMatrix square(const RealMatrix& a) { return a * a.transpose(); }

// Seventy visits seen from the second of two stations. Uncertain are its height, a loop of the first joint, and how its
// base moves with temperature; what is not known of a visit, the approach or the temperature, adds its spread.
TEST(VisitCovariances, OfManyVisitsByHand) {
  const Framed<Chain> second(chain, there, tool);
  ErrorModelEstimate estimate{
      .arm = ArmParameterisation({ArmGeometry(Framed<Chain>(chain, here, tool)), ArmGeometry(second)},
                                 {{2, 0, 1e-3, 0}, {2, 1, 1e-3, 0}, {1, 0, 1e-6, 0, true}, {1, 1, 1e-6, 0, true}})};
  JointTerms terms(6);
  terms.hysteresis = {0.05};
  estimate.arm.set_terms(terms, VectorX::Constant(6, 1e-4), VectorX::Ones(6));
  VectorX steps = VectorX::Zero(10);
  steps(2) = 50;
  steps(3) = 8;   // 8 um/K along y
  steps(4) = 20;  // half a loop of 2 mrad
  estimate.arm.move(steps);
  estimate.covariance = RealMatrix::diagonal(vector({100, 0.25, 100, 4, 9, 0, 0, 0, 0, 0}));
  estimate.position_sigma = 0.3e-4;
  estimate.joint_sigma = 2e-5;
  estimate.orientation_sigma = 1e-4;
  estimate.fallback_error = 1.6e-3;
  estimate.mean_temperature = 20;
  estimate.temperature_std = 3;

  constexpr Index n = 70;
  Rng rng(1);
  JointRows<6> joints(n, 6), previous(n, 6);
  VectorX gates(n), celsius(n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < 6; ++j) {
      joints(i, j) = rng.uniform(-1, 1);
      previous(i, j) = joints(i, j) + rng.uniform(-0.1, 0.1);
    }
    if (i % 5 == 2) previous(i, 3) = std::numeric_limits<double>::quiet_NaN();  // not known as a whole
    gates(i) = rng.uniform();
    celsius(i) = i % 3 == 2 ? std::numeric_limits<double>::quiet_NaN() : rng.uniform(15, 25);
  }
  const auto found = estimate.visit_covariances(joints, gates, 1, previous, celsius);
  const auto if_known = estimate.visit_covariances(joints, gates, 1, previous, celsius, MatrixX(), false);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(n));
  const RealMatrix x = vector({1, 0, 0, 0, 0, 0}), y = vector({0, 1, 0, 0, 0, 0}), z = vector({0, 0, 1, 0, 0, 0});
  for (Index i = 0; i < n; ++i) {
    JointVector<6> q = configuration(joints, i);
    const double step = std::tanh((q(0) - previous(i, 0)) / 0.05);
    q(0) += 2e-3 * step;
    const RealMatrix jacobian = second.jacobian(q), first = jacobian.col(0);
    RealMatrix wanted = 4e-10 * square(jacobian);
    if (i % 5 == 2) wanted += 4e-6 * square(first);
    const double warmer = celsius(i) - 20, suppressed = 1e-3 * (1 - gates(i));
    if (!std::isfinite(warmer)) wanted += 64e-12 * 9 * square(y);
    for (Index r = 0; r < 6; ++r) wanted(r, r) += r < 3 ? 9e-10 + suppressed * suppressed : 1e-8;
    EXPECT_LT((if_known[static_cast<std::size_t>(i)] - wanted).norm(), 1e-9 * wanted.norm()) << i;
    wanted += 0.25e-6 * square(z) + 9e-8 * step * step * square(first);
    if (std::isfinite(warmer)) wanted += 4e-12 * warmer * warmer * square(y);
    EXPECT_LT((found[static_cast<std::size_t>(i)] - wanted).norm(), 1e-9 * wanted.norm()) << i;
    const RealMatrix one = estimate.visit_covariance(configuration(joints, i), gates(i), 1,
                                                     VectorX(configuration(previous, i)), celsius(i));
    EXPECT_LT((one - wanted).norm(), 1e-9 * wanted.norm()) << i;
  }
  // of the first station its own height counts
  const RealMatrix first = estimate.model_covariance(configuration(joints, 0), 0);
  EXPECT_NEAR(first(2, 2), 1e-4, 1e-12);
}

// The same unknowns at other values: of the arm moved to another place and with another zero.
TEST(ErrorModelEstimate, OfAnotherArmHasItsValues) {
  JointTerms terms(6);
  terms.transmission[3] = Fourier::up_to(1);
  const ArmGeometry arm(Framed<Chain>(chain, here, tool));
  ErrorModelEstimate before{
      .arm = ArmParameterisation({arm}, {{0, -1, 1e-3, 0}, {7, -1, 2e-3, 4}, {8, -1, 1e-5, 1, true}})};
  before.arm.set_terms(terms, vector({1e-3, 2e-3}), vector({3, 5}));
  before.arm.move(vector({2, 3, 4, 5, 6}));
  before.covariance = RealMatrix::diagonal(vector({1, 2, 3, 4, 5}));
  before.position_sigma = 0.25;
  VectorX moved = before.arm.geometry(0).parameters();
  moved(0) += 0.5;
  moved(9) -= 0.01;
  const FittedArm now{arm.with_parameters(moved), JointErrors(terms, vector({7e-3, -4e-3}))};
  const ErrorModelEstimate after = before.of_arm(now);
  EXPECT_EQ(RealMatrix(after.arm.geometry(0).parameters()), RealMatrix(moved));
  EXPECT_LT((RealMatrix(after.arm.joint_errors().coefficients()) - vector({7e-3, -4e-3})).norm(), 1e-15);
  EXPECT_NEAR(after.arm.thermal_rates(0)(8), 4e-5, 1e-15);
  EXPECT_EQ(after.arm.thermal_rates(0)(7), 0);
  EXPECT_EQ(RealMatrix(after.arm.precisions()), vector({0, 4, 1, 3, 5}));
  EXPECT_EQ(RealMatrix(after.arm.scales()), vector({1e-3, 2e-3, 1e-5, 1e-3, 2e-3}));
  EXPECT_EQ(RealMatrix(after.covariance), RealMatrix(before.covariance));
  EXPECT_EQ(after.position_sigma, 0.25);
  const FittedArm other{arm, JointErrors()};
  EXPECT_EQ(vernier_test::complaint([&] { (void)before.of_arm(other); }),
            "of_arm: 0 terms of joint errors, expected 2");
}

}  // namespace
}  // namespace vernier::error_model_estimate_test
