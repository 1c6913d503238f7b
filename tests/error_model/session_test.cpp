// SPDX-License-Identifier: BSD-3-Clause
// What a session leaves in its measurements: the direction of approach, and a base that drifts.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "irb120_fits.hpp"
#include "larger.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/detail/drift_selection.hpp"
#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::session_test {
namespace {

using namespace vernier_test::irb120_fits;
using vernier_test::RealMatrix;
using Arm = ErrorModel<Chain>::Arm;

/// An arm whose joints have loops of hysteresis of some half width [rad].
ErrorModel<Chain> arm_with_hysteresis(double half_width) {
  JointTerms terms(6);
  terms.hysteresis = {0.02};
  const JointErrors errors(terms, VectorX::Constant(6, half_width));
  return {robot.chain, Arm({with_geometric_errors(robot.chain, {}, 4), errors}, base, tool)};
}

/// Poses visited one after the other, in a base that moves: `motion(i)` is applied in front of pose i.
template <class Motion>
Dataset<6> visited(const ErrorModel<Chain>& actual, const JointRows<6>& joints, const JointRows<6>& previous,
                   std::uint64_t seed, const Motion& motion) {
  Rng rng(seed);
  PointRows positions(joints.rows(), 3), orientations(joints.rows(), 3);
  for (Index i = 0; i < joints.rows(); ++i) {
    const auto approached = actual.approached_from(configuration(previous, i));
    const Isometry3 pose = composed(motion(i), approached.pose(configuration(joints, i)));
    set_point(positions, i, translation(pose));
    set_point(orientations, i, log_so3(rotation(pose)));
    for (int k = 0; k < 3; ++k) {
      positions(i, k) += 0.02e-3 * rng.normal();
      orientations(i, k) += 0.05e-3 * rng.normal();
    }
  }
  return Dataset<6>(joints, positions, orientations).approached_from(previous);
}

JointRows<6> rows_before(const JointRows<6>& joints) {
  JointRows<6> out(joints.rows(), 6);
  for (Index j = 0; j < 6; ++j) {
    out(0, j) = std::numeric_limits<double>::quiet_NaN();
    for (Index i = 1; i < joints.rows(); ++i) out(i, j) = joints(i - 1, j);
  }
  return out;
}

const auto still = [](Index) { return Isometry3::Identity(); };

FittedErrorModel<Chain> fitted(const Dataset<6>& data) {
  return fit_error_model(identified(data), data, {.harmonics = 2, .num_validation_poses = 100}, squared);
}

/// All joint values of a configuration, or of several, changed by the same.
template <class Joints>
Joints shifted(Joints joints, double by) {
  for (Index k = 0; k < joints.size(); ++k) joints.data()[k] += by;
  return joints;
}

/// What is deployed does not know the drift: errors of poses left out are nearly its errors of the same poses, because
/// one of many poses changes little.
void expect_left_out_as_deployed(const FittedErrorModel<Chain>& found, const std::vector<Dataset<6>>& stations) {
  ASSERT_GT(found.left_out_rows.size(), 60u);
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < found.left_out_rows.size(); ++k) {
    Index row = found.left_out_rows[k];
    std::size_t station = 0;
    while (row >= stations[station].size()) row -= stations[station++].size();
    const Dataset<6>& data = stations[station];
    const Vector3 deployed = found.models()[station].position(configuration(data.joints(), row));
    const double error = (deployed - point(data.positions(), row)).norm();
    worst = vernier_test::larger(worst, std::abs(error - found.left_out_errors(static_cast<Index>(k))));
    largest = vernier_test::larger(largest, error);
  }
  EXPECT_LT(worst, 0.02e-3);
  EXPECT_GT(largest, 0.08e-3);
}

bool used(const FittedErrorModel<Chain>& found, const char* name) {
  const BlockChoice* block = choice_of(found, name);
  return block != nullptr && block->used;
}

JointRows<6> samples(Index n, std::uint64_t seed) { return abb_irb120_operating_region().sample(robot.chain, n, seed); }

TEST(Approach, HysteresisIsFoundWithItsWidth) {
  const JointRows<6> joints = samples(250, 1);
  const auto found = fitted(visited(arm_with_hysteresis(60e-6), joints, rows_before(joints), 2, still));
  ASSERT_TRUE(used(found, "approach"));
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(found.arm.joint_errors().half_loop(j), 60e-6, 20e-6) << j;
  // a pose from either side, against the arm
  const auto actual = arm_with_hysteresis(60e-6);
  const JointVector<6> q = configuration(joints, 7), below = shifted(q, -0.4), above = shifted(q, 0.4);
  const Vector3 loop = actual.approached_from(below).position(q) - actual.approached_from(above).position(q);
  const auto& model = found.model();
  EXPECT_LT((model.approached_from(below).position(q) - model.approached_from(above).position(q) - loop).norm(),
            0.3 * loop.norm());
}

TEST(Approach, NothingIsFoundInAnArmWithout) {
  const JointRows<6> joints = samples(250, 1);
  EXPECT_FALSE(used(fitted(visited(arm_with_hysteresis(0), joints, rows_before(joints), 2, still)), "approach"));
}

// The rows are in another order than they were measured in: the pose before says nothing.
TEST(Approach, AShuffledFileFindsNothing) {
  const JointRows<6> joints = samples(250, 1);
  const Dataset<6> data = visited(arm_with_hysteresis(60e-6), joints, rows_before(joints), 2, still);
  const Dataset<6> mixed = data.rows(Rng(3).permutation(data.size()));
  EXPECT_FALSE(used(fitted(mixed.approached_from(rows_before(mixed.joints()))), "approach"));
}

// Every joint always came from the same side: its loop cannot be told from its zero.
TEST(Approach, ApproachesThatNeverVaryFindNothing) {
  const JointRows<6> joints = samples(250, 1), before = shifted(joints, -0.5);
  EXPECT_FALSE(used(fitted(visited(arm_with_hysteresis(60e-6), joints, before, 2, still)), "approach"));
}

/// A base that moves along a wave of 0.1 mm and 100 urad.
Isometry3 wave(Index i, Index n) {
  const double phase = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
  return rigid_motion(exp_so3(Vector3(0, 0, 100e-6 * std::cos(phase))),
                      0.1e-3 * std::sin(phase) * Vector3(1, -0.5, 0.3));
}

TEST(Drift, OfTheBaseIsFollowed) {
  const Index n = 400;
  const JointRows<6> joints = samples(n, 1);
  const auto found =
      fitted(visited(arm_with_hysteresis(0), joints, rows_before(joints), 2, [&](Index i) { return wave(i, n); }));
  ASSERT_TRUE(used(found, "drift"));
  ASSERT_EQ(found.drift.size(), 1u);
  // where the tool was, on average over the session, nothing is left but the mean
  const Vector3 centre = found.drift.front().centre;
  PointRows left(n, 3);
  for (Index i = 0; i < n; ++i) {
    const Isometry3 followed = found.drift.front().motion(static_cast<double>(i));
    set_point(left, i, transformed(wave(i, n), centre) - transformed(followed, centre));
  }
  const double worst = RealMatrix(distances_from(left, centroid(left))).largest();
  EXPECT_LT(worst, 0.04e-3);
  // nothing but frames and geometry was found: they are what is deployed, and the drift is taken off them
  EXPECT_FALSE(used(found, "jointwise") || used(found, "elastic") || used(found, "approach") || used(found, "tilt"));
  for (Index i = 0; i < 5; ++i) {
    const JointVector<6> q = configuration(joints, i);
    const RealMatrix position = found.model().position(q);
    EXPECT_EQ(RealMatrix(found.models(Stage::geometry).front().position(q)), position);
    EXPECT_EQ(RealMatrix(found.models(Stage::jointwise).front().position(q)), position);
  }
  EXPECT_EQ(RealMatrix(found.geometry_left_out_errors), RealMatrix(found.left_out_errors));
}

// The clock may count from any time, as Unix time does, in which a double has a quarter of a microsecond.
TEST(Drift, IsThatOfTimesSinceTheFirst) {
  const Index n = 300;
  const JointRows<6> joints = samples(n, 1);
  const Dataset<6> data =
      visited(arm_with_hysteresis(0), joints, rows_before(joints), 2, [&](Index i) { return wave(i, n); });
  constexpr double unix_time = 1714561234.5;
  const auto of_zero = fitted(data), of_unix = fitted(data.measured_at(data.times() + VectorX::Constant(n, unix_time)));
  ASSERT_TRUE(used(of_zero, "drift") && used(of_unix, "drift"));
  EXPECT_EQ(of_unix.drift.front().begin, unix_time);
  for (Index i = 0; i < n; i += 7) {
    const auto time = static_cast<double>(i) + 0.3;
    const RealMatrix expected = of_zero.drift.front().twist(time);
    EXPECT_LT(vernier_test::difference(of_unix.drift.front().twist(unix_time + time), expected), 1e-10) << i;
  }
}

// Two places, whose bases drift, each in its own way.
TEST(Drift, OfTwoStationsIsTakenOffEach) {
  const Index n = 200;
  const JointRows<6> joints = samples(n, 1), others = samples(n, 3);
  const Isometry3 there = FrameParameters(Vector6{-2, 1, 0.3, 0.4, -0.8, 2}).isometry();
  const Dataset<6> first = visited(arm_with_hysteresis(0), joints, rows_before(joints), 2,
                                   [&](Index i) { return wave(i, n); }),
                   second = visited(arm_with_hysteresis(0), others, rows_before(others), 4,
                                    [&](Index i) { return composed(wave((i + 70) % n, n), there); });
  const auto found = fit_error_model(identified(first), Measurements<6>(first).add(second),
                                     {.harmonics = 0, .num_validation_poses = 100}, squared);
  ASSERT_TRUE(used(found, "drift"));
  ASSERT_EQ(found.drift.size(), 2u);
  expect_left_out_as_deployed(found, {first, second});
}

// A base that goes by random steps from one knot to the next: the size of its steps is found, in factors of two, and
// stands for what comes after the session, whatever the accuracy that is stated of the sensor.
TEST(Drift, StepsHaveTheirSize) {
  const Index n = 400;
  const JointRows<6> joints = samples(n, 1);
  const double root = std::sqrt(40.0 / 200);
  for (const auto& [size, precision, stated] : {std::array{2.0, 0.25, 1.0}, {0.5, 4.0, 1.0}, {2.0, 0.0625, 2.0}}) {
    Rng rng(5);
    SessionDrift walk{0, (static_cast<double>(n) - 1) / 10, Vector3(0.4, -0.3, 0.5), MatrixX::Zero(6, 11), {}};
    for (Index k = 1; k < 11; ++k)
      for (Index r = 0; r < 6; ++r)
        walk.knots(r, k) = walk.knots(r, k - 1) + rng.sign() * size * root * (r < 3 ? 0.03e-3 : 20e-6);
    const Dataset<6> data = visited(arm_with_hysteresis(0), joints, rows_before(joints), 2,
                                    [&](Index i) { return walk.motion(static_cast<double>(i)); });
    // precisions are relative to the noise
    const SensorModel sensor{
        .position_sigma = stated * 0.02e-3, .orientation_sigma = stated * 0.05e-3, .loss = Loss::squared};
    const auto found =
        fit_error_model(identified(data, sensor), data, {.harmonics = 0, .num_validation_poses = 100}, sensor);
    ASSERT_TRUE(used(found, "drift"));
    EXPECT_EQ(choice_of(found, "drift")->precision, precision);
    const SessionDrift& drift = found.drift.front();
    EXPECT_EQ(drift.knots.cols(), 11);
    ASSERT_GE(drift.step_variance.size(), 6);
    for (Index r = 0; r < 6; ++r) {  // at least the expected one
      const double step = root * (r < 3 ? 0.03e-3 : 20e-6);
      EXPECT_NEAR(drift.step_variance(r) / (step * step), std::max(1.0, size * size), 0.8);
    }
  }
}

TEST(Drift, NothingIsFoundInABaseThatRests) {
  const JointRows<6> joints = samples(400, 1);
  EXPECT_FALSE(used(fitted(visited(arm_with_hysteresis(0), joints, rows_before(joints), 2, still)), "drift"));
}

// One solution that failed is remembered, though later ones succeed.
TEST(ModelSelectionWhiteBox, ConvergedWhereEverySolutionDid) {
  const JointRows<6> joints = samples(20, 8);
  const Dataset<6> data = visited(arm_with_hysteresis(0), joints, joints, 8, still);
  const ErrorModelOptions options;
  detail::CalibrationProblem problem(ArmParameterisation({ArmGeometry(nominal)}, {{11, -1, 1e-3, 1}}),
                                     {vernier_test::set_of(data, squared)}, Loss::squared);
  detail::ModelSelection model(std::move(problem), options, detail::spectra_of(options, 6),
                               detail::ChainTable(nominal.model().view()));
  model.solve();
  EXPECT_TRUE(model.converged);
  model.problem.arm.set_precisions(VectorX::Constant(1, std::numeric_limits<double>::quiet_NaN()));
  model.solve();
  EXPECT_FALSE(model.converged);
  model.problem.arm.set_precisions(VectorX::Ones(1));
  model.solve();
  EXPECT_FALSE(model.converged);
}

// Sums of harmonics that stay are copied: the equations are those that are computed anew.
TEST(ModelSelectionWhiteBox, ExtendedEquationsAreThoseOfNow) {
  const JointRows<6> joints = samples(20, 8);
  const Dataset<6> data = visited(arm_with_hysteresis(1e-3), joints, rows_before(joints), 8, still);
  const ErrorModelOptions options;
  detail::CalibrationProblem problem(ArmParameterisation({ArmGeometry(nominal)}, {{11, -1, 1e-3, 1}}),
                                     {vernier_test::set_of(data, squared)}, Loss::squared);
  detail::ModelSelection model(std::move(problem), options, detail::spectra_of(options, 6),
                               detail::ChainTable(nominal.model().view()));
  const auto expect_those_of_now = [&] {
    const MatrixX found = model.linearised().normal.matrix;
    EXPECT_EQ(RealMatrix(found), RealMatrix(model.problem.normal_equations().matrix));
  };
  JointTerms terms(6);
  terms.transmission[2] = Fourier::up_to(3);
  model.extend_terms(terms);
  expect_those_of_now();
  model.steps(1);  // to other values
  expect_those_of_now();
  terms.hysteresis = {0.02};  // beside the same harmonics
  model.extend_terms(terms);
  expect_those_of_now();
  terms.transmission[2].orders = {1, 2, 4};  // as many others
  model.extend_terms(terms);
  expect_those_of_now();
  model.problem.arm.move(VectorX::Constant(model.problem.arm.size(), 1e-3));
  model.changed();
  terms.gear_ratio = true;
  model.extend_terms(terms);
  expect_those_of_now();
}

TEST(Drift, OfAJointsZeroIsFollowed) {
  const Index n = 600;
  const JointRows<6> joints = samples(n, 1);
  const auto zero = [&](Index i) {
    return 150e-6 * std::sin(2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
  };
  JointRows<6> actually = joints;
  for (Index i = 0; i < n; ++i) actually(i, 1) += zero(i);
  const Dataset<6> seen =
      visited(arm_with_hysteresis(0), actually, rows_before(actually), 2, [&](Index i) { return wave(i, n); });
  const Dataset<6> data =
      Dataset<6>(joints, seen.positions(), seen.orientations()).approached_from(rows_before(joints));
  const auto found = fitted(data);
  ASSERT_TRUE(used(found, "drift"));
  ASSERT_TRUE(used(found, "joint_drift"));
  ASSERT_EQ(found.drift.front().knots.rows(), 12);
  double worst = 0;
  for (Index i = 0; i < n; ++i)
    worst = vernier_test::larger(worst, std::abs(found.drift.front().joint_zeros(static_cast<double>(i))(1) - zero(i)));
  EXPECT_LT(worst, 60e-6);
  expect_left_out_as_deployed(found, {data});
  const double step = std::sqrt(40.0 / 200) * 10e-6;
  ASSERT_EQ(found.drift.front().step_variance.size(), 12);
  EXPECT_NEAR(found.drift.front().step_variance(7) / (step * step),
              std::max(1.0, found.residual_variance / choice_of(found, "joint_drift")->precision), 1e-9);
  EXPECT_LT(choice_of(found, "joint_drift")->precision, 1);  // half a wave of 150 urad in 300 poses
}

TEST(Drift, OfTheBaseAloneMovesNoJoint) {
  const Index n = 400;
  const JointRows<6> joints = samples(n, 1);
  const auto found =
      fitted(visited(arm_with_hysteresis(0), joints, rows_before(joints), 2, [&](Index i) { return wave(i, n); }));
  EXPECT_FALSE(used(found, "joint_drift"));
  EXPECT_EQ(found.drift.front().knots.rows(), 6);
}

}  // namespace
}  // namespace vernier::session_test
