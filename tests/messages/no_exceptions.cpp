// SPDX-License-Identifier: BSD-3-Clause
// Misuse could not be reported.
// expect: #error "Vernier throws exceptions where it is misused: compile without -fno-exceptions"
// flags: -fno-exceptions
#ifdef MISTAKE
#include <vernier/kinematics/dh_chain.hpp>
#endif
