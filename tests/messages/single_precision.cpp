// SPDX-License-Identifier: BSD-3-Clause
// Literals of half the digits; clang++ has no such option.
// expect: Vernier computes in double precision: compile without -fsingle-precision-constant
// flags: -fsingle-precision-constant
// compiler: g++
#ifdef MISTAKE
#include <vernier/core/literals.hpp>
#endif
