// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/detail/steady_seconds.hpp"

#include <time.h>

namespace vernier::detail {

VERNIER_IMPL double steady_seconds() {
  struct timespec now {};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace vernier::detail
