// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// SHA-256, by which a report names the files that it was made from.

#include <string>
#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier {

/// The SHA-256 digest of some bytes as 64 lower-case hexadecimal digits, as `sha256sum` prints it.
/// @complexity O(n)
/// @cite FIPS 180-4
VERNIER_API std::string sha256(std::string_view bytes);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/sha256.ipp"
#endif
