// SPDX-License-Identifier: BSD-3-Clause
// Random numbers: known answers, moments, no bias.

#include "vernier/core/rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <random>

namespace vn = vernier;

namespace rng_test {
namespace {

static_assert(std::uniform_random_bit_generator<vn::Rng>);

using Words = std::array<std::uint64_t, 4>;

TEST(Rng, StateIsSeededBySplitMix64) {
  // First outputs of SplitMix64 for seeds 0 and 1234567, as published with its reference implementation.
  EXPECT_EQ(std::bit_cast<Words>(vn::Rng(0)),
            (Words{0xe220a8397b1dcdaf, 0x6e789e6aa1b965f4, 0x06c45d188009454f, 0xf88bb8a8724c81ec}));
  EXPECT_EQ(std::bit_cast<Words>(vn::Rng(1234567)),
            (Words{6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u}));
}

TEST(Rng, SequenceIsThatOfXoshiro256PlusPlus) {
  // From the state (1, 2, 3, 4): the sequence that other implementations test against.
  auto rng = std::bit_cast<vn::Rng>(Words{1, 2, 3, 4});
  constexpr std::uint64_t sequence[] = {41943041u,
                                        58720359u,
                                        3588806011781223u,
                                        3591011842654386u,
                                        9228616714210784205u,
                                        9973669472204895162u,
                                        14011001112246962877u,
                                        12406186145184390807u,
                                        15849039046786891736u,
                                        10450023813501588000u};
  for (const std::uint64_t expected : sequence) EXPECT_EQ(rng(), expected);
}

// The upper 53 bits of the first number of seed 0.
constexpr double first = vn::Rng(0).uniform();
static_assert(first == static_cast<double>(0x53175d61490b23dfu >> 11) / 9007199254740992.0);

// Bounds of five standard deviations of the estimate: a right generator fails one in two million seeds.
constexpr double five_sigma = 5;

// Between bounds it is the number between 0 and 1, stretched.
TEST(Rng, UniformBetweenBounds) {
  vn::Rng rng(1), unit(1);
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.uniform(-3, 2);
    EXPECT_NEAR(u, -3 + 5 * unit.uniform(), 1e-15);
    ASSERT_TRUE(u >= -3 && u < 2);
  }
}

// The polar method keeps the direction of a uniform point in the unit disk, s its squared distance from the centre, and
// puts it at a squared distance of -2 log(s). From the same words on every machine.
TEST(Rng, NormalPairsLieInTheDirectionsOfUniformPoints) {
  vn::Rng rng(8), uniforms(8);
  int outside = 0;
  for (int i = 0; i < 200; ++i) {
    double u = 0, v = 0, s = 0;
    for (;; ++outside) {
      u = 2 * uniforms.uniform() - 1;
      v = 2 * uniforms.uniform() - 1;
      s = u * u + v * v;
      if (s < 1) break;
    }
    vn::Rng alike = rng;
    const auto [x, y] = rng.normal_pair();
    EXPECT_EQ(rng, uniforms) << "two words a point, those outside the disk included";
    EXPECT_NEAR(x * x + y * y, -2 * std::log(s), 1e-12);
    EXPECT_NEAR(x * v, y * u, 1e-14);
    EXPECT_GT(x * u + y * v, 0);
    EXPECT_EQ(alike.normal(), x) << "the first of a pair";
    EXPECT_EQ(alike, rng);
  }
  EXPECT_GT(outside, 20);
}

// The first bit of a word, set for +1: as in every release, so that seeded results stay.
TEST(Rng, SignsAreFirstBits) {
  vn::Rng words(4), signs(4);
  for (int i = 0; i < 100; ++i) {
    const bool upper_half = words() >= std::uint64_t{1} << 63;
    EXPECT_EQ(signs.sign(), upper_half ? 1 : -1);
  }
}

TEST(Rng, BelowHasNoModuloBias) {
  // With n = 3 * 2^62 a plain remainder would fall below 2^62 half of the time instead of a third.
  constexpr int draws = 100'000;
  constexpr std::uint64_t n = 3u * (std::uint64_t{1} << 62);
  vn::Rng rng(4);
  int low = 0;
  for (int i = 0; i < draws; ++i) {
    const std::uint64_t r = rng.below(n);
    ASSERT_LT(r, n);
    low += r < n / 3;
  }
  EXPECT_NEAR(static_cast<double>(low) / draws, 1.0 / 3, five_sigma * std::sqrt(2.0 / 9 / draws));
}

TEST(Rng, PermutationsAreWholeAndEven) {
  vn::Rng rng(6);
  auto order = rng.permutation(1000);
  EXPECT_FALSE(std::is_sorted(order.begin(), order.end()));
  std::sort(order.begin(), order.end());
  for (vn::Index i = 0; i < 1000; ++i) ASSERT_EQ(order[static_cast<std::size_t>(i)], i);
  EXPECT_TRUE(rng.permutation(0).empty());
  EXPECT_EQ(rng.permutation(1), std::vector<vn::Index>{0});
  // n numbers have n - 1 free places: that many words are drawn (of 2^57 less than one is rejected)
  for (const vn::Index n : {0, 1, 2, 5, 100}) {
    vn::Rng drawn = rng;
    for (vn::Index i = 1; i < n; ++i) drawn();
    EXPECT_EQ(rng.permutation(n).size(), static_cast<std::size_t>(n));
    EXPECT_EQ(rng, drawn) << n;
  }

  constexpr int draws = 48'000;
  std::map<std::vector<vn::Index>, int> counts;
  for (int i = 0; i < draws; ++i) ++counts[rng.permutation(4)];
  ASSERT_EQ(counts.size(), 24u);
  for (const auto& [permutation, count] : counts)
    EXPECT_NEAR(static_cast<double>(count) / draws, 1.0 / 24, five_sigma * std::sqrt(23.0 / 576 / draws));
}

// What a stream adds to the seed: the multiples of one odd number, counted from 1. Seeds that undo it leave the stream
// of seed 0. Another rule would change every seeded result.
TEST(Rng, ChildSeedsAreThoseOfEveryRelease) {
  constexpr std::uint64_t odd = 0xd1342543de82ef95u, first_of_seed_0 = 0x53175d61490b23df;
  EXPECT_EQ(vn::child_seed(0, ~std::uint64_t{0}), first_of_seed_0);  // 0 times
  EXPECT_EQ(vn::child_seed(odd, 0), first_of_seed_0);
  EXPECT_EQ(vn::child_seed(odd + odd, 1), first_of_seed_0);
}

}  // namespace
}  // namespace rng_test
