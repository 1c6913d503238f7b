// SPDX-License-Identifier: BSD-3-Clause
// Gravity on compliant joints: cases by hand, slopes of the potential energy, and sums with their derivatives.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vernier/error_terms/gravity_compliance.hpp>

#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace vn = vernier;
using vernier_test::difference;
using vernier_test::normals;
using vernier_test::RealMatrix;
using vernier_test::stepped;
using vn::Index;
using vn::VectorX;

namespace gravity_compliance_test {
namespace {

vn::MatrixX basis_of(const vn::GravityCompliance& gravity, const vn::ConstVectorRef& q) {
  vn::MatrixX out = vn::MatrixX::Constant(q.size(), gravity.size(), std::nan(""));
  gravity.basis(q.data(), out);
  return out;
}

TEST(GravityCompliance, PlanarArmByHand) {
  // Two joints about z, gravity along -y: a weight of 1 N turns by minus its horizontal distance from the axis.
  const double l1 = 0.3, l2 = 0.2;
  const vn::DhChain<2> arm({{.a = l1}, {.a = l2}});
  const vn::GravityCompliance gravity(arm, -vn::Vector3::UnitY());
  vn::Rng rng(4);
  for (int i = 0; i < 50; ++i) {
    const vn::JointVector<2> q = vernier_test::random_joints<2>(rng);
    const double x1 = l1 * std::cos(q(0)), x2 = l2 * std::cos(q(0) + q(1));
    const RealMatrix by_hand(2, 3,
                             {-x1, -(x1 + x2), 0,  //
                              0, 0, -x2});
    EXPECT_LE(difference(basis_of(gravity, q), by_hand), 1e-15);
  }
}

TEST(GravityCompliance, AVerticalAxisCarriesNothing) {
  const vn::DhChain<2> scara({{.a = 0.3}, {.a = 0.2}});
  EXPECT_EQ(basis_of(vn::GravityCompliance(scara), vn::JointVector<2>(0.4, 1)).norm(), 0);
}

TEST(GravityCompliance, ALiftCarriesItsWeights) {
  const vn::DhChain<2> arm({{.d = 0.1, .joint = vn::JointType::prismatic}, {.a = 0.2}});
  const RealMatrix by_hand(2, 3, {-1, -1, 0, 0, 0, 0});
  EXPECT_EQ(RealMatrix(basis_of(vn::GravityCompliance(arm), vn::JointVector<2>(0.4, 1))), by_hand);
}

/// Height of the end of link j (from 0) against gravity: the same arm with nothing behind it.
template <class Chain>
double height(const Chain& arm, int j, const vn::JointVector<Chain::dof>& q, const vn::Vector3& down) {
  auto rows = arm.rows();
  for (int k = j + 1; k < Chain::dof; ++k) rows[static_cast<std::size_t>(k)] = {};
  return -down.dot(Chain::from_rows(rows).position(q));
}

/// @param slopes of the heights of links, one a column, by each joint
void expect_torques(const vn::GravityCompliance& gravity, const RealMatrix& torques, const RealMatrix& slopes) {
  const int n = static_cast<int>(slopes.rows());
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j)
      EXPECT_NEAR(j < i ? 0 : torques(i, gravity.index(i, j)), -slopes(i, j), 1e-9) << n << ": " << i << ", " << j;
    for (int other = 0; other < n; ++other)
      for (int j = other; j < n && other != i; ++j) EXPECT_EQ(torques(i, gravity.index(other, j)), 0);
  }
}

template <int N, class Convention>
void expect_torques_of_potential_energy() {
  vn::Rng rng(100 + N);
  for (int trial = 0; trial < 20; ++trial) {
    const auto arm = vernier_test::random_chain<N, Convention>(rng, {.prismatic = 0.4});
    const vn::Vector3 down = vernier_test::random_direction(rng);
    const vn::GravityCompliance gravity(arm, down);
    const vn::JointVector<N> q = vernier_test::random_joints<N>(rng);
    const double h = 1e-5;
    RealMatrix slopes(N, N);
    for (int i = 0; i < N; ++i) {
      const vn::JointVector<N> ahead = stepped(q, i, h), behind = stepped(q, i, -h);
      for (int j = 0; j < N; ++j) slopes(i, j) = (height(arm, j, ahead, down) - height(arm, j, behind, down)) / (2 * h);
    }
    expect_torques(gravity, basis_of(gravity, q), slopes);
  }
}

void expect_sums_of_products(const vn::GravityCompliance& gravity, Index n, vn::Rng& rng) {
  const VectorX products = normals(rng, gravity.size());
  const VectorX q = vernier_test::random_joint_values(rng, n), before = vernier_test::random_joint_values(rng, n);
  const vn::MatrixX sevens = vn::MatrixX::Constant(n, n, 7);
  const auto added = [&](const VectorX& at) {
    VectorX joints = before;
    vn::MatrixX derivative = sevens;
    gravity.add(at.data(), products.data(), joints.data(), derivative.data());
    return std::pair<RealMatrix, RealMatrix>(RealMatrix(joints) - before, RealMatrix(derivative) - sevens);
  };
  const auto [joints, derivative] = added(q);
  EXPECT_LE(difference(joints, RealMatrix(basis_of(gravity, q)) * products), 1e-13);
  const double h = 1e-5;
  for (int k = 0; k < n; ++k) {
    const RealMatrix slopes = (added(stepped(q, k, h)).first - added(stepped(q, k, -h)).first) / (2 * h);
    EXPECT_LE(difference(derivative.col(k), slopes), 1e-8) << n << ", joint " << k;
  }
}

template <int N, class Convention>
void expect_sums_of_products() {
  vn::Rng rng(200 + N);
  for (int trial = 0; trial < 20; ++trial) {
    const auto arm = vernier_test::random_chain<N, Convention>(rng, {.prismatic = 0.4});
    const vn::GravityCompliance gravity(arm, vernier_test::random_direction(rng));
    expect_sums_of_products(gravity, N, rng);
  }
}

/// Calls `check<N, Convention>()` for N = 1 .. 7 in both conventions.
template <class Check>
void for_all_sizes(Check&& check) {
  [&]<int... K>(std::integer_sequence<int, K...>) {
    (check.template operator()<K + 1, vn::StandardDh>(), ...);
    (check.template operator()<K + 1, vn::ModifiedDh>(), ...);
  }
  (std::make_integer_sequence<int, 7>{});
}

TEST(GravityCompliance, TorquesAreSlopesOfPotentialEnergy) {
  for_all_sizes([]<int N, class Convention>() { expect_torques_of_potential_energy<N, Convention>(); });
}

TEST(GravityCompliance, AddsItsProductsWithTheirDerivative) {
  for_all_sizes([]<int N, class Convention>() { expect_sums_of_products<N, Convention>(); });
}

TEST(GravityCompliance, CountsItsProductsRowByRow) {
  Index expected = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) EXPECT_EQ(vn::GravityCompliance::index(i, j, 6), expected++);
  EXPECT_EQ(vn::GravityCompliance::size(6), expected);
}

TEST(GravityCompliance, DownIsADirection) {
  const vn::DhChain<1> arm({{.a = 1}});
  for (const vn::Vector3& bad :
       {vn::Vector3(0, 0, -9.81), vn::Vector3(0, 0, 0), vn::Vector3(0, 0, -1.00001), vn::Vector3(0, 0.99999, 0),
        vn::Vector3(std::nan(""), 0, 1), vn::Vector3(1 + 1.2e-6, 0, 0)})
    EXPECT_THROW((void)vn::GravityCompliance(arm, bad), std::invalid_argument);
  EXPECT_NO_THROW((void)vn::GravityCompliance(arm, vn::Vector3(1 - 0.8e-6, 0, 0)));  // written with six digits
}

}  // namespace
}  // namespace gravity_compliance_test
