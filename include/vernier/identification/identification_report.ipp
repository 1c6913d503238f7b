// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/detail/number_text.hpp"
#include "vernier/identification/detail/wording.hpp"
#include "vernier/identification/identification_report.hpp"

namespace vernier {

VERNIER_IMPL std::vector<std::string> IdentificationReport::names(ParameterState state) const {
  std::vector<std::string> out;
  for (const auto& p : parameters)
    if (p.state == state) out.push_back(p.name);
  return out;
}

VERNIER_IMPL std::vector<std::string> IdentificationReport::strongly_correlated(double limit) const {
  std::vector<std::string> out;
  for (const Correlation& c : strong_correlations(covariance, limit)) {
    const auto name = [&](Index k) {
      return parameters[static_cast<std::size_t>(free[static_cast<std::size_t>(k)])].name;
    };
    out.push_back(name(c.first) + " and " + name(c.second) + " (" + detail::signed_digits(c.value, 2) + ")");
  }
  return out;
}

VERNIER_IMPL std::string IdentificationReport::summary() const {
  using detail::comma_list;
  using detail::fixed_digits;
  std::string out = (converged()                                 ? "Converged: "
                     : status == IdentifyStatus::underdetermined ? "UNDERDETERMINED: "
                                                                 : "NOT CONVERGED: ") +
                    message + "\n";
  out += "Position error (rms): " + fixed_digits(rms_before * 1e3, 4) +
         " mm with registered frames and nominal links, " + fixed_digits(rms_after * 1e3, 4) + " mm identified.\n";
  if (rotation_rms_after > 0)
    out += "Orientation error (rms): " + fixed_digits(rotation_rms_after * 1e3, 3) + " mrad identified.\n";
  out += "Parameters estimated: " + std::to_string(free.size()) + ", rank " + std::to_string(rank) + ", condition " +
         (std::isfinite(condition) ? fixed_digits(condition, 0) : std::string("infinite")) + ".\n";
  std::vector<std::string> freed, held;  // beta is estimated only where it takes the place of d
  for (const auto& p : parameters)
    if (p.name.starts_with("beta") && p.state != ParameterState::fixed) {
      freed.push_back(p.name);
      held.push_back("d" + p.name.substr(4));
    }
  if (!freed.empty())
    out += "Consecutive axes nearly parallel: " + comma_list(freed) + " (Hayati) estimated in place of " +
           comma_list(held) + ".\n";
  if (links_as_designed) out += "The links stay as designed: others do not predict left-out poses better.\n";
  if (const auto weak = names(ParameterState::weak); !weak.empty())
    out += "Weakly determined, regularised by priors around nominal: " + comma_list(weak) + ".\n";
  if (const auto pairs = strongly_correlated(); !pairs.empty()) {
    out += "Strongly correlated: ";
    for (std::size_t k = 0; k < pairs.size() && k < 4; ++k) out += (k > 0 ? ", " : "") + pairs[k];
    out += pairs.size() > 4 ? ", and " + std::to_string(pairs.size() - 4) + " more pairs.\n" : ".\n";
  }
  for (const auto& p : parameters)
    if (p.state == ParameterState::not_identifiable) out += "Not identifiable: " + p.name + ", " + p.remark + ".\n";
  return out;
}

}  // namespace vernier
