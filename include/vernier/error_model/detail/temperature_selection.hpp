// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whether the geometry changes with temperature.

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// Lets the geometry change with temperature, if it does beside a drift of the session. If the temperature follows the
/// time of the session, nothing can tell the two apart: the choice says "untested", and there is no such change. With
/// several sessions every one must be predicted from the others no worse with the change.
/// @param expansion expected relative change of a length [1/K], and change of an angle [rad/K]
/// @return          whether the geometry changes
VERNIER_API bool add_temperature(ModelSelection& model, double expansion);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/temperature_selection.ipp"
#endif
