#pragma once

/// @file
/// The functions of an exported arm that are called from outside.

#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// Pose, Jacobian and gate of the arm with everything.
VERNIER_API std::string_view c_arm_code();
/// Correction: `damped_least_squares`.
VERNIER_API std::string_view c_correction_code();

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/c_correction.ipp"
#endif
