// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Accuracy and repeatability after ISO 9283 as JSON.

#include <nlohmann/json_fwd.hpp>

#include "vernier/evaluation/iso9283.hpp"
#include "vernier/evaluation/iso9283_path.hpp"

namespace vernier {

/// Each pose, the distance, the variations by direction, the drift, the registration (translation and rotation vector,
/// m and rad) and the departures from the norm; lengths in mm, angles in mrad. What is unknown is null. Callers include
/// <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json to_json(const Iso9283& result);

/// Accuracy and repeatability of a path, as a whole and at each point; in mm and mrad. Callers include
/// <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json to_json(const Iso9283Path& result);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/iso9283_json.ipp"
#endif
