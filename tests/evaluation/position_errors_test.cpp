// SPDX-License-Identifier: BSD-3-Clause
// Error statistics against cases worked by hand, and the errors they are made of.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vernier/compensation/compensated.hpp>
#include <vernier/core/rng.hpp>
#include <vernier/core/so3.hpp>
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/evaluation/quantile.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/virtual_robot.hpp>

#include "real_matrix.hpp"

namespace statistics_test {
namespace {

using namespace vernier;
using namespace vernier::literals;
using vernier_test::RealMatrix;

TEST(ErrorStatistics, WorkedByHand) {
  VectorX errors(5);
  errors << 3, 1, 10, 2, 4;  // sorted: 1 2 3 4 10
  const auto e = ErrorStatistics::of(errors);
  EXPECT_EQ(e.n, 5);
  EXPECT_DOUBLE_EQ(e.mean, 4);
  EXPECT_DOUBLE_EQ(e.rms, std::sqrt(26.0));  // (9 + 1 + 100 + 4 + 16) / 5
  EXPECT_DOUBLE_EQ(e.max, 10);
  EXPECT_DOUBLE_EQ(e.min, 1);
  EXPECT_DOUBLE_EQ(e.median, 3);
  EXPECT_DOUBLE_EQ(e.p95, 4 + 0.8 * 6);  // at 0.95 * 4 = 3.8
}

TEST(Quantile, OfValuesInAnyOrderBothEndsIncluded) {
  VectorX values(5);
  values << 7, -1, 3, 5, 4;  // sorted: -1 3 4 5 7
  EXPECT_EQ(quantile(values, 0), -1);
  EXPECT_EQ(quantile(values, 1), 7);
  EXPECT_EQ(quantile(values, 0.5), 4);
  EXPECT_DOUBLE_EQ(quantile(values, 0.2), 2.2);  // at 0.8
  EXPECT_THROW((void)quantile(values, 1.01), std::invalid_argument);
  EXPECT_THROW((void)quantile(values, -0.01), std::invalid_argument);
  EXPECT_THROW((void)quantile(VectorX(), 0.5), std::invalid_argument);
  for (const Index k : {0, 3}) {
    VectorX broken = values;
    broken(k) = std::nan("");
    EXPECT_THROW((void)quantile(broken, 0.5), std::invalid_argument);
  }
  for (const double probability : {0.0, 0.3, 1.0}) EXPECT_EQ(quantile(VectorX::Constant(1, 7), probability), 7);
}

// Between two infinite values lies an infinite one.
TEST(Quantile, OfInfiniteValues) {
  const double infinity = std::numeric_limits<double>::infinity();
  VectorX values(4);
  values << 1, infinity, 2, infinity;
  EXPECT_EQ(quantile(values, 0.9), infinity);
  EXPECT_EQ(quantile(values, 0.5), infinity);  // half of the way to one
  EXPECT_DOUBLE_EQ(quantile(values, 0.2), 1.6);
  VectorX odd(3);
  odd << infinity, 1, 2;
  EXPECT_EQ(quantile(odd, 0.5), 2);  // at a value, whatever comes next
}

Matrix3 diagonal(const Vector3& values) {
  Matrix3 out = Matrix3::Zero();
  for (int k = 0; k < 3; ++k) out(k, k) = values(k);
  return out;
}

// Quantiles of the chi-square distribution (1, 2 and 3 degrees of freedom: 3.841459, 5.991465, 7.814728) where the
// approximation by two moments is exact but for Wilson and Hilferty's, and shares of samples elsewhere.
TEST(Radius95, ContainsNinetyFivePerCent) {
  EXPECT_NEAR(radius_95(Matrix3::Identity()), std::sqrt(7.814728), 3e-3 * 2.8);
  EXPECT_NEAR(radius_95(diagonal({4, 4, 0})), 2 * std::sqrt(5.991465), 6e-3 * 4.9);
  EXPECT_NEAR(radius_95(diagonal({0, 9, 0})), 3 * std::sqrt(3.841459), 2e-2 * 5.9);
  EXPECT_EQ(radius_95(Matrix3::Zero()), 0);
  const Matrix3 metres = diagonal({1, 4, 9});
  EXPECT_NEAR(radius_95(1e-6 * metres), 1e-3 * radius_95(metres), 1e-15);  // in millimetres it is a thousandth
  EXPECT_TRUE(std::isnan(radius_95(diagonal({-1, -1, -1}))));
  Rng rng(5);
  for (const Vector3& sigma : {Vector3(1, 2, 3), Vector3(1, 1, 4), Vector3(0.1, 2, 2)}) {
    Matrix3 root = exp_so3(Vector3(0.3, -0.5, 0.9));
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) root(r, c) *= sigma(c);
    const double radius = radius_95(root * root.transpose());
    int inside = 0;
    constexpr int samples = 40000;
    for (int i = 0; i < samples; ++i)
      inside += Vector3(sigma.x() * rng.normal(), sigma.y() * rng.normal(), sigma.z() * rng.normal()).norm() < radius;
    EXPECT_NEAR(inside / double(samples), 0.95, 0.008) << sigma.x() << ' ' << sigma.z();
  }
}

TEST(ErrorStatistics, OneErrorIsAllOfThem) {
  const auto e = ErrorStatistics::of(VectorX::Constant(1, 0.25));
  for (const double value : {e.mean, e.rms, e.max, e.min, e.median, e.p95}) EXPECT_EQ(value, 0.25);
  EXPECT_EQ(e.n, 1);
}

TEST(ErrorStatistics, NoErrorsThrow) {
  EXPECT_THROW((void)ErrorStatistics::of(VectorX(0)), std::invalid_argument);
  EXPECT_THROW((void)prediction_error(robots::ur5().chain, Dataset<6>{}), std::invalid_argument);
}

constexpr DhChain<2> planar{{{{.a = 300_mm}, {.a = 200_mm}}}};

/// Where the planar arm is at (0, 0) and at (90, 0) deg, seen with known errors.
Dataset<2> two_poses() {
  JointRows<2> q(2, 2);
  q << 0, 0, 90_deg, 0;
  PointRows p(2, 3), r(2, 3);
  p << 0.503, 0, 0.004,  // off by (3, 0, 4) mm
      0, 0.500, -0.001;  // off by (0, 0, -1) mm
  r << 0.002, 0, 0,      // turned by 2 mrad about x
      0, 0, 90_deg - 0.005;
  return {q, p, r};
}

TEST(PredictionError, OfAModel) {
  const auto data = two_poses();
  const VectorX errors = position_errors(planar, data);
  EXPECT_NEAR(errors(0), 0.005, 1e-15);
  EXPECT_NEAR(errors(1), 0.001, 1e-15);
  const auto e = prediction_error(planar, data);
  EXPECT_NEAR(e.mean, 0.003, 1e-15);
  EXPECT_EQ(e.n, 2);
}

/// Not a model: says where the arm goes and which command to send, nothing else.
struct Shifted {
  static constexpr int dof = 2;
  Isometry3 predict(const JointVector<2>& q) const noexcept {
    Isometry3 pose = planar.pose(q);
    pose(2, 3) += 0.004;
    return pose;
  }
  Correction<2> correct(const JointVector<2>& q) const noexcept { return {2 * q, IkStatus::converged, 0, 1}; }
};
static_assert(Compensator<Shifted> && !KinematicModel<Shifted> && PosePredictor<Shifted>);

TEST(PredictionError, OfACompensator) {
  const VectorX errors = position_errors(Shifted{}, two_poses());
  EXPECT_NEAR(errors(0), 0.003, 1e-15);
  EXPECT_NEAR(errors(1), 0.005, 1e-15);
}

/// Reaches farther by a hundredth of the joint values it came from.
struct Approached {
  static constexpr int dof = 2;
  JointVector<2> from = JointVector<2>::Zero();
  Isometry3 pose(const JointVector<2>& q) const {
    Isometry3 out = planar.pose(q);
    out(2, 3) += from(0) / 100 + from(1) / 1000;
    return out;
  }
  Isometry3 predict(const JointVector<2>& q) const { return pose(q); }
  Approached approached_from(const JointVector<2>& previous) const { return {previous}; }
};

TEST(PredictionError, OfAModelWithApproachOfEverySample) {
  const auto data = two_poses();
  JointRows<2> previous(2, 2);
  previous << 0.4, 0, 0, 2;  // 4 mm and 2 mm up
  const VectorX errors = position_errors(Approached{}, data.approached_from(previous));
  EXPECT_NEAR(errors(0), 0.003, 1e-15);
  EXPECT_NEAR(errors(1), 0.003, 1e-15);
}

TEST(RotationErrors, AreAngles) {
  const VectorX errors = rotation_errors(planar, two_poses());
  EXPECT_NEAR(errors(0), 0.002, 1e-15);
  EXPECT_NEAR(errors(1), 0.005, 1e-15);
  EXPECT_NEAR(rotation_errors(Shifted{}, two_poses())(0), 0.002, 1e-15);
}

TEST(RotationErrors, NeedOrientations) {
  const Dataset<2> positions_only(two_poses().joints(), two_poses().positions());
  EXPECT_THROW((void)rotation_errors(planar, positions_only), std::invalid_argument);
}

TEST(PositioningErrors, CommandTheActualArm) {
  auto p = planar.parameters();
  p(0) += 0.003;  // the first link is 3 mm longer
  p(8) += 0.010;  // the second zero is 10 mrad off
  const auto actual = planar.with_parameters(p);
  JointRows<2> targets(2, 2), commands(2, 2);
  targets << 0.3, 0.7, 0.3, 0.7;
  commands << 0.3, 0.7,  // as the nominal arm would be commanded
      0.3, 0.69;         // the zero corrected
  const auto errors = positioning_errors(actual, planar, commands, targets);
  EXPECT_NEAR(errors.rotation(0), 0.010, 1e-14);
  EXPECT_NEAR(errors.rotation(1), 0, 1e-14);
  EXPECT_NEAR(errors.position(1), 0.003, 1e-14);
  // 3 mm along the first link, and the second link's swing
  EXPECT_NEAR(errors.position(0),
              std::hypot(0.003 * std::cos(0.3) + 0.2 * (std::cos(1.01) - std::cos(1.0)),
                         0.003 * std::sin(0.3) + 0.2 * (std::sin(1.01) - std::sin(1.0))),
              1e-14);
  EXPECT_THROW((void)positioning_errors(actual, planar, JointRows<2>(1, 2), targets), std::invalid_argument);
}

TEST(CorrectedCommands, RowByRow) {
  JointRows<2> targets(2, 2);
  targets << 0.1, 0.2, 0.3, 0.4;
  EXPECT_EQ(RealMatrix::of(corrected_commands(Shifted{}, targets)), 2 * RealMatrix::of(targets));
}

}  // namespace
}  // namespace statistics_test
