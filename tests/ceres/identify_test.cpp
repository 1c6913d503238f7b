// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/identification/identify.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "vernier/ceres/solver.hpp"
#include "vernier/compensation/compensated.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::identify_test {
namespace {

using namespace vernier::literals;

const DhChain<6> nominal = robots::abb_irb120().chain;

/// A tracker metres away and a tool in the hand.
Framed<DhChain<6>> placed(const DhChain<6>& chain) {
  return Framed<DhChain<6>>(chain, FrameParameters(Vector6{2.1, -3.2, 0.4, 0.3, -0.4, 2.6}),
                            FrameParameters(Vector6{0.02, -0.01, 0.11, 0.2, -0.1, 0.5}));
}

JointRows<6> sample(Index n, std::uint64_t seed) { return abb_irb120_operating_region().sample(nominal, n, seed); }

double fresh_error(const Calibrated<DhChain<6>>& model, const Framed<DhChain<6>>& actual) {
  return prediction_error(model, measure(actual, sample(300, 99))).mean;
}

TEST(Identify, NoiseFreePosesAreExact) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto actual = placed(with_geometric_errors(nominal, {}, seed));
    const auto found = identify(nominal, measure(actual, sample(60, seed)), {.frames = Frames::base_and_tool});
    EXPECT_TRUE(found.converged()) << found.summary();
    EXPECT_LT(fresh_error(found.model, actual), 1e-9);
    EXPECT_LT(rotation_errors(found.model, measure(actual, sample(100, 98))).maxCoeff(), 1e-9);
    EXPECT_EQ(found.free.size(), 30u);  // 4 R + 6 with R = 6
    EXPECT_EQ(found.rank, 30);
  }
}

TEST(Identify, NoiseFreePositionsAreExact) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto actual = placed(with_geometric_errors(nominal, {}, seed));
    const auto found = identify(nominal, measure(actual, sample(100, seed), {.with_orientations = false}),
                                {.frames = Frames::base_and_tool});
    EXPECT_TRUE(found.converged()) << found.summary();
    EXPECT_LT(fresh_error(found.model, actual), 1e-9);
    EXPECT_EQ(found.free.size(), 27u);  // a position-only sensor
  }
}

TEST(Identify, WithoutFramesTheToolPointLiesOnTheLastAxisAtNominalOnly) {
  // d5 and alpha5 act alike at nominal, not at the actual arm: the selection has to be made again at the solution
  const DhChain<6> actual = with_geometric_errors(nominal, {}, 3);
  const auto found = identify(nominal, measure(actual, sample(100, 1), {.with_orientations = false}));
  EXPECT_TRUE(found.converged()) << found.summary();
  EXPECT_LT(prediction_error(found.model, measure(actual, sample(300, 2))).mean, 1e-9);
}

TEST(Identify, ModifiedConventionIsExact) {
  const auto robot = robots::puma560_modified();
  const auto actual = with_geometric_errors(robot.chain, {}, 5);
  const auto joints = sample_joints(robot.limits, 100, 1);
  const auto found = identify(robot.chain, measure(actual, joints), {.frames = Frames::base_and_tool});
  EXPECT_TRUE(found.converged()) << found.summary();
  EXPECT_LT(prediction_error(found.model, measure(actual, sample_joints(robot.limits, 200, 2))).mean, 1e-9);
}

TEST(Identify, HundredNoisyPosesAreEnough) {
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto actual = placed(with_geometric_errors(nominal, {}, seed));
    const auto data = measure(actual, sample(100, seed), {.position = 0.03_mm, .with_orientations = false}, seed);
    const auto found = identify(nominal, data, {.frames = Frames::base_and_tool});
    EXPECT_TRUE(found.converged()) << found.summary();
    sum += fresh_error(found.model, actual);
  }
  EXPECT_LT(sum / 10, 0.025_mm);
}

TEST(Identify, CorrectedCommandsLandOnTheNominalPose) {
  const DhChain<6> actual = with_geometric_errors(nominal, {}, 7);
  const auto found = identify(nominal, measure(actual, sample(60, 1)));  // full poses, frames known
  const auto targets = sample(200, 2);
  const auto landed =
      positioning_errors(actual, nominal, corrected_commands(compensate(found.model), targets), targets);
  EXPECT_LT(landed.position.maxCoeff(), 2e-6);
  EXPECT_LT(landed.rotation.maxCoeff(), 2e-6);
  const auto before = positioning_errors(actual, nominal, targets, targets);
  EXPECT_GT(before.position.mean(), 1_mm);
}

TEST(Identify, FixedParametersKeepTheirValuesBitForBit) {
  const auto actual = with_geometric_errors(nominal, {}, 2);
  const auto found =
      identify(nominal, measure(actual, sample(60, 1)), {.frames = Frames::tool, .fixed = {"a2", "theta3", "tool_z"}});
  const auto before = Framed(nominal).parameters();
  const auto after = found.model.identified().parameters();
  const auto names = Framed<DhChain<6>>::parameter_names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == "tool_z") continue;  // holds its start, which is that of the frames
    const bool held = names[k] == "a2" || names[k] == "theta3" || names[k].starts_with("base_") ||
                      (names[k].starts_with("beta") && names[k] != "beta2");
    if (!held) continue;
    EXPECT_EQ(before(static_cast<Index>(k)), after(static_cast<Index>(k))) << names[k];
  }
  EXPECT_TRUE(found.model.identified().base().matrix() == Isometry3::Identity().matrix());
}

TEST(Identify, DeviationsAreWhatTheScatterOverSeedsShows) {
  const auto actual = placed(with_geometric_errors(nominal, {}, 4));
  const auto joints = sample(80, 6);
  const auto names = Framed<DhChain<6>>::parameter_names();
  const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), "a2") - names.begin());
  std::vector<double> values;
  double std = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto data = measure(actual, joints, {.position = 0.03_mm, .orientation = 0.1_mrad}, seed);
    const auto found = identify(nominal, data, {.frames = Frames::base_and_tool});
    values.push_back(found.parameters[at].identified);
    std += found.parameters[at].std / 40;
  }
  const Eigen::Map<const VectorX> v(values.data(), 40);
  const double scatter = std::sqrt((v.array() - v.mean()).square().sum() / 39);
  EXPECT_GT(std / scatter, 0.7);  // 95 % of a chi distribution with 39 degrees of freedom lies within 22 %
  EXPECT_LT(std / scatter, 1.4);
}

TEST(Identify, RobustLossSurvivesOutliers) {
  const auto actual = placed(with_geometric_errors(nominal, {}, 8));
  auto clean = measure(actual, sample(200, 3), {.position = 0.03_mm, .with_orientations = false}, 3);
  PointRows positions = clean.positions();
  for (Index i = 0; i < positions.rows(); i += 20) positions(i, i % 3) += 5_mm;
  const Dataset<6> spoiled(clean.joints(), positions);
  const auto plain = identify(nominal, spoiled, {.frames = Frames::base_and_tool});
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    const auto robust = identify(nominal, spoiled, {.frames = Frames::base_and_tool}, {.loss = loss});
    EXPECT_LT(fresh_error(robust.model, actual), 0.035_mm);
    EXPECT_LT(fresh_error(robust.model, actual), 0.2 * fresh_error(plain.model, actual));
  }
}

TEST(Identify, WeakParametersDoNotRunOff) {
  // With the tool point nearly on axis 6, a5, alpha5, d5 and theta5 are one: at noise they would run off by
  // centimetres.
  const auto actual = Framed<DhChain<6>>(with_geometric_errors(nominal, {}, 1));
  const auto data = measure(actual, sample(60, 1), {.position = 0.1_mm, .with_orientations = false}, 1);
  const auto held = identify(nominal, data, {.frames = Frames::base_and_tool});
  const auto loose = identify(nominal, data, {.frames = Frames::base_and_tool, .priors = false});
  ASSERT_FALSE(held.names(ParameterState::weak).empty());
  const auto furthest = [](const auto& found) {
    double most = 0;
    for (const auto& p : found.parameters)
      if (p.kind == ParameterKind::length && !p.name.starts_with("base") && !p.name.starts_with("tool"))
        most = std::max(most, std::abs(p.identified - p.nominal));
    return most;
  };
  EXPECT_LT(furthest(held), 3_mm);
  EXPECT_GT(furthest(loose), 2 * furthest(held));
  EXPECT_LT(fresh_error(held.model, actual), 1.05 * fresh_error(loose.model, actual));
}

TEST(Identify, TooFewPosesAreSaidSo) {
  const auto actual = placed(with_geometric_errors(nominal, {}, 1));
  for (const Index n : {1, 2, 3}) {
    const auto found = identify(nominal, measure(actual, sample(n, 1)), {.frames = Frames::base_and_tool});
    EXPECT_EQ(found.status, IdentifyStatus::underdetermined);
    EXPECT_NE(found.summary().find("UNDERDETERMINED"), std::string::npos);
  }
  const JointRows<6> same = sample(1, 1).replicate(50, 1);
  EXPECT_EQ(identify(nominal, measure(actual, same), {.frames = Frames::base_and_tool}).status,
            IdentifyStatus::underdetermined);
  JointRows<6> stiff = sample(100, 1);  // one joint never moved
  stiff.col(2).setConstant(0.3);
  const auto found = identify(nominal, measure(actual, stiff), {.frames = Frames::base_and_tool});
  EXPECT_EQ(found.status, IdentifyStatus::underdetermined);
  EXPECT_FALSE(found.names(ParameterState::not_identifiable).empty());
}

TEST(Identify, SaysWhatCannotBeToldApart) {
  const auto actual = placed(with_geometric_errors(nominal, {}, 1));
  const auto found = identify(nominal, measure(actual, sample(60, 1)), {.frames = Frames::base_and_tool});
  const auto lost = found.names(ParameterState::not_identifiable);
  EXPECT_EQ(lost, (std::vector<std::string>{"d1", "theta1", "a6", "alpha6", "d6", "theta6"}));
  EXPECT_NE(found.summary().find("d1, absorbed by base_"), std::string::npos) << found.summary();
  EXPECT_NE(found.summary().find("theta6, absorbed by tool_rx, tool_ry, tool_rz"), std::string::npos)
      << found.summary();
}

TEST(Identify, MisuseThrowsWithTheValue) {
  const auto data = measure(nominal, sample(10, 1));
  EXPECT_THROW((void)identify(nominal, Dataset<6>()), std::invalid_argument);
  EXPECT_THROW((void)identify(nominal, data, {}, {.position_sigma = -1}), std::invalid_argument);
  try {
    (void)identify(nominal, data, {.fixed = {"a9"}});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("a9"), std::string::npos);
  }
}

TEST(Identify, SameBitsTwice) {
  const auto actual = placed(with_geometric_errors(nominal, {}, 1));
  const auto data = measure(actual, sample(50, 1), {.position = 0.03_mm, .orientation = 0.1_mrad}, 1);
  const auto a = identify(nominal, data, {.frames = Frames::base_and_tool});
  const auto b = identify(nominal, data, {.frames = Frames::base_and_tool});
  EXPECT_TRUE(a.model.identified().parameters() == b.model.identified().parameters());
}

/// Held-out mean of the measured robots, row i held out when i % 5 == 0 [mm].
template <int N>
void expect_measured(const char* file, const DhChain<N>& chain, double frames_mm, double geometry_mm) {
  const char* folder = std::getenv("VERNIER_DATA_DIR");
  if (folder == nullptr || *folder == '\0') GTEST_SKIP() << "VERNIER_DATA_DIR is not set: no measured poses";
  const auto data = split_every(read_dataset<N>(std::string(folder) + "/" + file), 5);
  const auto frames = identify(chain, data.train, {.frames = Frames::base_and_tool, .geometry = false});
  const auto geometry = identify(chain, data.train, {.frames = Frames::base_and_tool});
  EXPECT_NEAR(prediction_error(frames.model, data.test).mean * 1e3, frames_mm, 0.02 * frames_mm);
  EXPECT_LT(prediction_error(geometry.model, data.test).mean * 1e3, geometry_mm);
}

TEST(IdentifyMeasured, Ur10) { expect_measured<6>("ur10_random_poses.csv", robots::ur10().chain, 0.903, 0.44); }
TEST(IdentifyMeasured, Ur5) { expect_measured<6>("ur5_grid.csv", robots::ur5().chain, 0.654, 0.105); }
TEST(IdentifyMeasured, BarrettWam) { expect_measured<7>("wam_grid.csv", robots::barrett_wam().chain, 4.26, 2.2); }

}  // namespace
}  // namespace vernier::identify_test
