// The noise of a visit, from errors of poses left out.

#include "vernier/error_model/detail/visit_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::visit_noise_test {
namespace {

using vernier_test::RealMatrix;

RealMatrix random_matrix(Rng& rng, Index rows, Index cols, double size) {
  RealMatrix out(rows, cols);
  for (Index j = 0; j < cols; ++j)
    for (Index i = 0; i < rows; ++i) out(i, j) = size * rng.normal();
  return out;
}

/// Visits whose joints and position are off by normal errors.
std::vector<detail::LeftOutVisit> visits(double position, double joint, double model, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<detail::LeftOutVisit> out;
  for (int i = 0; i < 2000; ++i) {
    const RealMatrix jacobian = random_matrix(rng, 3, 6, 0.4), root = random_matrix(rng, 3, 3, model);
    const RealMatrix by_joints = jacobian * random_matrix(rng, 6, 1, joint),
                     by_model = root * random_matrix(rng, 3, 1, 1), in_space = random_matrix(rng, 3, 1, position);
    out.push_back({by_joints + by_model + in_space, root * root.transpose(), jacobian * jacobian.transpose()});
  }
  return out;
}

TEST(VisitNoiseWhiteBox, TellsSpaceFromJoints) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const detail::VisitNoise noise = detail::visit_noise(visits(30e-6, 40e-6, 15e-6, seed));
    EXPECT_NEAR(noise.position, 30e-6, 3e-6) << seed;
    EXPECT_NEAR(noise.joint, 40e-6, 4e-6) << seed;
  }
}

TEST(VisitNoiseWhiteBox, FindsOneAlone) {
  const detail::VisitNoise space = detail::visit_noise(visits(30e-6, 0, 0, 4));
  EXPECT_NEAR(space.position, 30e-6, 3e-6);
  EXPECT_LT(space.joint, 10e-6);  // in space: below 10 um of 30
  const detail::VisitNoise joints = detail::visit_noise(visits(0, 40e-6, 0, 5));
  EXPECT_LT(joints.position, 4e-6);
  EXPECT_NEAR(joints.joint, 40e-6, 4e-6);
}

TEST(VisitNoiseWhiteBox, NoneInNothing) {
  const detail::LeftOutVisit exact{Vector3::Zero(), Matrix3::Zero(), Matrix3::Identity()};
  for (const std::size_t n : {0, 2}) {
    const detail::VisitNoise none = detail::visit_noise(std::vector<detail::LeftOutVisit>(n, exact));
    EXPECT_EQ(none.position, 0);
    EXPECT_EQ(none.joint, 0);
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

}  // namespace
}  // namespace vernier::visit_noise_test
