#pragma once

/// @file
/// Files that are either whole or not there: written beside, then renamed.

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace vernier {

/// Writes `content` to `path` through a neighbouring file and a rename, so that a failure leaves what was there before.
/// @throws std::runtime_error naming the file and the reason
inline void write_file(const std::filesystem::path& path, std::string_view content) {
  std::filesystem::path beside = path;
  beside += ".partial";
  const auto fail = [&](const char* what) {
    const int reason = errno;
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    throw std::runtime_error(path.string() + ": " + what +
                             (reason != 0 ? std::string(": ") + std::strerror(reason) : std::string()));
  };
  errno = 0;
  {
    std::ofstream out(beside, std::ios::binary | std::ios::trunc);
    if (!out) fail("cannot be written");
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.flush();
    if (!out) fail("could not be written whole");
  }
  std::error_code error;
  std::filesystem::rename(beside, path, error);
  if (error) {
    errno = error.value();
    fail("cannot be replaced");
  }
}

/// The whole of a file.
/// @throws std::invalid_argument naming the file and the reason
inline std::string read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw std::invalid_argument(path.string() + ": is a folder, not a file");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::invalid_argument(path.string() + ": " + (errno != 0 ? std::strerror(errno) : "cannot be opened"));
  std::string content{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad()) throw std::invalid_argument(path.string() + ": could not be read");
  return content;
}

}  // namespace vernier
