// SPDX-License-Identifier: BSD-3-Clause
// A length without its unit: 400 m.
// expect: length_above_100_m_is_the_unit_right
#include <vernier/core/literals.hpp>
#include <vernier/kinematics/dh_chain.hpp>

using namespace vernier::literals;

#ifdef MISTAKE
constexpr vernier::DhChain<2> arm{{{{.a = 400}, {.a = 200_mm}}}};
#else
constexpr vernier::DhChain<2> arm{{{{.a = 400_mm}, {.a = 200_mm}}}};
#endif
