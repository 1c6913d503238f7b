// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Seeded sampling of joint configurations.

#include <cmath>
#include <cstdint>

#include "vernier/core/check.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"
#include "vernier/kinematics/concepts.hpp"
#include "vernier/kinematics/joint_limits.hpp"

namespace vernier {

namespace detail {

/// Fills the rows of `out` with vectors uniform in [lower, upper] that `accept` accepts.
VERNIER_API void sample_rows(const ConstVectorRef& lower, const ConstVectorRef& upper, std::uint64_t seed,
                             FunctionRef<bool(const double* q)> accept, MatrixRef out);

}  // namespace detail

/// n joint configurations, uniform within limits.
/// @param limits finite, lower not above upper
/// @param n      number of configurations
/// @param seed   same seed, same configurations
/// @param accept predicate of a configuration, e.g. that it is clear of a singularity; others are rejected and drawn
/// again
/// @throws std::invalid_argument for unbounded limits, or where fewer than one in a thousand is accepted
template <int N, class Accept>
JointRows<N> sample_joints(const JointLimits<N>& limits, Index n, std::uint64_t seed, Accept&& accept) {
  demand(n >= 0, "sample_joints: ", n, " configurations requested");
  JointRows<N> out(n, N);
  const auto accepted = [&](const double* q) -> bool { return accept(JointVector<N>(q)); };
  detail::sample_rows(limits.lower, limits.upper, seed, accepted, out);
  return out;
}

/// n joint configurations, uniform within limits.
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

  /// n joint configurations of an arm within the region.
  template <class Chain>
  JointRows<N> sample(const Chain& chain, Index n, std::uint64_t seed) const {
    return sample_joints(limits, n, seed, [&](const JointVector<N>& q) {
      const Isometry3 end = chain.pose(q);
      const double d = chain.row(N - 1).d;
      return std::hypot(end(0, 3) - d * end(0, 2), end(1, 3) - d * end(1, 2)) >= wrist_clearance;
    });
  }
};

/// The part of the ABB IRB 120's joint space that is free of wrist, elbow and shoulder singularities: q1 +-90, q2
/// +-60, q3 -60..50, q4 +-90, q5 20..110, q6 +-180 deg, wrist centre 120 mm or more off axis 1.
VERNIER_API OperatingRegion<6> abb_irb120_operating_region();

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/simulation/sampling.ipp"
#endif
