// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whether the mean of paired differences is above zero, without an assumption on their distribution but symmetry.

#include <cstdint>

#include "vernier/core/types.hpp"

namespace vernier {

/// One-sided sign-flip test: the probability that the mean of values symmetric about zero is at least as large as the
/// mean of these. All arrangements of signs are counted for up to 12 values, else a sample of them.
/// @param differences at least one, finite; independent of each other
/// @param draws       number of sampled arrangements
/// @param seed        of these
/// @return            p in (0, 1]; never below 1 / (draws + 1)
/// @throws std::invalid_argument without values, or for one that is not finite
/// @complexity O(draws n)
/// @cite Fisher 1935
VERNIER_API double sign_flip_test(const ConstVectorRef& differences, Index draws = 9999, std::uint64_t seed = 0);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/sign_flip_test.ipp"
#endif
