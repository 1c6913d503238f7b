// SPDX-License-Identifier: BSD-3-Clause
// The subproblems of closed-form inverse kinematics where nothing solves them, or everything: against a search over all
// angles.

#include "vernier/kinematics/detail/subproblems.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::subproblems_test {
namespace {

using detail::AnglePair;
using detail::rotation_about;
using vernier_test::random_direction;

constexpr double pi = std::numbers::pi;
constexpr double negligible = 1e-10;

Vector3 random_point(Rng& rng) { return rng.uniform(0.1, 1) * random_direction(rng); }

double turn_difference(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

/// The smallest value of a function of an angle, on a grid.
template <class F>
double least_on_grid(const F& f) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 360; ++i) least = std::min(least, f(2 * pi * i / 360));
  return least;
}

TEST(Subproblems, AngleThatBringsVectorsNearestWhereTheyDiffer) {
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    const Vector3 k = random_direction(rng), a = random_point(rng), b = random_point(rng);
    const auto missing = [&](double angle) { return (rotation_about(k, angle) * a - b).norm(); };
    const auto found = detail::angle_between(k, a, b, negligible);
    EXPECT_FALSE(found.any);
    EXPECT_LE(missing(found.angle), least_on_grid(missing) + 1e-14);
  }
}

TEST(Subproblems, BeyondTheBoundaryOfAPlaneTheNearestAngleAndByHowMuch) {
  Rng rng(7);
  for (int i = 0; i < 200; ++i) {
    const Vector3 h = random_direction(rng), k = random_direction(rng), p = random_point(rng);
    const double centre = h.dot(k) * k.dot(p), radius = (h - k * k.dot(h)).norm() * (p - k * k.dot(p)).norm();
    if (radius < 0.01) continue;
    for (const double side : {-1.0, 1.0}) {
      for (const double margin : {1e-6, 0.01, 0.5}) {
        const double d = centre + side * radius * (1 + margin);
        const auto missing = [&](double x) { return std::abs(h.dot(rotation_about(k, x) * p) - d); };
        const AnglePair pair = detail::angles_to_plane(h, k, p, d, negligible);
        EXPECT_FALSE(pair.any);
        EXPECT_NEAR(pair.margin, margin, 1e-10);
        EXPECT_LE(missing(pair.centre + pair.half), least_on_grid(missing) + 1e-14);
        EXPECT_LT(turn_difference(pair.centre + pair.half, pair.centre - pair.half), 1e-15);
      }
    }
  }
}

TEST(Subproblems, BeyondTheBoundaryOfADistanceTheNearestAngle) {
  Rng rng(8);
  for (int i = 0; i < 200; ++i) {
    const Vector3 k = random_direction(rng), a = random_point(rng), b = random_point(rng);
    const auto distance = [&](double x) { return (rotation_about(k, x) * a - b).norm(); };
    const double least = least_on_grid(distance), most = -least_on_grid([&](double x) { return -distance(x); });
    for (const double d : {1.1 * most, 0.9 * least}) {
      const auto missing = [&](double x) { return std::abs(distance(x) - d); };
      const AnglePair pair = detail::angles_to_distance(k, a, b, d, negligible);
      EXPECT_GT(pair.margin, 0);
      EXPECT_LE(missing(pair.centre + pair.half), least_on_grid(missing) + 1e-14);
      EXPECT_LT(turn_difference(pair.centre + pair.half, pair.centre - pair.half), 1e-15);
    }
  }
}

TEST(Subproblems, AnyAngleWhereThePointDoesNotMove) {
  Rng rng(9);
  for (int i = 0; i < 100; ++i) {
    const Vector3 h = random_direction(rng), k = random_direction(rng), p = random_point(rng);
    const double length = rng.uniform(0.1, 1);
    // on the axis, or seen along it
    const AnglePair on_axis = detail::angles_to_plane(h, k, length * k, length * h.dot(k), negligible);
    EXPECT_TRUE(on_axis.any);
    EXPECT_EQ(on_axis.margin, 0);
    const AnglePair along = detail::angles_to_plane(k, k, p, k.dot(p), negligible);
    EXPECT_TRUE(along.any);
    EXPECT_EQ(along.margin, 0);
    // then no angle does where the plane is elsewhere
    const AnglePair elsewhere = detail::angles_to_plane(k, k, p, k.dot(p) + 0.01, negligible);
    EXPECT_TRUE(elsewhere.any);
    EXPECT_GT(elsewhere.margin, 1e6);

    const Vector3 b = length * k;
    const AnglePair circle = detail::angles_to_distance(k, p, b, (p - b).norm(), negligible);
    EXPECT_TRUE(circle.any);
    EXPECT_TRUE(detail::angles_to_distance(k, b, p, (p - b).norm(), negligible).any);
    EXPECT_GT(detail::angles_to_distance(k, p, b, (p - b).norm() + 0.01, negligible).margin, 1e6);
  }
}

}  // namespace
}  // namespace vernier::subproblems_test
