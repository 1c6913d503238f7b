// SPDX-License-Identifier: BSD-3-Clause
// Sines, cosines and exponentials of vectors against the standard library's, for every instruction set that the machine
// has.

#include "vernier/core/simd.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "vernier/core/rng.hpp"

namespace vernier::simd_test {
namespace {

constexpr double pi = std::numbers::pi;

struct SinCosRows {
  std::vector<double> sine, cosine;
};

/// Three vectors at a time; the number of angles is a multiple of 12.
template <int W>
VERNIER_INLINE void sincos_rows(const std::vector<double>& angles, SinCosRows& out) {
  for (std::size_t i = 0; i < angles.size(); i += 3 * W) {
    typename detail::Simd<W>::Double x[3], s[3], c[3];
    for (std::size_t k = 0; k < 3; ++k) detail::load<W>(x[k], angles.data() + i + k * W);
    detail::sincos<W>(x, s, c);
    for (std::size_t k = 0; k < 3; ++k) {
      detail::store<W>(out.sine.data() + i + k * W, s[k]);
      detail::store<W>(out.cosine.data() + i + k * W, c[k]);
    }
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void sincos_fma(const std::vector<double>& angles, SinCosRows& out) {
  sincos_rows<4>(angles, out);
}
#endif

/// By each instruction set in turn; the ones without FMA must agree to the bit.
std::vector<SinCosRows> sincos_by_all(std::vector<double> angles) {
  while (angles.size() % 12 != 0) angles.push_back(0);
  SinCosRows out{std::vector<double>(angles.size()), std::vector<double>(angles.size())};
  const auto run = [&]<int W>() VERNIER_INLINED { sincos_rows<W>(angles, out); };
  detail::run_same_bits(run, InstructionSet::baseline);
  std::vector<SinCosRows> all{out};
#if defined(__x86_64__)
  if (widest_instruction_set() != InstructionSet::baseline) {
    detail::run_same_bits(run, InstructionSet::avx2);
    for (std::size_t i = 0; i < angles.size(); ++i) {
      if (std::isnan(out.sine[i]) && std::isnan(out.cosine[i])) continue;
      EXPECT_EQ(out.sine[i], all[0].sine[i]) << angles[i];
      EXPECT_EQ(out.cosine[i], all[0].cosine[i]) << angles[i];
    }
    all.push_back(out);
    sincos_fma(angles, out);
    all.push_back(out);
  }
#endif
  return all;
}

void expect_close(const std::vector<double>& angles, double tolerance) {
  for (const SinCosRows& rows : sincos_by_all(angles)) {
    for (std::size_t i = 0; i < angles.size(); ++i) {
      ASSERT_NEAR(rows.sine[i], std::sin(angles[i]), tolerance) << angles[i];
      ASSERT_NEAR(rows.cosine[i], std::cos(angles[i]), tolerance) << angles[i];
    }
  }
}

TEST(VectorSinCosWhiteBox, EqualTheLibraryFunctionsOverManyRanges) {
  Rng rng(1);
  for (const double range : {1e-300, 1e-12, 1e-4, pi / 4, pi, 2 * pi, 100.0, 1e4, 1e5}) {
    std::vector<double> angles(48000);
    for (double& x : angles) x = rng.uniform(-range, range);
    expect_close(angles, 3e-16);
  }
}

TEST(VectorSinCosWhiteBox, EqualTheLibraryFunctionsAroundMultiplesOfAnEighthTurn) {
  std::vector<double> angles;
  for (int k = -100000; k <= 100000; k += k > -200 && k < 200 ? 1 : 7) {
    const double angle = k * (pi / 4);
    for (const double x : {std::nextafter(angle, -1e9), angle, std::nextafter(angle, 1e9), angle + 1e-9})
      angles.push_back(x);
  }
  expect_close(angles, 3e-16);
}

TEST(VectorSinCosWhiteBox, AnglesNearZeroAndPiKeepTheirDigits) {
  std::vector<double> angles;
  for (double x = 1e-300; x < 0.5; x *= 3) angles.insert(angles.end(), {x, -x, pi + x, pi - x});
  for (const SinCosRows& rows : sincos_by_all(angles)) {
    for (std::size_t i = 0; i < angles.size(); ++i) {
      const double expected = std::sin(angles[i]);
      EXPECT_NEAR(rows.sine[i], expected, 4e-16 * std::abs(expected)) << angles[i];
    }
  }
}

TEST(VectorSinCosWhiteBox, BeyondTheRangeOfTheReductionTheLibraryIsAsked) {
  Rng rng(3);
  std::vector<double> angles;
  for (int i = 0; i < 1200; ++i) angles.push_back(rng.sign() * std::pow(10.0, rng.uniform(5.0001, 308)));
  angles.insert(angles.end(), {1.7976931348623157e308, -1.7976931348623157e308, std::nextafter(1e5, 1e6), -100000.01});
  for (const SinCosRows& rows : sincos_by_all(angles)) {
    for (std::size_t i = 0; i < angles.size(); ++i) {
      ASSERT_EQ(rows.sine[i], std::sin(angles[i])) << angles[i];
      ASSERT_EQ(rows.cosine[i], std::cos(angles[i])) << angles[i];
    }
  }
}

TEST(VectorSinCosWhiteBox, ALaneIsNotDisturbedByItsNeighbours) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  std::vector<double> calm(24), disturbed;
  for (std::size_t i = 0; i < calm.size(); ++i) calm[i] = 0.3 * static_cast<double>(i) - 2;
  const auto expected = sincos_by_all(calm);
  for (const double strange : {nan, -nan, infinity, -infinity, 1e6, -1e300}) {
    for (std::size_t at = 0; at < calm.size(); ++at) {
      disturbed = calm;
      disturbed[at] = strange;
      const auto all = sincos_by_all(disturbed);
      for (std::size_t set = 0; set < all.size(); ++set) {
        for (std::size_t i = 0; i < calm.size(); ++i) {
          if (i != at) {
            ASSERT_EQ(all[set].sine[i], expected[set].sine[i]);
            ASSERT_EQ(all[set].cosine[i], expected[set].cosine[i]);
          } else if (std::isfinite(strange)) {
            ASSERT_EQ(all[set].sine[i], std::sin(strange));
          } else {
            ASSERT_TRUE(std::isnan(all[set].sine[i]) && std::isnan(all[set].cosine[i])) << strange;
          }
        }
      }
    }
  }
}

/// By each instruction set in turn.
std::vector<std::vector<double>> exponentials_by_all(std::vector<double> x) {
  while (x.size() % 8 != 0) x.push_back(0);
  std::vector<std::vector<double>> all;
  for (const InstructionSet set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
    if (set > widest_instruction_set()) break;
    std::vector<double> out(x.size());
    detail::run_widest(
        [&]<int W>() VERNIER_INLINED {
          typename detail::Simd<W>::Double v;
          for (std::size_t i = 0; i < x.size(); i += W) {
            detail::load<W>(v, x.data() + i);
            detail::exponential<W>(v);
            detail::store<W>(out.data() + i, v);
          }
        },
        set);
    all.push_back(out);
  }
  return all;
}

TEST(VectorExponentialWhiteBox, EqualsTheLibraryFunctionOverManyRanges) {
  Rng rng(4);
  for (const double range : {1e-300, 1e-12, 1e-4, 0.35, 1.0, 30.0, 708.0}) {
    std::vector<double> x(48000);
    for (double& value : x) value = rng.uniform(-range, range);
    for (const auto& found : exponentials_by_all(x))
      for (std::size_t i = 0; i < x.size(); ++i)
        ASSERT_NEAR(found[i], std::exp(x[i]), 4.5e-16 * std::exp(x[i])) << x[i];
  }
}

TEST(VectorExponentialWhiteBox, IsExactAtZeroAndHeldBeyondItsRange) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> x{0,     -0.0, 708,  -708, std::nextafter(708, 709), -1e300, infinity, -infinity,
                              1e300, -709, -745, 709};
  for (const auto& found : exponentials_by_all(x)) {
    EXPECT_EQ(found[0], 1);
    EXPECT_EQ(found[1], 1);
    for (std::size_t i = 2; i < x.size(); ++i) {
      const double expected = std::exp(x[i] > 0 ? 708 : -708);
      EXPECT_NEAR(found[i], expected, 4.5e-16 * expected) << x[i];
    }
  }
  for (const auto& found : exponentials_by_all({std::numeric_limits<double>::quiet_NaN(), 1}))
    EXPECT_TRUE(std::isnan(found[0]) && std::abs(found[1] - std::exp(1)) < 1e-15);
}

}  // namespace
}  // namespace vernier::simd_test
