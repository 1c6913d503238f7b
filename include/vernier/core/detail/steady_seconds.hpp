// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Time that passes, without `<chrono>`, which takes longer to compile than many headers of ours.

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// Seconds on a monotonic clock, from a start of its own.
VERNIER_API double steady_seconds();

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/core/detail/steady_seconds.ipp"
#endif
