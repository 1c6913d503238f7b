// SPDX-License-Identifier: BSD-3-Clause
// Measurements between two configurations: distances of two positions of the tool point, wherever the base stands.

#include <gtest/gtest.h>

#include <cmath>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/measurements/measurements.hpp"
#include "vernier/measurements/pose_sensor.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::pairs_test {
namespace {

using vernier_test::RealMatrix;

const auto robot = robots::ur10();
const Framed<DhChain<6>> nominal(robot.chain, {}, FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0, 0}));

JointRows<6> joints(Index n, std::uint64_t seed) { return sample_joints(robot.limits, n, seed); }

/// Distances between positions of an arm, as by a tracker whose place changes, or a ball-bar that is set twice.
template <class Model>
Measurements<6> between(const Model& arm, const JointRows<6>& from, const JointRows<6>& to) {
  const PointRows a = positions(arm, from), b = positions(arm, to);
  VectorX lengths(a.rows());
  for (Index i = 0; i < a.rows(); ++i) lengths(i) = (point(a, i) - point(b, i)).norm();
  return Measurements<6>().add_between(from, to, DistanceSensor(lengths, 1e-5));
}

// All terms are there: the tool, links, gravity, hysteresis and transmissions, which act through both configurations.
TEST(Pairs, JacobianIsTheDerivativeOfTheResiduals) {
  const auto measured = between(nominal, joints(20, 1), joints(20, 2));
  std::vector<GeometricUnknown> unknowns;
  for (Index k = ArmParameters::chain_begin; k < ArmParameters::chain_end(6) + 3; ++k)
    unknowns.push_back({k, -1, 1e-3, 0});
  ArmParameterisation arm({ArmGeometry(nominal)}, unknowns);
  JointTerms terms(6);
  terms.gear_ratio = terms.coupling = true;
  terms.gravity.emplace(robot.chain, Vector3(0, 0, -1));
  terms.transmission = {Fourier::up_to(2), Fourier::up_to(3), Fourier{},
                        Fourier::up_to(1), Fourier{},         Fourier::up_to(2)};
  arm.set_terms(terms, VectorX::Constant(terms.size(), 1e-3), VectorX::Ones(terms.size()));
  Rng rng(5);
  VectorX start(arm.size());
  for (double& x : start) x = rng.uniform(-0.3, 0.3);
  arm.move(start);
  detail::CalibrationProblem problem(arm, measured.sets(), Loss::squared);
  EXPECT_EQ(problem.measured_values(), 20);
  const RealMatrix jacobian = problem.stacked(true).jacobian;
  const auto residuals = [&](Index k, double by) {
    RealMatrix step(arm.size(), 1);
    step(k) = by;
    problem.arm = arm;
    problem.arm.move(step);
    return RealMatrix(problem.stacked(false).residuals);
  };
  for (Index k = 0; k < arm.size(); ++k) {
    const double h = 1e-3;
    const RealMatrix slope = (residuals(k, h) - residuals(k, -h)) / (2 * h), column = jacobian.col(k);
    EXPECT_LT((slope - column).norm(), 1e-5 * (1 + column.norm())) << arm.names()[static_cast<std::size_t>(k)];
  }
}

TEST(Pairs, IdentifyAnArmWithoutItsBase) {
  const auto actual = nominal.around(with_geometric_errors(robot.chain, {}, 4));
  const auto found = identify(nominal, between(actual, joints(150, 1), joints(150, 2)),
                              {.frames = Frames::tool, .priors = false}, {.loss = Loss::squared}, own_solver);
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_GT(found.rms_before, 0.5e-3);
  const auto fresh = between(actual, joints(100, 3), joints(100, 4)).sets().front();
  SensedRows sensed;
  for (Index i = 0; i < 100; ++i) {
    const JointVector<6> from = fresh.seen_from.row(i), to = fresh.joints.row(i);
    fresh.sense(i, composed(inverse_of(found.model.pose(from)), found.model.pose(to)), sensed);
    EXPECT_LT(std::abs(sensed.residual(0)), 1e-9) << i;
  }
}

TEST(Pairs, MisuseIsNamed) {
  const JointRows<6> three = joints(3, 1), two = joints(2, 1);
  EXPECT_EQ(vernier_test::complaint(
                [&] { (void)Measurements<6>().add_between(two, three, DistanceSensor(VectorX::Ones(3)), "bar"); }),
            "bar: 2 first configurations and 3 second");
  EXPECT_EQ(vernier_test::complaint([&] {
              (void)Measurements<6>().add_between(three, three, PositionSensor(PointRows::Zero(3, 3)), "tracker");
            }),
            "tracker: between two configurations a sensor has one value, not 3");
  JointRows<6> unknown = three;
  unknown(1, 4) = std::nan("");
  EXPECT_EQ(vernier_test::complaint(
                [&] { (void)Measurements<6>().add_between(unknown, three, DistanceSensor(VectorX::Ones(3)), "bar"); }),
            "bar, row 1: a joint value of the first configuration is not finite");
  EXPECT_FALSE(between(nominal, three, joints(3, 2)).sets().front().locates());
}

}  // namespace
}  // namespace vernier::pairs_test
