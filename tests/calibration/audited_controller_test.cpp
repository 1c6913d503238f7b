// SPDX-License-Identifier: BSD-3-Clause
// The map of a controller's joints, named by an audit of poses that were read without it.
#include "vernier/calibration/data_audit.hpp"

#include <gtest/gtest.h>

#include "vernier/calibration/controller_search.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::audited_controller_test {
namespace {

/// Poses of an arm whose joints are written as a controller shows them, and read as those of the chain.
DataAudit audit(const Robot<6>& robot, const ControllerMap& shown_by, std::uint64_t seed = 3, bool oriented = true) {
  const JointRows<6> chain = 0.8 * sample_joints(robots::abb_irb120().limits, 80, seed);
  const auto measured = measure(with_geometric_errors(robot.chain, {}, seed + 1), chain,
                                {.position = 3e-5, .with_orientations = oriented}, seed);
  const JointRows<6> shown = shown_by.to_controller(chain);
  return audit_data(robot.chain, Measurements<6>(Dataset<6>(shown, measured.positions(), measured.orientations())));
}

using Formulas = std::vector<std::string>;

Formulas formulas_of(const std::optional<ControllerMap>& map, std::size_t joints = 6) {
  return map ? map->formulas(std::vector<JointType>(joints, JointType::revolute)) : Formulas();
}

TEST(AuditedController, NamesSignsAndTheCouplingOfAFanucArm) {
  const auto robot = robots::fanuc_r2000ib_165f();
  const auto found = audited_controller(audit(robot, robot.controller), {}, 6);
  ASSERT_TRUE(found.has_value());
  // the signs of joints 4 and 6, and of joint 1 with the sensor's frame, are told by orientations
  EXPECT_EQ(found->formulas(std::vector<JointType>(6, JointType::revolute)),
            (std::vector<std::string>{"J1", "J2", "-J2 - J3", "-J4", "-J5", "-J6"}));
}

// Joints 2 to 4 of this arm are parallel: two of them may be coupled, each with either sign, and any sign reversed.
TEST(AuditedController, NamesSeveralCouplingsWithSigns) {
  const auto robot = robots::ur5();
  const Formulas maps[] = {{"J1", "J2", "J3 - J2", "J4 - J3", "J5", "J6"},
                           {"J1", "-J2", "J3 + J2", "-J4 + J3", "J5", "J6"},
                           {"J1", "J2", "-J3 - J2", "J4 + J3", "-J5", "J6"},
                           {"-J1", "J2", "J3", "J4 - J3", "J5", "-J6"}};
  for (const Formulas& map : maps) {
    const bool oriented = &map < maps + 2;
    const ControllerMap shown{std::span<const std::string>(map)};
    Formulas found = formulas_of(audited_controller(audit(robot, shown, 7, oriented), {}, 6)), law = formulas_of(shown);
    ASSERT_EQ(found.size(), 6u);
    if (!oriented) found[5] = law[5];  // the tool on the last axis takes its sign
    EXPECT_EQ(found, law);
  }
}

// Arms whose joints are those of the chain, with errors of all sizes that are usual.
TEST(AuditedController, NoneInSoundData) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (const Robot<6>& robot : {robots::ur5(), robots::abb_irb120(), robots::kuka_kr6_r900()}) {
      const DataAudit found = audit(robot, {}, seed, seed % 2 == 0);
      EXPECT_FALSE(audited_controller(found, {}, 6).has_value()) << robot.name << ", " << seed << found.summary();
      EXPECT_FALSE(found.has(FaultKind::joint_zero) || found.has(FaultKind::unexplained)) << found.summary();
    }
}

const std::array<DhRow, 5> palletiser{{{.a = 0.26, .alpha = -1.5707963267948966, .d = 0.814},
                                       {.a = 1.15, .theta = -1.5707963267948966},
                                       {.a = 1.25, .theta = 1.5707963267948966},
                                       {.a = 0.22, .alpha = -1.5707963267948966},
                                       {.d = 0.25}}};

/// What the search says of an arm of five joints of which a controller shows four.
std::optional<FoundController> passive_joint(const Formulas& law, std::uint64_t seed, bool oriented) {
  const auto nominal = DhChain<5>::from_rows(palletiser);
  const ControllerMap map{std::span<const std::string>(law)};
  JointLimits<4> limits;
  limits.lower << -1.5, -0.6, -0.3, -2;
  limits.upper << 1.5, 1.2, 1.6, 2;
  const JointRows<4> shown = sample_joints(limits, 60, seed);
  const auto data = measure(with_geometric_errors(nominal, {}, seed), JointRows<5>(map.to_chain(shown)),
                            {.position = 3e-5, .with_orientations = oriented}, seed);
  return find_passive_joint(ArmGeometry(in_frames(nominal)), shown, data.positions(), data.orientations());
}

TEST(AuditedController, FindsThePassiveJointOfAPalletiser) {
  for (const Formulas& law :
       {Formulas{"J1", "J2", "J3 - J2", "-J3", "J4"}, Formulas{"J1", "J2", "J3", "-J2 - J3", "J4"},
        Formulas{"J1", "J2", "-J2 - J3", "J3", "-J4"}})
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
      for (const bool oriented : {true, false}) {
        const auto found = passive_joint(law, seed, oriented);
        ASSERT_TRUE(found.has_value()) << law[2] << ", " << seed;
        Formulas named = formulas_of(found->map, 5);
        const Formulas shown = formulas_of(ControllerMap{std::span<const std::string>(law)}, 5);
        if (!oriented) named[4] = shown[4];  // the tool on the last axis takes its sign
        EXPECT_EQ(named, shown) << seed;
        EXPECT_LT(found->median, 6e-3);
      }
}

TEST(AuditedController, FindsNoPassiveJointInWhatIsNone) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (const bool oriented : {true, false})
      EXPECT_FALSE(passive_joint({"J1", "J2", "J3", "J2", "J4"}, seed, oriented).has_value()) << seed;
}

TEST(AuditedController, FollowsAMapThatIsWrongInOneSign) {
  const auto robot = robots::kuka_kr6_r900();
  DataAudit found;
  found.findings.push_back({FaultKind::joint_sign, 2, {}, 0, ""});
  const auto map = audited_controller(found, robot.controller, 6);
  ASSERT_TRUE(map.has_value());
  EXPECT_EQ(map->formulas(std::vector<JointType>(6, JointType::revolute)),
            (std::vector<std::string>{"-J1", "J2", "-J3", "-J4", "J5", "-J6"}));
}

TEST(AuditedController, NoneWithoutSuchAFault) {
  DataAudit found;
  found.findings.push_back({FaultKind::outlier, -1, {3}, 0.01, ""});
  EXPECT_FALSE(audited_controller(found, {}, 6).has_value());
}

}  // namespace
}  // namespace vernier::audited_controller_test
