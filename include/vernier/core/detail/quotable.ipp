// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/detail/quotable.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string quotable(std::string_view text, std::size_t limit) {
  std::string out;
  for (const char c : text.substr(0, limit)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > limit ? "..." : "");
}

}  // namespace vernier::detail
