#pragma once

#include <cstdio>

#include "vernier/calibration/stage_errors.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace vernier {

VERNIER_IMPL std::string stage_table(const std::vector<StageErrors>& stages) {
  const bool oriented = !stages.empty() && stages.front().rotation.size() > 0;
  std::string out = "stage                      mean      rms      max      min      p95";
  out += oriented ? "  mean [mrad]\n" : "\n";
  char line[160];
  for (const StageErrors& stage : stages) {
    const auto e = ErrorStatistics::of(stage.position * 1e3);
    std::snprintf(line, sizeof line, "%-22s%9.4f%9.4f%9.4f%9.4f%9.4f", stage.title.c_str(), e.mean, e.rms, e.max, e.min,
                  e.p95);
    out += line;
    if (stage.rotation.size() > 0) {
      std::snprintf(line, sizeof line, "%13.4f", stage.rotation.mean() * 1e3);
      out += line;
    }
    out += "\n";
  }
  return out;
}

}  // namespace vernier
