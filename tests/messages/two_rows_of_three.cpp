// SPDX-License-Identifier: BSD-3-Clause
// Two rows of an arm of three joints.
// expect: the number of rows is not the number of joints
#include <vernier/core/literals.hpp>
#include <vernier/kinematics/dh_chain.hpp>

using namespace vernier::literals;

const vernier::DhChain<3> arm{{{
    {.a = 300_mm},
    {.a = 200_mm},
#ifndef MISTAKE
    {.a = 100_mm},
#endif
}}};
