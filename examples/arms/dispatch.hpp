// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// From a number of joints known at run time to one known at compile time.

#include <type_traits>

#include "arm_joints.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

/// Expands `macro(N)` for every number of joints that this build serves (VERNIER_ARM_JOINTS of CMake): 1 to 9 unless
/// told otherwise.
#define VERNIER_FOR_ALL_DOF(macro) VERNIER_ARM_JOINTS(macro)
static_assert(vernier::max_arm_joints == 9);

namespace support {

/// Calls `f` with the number of joints as a `std::integral_constant<int, N>`. All calls must give the same type.
/// @throws std::invalid_argument for a number that this build does not serve
template <class F>
decltype(auto) dispatch_dof(int n, F&& f) {
#define VERNIER_CASE(N) \
  case N: return f(std::integral_constant<int, N>{});
  switch (n) {
    VERNIER_FOR_ALL_DOF(VERNIER_CASE)
    default: break;
  }
#undef VERNIER_CASE
#define VERNIER_NUMBER(N) " " #N
  throw std::invalid_argument(vernier::message(
      "the arm has ", n, " joints; this program was built for arms of these:", VERNIER_FOR_ALL_DOF(VERNIER_NUMBER)));
#undef VERNIER_NUMBER
}

}  // namespace support
