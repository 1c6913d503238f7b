// SPDX-License-Identifier: BSD-3-Clause
// Rigid registration of points against what defines it: the least sum of squares, and hand-made cases.

#include "vernier/core/register_points.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "complaint.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::register_points_test {
namespace {

using vernier_test::complaint;
using vernier_test::RealMatrix;

double sum_of_squares(const PointRows& from, const PointRows& to, const Isometry3& motion) {
  double sum = 0;
  for (Index i = 0; i < from.rows(); ++i) sum += (transformed(motion, point(from, i)) - point(to, i)).squaredNorm();
  return sum;
}

// Deviations so large that every point counts: no small motion lowers the sum of squares, at any number of points.
TEST(RegisterPoints, HasTheLeastSumOfSquares) {
  Rng rng(5);
  for (const Index n : {3, 4, 9}) {
    PointRows from(n, 3), to(n, 3);
    const Isometry3 motion = rigid_motion(exp_so3(Vector3(1.2, -0.7, 2)), Vector3(3, -1, 0.5));
    for (Index i = 0; i < n; ++i) {
      set_point(from, i, Vector3(rng.normal(), rng.normal(), rng.normal()));
      const Vector3 deviation(rng.normal(), rng.normal(), rng.normal());
      set_point(to, i, Vector3(transformed(motion, point(from, i)) + 0.3 * deviation));
    }
    const Isometry3 found = register_points(from, to);
    const RealMatrix turn(rotation(found));
    EXPECT_LT((turn * turn.transpose() - RealMatrix::identity(3)).norm(), 1e-13);
    const double least = sum_of_squares(from, to, found);
    for (int axis = 0; axis < 3; ++axis)
      for (const double step : {-1e-3, 1e-3}) {
        Vector3 along = Vector3::Zero();
        along(axis) = step;
        // about the centroid, where turns and shifts do not help each other
        const Vector3 centre = centroid(to);
        const Matrix3 small = exp_so3(along);
        const Vector3 turned = small * centre, back = centre - turned;
        EXPECT_GT(sum_of_squares(from, to, composed(rigid_motion(small, back), found)), least) << n;
        EXPECT_NEAR(sum_of_squares(from, to, composed(rigid_motion(Matrix3::Identity(), along), found)) - least,
                    static_cast<double>(n) * step * step, 1e-12)
            << n;
      }
  }
}

// In a plane the angle is that of the sums of cross and inner products; both sets about their centroids.
TEST(RegisterPoints, InAPlaneIsAnArcTangent) {
  const double x[] = {1, -2, 0.5, 0.5}, y[] = {0.3, 1, -2, 0.7}, u[] = {0.1, -1.2, 2.3, -1.2},
               v[] = {1.2, -1.4, 0.6, -0.4};
  PointRows from(4, 3), to(4, 3);
  double cross = 0, inner = 0;
  for (Index i = 0; i < 4; ++i) {
    set_point(from, i, Vector3(x[i], y[i] + 5, 0));
    set_point(to, i, Vector3(u[i] - 3, v[i], 0));
    cross += x[i] * v[i] - y[i] * u[i];
    inner += x[i] * u[i] + y[i] * v[i];
  }
  const Isometry3 found = register_points(from, to);
  EXPECT_NEAR(std::atan2(found(1, 0), found(0, 0)), std::atan2(cross, inner), 1e-13);
  EXPECT_NEAR(found(2, 2), 1, 1e-13);
  EXPECT_LT((transformed(found, Vector3(0, 5, 0)) - Vector3(-3, 0, 0)).norm(), 1e-13);
}

TEST(RegisterPoints, RefusesNoPointsAndOtherNumbers) {
  EXPECT_NE(complaint([] { (void)register_points(PointRows(0, 3), PointRows(0, 3)); }), "");
  EXPECT_NE(complaint([] { (void)register_points(PointRows::Zero(2, 3), PointRows::Zero(3, 3)); }).find("2 and 3"),
            std::string::npos);
}

// One point says nothing of the rotation, but the point is met.
TEST(RegisterPoints, MeetsOnePoint) {
  PointRows from(1, 3), to(1, 3);
  set_point(from, 0, Vector3(1, 2, 3));
  set_point(to, 0, Vector3(-4, 0, 1));
  EXPECT_LT((transformed(register_points(from, to), Vector3(1, 2, 3)) - Vector3(-4, 0, 1)).norm(), 1e-14);
}

// A mirrored matrix in general position: the rotation M with the largest trace of M' A is the nearest; no small or
// large turn of it comes nearer.
TEST(NearestRotation, OfAMirroredMatrixIsARotationAndTheNearest) {
  Rng rng(6);
  for (int trial = 0; trial < 5; ++trial) {
    const RealMatrix turns[] = {exp_so3(2 * vernier_test::random_direction(rng)),
                                exp_so3(2 * vernier_test::random_direction(rng))};
    const RealMatrix mirrored = turns[0] * RealMatrix::diagonal(vernier_test::vector({3, 2, -0.5})) * turns[1];
    const RealMatrix found(nearest_rotation(mirrored));
    EXPECT_LT((found * found.transpose() - RealMatrix::identity(3)).norm(), 1e-14);
    EXPECT_NEAR(found.determinant(), 1, 1e-14);
    const double distance = (found - mirrored).norm();
    EXPECT_NEAR(distance, std::sqrt(2.0 * 2 + 1 * 1 + 1.5 * 1.5), 1e-13);
    for (const double angle : {1e-3, 0.1, 1.0, 3.0})
      for (int k = 0; k < 50; ++k) {
        const RealMatrix turn(exp_so3(angle * vernier_test::random_direction(rng)));
        EXPECT_GT((turn * found - mirrored).norm(), distance);
      }
  }
}

TEST(NearestRotation, UndoesASmallStretch) {
  // R S with S symmetric positive definite: R is the nearest, whatever S
  const RealMatrix turn(exp_so3(Vector3(0.4, 2, -1)));
  const RealMatrix stretch(3, 3, {2, 0.3, -0.1, 0.3, 1, 0.2, -0.1, 0.2, 0.5});
  EXPECT_LT((RealMatrix(nearest_rotation(turn * stretch)) - turn).norm(), 1e-14);
  // a reflection of the axis that counts least
  const RealMatrix mirrored = RealMatrix::diagonal(vernier_test::vector({3, -0.5, 2}));
  EXPECT_LT((RealMatrix(nearest_rotation(mirrored)) - RealMatrix::identity(3)).norm(), 1e-14);
}

}  // namespace
}  // namespace vernier::register_points_test
