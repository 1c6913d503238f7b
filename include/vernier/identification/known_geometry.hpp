// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What is known of an arm's chain before it is identified.

#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// A chain as an earlier calibration has it, of the same arm or of another of its type. With its covariance S and the
/// expected sizes V0 of geometric errors the prior is N(values, S + change^2 V0): `change`, how much of these sizes has
/// changed since, or differs between the arms, follows from evidence.
struct KnownGeometry {
  std::string name;                 ///< for messages
  VectorX values{};                 ///< of all parameters, as `ArmGeometry` counts them; those of frames are not used
  std::vector<Index> parameters{};  ///< those of the chain that were estimated
  MatrixX covariance{};             ///< of these [m, rad]
};

}  // namespace vernier
