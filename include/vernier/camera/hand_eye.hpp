// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Base and tool frames from poses of the flange and poses seen, in closed form.

#include <array>
#include <span>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// Frames X and Y with `seen_i ~ X flange_i Y`.
struct HandEye {
  Isometry3 base = Isometry3::Identity();  ///< X: the arm's base in the sensor's frame
  Isometry3 tool = Isometry3::Identity();  ///< Y: the tool in the flange's frame
  double spread = 0;                  ///< of the flange's rotations: 0 where they are all about one axis, at most 1
  double rotation_rms = 0;            ///< of the residual rotations [rad]
  double translation_rms = 0;         ///< of the residual shifts [m]
  std::vector<std::size_t> chosen{};  ///< of each pose: which of its two candidates is consistent
};

/// Both frames by linear least squares: the rotations by a singular value decomposition, then the translations.
/// @param flanges base_T_flange, n >= 3
/// @param seen    n poses
/// @param weights of the poses; none: one each
/// @throws std::invalid_argument for other numbers
/// @cite Shah 2013
VERNIER_API HandEye hand_eye(std::span<const Isometry3> flanges, std::span<const Isometry3> seen,
                             std::span<const double> weights = {});

/// The same with two candidates for each pose, of which at most one is right; some poses may be wrong altogether. The
/// choice is that which most poses agree on: the least median of squares over random triples of poses.
/// @param flanges    base_T_flange, n >= 3
/// @param candidates n pairs; the likelier one first. A pair may hold the same pose twice
/// @cite Rousseeuw and Leroy 1987
VERNIER_API HandEye consistent_hand_eye(std::span<const Isometry3> flanges,
                                        std::span<const std::array<Isometry3, 2>> candidates);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/camera/hand_eye.ipp"
#endif
