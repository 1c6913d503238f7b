#pragma once

#include "vernier/calibration/stage_errors.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace vernier {

VERNIER_IMPL std::string stage_table(const std::vector<StageErrors>& stages) {
  const bool oriented = !stages.empty() && stages.front().rotation.size() > 0;
  std::string out = "stage                      mean      rms      max      min      p95";
  out += oriented ? "  mean [mrad]\n" : "\n";
  for (const StageErrors& stage : stages) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    out += detail::at_left(stage.title, 22);
    for (const double mm : {e.mean, e.rms, e.max, e.min, e.p95})
      out += detail::at_right(detail::fixed_digits(mm, 4), 9);
    if (stage.rotation.size() > 0) out += detail::at_right(detail::fixed_digits(stage.rotation.mean() * 1e3, 4), 13);
    out += "\n";
  }
  return out;
}

}  // namespace vernier
