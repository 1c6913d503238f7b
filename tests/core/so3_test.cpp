// SPDX-License-Identifier: BSD-3-Clause
// Rotations: exponential, logarithm and their derivatives, at identity, near half a turn and between.

#include "vernier/core/so3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/check.hpp"

namespace vn = vernier;

namespace so3_test {
namespace {

using namespace vernier_test;

constexpr double pi = std::numbers::pi;
const RealMatrix identity = RealMatrix::identity(3);

/// Angles where something switches, and between.
std::vector<double> angles() {
  return {0,       1e-300, 1e-160,    1e-20,   1e-12,     1e-8,      1e-6,       0.99e-4,    1e-4,
          1.01e-4, 1e-3,   0.99e-2,   1.01e-2, 0.1,       1.0,       pi / 2,     2 * pi / 3, 2.0943952,
          2.5,     3.0,    pi - 1e-4, 3.14159, pi - 1e-6, pi - 1e-8, pi - 1e-12, pi - 1e-15};
}

TEST(Skew, IsTheCrossProduct) {
  const vn::Vector3 a(1, 2, 3), b(-4, 5, 0.5);
  const RealMatrix of_a = vn::skew(a);
  EXPECT_EQ(of_a * b, RealMatrix(vn::Vector3(a.cross(b))));
  EXPECT_EQ(of_a.transpose(), -of_a);
}

/// Rodrigues' formula in extended precision.
vn::Matrix3 rodrigues(const vn::Vector3& r) {
  using Real = long double;
  const auto x = static_cast<Real>(r(0)), y = static_cast<Real>(r(1)), z = static_cast<Real>(r(2)),
             angle = std::sqrt(x * x + y * y + z * z);
  const bool tiny = angle < 1e-100L;
  const Real half = std::sin(angle / 2);
  const Real odd = tiny ? 1 : std::sin(angle) / angle, even = tiny ? 0 : 2 * (half / angle) * (half / angle);
  const Real k[3][3] = {{0, -z, y}, {z, 0, -x}, {-y, x, 0}};
  vn::Matrix3 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Real square = k[i][0] * k[0][j] + k[i][1] * k[1][j] + k[i][2] * k[2][j];
      out(i, j) = static_cast<double>((i == j ? 1 : 0) + odd * k[i][j] + even * square);
    }
  return out;
}

TEST(ExpSo3, IsRodriguesFormulaAtEveryAngle) {
  vn::Rng rng(1);
  for (const double angle : angles()) {
    for (int i = 0; i < 50; ++i) {
      const vn::Vector3 r = angle * random_direction(rng);
      const vn::Matrix3 rotation = vn::exp_so3(r);
      ASSERT_LE(difference(rotation, rodrigues(r)), 1e-15) << angle;
      ASSERT_LE(difference(RealMatrix(rotation) * RealMatrix(rotation).transpose(), identity), 2e-15) << angle;
      // To all digits of the angle, however small: the odd part is sin(t)/t r.
      const vn::Vector3 odd(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                            rotation(1, 0) - rotation(0, 1));
      if (angle > 0 && angle < 1e-4) {
        ASSERT_LE((odd / 2 - r * (1 - angle * angle / 6)).norm(), 4e-16 * std::max(angle, angle * angle)) << angle;
      }
    }
  }
  EXPECT_EQ(RealMatrix(vn::exp_so3(vn::Vector3::Zero())), identity);
}

/// (1 - cos t)/t^2 and (t - sin t)/t^3 by their series in extended precision; t well below 1.
long double versine_over_square(long double t) {
  const long double t2 = t * t;
  return (1 - t2 / 12 * (1 - t2 / 30 * (1 - t2 / 56))) / 2;
}
long double excess_over_cube(long double t) {
  const long double t2 = t * t;
  return (1 - t2 / 20 * (1 - t2 / 42 * (1 - t2 / 72))) / 6;
}

// Not only to the digits of the whole matrix: about an axis in a coordinate plane, one element is of second order
// alone.
TEST(ExpSo3, SmallElementsOfSmallRotationsHaveTheirDigits) {
  for (const double angle : {1e-7, 1e-6, 1e-5, 0.5e-4, 0.99e-4, 1.01e-4, 1e-3}) {
    const double x = 0.8 * angle, y = 0.6 * angle;
    const vn::Matrix3 rotation = vn::exp_so3(vn::Vector3(x, y, 0));
    const long double even = versine_over_square(static_cast<long double>(std::hypot(x, y)));
    const auto expected = static_cast<double>(even * static_cast<long double>(x) * static_cast<long double>(y));
    EXPECT_NEAR(rotation(0, 1) / expected, 1, 2e-14) << angle;
    EXPECT_NEAR(rotation(1, 0) / expected, 1, 2e-14) << angle;
  }
}

TEST(LogSo3, UndoesExpAtEveryAngle) {
  vn::Rng rng(2);
  for (const double angle : angles()) {
    for (int i = 0; i < 200; ++i) {
      const vn::Vector3 r = angle * random_direction(rng);
      const vn::Vector3 back = vn::log_so3(vn::exp_so3(r));
      if (angle > pi - 1e-14) {  // at half a turn either sign is right
        ASSERT_LE(std::min((back - r).norm(), (back + r).norm()), 4e-15) << angle;
      } else {
        ASSERT_LE((back - r).norm(), angle < 1 ? 1e-15 * angle : 4e-15) << angle;  // all digits, however small
      }
      ASSERT_LE(back.norm(), pi * (1 + 1e-15));
    }
  }
  EXPECT_EQ(RealMatrix(vn::log_so3(vn::Matrix3::Identity())), vector({0, 0, 0}));
}

TEST(LogSo3, HalfTurnsAboutEveryAxis) {
  // R = 2 a a' - I exactly; its logarithm is pi a, up to sign.
  vn::Rng rng(3);
  std::vector<vn::Vector3> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 200; ++i) axes.push_back(random_direction(rng));
  for (const vn::Vector3& a : axes) {
    vn::Matrix3 rotation;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rotation(i, j) = 2 * a(i) * a(j) - (i == j ? 1 : 0);
    const vn::Vector3 r = vn::log_so3(rotation);
    EXPECT_LE(std::min((r - pi * a).norm(), (r + pi * a).norm()), 4e-15);
  }
}

/// Central difference of `log(exp(r + d) exp(r)')` over d: the left Jacobian by its definition.
vn::Matrix3 left_jacobian_by_differences(const vn::Vector3& r) {
  constexpr double h = 1e-5;
  vn::Matrix3 out;
  for (int k = 0; k < 3; ++k) {
    vn::Vector3 ahead = r, behind = r;
    ahead(k) += h;
    behind(k) -= h;
    const vn::Vector3 turned = vn::log_so3(vn::exp_so3(ahead) * vn::exp_so3(behind).transpose());
    for (int i = 0; i < 3; ++i) out(i, k) = turned(i) / (2 * h);
  }
  return out;
}

TEST(LeftJacobianSo3, IsTheDerivativeOfExpAndItsInverseTheInverse) {
  vn::Rng rng(4);
  for (const double angle : angles()) {
    for (int i = 0; i < 20; ++i) {
      const vn::Vector3 r = angle * random_direction(rng);
      const RealMatrix jacobian = vn::left_jacobian_so3(r);
      ASSERT_LE(difference(jacobian, left_jacobian_by_differences(r)), 1e-9) << angle;
      ASSERT_LE(difference(jacobian * vn::left_jacobian_inverse_so3(r), identity), 4e-15) << angle;
      // A rate along r is an angular velocity along r; and Jl(-r) = Jl(r)'.
      ASSERT_LE((jacobian * r - r).norm(), 1e-15 * std::max(angle, 1e-300) * 4) << angle;
      ASSERT_LE(difference(vn::left_jacobian_so3(-r), jacobian.transpose()), 1e-15) << angle;
    }
  }
  EXPECT_EQ(RealMatrix(vn::left_jacobian_so3(vn::Vector3::Zero())), identity);
  EXPECT_EQ(RealMatrix(vn::left_jacobian_inverse_so3(vn::Vector3::Zero())), identity);
}

// About an axis in a coordinate plane: J(0, 1) = (t - sin t)/t^3 x y, J(0, 2) = (1 - cos t)/t^2 y; of the inverse
// c x y, and c = (1 - t/2 cot(t/2))/t^2 = 1/12 + t^2/720 + t^4/30240 + t^6/1209600.
TEST(LeftJacobianSo3, SmallElementsHaveTheirDigits) {
  for (const double angle : {1e-6, 1e-4, 1e-3, 5e-3, 0.9e-2, 0.99e-2}) {
    const double x = 0.8 * angle, y = 0.6 * angle;
    const long double product = static_cast<long double>(x) * static_cast<long double>(y),
                      t = static_cast<long double>(std::hypot(x, y)), t2 = t * t;
    const vn::Matrix3 jacobian = vn::left_jacobian_so3(vn::Vector3(x, y, 0)),
                      inverse = vn::left_jacobian_inverse_so3(vn::Vector3(x, y, 0));
    EXPECT_NEAR(jacobian(0, 1) / static_cast<double>(excess_over_cube(t) * product), 1, 1.5e-15) << angle;
    EXPECT_NEAR(jacobian(0, 2) / static_cast<double>(versine_over_square(t) * static_cast<long double>(y)), 1, 1.5e-15)
        << angle;
    const long double c = (1 + t2 / 60 * (1 + t2 / 42 * (1 + t2 / 40))) / 12;
    EXPECT_NEAR(inverse(0, 1) / static_cast<double>(c * product), 1, 1.5e-15) << angle;
  }
}

TEST(LeftJacobianSo3, SeriesAndFormulaMeet) {
  const vn::Vector3 axis = vn::Vector3(2, -1, 2) / 3;
  const auto jump = [&](auto&& f) {
    return difference(f((1e-2 * (1 + 1e-12)) * axis), f((1e-2 * (1 - 1e-12)) * axis));
  };
  EXPECT_LE(jump([](const vn::Vector3& r) { return vn::left_jacobian_so3(r); }), 1e-13);
  EXPECT_LE(jump([](const vn::Vector3& r) { return vn::left_jacobian_inverse_so3(r); }), 1e-13);
}

TEST(LeftJacobianSo3, InverseIsFiniteBelowAFullTurn) {
  const vn::Vector3 axis = vn::Vector3(2, -1, 2) / 3;
  for (const double angle : {pi, 4.0, 5.0, 6.0}) {
    const RealMatrix jacobian = vn::left_jacobian_so3(angle * axis);
    EXPECT_LE(difference(jacobian * vn::left_jacobian_inverse_so3(angle * axis), identity), 1e-13) << angle;
  }
}

TEST(PoseDifference, TakesOneFrameToTheOther) {
  vn::Rng rng(5);
  for (int i = 0; i < 100; ++i) {
    const vn::Matrix3 orientation = vn::exp_so3(rng.uniform(0, 3) * random_direction(rng));
    const vn::Vector3 place = random_direction(rng);
    const vn::Vector3 turn = rng.uniform(0, 3) * random_direction(rng), shift = random_direction(rng);
    const vn::Isometry3 from = vn::rigid_motion(orientation, place);
    const vn::Isometry3 to = vn::rigid_motion(vn::exp_so3(turn) * orientation, place + shift);
    const RealMatrix e = vn::pose_difference(to, from);
    EXPECT_LE((e.block(0, 0, 3, 1) - shift).norm(), 1e-15);
    EXPECT_LE((e.block(3, 0, 3, 1) - turn).norm(), 1e-14);
    EXPECT_LE((vn::rotation_difference(vn::rotation(to), vn::rotation(from)) - turn).norm(), 1e-14);
    for (const double fraction : {0.0, 0.3, 1.0}) {  // so far on the way
      const RealMatrix passed = vn::pose_difference(vn::interpolated(from, to, fraction), from);
      EXPECT_LE((passed - fraction * e).norm(), 1e-14);
    }
  }
}

}  // namespace
}  // namespace so3_test
