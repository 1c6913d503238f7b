// SPDX-License-Identifier: BSD-3-Clause
// The noise of a visit, from errors of poses left out.

#include "vernier/error_model/detail/visit_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::visit_noise_test {
namespace {

using vernier_test::RealMatrix;
using vernier_test::vector;

TEST(VisitNoiseWhiteBox, NoneInNothing) {
  const detail::LeftOutVisit exact{Vector3::Zero(), Matrix3::Zero(), Matrix3::Identity()};
  for (const std::size_t n : {0, 2}) {
    const detail::VisitNoise none = detail::visit_noise(std::vector<detail::LeftOutVisit>(n, exact));
    EXPECT_EQ(none.position, 0);
    EXPECT_EQ(none.joint, 0);
  }
}

/// Visits off by as much as a model of some size, a noise in space and a noise of the joints explain together, along
/// each of three oblique axes and to both sides: their likelihood is largest exactly there.
void add_visits(std::vector<detail::LeftOutVisit>& to, const RealMatrix& model, const RealMatrix& joints, double factor,
                double position, double joint) {
  const RealMatrix axes = exp_so3(Vector3(0.4, -0.7, 0.5));
  const RealMatrix of_model = axes * RealMatrix::diagonal(model) * axes.transpose(),
                   of_joints = axes * RealMatrix::diagonal(joints) * axes.transpose();
  for (Index k = 0; k < 3; ++k)
    for (const double side : {-1.0, 1.0}) {
      const double variance = factor * model(k) + position * position + joint * joint * joints(k);
      to.push_back({side * std::sqrt(3 * variance) * axes.col(k), of_model, of_joints});
    }
}

// Some visits were predicted by a model much more uncertain than the noise, others by one that is known.
TEST(VisitNoiseWhiteBox, FindsByHowMuchTheModelIsBetterKnown) {
  for (const double factor : {1.0, 0.7, 0.5, 0.35, 0.25}) {
    const RealMatrix none = vector({0, 0, 0});
    std::vector<detail::LeftOutVisit> all;
    add_visits(all, vector({9, 4, 16}), none, factor, 0.5, 0);
    add_visits(all, vector({0.01, 0.02, 0.01}), none, factor, 0.5, 0);
    const detail::VisitNoise found = detail::visit_noise(all);
    EXPECT_EQ(found.model, factor);
    EXPECT_NEAR(found.position / 0.5, 1, 0.05) << factor;  // steps of variance of 1.2
    EXPECT_EQ(found.joint, 0) << factor;
  }
}

// Joints that act with different strength, up to where all of the errors are theirs; and noise in space, down to a
// hundredth of that.
TEST(VisitNoiseWhiteBox, FindsTheSharesOfSpaceAndJoints) {
  for (const auto& [position, joint] : {std::pair{1.0, 0.1}, {0.3, 0.7}, {0.1, 1.0}}) {
    const RealMatrix none = vector({0, 0, 0});
    std::vector<detail::LeftOutVisit> all;
    add_visits(all, none, vector({4, 1, 0.25}), 1, position, joint);
    add_visits(all, none, vector({0, 9, 1}), 1, position, joint);
    add_visits(all, none, vector({0.04, 0, 25}), 1, position, joint);
    const detail::VisitNoise found = detail::visit_noise(all);
    EXPECT_NEAR(found.position / position, 1, 0.12) << position;
    double square_sum = 0, effect = 0;  // tenths of what the joints would be if all were theirs
    for (const detail::LeftOutVisit& visit : all) {
      square_sum += visit.error.squaredNorm();
      effect += RealMatrix(visit.joint_noise).trace();
    }
    EXPECT_NEAR(found.joint * found.joint, joint * joint, 0.06 * square_sum / effect) << position;
  }
}

/// Of 100 visits off in space alone, some by 4 mm and the others by 1 mm, the radius of the ellipsoids that hold 95 %.
double radius_with_outliers(std::size_t outliers) {
  std::vector<detail::LeftOutVisit> all(100, {Vector3(0, 1e-3, 0), Matrix3::Zero(), Matrix3::Zero()});
  for (std::size_t k = 0; k < outliers; ++k) all[k].error *= 4;
  return std::sqrt(7.8147) * detail::visit_noise(all).position;
}

TEST(VisitNoiseWhiteBox, NineteenOfTwentyVisitsLieWithinTheirEllipsoids) {
  EXPECT_LT(radius_with_outliers(5), 2.6e-3);  // the likeliest noise holds the other 95
  EXPECT_GE(radius_with_outliers(6), 4e-3);    // widened, by no more than a step too much
  EXPECT_LT(radius_with_outliers(6), 4e-3 * 1.02);
}

// The noise of fewer than a hundred visits is not widened, nor is any to more than twice; that of the joints is widened
// by the same factor.
TEST(VisitNoiseWhiteBox, NoiseIsWidenedToTwiceItsDeviationAtMost) {
  std::vector<detail::LeftOutVisit> all(100, {Vector3(0, 1e-3, 0), Matrix3::Zero(), Matrix3::Zero()});
  for (std::size_t k = 0; k < 6; ++k) all[k].error *= 40;
  const std::vector<detail::LeftOutVisit> few(all.begin(), all.begin() + 99);
  const auto likely = [](const std::vector<detail::LeftOutVisit>& visits) {
    double sum = 0;
    for (const detail::LeftOutVisit& visit : visits) sum += visit.error.squaredNorm();
    return std::sqrt(sum / (3 * static_cast<double>(visits.size())));
  };
  EXPECT_NEAR(detail::visit_noise(few).position / likely(few), 1, 0.05);  // a step of the grid
  EXPECT_NEAR(detail::visit_noise(all).position / likely(all), 2, 0.1);
  // errors of joints alone, of which six visits have four times as much
  for (detail::LeftOutVisit& visit : all) {
    visit.error = Vector3(0, 1e-3, 0);
    visit.joint_noise(1, 1) = 1;
  }
  for (std::size_t k = 0; k < 6; ++k) all[k].error *= 4;
  const detail::VisitNoise wide = detail::visit_noise(all);
  EXPECT_GE(7.8147 * (wide.joint * wide.joint + wide.position * wide.position), 16e-6);
  EXPECT_LT(wide.position, 0.6 * wide.joint);
}

}  // namespace
}  // namespace vernier::visit_noise_test
