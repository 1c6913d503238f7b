// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The direction of gravity as an unknown of an error model with gravity compliance.

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// Estimates the direction of gravity: the best of the axes and of the given direction, then Newton's steps of the
/// two angles about it. Torques are linear in the direction; the products of compliance follow it at each trial.
/// @param model   solved with these terms; solved again with the direction that is found
/// @param terms   those of the problem, with gravity compliance; they get the direction
/// @param nominal the chain whose torques gravity compliance needs
/// @param start   the direction as stated, base frame of the chain; a unit vector
/// @return        its standard deviation [rad], of the weaker angle; 0 where the measurements do not tell it
VERNIER_API double estimate_down(ModelSelection& model, JointTerms& terms, const ChainTable& nominal,
                                 const Vector3& start);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/gravity_direction.ipp"
#endif
