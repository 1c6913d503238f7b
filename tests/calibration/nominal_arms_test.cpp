// SPDX-License-Identifier: BSD-3-Clause
// Where a nominal arm is taken, so is a robot of the catalogue: to the same bits as its chain.

#include <gtest/gtest.h>

#include <type_traits>

#include "touched_objects.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/ceres.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/kinematics/general_six_axis.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/planning/plan_measurements.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::nominal_arms_test {
namespace {

using testing::same_bits;

static_assert(NominalArm<Robot<6>> && NominalArm<Robot<7, ModifiedDh>>);
static_assert(std::is_same_v<ChainOf<Robot<6, ModifiedDh>>, DhChain<6, ModifiedDh>>);
static_assert(!NominalArm<JointLimits<6>> && !NominalArm<int>);

const Robot<6> robot = robots::abb_irb120();

Dataset<6> measured() {
  const Framed actual(with_geometric_errors(robot.chain, {}, 3), FrameParameters(Vector6{1, -0.5, 0.3, 0, 0.1, 0.4}),
                      FrameParameters(Vector6{0.02, 0, 0.1, 0, 0, 0}));
  return measure(actual, sample_joints(abb_irb120_operating_region().limits, 40, 2), {.position = 0.1e-3}, 4);
}

VectorX parameters(const Framed<DhChain<6>>& arm) { return ArmGeometry(arm).parameters(); }

TEST(NominalArms, FramesAndGeometry) {
  EXPECT_TRUE(same_bits(parameters(in_frames(robot)), parameters(in_frames(robot.chain))));
  const Robot<6, ModifiedDh> modified = robots::puma560_modified();
  EXPECT_TRUE(
      same_bits(ArmGeometry(in_frames(modified)).parameters(), ArmGeometry(in_frames(modified.chain)).parameters()));
}

TEST(NominalArms, ClosedForms) {
  const Isometry3 target = robot.chain.pose(JointVector<6>::Constant(0.3));
  EXPECT_TRUE(same_bits(ClosedForm(robot).roots(target).begin()->joints,
                        ClosedForm(robot.chain).roots(target).begin()->joints));
  EXPECT_TRUE(same_bits(GeneralSixAxis(robot).roots(target).begin()->joints,
                        GeneralSixAxis(robot.chain).roots(target).begin()->joints));
}

TEST(NominalArms, FramesIdentificationAndAudit) {
  const Dataset<6> data = measured();
  EXPECT_TRUE(same_bits(parameters(starting_frames(robot, data, true, true)),
                        parameters(starting_frames(robot.chain, data, true, true))));
  const IdentifyOptions options{.frames = Frames::base_and_tool};
  EXPECT_TRUE(same_bits(parameters(identify(robot, data, options).model.identified()),
                        parameters(identify(robot.chain, data, options).model.identified())));
  EXPECT_EQ(audit_data(robot, data).summary(), audit_data(robot.chain, data).summary());
}

TEST(NominalArms, Contacts) {
  const std::vector<Contact> contacts = vernier_test::three_planes(true);
  EXPECT_TRUE(same_bits(parameters(identify_by_contacts(robot, contacts).model.identified()),
                        parameters(identify_by_contacts(robot.chain, contacts).model.identified())));
}

TEST(NominalArms, Plans) {
  const auto candidates = sample_candidates(robot, robot.limits, {}, 60, 1);
  EXPECT_TRUE(same_bits(candidates.joints, sample_candidates(robot.chain, robot.limits, {}, 60, 1).joints));
  PlanOptions options{.count = 10};
  options.errors.harmonics = 3;
  EXPECT_EQ(plan_measurements(robot, candidates, options).chosen,
            plan_measurements(robot.chain, candidates, options).chosen);
}

TEST(NominalArms, Calibrations) {
  const Dataset<6> data = measured();
  const CalibrateOptions options{.errors = {.harmonics = 0, .drift = false}, .remainder = {.learners = {}}};
  const auto of_robot = calibrate(robot, data, options), of_chain = calibrate(robot.chain, data, options);
  for (Index i = 0; i < 5; ++i)
    EXPECT_TRUE(
        same_bits(of_robot.model().pose(data.joints(i)).matrix(), of_chain.model().pose(data.joints(i)).matrix()));
  EXPECT_TRUE(same_bits(evaluate(of_robot, data, robot.limits).stages.back().position,
                        evaluate(of_chain, data, robot.limits).stages.back().position));
}

}  // namespace
}  // namespace vernier::nominal_arms_test
