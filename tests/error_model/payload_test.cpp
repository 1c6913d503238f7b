// SPDX-License-Identifier: BSD-3-Clause
// Deflection under a payload: predicted between two payloads that were measured, unknown beside one.

#include <gtest/gtest.h>

#include <cmath>

#include "complaint.hpp"
#include "irb120_fits.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::payload_test {
namespace {

using namespace vernier_test::irb120_fits;

/// Pose of an arm whose links bend: each has a spring at its end that gives way to moments about any axis. The payload
/// hangs 30 mm beside the tool point.
Isometry3 bent_pose(const Framed<Chain>& arm, const JointVector<6>& q, double payload) {
  constexpr double springs[] = {16e-6, 16e-6, 20e-6, 30e-6, 30e-6, 40e-6};  // [rad/(N m)]
  constexpr double weights[] = {60, 50, 40, 20, 10, 3};                     // of what is at each end [N]
  const auto links = arm.model().links(q);
  const Isometry3 flange = arm.model().pose(q);
  const Vector3 centre = flange * (arm.tool().translation() + Vector3(0.018, 0.024, 0));
  Vector3 turn = Vector3::Zero(), shift = Vector3::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector3 end = links.origin.col(i);
    Vector3 moment = (centre - end).cross(Vector3(0, 0, -9.80665 * payload));
    for (int j = i + 1; j < 6; ++j) moment += (links.origin.col(j) - end).cross(Vector3(0, 0, -weights[j]));
    const Vector3 bend = springs[i] * moment;
    turn += bend;
    shift += bend.cross(flange.translation() - end);
  }
  Isometry3 bent = flange;
  bent.linear() = exp_so3(turn) * flange.linear();
  bent.translation() += shift;
  return arm.base() * bent * arm.tool();
}

/// @param payloads of the rows in turn [kg]
Dataset<6> measured(Index poses, std::vector<double> payloads, std::uint64_t seed, double noise = 0.03e-3) {
  const Framed<Chain> arm(with_geometric_errors(robot.chain, {}, 4), base, tool);
  const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, poses, seed);
  Rng rng(seed);
  MatrixX carried = MatrixX::Constant(poses, 4, std::nan(""));
  PointRows positions(poses, 3), orientations(poses, 3);
  for (Index i = 0; i < poses; ++i) {
    carried(i, 0) = payloads[static_cast<std::size_t>(i) % payloads.size()];
    const Isometry3 pose = bent_pose(arm, configuration(joints, i), carried(i, 0));
    set_point(positions, i, translation(pose));
    set_point(orientations, i, log_so3(rotation(pose)));
    for (int k = 0; k < 3; ++k) {
      positions(i, k) += noise * rng.normal();
      orientations(i, k) += 0.05 / 0.03 * noise * rng.normal();
    }
  }
  return Dataset<6>(joints, positions, orientations).without_approach().carrying(carried);
}

FittedErrorModel<Chain> fitted(const Dataset<6>& data) {
  const ErrorModelOptions options{.harmonics = 0, .hysteresis = false, .drift = false, .num_validation_poses = 60};
  return fit_error_model(identified(data), data, options, squared);
}

double mean_error(const ErrorModel<Chain>& model, const Dataset<6>& data) {
  double sum = 0;
  for (Index i = 0; i < data.size(); ++i)
    sum += (model.carrying(Payload::of(data.payloads(), i)).position(data.joints(i)) - data.position(i)).norm();
  return sum / static_cast<double>(data.size());
}

// The fitted arm has springs at its joints, and the payload at the tool point.
TEST(Payload, BetweenTwoThatWereMeasuredIsPredicted) {
  const auto found = fitted(measured(120, {0, 0, 5, 5}, 1));  // every other pose validates
  const double empty = mean_error(found.model(), measured(100, {0}, 2, 0)),
               between = mean_error(found.model(), measured(100, {2.5}, 3, 0)),
               full = mean_error(found.model(), measured(100, {5}, 4, 0));
  EXPECT_LT(between, 1.2 * empty);
  EXPECT_LT(full, 1.5 * empty);  // springs about the joints' axes alone leave twice as much
  EXPECT_LT(empty, 0.05e-3);
  EXPECT_TRUE(found.model().identified().model().joint_errors().terms().bend.has_value());
  const ErrorModel<Chain>& model = found.model();
  ASSERT_TRUE(model.identified().model().joint_errors().terms().payload);
  EXPECT_NEAR(model.identified().model().joint_errors().terms().payload->reference().mass, 2.5, 1e-12);
  const JointVector<6> q = measured(1, {0}, 5).joints(0);
  EXPECT_GT((model.carrying({5}).position(q) - model.carrying({0}).position(q)).norm(), 0.3e-3);
  Dataset<6> silent = measured(100, {2.5}, 3);
  MatrixX none = silent.payloads();
  none.col(0).setZero();
  EXPECT_GT(mean_error(model, silent.carrying(none)), 2 * between);  // as if it carried nothing
  EXPECT_EQ((model.carrying({}).position(q) - model.carrying({0}).position(q)).norm(), 0);
}

// One payload: nothing is known of another, and the covariance says so.
TEST(Payload, BesideOneIsUnknown) {
  const Dataset<6> empty = measured(60, {0}, 1);
  const auto found = fitted(empty);
  const JointErrors& errors = found.model().identified().model().joint_errors();
  ASSERT_TRUE(errors.terms().payload);
  const JointVector<6> q = empty.joints(0);
  EXPECT_EQ((found.model().carrying({5}).position(q) - found.model().position(q)).norm(), 0);
  const auto radius = [&](double mass) {
    MatrixX carried = MatrixX::Constant(1, 4, std::nan(""));
    carried(0, 0) = mass;
    const Matrix6 covariance =
        found.visit_covariances(q.transpose(), VectorX::Ones(1), 0, MatrixX(), VectorX(), carried).front();
    return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  };
  const double at_zero = radius(0), at_five = radius(5);
  EXPECT_NEAR(at_zero, std::sqrt(found.visit_covariance(q, 1).topLeftCorner<3, 3>().trace()), 1e-12);
  EXPECT_GT(at_five, 3 * at_zero);
  EXPECT_NEAR(std::hypot(at_zero, 2 * std::sqrt(at_five * at_five - at_zero * at_zero)), radius(10), 1e-9);
  const double true_error = (found.model().position(q) - measured(60, {5}, 1).position(0)).norm();
  EXPECT_LT(true_error, 3 * at_five);
}

TEST(Payload, OfOneStationAloneIsRefused) {
  const Dataset<6> stated = measured(30, {0, 5}, 1), silent = measured(30, {0}, 2).carrying(MatrixX());
  const auto start = identified(stated);
  Measurements<6> both(stated);
  both.add(silent);
  EXPECT_NE(vernier_test::complaint([&] {
              (void)fit_error_model(start, both, {.harmonics = 0}, squared);
            }).find("states no payload, but"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::payload_test
