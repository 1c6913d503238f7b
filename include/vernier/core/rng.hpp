// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Random numbers with bits that agree across compilers and standard libraries.

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// xoshiro256++, seeded by SplitMix64, with distributions of our own; a value type, copied with its state.
/// Satisfies `std::uniform_random_bit_generator`.
/// @cite Blackman and Vigna 2021
class Rng {
 public:
  /// What one call yields.
  using result_type = std::uint64_t;

  /// A stream determined by its seed.
  explicit constexpr Rng(std::uint64_t seed = 0) {
    for (auto& word : state_) {  // SplitMix64, as its authors recommend for seeding
      seed += 0x9e3779b97f4a7c15u;
      std::uint64_t z = seed;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      word = z ^ (z >> 31);
    }
  }

  /// Smallest value of a call.
  static constexpr result_type(min)() { return 0; }
  /// Largest value of a call.
  static constexpr result_type(max)() { return ~result_type{0}; }

  /// The next 64 bits.
  constexpr result_type operator()() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  /// Uniform in [0, 1), 53 bits.
  constexpr double uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }

  /// Uniform in [lower, upper).
  constexpr double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

  /// Uniform integer in [0, n), n >= 1, without modulo bias.
  constexpr std::uint64_t below(std::uint64_t n) {
    const std::uint64_t threshold = (0 - n) % n;
    for (;;)
      if (const std::uint64_t r = (*this)(); r >= threshold) return r % n;
  }

  /// Two independent standard normal numbers, by Marsaglia's polar method.
  /// @cite Marsaglia and Bray 1964
  std::array<double, 2> normal_pair() {
    for (;;) {
      const double u = uniform(-1, 1);
      const double v = uniform(-1, 1);
      const double s = u * u + v * v;
      if (!(s > 0 && s < 1)) continue;
      const double scale = std::sqrt(-2 * std::log(s) / s);
      return {u * scale, v * scale};
    }
  }

  /// Standard normal: the first of `normal_pair`. The second is dropped, so that the generator's state is all there is.
  double normal() { return normal_pair()[0]; }

  /// -1 or +1 with equal probability.
  constexpr double sign() { return ((*this)() >> 63) != 0 ? 1.0 : -1.0; }

  /// The numbers 0 .. n-1 in random order (Fisher and Yates).
  std::vector<Index> permutation(Index n) {
    std::vector<Index> order(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) order[static_cast<std::size_t>(i)] = i;
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[below(i)]);
    return order;
  }

  /// Equal in every bit of state.
  bool operator==(const Rng&) const = default;

 private:
  std::array<std::uint64_t, 4> state_{};
};

/// A seed for an independent stream of a seeded computation, e.g. one per run or per purpose.
constexpr std::uint64_t child_seed(std::uint64_t seed, std::uint64_t stream) {
  Rng rng(seed ^ (0xd1342543de82ef95u * (stream + 1)));
  return rng();
}

}  // namespace vernier
