// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// JSON files, written whole or not at all.

#include <filesystem>
#include <nlohmann/json.hpp>

namespace support {

using Json = nlohmann::ordered_json;  ///< keeps the order in which members were added

/// Writes a document with two spaces a level. A number that is not finite becomes null.
/// @throws std::runtime_error naming the file and the reason
void write_json(const std::filesystem::path& path, const Json& document);

}  // namespace support
