// SPDX-License-Identifier: BSD-3-Clause
// An older language than the headers need.
// expect: #error "Vernier needs C++20: compile with -std=c++20"
// flags: -std=c++17
#ifdef MISTAKE
#include <vernier/vernier.hpp>
#endif
