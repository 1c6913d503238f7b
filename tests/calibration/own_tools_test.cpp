// SPDX-License-Identifier: BSD-3-Clause
// Two files with different tools: each has its own in every step.

#include <gtest/gtest.h>

#include "ur10_measured.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace vernier::own_tools_test {
namespace {

using namespace vernier_test::ur10_measured;

const Isometry3 other_base = FrameParameters(Vector6{-1, 2, 0.3, 0, 0.3, -1}).isometry(),
                other_tool = FrameParameters(Vector6{-0.12, 0.2, 0.3, 1, -0.4, 0.5}).isometry();

Actual arm_with(bool first) {
  const auto arm = actual_arm();
  return first ? arm : Actual(arm.model(), other_base, other_tool);
}

std::vector<Dataset<6>> files(Index poses, std::uint64_t seed, bool oriented) {
  MeasurementNoise sensor = noise;
  sensor.with_orientations = oriented;
  return {measure(arm_with(true), joints(poses, seed), sensor, seed + 10),
          measure(arm_with(false), joints(poses, seed + 1), sensor, seed + 11)};
}

void expect_own_tools(bool oriented) {
  CalibrateOptions options;
  options.errors.tool_per_station = true;
  options.remainder.on_geometry = true;
  options.remainder.iterations = 3;
  const auto found = calibrate(robot.chain, files(80, 1, oriented), options);
  const auto report = evaluate(found, files(40, 5, oriented));
  double worst_link = 0;
  for (const ParameterEstimate& p : found.geometry.parameters)
    if (p.kind == ParameterKind::length && !p.name.starts_with("base") && !p.name.starts_with("tool"))
      worst_link = (std::max)(worst_link, std::abs(p.identified - p.nominal));
  EXPECT_LT(worst_link, 2e-3);  // 1 mm was simulated
  EXPECT_LT(found.geometry.rms_after, 0.6e-3);
  for (const StageErrors& stage : report.stages) {
    EXPECT_LT(stage.position.tail(40).mean(), 1.5 * stage.position.head(40).mean()) << stage.title;
    EXPECT_LT(stage.position.mean(), 5e-3) << stage.title;
  }
  const double deployed = report.held_out_mean().mean;
  EXPECT_LT(deployed, 0.12e-3);
  for (std::size_t s = 0; s < 2; ++s) {
    const Actual actual = arm_with(s == 0);
    EXPECT_LT(prediction_error(found.model(s), measure(actual, joints(200, 77))).mean, 0.1e-3) << s;
    // the errors of the last link, up to 1 mm along two axes, are the tool's as well
    EXPECT_LT((found.model(s).identified().tool().translation() - actual.tool().translation()).norm(), 2e-3) << s;
  }
}

TEST(OwnTools, WithOrientations) { expect_own_tools(true); }

TEST(OwnTools, FromPositionsAlone) { expect_own_tools(false); }

}  // namespace
}  // namespace vernier::own_tools_test
