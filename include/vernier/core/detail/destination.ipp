#pragma once

#include "vernier/core/detail/destination.hpp"

#include <charconv>
#include <filesystem>
#include <system_error>

namespace vernier::detail {

/// The number that a name in the folder of this process's open files is; -1 for all others.
VERNIER_LOCAL int descriptor_named(const std::filesystem::path& folder, const std::string& name) {
  namespace fs = std::filesystem;
  int number = -1;
  const auto [end, failure] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (failure != std::errc() || end != name.data() + name.size()) return -1;
  std::error_code error;
  const fs::path there = fs::canonical(folder, error);
  if (error) return -1;
  for (const char* open_files : {"/dev/fd", "/proc/self/fd"})
    if (there == fs::canonical(open_files, error) && !error) return number;
  return -1;
}

VERNIER_IMPL Destination destination_of(const std::string& path) {
  namespace fs = std::filesystem;
  fs::path at = path;
  constexpr int most_links = 40;  // as the system has it, which refuses longer chains and circles
  for (int links = 0; links < most_links; ++links) {
    const fs::path folder = at.has_parent_path() ? at.parent_path() : ".";
    // before the link is read: what a descriptor is open for may have another name by now, or none
    if (const int number = descriptor_named(folder, at.filename().string()); number >= 0) return {at.string(), number};
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(at, error))) break;
    const fs::path next = fs::read_symlink(at, error);
    if (error) break;
    at = next.is_absolute() ? next : folder / next;
  }
  return {at.string()};
}

}  // namespace vernier::detail
