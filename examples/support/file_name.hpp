// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How results name the files that they are from.

#include <filesystem>
#include <string>
#include <system_error>

namespace support {

/// A file's name without its folder; of a pipe the whole path, whose last part (63 of /dev/fd/63) says nothing.
inline std::string file_name(const std::string& path) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  const bool file = kind == std::filesystem::file_type::regular || kind == std::filesystem::file_type::not_found;
  return file ? std::filesystem::path(path).filename().string() : path;
}

/// The name of a file with a number before its ending: "arm.json", 2 gives "arm.2.json".
inline std::string numbered(const std::filesystem::path& path, std::size_t number) {
  std::filesystem::path out = path;
  return out.replace_extension("." + std::to_string(number) + path.extension().string()).string();
}

}  // namespace support
