// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Comparison of numbers without a tolerance.

#include "vernier/core/language.hpp"

namespace vernier {

/// Whether two numbers are equal to the last bit, on purpose: as `==`, which -Wfloat-equal takes for an oversight. 0
/// and -0 are the same; NaN is the same as nothing.
constexpr bool same_value(double a, double b) noexcept { return a <= b && b <= a; }

}  // namespace vernier
