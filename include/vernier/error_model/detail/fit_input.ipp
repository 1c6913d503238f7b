#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/error_model/detail/fit_input.hpp"
#include "vernier/identification/detail/contact_frames.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier::detail {

VERNIER_IMPL void ErrorModelInput::place() {
  arms.clear();
  for (MeasuredSet& set : sets) {
    demand(set.size() >= 1, "fit_error_model: ", set.name, " has no measurements");
    arms.push_back(sets.size() == 1 ? identified : placed(identified, set));
    require_spread(arms.back(), set);
  }
}

VERNIER_IMPL std::vector<GeometricUnknown> geometric_unknowns(const ErrorModelInput& input,
                                                              const ErrorModelOptions& options) {
  const std::size_t stations = input.sets.size();
  std::size_t locating = 0;
  while (locating < stations && input.sets[locating].locates()) ++locating;
  const Index chain_end = ArmParameters::chain_end(input.identified.joints());
  std::vector<GeometricUnknown> out;
  for (const Index k : input.identification.free) {
    const ParameterEstimate& p = input.identification.parameters[static_cast<std::size_t>(k)];
    const bool of_chain = k >= ArmParameters::chain_begin && k < chain_end;
    // thirty expected sizes do not affect what is determined
    const double deviation = std::isfinite(p.prior_std) ? p.prior_std / p.scale : 30;
    const double precision = of_chain ? 1 / (deviation * deviation) : 0;
    const bool own = stations > 1 && (k < 6 || (options.tool_per_station && k >= chain_end));  // a base, or a tool
    if (!own) {
      out.push_back({k, -1, p.scale, precision});
      continue;
    }
    const auto last = k < 6 ? locating : stations;
    for (std::size_t s = 0; s < last; ++s) out.push_back({k, static_cast<int>(s), p.scale, precision});
  }
  for (std::size_t s = locating; s < stations && stations > 1; ++s)  // frames of objects and fixed points
    for (const Index k : frame_unknowns(input.sets[s]))
      out.push_back({k, static_cast<int>(s), input.identification.parameters[static_cast<std::size_t>(k)].scale, 0});
  return out;
}

}  // namespace vernier::detail
