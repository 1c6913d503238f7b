// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Arms in model files: rows of the chain, frames, joint errors, measured joint ranges.

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/error_model/error_model.hpp"
#include "vernier/identification/fitted_arm.hpp"
#include "vernier/io/json.hpp"

namespace vernier::detail {

using OrderedJson = nlohmann::ordered_json;

/// The measured ranges of some joints, and the margins.
struct CoverageData {
  std::vector<std::vector<JointRange>> ranges;
  VectorX margins;
  std::vector<bool> periodic;
  MotorAngles motors{};

  CoverageData() = default;
  template <int N>
  explicit CoverageData(const JointCoverage<N>& coverage)
      : ranges(coverage.ranges.begin(), coverage.ranges.end()),
        margins(coverage.margin),
        periodic(coverage.periodic.begin(), coverage.periodic.end()),
        motors(coverage.motors) {}
  template <int N>
  JointCoverage<N> typed() const {
    JointCoverage<N> out;
    std::copy(ranges.begin(), ranges.end(), out.ranges.begin());
    out.margin = margins;
    std::copy(periodic.begin(), periodic.end(), out.periodic.begin());
    out.motors = motors;
    return out;
  }
};

/// The position of a name in a list, for the enums that are stored by name.
template <std::size_t K>
int named(const JsonNode& node, const std::array<std::string_view, K>& names) {
  const std::string name = node.text();
  for (std::size_t i = 0; i < K; ++i)
    if (names[i] == name) return static_cast<int>(i);
  node.fail("'" + quotable(name) + "' is unknown");
}

/// Numbers as a list.
/// @throws std::invalid_argument on a value that is not finite
VERNIER_API OrderedJson list_of(const ConstVectorRef& values);

VERNIER_API OrderedJson row_to_json(const DhRow& row);
VERNIER_API DhRow row_from_json(const JsonNode& node, JointType type);

VERNIER_API OrderedJson coverage_to_json(const CoverageData& coverage);
VERNIER_API CoverageData coverage_from_json(const JsonNode& node, int joints);

/// An identified arm with its joint errors.
VERNIER_API OrderedJson arm_to_json(const FittedArm& arm);
/// @param nominal the chain whose torques gravity compliance needs, and whose frames tilt
VERNIER_API FittedArm arm_from_json(const ChainTable& nominal, const JsonNode& node);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/arm_json.ipp"
#endif
