// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Configurations of an IRB 120, for tests of plans.

#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/planning/plan_measurements.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier_test {

/// In its operating region, each approached from the one before.
inline vernier::MeasurementCandidates<6> some_candidates(vernier::Index n, std::uint64_t seed) {
  vernier::MeasurementCandidates<6> out;
  out.joints = vernier::abb_irb120_operating_region().sample(vernier::robots::abb_irb120().chain, n, seed);
  out.previous = out.joints;
  for (vernier::Index i = 1; i < n; ++i)
    vernier::set_configuration(out.previous, i, vernier::configuration(out.joints, i - 1));
  return out;
}

}  // namespace vernier_test
