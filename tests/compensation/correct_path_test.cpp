// Corrected commands of whole paths: branches, turns, lines, and what cannot be met.

#include "vernier/compensation/correct_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <numbers>

#include "real_matrix.hpp"
#include "vernier/core/points.hpp"
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

// Errors that no fit knows: the arm differs from its model by harmonics of 20 urad.
TEST(CorrectPath, ArmsStayOnTheirLines) {
  const Model model = arm_off(5);
  JointTerms terms = model.identified().model().joint_errors().terms();
  VectorX coefficients = model.identified().model().joint_errors().coefficients();
  Rng rng(9);
  for (double& c : coefficients) c += 2e-5 * rng.normal();
  const Model arm(robot.chain, Model::Arm({model.identified().chain(), JointErrors(terms, coefficients)}));
  PathOptions<6> options{.limits = robot.limits};
  double before = 0, after = 0, apart = 0;
  int lines = 0;
  while (lines < 100) {
    JointVector<6> q;
    for (double& value : q) value = rng.uniform(-2, 2);
    q(2) = rng.uniform(0.5, 2.2);
    const Isometry3 a = model.nominal().pose(q);
    const Isometry3 b = moved(a, 0.2 * Vector3(rng.normal(), rng.normal(), rng.normal()).normalized());
    options.start = q;
    const auto path = correct_path(model, closed_form, {{.pose = a}, {.pose = b, .motion = Motion::linear}}, options);
    if (path.first_failure() != nullptr) continue;  // ends out of reach, or a singularity between them
    ++lines;
    const auto n = static_cast<double>(path.points.size() - 1);
    const auto deviation = [&](const Model& of, std::size_t i, std::size_t k, double s, double e) {
      return ::vernier::testing::detail::deviation_from_line(of, path.points[i].command, path.points[i].command,
                                                             path.points[k].command, interpolated(a, b, s),
                                                             interpolated(a, b, e));
    };
    before = std::max(before, deviation(arm, 0, path.points.size() - 1, 0, 1));
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
      const auto s = static_cast<double>(i);
      after = std::max(after, deviation(arm, i, i + 1, s / n, (s + 1) / n));
      apart = std::max(apart, (arm.position(path.points[i].command) - model.position(path.points[i].command)).norm());
    }
  }
  EXPECT_LE(after, 1.1 * options.tolerance + 1.5 * apart);  // the places where they are apart most lie between
  EXPECT_GT(before, 5 * options.tolerance);
  EXPECT_GT(before, 2 * after);
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
       all_branches(closed_form, arm, targets.front().pose, {.limits = robot.limits, .near = home})) {
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
  options = {};
  options.tolerance = 0;
  EXPECT_THROW(static_cast<void>(correct_path(arm, closed_form, {{.pose = good}}, options)), std::invalid_argument);
  EXPECT_TRUE(correct_path(arm, closed_form, std::vector<PathTarget<6>>{}).points.empty());
}

TEST(CorrectPath, TooFewInsertedPointsLeaveTheLine) {
  const Model arm = arm_off(1);
  PathOptions<6> options{.limits = robot.limits};
  options.tolerance = 1e-6;
  options.rotation_tolerance = 1e-2;
  options.max_inserted = 3;
  options.start = home;
  const auto path = correct_path(arm, closed_form, rectangle(arm), options);
  EXPECT_GT(path.count(PointStatus::off_path), 0);
  EXPECT_GT(path.after, 1e-6);
  EXPECT_LT(path.after, path.before);
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

detail::PathJoints joints_of(std::initializer_list<double> values) {
  detail::PathJoints out(static_cast<Index>(values.size()));
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

/// A tool on two slides that should move along x and y, but goes along an arc: off in y by `bow` in the middle of its
/// way from x = 0 to x = 1. Where a target has another branch, it takes 2 m of the second slide.
struct BowedSlides {
  double bow = 0;
  bool other_branch = false;
  double twist = 0;                            ///< about z, as much there as `bow`
  std::function<double(double)> way = {};      ///< how far it is off at x, in place of an arc
  std::function<int(double)> branch = {};      ///< in which branch it is at x
  std::function<double(double)> cost_at = {};  ///< of being at y
  double reach = 1e3;                          ///< how far from where it begins Newton's method finds the target
  double nominal_reach = 1e3;                  ///< the same of the nominal arm
  double hole = -1e3;                          ///< the x of a target that is not met
  double leap = -1e3;                          ///< the x at which the nominal arm's first slide is off by 2.5
  std::vector<double>* asked = nullptr;        ///< takes the x near which branches are asked for
  double left = 0;                             ///< what remains of errors: positions so much, rotations twice that
  std::vector<double> more = {};               ///< further branches, at x = 0 and these y

  detail::SolvedPath path(const std::vector<detail::PathGoal>& goals, const detail::PathSettings& settings) const {
    using detail::PathJoints;
    const auto off = [&](double x) { return way ? way(x) : 4 * bow * x * (1 - x); };
    const auto id_at = [&](double x) { return branch ? branch(x) : 0; };
    const auto at = [](double x, double y) { return rigid_motion(Matrix3::Identity(), Vector3(x, y, 0)); };
    const auto meet = [&](const Isometry3& target, const PathJoints&, PathJoints& command, double* errors) {
      const Vector3 p = translation(target);
      const bool near = std::abs(command(0) - p.x()) <= reach;
      if (!other_branch && near) command = joints_of({p.x(), p.y() - off(p.x())});
      errors[0] = left;
      errors[1] = 2 * left;
      return near && p.x() != hole;
    };
    const auto branches = [&](const Isometry3& target, const PathJoints& near, std::vector<detail::PathBranch>& out) {
      if (asked != nullptr) asked->push_back(near(0));
      const Vector3 p = translation(target);
      out.push_back({joints_of({p.x(), p.y() - off(p.x())}), id_at(p.x())});
      if (other_branch) out.push_back({joints_of({0, 2}), 1});
      for (const double y : more) out.push_back({joints_of({0, y}), 2});
      return Reach::met;
    };
    const auto pose = [&](const PathJoints& q, const PathJoints&) {
      return rigid_motion(exp_so3(Vector3(0, 0, 4 * twist * q(0) * (1 - q(0)))), Vector3(q(0), q(1) + off(q(0)), 0));
    };
    const auto nominal_pose = [&](const PathJoints& q) { return at(q(0), q(1)); };
    const auto nominal_joints = [&](const Isometry3& target, PathJoints& q) {
      const bool near = std::abs(q(0) - target(0, 3)) <= nominal_reach;
      q = joints_of({target(0, 3) + (target(0, 3) == leap ? 2.5 : 0), target(1, 3)});
      return near;
    };
    const auto cost = [&](const PathJoints& q) { return cost_at ? cost_at(q(1)) : 0.0; };
    const auto branch_id = [&](const PathJoints& q) { return other_branch && q(1) == 2 ? 1 : id_at(q(0)); };
    return detail::solve_path({2, branches, meet, pose, nominal_pose, nominal_joints, cost, branch_id}, goals,
                              settings);
  }
};

/// Settings of two slides; no step is too long.
detail::PathSettings slides_settings(const detail::PathJoints& speed) {
  return {1e-3, 1, 2, 127, joints_of({-3, -3}), joints_of({3, 3}), speed, joints_of({0, 0})};
}

TEST(PathSolverWhiteBox, AJointThatTurnedRoundComesFromTheCommandBeyondATransition) {
  const detail::PathJoints from =
      detail::approach_on_the_way(joints_of({std::nan(""), 0, 0, 0, 0.1, 0}), joints_of({0.1, 0.1, 0.1, 0.1, 0.1, 0.1}),
                                  joints_of({0.3, 0.2, 0.08, 0.02, 0.12, 0.1}));
  EXPECT_EQ(from(0), 0.1);  // nothing is known of its direction
  EXPECT_EQ(from(1), 0);    // goes on
  // 2/5 of the transition of 0.05 rad: 3/5 of it still lag behind, 2/5 of the way back lead
  EXPECT_NEAR(from(2), 0.08 - (0.6 * 0.05 - 0.4 * 0.02), 1e-15);
  EXPECT_NEAR(from(3), 0.1, 1e-15);  // has turned round
  EXPECT_EQ(from(4), 0.1);           // stood still before
  EXPECT_EQ(from(5), 0);             // has not moved since
}

TEST(PathSolverWhiteBox, SpeedsChooseTheBranch) {
  const BowedSlides arm{.other_branch = true};
  const std::vector<detail::PathGoal> goals{{rigid_motion(Matrix3::Identity(), Vector3(1, 0, 0)), {}, Motion::joint}};
  // 1 m of the first slide or 2 m of the second
  const auto second = [&](double speed) {
    return arm.path(goals, slides_settings(joints_of({1, speed}))).points.front().command(1);
  };
  EXPECT_EQ(second(1.9), 0);
  EXPECT_EQ(second(2.1), 2);
}

TEST(PathSolverWhiteBox, DeviationsShrinkWithTheSquareOfAPiece) {
  const BowedSlides arm{.bow = 15.5e-3};  // in units of the tolerance of 1 mm: sqrt(15.5) pieces, rounded up
  const detail::SolvedPath path = arm.path({{rigid_motion(Matrix3::Identity(), Vector3(0, 0, 0)), {}, Motion::joint},
                                            {rigid_motion(Matrix3::Identity(), Vector3(1, 0, 0)), {}, Motion::linear}},
                                           slides_settings(joints_of({1, 1})));
  ASSERT_EQ(path.points.size(), 5u);  // both ends, and three that were inserted
  for (std::size_t k = 1; k < 5; ++k) EXPECT_NEAR(path.points[k].command(0), 0.25 * static_cast<double>(k), 1e-15);
  EXPECT_NEAR(path.points[2].command(1), -15.5e-3, 1e-15);
  EXPECT_NEAR(path.before, 15.5e-3, 1e-12);
  EXPECT_NEAR(path.after, 15.5e-3 / 16, 1e-12);
}

/// A move to x = 0, and lines to other places on the x axis.
std::vector<detail::PathGoal> line_through(std::initializer_list<double> places) {
  std::vector<detail::PathGoal> out{{rigid_motion(Matrix3::Identity(), Vector3(0, 0, 0)), {}, Motion::joint}};
  for (const double x : places)
    out.push_back({rigid_motion(Matrix3::Identity(), Vector3(x, 0, 0)), {}, Motion::linear});
  return out;
}

TEST(PathSolverWhiteBox, TheLargestDeviationOfAllLinesIsReported) {
  // the second line is 0.4 long, so off by 0.16 of the first, and half of it by a quarter of that
  const detail::SolvedPath path =
      BowedSlides{.bow = 15.5e-3}.path(line_through({1, 0.6}), slides_settings(joints_of({1, 1})));
  ASSERT_EQ(path.points.size(), 7u);
  EXPECT_NEAR(path.points[6].deviation, 0.04 * 15.5e-3, 1e-12);
  EXPECT_NEAR(path.points[6].ends_only, 0.16 * 15.5e-3, 1e-12);
  EXPECT_NEAR(path.before, 15.5e-3, 1e-12);
  EXPECT_NEAR(path.after, 15.5e-3 / 16, 1e-12);
}

TEST(PathSolverWhiteBox, AJointComesFromWhereItTurnedRound) {
  const detail::SolvedPath path =
      BowedSlides{.bow = 15.5e-3}.path(line_through({1, 0.6}), slides_settings(joints_of({1, 1})));
  ASSERT_EQ(path.points.size(), 7u);  // in four pieces from 0 to 1, in two from there to 0.6
  for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(path.points[k].coming(0), k < 5 ? 0 : 1, 1e-15) << k;
}

TEST(PathSolverWhiteBox, NoStepIsLongerThanAllowed) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.max_joint_step = 0.35;
  const detail::SolvedPath path = BowedSlides{}.path(line_through({1}), settings);  // a straight line already
  ASSERT_EQ(path.points.size(), 4u);
  for (std::size_t k = 1; k < 4; ++k) EXPECT_NEAR(path.points[k].command(0), static_cast<double>(k) / 3, 1e-15);
}

TEST(PathSolverWhiteBox, OrientationsHaveATolerance) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.max_inserted = 3;  // slides cannot turn the tool, however many there are
  for (const double tolerance : {1.8e-3, 2.1e-3}) {
    settings.rotation_tolerance = tolerance;
    const detail::SolvedPath path = BowedSlides{.twist = 2e-3}.path(line_through({1}), settings);
    EXPECT_EQ(path.points.back().status, tolerance > 2e-3 ? PointStatus::met : PointStatus::off_path);
  }
}

PointStatus last_status(const BowedSlides& arm, double x, Motion motion = Motion::linear) {
  std::vector<detail::PathGoal> goals = line_through({x});
  goals.back().motion = motion;
  return arm.path(goals, slides_settings(joints_of({1, 1}))).points.back().status;
}

TEST(PathSolverWhiteBox, ALineMayNotChangeTheBranch) {
  const BowedSlides two{.branch = [](double x) { return x > 0.05 ? 1 : 0; }};
  EXPECT_EQ(last_status(two, 0.04), PointStatus::met);
  EXPECT_EQ(last_status(two, 0.06), PointStatus::jump);  // next to one another, but beyond a singularity
  EXPECT_EQ(last_status(two, 0.06, Motion::joint), PointStatus::met);
  const BowedSlides between{.branch = [](double x) { return x > 0.4 && x < 0.6 ? 1 : 0; }};
  EXPECT_EQ(last_status(between, 0.3), PointStatus::met);
  EXPECT_EQ(last_status(between, 1), PointStatus::jump);  // on the branch of the start again
}

TEST(PathSolverWhiteBox, ALineEndsWhereTheNominalArmComesTo) {
  // off by more than 0.1 where the line ends: joint values of another turn, or of the same signs by chance
  const auto ending = [](double off) { return last_status({.way = [=](double x) { return x == 1 ? off : 0; }}, 1); };
  EXPECT_NE(ending(0.09), PointStatus::jump);
  EXPECT_EQ(ending(0.11), PointStatus::jump);
}

TEST(PathSolverWhiteBox, ThePiecesOfALineBeginWhereTheNominalArmIs) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.max_joint_step = 0.3;
  const BowedSlides arm{.reach = 0.1, .nominal_reach = 0.3};  // from the piece before it would not be found
  const detail::SolvedPath path = arm.path(line_through({0.8}), settings);
  ASSERT_EQ(path.points.size(), 4u);
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_EQ(path.points[k].status, PointStatus::met);
    EXPECT_EQ(path.points[k].inserted, k < 3);
    EXPECT_EQ(path.points[k].target, 1);
    EXPECT_NEAR(path.points[k].command(0), 0.8 / 3 * static_cast<double>(k), 1e-15);
  }
}

TEST(PathSolverWhiteBox, ALineWhoseStepsStayTooLongIsAJump) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.max_joint_step = 0.15;
  for (const int inserted : {5, 6}) {  // steps of 1/6, 1/7
    settings.max_inserted = inserted;
    const detail::SolvedPath path = BowedSlides{}.path(line_through({1}), settings);
    EXPECT_EQ(path.points.size(), inserted == 5 ? 2u : 8u);
    EXPECT_EQ(path.points.back().status, inserted == 5 ? PointStatus::jump : PointStatus::met);
    EXPECT_NEAR(path.points.back().command(0), 1, 1e-15);
  }
}

TEST(PathSolverWhiteBox, ALineIsWatchedAtItsQuarters) {
  // off by 10 mm where x^3 (1 - x), or its mirror image, is largest, and by 6 mm in the middle
  const auto hump = [](double x) { return 10e-3 * 256 / 27 * x * x * x * (1 - x); };
  for (const bool late : {false, true}) {
    const BowedSlides arm{.way = [&](double x) { return hump(late ? x : 1 - x); }};
    EXPECT_NEAR(arm.path(line_through({1}), slides_settings(joints_of({1, 1}))).before, 10e-3, 1e-12) << late;
  }
}

TEST(PathSolverWhiteBox, EveryPointSaysWhatIsLeft) {
  const BowedSlides arm{.bow = 5e-3, .left = 1e-7};
  const detail::SolvedPath path = arm.path(line_through({1}), slides_settings(joints_of({1, 1})));
  ASSERT_EQ(path.points.size(), 4u);
  for (const detail::SolvedPoint& point : path.points) {
    EXPECT_EQ(point.position_error, 1e-7);
    EXPECT_EQ(point.rotation_error, 2e-7);
  }
}

TEST(PathSolverWhiteBox, NothingIsAskedOfTheMoveToTheFirstTarget) {
  std::vector<detail::PathGoal> goals = line_through({0.1});
  goals.front().motion = Motion::linear;
  for (const detail::SolvedPoint& point : BowedSlides{}.path(goals, slides_settings(joints_of({1, 1}))).points)
    EXPECT_EQ(point.status, PointStatus::met);
}

TEST(PathSolverWhiteBox, WithoutAStartTheWayToTheFirstTargetHardlyCounts) {
  std::vector<detail::PathGoal> goals = line_through({1});
  goals.back().motion = Motion::joint;
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  const auto branch = [&] { return BowedSlides{.other_branch = true}.path(goals, settings).points.back().command(1); };
  EXPECT_EQ(branch(), 0);  // 0 to the first target and 1 m to the second, in place of 2 m and 0
  settings.start(1) = std::nan("");
  EXPECT_EQ(branch(), 2);
}

TEST(PathSolverWhiteBox, ALineFromATargetThatWasNotMetIsAJump) {
  const detail::SolvedPath path =
      BowedSlides{.hole = 0.5}.path(line_through({0.5, 1}), slides_settings(joints_of({1, 1})));
  ASSERT_EQ(path.points.size(), 3u);
  EXPECT_EQ(path.points[0].status, PointStatus::met);
  EXPECT_EQ(path.points[1].status, PointStatus::not_found);
  EXPECT_EQ(path.points[2].status, PointStatus::jump);
}

TEST(PathSolverWhiteBox, WithoutAStartItBeginsInTheMiddleOfTheLimits) {
  std::vector<detail::PathGoal> goals = line_through({});
  goals.front().pose(0, 3) = 1;
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.start(0) = std::nan("");
  const auto second = [&](double lower, double upper) {  // of (1, 0) and (0, 2)
    settings.lower(1) = lower;
    settings.upper(1) = upper;
    return BowedSlides{.other_branch = true}.path(goals, settings).points.back().command(1);
  };
  EXPECT_EQ(second(-3, 3), 0);
  EXPECT_EQ(second(-1, 5), 2);
  settings.lower(0) = -1;  // from (0.5, 2), not from the lower limits
  settings.upper(0) = 2;
  EXPECT_EQ(second(-1, 5), 2);
}

TEST(PathSolverWhiteBox, ALongLineEndsWithTheTurnsThatItTook) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.lower(0) = -10;
  settings.upper(0) = 10;
  const detail::SolvedPath path = BowedSlides{}.path(line_through({5}), settings);
  EXPECT_EQ(path.points.back().status, PointStatus::met);
  EXPECT_NEAR(path.points.back().command(0), 5, 1e-12);  // not 5 - 2 pi, which is nearer to the start
}

TEST(PathSolverWhiteBox, CostsOfPlacesChooseTheBranch) {
  std::vector<detail::PathGoal> goals = line_through({});
  goals.front().pose(0, 3) = 1;
  const auto branch = [&](double cost) {  // 1 m to the first branch, 2 m to the other
    const BowedSlides arm{.other_branch = true, .cost_at = [=](double y) { return y == 0 ? cost : 0; }};
    return arm.path(goals, slides_settings(joints_of({1, 1}))).points.back().command(1);
  };
  EXPECT_EQ(branch(0.9), 0);
  EXPECT_EQ(branch(1.1), 2);
}

/// Settings of slides that count turns: 10 m either way.
detail::PathSettings wide_settings() {
  detail::PathSettings out = slides_settings(joints_of({1, 1}));
  out.lower = joints_of({-10, -10});
  out.upper = joints_of({10, 10});
  return out;
}

// A target outside the measured ranges costs 100; a turn of the second slide that is measured is farther, but cheaper.
TEST(PathSolverWhiteBox, CostsOfPlacesChooseTheTurn) {
  const std::vector<detail::PathGoal> goals = line_through({});
  for (const double sign : {-1.0, 1.0}) {
    const BowedSlides arm{.other_branch = true, .cost_at = [&](double y) { return sign * y > 4 ? 0 : 100; }};
    const double found = arm.path(goals, wide_settings()).points.back().command(1);
    EXPECT_NEAR(std::remainder(found, 2 * pi), found > 0 ? 0 : 2, 1e-12);  // of 0 or 2, whichever is nearer by a turn
    EXPECT_GT(sign * found, 4);
  }
}

// With joint values of its own a target has no choice, nor a price.
TEST(PathSolverWhiteBox, TargetsWithJointValuesCostNothing) {
  std::vector<detail::PathGoal> goals = line_through({});
  const auto found = [&] {
    const BowedSlides arm{.other_branch = true, .cost_at = [](double y) { return y > 4 ? 0 : 100; }};
    return arm.path(goals, wide_settings()).points.back().command(1);
  };
  EXPECT_NEAR(found(), 2 * pi, 1e-12);
  goals.front().joints = joints_of({0, 0});
  EXPECT_EQ(found(), 0);
}

// The first target is measured at y = 0, the second at 1 + 2 pi alone: a turn on the way to it.
TEST(PathSolverWhiteBox, TurnsMayChangeOnTheWay) {
  std::vector<detail::PathGoal> goals = line_through({0});
  goals.back().motion = Motion::joint;
  goals.back().pose(1, 3) = 1;
  const auto measured = [](double y) { return std::abs(y) < 0.1 || std::abs(y - 1 - 2 * pi) < 0.1; };
  const BowedSlides arm{.other_branch = true, .cost_at = [&](double y) { return measured(y) ? 0 : 100; }};
  std::vector<double> found;
  for (const detail::SolvedPoint& point : arm.path(goals, wide_settings()).points) found.push_back(point.command(1));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0], 0);
  EXPECT_NEAR(found[1], 1 + 2 * pi, 1e-12);
}

// At the first target the turns of all branches are tried, not those of the nearest two alone.
TEST(PathSolverWhiteBox, TheFirstTargetMayBeginWithAnyTurnOfAnyBranch) {
  const std::vector<detail::PathGoal> goals = line_through({});
  const auto measured = [](double y) { return std::abs(y - 2.7 - 2 * pi) < 0.1; };
  const BowedSlides arm{
      .other_branch = true, .cost_at = [&](double y) { return measured(y) ? 0 : 100; }, .more = {2.7}};
  EXPECT_NEAR(arm.path(goals, wide_settings()).points.back().command(1), 2.7 + 2 * pi, 1e-12);
}

// In four pieces the arm leaves its line by twice the tolerance, in eight by three times, as gears may: four it is.
TEST(PathSolverWhiteBox, FinerPiecesThatAreWorseAreNotTaken) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.max_joint_step = 0.3;
  settings.max_inserted = 7;
  const BowedSlides arm{.way = [](double x) { return x == 0.125 ? 2e-3 : x == 0.03125 ? 3e-3 : 0; }};
  const detail::SolvedPath path = arm.path(line_through({1}), settings);
  ASSERT_EQ(path.points.size(), 5u);
  EXPECT_EQ(path.points.back().status, PointStatus::off_path);
  EXPECT_NEAR(path.after, 2e-3, 1e-15);
  // ends_only says what the line would be without them
  EXPECT_EQ(path.points.back().ends_only, 0);
}

// Where the deviation from the line is unknown, because the nominal arm jumps on the way, eight pieces are tried first.
TEST(PathSolverWhiteBox, EightPiecesAreTriedWhereTheNominalArmLeaps) {
  const detail::SolvedPath path = BowedSlides{.leap = 0.25}.path(line_through({1}), slides_settings(joints_of({1, 1})));
  ASSERT_EQ(path.points.size(), 9u);
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_EQ(path.points[k].status, PointStatus::met);
    EXPECT_NEAR(path.points[k].command(0), 0.125 * static_cast<double>(k), 1e-15);
  }
}

TEST(PathSolverWhiteBox, BranchesAreAskedForNearTheTargetBefore) {
  std::vector<double> asked;
  BowedSlides arm;
  arm.asked = &asked;
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.start(0) = -0.5;
  (void)arm.path(line_through({1, 0.6}), settings);
  EXPECT_EQ(asked, (std::vector<double>{-0.5, 0, 1}));
}

TEST(PathSolverWhiteBox, ALineThatNeedsNoPointsDeviatesAsItDid) {
  const detail::SolvedPath path =
      BowedSlides{.bow = 0.75e-3}.path(line_through({1}), slides_settings(joints_of({1, 1})));
  ASSERT_EQ(path.points.size(), 2u);
  for (const double deviation : {path.before, path.after, path.points[1].deviation, path.points[1].ends_only})
    EXPECT_NEAR(deviation, 0.75e-3, 1e-15);
}

// Two pieces are too few for the first line; the second line begins where it ends.
TEST(PathSolverWhiteBox, ALineGoesOnFromOneThatWasLeft) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  settings.max_inserted = 1;
  const detail::SolvedPath path = BowedSlides{.bow = 15.5e-3}.path(line_through({1, 0.9}), settings);
  ASSERT_EQ(path.points.size(), 4u);
  EXPECT_EQ(path.points[2].status, PointStatus::off_path);
  EXPECT_EQ(path.points[3].status, PointStatus::met);
  EXPECT_NEAR(path.after, 15.5e-3 / 4, 1e-15);
}

TEST(PathSolverWhiteBox, ALineMayNotEndBeyondALimit) {
  detail::PathSettings settings = slides_settings(joints_of({1, 1}));
  for (const double upper : {0.9, 1.1}) {
    settings.upper(0) = upper;
    EXPECT_EQ(BowedSlides{}.path(line_through({1}), settings).points.back().status,
              upper < 1 ? PointStatus::beyond_limits : PointStatus::met);
  }
}

TEST(PathSolverWhiteBox, ATargetOutOfReachOfNewtonsMethodIsNotFound) {
  BowedSlides arm{.other_branch = true, .reach = 0.5};  // the other branch begins at 0, the target is at 1
  std::vector<detail::PathGoal> goals = line_through({});
  goals.front().pose(0, 3) = 1;
  detail::PathSettings settings = slides_settings(joints_of({0.1, 1}));
  EXPECT_EQ(arm.path(goals, settings).points.back().status, PointStatus::not_found);
  settings.upper(1) = 2 + 1e-10;  // where the other branch is, but for rounding errors
  EXPECT_EQ(arm.path(goals, settings).points.back().status, PointStatus::beyond_limits);
  settings.upper(1) = 3;
  settings.lower(1) = 2 - 1e-10;
  EXPECT_EQ(arm.path(goals, settings).points.back().status, PointStatus::beyond_limits);
}

}  // namespace
}  // namespace vernier::correct_path_test
