// SPDX-License-Identifier: BSD-3-Clause
// Arithmetic in which NaN does not exist.
// expect: #error "Vernier marks what is unknown by NaN: compile without -ffast-math, -Ofast and -ffinite-math-only"
// flags: -ffast-math
#ifdef MISTAKE
#include <vernier/core/literals.hpp>
#endif
