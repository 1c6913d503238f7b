// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

VERNIER_IMPL void SensorModel::validate() const {
  for (const auto& [name, value] : {std::pair{"position_sigma", position_sigma},
                                    {"orientation_sigma", orientation_sigma},
                                    {"distance_sigma", distance_sigma},
                                    {"contact_sigma", contact_sigma}})
    demand(value > 0 && std::isfinite(value), "SensorModel: ", name, " is ", value, ", must be positive");
  demand(joint_sigma >= 0 && std::isfinite(joint_sigma), "SensorModel: joint_sigma is ", joint_sigma,
         ", must not be negative");
}

}  // namespace vernier
