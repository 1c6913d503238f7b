#pragma once

/// @file
/// Seeded sampling of joint combinations.

#include <cmath>
#include <cstdint>

#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace vernier {

/// n joint combinations, uniform within limits.
/// @param limits finite, lower below upper
/// @param n      how many
/// @param seed   same seed, same combinations
/// @param accept which combinations to keep, e.g. those clear of a singularity; the others are drawn again
/// @throws std::invalid_argument for unbounded limits, or where fewer than one in a thousand is accepted
template <int N, class Accept>
JointRows<N> sample_joints(const JointLimits<N>& limits, Index n, std::uint64_t seed, Accept&& accept) {
  require(n >= 0, "sample_joints: ", n, " combinations asked for");
  require(limits.lower.allFinite() && limits.upper.allFinite() && (limits.lower.array() <= limits.upper.array()).all(),
          "sample_joints: the limits must be finite, lower below upper");
  Rng rng(seed);
  JointRows<N> out(n, N);
  JointVector<N> q;
  for (Index i = 0, tries = 0; i < n;) {
    require(++tries <= 1000 * (n + 10), "sample_joints: fewer than one combination in a thousand is accepted");
    for (int j = 0; j < N; ++j) q(j) = rng.uniform(limits.lower(j), limits.upper(j));
    if (accept(q)) out.row(i++) = q.transpose();
  }
  return out;
}

/// n joint combinations, uniform within limits.
template <int N>
JointRows<N> sample_joints(const JointLimits<N>& limits, Index n, std::uint64_t seed) {
  return sample_joints(limits, n, seed, [](const JointVector<N>&) { return true; });
}

/// Joint ranges and a minimum distance of the wrist centre (the origin of the last-but-one frame) from the first axis.
template <int N>
struct OperatingRegion {
  /// Joint ranges.
  JointLimits<N> limits;
  double wrist_clearance = 0;  ///< [m]

  /// n joint combinations of an arm within the region.
  template <class Chain>
  JointRows<N> sample(const Chain& chain, Index n, std::uint64_t seed) const {
    return sample_joints(limits, n, seed, [&](const JointVector<N>& q) {
      const Isometry3 end = chain.pose(q);
      const Vector3 wrist = end.translation() - chain.row(N - 1).d * end.linear().col(2);
      return std::hypot(wrist.x(), wrist.y()) >= wrist_clearance;
    });
  }
};

/// The part of the ABB IRB 120's joint space where it works without a wrist, elbow or shoulder singularity: q1 +-90, q2
/// +-60, q3 -60..50, q4 +-90, q5 20..110, q6 +-180 deg, wrist centre 120 mm or more off axis 1.
inline OperatingRegion<6> abb_irb120_operating_region() {
  constexpr double degree = 3.14159265358979323846 / 180;
  OperatingRegion<6> region;
  region.limits.lower << -90, -60, -60, -90, 20, -180;
  region.limits.upper << 90, 60, 50, 90, 110, 180;
  region.limits.lower *= degree;
  region.limits.upper *= degree;
  region.wrist_clearance = 0.12;
  return region;
}

}  // namespace vernier
