// Random numbers: known answers, moments, no bias.

#include "vernier/core/rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <random>
#include <set>

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

TEST(Rng, SeedAndSequenceTogether) {
  constexpr std::uint64_t seed_0[] = {0x53175d61490b23df, 0x61da6f3dc380d507, 0x5c0fdf91ec9a7bfc, 0x02eebf8c3bbe5e1a};
  constexpr std::uint64_t seed_42[] = {0xd0764d4f4476689f, 0x519e4174576f3791, 0xfbe07cfb0c24ed8c, 0xb37d9f600cd835b8};
  vn::Rng a(0), b(42);
  for (const std::uint64_t expected : seed_0) EXPECT_EQ(a(), expected);
  for (const std::uint64_t expected : seed_42) EXPECT_EQ(b(), expected);
  // uniform() is the upper 53 bits; also a constant expression.
  constexpr double first = vn::Rng(0).uniform();
  static_assert(first == static_cast<double>(0x53175d61490b23dfu >> 11) / 9007199254740992.0);
}

TEST(Rng, ACopyContinuesAlike) {
  vn::Rng a(5);
  a.normal();
  vn::Rng b = a;
  EXPECT_EQ(a, b);
  EXPECT_EQ(a.normal(), b.normal());
  a();
  EXPECT_FALSE(a == b);
}

// Bounds of five standard deviations of the estimate: a right generator fails one in two million seeds.
constexpr double five_sigma = 5;

TEST(Rng, UniformHasItsMoments) {
  constexpr int n = 1'000'000;
  vn::Rng rng(1);
  double sum = 0, sum2 = 0, lagged = 0, last = 0, low = 1, high = 0;
  for (int i = 0; i < n; ++i) {
    const double u = rng.uniform();
    sum += u;
    sum2 += (u - 0.5) * (u - 0.5);
    lagged += (u - 0.5) * (last - 0.5);
    last = u;
    low = std::min(low, u);
    high = std::max(high, u);
  }
  EXPECT_GE(low, 0);
  EXPECT_LT(high, 1);
  EXPECT_LT(low, 20.0 / n);
  EXPECT_GT(high, 1 - 20.0 / n);
  EXPECT_NEAR(sum / n, 0.5, five_sigma / std::sqrt(12.0 * n));
  EXPECT_NEAR(sum2 / n, 1.0 / 12, five_sigma / std::sqrt(180.0 * n));  // var((u - 1/2)^2) = 1/80 - 1/144
  EXPECT_NEAR(lagged / n, 0, five_sigma / 12 / std::sqrt(1.0 * n));
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.uniform(-3, 2);
    ASSERT_TRUE(u >= -3 && u < 2);
  }
}

TEST(Rng, NormalHasItsMomentsAndItsShape) {
  constexpr int n = 1'000'000;
  vn::Rng rng(2);
  std::vector<double> x(n);
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0, lagged = 0;
  for (int i = 0; i < n; ++i) {
    const double z = rng.normal();
    m1 += z;
    m2 += z * z;
    m3 += z * z * z;
    m4 += z * z * z * z;
    if (i > 0) lagged += z * x[static_cast<std::size_t>(i - 1)];
    x[static_cast<std::size_t>(i)] = z;
  }
  const double root = std::sqrt(1.0 * n);
  EXPECT_NEAR(m1 / n, 0, five_sigma / root);
  EXPECT_NEAR(m2 / n, 1, five_sigma * std::sqrt(2.0) / root);   // var(z^2) = 2
  EXPECT_NEAR(m3 / n, 0, five_sigma * std::sqrt(15.0) / root);  // var(z^3) = 15
  EXPECT_NEAR(m4 / n, 3, five_sigma * std::sqrt(96.0) / root);  // var(z^4) = 105 - 9
  EXPECT_NEAR(lagged / n, 0, five_sigma / root);
  // Kolmogorov and Smirnov: the largest gap of the distribution functions, 1.95 at a level of 0.001.
  std::sort(x.begin(), x.end());
  double gap = 0;
  for (int i = 0; i < n; ++i) {
    const double cdf = 0.5 * std::erfc(-x[static_cast<std::size_t>(i)] / std::sqrt(2.0));
    gap = std::max({gap, std::abs(cdf - static_cast<double>(i) / n), std::abs(cdf - static_cast<double>(i + 1) / n)});
  }
  EXPECT_LE(gap, 1.95 / root);
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

TEST(Rng, SignsAreEven) {
  constexpr int n = 100'000;
  vn::Rng rng(3);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double s = rng.sign();
    ASSERT_EQ(std::abs(s), 1);
    sum += s;
  }
  EXPECT_NEAR(sum / n, 0, five_sigma / std::sqrt(1.0 * n));
  // the first bit of a word, set for +1: as in every release, so that seeded results stay
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

TEST(Rng, BelowReachesEveryNumberEvenly) {
  constexpr int n = 7, draws = 70'000;
  vn::Rng rng(5);
  int counts[n] = {};
  for (int i = 0; i < draws; ++i) ++counts[rng.below(n)];
  for (const int count : counts)
    EXPECT_NEAR(static_cast<double>(count) / draws, 1.0 / n, five_sigma * std::sqrt(6.0 / 49 / draws));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(rng.below(1), 0u);
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

TEST(Rng, ChildSeedsDiffer) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    seeds.insert(seed);
    for (std::uint64_t stream = 0; stream < 100; ++stream) seeds.insert(vn::child_seed(seed, stream));
  }
  EXPECT_EQ(seeds.size(), 100u + 100u * 100u);
  static_assert(vn::child_seed(1, 2) == vn::child_seed(1, 2));
}

// What a stream adds to the seed: the multiples of one odd number, counted from 1. Seeds that undo it leave the stream
// of seed 0. Another rule would change every seeded result.
TEST(Rng, ChildSeedsAreThoseOfEveryRelease) {
  constexpr std::uint64_t odd = 0xd1342543de82ef95u, first_of_seed_0 = 0x53175d61490b23df;
  EXPECT_EQ(vn::child_seed(0, ~std::uint64_t{0}), first_of_seed_0);  // 0 times
  EXPECT_EQ(vn::child_seed(odd, 0), first_of_seed_0);
  EXPECT_EQ(vn::child_seed(odd + odd, 1), first_of_seed_0);
}

// Streams of one seed share no number, not even shifted, and do not correlate.
TEST(Rng, ChildStreamsAreIndependent) {
  constexpr int streams = 20, draws = 500;
  std::set<std::uint64_t> numbers;
  std::vector<std::vector<double>> uniforms;
  for (std::uint64_t stream = 0; stream < streams; ++stream) {
    vn::Rng rng(vn::child_seed(7, stream)), again = rng;
    uniforms.emplace_back();
    for (int k = 0; k < draws; ++k) {
      numbers.insert(rng());
      uniforms.back().push_back(again.uniform() - 0.5);
    }
  }
  EXPECT_EQ(numbers.size(), static_cast<std::size_t>(streams * draws));
  for (std::size_t a = 0; a < streams; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      double sum = 0;
      for (std::size_t k = 0; k < draws; ++k) sum += 12 * uniforms[a][k] * uniforms[b][k];
      EXPECT_LT(std::abs(sum) / std::sqrt(draws), 5) << a << ", " << b;  // five standard deviations
    }
}

}  // namespace
}  // namespace rng_test
