// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Distances of a six-axis arm from its singularities; their signs name a branch of its inverse kinematics.

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "vernier/core/language.hpp"

namespace vernier {

/// The three factors into which the determinant of the Jacobian of an arm with a closed form decomposes, each scaled
/// to [-1, 1]: zero in a singularity, and there its sign changes. `asin` of each is an angle: that of the elbow from
/// its stretched, of the wrist from its straight configuration.
/// @cite Gorla and Renaud 1984; Wenger 2004
struct SingularityDistances {
  double shoulder =
      0;             ///< distance of the wrist centre from the surface on which it is singular, over the arm's length
  double elbow = 0;  ///< sine of the angle between upper arm and forearm
  double wrist = 0;  ///< sine of the angle between the wrist's first and last axis, where the second is orthogonal

  /// Whether those three are known. Of an arm without closed form they are not: then `wrist` is the determinant of the
  /// Jacobian over the product of its columns' lengths, and the others are 1.
  bool factored = true;
  bool known = true;  ///< whether anything is known: else all of these are meaningless

  /// All three, in that order.
  std::array<double, 3> values() const { return {shoulder, elbow, wrist}; }
  /// The signs as a number from 0 to 7: bit 0 shoulder, bit 1 elbow, bit 2 wrist; set where negative.
  int branch() const { return (shoulder < 0 ? 1 : 0) + (elbow < 0 ? 2 : 0) + (wrist < 0 ? 4 : 0); }
  /// The smallest distance as an angle [rad].
  double nearest_angle() const {
    return std::asin((std::min)({std::abs(shoulder), std::abs(elbow), std::abs(wrist), 1.0}));
  }
  /// The singularity to which that belongs: `shoulder`, `elbow` or `wrist`; `any` where they are not told apart, empty
  /// where nothing is known.
  std::string_view nearest() const {
    if (!known) return "";
    if (!factored) return "any";
    const double least = (std::min)({std::abs(shoulder), std::abs(elbow), std::abs(wrist)});
    return std::abs(wrist) <= least ? "wrist" : std::abs(elbow) <= least ? "elbow" : "shoulder";
  }
};

}  // namespace vernier
