// SPDX-License-Identifier: BSD-3-Clause
// The unknowns of an arm: what stays when terms or parameters are added.

#include "vernier/identification/arm_parameterisation.hpp"

#include <gtest/gtest.h>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/fitted_arm.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::arm_parameterisation_test {
namespace {

using Chain = DhChain<6>;

using vernier_test::difference;
using vernier_test::normals;
using vernier_test::RealMatrix;
using vernier_test::vector;

const Robot<6> robot = robots::abb_irb120();

ArmParameterisation example() {
  const FrameParameters base(Vector6{0.4, -0.3, 0.2, 0.3, -0.4, 0.6}), tool(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5});
  return ArmParameterisation({ArmGeometry(Framed<Chain>(robot.chain, base, tool))},
                             {{0, -1, 1e-3, 0}, {9, -1, 1e-2, 1}, {38, -1, 2e-3, 4}});
}

/// Values by name [m, rad].
double value(const ArmParameterisation& arm, const std::string& name) {
  const auto names = arm.names();
  const Index k = std::find(names.begin(), names.end(), name) - names.begin();
  return arm.steps()(k) * arm.scales()(k);
}

// Without joint errors there is nothing to multiply by, so nothing is written; without temperatures rates do nothing.
TEST(ArmParameterisation, RowsHaveNoMoreThanIsAsked) {
  ArmParameterisation arm({ArmGeometry(Framed<Chain>(robot.chain))}, {{9, -1, 1e-3, 0}, {9, -1, 1e-3, 0, true}});
  arm.move(vector({1, 2}));
  const RealMatrix joints(1, 6, {0.1, -0.5, 0.3, 0.7, -0.4, 1});
  RowBlock rows;
  const Isometry3 cold = arm.linearise(0, joints, MatrixX(0, 6), &rows, false, VectorX()).front();
  EXPECT_EQ(rows.factor.cols(), 0);
  EXPECT_EQ(rows.functions.size(), 0);
  EXPECT_EQ(RealMatrix(rows.dense).col(1).norm(), 0);
  EXPECT_EQ(RealMatrix(cold), RealMatrix(arm.poses(0, joints).front()));
  const Isometry3 warm = arm.linearise(0, joints, MatrixX(0, 6), &rows, true, vector({3})).front();
  EXPECT_EQ(rows.factor.cols(), 6);
  const RealMatrix dense = rows.dense;
  EXPECT_LT((dense.col(1) - 3 * dense.col(0)).norm(), 1e-15);
  const Vector3 shift = translation(warm) - translation(cold);  // two units a kelvin, three kelvins
  for (Index r = 0; r < 3; ++r) EXPECT_NEAR(shift(r), 6 * dense(r, 0), 1e-12);
}

// Gears stand in front of gravity, which stands in front of the transmissions: all indices change.
TEST(ArmParameterisation, CoefficientsKeepTheirValuesWhenTermsAreAdded) {
  Rng rng(1);
  ArmParameterisation arm = example();
  JointTerms few(6);
  few.gravity.emplace(robot.chain);
  few.transmission[1] = Fourier::up_to(2);
  few.transmission[4] = Fourier::up_to(3);
  arm.set_terms(few, VectorX::LinSpaced(few.size(), 1e-4, 2e-4), VectorX::Ones(few.size()));
  arm.move(normals(rng, arm.size()));
  const RealMatrix joints(1, 6, {0.1, -0.5, 0.3, 0.7, -0.4, 1});
  const Isometry3 before = arm.poses(0, joints).front();
  ArmParameterisation more = arm;
  JointTerms all = few;
  all.gear_ratio = all.coupling = true;
  all.transmission[0] = Fourier::up_to(1);
  all.transmission[4] = Fourier::up_to(5);  // longer: what was there comes first
  more.set_terms(all, VectorX::LinSpaced(all.size(), 3e-4, 5e-4), VectorX::Ones(all.size()));
  EXPECT_EQ(more.size(), arm.size() + 6 + 5 + 2 + 4);
  for (const std::string& name : arm.names()) EXPECT_NEAR(value(more, name), value(arm, name), 1e-16) << name;
  for (const char* added : {"gear3", "coupling2", "cos1_1", "sin5_4"}) EXPECT_EQ(value(more, added), 0) << added;
  EXPECT_LT((RealMatrix(more.poses(0, joints).front()) - before).norm(), 1e-15);
}

TEST(ArmParameterisation, StepsAreRelativeToThePriorsMeans) {
  Rng rng(2);
  ArmParameterisation arm = example();
  JointTerms terms(6);
  terms.transmission[2] = Fourier::up_to(2);
  arm.set_terms(terms, VectorX::Constant(4, 1e-4), VectorX::Constant(4, 7));
  EXPECT_EQ(RealMatrix(arm.steps()).largest(), 0);
  const VectorX first = normals(rng, 7), second = normals(rng, 7);
  arm.move(first);
  arm.move(second);
  EXPECT_LT((arm.steps() - first - second).norm(), 1e-12);
  EXPECT_EQ(difference(arm.precisions(), vector({0, 1, 4, 7, 7, 7, 7})), 0);
  EXPECT_EQ(difference(arm.scales(), vector({1e-3, 1e-2, 2e-3, 1e-4, 1e-4, 1e-4, 1e-4})), 0);
  arm.set_geometric({{38, -1, 2e-3, 4}});  // values stay
  EXPECT_NEAR(arm.steps()(0), first(2) + second(2), 1e-12);
}

/// Two places of one arm: the base's x of each, a length that both share, and what changes with temperature.
ArmParameterisation from_two_places() {
  const ArmGeometry arm(Framed<Chain>(robot.chain, {}, {}));
  const ArmGeometry beside = arm.with_frames(FrameParameters(Vector6{1, 2, 3, 0, 0, 0}), arm.tool());
  return ArmParameterisation({arm, beside}, {{0, 0, 1e-3, 1},
                                             {0, 1, 2e-3, 2},
                                             {6, -1, 5e-3, 3},
                                             {0, 1, 1e-6, 4, true},
                                             {6, -1, 4e-6, 5, true},
                                             {7, -1, 8e-6, 6, true}});
}

TEST(ArmParameterisation, UnknownsOfAStationAreItsOwn) {
  ArmParameterisation arm = from_two_places();
  EXPECT_EQ(arm.names(), (std::vector<std::string>{"base_x", "base_x@2", "a1", "base_x@2/K", "a1/K", "alpha1/K"}));
  EXPECT_EQ(arm.thermal_rates(0).size(), 0);
  const RealMatrix step = vector({1, 2, 3, 5, 7, 11});
  arm.move(step);
  EXPECT_LT(difference(arm.steps(), step), 1e-9);
  const VectorX first = arm.geometry(0).parameters(), second = arm.geometry(1).parameters(),
                nominal = ArmGeometry(Framed<Chain>(robot.chain, {}, {})).parameters();
  EXPECT_NEAR(first(0), 1e-3, 1e-15);
  EXPECT_NEAR(second(0), 1 + 4e-3, 1e-15);
  EXPECT_NEAR(first(6), nominal(6) + 15e-3, 1e-15);
  EXPECT_NEAR(second(6), nominal(6) + 15e-3, 1e-15);
  EXPECT_EQ(first(7), nominal(7));  // of a rate nothing is left at the mean temperature
  // rates [m/K, rad/K] by parameter
  VectorX rates = VectorX::Zero(first.size());
  rates(6) = 7 * 4e-6;
  rates(7) = 11 * 8e-6;
  EXPECT_LT(difference(arm.thermal_rates(0), rates), 1e-18);
  rates(0) = 5 * 1e-6;
  EXPECT_LT(difference(arm.thermal_rates(1), rates), 1e-18);
}

TEST(ArmParameterisation, PrecisionsAreSetByUnknown) {
  ArmParameterisation arm = from_two_places();
  JointTerms terms(6);
  terms.transmission[2] = Fourier::up_to(1);
  arm.set_terms(terms, VectorX::Constant(2, 1e-4), VectorX::Constant(2, 7));
  const RealMatrix precisions = vector({9, 8, 7, 6, 5, 4, 3, 2});
  arm.set_precisions(precisions);
  EXPECT_EQ(difference(arm.precisions(), precisions), 0);
  EXPECT_THROW(arm.set_precisions(VectorX::Ones(7)), std::invalid_argument);
}

// The hysteresis of all joints is that of the other arm; all other terms stay.
TEST(FittedArm, TakesTheHysteresisOfAnother) {
  JointTerms terms(6), others(6);
  terms.gear_ratio = others.gear_ratio = true;
  terms.gravity.emplace(robot.chain);
  others.gravity.emplace(robot.chain);
  terms.hysteresis = {0.05};
  others.hysteresis = {0.02, 0.3};
  terms.transmission[1] = Fourier::up_to(2);
  terms.transmission[4] = Fourier::up_to(2);
  others.transmission[1] = Fourier::up_to(2);
  Rng rng(5);
  const ArmGeometry geometry(in_frames(robot.chain));
  const FittedArm arm{geometry, JointErrors(terms, normals(rng, terms.size()))},
      other{geometry, JointErrors(others, normals(rng, others.size()))},
      rigid{geometry, JointErrors(JointTerms(6), VectorX())};
  const auto expect_joined = [&](const FittedArm& found, const FittedArm& own) {
    EXPECT_EQ(found.errors.terms().hysteresis, others.hysteresis);
    const auto names = found.errors.terms().names();
    Index of_other = 0;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const bool hysteresis = names[k].starts_with("hysteresis");
      const JointErrors& from = hysteresis ? other.errors : own.errors;
      const auto known = from.terms().names();
      const Index at = std::find(known.begin(), known.end(), names[k]) - known.begin();
      ASSERT_LT(at, from.coefficients().size()) << names[k];
      EXPECT_EQ(found.errors.coefficients()(static_cast<Index>(k)), from.coefficients()(at)) << names[k];
      of_other += hysteresis ? 1 : 0;
    }
    EXPECT_EQ(of_other, 12);  // two widths of six joints
  };
  expect_joined(arm.with_hysteresis_of(other), arm);
  EXPECT_EQ(arm.with_hysteresis_of(other).errors.terms().size(), terms.size() + 6);
  expect_joined(rigid.with_hysteresis_of(other), rigid);
  EXPECT_EQ(rigid.with_hysteresis_of(other).errors.terms().size(), 12);
}

/// An arm with its k-th unknown moved.
ArmParameterisation moved(ArmParameterisation arm, Index k, double by) {
  RealMatrix step(arm.size(), 1);
  step(k) = by;
  arm.move(step);
  return arm;
}

// Every column of a pose with tilts against the difference of two poses: of both frames, the chain and all joint
// errors.
TEST(ArmParameterisation, ColumnsOfAnArmThatTiltsAreDifferences) {
  Rng rng(3);
  ArmParameterisation arm = example();
  std::vector<GeometricUnknown> unknowns;
  for (Index k = 0; k < 42; ++k) unknowns.push_back({k, -1, 1e-2, 0});
  arm.set_geometric(unknowns);
  JointTerms terms(6);
  terms.gear_ratio = true;
  terms.gravity.emplace(robot.chain);
  terms.tilt.emplace(robot.chain, Vector3(0.6, 0, -0.8));
  terms.transmission[2] = Fourier::up_to(2);
  arm.set_terms(terms, VectorX::LinSpaced(terms.size(), 1e-2, 2e-2), VectorX::Ones(terms.size()));
  arm.move(normals(rng, arm.size()));
  const RealMatrix joints(2, 6, {0.1, -0.5, 0.3, 0.7, -0.4, 1, -1.2, 0.4, 0.2, -0.7, 1.1, 0.5});
  std::vector<RowBlock> rows(2);
  const auto poses = arm.linearise(0, joints, MatrixX(), rows.data());
  const auto typed = FittedArm{arm.geometry(0), arm.joint_errors()}.typed(robot.chain);
  for (Index i = 0; i < 2; ++i) {
    const auto s = static_cast<std::size_t>(i);
    JointVector<6> q;
    for (Index j = 0; j < 6; ++j) q(j) = joints(i, j);
    EXPECT_LT((RealMatrix(poses[s]) - arm.poses(0, joints)[s]).norm(), 1e-14);
    EXPECT_LT((RealMatrix(poses[s]) - typed.pose(q)).norm(), 1e-14);
    Rows6 expanded(6, arm.size());
    rows[s].expand(arm.group_sizes(), expanded);
    const RealMatrix all = expanded;
    for (Index k = 0; k < arm.size(); ++k) {
      constexpr double h = 1e-4;
      const RealMatrix apart =
          pose_difference(moved(arm, k, h).poses(0, joints)[s], moved(arm, k, -h).poses(0, joints)[s]);
      EXPECT_LT((all.col(k) - apart / (2 * h)).norm(), 1e-9) << arm.names()[static_cast<std::size_t>(k)];
    }
  }
}

// Columns of errors of motors, and of unit errors of each motor.
TEST(ArmParameterisation, ColumnsOfMotorsAreDifferences) {
  Rng rng(7);
  ArmParameterisation arm = example();
  const std::array<std::string, 6> law{"J1", "J2", "J3 - J2", "-J4", "J5", "J6 + J5"};
  JointTerms terms(6);
  terms.motors = MotorAngles(ControllerMap(law).with_motor_errors());
  terms.gear_ratio = terms.coupling = true;
  terms.gravity.emplace(robot.chain);
  terms.hysteresis = {0.05};
  terms.tilt.emplace(robot.chain);
  terms.transmission[1] = terms.transmission[2] = terms.transmission[4] = Fourier::up_to(2);
  arm.set_terms(terms, VectorX::LinSpaced(terms.size(), 1e-3, 2e-3), VectorX::Ones(terms.size()));
  arm.move(normals(rng, arm.size()));
  const RealMatrix joints(1, 6, {0.1, -0.5, 0.3, 0.7, -0.4, 1}), previous(1, 6, {0.2, -0.6, 0.5, 0.6, -0.3, 1.2});
  RowBlock rows;
  arm.linearise(0, joints, previous, &rows);
  Rows6 expanded(6, arm.size());
  rows.expand(arm.group_sizes(), expanded);
  for (Index k = 0; k < arm.size(); ++k) {
    constexpr double h = 1e-2;
    RowBlock other;
    const RealMatrix apart = pose_difference(moved(arm, k, h).linearise(0, joints, previous, &other).front(),
                                             moved(arm, k, -h).linearise(0, joints, previous, &other).front());
    EXPECT_LT((RealMatrix(expanded).col(k) - apart / (2 * h)).norm(), 1e-8) << arm.names()[static_cast<std::size_t>(k)];
  }
  // a gear ratio is a unit error of its motor, by the motor's angle: J3 = q3 + q2
  const Index gear = static_cast<Index>(arm.geometric().size()) + 2;
  EXPECT_EQ(arm.names()[static_cast<std::size_t>(gear)], "gear3");
  const RealMatrix unit = RealMatrix(rows.factor).col(2), column = RealMatrix(rows.dense).col(gear);
  EXPECT_GT(unit.norm(), 0.1);
  EXPECT_LT((column - arm.scales()(gear) * (0.3 - 0.5) * unit).norm(), 1e-12);
}

// Hysteresis by where each configuration came from, and rates per degree.
TEST(ArmParameterisation, ColumnsOfHysteresisAndHeatAreDifferences) {
  Rng rng(4);
  ArmParameterisation arm = example();
  arm.set_geometric({{9, -1, 1e-2, 0}, {9, -1, 1e-4, 0, true}, {2, -1, 1e-2, 0}, {17, -1, 1e-4, 0, true}});
  JointTerms terms(6);
  terms.hysteresis = {0.05, 0.4};
  arm.set_terms(terms, VectorX::LinSpaced(terms.size(), 1e-3, 2e-3), VectorX::Ones(terms.size()));
  arm.move(normals(rng, arm.size()));
  const RealMatrix joints(2, 6, {0.1, -0.5, 0.3, 0.7, -0.4, 1, -1.2, 0.4, 0.2, -0.7, 1.1, 0.5});
  RealMatrix previous = joints;
  for (Index i = 0; i < 2; ++i)
    for (Index j = 0; j < 6; ++j) previous(i, j) += 0.1 * rng.normal();
  const VectorX warmer = vector({3, -2});
  const auto poses = [&](const ArmParameterisation& of, RowBlock* rows) {
    return of.linearise(0, joints, previous, rows, false, warmer);
  };
  std::vector<RowBlock> rows(2), other(2);
  const auto found = poses(arm, rows.data());
  for (Index k = 0; k < arm.size(); ++k) {
    constexpr double h = 1e-3;
    const auto after = poses(moved(arm, k, h), other.data()), before = poses(moved(arm, k, -h), other.data());
    for (std::size_t i = 0; i < 2; ++i) {
      const RealMatrix apart = pose_difference(after[i], before[i]), column = RealMatrix::of(rows[i].dense).col(k);
      EXPECT_LT((column - apart / (2 * h)).norm(), 1e-3 * column.norm() + 1e-9)
          << arm.names()[static_cast<std::size_t>(k)];
      EXPECT_GT(column.norm(), 1e-7) << k;
    }
  }
  // a warmer arm is one with other parameters
  const VectorX at = arm.steps();
  for (std::size_t i = 0; i < 2; ++i) {
    const double degrees = warmer(static_cast<Index>(i));
    VectorX p = arm.geometry(0).parameters();
    p(9) += degrees * at(1) * 1e-4;
    p(17) += degrees * at(3) * 1e-4;
    const FittedArm warm{arm.geometry(0).with_parameters(p), arm.joint_errors()};
    const RealMatrix q = RealMatrix(joints).row(static_cast<Index>(i)), from = previous.row(static_cast<Index>(i));
    const Isometry3 expected = warm.geometry.poses(arm.joint_errors().effective_rows(q, from)).front();
    EXPECT_LT((RealMatrix(found[i]) - expected).norm(), 1e-6) << i;  // to first order: 5e-4 rad and m
  }
}

}  // namespace
}  // namespace vernier::arm_parameterisation_test
