// SPDX-License-Identifier: BSD-3-Clause
// Corrected commands of whole paths: branches, turns, lines, and what cannot be met.

#include "vernier/compensation/correct_path.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/error_model.hpp"
#include "vernier/kinematics/general_six_axis.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/virtual_robot.hpp"
#include "vernier/testing/path_laws.hpp"

namespace vernier::correct_path_test {
namespace {

using Model = ErrorModel<DhChain<6>>;
constexpr double pi = std::numbers::pi;
const Robot<6> robot = robots::ur10();
const ClosedForm<6> closed_form(robot.chain);
const JointVector<6> home{0.3, -1.2, 1.4, -0.9, 1.0, 0.2};

/// An arm off by half a millimetre and a few milliradians, with transmission errors, and hysteresis where asked.
Model arm_off(std::uint64_t seed, double hysteresis = 0) {
  JointTerms terms(6);
  for (Fourier& of_joint : terms.transmission) of_joint = Fourier::up_to(4);
  if (hysteresis > 0) terms.hysteresis = {0.02};
  VectorX coefficients(terms.size());
  Rng rng(seed);
  for (double& c : coefficients) c = 1e-4 * rng.normal();
  if (hysteresis > 0) {
    for (int j = 1; j <= 6; ++j) coefficients(coefficients.size() - j) = hysteresis;
  }
  return Model(robot.chain,
               Model::Arm({with_geometric_errors(robot.chain, {}, seed), JointErrors(terms, coefficients)}));
}

Isometry3 moved(const Isometry3& pose, const Vector3& by) {
  return rigid_motion(rotation(pose), translation(pose) + by);
}

/// A rectangle of 200 mm in the air, its sides linear moves.
std::vector<PathTarget<6>> rectangle(const Model& arm) {
  const Isometry3 corner = arm.nominal().pose(home);
  std::vector<PathTarget<6>> out{{.pose = corner}};
  for (const Vector3& by : {Vector3(0.2, 0, 0), Vector3(0.2, 0.2, 0), Vector3(0, 0.2, 0.05), Vector3(0, 0, 0)})
    out.push_back({.pose = moved(corner, by), .motion = Motion::linear});
  return out;
}

const auto correct = [](const auto& arm, const auto& targets, const auto& options) {
  return correct_path(arm, closed_form, targets, options);
};

TEST(CorrectPath, ObeysTheLawsOfPaths) {
  PathOptions<6> options{.limits = robot.limits};
  options.start = home;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Model arm = arm_off(seed);
    for (const auto& violation : ::vernier::testing::path_violations(correct, arm, rectangle(arm), options))
      ADD_FAILURE() << violation;
    const Model lagging = arm_off(seed, 2e-5);
    for (const auto& violation : ::vernier::testing::path_violations(correct, lagging, rectangle(lagging), options,
                                                                     {.line_slack = 1.5, .reversible = false}))
      ADD_FAILURE() << "with hysteresis: " << violation;
  }
}

TEST(CorrectPath, LawsCatchPlantedFaults) {
  const Model arm = arm_off(1);
  PathOptions<6> options{.limits = robot.limits};
  options.start = home;
  const auto broken = [&](const auto& spoil) {
    const auto solver = [&](const auto& model, const auto& targets, const auto& asked) {
      auto path = correct_path(model, closed_form, targets, asked);
      spoil(path);
      return path;
    };
    std::string all;
    for (const auto& violation : ::vernier::testing::path_violations(solver, arm, rectangle(arm), options))
      all += violation + "; ";
    return all;
  };
  EXPECT_EQ(broken([](auto&) {}), "");
  const std::string flipped = broken([&](auto& path) {  // another branch from the middle on
    for (std::size_t i = path.points.size() / 2; i < path.points.size(); ++i) {
      const auto others = all_branches(closed_form, arm, arm.pose(path.points[i].command));
      for (const auto& other : others)
        if (other.singularities.branch() != path.points[i].singularities.branch())
          path.points[i].command = other.joints;
    }
  });
  EXPECT_NE(flipped.find("a joint leaps"), std::string::npos) << flipped;
  const std::string ends =
      broken([](auto& path) { std::erase_if(path.points, [](const auto& point) { return point.inserted; }); });
  EXPECT_NE(ends.find("leaves its line"), std::string::npos) << ends;
  const std::string missed = broken([](auto& path) { path.points.back().command(0) += 1e-4; });
  EXPECT_NE(missed.find("is missed"), std::string::npos) << missed;
  const std::string dropped = broken([](auto& path) { path.points.pop_back(); });
  EXPECT_NE(dropped.find("targets have a point"), std::string::npos) << dropped;
  int calls = 0;
  const std::string another = broken([&](auto& path) {
    if (++calls == 3) path.points.front().command(5) += 1e-5;
  });
  EXPECT_NE(another.find("the way back"), std::string::npos) << another;
}

TEST(CorrectPath, EachCommandIsForTheApproachFromTheOneBefore) {
  const Model arm = arm_off(3, 3e-4);
  std::vector<PathTarget<6>> targets;
  Rng rng(2);
  for (int i = 0; i < 20; ++i) {
    JointVector<6> q = home;
    for (double& value : q) value += rng.uniform(-0.4, 0.4);
    targets.push_back({.pose = arm.nominal().pose(q)});
  }
  PathOptions<6> options{.limits = robot.limits};
  options.start = home;
  const auto path = correct_path(arm, closed_form, targets, options);
  options.approach = false;
  const auto middle = correct_path(arm, closed_form, targets, options);
  ASSERT_EQ(path.count(PointStatus::met), 20);
  for (std::size_t i = 1; i < 20; ++i) {
    const auto missed = [&](const auto& of) {
      return (arm.approached_from(of.points[i - 1].command).position(of.points[i].command) -
              translation(targets[i].pose))
          .norm();
    };
    EXPECT_LT(missed(path), 1e-7);
    EXPECT_GT(missed(middle), 1e-6);
  }
}

TEST(CorrectPath, AnObserverEndsAPath) {
  const Model arm = arm_off(1);
  PathOptions<6> options{.limits = robot.limits};
  options.start = home;
  const auto whole = correct_path(arm, closed_form, rectangle(arm), options);
  Index looked_at = 0, commands = 0;
  const auto until = [&](const Progress& progress) {
    looked_at = progress.evaluations;
    commands = progress.generation;
    return commands < 2;
  };
  options.observer = until;
  const auto stopped = correct_path(arm, closed_form, rectangle(arm), options);
  EXPECT_EQ(looked_at, 5);
  EXPECT_EQ(commands, 2);
  ASSERT_LT(stopped.points.size(), whole.points.size());
  EXPECT_EQ(stopped.points.back().target, 1);
  EXPECT_EQ(stopped.points.back().command, whole.points[stopped.points.size() - 1].command);
  const auto at_once = [](const Progress&) { return false; };
  options.observer = at_once;
  EXPECT_TRUE(correct_path(arm, closed_form, rectangle(arm), options).points.empty());
}

TEST(CorrectPath, ALineThroughAWristSingularityIsAJump) {
  const Model arm = arm_off(1);
  JointVector<6> near = home, far = home;
  near(4) = -0.15;
  far(4) = 0.15;  // joint 5 changes its sign between them
  Isometry3 a = arm.nominal().pose(near), b = arm.nominal().pose(far);
  PathOptions<6> options{.limits = robot.limits};
  const auto path = correct_path(
      arm, closed_form, {{.pose = a, .joints = near}, {.pose = b, .joints = far, .motion = Motion::linear}}, options);
  ASSERT_EQ(path.points.size(), 2u);
  EXPECT_EQ(path.points[0].status, PointStatus::met);
  EXPECT_EQ(path.points[1].status, PointStatus::jump);
  EXPECT_EQ(path.first_failure(), &path.points[1]);
  EXPECT_LT(path.points[1].position_error, 1e-7);  // it is met all the same
  const auto joint = correct_path(arm, closed_form, {{.pose = a, .joints = near}, {.pose = b, .joints = far}}, options);
  EXPECT_EQ(joint.first_failure(), nullptr);
}

TEST(CorrectPath, ChoosesTheShortestWayOverAllTargets) {
  const Model arm = arm_off(2);
  // From a start near another branch, the first target is met on the branch on which the others are near, too.
  std::vector<PathTarget<6>> targets;
  for (int i = 0; i < 6; ++i) {
    JointVector<6> q = home;
    q(0) += 0.2 * i;
    targets.push_back({.pose = arm.nominal().pose(q)});
  }
  PathOptions<6> options{.limits = robot.limits};
  for (const auto& branch :
       all_branches(closed_form, arm, targets.front().pose, {.limits = robot.limits, .close_to = home})) {
    options.start = branch.joints;
    const auto path = correct_path(arm, closed_form, targets, options);
    ASSERT_EQ(path.first_failure(), nullptr);
    for (const auto& point : path.points) {
      EXPECT_EQ(point.singularities.branch(), branch.singularities.branch());
      EXPECT_LT(vernier_test::difference(point.command, branch.joints), 1.5);
    }
  }
}

TEST(CorrectPath, WholeTurnsFitAllMovesToCome) {
  const Model arm = arm_off(2);
  // joint 6 turns by 1.5 turns; from +1 rad it would leave its limits of one turn
  std::vector<PathTarget<6>> targets;
  for (int i = 0; i <= 15; ++i) {
    JointVector<6> q = home;
    q(5) = 1 + 0.1 * 2 * pi * i;
    targets.push_back({.pose = arm.nominal().pose(q), .motion = i == 0 ? Motion::joint : Motion::linear});
  }
  PathOptions<6> options{.limits = robot.limits};
  options.max_joint_step = 0.7;
  options.start = home;
  options.start(5) = 1;
  const auto path = correct_path(arm, closed_form, targets, options);
  EXPECT_EQ(path.first_failure(), nullptr) << static_cast<int>(path.first_failure()->status);
  EXPECT_NEAR(path.points.front().command(5), 1 - 2 * pi, 0.05);
  for (const auto& point : path.points) EXPECT_TRUE(options.limits.contains(point.command));
}

TEST(CorrectPath, SaysWhatCannotBeMet) {
  const Model arm = arm_off(4);
  const Isometry3 good = arm.nominal().pose(home);
  Isometry3 far = moved(good, Vector3(10, 0, 0)), nan = good, mirrored = good;
  nan(0, 3) = std::numeric_limits<double>::quiet_NaN();
  for (int r = 0; r < 3; ++r) mirrored(r, 0) *= -1;
  PathOptions<6> options{.limits = robot.limits};
  const auto path = correct_path(
      arm, closed_form,
      {{.pose = good}, {.pose = far}, {.pose = nan}, {.pose = mirrored}, {.pose = good, .motion = Motion::linear}},
      options);
  ASSERT_EQ(path.points.size(), 5u);
  EXPECT_EQ(path.points[0].status, PointStatus::met);
  EXPECT_EQ(path.points[1].status, PointStatus::proven_out);
  EXPECT_FALSE(path.points[1].command.allFinite());
  EXPECT_EQ(path.points[2].status, PointStatus::invalid_target);
  EXPECT_EQ(path.points[3].status, PointStatus::invalid_target);
  EXPECT_EQ(path.points[4].status, PointStatus::jump);  // its line begins at a target that was not met
  EXPECT_EQ(correct_path(robot.chain, closed_form, {{.pose = far}}).points[0].status, PointStatus::proven_out);

  options.limits.lower = home + JointVector<6>::Constant(0.5);
  options.limits.upper = home + JointVector<6>::Constant(0.6);
  EXPECT_EQ(correct_path(arm, closed_form, {{.pose = good}}, options).points[0].status, PointStatus::beyond_limits);
  EXPECT_TRUE(correct_path(arm, closed_form, std::vector<PathTarget<6>>{}).points.empty());
}

TEST(CorrectPath, WithoutClosedFormItFollowsTheBranchOfTheStart) {
  const Model arm = arm_off(1);
  PathOptions<6> options{.limits = robot.limits};
  options.start = home;
  const auto followed = correct_path(arm, rectangle(arm), options);
  const auto chosen = correct_path(arm, closed_form, rectangle(arm), options);
  const auto general = correct_path(arm, GeneralSixAxis(robot.chain), rectangle(arm), options);
  ASSERT_EQ(followed.points.size(), chosen.points.size());
  ASSERT_EQ(general.points.size(), chosen.points.size());
  for (std::size_t i = 0; i < chosen.points.size(); ++i) {
    EXPECT_LT((followed.points[i].command - chosen.points[i].command).norm(), 1e-6);
    EXPECT_LT((general.points[i].command - chosen.points[i].command).norm(), 1e-6);
  }
  const auto wam = robots::barrett_wam();  // seven joints: Newton's method from the start
  const JointVector<7> q{0.2, 0.5, 0.1, 1.5, 0.3, 0.4, 0.2};
  PathOptions<7> seven{.limits = wam.limits};
  seven.start = q;
  const Isometry3 a = wam.chain.pose(q);
  const auto path = correct_path(
      wam.chain, {{.pose = a}, {.pose = moved(a, Vector3(0, 0.05, -0.05)), .motion = Motion::linear}}, seven);
  EXPECT_EQ(path.first_failure(), nullptr);
}

// More joints than a position has equations: the ends say how the others turn on the way.
TEST(CorrectPath, AScaraTurnsItsToolAlongALine) {
  const auto row = [](double a, double alpha, JointType type) { return DhRow{.a = a, .alpha = alpha, .joint = type}; };
  const auto scara = DhChain<4>::from_rows({row(0.35, 0, JointType::revolute), row(0.25, pi, JointType::revolute),
                                            row(0, 0, JointType::prismatic), row(0, 0, JointType::revolute)});
  using Scara = ErrorModel<DhChain<4>>;
  const Scara arm(scara, Scara::Arm({with_geometric_errors(scara, {}, 3), JointErrors()}));
  const JointVector<4> from{0.4, 0.9, 0.1, -1.2};
  for (const double turn : {0.05, 0.4, 2.5}) {
    const JointVector<4> to{0.65, 0.7, 0.12, -1.2 + turn};
    std::vector<PathTarget<4>> targets;
    for (const JointVector<4>& q : {from, to, from})
      targets.push_back(
          {.pose = arm.nominal().pose(q), .joints = q, .motion = targets.empty() ? Motion::joint : Motion::linear});
    const CorrectedPath<4> path = correct_path(arm, targets);
    double before = path.points.front().command(3);
    for (const auto& point : path.points) {
      EXPECT_EQ(point.status, PointStatus::met) << turn;
      EXPECT_LE(point.deviation, 0.05e-3);
      EXPECT_LE(std::abs(point.command(3) - before), 0.5);  // evenly, not all of it at the end
      before = point.command(3);
      const double asked = targets[static_cast<std::size_t>(point.target)].joints(3);
      EXPECT_TRUE(point.inserted || std::abs(point.command(3) - asked) < 0.02) << turn;
    }
  }
}

// Near a stretched elbow a command is far from the joint values it corrects; the line is as straight as any other.
TEST(CorrectPath, LinesNearASingularityStayLines) {
  std::vector<DhRow> rows;  // an arm whose links are longer must bend its elbow more
  for (int i = 0; i < 6; ++i) {
    rows.push_back(robot.chain.row(i));
    rows.back().a *= 1.004;
  }
  const Model arm(
      robot.chain,
      Model::Arm({DhChain<6>::from_rows({rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]}), JointErrors()}));
  const auto line = [&](double elbow, double end) {
    const JointVector<6> from{0.3, -1.2, elbow, -0.9, 1.0, 0.2}, to{0.6, -1.2, end, -0.7, 1.1, 0.6};
    std::vector<PathTarget<6>> targets;
    for (const JointVector<6>& q : {from, to})
      targets.push_back(
          {.pose = arm.nominal().pose(q), .joints = q, .motion = targets.empty() ? Motion::joint : Motion::linear});
    return correct_path(arm, closed_form, targets, {.limits = robot.limits});
  };
  double farthest = 0;
  for (const double elbow : {0.02, 0.05, 0.1, 0.2}) {
    const CorrectedPath<6> path = line(elbow, elbow + 0.03);
    farthest = (std::max)(farthest, std::abs(path.points.front().command(2) - elbow));
    for (const auto& point : path.points) EXPECT_EQ(point.status, PointStatus::met) << elbow << ' ' << point.command;
  }
  EXPECT_GT(farthest, 0.1);
  EXPECT_EQ(line(0.2, -0.2).points.back().status, PointStatus::jump);  // through it, on another branch
}

}  // namespace
}  // namespace vernier::correct_path_test
