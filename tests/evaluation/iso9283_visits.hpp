// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Visits of poses, for tests of ISO 9283.

#include <cstdint>
#include <span>
#include <vector>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/iso9283.hpp"

namespace vernier_test {

using vernier::Iso9283Visit;
using vernier::Isometry3;
using vernier::Vector3;

inline Isometry3 pose_of(const Vector3& position, const Vector3& rotation = Vector3::Zero()) {
  return vernier::rigid_motion(vernier::exp_so3(rotation), position);
}

inline Vector3 normal3(vernier::Rng& rng, double sigma) {
  return sigma * Vector3(rng.normal(), rng.normal(), rng.normal());
}

/// A pose moved and then turned where it is, in the frame of the base.
inline Isometry3 moved_by(const Isometry3& pose, const Vector3& shift, const Vector3& turn) {
  return vernier::rigid_motion(vernier::exp_so3(turn) * vernier::rotation(pose), vernier::translation(pose) + shift);
}

/// Visits of poses with normal errors of positions [m] and rotation vectors [rad], in the order P5 P4 P3 P2 P1.
inline std::vector<Iso9283Visit> visits_of(std::span<const Isometry3> poses, int cycles, double sigma, double angle,
                                           std::uint64_t seed) {
  vernier::Rng rng(seed);
  std::vector<Iso9283Visit> out;
  for (int cycle = 1; cycle <= cycles; ++cycle)
    for (int k = static_cast<int>(poses.size()); k >= 1; --k) {
      const Vector3 shift = normal3(rng, sigma), turn = normal3(rng, angle);
      const Isometry3 measured = moved_by(poses[static_cast<std::size_t>(k - 1)], shift, turn);
      out.push_back({k, cycle, 0, measured, 2.0 * static_cast<double>(out.size())});
    }
  return out;
}

}  // namespace vernier_test
