// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/error_model/error_model_options.hpp"

namespace vernier {

VERNIER_IMPL std::optional<std::vector<double>> ErrorModelOptions::parameters(JointTermBlock::Kind kind,
                                                                              const Vector3& gravity) const {
  using Kind = JointTermBlock::Kind;
  const auto if_allowed = [](bool allowed, std::vector<double> values) {
    return allowed ? std::optional(std::move(values)) : std::nullopt;
  };
  const std::vector<double> direction(gravity.begin(), gravity.end());
  switch (kind) {
    case Kind::gear_ratio: return if_allowed(gear_ratio, {});
    case Kind::coupling: return if_allowed(coupling, {});
    case Kind::gravity: return if_allowed(compliance, direction);
    case Kind::hysteresis: return if_allowed(hysteresis, {0.01, 0.3});
    case Kind::tilt: return if_allowed(tilt, direction);
    case Kind::payload:
    case Kind::bend:
    case Kind::straightness:
    case Kind::transmission: break;
  }
  return std::nullopt;
}

VERNIER_IMPL double ErrorModelOptions::expected_size(const JointTerms& terms, const JointTermBlock& block,
                                                     Index coefficient) const {
  using Kind = JointTermBlock::Kind;
  switch (block.kind) {
    case Kind::gear_ratio: return gear_ratio_prior_std;
    case Kind::coupling: return coupling_prior_std;
    case Kind::gravity: return compliance_prior_std;
    case Kind::hysteresis: return hysteresis_prior_std;
    case Kind::payload:
    case Kind::bend: return payload_prior_std;
    case Kind::tilt: return tilt_prior_std;
    case Kind::straightness: {
      const auto order = static_cast<double>(coefficient % terms.straightness->orders() + 1);
      return straightness_prior_std / (order * order);
    }
    case Kind::transmission: break;
  }
  demand(false, "ErrorModelOptions: functions of single joints have expected sizes by their spectrum");
  return 0;
}

VERNIER_IMPL void ErrorModelOptions::validate() const {
  for (const auto& [name, value] : {std::pair{"compliance_prior_std", compliance_prior_std},
                                    std::pair{"thermal_prior_std", thermal_prior_std},
                                    {"payload_prior_std", payload_prior_std},
                                    {"straightness_prior_std", straightness_prior_std},
                                    {"gear_ratio_prior_std", gear_ratio_prior_std},
                                    {"coupling_prior_std", coupling_prior_std},
                                    {"hysteresis_prior_std", hysteresis_prior_std},
                                    {"tilt_prior_std", tilt_prior_std}})
    demand(value > 0 && std::isfinite(value), "ErrorModelOptions: ", name, " is ", value, ", must be positive");
  demand(relevant_size >= 0 && std::isfinite(relevant_size), "ErrorModelOptions: relevant_size is ", relevant_size,
         ", must be 0 or more");
  demand(harmonics >= 0 && harmonics <= 500, "ErrorModelOptions: harmonics is ", harmonics, ", must lie in 0..500");
  demand(num_validation_poses >= 1, "ErrorModelOptions: num_validation_poses is ", num_validation_poses,
         ", must be at least 1");
  demand(std::abs(down.norm() - 1) < 1e-6, "ErrorModelOptions: down has length ", down.norm(), ", must be 1");
}

}  // namespace vernier
