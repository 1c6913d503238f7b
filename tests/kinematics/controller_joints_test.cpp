// SPDX-License-Identifier: BSD-3-Clause
// Arms whose controllers count joints differently: published forward kinematics, laws of the model, limits and turns.
#include <gtest/gtest.h>

#include <numbers>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/testing/branch_laws.hpp"
#include "vernier/testing/kinematic_laws.hpp"

namespace vernier::controller_joints_test {
namespace {

/// A joint as a URDF file states it: where its frame lies in the one before [m], and its axis.
struct PublishedJoint {
  Vector3 origin, axis;
};

Isometry3 published_pose(const std::array<PublishedJoint, 6>& joints, const JointVector<6>& q, const Matrix3& flange) {
  Isometry3 out = Isometry3::Identity();
  for (int j = 0; j < 6; ++j) {
    const PublishedJoint& joint = joints[static_cast<std::size_t>(j)];
    out = out * Eigen::Translation3d(joint.origin) * Eigen::AngleAxisd(q(j), joint.axis);
  }
  return out * Isometry3(flange);
}

Matrix3 turned(double angle, const Vector3& axis) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); }

double difference(const Isometry3& a, const Isometry3& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

constexpr double quarter = std::numbers::pi / 2;

// Frames, axes and flange of the packages fanuc_r2000ic_support (R-2000iC/165F, the same lengths) and kuka_kr6_support
// of ROS-Industrial. Its driver adds J2 to joint 3 of a FANUC arm.
TEST(ControllerJoints, PublishedForwardKinematicsOfAFanucArm) {
  const auto robot = robots::fanuc_r2000ib_165f();
  const std::array<PublishedJoint, 6> published{{{{0, 0, 0}, {0, 0, 1}},
                                                 {{0.312, 0, 0}, {0, 1, 0}},
                                                 {{0, 0, 1.075}, {0, -1, 0}},
                                                 {{0, 0, 0.225}, {-1, 0, 0}},
                                                 {{1.280, 0, 0}, {0, -1, 0}},
                                                 {{0.215, 0, 0}, {-1, 0, 0}}}};
  const Matrix3 flange = turned(-quarter, Vector3::UnitY()) * turned(2 * quarter, Vector3::UnitX());
  const InControllerJoints<DhChain<6>> arm(robot.chain, JointChange<6>(robot.controller));
  const JointRows<6> joints = sample_joints(robot.limits, 50, 1);
  for (Index i = 0; i < joints.rows(); ++i) {
    JointVector<6> q = joints.row(i).transpose(), serial = q;
    serial(2) += q(1);
    EXPECT_LT(difference(arm.pose(q), published_pose(published, serial, flange)), 1e-12);
  }
}

TEST(ControllerJoints, PublishedForwardKinematicsOfAKukaArm) {
  const auto robot = robots::kuka_kr6_r900();
  const std::array<PublishedJoint, 6> published{{{{0, 0, 0.400}, {0, 0, -1}},
                                                 {{0.025, 0, 0}, {0, 1, 0}},
                                                 {{0.455, 0, 0}, {0, 1, 0}},
                                                 {{0, 0, 0.035}, {-1, 0, 0}},
                                                 {{0.420, 0, 0}, {0, 1, 0}},
                                                 {{0.080, 0, 0}, {-1, 0, 0}}}};
  const InControllerJoints<DhChain<6>> arm(robot.chain, JointChange<6>(robot.controller));
  const JointRows<6> joints = sample_joints(robot.limits, 50, 2);
  for (Index i = 0; i < joints.rows(); ++i) {
    const JointVector<6> q = joints.row(i).transpose();
    EXPECT_LT(difference(arm.pose(q), published_pose(published, q, turned(quarter, Vector3::UnitY()))), 1e-12);
  }
}

TEST(ControllerJoints, LawsOfModelsAndOfBranches) {
  for (const auto& robot : {robots::fanuc_r2000ib_165f(), robots::kuka_kr6_r900()}) {
    const JointChange<6> change(robot.controller);
    const InControllerJoints<DhChain<6>> arm(robot.chain, change);
    const JointRows<6> joints = sample_joints(robot.limits, 20, 3);
    for (const auto& violation : testing::kinematic_model_violations(arm, joints)) ADD_FAILURE() << violation;
    const RootsInControllerJoints<ClosedForm<6>> roots(ClosedForm<6>(robot.chain), change);
    testing::BranchLawOptions<6> options;
    options.limits = robot.limits;
    const auto solver = [&](const Isometry3& target) {
      return all_branches(roots, arm, target, {.limits = robot.limits});
    };
    for (const auto& violation : testing::branch_violations(solver, arm, joints, options)) ADD_FAILURE() << violation;
  }
}

TEST(ControllerJoints, LimitsAndTurnsAreThoseOfTheController) {
  const auto robot = robots::fanuc_r2000ib_165f();
  const JointChange<6> change(robot.controller);
  const InControllerJoints<DhChain<6>> arm(robot.chain, change);
  const RootsInControllerJoints<ClosedForm<6>> roots(ClosedForm<6>(robot.chain), change);
  constexpr double degree = std::numbers::pi / 180;
  JointVector<6> q;
  q << 20, 70, 200, 300, 50, -200;  // chain joint 3 is at 270 deg, joints 4 and 6 have turned
  q *= degree;
  ASSERT_TRUE(robot.limits.contains(q));
  const Branches<6> found = all_branches(roots, arm, arm.pose(q), {.limits = robot.limits, .close_to = q});
  ASSERT_NE(found.nearest(q), nullptr);
  EXPECT_LT((found.nearest(q)->joints - q).cwiseAbs().maxCoeff(), 1e-9);
  JointVector<6> outside = q;
  outside(1) = 80 * degree;  // beyond the limit of joint 2, with which chain joint 3 moves
  for (const Branch<6>& branch : all_branches(roots, arm, arm.pose(outside), {.limits = robot.limits, .close_to = q}))
    EXPECT_EQ(branch.within_limits, robot.limits.contains(branch.joints));
  IkOptions<6> options;
  options.limits = robot.limits;
  const IkResult<6> held = inverse_kinematics(arm, arm.pose(outside), q, options);
  EXPECT_TRUE(robot.limits.contains(held.joints));
  EXPECT_NE(held.status, IkStatus::converged);
}

TEST(ControllerJoints, APassiveJointKeepsItsLaw) {
  const DhChain<5> palletiser{{{{.a = 0.3, .alpha = -quarter, .d = 0.8},
                                {.a = 1.2, .theta = -quarter},
                                {.a = 1.3, .theta = quarter},
                                {.a = 0.25, .alpha = -quarter},
                                {.d = -0.2}}}};
  const std::array<std::string, 5> law{"J1", "J2", "J3 - J2", "-J3", "J4"};
  const ControllerMap map(law);
  const JointChange<5> change(map);
  ASSERT_EQ(change.moving(), 4);
  const InControllerJoints<DhChain<5>> arm(palletiser, change);
  Rng rng(5);
  for (int k = 0; k < 20; ++k) {
    JointVector<5> q = JointVector<5>::Zero();
    for (int j = 0; j < 4; ++j) q(j) = rng.uniform(-0.8, 0.8);
    const JointVector<5> chain = change.to_chain(q);
    EXPECT_NEAR(chain(1) + chain(2) + chain(3), 0, 1e-15);        // the wrist
    EXPECT_NEAR(std::abs(arm.pose(q).linear()(2, 2)), 1, 1e-12);  // stays level
    EXPECT_LT((change.to_controller(chain) - q).cwiseAbs().maxCoeff(), 1e-15);
    IkOptions<5> options;
    for (int j = 0; j < 4; ++j) options.limits.lower(j) = -(options.limits.upper(j) = 1);
    options.limits.lower(4) = options.limits.upper(4) = 0;
    JointVector<5> seed = q;
    seed.head<4>().array() += 0.05;
    const IkResult<5> found = inverse_kinematics(arm, Vector3(arm.position(q)), seed, options);
    EXPECT_EQ(found.status, IkStatus::converged);
    EXPECT_EQ(found.joints(4), 0);
    EXPECT_LT((arm.position(found.joints) - arm.position(q)).norm(), 1e-6);
  }
}

TEST(ControllerJoints, AHeldJointHasToMoveAlone) {
  const std::array<std::string, 7> signs{"-J1", "J2", "-J3", "J4", "J5", "J6", "J7"},
      coupled{"J1", "J2", "J3 - J2", "J4", "J5", "J6", "J7"};
  const JointChange<7> turned_round{ControllerMap(signs)}, follows{ControllerMap(coupled)};
  EXPECT_EQ(turned_round.alone(2), 2);
  EXPECT_EQ(follows.alone(2), -1);
  EXPECT_EQ(follows.alone(1), -1);
  EXPECT_EQ(follows.alone(6), 6);
  EXPECT_NEAR(turned_round.stretch(), 1, 1e-15);
  EXPECT_GE(follows.stretch() * follows.stretch(), 2);
}

}  // namespace
}  // namespace vernier::controller_joints_test
