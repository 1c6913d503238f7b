// SPDX-License-Identifier: BSD-3-Clause
// Sine and cosine of constant expressions against the standard library's.

#include "vernier/kinematics/detail/constexpr_trig.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "vernier/core/rng.hpp"

using vernier::detail::constexpr_sincos;

namespace constexpr_trig_test {
namespace {

// Known at compile time.
static_assert(constexpr_sincos(0).sin == 0 && constexpr_sincos(0).cos == 1);
static_assert(constexpr_sincos(std::numbers::pi / 2).sin == 1);
static_assert(constexpr_sincos(-std::numbers::pi / 2).sin == -1);
static_assert(constexpr_sincos(std::numbers::pi).cos == -1);

/// How many representable numbers lie between two.
std::int64_t ulps(double a, double b) {
  const auto ordered = [](double x) {
    const auto bits = std::bit_cast<std::int64_t>(x);
    return bits < 0 ? std::numeric_limits<std::int64_t>::min() - bits : bits;
  };
  return std::abs(ordered(a) - ordered(b));
}

void expect_close(double angle) {
  const auto [sine, cosine] = constexpr_sincos(angle);
  EXPECT_LE(ulps(sine, std::sin(angle)), 2) << "sin " << angle;
  EXPECT_LE(ulps(cosine, std::cos(angle)), 2) << "cos " << angle;
}

TEST(ConstexprSinCosWhiteBox, WithinTwoUlpsForAnglesOfATable) {
  constexpr int n = 100000;
  for (int i = -n; i <= n; ++i) expect_close(2 * std::numbers::pi * i / n);
}

TEST(ConstexprSinCosWhiteBox, WithinTwoUlpsAtMultiplesOfAQuarterTurn) {
  for (int k = -40000; k <= 40000; ++k) {
    const double angle = k * (std::numbers::pi / 2);
    expect_close(angle);
    expect_close(std::nextafter(angle, 1e9));
    expect_close(std::nextafter(angle, -1e9));
  }
}

TEST(ConstexprSinCosWhiteBox, WithinTwoUlpsForSmallAndLargeAngles) {
  vernier::Rng rng(1);
  for (int i = 0; i < 200000; ++i) {
    expect_close(rng.sign() * std::pow(10.0, rng.uniform(-300, 0)));
    expect_close(rng.uniform(-1e5, 1e5));
  }
}

}  // namespace
}  // namespace constexpr_trig_test
