// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/sha256.hpp"
#include "vernier/io/model_file.hpp"

namespace vernier {

VERNIER_IMPL SavedModel read_model(const std::string& path) {
  const std::string content = detail::read_json_text(path);
  return detail::SavedModelParts::make(path, sha256(content), detail::parse_model(content, path));
}

VERNIER_IMPL SavedModel SavedModel::carrying(const Payload& payload) const {
  SavedModel out = *this;
  const auto load = [&](FittedArm& arm) {
    arm.errors = arm.errors.carrying(payload.at(translation(arm.geometry.tool().isometry())));
  };
  load(out.data_.identified);
  if (out.data_.fallback) load(*out.data_.fallback);
  return out;
}

}  // namespace vernier
