// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Text of users in messages.

#include <cstddef>
#include <string>
#include <string_view>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// Text from a file or command line, for a message: short, printable, on one line.
VERNIER_API std::string quotable(std::string_view text, std::size_t limit = 60);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/core/detail/quotable.ipp"
#endif
