// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Files written whole or left as they were, and files read whole.

#include <cstddef>
#include <string>
#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier {

/// How `write_file` writes to a path.
enum class Writing {
  replaced,  ///< a regular file or a new one: written beside and renamed, so that it is whole, or as it was before
  in_place,  ///< a regular file that no other one may replace: mounted alone, of another owner, or in a folder that
             ///< takes no new file. A full disk leaves what was there; a crash, or another reader, may meet a part
  through    ///< a device, a pipe, or a stream of this process such as /dev/stdout, whose earlier content stays
};

/// How `path` is going to be written. Symbolic links are followed. Nothing is written, and no pipe is opened.
/// @throws std::runtime_error naming the file and the reason why it cannot be written
VERNIER_API Writing writing_of(const std::string& path);

/// Writes `content` to `path` as `writing_of` says. A file that is replaced keeps its owner, group and mode; its other
/// names (hard links) keep the content of before. The neighbouring file is always a new one, so processes that write to
/// one path at a time do not disturb each other.
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
