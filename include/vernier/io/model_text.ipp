// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/sha256.hpp"
#include "vernier/io/model_text.hpp"

namespace vernier {

VERNIER_IMPL SavedModel parse_model(const std::string& text, const std::string& name) {
  return detail::SavedModelParts::make(name, sha256(text), detail::parse_model(text, name));
}

}  // namespace vernier
