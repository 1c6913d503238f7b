#pragma once

/// @file
/// Vectors, rotations and the chain of an exported arm in C.

#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// Vectors and rotations.
VERNIER_API std::string_view c_vector_code();
/// The chain at joint values.
VERNIER_API std::string_view c_chain_code();

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/c_chain.ipp"
#endif
