// SPDX-License-Identifier: BSD-3-Clause
// Joint frames that tilt under gravity: a case by hand, arms whose rows are tilted one by one, derivatives, and chains
// with tilts as kinematic models.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>
#include <vernier/core/so3.hpp>
#include <vernier/error_terms/joint_errors.hpp>
#include <vernier/kinematics/framed.hpp>
#include <vernier/testing/kinematic_laws.hpp>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "laws.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace vernier::gravity_tilt_test {
namespace {

using vernier_test::allocations;
using vernier_test::keep;
using vernier_test::normals;
using vernier_test::RealMatrix;
using vernier_test::stepped;

/// A chain whose frames tilt, with or without all other joint errors.
template <class Chain>
WithJointErrors<Chain> tilted(const Chain& chain, const Vector3& down, double size, bool others, Rng& rng) {
  JointTerms terms(Chain::dof);
  terms.tilt.emplace(chain, down);
  if (others) {
    terms.gear_ratio = true;
    terms.gravity.emplace(chain, down);
    terms.hysteresis = {0.3};
    terms.transmission.assign(Chain::dof, Fourier::up_to(2));
  }
  return {chain, JointErrors(terms, normals(rng, terms.size(), size))};
}

// A level arm that turns in a vertical plane: gravity along -y at q = 0, and along -x of the turned frame at 90
// degrees.
TEST(GravityTilt, OneJointByHand) {
  const DhChain<1> arm({{.a = 0.5}});
  constexpr double tilt = 1e-3;
  const auto by = [&](Index coefficient, double angle) {
    JointTerms terms(1);
    terms.tilt.emplace(arm, Vector3(0, -1, 0));
    VectorX coefficients = VectorX::Zero(6);
    coefficients(coefficient) = tilt;
    const WithJointErrors<DhChain<1>> actual(arm, JointErrors(terms, coefficients));
    const JointVector<1> q(angle);
    return pose_difference(actual.pose(q), arm.pose(q));
  };
  constexpr double right = std::numbers::pi / 2;
  const auto expect = [](const Vector6& found, const Vector6& wanted) {
    EXPECT_LT((RealMatrix(found) - wanted).norm(), tilt * tilt) << ::testing::PrintToString(RealMatrix(found));
  };
  // xx, xy, xz, yx, yy, yz: about x the arm twists, about y its end leaves the plane
  expect(by(0, 0), Vector6::Zero());
  expect(by(1, 0), Vector6{0, 0, 0, -tilt, 0, 0});
  expect(by(4, 0), Vector6{0, 0, 0.5 * tilt, 0, -tilt, 0});
  expect(by(0, right), Vector6{0, 0, 0, 0, -tilt, 0});
  expect(by(3, right), Vector6{0, 0, 0.5 * tilt, tilt, 0, 0});
  for (const Index unseen : {2, 5}) expect(by(unseen, 0.7), Vector6::Zero());  // no gravity along the axis
}

/// The arm with a rotation of each joint's frame between its joint and the rest of its link.
template <int N, class Convention>
Isometry3 tilted_row_by_row(const DhChain<N, Convention>& arm, const Vector3& down, const VectorX& coefficients,
                            const JointVector<N>& q) {
  Isometry3 at = Isometry3::Identity(), rigid = at;
  for (int i = 0; i < N; ++i) {
    DhRow joint = arm.row(i), rest = joint;
    if (Convention::modified) {
      rest = {};
    } else {
      joint.a = joint.alpha = joint.beta = 0;
      rest.d = rest.theta = 0;
    }
    rest.joint = JointType::revolute;
    using Row = DhChain<1, Convention>;
    const Isometry3 moved = Row::from_rows({joint}).pose(JointVector<1>(q(i)));
    const Isometry3 link = Row::from_rows({rest}).pose(JointVector<1>(0));
    const Vector3 gravity = rotation(rigid * moved).transpose() * down;
    const auto angle = [&](Index first) {
      return Vector3(coefficients(first), coefficients(first + 1), coefficients(first + 2)).dot(gravity);
    };
    const Isometry3 tilt = rigid_motion(exp_so3(Vector3(angle(6 * i), angle(6 * i + 3), 0)), Vector3::Zero());
    at = at * moved * tilt * link;
    rigid = rigid * moved * link;
  }
  return at;
}

template <int N, class Convention>
void expect_tilts_row_by_row() {
  Rng rng(500 + N);
  for (int trial = 0; trial < 10; ++trial) {
    const auto arm = vernier_test::random_chain<N, Convention>(rng);
    const Vector3 down = vernier_test::random_direction(rng);
    constexpr double size = 1e-6;
    const auto actual = tilted(arm, down, size, false, rng);
    const JointVector<N> q = vernier_test::random_joints<N>(rng);
    const Isometry3 by_rows = tilted_row_by_row(arm, down, actual.joint_errors().coefficients(), q);
    EXPECT_GT(pose_difference(by_rows, arm.pose(q)).norm(), size / 10);
    EXPECT_LT(pose_difference(actual.pose(q), by_rows).norm(), 1e-10) << N;  // tilts on tilts
  }
}

TEST(GravityTilt, IsThatOfEveryRowToFirstOrder) {
  expect_tilts_row_by_row<1, StandardDh>();
  expect_tilts_row_by_row<3, ModifiedDh>();
  expect_tilts_row_by_row<6, StandardDh>();
  expect_tilts_row_by_row<7, ModifiedDh>();
}

void expect_sums_with_rates(const GravityTilt& tilt, Index n, Rng& rng) {
  ASSERT_EQ(tilt.size(), 6 * n);
  const VectorX coefficients = normals(rng, tilt.size(), 1), q = vernier_test::random_joint_values(rng, n);
  MatrixX basis = MatrixX::Constant(6, tilt.size(), std::nan(""));
  tilt.basis(q.data(), basis);
  MatrixX rates = MatrixX::Constant(6, n, std::nan(""));
  const RealMatrix motion = tilt.motion(q.data(), coefficients.data(), rates.data());
  EXPECT_LT((motion - RealMatrix(basis) * coefficients).norm(), 1e-13);
  const auto motion_at = [&](const VectorX& joints) {
    return RealMatrix(tilt.motion(joints.data(), coefficients.data()));
  };
  EXPECT_EQ(motion, motion_at(q));
  constexpr double h = 1e-5;
  for (int k = 0; k < n; ++k) {
    const RealMatrix slope = (motion_at(stepped(q, k, h)) - motion_at(stepped(q, k, -h))) / (2 * h);
    EXPECT_LT((RealMatrix(rates).col(k) - slope).norm(), 1e-7) << n << ", joint " << k;
  }
}

template <int N, class Convention>
void expect_sums_with_rates() {
  Rng rng(600 + N);
  for (int trial = 0; trial < 10; ++trial) {
    const auto arm = vernier_test::random_chain<N, Convention>(rng);
    expect_sums_with_rates(GravityTilt(arm, vernier_test::random_direction(rng)), N, rng);
  }
}

TEST(GravityTilt, AddsItsCoefficientsWithTheirDerivative) {
  expect_sums_with_rates<1, StandardDh>();
  expect_sums_with_rates<2, ModifiedDh>();
  expect_sums_with_rates<6, StandardDh>();
  expect_sums_with_rates<7, ModifiedDh>();
}

template <int N, class Convention>
void expect_laws() {
  using Chain = DhChain<N, Convention>;
  Rng rng(700 + N);
  const auto arm = vernier_test::random_chain<N, Convention>(rng);
  const auto actual = tilted(arm, vernier_test::random_direction(rng), 5e-3, true, rng);
  const FrameParameters base(Vector6{1, 2, 3, 0.4, -1.2, 2}), tool(Vector6{0.1, -0.05, 0.2, 0, 0.7, -0.1});
  const JointRows<N> samples = vernier_test::random_joint_rows<N>(rng, 20);
  EXPECT_TRUE(vernier_test::no_violations(testing::kinematic_model_violations(actual, samples)));
  EXPECT_TRUE(vernier_test::no_violations(testing::kinematic_model_violations(Framed(actual, base, tool), samples)));
  const JointVector<N> previous = vernier_test::random_joints<N>(rng);
  const Framed seen(ApproachedArm<Chain>(actual, previous), base, tool);
  EXPECT_TRUE(vernier_test::no_violations(testing::kinematic_model_violations(seen, samples)));
  // points of the tool, of many configurations at once
  const Vector3 tip(0.1, 0.2, -0.3);
  const PointRows points = actual.positions(samples, tip);
  for (Index i = 0; i < samples.rows(); ++i)
    EXPECT_LT((point(points, i) - transformed(actual.pose(configuration<N>(samples, i)), tip)).norm(), 1e-12);
}

TEST(GravityTilt, ChainsWithItObeyTheLaws) {
  expect_laws<1, StandardDh>();
  expect_laws<3, ModifiedDh>();
  expect_laws<6, StandardDh>();
  expect_laws<7, ModifiedDh>();
}

TEST(GravityTilt, NamesAreInOrderAndUnique) {
  Rng rng(10);
  JointTerms terms(2);
  terms.tilt.emplace(vernier_test::random_chain<2>(rng));
  terms.hysteresis = {0.1};
  terms.transmission[1] = Fourier::up_to(1);
  EXPECT_EQ(terms.names(),
            (std::vector<std::string>{"hysteresis1_1", "hysteresis2_1", "tilt1_xx", "tilt1_xy", "tilt1_xz", "tilt1_yx",
                                      "tilt1_yy", "tilt1_yz", "tilt2_xx", "tilt2_xy", "tilt2_xz", "tilt2_yx",
                                      "tilt2_yy", "tilt2_yz", "cos2_1", "sin2_1"}));
  EXPECT_EQ(terms.end_begin(), 2);
  EXPECT_EQ(terms.num_dense_terms(), 14);
  MatrixX dense(2, 14);
  const JointVector<2> q(0.3, 0.4);
  terms.dense_basis(q.data(), nullptr, dense);
  EXPECT_EQ(RealMatrix(dense), RealMatrix(2, 14));  // zeros: no joint value changes
}

TEST(GravityTilt, MisuseIsNamed) {
  const DhChain<1> one({{.a = 1}});
  for (const Vector3& bad : {Vector3(0, 0, -9.81), Vector3(0, 0, 0), Vector3(0, 1.00001, 0), Vector3(0, 0, -0.99999),
                             Vector3(std::nan(""), 0, 1), Vector3(1 + 1.2e-6, 0, 0)})
    EXPECT_THROW((void)GravityTilt(one, bad), std::invalid_argument);
  EXPECT_NO_THROW((void)GravityTilt(one, Vector3(1 - 0.8e-6, 0, 0)));  // written with six digits
  JointTerms terms(2);
  terms.tilt.emplace(one);
  EXPECT_EQ(vernier_test::complaint([&] { (void)JointErrors(terms, VectorX::Ones(6)); }),
            "JointErrors: tilts of 1 joints, expected 2");
}

TEST(NoAllocation, GravityTilt) {
  Rng rng(11);
  const auto arm = vernier_test::random_chain<6>(rng);
  const auto actual = tilted(arm, Vector3(0, 0, -1), 1e-3, true, rng);
  const JointVector<6> q = vernier_test::random_joints<6>(rng), previous = vernier_test::random_joints<6>(rng);
  const ApproachedArm seen(actual, previous);
  MatrixX basis(6, 36);
  EXPECT_EQ(allocations([&] { keep(actual.pose(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(actual.position(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(actual.pose_and_jacobian(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(seen.pose_and_jacobian(q)); }), 0);
  EXPECT_EQ(allocations([&] { actual.joint_errors().terms().tilt->basis(q.data(), basis); }), 0);
}

}  // namespace
}  // namespace vernier::gravity_tilt_test
