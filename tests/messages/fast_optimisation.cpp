// SPDX-License-Identifier: BSD-3-Clause
// An optimisation level that includes -ffast-math.
// expect: #error "Vernier marks what is unknown by NaN: compile without -ffast-math, -Ofast and -ffinite-math-only"
// flags: -Ofast -Wno-error
#ifdef MISTAKE
#include <vernier/data/csv.hpp>
#endif
