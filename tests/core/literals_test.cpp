// SPDX-License-Identifier: BSD-3-Clause
// Unit literals are the nearest doubles to what they say, at compile time.

#include "vernier/core/literals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <type_traits>

using namespace vernier::literals;

namespace literals_test {
namespace {

static_assert(290_mm == 0.29 && 270_mm == 0.27 && 70_mm == 0.07 && 302_mm == 0.302 && 72_mm == 0.072);
static_assert(127.3_mm == 0.1273 && 163.941_mm == 0.163941 && 89.159_mm == 0.089159 && -572.3_mm == -0.5723);
static_assert(0_mm == 0.0 && 1_mm == 0.001 && 0.001_mm == 1e-6 && 12345_mm == 12.345);
static_assert(30_um == 30e-6 && 0.5_um == 5e-7 && 1_um == 1e-6);
static_assert(1_m == 1.0 && 1.5_m == 1.5);
static_assert(180_deg == std::numbers::pi && -90_deg == -std::numbers::pi / 2 && 45_deg == std::numbers::pi / 4);
static_assert(0_deg == 0.0 && 22.5_deg == std::numbers::pi / 8 && 360.0_deg == 2 * std::numbers::pi);
static_assert(1_rad == 1.0 && 0.25_rad == 0.25);
static_assert(1_mrad == 0.001 && 0.3_mrad == 0.0003 && 1500_mrad == 1.5);
static_assert(std::is_same_v<decltype(1_mm), double> && std::is_same_v<decltype(1.0_deg), double>);

TEST(Literals, DegreesOfAFullTurnAreWithinOneUlp) {
  // One literal stands for all whole numbers: the operator itself, called with each.
  for (unsigned long long k = 0; k <= 720; ++k) {
    const long double exact = static_cast<long double>(k) * 3.14159265358979323846264338327950288L / 180.0L;
    const double value = operator""_deg(k);
    EXPECT_LE(std::abs(static_cast<double>(static_cast<long double>(value) - exact)),
              1.2e-16 * static_cast<double>(exact))
        << k;
    EXPECT_EQ(operator""_deg(static_cast<long double>(k)), value) << k;
  }
}

TEST(Literals, MillimetresAreTheDecimalNumbersTheyRead) {
  for (unsigned long long k = 0; k <= 5000; ++k) EXPECT_DOUBLE_EQ(operator""_mm(k), static_cast<double>(k) / 1000) << k;
}

}  // namespace
}  // namespace literals_test
