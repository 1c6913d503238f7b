// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Words of reports.

#include <string>
#include <vector>

#include "vernier/core/api.hpp"

#include "vernier/core/language.hpp"

namespace vernier::detail {

/// Texts joined by commas.
VERNIER_API inline std::string comma_list(const std::vector<std::string>& texts) {
  std::string out;
  for (const auto& text : texts) out += (out.empty() ? "" : ", ") + text;
  return out;
}

}  // namespace vernier::detail
