// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Estimates of error models in model files: unknowns, noise, and the covariance in single precision.

#include "vernier/error_model/error_model.hpp"
#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/io/json.hpp"

namespace vernier::detail {

/// An estimate of one station without the values of its unknowns, which the model has. Of more than 1,700 unknowns
/// those of the highest orders are kept with their standard deviations alone, so that a file stays below 10 MB.
VERNIER_API nlohmann::ordered_json estimate_to_json(const ErrorModelEstimate& estimate);
/// @param arm     the identified arm of the model
/// @param thermal how its geometry changes with temperature; null where it does not
VERNIER_API ErrorModelEstimate estimate_from_json(const JsonNode& node, const FittedArm& arm,
                                                  const ThermalRates* thermal);

/// Numbers in single precision, little endian, as base64 (RFC 4648).
VERNIER_API std::string base64_of(const std::vector<float>& values);
/// The reverse; empty where the text is not what some number of values is written as.
VERNIER_API std::vector<float> floats_of(const std::string& base64);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/estimate_json.ipp"
#endif
