// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics: near seeds, limits, targets out of reach, singular starts, positions alone, joints held still.

#include "vernier/kinematics/inverse_kinematics.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::random_joints;
using vernier_test::RealMatrix;

namespace inverse_kinematics_test {
namespace {

constexpr double pi = std::numbers::pi;

/// The error that the solver makes least, in metres.
template <int N>
double weighted_error(const vn::IkResult<N>& result) {
  return std::hypot(result.position_error, vn::IkOptions<N>{}.rotation_length * result.rotation_error);
}

/// What the result says is left must be what is left.
template <class Model>
void expect_honest(const Model& model, const vn::Isometry3& target, const vn::IkResult<Model::dof>& result,
                   const vn::IkOptions<Model::dof>& options, bool full_pose) {
  const vn::Vector6 left = vn::pose_difference(target, model.pose(result.joints));
  EXPECT_NEAR(vn::Vector3(left(0), left(1), left(2)).norm(), result.position_error, 1e-14);
  if (full_pose) {
    EXPECT_NEAR(vn::Vector3(left(3), left(4), left(5)).norm(), result.rotation_error, 1e-14);
  } else {
    EXPECT_EQ(result.rotation_error, 0);
  }
  const bool within_tolerances =
      result.position_error <= options.position_tolerance && result.rotation_error <= options.rotation_tolerance;
  EXPECT_EQ(result.status == vn::IkStatus::converged, within_tolerances);
  EXPECT_TRUE(options.limits.contains(result.joints));
  EXPECT_LE(result.iterations, options.max_iterations);
}

/// 2000 poses within the limits, seeds within 0.05 rad of a solution in each joint.
template <int N, class Convention>
void expect_convergence(const vn::Robot<N, Convention>& robot, bool full_pose) {
  SCOPED_TRACE(vn::message(robot.name, full_pose ? ", poses" : ", positions"));
  constexpr int n = 2000;
  vn::Rng rng(41);
  vn::IkOptions<N> options;
  options.limits = robot.limits;
  int converged = 0;
  long evaluations = 0;
  for (int i = 0; i < n; ++i) {
    const vn::JointVector<N> q = random_joints<N>(rng, robot.limits);
    const vn::JointVector<N> seed = q + random_joints<N>(rng, 0.05);
    const vn::Isometry3 target = robot.chain.pose(q);
    const auto result = full_pose ? inverse_kinematics(robot.chain, target, seed, options)
                                  : inverse_kinematics(robot.chain, vn::Vector3(target.translation()), seed, options);
    expect_honest(robot.chain, target, result, options, full_pose);
    converged += result.status == vn::IkStatus::converged;
    evaluations += result.iterations;
  }
  EXPECT_GE(converged, n * 999 / 1000);
  EXPECT_LE(evaluations, 5 * n) << "about five evaluations from a near seed";
}

template <class Check>
void for_the_catalogue(Check&& check) {
  check(vn::robots::abb_irb120());
  check(vn::robots::ur10());
  check(vn::robots::ur5());
  check(vn::robots::barrett_wam());
  check(vn::robots::puma560());
  check(vn::robots::puma560_modified());
}

TEST(InverseKinematics, ConvergesFromNearSeeds) {
  for_the_catalogue([](const auto& robot) {
    expect_convergence(robot, true);
    expect_convergence(robot, false);
  });
}

TEST(InverseKinematics, ASeedOutsideTheLimitsIsTakenIntoThem) {
  const auto robot = vn::robots::abb_irb120();
  vn::IkOptions<6> options;
  options.limits = robot.limits;
  vn::Rng rng(42);
  for (int i = 0; i < 500; ++i) {
    const vn::Isometry3 target = robot.chain.pose(random_joints<6>(rng, robot.limits));
    const auto result = inverse_kinematics(robot.chain, target, random_joints<6>(rng, 20.0), options);
    expect_honest(robot.chain, target, result, options, true);
  }
}

TEST(InverseKinematics, OutOfReachIsNeverConvergedAndGetsAsNearAsItCan) {
  for_the_catalogue([](const auto& robot) {
    SCOPED_TRACE(robot.name);
    constexpr int N = std::remove_cvref_t<decltype(robot.chain)>::dof;
    double reach = 0;
    for (const vn::DhRow& row : robot.chain.rows()) reach += std::hypot(row.a, row.d);
    vn::IkOptions<N> options;
    options.limits = robot.limits;
    vn::Rng rng(43);
    int unreachable = 0, n = 0;
    for (const double beyond : {1e-4, 1e-2, 1.0}) {
      for (int i = 0; i < 100; ++i, ++n) {
        const vn::JointVector<N> seed = random_joints<N>(rng, robot.limits);
        const vn::Vector3 target = (reach + beyond) * vernier_test::random_direction(rng);
        const vn::Isometry3 pose = vn::rigid_motion(vn::rotation(robot.chain.pose(seed)), target);
        const auto result = inverse_kinematics(robot.chain, target, seed, options);
        EXPECT_NE(result.status, vn::IkStatus::converged);
        EXPECT_GE(result.position_error, beyond - 1e-12);
        EXPECT_LE(result.position_error, (target - robot.chain.position(seed)).norm());
        expect_honest(robot.chain, pose, result, options, false);
        unreachable += result.status == vn::IkStatus::unreachable;

        const auto full = inverse_kinematics(robot.chain, pose, seed, options);
        EXPECT_NE(full.status, vn::IkStatus::converged);
        EXPECT_LE(weighted_error(full), (target - robot.chain.position(seed)).norm() + 1e-12);
        expect_honest(robot.chain, pose, full, options, true);
      }
    }
    EXPECT_GE(unreachable, n * 9 / 10) << "most say why";
  });
}

constexpr vn::DhChain<2> planar{{{{.a = 0.3}, {.a = 0.2}}}};

TEST(InverseKinematics, ReachOfAPlanarArmIsFoundToTheMicrometre) {
  // The boundary is a circle of 0.5 m, where the arm is singular: just inside converges, just outside is unreachable.
  vn::Rng rng(44);
  for (const double beyond : {-1e-2, -1e-4, -1e-6, 1e-6, 1e-4, 1e-2, 1.0}) {
    SCOPED_TRACE(beyond);
    for (int i = 0; i < 200; ++i) {
      const double heading = rng.uniform(-pi, pi);
      const vn::Vector3 target = (0.5 + beyond) * vn::Vector3(std::cos(heading), std::sin(heading), 0);
      const vn::JointVector<2> seed(heading + rng.uniform(-0.5, 0.5), rng.sign() * rng.uniform(0.05, 0.5));
      const auto result = inverse_kinematics(planar, target, seed);
      EXPECT_EQ(result.status, beyond < 0 ? vn::IkStatus::converged : vn::IkStatus::unreachable);
      EXPECT_LE(result.position_error, std::max(beyond, 0.0) + 5e-6);
    }
  }
}

TEST(InverseKinematics, ALimitInTheWayIsUnreachable) {
  vn::IkOptions<2> options;
  options.limits = {{-1, 0.5}, {1, 2}};
  const vn::Vector3 target = planar.position({0.2, 0.1});  // the elbow may not open that far
  const auto result = inverse_kinematics(planar, target, {0.2, 1.0}, options);
  EXPECT_EQ(result.status, vn::IkStatus::unreachable);
  EXPECT_EQ(result.joints(1), 0.5);
  // Joint 1 then turns the tool onto the target's ray, the nearest it can get.
  const vn::Vector3 tool = planar.position(result.joints);
  EXPECT_NEAR(std::atan2(tool.y(), tool.x()), std::atan2(target.y(), target.x()), 1e-3);
}

/// A pose moved in some direction [m], and turned about another as much, weighted.
vn::Isometry3 moved_and_turned(const vn::Isometry3& pose, double size, vn::Rng& rng) {
  const vn::Vector3 place = vn::translation(pose) + size * vernier_test::random_direction(rng);
  const vn::Matrix3 turn = vn::exp_so3(size / 0.3 * vernier_test::random_direction(rng));
  return vn::rigid_motion(turn * vn::rotation(pose), place);
}

/// Targets of all sizes around a singular configuration: never further off than at the start, whenever it is stopped.
void expect_calm(const vn::Robot<6>& robot, const vn::JointVector<6>& singular) {
  SCOPED_TRACE(robot.name);
  ASSERT_LE(std::abs(RealMatrix(robot.chain.jacobian(singular)).determinant()), 1e-15)
      << "the start should be singular";
  vn::Rng rng(45);
  for (int i = 0; i < 1000; ++i) {
    const double size = std::pow(10.0, rng.uniform(-6, -1.5));  // [m]
    const vn::Isometry3 target = moved_and_turned(robot.chain.pose(singular), size, rng);
    for (const int evaluations : {1, 2, 3, 5, 200}) {
      vn::IkOptions<6> options;
      options.max_iterations = evaluations;
      const auto result = inverse_kinematics(robot.chain, target, singular, options);
      expect_honest(robot.chain, target, result, options, true);
      EXPECT_LE(weighted_error(result), std::sqrt(2.0) * size * (1 + 1e-9));
      EXPECT_LE((robot.chain.position(result.joints) - robot.chain.position(singular)).norm(),
                (1 + std::sqrt(2.0)) * size * (1 + 1e-9));
      EXPECT_LE(vernier_test::difference(result.joints, singular), pi) << "no joint winds up";
    }
  }
}

vn::JointVector<6> joints(double q1, double q2, double q3, double q4, double q5, double q6) {
  return vn::JointVector<6>{q1, q2, q3, q4, q5, q6};
}

TEST(InverseKinematics, ASingularStartNeverThrowsThePoseAway) {
  expect_calm(vn::robots::puma560(), joints(0.3, 0.5, -0.4, 0.2, 0, 0.1));     // wrist
  expect_calm(vn::robots::abb_irb120(), joints(0.3, 0.5, -0.4, 0.2, 0, 0.1));  // wrist
  expect_calm(vn::robots::ur5(), joints(0.3, -0.5, 0, 0.2, 0.7, 0.1));         // elbow
  expect_calm(vn::robots::ur10(), joints(0, 0, 0, 0, 0, 0));                   // elbow and wrist
}

TEST(InverseKinematics, LeavesASingularWrist) {
  // A wrist with q5 = 0 can take any small change of pose, by large motions of q4 and q6.
  vn::Rng rng(46);
  for (const auto& robot : {vn::robots::puma560(), vn::robots::abb_irb120()}) {
    const vn::JointVector<6> singular = joints(0.3, 0.5, -0.4, 0.2, 0, 0.1);
    for (int i = 0; i < 1000; ++i) {
      const double size = std::pow(10.0, rng.uniform(-6, -2));
      const vn::Isometry3 target = moved_and_turned(robot.chain.pose(singular), size, rng);
      const auto result = inverse_kinematics(robot.chain, target, singular);
      ASSERT_EQ(result.status, vn::IkStatus::converged) << robot.name << ", " << size << " m";
    }
  }
}

TEST(InverseKinematics, PositionAloneLeavesTheOrientationFree) {
  const auto robot = vn::robots::abb_irb120();
  vn::Rng rng(47);
  int turned = 0;
  for (int i = 0; i < 200; ++i) {
    const vn::JointVector<6> q = 0.3 * random_joints<6>(rng, 1.0);
    const vn::JointVector<6> seed = q + random_joints<6>(rng, 0.2);
    const auto result = inverse_kinematics(robot.chain, robot.chain.position(q), seed);
    EXPECT_EQ(result.status, vn::IkStatus::converged);
    EXPECT_LE((robot.chain.position(result.joints) - robot.chain.position(q)).norm(), 1e-9);
    EXPECT_EQ(result.rotation_error, 0);
    const vn::Matrix3 wanted = vn::rotation(robot.chain.pose(q)), found = vn::rotation(robot.chain.pose(result.joints));
    turned += vn::rotation_difference(wanted, found).norm() > 1e-3;
  }
  EXPECT_GE(turned, 190);
}

TEST(InverseKinematics, JointsThatDoNotMoveKeepTheirBits) {
  const auto robot = vn::robots::abb_irb120();
  vn::IkOptions<6> options;
  options.limits = robot.limits;
  vn::Rng rng(48);
  int converged = 0;
  for (int i = 0; i < 500; ++i) {
    vn::JointVector<6> seed = random_joints<6>(rng, 1.0);
    seed(4) = 0.3 + std::abs(seed(4));
    seed(3) = 7.123;  // outside its limits: it does not move all the same
    vn::JointVector<6> q = seed;
    const vn::JointVector<3> step = random_joints<3>(rng, 0.02);
    for (int j = 0; j < 3; ++j) q(j) += step(j);
    options.moving_joints = 3;
    const auto result = inverse_kinematics(robot.chain, robot.chain.position(q), seed, options);
    for (int j = 3; j < 6; ++j) EXPECT_EQ(result.joints(j), seed(j));
    converged += result.status == vn::IkStatus::converged;
    options.moving_joints = 1;
    const auto one = inverse_kinematics(robot.chain, robot.chain.pose(q), seed, options);
    for (int j = 1; j < 6; ++j) EXPECT_EQ(one.joints(j), seed(j));
    EXPECT_NE(one.joints(0), seed(0));
  }
  EXPECT_GE(converged, 499);
}

TEST(InverseKinematics, ARedundantArmStaysNearItsSeed) {
  // Seven joints, six equations: of all solutions the one found is hardly further from the seed than the one drawn.
  const auto robot = vn::robots::barrett_wam();
  const auto distance = [](const vn::JointVector<7>& a, const vn::JointVector<7>& b) {
    return (RealMatrix::of(a) - RealMatrix::of(b)).norm();
  };
  vn::Rng rng(49);
  std::vector<double> ratios;
  for (int i = 0; i < 1000; ++i) {
    const vn::JointVector<7> q = random_joints<7>(rng, robot.limits);
    const vn::JointVector<7> seed = q + random_joints<7>(rng, 0.05);
    const auto result = inverse_kinematics(robot.chain, robot.chain.pose(q), seed);
    if (result.status != vn::IkStatus::converged) continue;
    ratios.push_back(distance(result.joints, seed) / distance(q, seed));
  }
  ASSERT_GE(ratios.size(), 999u);
  std::sort(ratios.begin(), ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 1.0);
  EXPECT_LE(ratios[ratios.size() * 98 / 100], 1.2);

  // A way there and back in small steps, always from the last joints: the elbow comes back too.
  const vn::JointVector<7> start{0.2, 0.6, -0.3, 1.2, 0.1, -0.5, 0.4};
  vn::JointVector<7> q = start;
  for (int step = 1; step <= 400; ++step) {
    vn::Isometry3 target = robot.chain.pose(start);
    target(1, 3) += 0.1 * std::sin(pi * step / 400);
    const auto result = inverse_kinematics(robot.chain, target, q);
    ASSERT_EQ(result.status, vn::IkStatus::converged);
    q = result.joints;
  }
  EXPECT_LE(distance(q, start), 1e-3);
}

// From anywhere: single starts fail now and then, restarts find the pose.
TEST(InverseKinematics, RestartsReachWhatOneStartMisses) {
  const auto robot = vn::robots::abb_irb120();
  vn::Rng rng(5);
  vn::IkOptions<6> once{.limits = robot.limits}, again = once, unbounded;
  again.restarts = 200;  // within the limits a few poses are reached from one start in twenty
  unbounded.restarts = 20;
  int missed = 0;
  for (int i = 0; i < 500; ++i) {
    const vn::JointVector<6> seed = random_joints<6>(rng, robot.limits);
    const vn::Isometry3 target = robot.chain.pose(random_joints<6>(rng, robot.limits));
    const auto first = inverse_kinematics(robot.chain, target, seed, once);
    const auto found = inverse_kinematics(robot.chain, target, seed, again);
    EXPECT_EQ(found.status, vn::IkStatus::converged);
    EXPECT_TRUE(robot.limits.contains(found.joints));
    EXPECT_LT(vn::pose_difference(target, robot.chain.pose(found.joints)).norm(), 2e-9);
    EXPECT_EQ(RealMatrix(found.joints), RealMatrix(inverse_kinematics(robot.chain, target, seed, again).joints));
    EXPECT_EQ(inverse_kinematics(robot.chain, target, seed, unbounded).status, vn::IkStatus::converged);
    if (first.status == vn::IkStatus::converged) {
      EXPECT_EQ(RealMatrix(found.joints), RealMatrix(first.joints));
    } else {
      ++missed;
      EXPECT_GT(found.iterations, first.iterations);
    }
  }
  EXPECT_GT(missed, 5);
  // Out of reach: the nearest of all starts, and honest about it.
  const vn::Isometry3 far = vn::rigid_motion(vn::Matrix3::Identity(), {2, 0, 0.3});
  const vn::JointVector<6> zero = vn::JointVector<6>::Zero();
  const auto first = inverse_kinematics(robot.chain, far, zero, once),
             all = inverse_kinematics(robot.chain, far, zero, again);
  EXPECT_NE(all.status, vn::IkStatus::converged);
  EXPECT_LE(weighted_error(all), weighted_error(first));
}

/// A planar arm that notes where it was evaluated.
struct Noting {
  static constexpr int dof = 2;
  vn::DhChain<2> chain;
  std::vector<vn::JointVector<2>>* visited;
  vn::Isometry3 pose(const vn::JointVector<2>& q) const noexcept { return chain.pose(q); }
  vn::Vector3 position(const vn::JointVector<2>& q) const noexcept { return chain.position(q); }
  vn::Jacobian<2> jacobian(const vn::JointVector<2>& q) const noexcept { return chain.jacobian(q); }
  vn::PoseAndJacobian<2> pose_and_jacobian(const vn::JointVector<2>& q) const noexcept {
    visited->push_back(q);
    return chain.pose_and_jacobian(q);
  }
};

// One evaluation a start shows where the starts lie: half a turn to either side of the seed where a joint has no
// limits, or one alone, and within the limits where it has both.
TEST(InverseKinematics, RestartsLieAboutTheSeedOrWithinTheLimits) {
  std::vector<vn::JointVector<2>> visited;
  const Noting arm{planar, &visited};
  const vn::JointVector<2> seed(20, 0.5);
  vn::IkOptions<2> options{.max_iterations = 1, .restarts = 200};
  options.limits.upper(0) = 30;  // one side alone
  options.limits.lower(1) = 0.2;
  options.limits.upper(1) = 0.6;
  const auto once_each = inverse_kinematics(arm, vn::Vector3(9, 0, 0), seed, options);
  EXPECT_NE(once_each.status, vn::IkStatus::converged);
  EXPECT_EQ(once_each.iterations, 201);
  ASSERT_EQ(visited.size(), 201u);
  EXPECT_EQ(RealMatrix::of(visited[0]), RealMatrix::of(seed));
  double least = 100, most = -100;
  for (std::size_t k = 1; k < visited.size(); ++k) {
    EXPECT_LE(std::abs(visited[k](0) - seed(0)), pi);
    EXPECT_GE(visited[k](1), 0.2);
    EXPECT_LE(visited[k](1), 0.6);
    least = std::min(least, visited[k](0));
    most = std::max(most, visited[k](0));
  }
  EXPECT_LT(least, seed(0) - 0.9 * pi);  // of 200 uniform draws some reach the last twentieth on either side
  EXPECT_GT(most, seed(0) + 0.9 * pi);
}

// No joint values move by more than 1.5 (rad, m) at once, as a vector: on a slide the way is known, and is 4 m.
TEST(InverseKinematics, NoStepIsLongerThanOneAndAHalf) {
  const vn::DhRow slide{.joint = vn::JointType::prismatic};
  const vn::DhChain<1> one({slide});
  const auto first = inverse_kinematics(one, vn::Vector3(0, 0, 4), vn::JointVector<1>::Zero(), {.max_iterations = 2});
  EXPECT_EQ(first.status, vn::IkStatus::stalled);
  EXPECT_NEAR(first.joints(0), 1.5, 1e-15);
  EXPECT_NEAR(first.position_error, 2.5, 1e-15);
  // along z and along -y, 2.4 m and 3.2 m: 0.6 and 0.8 of the step
  const vn::DhChain<2> two({{.alpha = pi / 2, .joint = vn::JointType::prismatic}, slide});
  const auto both =
      inverse_kinematics(two, vn::Vector3(0, -3.2, 2.4), vn::JointVector<2>::Zero(), {.max_iterations = 2});
  EXPECT_NEAR(both.joints(0), 0.6 * 1.5, 1e-12);
  EXPECT_NEAR(both.joints(1), 0.8 * 1.5, 1e-12);
}

TEST(InverseKinematics, IterationsAreEvaluationsOfAllStarts) {
  std::vector<vn::JointVector<2>> visited;
  const Noting arm{planar, &visited};
  for (const double x : {0.5, 9.0})
    for (const int restarts : {0, 3}) {
      visited.clear();
      const auto found = vn::inverse_kinematics(arm, vn::Vector3(x, 0.3, 0), vn::JointVector<2>(0.1, 0.2),
                                                {.max_iterations = 30, .restarts = restarts});
      EXPECT_EQ(found.iterations, static_cast<int>(visited.size())) << x << ' ' << restarts;
    }
}

TEST(InverseKinematics, WhatIsNotANumberStallsAtTheSeed) {
  const vn::JointVector<2> seed(0.1, 0.2);
  const auto result = inverse_kinematics(planar, vn::Vector3(std::nan(""), 0, 0), seed);
  EXPECT_EQ(result.status, vn::IkStatus::stalled);
  EXPECT_EQ(RealMatrix::of(result.joints), RealMatrix::of(seed));
}

TEST(InverseKinematics, AlreadyThereCostsOneEvaluation) {
  const vn::JointVector<2> q(0.4, 0.9);
  const auto result = inverse_kinematics(planar, planar.pose(q), q);
  EXPECT_EQ(result.status, vn::IkStatus::converged);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_EQ(RealMatrix::of(result.joints), RealMatrix::of(q));
}

}  // namespace
}  // namespace inverse_kinematics_test
