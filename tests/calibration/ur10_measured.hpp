// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// A UR10 that is off as arms are made, measured in a part of its joint space.

#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier_test::ur10_measured {

using namespace vernier;
using Chain = DhChain<6>;
using Actual = Framed<WithJointErrors<Chain>>;

inline const Robot<6> robot = robots::ur10();
inline const Isometry3 base = FrameParameters(Vector6{2, -1, 0.5, 0.1, -0.2, 1.5}).isometry(),
                       tool = FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}).isometry();
constexpr MeasurementNoise noise{.position = 0.03e-3, .orientation = 0.1e-3};

/// @param reach of joint 1, relative to what is measured
inline JointRows<6> joints(Index n, std::uint64_t seed, double reach = 1) {
  JointLimits<6> ranges;
  ranges.lower = JointVector<6>(-2.5 * reach, -2.6, 0.3, -2.5, -2, -2.5);
  ranges.upper = JointVector<6>(2.5 * reach, -0.6, 2.4, 2.5, 2, 2.5);
  return sample_joints(ranges, n, seed);
}

/// With geometric errors and joint errors; by default compliance and harmonics alone.
inline Actual actual_arm(const Isometry3& at = base, const JointErrorSizes& sizes = {.gear_ratio = 0, .coupling = 0}) {
  const Chain off =
      with_geometric_errors(robot.chain, {.length_min = 0.2e-3, .angle_min = 0.3e-3, .angle_max = 1e-3}, 4);
  return Actual({off, draw_joint_errors(robot.chain, sizes, 5)}, at, tool);
}

}  // namespace vernier_test::ur10_measured
