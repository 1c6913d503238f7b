// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which parameters of an arm an identification may estimate, and the expected sizes of their errors.

#include <string>
#include <vector>

#include "vernier/identification/options.hpp"

namespace vernier::detail {

/// The parameters of an arm by index, as `ArmGeometry` counts them.
struct IdentificationPlan {
  VERNIER_API IdentificationPlan(const ArmGeometry& nominal, const IdentifyOptions& options);

  Index chain_begin = ArmParameters::chain_begin, chain_end;
  std::vector<std::string> names;
  std::vector<ParameterKind> kinds;
  VectorX scales;                 ///< expected size of the error of each parameter [m, rad]
  std::vector<Index> candidates;  ///< to be estimated, frames first, so that the ends of the chain yield to them
  std::vector<Index> frames;      ///< the frame parameters among them

  bool in_chain(Index k) const { return k >= chain_begin && k < chain_end; }
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/identification_plan.ipp"
#endif
