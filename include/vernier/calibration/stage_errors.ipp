// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/calibration/stage_errors.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace vernier {

VERNIER_IMPL std::string stage_table(const std::vector<StageErrors>& stages) {
  const bool oriented = !stages.empty() && stages.front().rotation.size() > 0;
  std::string out = "stage                      mean      rms      max      min      p95";
  out += oriented ? "  mean [mrad]\n" : "\n";
  const auto add = [&](double value, std::size_t width) {
    const std::string text = detail::three_digits(value);
    out += std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
  };
  for (const StageErrors& stage : stages) {
    const auto e = ErrorStatistics::of(VERNIER_LATER(stage.position) * 1e3);
    out += stage.title + std::string(stage.title.size() < 22 ? 22 - stage.title.size() : 0, ' ');
    for (const double value : {e.mean, e.rms, e.max, e.min, e.p95}) add(value, 9);
    if (stage.rotation.size() > 0) add(VERNIER_LATER(stage.rotation).mean() * 1e3, 13);
    out += "\n";
  }
  return out;
}

}  // namespace vernier
