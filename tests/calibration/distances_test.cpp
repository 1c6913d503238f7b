// SPDX-License-Identifier: BSD-3-Clause
// Calibration from distances: draw-wires and ball-bars, alone and beside poses.

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "ur10_measured.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::distances_test {
namespace {

using namespace vernier_test::ur10_measured;
using vernier_test::complaint;

const Vector3 anchor(0.9, -1.2, 0.3);
const RemainderOptions nothing{.on_error_model = false};

/// In its own base frame.
Actual actual_arm(double harmonic, double compliance) {
  return vernier_test::ur10_measured::actual_arm(
      Isometry3::Identity(), {.gear_ratio = 0, .coupling = 0, .compliance = compliance, .harmonic = harmonic});
}

/// The nominal arm, its tool off by millimetres.
Framed<Chain> with_rough_tool() {
  Isometry3 rough = tool;
  rough.translation() += Vector3(3e-3, -2e-3, 4e-3);
  return Framed<Chain>(robot.chain, {}, rough);
}

constexpr Frames both = Frames::base_and_tool;

template <class Model>
double rms_of_distances(const Model& model, const Distances<6>& data) {
  return std::sqrt((positions(model, data.joints()).rowwise().norm() - data.lengths()).squaredNorm() /
                   static_cast<double>(data.size()));
}

TEST(Distances, AloneIdentifyGeometryExactly) {
  const Actual actual = actual_arm(0, 0);
  const auto found =
      identify(with_rough_tool(), measure_distances(actual, anchor, joints(300, 1)), {.frames = both, .priors = false});
  EXPECT_TRUE(found.converged()) << found.summary();
  EXPECT_LT(rms_of_distances(found.model, measure_distances(actual, anchor, joints(100, 2))), 1e-9);
  EXPECT_GT(found.rms_before, 1e-4);
  EXPECT_LT(found.rms_after, 1e-9);
  // the fixed point lies where it was put, as far as the arm's own zero of joint 1 and foot of axis 1 are known
  const Vector3 there = found.model.identified().base().inverse() * Vector3::Zero();
  EXPECT_LT((there - anchor).norm(), 0.02);
  // and which way the sensor looks has no meaning
  for (const Index k : {3, 4, 5})
    EXPECT_EQ(found.parameters[static_cast<std::size_t>(k)].state, ParameterState::not_identifiable) << k;
}

TEST(Distances, AloneFindJointErrors) {
  const Actual actual = actual_arm(0.3e-3, 1e-3);
  const std::vector<Distances<6>> wire{measure_distances(actual, anchor, joints(600, 1), 0.02e-3, 2)};
  const auto found = calibrate(with_rough_tool(), wire, {.errors = {.harmonics = 30}});
  const auto fresh = measure_distances(actual, anchor, joints(300, 3));
  const double geometry = rms_of_distances(found.errors.models(Stage::geometry)[0], fresh);
  const double all = rms_of_distances(found.model(), fresh);
  EXPECT_LT(all, 0.4 * geometry);
  EXPECT_LT(all, 0.05e-3);
  EXPECT_GT(found.errors.position_sigma, 0.01e-3);
  EXPECT_LT(found.errors.position_sigma, 0.08e-3);
}

/// Few positions, and what two wires at other places add.
struct Mixed {
  Actual actual = actual_arm(0.3e-3, 1e-3);
  std::vector<Dataset<6>> poses{measure(actual, joints(40, 1), {.position = 0.03e-3, .with_orientations = false}, 2)};
  std::vector<Distances<6>> wires(double sigma) const {
    return {measure_distances(actual, anchor, joints(200, 3), sigma, 4),
            measure_distances(actual, Vector3(-1, 0.4, 1.2), joints(200, 5), sigma, 6)};
  }
  Measurements<6> with(const std::vector<Distances<6>>& distances) const {
    Measurements<6> out(poses);
    for (const auto& wire : distances) out.add(wire);
    return out;
  }
  double error(const std::vector<Distances<6>>& distances, double sigma) const {
    const auto found =
        calibrate(robot.chain, with(distances),
                  {.errors = {.harmonics = 15}, .sensors = {.distance_sigma = sigma}, .remainder = nothing});
    EXPECT_EQ(found.errors.models().size(), 1 + distances.size());
    return prediction_error(found.model(), measure(actual, joints(300, 7))).mean;
  }
};

TEST(Distances, BesidePosesAddWhatTheyAreGoodFor) {
  const Mixed mixed;
  const double without = mixed.error({}, 1e-3);
  EXPECT_LT(mixed.error(mixed.wires(0.03e-3), 0.03e-3), 0.8 * without);
  EXPECT_LT(mixed.error(mixed.wires(5e-3), 5e-3), 1.1 * without);  // a bad wire, known to be one, harms little
}

TEST(Distances, OneInTwentyOffByFiveMillimetres) {
  const Mixed mixed;
  const auto clean = mixed.wires(0.03e-3);
  auto dirty = clean;
  for (auto& wire : dirty) {
    VectorX lengths = wire.lengths();
    for (Index i = 0; i < lengths.size(); i += 20) lengths(i) += i % 40 == 0 ? 5e-3 : -5e-3;
    wire = Distances<6>(wire.joints(), lengths);
  }
  EXPECT_LT(mixed.error(dirty, 0.03e-3), 2 * mixed.error(clean, 0.03e-3));
}

TEST(Distances, EveryWireFindsItsFixedPoint) {
  const Mixed mixed;
  const auto wires = mixed.wires(0.03e-3);
  const auto found = calibrate(robot.chain, mixed.with(wires), {.errors = {.harmonics = 15}, .remainder = nothing});
  // in the frame of the positions, which is the arm's own here
  const auto fixed_point = [&](std::size_t s) {
    return Vector3(found.errors.models()[0].identified().base() *
                   found.errors.models()[s].identified().base().inverse() * Vector3::Zero());
  };
  EXPECT_LT((fixed_point(1) - anchor).norm(), 0.2e-3);
  EXPECT_LT((fixed_point(2) - Vector3(-1, 0.4, 1.2)).norm(), 0.2e-3);
}

TEST(Distances, MisuseThrows) {
  EXPECT_NE(complaint([] { (void)identify(robot.chain, Distances<6>()); }).find("no samples"), std::string::npos);
  const std::vector<Distances<6>> empty(1);
  EXPECT_THROW((void)calibrate(robot.chain, empty), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::distances_test
