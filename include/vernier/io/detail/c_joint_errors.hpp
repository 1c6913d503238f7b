#pragma once

/// @file
/// Errors of the joints of an exported arm in C: `JointErrors::evaluate` and `GravityTilt`.

#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// Each kind of terms, then all of them around a chain: `Framed<WithJointErrors>`.
VERNIER_API std::string_view c_joint_error_code();

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/c_joint_errors.ipp"
#endif
