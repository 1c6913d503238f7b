// SPDX-License-Identifier: BSD-3-Clause
// Candidates of a joint, and wrists: what is taken, left out and sampled.
#include "vernier/kinematics/detail/wrist.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::wrist_test {
namespace {

using detail::angle_samples;
using detail::Candidates;
using detail::rotation_about;

constexpr double pi = std::numbers::pi;

/// Whether angles divide a turn into equal parts, the middle of one of which is at `centre`.
void expect_spread_about(double centre, const double* angles) {
  constexpr double part = 2 * pi / angle_samples;
  double seen = 0;  // the parts, one bit each
  for (int k = 0; k < angle_samples; ++k) {
    const double parts = (angles[k] - centre) / part;
    EXPECT_NEAR(std::abs(parts - std::floor(parts)), 0.5, 1e-12) << k;
    seen += std::exp2(static_cast<double>(static_cast<int>(std::floor(parts)) & (angle_samples - 1)));
  }
  EXPECT_EQ(seen, std::exp2(angle_samples) - 1);
}

TEST(CandidatesWhiteBox, BeyondTheBoundaryAreTheNearestUpToFivePercent) {
  const Candidates near({0.7, 0, 0.04, false, 1}, 5);
  ASSERT_EQ(near.count, 1);
  EXPECT_EQ(near.angles[0], 0.7);
  EXPECT_EQ(near.margin, 0.04);
  const Candidates far({0.7, 0, 0.06, false, 1}, 5);
  EXPECT_EQ(far.count, 0);
  EXPECT_EQ(far.margin, 0.06);
  // farther, but in absolute terms within the width: with the largest margin there is
  const Candidates small({0.7, 0, 0.06, false, 0.1}, 5, 0.01);
  EXPECT_GE(small.count, 1);
  EXPECT_EQ(small.margin, 0.05);
}

TEST(CandidatesWhiteBox, NextToASingularitySamplesAreAllAround) {
  const Candidates sampled({0.7, 0.3, 0, false, 0.01}, 5, 0.02);
  ASSERT_EQ(sampled.count, 2 + angle_samples);
  EXPECT_EQ(sampled.exact, 2);
  expect_spread_about(0.7, sampled.angles + 2);
  EXPECT_EQ(sampled.margin_of(1), 0);
  EXPECT_EQ(sampled.margin_of(2), 1e-3);  // what marks a sample
  EXPECT_EQ(Candidates({0.7, 0.3, 0, false, 0.02}, 5, 0.01).count, 2);
}

// Next to the straight wrist: samples of joint 4 with joint 5 straight, joint 6 such that the sum is what it was.
TEST(WristWhiteBox, SamplesOfTheStraightWristMissByItsBend) {
  const auto wrist = detail::wrist_of({0, 0, 1}, {0, 1, 0}, {0, 0, 1});
  for (const bool backwards : {false, true})
    for (const double bend : {0.004, -0.004}) {
      const double straight = backwards ? pi : 0;
      const Matrix3 target =
          detail::times3(detail::times3(rotation_about(wrist.k4, 0.5), rotation_about(wrist.k5, straight + bend)),
                         rotation_about(wrist.k6, 0.9));
      const auto found = detail::solve_wrist(wrist, target, 0, 0.01);
      ASSERT_EQ(found.count, 2 + angle_samples);
      ASSERT_EQ(found.exact, 2);
      expect_spread_about(found.q4[0], found.q4 + 2);
      EXPECT_EQ(found.margin_of(0), 0);
      EXPECT_EQ(found.margin_of(2), 1e-3);
      for (int k = 0; k < found.count; ++k) {
        const Matrix3 reached =
            detail::times3(detail::times3(rotation_about(wrist.k4, found.q4[k]), rotation_about(wrist.k5, found.q5[k])),
                           rotation_about(wrist.k6, found.q6[k]));
        EXPECT_NEAR(rotation_difference(target, reached).norm(), k < 2 ? 0 : 0.004, 1e-5) << k;
        if (k >= 2) {
          EXPECT_NEAR(std::remainder(found.q5[k] - straight, 2 * pi), 0, 1e-15) << k;
        }
      }
      EXPECT_EQ(detail::solve_wrist(wrist, target, 0, 0.003).count, 2);
    }
}

// Only (-pi, pi] has an end that belongs to it.
TEST(WristWhiteBox, WrappedAnglesIncludeHalfATurn) {
  EXPECT_EQ(detail::wrapped_angle(pi), pi);
  EXPECT_EQ(detail::wrapped_angle(-pi), pi);
  EXPECT_NEAR(detail::wrapped_angle(7), 7 - 2 * pi, 1e-15);
  EXPECT_NEAR(detail::wrapped_angle(-7), 2 * pi - 7, 1e-15);
  EXPECT_EQ(detail::wrapped_angle(-3), -3);
}

}  // namespace
}  // namespace vernier::wrist_test
