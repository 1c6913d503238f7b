// SPDX-License-Identifier: BSD-3-Clause
// Rotations of dual numbers: the derivative is right where the angle is zero, tiny, and half a turn.

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <numbers>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"

namespace vn = vernier;
using vernier_test::difference;
using vernier_test::RealMatrix;

namespace so3_jet_test {
namespace {

constexpr double pi = std::numbers::pi;
using Jet = ceres::Jet<double, 3>;
using JetVector = Eigen::Matrix<Jet, 3, 1>;
using JetMatrix = Eigen::Matrix<Jet, 3, 3>;

JetVector seeded(const vn::Vector3& r) { return {Jet(r.x(), 0), Jet(r.y(), 1), Jet(r.z(), 2)}; }

RealMatrix rates(const JetMatrix& m, int k) {
  RealMatrix out(3, 3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = m(i, j).v(k);
  return out;
}

TEST(ExpSo3OfDualNumbers, IsTheLeftJacobianEverywhere) {
  vn::Rng rng(1);
  for (const double angle : {0.0, 1e-300, 1e-160, 1e-12, 0.99e-4, 1.01e-4, 1e-2, 1.0, 3.0, pi - 1e-9, pi, 5.0}) {
    for (int i = 0; i < 20; ++i) {
      const vn::Vector3 r = angle * vernier_test::random_direction(rng);
      const JetMatrix rotation = vn::exp_so3(seeded(r));
      for (int k = 0; k < 3; ++k) {
        const vn::Matrix3 jacobian = vn::left_jacobian_so3(r);
        const vn::Vector3 rate(jacobian(0, k), jacobian(1, k), jacobian(2, k));
        const RealMatrix expected = RealMatrix(vn::skew(rate)) * vn::exp_so3(r);
        ASSERT_LE(difference(rates(rotation, k), expected), 2e-12) << angle;
      }
    }
  }
}

/// d log(exp(e) R) / de at e = 0, by dual numbers.
RealMatrix log_rates(const vn::Matrix3& rotation) {
  JetMatrix at;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) at(i, j) = Jet(rotation(i, j));
  const JetMatrix moved = vn::exp_so3(seeded(vn::Vector3::Zero())) * at;
  const JetVector r = vn::log_so3(moved);
  RealMatrix out(3, 3);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out(i, k) = r(i).v(k);
  return out;
}

TEST(LogSo3OfDualNumbers, IsTheInverseLeftJacobianEverywhere) {
  vn::Rng rng(2);
  for (const double angle : {0.0, 1e-300, 1e-12, 0.99e-4, 1.99e-4, 2.01e-4, 1e-2, 1.0, pi / 2, 2.0, 2.2, 3.0, pi - 1e-6,
                             pi - 1e-9, pi - 1e-13}) {
    for (int i = 0; i < 20; ++i) {
      const vn::Vector3 r = angle * vernier_test::random_direction(rng);
      const vn::Matrix3 expected = vn::left_jacobian_inverse_so3(r);
      ASSERT_LE(difference(log_rates(vn::exp_so3(r)), expected), 2e-12) << angle;
    }
  }
}

TEST(LogSo3OfDualNumbers, IsFiniteAtHalfATurn) {
  for (int k = 0; k < 3; ++k) {
    vn::Matrix3 half = -vn::Matrix3::Identity();
    half(k, k) = 1;
    const vn::Vector3 r = vn::log_so3(half);
    EXPECT_NEAR(r.norm(), pi, 1e-15);
    EXPECT_LE(difference(log_rates(half), vn::left_jacobian_inverse_so3(r)), 1e-14);
  }
}

}  // namespace
}  // namespace so3_jet_test
