// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Learned position errors in model files.

#include <variant>

#include "vernier/io/calibrated_robot.hpp"
#include "vernier/io/detail/arm_json.hpp"

namespace vernier::detail {

/// A learned position error.
struct LearnedData {
  std::variant<FittedNetwork, FittedKernels> function;
  CoverageData coverage;
};

VERNIER_API OrderedJson learned_to_json(const LearnedData& learned);
VERNIER_API LearnedData learned_from_json(const JsonNode& node, int joints);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/learned_json.ipp"
#endif
