// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A model in the state in which a row was measured: at its temperature, under its payload.

#include "vernier/data/dataset.hpp"
#include "vernier/error_model/error_model.hpp"

namespace vernier::detail {

/// Whether a model depends on what the arm carries, and the data state that.
template <class Chain>
bool loaded_by(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data) {
  return data.payloads().rows() > 0 && model.identified().model().joint_errors().terms().payload.has_value();
}

/// The model at the temperature of a row and under its payload; unchanged by what is unknown.
/// @param temperature whether it is to be at that temperature
template <class Chain>
ErrorModel<Chain> in_state_of(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data, Index row,
                              bool temperature = true) {
  ErrorModel<Chain> out =
      temperature && data.temperatures().size() > 0 ? model.at_temperature(data.temperatures()(row)) : model;
  return loaded_by(model, data) ? out.carrying(Payload::of(data.payloads(), row)) : out;
}

}  // namespace vernier::detail
