// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/detail/number_text.hpp"
#include "vernier/identification/contact_report.hpp"
#include "vernier/identification/detail/wording.hpp"

namespace vernier {

VERNIER_IMPL std::vector<std::string> ContactReport::unobserved() const {
  std::vector<std::string> out{
      "the base frame (6 directions): contacts are relative to the arm; base_x .. base_rz stay nominal"};
  if (!scale_observable)
    out.push_back(
        "the scale of the arm (1 direction): no contact has a known length; the lengths of its links, taken together, "
        "stay " +
        (prior.empty() ? std::string("nominal") : "as " + prior + " has them"));
  std::string rotations;
  for (const auto& p : parameters)
    if (p.state == ParameterState::not_identifiable && !p.name.starts_with("base_")) {
      if (p.name.starts_with("tool_r"))
        rotations += (rotations.empty() ? "" : ", ") + p.name;
      else
        out.push_back(p.name + " (1 direction): " + p.remark);
    }
  if (!rotations.empty()) out.push_back("the orientation of the tool: " + rotations + " have no effect on touches");
  return out;
}

VERNIER_IMPL std::string ContactReport::summary() const {
  using detail::comma_list;
  using detail::fixed_digits;
  std::string out = (converged()                                 ? "Converged: "
                     : status == IdentifyStatus::underdetermined ? "UNDERDETERMINED: "
                                                                 : "NOT CONVERGED: ") +
                    message + "\n";
  out += "Touches miss what they touch by (rms): " + fixed_digits(rms_before * 1e3, 4) + " mm with " +
         (prior.empty() ? "nominal links, " : "the links of " + prior + ", ") + fixed_digits(rms_after * 1e3, 4) +
         " mm identified.\n";
  for (const TouchedObject& o : objects)
    out += "  " + o.name + ": " + name_of(o.kind) + ", " + std::to_string(o.touches) + " touches, " +
           fixed_digits(o.rms * 1e3, 4) + " mm\n";
  out += "Parameters estimated: " + std::to_string(free.size()) + ", condition " +
         (std::isfinite(condition) ? fixed_digits(condition, 0) : std::string("infinite")) + ".\n";
  if (!prior.empty())
    out += "Prior: " + prior + ". By evidence the geometry has changed since by " + fixed_digits(prior_change, 2) +
           " of the expected sizes of its errors.\n";
  constexpr std::size_t most = 5;
  for (std::size_t k = 0; k < suspects.size() && k < most; ++k)
    out += "Suspect touch: " + suspects[k].where + " (" + suspects[k].contact + "), " +
           fixed_digits(suspects[k].error * 1e3, 3) + " mm off, " + fixed_digits(suspects[k].factor, 1) +
           " times the usual.\n";
  if (suspects.size() > most) out += "And " + std::to_string(suspects.size() - most) + " more suspect touches.\n";
  if (object_sigma > 0) {
    out += "Standard deviations include errors that touches share: " + fixed_digits(object_sigma * 1e3, 3) +
           " mm of each object";
    if (joint_sigma > 0) out += ", and " + fixed_digits(joint_sigma * 1e3, 3) + " mrad of each joint once a turn";
    out += ".\n";
  }
  if (const auto weak = names(ParameterState::weak); !weak.empty())
    out += "Weakly determined, held near " + (prior.empty() ? std::string("nominal") : "those of " + prior) +
           " by their priors: " + comma_list(weak) + ".\n";
  out += "Contacts do not observe (" + std::to_string(unobservable) + " of " + std::to_string(singular_values.size()) +
         " directions):\n";
  for (const std::string& sentence : unobserved()) out += "  - " + sentence + ".\n";
  return out;
}

}  // namespace vernier
