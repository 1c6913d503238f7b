// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The language and the build settings that every header needs, checked before the first line that would fail or
/// compute something else without them. Settings that change the last bits of results alone are left to the user. Those
/// of Eigen that change its types are checked in core/api.hpp.

/// @cond

// Each refusal includes a file that does not exist: this ends the compilation, else thousands of lines would follow the
// sentence.
#if __cplusplus <= 201703L
#error "Vernier needs C++20: compile with -std=c++20"
#include <C++20>
#elif defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "Vernier marks what is unknown by NaN: compile without -ffast-math, -Ofast and -ffinite-math-only"
#include <NaN>
#elif !defined(__cpp_exceptions)
#error "Vernier throws exceptions where it is misused: compile without -fno-exceptions"
#include <exceptions>
#endif

static_assert(sizeof(1.0) == 8, "Vernier computes in double precision: compile without -fsingle-precision-constant");

/// @endcond
