#pragma once

#include "vernier/core/atomic_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace vernier {

VERNIER_IMPL void write_file(const std::string& path, std::string_view content) {
  const std::string beside = path + ".partial";
  const auto fail = [&](const char* what) {
    const int reason = errno;
    std::remove(beside.c_str());
    throw std::runtime_error(path + ": " + what +
                             (reason != 0 ? std::string(": ") + std::strerror(reason) : std::string()));
  };
  errno = 0;
  std::FILE* out = std::fopen(beside.c_str(), "wb");
  if (out == nullptr) fail("cannot be written");
  const bool written = std::fwrite(content.data(), 1, content.size(), out) == content.size();
  const int reason = errno;
  const bool closed = std::fclose(out) == 0;  // writes what is buffered
  if (!written) errno = reason;
  if (!written || !closed) fail("could not be written whole");
  if (std::rename(beside.c_str(), path.c_str()) != 0) fail("cannot be replaced");
}

VERNIER_IMPL std::string read_file(const std::string& path, std::size_t most) {
  const auto fail = [&](const char* what) {
    throw std::invalid_argument(path + ": " + (what != nullptr ? what : std::strerror(errno)));
  };
  errno = 0;
  std::FILE* in = std::fopen(path.c_str(), "rb");
  if (in == nullptr) fail(errno != 0 ? nullptr : "cannot be opened");
  std::string content;
  char buffer[1 << 14];
  for (std::size_t n; content.size() <= most && (n = std::fread(buffer, 1, sizeof buffer, in)) > 0;)
    content.append(buffer, n);
  const bool failed = std::ferror(in) != 0, folder = errno == EISDIR;
  std::fclose(in);
  if (failed) fail(folder ? "is a folder, not a file" : "could not be read");
  if (content.size() > most) fail(("has more than " + std::to_string(most >> 20) + " MiB").c_str());
  return content;
}

}  // namespace vernier
