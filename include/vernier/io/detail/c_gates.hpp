#pragma once

/// @file
/// Gates of an exported arm in C, and what a network learned.

#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// `JointCoverage`, and the blend of two arms: `GatedModels`.
VERNIER_API std::string_view c_gate_code();
/// A network of one hidden layer: `NodeSum`.
VERNIER_API std::string_view c_learned_code();

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/c_gates.ipp"
#endif
