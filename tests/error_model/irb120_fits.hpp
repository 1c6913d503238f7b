// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Fits of error models of an IRB 120 between a base and a tool, of which an identification without Ceres is the start.

#include <gtest/gtest.h>

#include <string>

#include "gauss_newton.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier_test::irb120_fits {

using namespace vernier;
using Chain = DhChain<6>;

inline const Robot<6> robot = robots::abb_irb120();
inline const FrameParameters base(Vector6{0.4, -0.3, 0.2, 0.3, -0.4, 0.6}),
    tool(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5});
inline const Framed<Chain> nominal(robot.chain, base, tool);
inline const SensorModel squared{.loss = Loss::squared};

/// From the nominal arm.
inline Identified<Chain> identified(const Dataset<6>& data, const SensorModel& sensors = squared) {
  const auto out = identify_by_gauss_newton(nominal, data, {.frames = Frames::base_and_tool}, sensors);
  EXPECT_TRUE(out.converged()) << out.message;
  return out;
}

/// What was decided of a block, by its key; null where it was not tried.
inline const BlockChoice* choice_of(const FittedErrorModel<Chain>& found, const std::string& key) {
  for (const BlockChoice& block : found.blocks)
    if (traits_of(block.block).key == key) return &block;
  return nullptr;
}

}  // namespace vernier_test::irb120_fits
