// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/rng.hpp"
#include "vernier/testing/any_regressor.hpp"

namespace vernier::testing::detail {

VERNIER_IMPL Samples::Samples(Index n, Index inputs, Index outputs, std::uint64_t seed) : x(n, inputs), y(n, outputs) {
  Rng rng(seed);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < inputs; ++j) x(i, j) = rng.uniform(-1.5, 1.5);
    for (Index k = 0; k < outputs; ++k) {
      const auto output = static_cast<double>(k);
      double value = 0.1 * (output + 1);
      for (Index j = 0; j < inputs; ++j)
        value += std::sin((1 + 0.3 * static_cast<double>(j)) * x(i, j) + output) * (1 + 0.2 * x(i, 0));
      y(i, k) = 1e-3 * (output + 1) * value;
    }
  }
}

}  // namespace vernier::testing::detail
