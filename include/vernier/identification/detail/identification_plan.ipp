// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>

#include "vernier/identification/detail/identification_plan.hpp"

namespace vernier::detail {

VERNIER_IMPL IdentificationPlan::IdentificationPlan(const ArmGeometry& nominal, const IdentifyOptions& options)
    : chain_end(ArmParameters::chain_end(nominal.joints())),
      names(nominal.parameter_names()),
      kinds(nominal.parameter_kinds()),
      scales(nominal.num_parameters()) {
  options.validate(names);
  std::vector<bool> free(names.size());
  for (Index k = 0; k < scales.size(); ++k) {
    const bool length = kinds[static_cast<std::size_t>(k)] == ParameterKind::length;
    const auto parameter = static_cast<DhParameter>((k - chain_begin) % 5);
    if (in_chain(k)) {
      scales(k) = length                            ? options.length_prior_std
                  : parameter == DhParameter::theta ? options.joint_zero_prior_std
                                                    : options.angle_prior_std;
      free[static_cast<std::size_t>(k)] = options.geometry && parameter != DhParameter::beta;
    } else {
      scales(k) = 10e-3;
      free[static_cast<std::size_t>(k)] = k < chain_begin ? options.base_free() : options.tool_free();
    }
  }
  if (options.hayati && options.geometry)
    for (const int row : parallel_rows(nominal.chain())) {
      free[static_cast<std::size_t>(ArmParameters::of_row(row, DhParameter::beta))] = true;
      free[static_cast<std::size_t>(ArmParameters::of_row(row, DhParameter::d))] = false;
    }
  for (const auto& name : options.fixed)
    free[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())] = false;
  for (const auto& [begin, end] :
       {std::pair{Index{0}, chain_begin}, {chain_end, scales.size()}, {chain_begin, chain_end}})
    for (Index k = begin; k < end; ++k) {
      if (!free[static_cast<std::size_t>(k)]) continue;
      candidates.push_back(k);
      if (!in_chain(k)) frames.push_back(k);
    }
}

}  // namespace vernier::detail
