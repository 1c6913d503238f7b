#pragma once

/// @file
/// Files written atomically: whole, or as they were before.

#include <cstddef>
#include <string>
#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier {

/// Writes `content` to `path` through a neighbouring file and a rename, so that a failure leaves what was there before.
/// @throws std::runtime_error naming the file and the reason
VERNIER_API void write_file(const std::string& path, std::string_view content);

/// The whole of a file.
/// @param path the file
/// @param most bytes that it may have: what else is read, such as a device without end, would fill the memory
/// @throws std::invalid_argument naming the file and the reason
VERNIER_API std::string read_file(const std::string& path, std::size_t most = std::size_t{1} << 30);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/atomic_file.ipp"
#endif
