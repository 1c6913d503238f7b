// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What every fuzz target does: bytes become a file, a reader takes it or refuses it with one clear line.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>

#include "vernier/core/data_error.hpp"

namespace vernier::fuzz {

/// Bytes as a file in memory, under a path that readers can open.
class InputFile {
 public:
  InputFile(const std::uint8_t* data, std::size_t size) : file_(memfd_create("input", MFD_CLOEXEC)) {
    if (file_ < 0) std::abort();
    for (std::size_t done = 0; done < size;) {
      const ssize_t n = ::write(file_, data + done, size - done);
      if (n <= 0) std::abort();
      done += static_cast<std::size_t>(n);
    }
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() { ::close(file_); }

  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

inline std::string complaint;  ///< the last one, of a file that was refused

/// Ends the process, as a finding.
[[noreturn]] inline void finding(const char* what, const std::string& said) {
  std::fprintf(stderr, "%s: %s\n", what, said.c_str());
  std::abort();
}

/// Holds a complaint to what users are promised: one line of printable text, not too long.
inline void check_complaint(const std::string& said) {
  complaint = said;
  if (said.empty() || said.size() > 1000) finding("a complaint of no or too many words", said);
  for (const char c : said)
    if (c < ' ' || c > '~') finding("a complaint that is not one printable line", said);
}

/// Gives the bytes to a reader. It may refuse them with DataError, or one of Refused; anything else it throws is a
/// finding.
/// @param read takes the path of a file
template <class... Refused, class Read>
int read_as_file(const std::uint8_t* data, std::size_t size, const Read& read) {
  const InputFile file(data, size);
  try {
    read(file.path());
  } catch (const std::exception& error) {
    if (dynamic_cast<const DataError*>(&error) == nullptr && (... && (dynamic_cast<const Refused*>(&error) == nullptr)))
      throw;
    check_complaint(error.what());
  }
  return 0;
}

}  // namespace vernier::fuzz
