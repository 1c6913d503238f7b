// SPDX-License-Identifier: BSD-3-Clause
// Members of a row in another order than that of their declaration: an error of g++, a warning of clang++.
// expect: declaration order
#include <vernier/core/literals.hpp>
#include <vernier/kinematics/dh_chain.hpp>

using namespace vernier::literals;

#ifdef MISTAKE
const vernier::DhChain<2> arm{{{{.alpha = 90_deg, .a = 300_mm}, {.a = 200_mm}}}};
#else
const vernier::DhChain<2> arm{{{{.a = 300_mm, .alpha = 90_deg}, {.a = 200_mm}}}};
#endif
