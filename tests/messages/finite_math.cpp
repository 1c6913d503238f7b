// SPDX-License-Identifier: BSD-3-Clause
// NaN alone is missing from the arithmetic.
// expect: #error "Vernier marks what is unknown by NaN: compile without -ffast-math, -Ofast and -ffinite-math-only"
// flags: -O2 -ffinite-math-only
#ifdef MISTAKE
#include <vernier/core/simd.hpp>
#endif
