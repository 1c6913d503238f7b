#pragma once

/// @file
/// From a number of joints known at run time to one known at compile time.

#include <type_traits>

#include "vernier/core/check.hpp"

namespace support {

/// Calls `f` with the number of joints as a `std::integral_constant<int, N>`, N = 3 to 9. All calls must give the same
/// type.
/// @throws std::invalid_argument for any other number
template <class F>
decltype(auto) dispatch_dof(int n, F&& f) {
  switch (n) {
    case 3: return f(std::integral_constant<int, 3>{});
    case 4: return f(std::integral_constant<int, 4>{});
    case 5: return f(std::integral_constant<int, 5>{});
    case 6: return f(std::integral_constant<int, 6>{});
    case 7: return f(std::integral_constant<int, 7>{});
    case 8: return f(std::integral_constant<int, 8>{});
    case 9: return f(std::integral_constant<int, 9>{});
    default: break;
  }
  throw std::invalid_argument(vernier::message("arms of 3 to 9 joints are supported, this one has ", n));
}

}  // namespace support
