// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where a path leads: symbolic links, and the open files of this process.

#include <string>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// Where a path leads.
struct Destination {
  std::string file;     ///< what it names after all symbolic links
  int descriptor = -1;  ///< the open file of this process that it names (/dev/stdout, /dev/fd/63); -1: none
};

/// Follows the symbolic links of a path, also where they lead to a file that is not there.
VERNIER_API Destination destination_of(const std::string& path);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/core/detail/destination.ipp"
#endif
