// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/identification/detail/frame_sharing.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<GeometricUnknown> frame_of_sets(std::span<const MeasuredSet> sets, bool base, bool own_tools,
                                                         std::size_t last) {
  std::vector<GeometricUnknown> out;
  for (std::size_t s = 0; s < last; ++s) {
    const auto first = static_cast<int>(base ? first_of_place(sets, s) : first_of_point(sets, s, own_tools));
    const auto of_first = [&](const GeometricUnknown& u) { return u.station == first; };
    const auto known = std::find_if(out.begin(), out.end(), of_first);
    if (known == out.end())
      out.push_back({.parameter = 0, .station = static_cast<int>(s)});
    else
      known->shared_with.push_back(static_cast<int>(s));
  }
  const bool same = out.size() == 1 && last == sets.size();  // of all sets, objects without a tool apart
  if (same && (!base || sets.size() == 1)) out.front() = {.parameter = 0};
  return out;
}

}  // namespace vernier::detail
