// SPDX-License-Identifier: BSD-3-Clause
// Command correction on a known model: exact where the arm can get there, never wild where it cannot.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vernier/compensation/compensated.hpp>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/core/rng.hpp>
#include <vernier/identification/calibrated.hpp>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "irb120.hpp"
#include "larger.hpp"

namespace compensated_test {
namespace {

using namespace vernier;
using namespace vernier_test;

Vector3 linear_part(const Vector6& twist) { return {twist(0), twist(1), twist(2)}; }
Vector3 angular_part(const Vector6& twist) { return {twist(3), twist(4), twist(5)}; }
const double infinity = std::numeric_limits<double>::infinity();

using Geometry = Compensated<DhChain<6>, DhChain<6>>;
static_assert(Compensator<Geometry> && KinematicModel<Geometry>);
static_assert(!Compensator<DhChain<6>>, "a chain says where it is, not what to command");
struct Throwing : Geometry {
  using Geometry::Geometry;
  Correction<6> correct(const JointVector<6>& q) const { return Geometry::correct(q); }
};
static_assert(!Compensator<Throwing>, "correct must be noexcept");
struct BarePose {
  static constexpr int dof = 6;
  Vector3 predict(const JointVector<6>&) const noexcept;
  Correction<6> correct(const JointVector<6>&) const noexcept;
};
static_assert(!Compensator<BarePose>, "predict gives a pose");

TEST(Compensated, ObeysTheLaws) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Geometry arm(actual_arm(seed), nominal);
    EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(arm, operating_targets(50))));
    EXPECT_TRUE(no_violations(vernier::testing::kinematic_model_violations(arm, operating_targets(20))));
  }
}

/// Breaks one law at a time.
struct Dishonest : Geometry {
  using Geometry::Geometry;
  int fault = 0;
  Isometry3 predict(const JointVector<6>& q) const noexcept {
    Isometry3 pose = Geometry::predict(q);
    if (fault == 1) pose = rigid_motion(1.001 * rotation(pose), translation(pose));
    return pose;
  }
  Correction<6> correct(const JointVector<6>& q) const noexcept {
    Correction<6> c = Geometry::correct(q);
    static double drift = 0;
    if (fault == 2) c.command(0) += (drift += 1e-12);
    if (fault == 3) c.predicted_error += 1e-5;
    if (fault == 4) c.command(5) += 1e-4;  // orientation alone
    if (fault == 5) c.gate = 1.5;
    if (fault == 6) c.command = q;
    if (fault == 7) c.command(2) = std::nan("");
    return c;
  }
};
static_assert(Compensator<Dishonest>);

TEST(CompensatorLaws, NoticeWhatIsBroken) {
  const auto targets = operating_targets(5);
  for (const auto& [fault, part] :
       {std::pair{1, "rigid motion"}, std::pair{2, "same bits"}, std::pair{3, "predicted_error is the distance"},
        std::pair{4, "predicted orientation"}, std::pair{5, "gate within [0, 1]"}, std::pair{6, "predicted position"},
        std::pair{7, "finite"}}) {
    Dishonest arm(actual_arm(), nominal);
    arm.fault = fault;
    const auto violations = vernier::testing::compensator_violations(arm, targets);
    EXPECT_TRUE(mentions(violations, part)) << "fault " << fault << " went unnoticed";
  }
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(Dishonest(actual_arm(), nominal), targets)));
  EXPECT_THROW((void)vernier::testing::compensator_violations(Dishonest(actual_arm(), nominal), JointRows<6>(0, 6)),
               std::invalid_argument);
}

TEST(Compensated, AKnownArmLandsOnTheNominalPose) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto actual = actual_arm(seed);
    const Geometry arm(actual, nominal);
    const auto targets = operating_targets(200, seed);
    const auto before = positioning_errors(actual, nominal, targets, targets);
    const auto after = positioning_errors(actual, nominal, corrected_commands(arm, targets), targets);
    EXPECT_GT(before.position.minCoeff(), 1e-5);
    EXPECT_GT(before.position.mean(), 1e-3);
    EXPECT_LE(after.position.maxCoeff(), 1e-6);
    EXPECT_LE(after.rotation.maxCoeff(), 1e-6);
    for (Index i = 0; i < targets.rows(); ++i) {
      const JointVector<6> q = configuration(targets, i);
      const auto correction = arm.correct(q);
      EXPECT_EQ(correction.status, IkStatus::converged);
      EXPECT_EQ(correction.gate, 1);                    // nothing learned, nothing gated
      EXPECT_LT((correction.command - q).norm(), 0.2);  // the branch of the target
    }
  }
}

TEST(Compensated, APerfectArmIsCommandedAsItIs) {
  const Geometry arm(nominal, nominal);
  const auto targets = operating_targets(20);
  EXPECT_TRUE(corrected_commands(arm, targets) == targets);
}

TEST(Compensated, ReachesAPoseAskedFor) {
  const Geometry arm(actual_arm(), nominal);
  const JointVector<6> q = configuration(operating_targets(1), 0);
  const Isometry3 pose = nominal.pose(q);
  const auto correction = arm.correct(pose, q + JointVector<6>::Constant(0.1));
  EXPECT_EQ(correction.status, IkStatus::converged);
  const Vector6 left = pose_difference(pose, arm.predict(correction.command));
  EXPECT_LE(linear_part(left).norm(), 1e-6);
  EXPECT_LE(angular_part(left).norm(), 1e-6);
}

TEST(Compensated, ATargetOutOfReachSaysSo) {
  const Geometry arm(actual_arm(), nominal);
  Isometry3 far = nominal.pose(JointVector<6>::Constant(0.3));
  far = rigid_motion(rotation(far), Vector3(3, 0, 0.5));
  const auto correction = arm.correct(far, JointVector<6>::Constant(0.3));
  EXPECT_NE(correction.status, IkStatus::converged);
  EXPECT_TRUE(correction.command.allFinite());
  EXPECT_NEAR(correction.predicted_error, (arm.position(correction.command) - translation(far)).norm(), 1e-12);
  EXPECT_GT(correction.predicted_error, 1);
}

TEST(Compensated, PositionModeMovesThreeJointsAndLeavesTheOthers) {
  const auto actual = actual_arm();
  const Geometry arm(actual, nominal, {.target = CorrectionTarget::position, .moving_joints = 3});
  const auto targets = operating_targets(200);
  const auto commands = corrected_commands(arm, targets);
  EXPECT_TRUE(commands.rightCols<3>() == targets.rightCols<3>());  // bit for bit
  EXPECT_FALSE(commands.leftCols<3>() == targets.leftCols<3>());
  const auto after = positioning_errors(actual, nominal, commands, targets);
  EXPECT_LE(after.position.maxCoeff(), 1e-6);
  EXPECT_GT(after.rotation.mean(), 1e-3);  // the price of the paper's mode: orientation falls as it may
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(arm, targets, {.rotation_tolerance = infinity})));
}

TEST(Compensated, FewerThanSixJointsAimAtThePosition) {
  using namespace vernier::literals;
  const DhChain<3> drawn{{{{.alpha = 90_deg, .d = 300_mm}, {.a = 250_mm}, {.a = 200_mm}}}};
  const auto actual = with_geometric_errors(drawn, {}, 4);
  const Compensated arm(actual, drawn);
  Rng rng(6);
  JointRows<3> targets(50, 3);
  for (Index i = 0; i < 50; ++i) targets.row(i) << rng.uniform(-2, 2), rng.uniform(0.2, 1.2), rng.uniform(-1.5, -0.4);
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(arm, targets, {.rotation_tolerance = infinity})));
  EXPECT_LE(positioning_errors(actual, drawn, corrected_commands(arm, targets), targets).position.maxCoeff(), 1e-6);
}

TEST(Compensated, StaysWithinLimits) {
  JointLimits<6> limits = abb_irb120_operating_region().limits;
  const Geometry arm(actual_arm(), nominal);
  const Geometry limited = arm.within(limits);
  auto targets = operating_targets(100);
  // targets on the very edge, where corrections point outside about half of the time
  for (Index i = 0; i < targets.rows(); ++i)
    targets(i, i % 6) = (i / 6) % 2 == 0 ? limits.lower(i % 6) : limits.upper(i % 6);
  int outside = 0, held = 0;
  for (Index i = 0; i < targets.rows(); ++i) {
    const JointVector<6> q = configuration(targets, i);
    const auto free = arm.correct(q), kept = limited.correct(q);
    EXPECT_EQ(free.status, IkStatus::converged);
    EXPECT_TRUE(limits.contains(kept.command)) << i;
    if (limits.contains(free.command)) {
      EXPECT_LE((kept.command - free.command).norm(), 1e-3);
    } else {
      ++outside;
      held += kept.status != IkStatus::converged;
    }
    EXPECT_LE(kept.predicted_error, 0.02);  // the best there is within the limits, not given up
  }
  EXPECT_GT(outside, 20);
  EXPECT_GT(held, 10);
}

TEST(Compensated, TheReferenceIsTheNominalArmInTheIdentifiedFrames) {
  const auto actual = actual_arm();
  const Isometry3 base = rigid_motion(exp_so3(Vector3(0.1, 0.2, 1.0)), Vector3(1, -2, 0.5)),
                  tool = rigid_motion(Matrix3::Identity(), Vector3(0.01, 0.02, 0.12));
  const Calibrated<DhChain<6>> calibrated(Framed<DhChain<6>>(actual, base, tool), nominal);
  const auto arm = compensate(calibrated);
  const auto targets = operating_targets(50);
  for (Index i = 0; i < targets.rows(); ++i) {
    const JointVector<6> q = configuration(targets, i);
    const Isometry3 wanted = composed(base, composed(nominal.pose(q), tool));
    const Isometry3 reached = composed(base, composed(actual.pose(arm.correct(q).command), tool));
    const Vector6 left = pose_difference(wanted, reached);
    EXPECT_LE(linear_part(left).norm(), 1e-6);
    EXPECT_LE(angular_part(left).norm(), 1e-6);
  }
  EXPECT_TRUE(no_violations(vernier::testing::compensator_violations(arm, targets)));
}

/// What inverse kinematics minimises: squared metres, a radian counting as 0.3 m.
double cost(const Isometry3& target, const Isometry3& pose) {
  const Vector6 e = pose_difference(target, pose);
  return linear_part(e).squaredNorm() + 0.09 * angular_part(e).squaredNorm();
}

TEST(Compensated, NoPoseIsThrownAwayNearSingularities) {
  auto targets = sample_joints(robot.limits, 1500, 8);
  for (Index i = 0; i < 300; ++i) {
    if (i % 3 == 0) targets(i, 4) = 0;                             // wrist, exactly
    if (i % 3 == 1) targets(i, 4) = 1e-5 * (i % 2 == 0 ? 1 : -1);  // wrist, nearly
    if (i % 3 == 2) targets(i, 2) = -std::numbers::pi / 2 + std::atan2(70.0, 302.0) + 1e-7 * static_cast<double>(i);
  }
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Geometry arm(actual_arm(seed), nominal);
    const Geometry limited = arm.within(robot.limits);
    int converged = 0;
    double worst_uncorrected = 0, worst = 0;
    for (Index i = 0; i < targets.rows(); ++i) {
      const JointVector<6> q = configuration(targets, i);
      const Isometry3 wanted = nominal.pose(q);
      const Vector6 before = pose_difference(wanted, arm.pose(q));
      for (const Geometry* which : {&arm, &limited}) {
        const auto correction = which->correct(q);
        ASSERT_TRUE(correction.command.allFinite());
        const Vector6 after = pose_difference(wanted, arm.pose(correction.command));
        // position and orientation together never get worse, so the position by 0.3 m times the rotation at most
        EXPECT_LE(cost(wanted, arm.pose(correction.command)), cost(wanted, arm.pose(q)) * (1 + 1e-12));
        EXPECT_LE(linear_part(after).norm(), linear_part(before).norm() + 0.3 * angular_part(before).norm() + 1e-12);
        worst = vernier_test::larger(worst, linear_part(after).norm());
        if (which == &arm) converged += correction.status == IkStatus::converged;
      }
      EXPECT_TRUE(robot.limits.contains(limited.correct(q).command));
      worst_uncorrected = std::max(worst_uncorrected, linear_part(before).norm());
    }
    // what is not reached lies beyond the stretched elbow of an arm with shorter links
    EXPECT_GE(converged, 1100) << "of 1500";
    EXPECT_LE(worst, worst_uncorrected);
  }
}

TEST(Compensated, DoesNotAllocateOrThrow) {
  const Geometry arm = Geometry(actual_arm(), nominal).within(robot.limits);
  const JointVector<6> q = configuration(operating_targets(1), 0);
  const Isometry3 pose = nominal.pose(q);
  static_assert(noexcept(arm.correct(q))&& noexcept(arm.correct(pose, q))&& noexcept(arm.predict(q)));
  EXPECT_EQ(vernier_test::allocations([&] {
              vernier_test::keep(arm.correct(q));
              vernier_test::keep(arm.correct(pose, q));
              vernier_test::keep(arm.predict(q));
              vernier_test::keep(arm.pose_and_jacobian(q));
            }),
            0);
  // nor on values that are no numbers
  const JointVector<6> bad = JointVector<6>::Constant(std::nan(""));
  EXPECT_NE(arm.correct(bad).status, IkStatus::converged);
}

// Within its tolerances a command stays as it is; each of them counts, and a model is evaluated no more than allowed.
TEST(CorrectionOptions, TolerancesEndTheSearch) {
  const JointVector<6> q = configuration(operating_targets(1), 0);
  const auto corrected = [&](const CorrectionOptions& options) {
    return Geometry(actual_arm(), nominal, options).correct(q);
  };
  const auto loose = corrected({.position_tolerance = 0.05, .rotation_tolerance = 0.05});
  EXPECT_EQ(loose.status, IkStatus::converged);
  EXPECT_TRUE(loose.command == q);
  EXPECT_FALSE(corrected({.position_tolerance = 1e-6, .rotation_tolerance = 0.05}).command == q);
  EXPECT_FALSE(corrected({.position_tolerance = 0.05, .rotation_tolerance = 1e-6}).command == q);
  const auto once = corrected({.max_iterations = 1});
  EXPECT_EQ(once.status, IkStatus::stalled);
  EXPECT_TRUE(once.command == q);
}

TEST(CorrectionOptions, UnusableValuesAreNamed) {
  const auto complaint = [](const CorrectionOptions& options) {
    return vernier_test::complaint([&] { (void)Geometry(nominal, nominal, options); });
  };
  EXPECT_NE(complaint({.moving_joints = 7}).find("moving_joints is 7, must lie in 0..6"), std::string::npos);
  EXPECT_NE(complaint({.moving_joints = -1}).find("-1"), std::string::npos);
  EXPECT_NE(complaint({.position_tolerance = 0}).find("tolerances 0 m"), std::string::npos);
  EXPECT_NE(complaint({.rotation_tolerance = -1}).find("-1 rad"), std::string::npos);
  EXPECT_NE(complaint({.rotation_tolerance = 0}).find("0 rad must be positive"), std::string::npos);
  EXPECT_NE(complaint({.position_tolerance = std::nan("")}).find("nan"), std::string::npos);
  EXPECT_NE(complaint({.max_iterations = 0}).find("max_iterations is 0"), std::string::npos);
  EXPECT_EQ(complaint({.moving_joints = 6}), "");
  EXPECT_EQ(complaint({.max_iterations = 1}), "");
}

}  // namespace
}  // namespace compensated_test
