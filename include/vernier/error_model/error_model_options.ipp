// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/error_model/error_model_options.hpp"

namespace vernier {

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
