// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/evaluation/sign_flip_test.hpp"

namespace vernier {

VERNIER_IMPL double sign_flip_test(const ConstVectorRef& differences, Index draws, std::uint64_t seed) {
  const Index n = differences.size();
  demand(n > 0 && draws > 0, "sign_flip_test: ", n, " differences and ", draws, " draws");
  double sum = 0, size = 0;
  for (const double value : differences) {
    demand(std::isfinite(value), "sign_flip_test: a difference is not finite");
    sum += value;
    size += std::abs(value);
  }
  const double least = sum - 1e-12 * size;  // equal sums differ by rounding
  constexpr Index few = 12;
  const bool all = n <= few;
  const Index arrangements = all ? Index{1} << n : draws;
  Rng rng(seed);
  Index as_large = 0;
  for (Index a = 0; a < arrangements; ++a) {
    double flipped = 0;
    std::uint64_t bits = static_cast<std::uint64_t>(a);
    for (Index i = 0; i < n; ++i) {
      if (!all && i % 64 == 0) bits = rng();
      flipped += (bits >> (i % 64)) % 2 == 0 ? differences(i) : -differences(i);
    }
    as_large += flipped >= least;
  }
  if (all) return static_cast<double>(as_large) / static_cast<double>(arrangements);
  return static_cast<double>(as_large + 1) / static_cast<double>(arrangements + 1);
}

}  // namespace vernier
