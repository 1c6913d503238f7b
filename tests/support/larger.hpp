// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The worst of many errors.

#include <cmath>

namespace vernier_test {

/// The larger of two values; NaN where one is, which no tolerance admits. (std::max drops it.)
inline double larger(double a, double b) { return a > b || std::isnan(a) ? a : b; }

}  // namespace vernier_test
