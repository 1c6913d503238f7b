// SPDX-License-Identifier: BSD-3-Clause
// The virtual actual robot: errors of the sizes asked for, noise with the statistics it claims, seeds that decide
// alone.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/core/rng.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/virtual_robot.hpp>

#include "complaint.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace virtual_robot_test {
namespace {

using namespace vernier;
using vernier_test::RealMatrix;

const DhChain<6> nominal = robots::abb_irb120().chain;

TEST(GeometricErrors, LieInTheirRangesWithBothSigns) {
  const GeometricErrors sizes;  // 0.5 to 1 mm, 1 to 3 mrad
  int positive_lengths = 0, positive_angles = 0, n = 0;
  VectorX parameters = nominal.parameters();
  parameters(5 * 1 + 4) = 0.01;  // beta of the second row
  const auto hayati = nominal.with_parameters(parameters);
  double smallest_length = 1, largest_length = 0, smallest_angle = 1, largest_angle = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto actual = with_geometric_errors(hayati, sizes, seed);
    for (int i = 0; i < 6; ++i) {
      for (const double off : {actual.row(i).a - nominal.row(i).a, actual.row(i).d - nominal.row(i).d}) {
        smallest_length = std::min(smallest_length, std::abs(off));
        largest_length = std::max(largest_length, std::abs(off));
        positive_lengths += off > 0;
      }
      for (const double off :
           {actual.row(i).alpha - nominal.row(i).alpha, actual.row(i).theta - nominal.row(i).theta}) {
        smallest_angle = std::min(smallest_angle, std::abs(off));
        largest_angle = std::max(largest_angle, std::abs(off));
        positive_angles += off > 0;
      }
      n += 2;
      EXPECT_EQ(actual.row(i).beta, hayati.row(i).beta);
      EXPECT_EQ(actual.row(i).joint, nominal.row(i).joint);
    }
  }
  const double rounding = 1e-15;  // of adding an error to a parameter
  EXPECT_GE(smallest_length, sizes.length_min - rounding);
  EXPECT_LE(largest_length, sizes.length_max + rounding);
  EXPECT_GE(smallest_angle, sizes.angle_min - rounding);
  EXPECT_LE(largest_angle, sizes.angle_max + rounding);
  // 1200 draws each fill the ranges to a hundredth, and signs are even within five deviations (17.3)
  EXPECT_LT(smallest_length, 0.505e-3);
  EXPECT_GT(largest_length, 0.995e-3);
  EXPECT_LT(smallest_angle, 1.02e-3);
  EXPECT_GT(largest_angle, 2.98e-3);
  EXPECT_NEAR(positive_lengths, n / 2, 87);
  EXPECT_NEAR(positive_angles, n / 2, 87);
}

TEST(GeometricErrors, SeedsDecideAlone) {
  EXPECT_TRUE(with_geometric_errors(nominal, {}, 1) == with_geometric_errors(nominal, {}, 1));
  EXPECT_FALSE(with_geometric_errors(nominal, {}, 1) == with_geometric_errors(nominal, {}, 2));
}

TEST(GeometricErrors, ZeroSizesChangeNothing) {
  EXPECT_TRUE(with_geometric_errors(nominal, {0, 0, 0, 0}, 1) == nominal);
}

TEST(GeometricErrors, UpsideDownRangesAreNamed) {
  for (const GeometricErrors& bad :
       {GeometricErrors{.length_min = 2e-3, .length_max = 1e-3}, GeometricErrors{.length_min = -1e-3},
        GeometricErrors{.angle_min = 4e-3, .angle_max = 3e-3}, GeometricErrors{.angle_min = -1e-3},
        GeometricErrors{.angle_max = std::nan("")}}) {
    EXPECT_THROW((void)with_geometric_errors(nominal, bad, 1), std::invalid_argument);
  }
  const std::string said = vernier_test::complaint(
      [] { (void)with_geometric_errors(nominal, {.length_min = 0.25, .length_max = 0.125}, 1); });
  EXPECT_NE(said.find("0.25, 0.125"), std::string::npos) << said;
}

JointRows<6> some_joints(Index n) {
  Rng rng(9);
  return vernier_test::random_joint_rows<6>(rng, n, 2.0);
}

TEST(Measure, WithoutNoiseIsTheModel) {
  const auto q = some_joints(50);
  const auto data = measure(nominal, q);
  ASSERT_EQ(data.size(), 50);
  ASSERT_TRUE(data.has_orientations());
  EXPECT_TRUE(RealMatrix(data.joints()) == q);
  for (Index i = 0; i < 50; ++i) {
    const Isometry3 pose = nominal.pose(data.joints(i));
    EXPECT_EQ(data.position(i), translation(pose));
    EXPECT_LT((data.orientation(i) - rotation(pose)).norm(), 1e-14);
  }
}

TEST(Measure, NoiseHasTheStatisticsItClaims) {
  const Index n = 4000;
  const double sigma = 0.03e-3, angular = 0.1e-3;
  const auto q = some_joints(n);
  const auto data = measure(nominal, q, {.position = sigma, .orientation = angular}, 17);
  PointRows off_rows(n, 3), turned_rows(n, 3);
  for (Index i = 0; i < n; ++i) {
    const Isometry3 pose = nominal.pose(data.joints(i));
    set_point(off_rows, i, (data.position(i) - translation(pose)) / sigma);
    const Matrix3 turn = data.orientation(i) * rotation(pose).transpose();
    set_point(turned_rows, i, log_so3(turn) / angular);
  }
  const RealMatrix off = off_rows, turned = turned_rows;
  // five deviations of each estimate from n unit normals
  const double mean_bound = 5 / std::sqrt(static_cast<double>(n)), variance_bound = mean_bound * std::sqrt(2.0);
  for (const RealMatrix* noise : {&off, &turned}) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(noise->col(k).mean(), 0, mean_bound);
      EXPECT_NEAR(noise->col(k).squared_norm() / static_cast<double>(n), 1, variance_bound);
      EXPECT_NEAR(noise->col(k).dot(noise->col((k + 1) % 3)) / static_cast<double>(n), 0, mean_bound);
    }
    EXPECT_GT(noise->largest(), 3);  // tails: 12,000 draws hardly stay below 3 sigma
    EXPECT_LT(noise->largest(), 6);
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(off.col(k).dot(turned.col(k)) / static_cast<double>(n), 0, mean_bound);
}

TEST(Measure, SeedsDecideAlone) {
  const auto q = some_joints(10);
  const MeasurementNoise noise{.position = 1e-3};
  const auto positions = [&](std::uint64_t seed) { return RealMatrix(measure(nominal, q, noise, seed).positions()); };
  EXPECT_TRUE(positions(1) == positions(1));
  EXPECT_FALSE(positions(1) == positions(2));
  // whether orientations are recorded does not change the positions of the first pose
  const auto without = measure(nominal, q, {.position = 1e-3, .with_orientations = false}, 1);
  EXPECT_FALSE(without.has_orientations());
  EXPECT_EQ(measure(nominal, q, noise, 1).position(0), without.position(0));
}

TEST(MeasureDistances, AreThoseFromTheAnchor) {
  const Vector3 anchor(0.5, -0.25, 1);
  const Index n = 2000;
  const auto q = some_joints(n);
  const auto exact = measure_distances(nominal, anchor, q);
  const double sigma = 0.05e-3;
  const auto noisy = measure_distances(nominal, anchor, q, sigma, 3),
             again = measure_distances(nominal, anchor, q, sigma, 3),
             other = measure_distances(nominal, anchor, q, sigma, 4);
  EXPECT_TRUE(RealMatrix(exact.joints()) == q);
  RealMatrix off(n, 1);
  for (Index i = 0; i < n; ++i) {
    EXPECT_NEAR(exact.lengths()(i), (nominal.position(configuration(q, i)) - anchor).norm(), 1e-15);
    off(i) = (noisy.lengths()(i) - exact.lengths()(i)) / sigma;
  }
  // five deviations of the estimates from n unit normals
  EXPECT_NEAR(off.mean(), 0, 5 / std::sqrt(2000.0));
  EXPECT_NEAR(off.squared_norm() / 2000, 1, 5 * std::sqrt(2 / 2000.0));
  EXPECT_EQ(RealMatrix(noisy.lengths()), RealMatrix(again.lengths()));
  EXPECT_NE(noisy.lengths()(0), other.lengths()(0));
}

}  // namespace
}  // namespace virtual_robot_test
