// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/detail/destination.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <charconv>
#include <string_view>

namespace vernier::detail {

/// A path without symbolic links; empty where it leads nowhere.
VERNIER_LOCAL std::string without_links(const std::string& path) {
  char* const found = ::realpath(path.c_str(), nullptr);
  std::string out = found != nullptr ? found : "";
  ::free(found);
  return out;
}

/// The number that a name in the folder of this process's open files is; -1 for all others.
/// @param folder ends in a slash, or is empty
VERNIER_LOCAL int descriptor_named(const std::string& folder, std::string_view name) {
  int number = -1;
  const auto [end, failure] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (failure != std::errc() || end != name.data() + name.size()) return -1;
  const std::string there = without_links(folder.empty() ? "." : folder);
  if (there.empty()) return -1;
  for (const char* open_files : {"/dev/fd", "/proc/self/fd"})
    if (there == without_links(open_files)) return number;
  return -1;
}

VERNIER_IMPL Destination destination_of(const std::string& path) {
  std::string at = path;
  constexpr int most_links = 40;  // as the system has it, which refuses longer chains and circles
  for (int links = 0; links < most_links; ++links) {
    const std::size_t behind = at.rfind('/') + 1;  // 0 without a slash
    const std::string folder = at.substr(0, behind);
    // before the link is read: what a descriptor is open for may have another name by now, or none
    if (const int number = descriptor_named(folder, std::string_view(at).substr(behind)); number >= 0)
      return {at, number};
    char link[1 << 12];
    const auto length = ::readlink(at.c_str(), link, sizeof link);
    if (length <= 0 || static_cast<std::size_t>(length) == sizeof link) break;  // no link, or a longer path than any
    const std::string_view next(link, static_cast<std::size_t>(length));
    at = next.front() == '/' ? std::string(next) : folder + std::string(next);
  }
  return {at};
}

}  // namespace vernier::detail
