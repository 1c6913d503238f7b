// SPDX-License-Identifier: BSD-3-Clause
// How commands of a path are searched for, on two slides whose errors are known in closed form.

#include "vernier/compensation/detail/path_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "vernier/core/rigid_motions.hpp"

namespace vernier::path_solver_test {
namespace {

constexpr double pi = std::numbers::pi;

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
  std::function<double(double)> way = {};      ///< how far it is off at x, in place of an arc
  std::function<int(double)> branch = {};      ///< in which branch it is at x
  std::function<double(double)> cost_at = {};  ///< of being at y
  double reach = 1e3;                          ///< how far from where it begins Newton's method finds the target
  double nominal_reach = 1e3;                  ///< the same of the nominal arm
  double hole = -1e3;                          ///< the x of a target that is not met
  std::vector<double> more = {};               ///< further branches, at x = 0 and these y
  double lag = 0;  ///< how much of the y that it comes from is added to where it is, as hysteresis may do

  detail::SolvedPath path(const std::vector<detail::PathGoal>& goals, const detail::PathSettings& settings) const {
    using detail::PathJoints;
    const auto off = [&](double x) { return way ? way(x) : 4 * bow * x * (1 - x); };
    const auto id_at = [&](double x) { return branch ? branch(x) : 0; };
    const auto at = [](double x, double y) { return rigid_motion(Matrix3::Identity(), Vector3(x, y, 0)); };
    const auto lagging = [&](const PathJoints& from) { return lag == 0 ? 0 : lag * from(1); };  // from may be unknown
    const auto meet = [&](const Isometry3& target, const PathJoints& from, PathJoints& command, double* errors) {
      const Vector3 p = translation(target);
      const bool near = std::abs(command(0) - p.x()) <= reach;
      if (!other_branch && near) command = joints_of({p.x(), p.y() - off(p.x()) - lagging(from)});
      errors[0] = errors[1] = 0;
      return near && p.x() != hole;
    };
    const auto branches = [&](const Isometry3& target, const PathJoints&, std::vector<detail::PathBranch>& out) {
      const Vector3 p = translation(target);
      out.push_back({joints_of({p.x(), p.y() - off(p.x())}), id_at(p.x())});
      if (other_branch) out.push_back({joints_of({0, 2}), 1});
      for (const double y : more) out.push_back({joints_of({0, y}), 2});
      return Reach::met;
    };
    const auto pose = [&](const PathJoints& q, const PathJoints& from) {
      return at(q(0), q(1) + off(q(0)) + lagging(from));
    };
    const auto nominal_pose = [&](const PathJoints& q) { return at(q(0), q(1)); };
    const auto nominal_joints = [&](const Isometry3& target, PathJoints& q) {
      const bool near = std::abs(q(0) - target(0, 3)) <= nominal_reach;
      q = joints_of({target(0, 3), target(1, 3)});
      return near;
    };
    const auto cost = [&](const PathJoints& q) { return cost_at ? cost_at(q(1)) : 0.0; };
    const auto branch_id = [&](const PathJoints& q) { return other_branch && q(1) == 2 ? 1 : id_at(q(0)); };
    return detail::solve_path({2, 2, branches, meet, pose, nominal_pose, nominal_joints, cost, branch_id}, goals,
                              settings);
  }
};

/// Settings of two slides; no step is too long.
detail::PathSettings slides_settings() {
  return {1e-3, 1, 2, 127, joints_of({-3, -3}), joints_of({3, 3}), joints_of({0, 0})};
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

TEST(PathSolverWhiteBox, DeviationsShrinkWithTheSquareOfAPiece) {
  const BowedSlides arm{.bow = 15.5e-3};  // in units of the tolerance of 1 mm: sqrt(15.5) pieces, rounded up
  const detail::SolvedPath path = arm.path({{rigid_motion(Matrix3::Identity(), Vector3(0, 0, 0)), {}, Motion::joint},
                                            {rigid_motion(Matrix3::Identity(), Vector3(1, 0, 0)), {}, Motion::linear}},
                                           slides_settings());
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

TEST(PathSolverWhiteBox, AJointComesFromWhereItTurnedRound) {
  const detail::SolvedPath path = BowedSlides{.bow = 15.5e-3}.path(line_through({1, 0.6}), slides_settings());
  ASSERT_EQ(path.points.size(), 7u);  // in four pieces from 0 to 1, in two from there to 0.6
  for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(path.points[k].coming(0), k < 5 ? 0 : 1, 1e-15) << k;
}

PointStatus last_status(const BowedSlides& arm, double x, Motion motion = Motion::linear) {
  std::vector<detail::PathGoal> goals = line_through({x});
  goals.back().motion = motion;
  return arm.path(goals, slides_settings()).points.back().status;
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
  // a command farther from there than a step: joint values of another turn, or of the same signs by chance
  const auto ending = [](double off) { return last_status({.way = [=](double x) { return x == 1 ? off : 0; }}, 1); };
  EXPECT_NE(ending(0.11), PointStatus::jump);
  EXPECT_NE(ending(1.9), PointStatus::jump);
  EXPECT_EQ(ending(2.1), PointStatus::jump);
}

TEST(PathSolverWhiteBox, ThePiecesOfALineBeginWhereTheNominalArmIs) {
  detail::PathSettings settings = slides_settings();
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
  detail::PathSettings settings = slides_settings();
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
    EXPECT_NEAR(arm.path(line_through({1}), slides_settings()).before, 10e-3, 1e-12) << late;
  }
}

TEST(PathSolverWhiteBox, NothingIsAskedOfTheMoveToTheFirstTarget) {
  std::vector<detail::PathGoal> goals = line_through({0.1});
  goals.front().motion = Motion::linear;
  for (const detail::SolvedPoint& point : BowedSlides{}.path(goals, slides_settings()).points)
    EXPECT_EQ(point.status, PointStatus::met);
}

TEST(PathSolverWhiteBox, WithoutAStartTheWayToTheFirstTargetHardlyCounts) {
  std::vector<detail::PathGoal> goals = line_through({1});
  goals.back().motion = Motion::joint;
  detail::PathSettings settings = slides_settings();
  const auto branch = [&] { return BowedSlides{.other_branch = true}.path(goals, settings).points.back().command(1); };
  EXPECT_EQ(branch(), 0);  // 0 to the first target and 1 m to the second, in place of 2 m and 0
  settings.start(1) = std::nan("");
  EXPECT_EQ(branch(), 2);
}

TEST(PathSolverWhiteBox, ALineFromATargetThatWasNotMetIsAJump) {
  const detail::SolvedPath path = BowedSlides{.hole = 0.5}.path(line_through({0.5, 1}), slides_settings());
  ASSERT_EQ(path.points.size(), 3u);
  EXPECT_EQ(path.points[0].status, PointStatus::met);
  EXPECT_EQ(path.points[1].status, PointStatus::not_found);
  EXPECT_EQ(path.points[2].status, PointStatus::jump);
}

TEST(PathSolverWhiteBox, WithoutAStartItBeginsInTheMiddleOfTheLimits) {
  std::vector<detail::PathGoal> goals = line_through({});
  goals.front().pose(0, 3) = 1;
  detail::PathSettings settings = slides_settings();
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
  detail::PathSettings settings = slides_settings();
  settings.lower(0) = -10;
  settings.upper(0) = 10;
  const detail::SolvedPath path = BowedSlides{}.path(line_through({5}), settings);
  EXPECT_EQ(path.points.back().status, PointStatus::met);
  EXPECT_NEAR(path.points.back().command(0), 5, 1e-12);  // not 5 - 2 pi, which is nearer to the start
}

/// Settings of slides that count turns: 10 m either way.
detail::PathSettings wide_settings() {
  detail::PathSettings out = slides_settings();
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
  detail::PathSettings settings = slides_settings();
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

// Two pieces are too few for the first line; the second line begins where it ends.
TEST(PathSolverWhiteBox, ALineGoesOnFromOneThatWasLeft) {
  detail::PathSettings settings = slides_settings();
  settings.max_inserted = 1;
  const detail::SolvedPath path = BowedSlides{.bow = 15.5e-3}.path(line_through({1, 0.9}), settings);
  ASSERT_EQ(path.points.size(), 4u);
  EXPECT_EQ(path.points[2].status, PointStatus::off_path);
  EXPECT_EQ(path.points[3].status, PointStatus::met);
  EXPECT_NEAR(path.after, 15.5e-3 / 4, 1e-15);
}

TEST(PathSolverWhiteBox, ALineMayNotEndBeyondALimit) {
  detail::PathSettings settings = slides_settings();
  for (const double upper : {0.9, 1.1}) {
    settings.upper(0) = upper;
    EXPECT_EQ(BowedSlides{}.path(line_through({1}), settings).points.back().status,
              upper < 1 ? PointStatus::beyond_limits : PointStatus::met);
  }
}

TEST(PathSolverWhiteBox, ATargetOutOfReachOfNewtonsMethodIsNotFound) {
  // the other branch, which costs less, begins at 0; the target is at 1
  BowedSlides arm{.other_branch = true, .cost_at = [](double y) { return y > 1 ? 0 : 100; }, .reach = 0.5};
  std::vector<detail::PathGoal> goals = line_through({});
  goals.front().pose(0, 3) = 1;
  detail::PathSettings settings = slides_settings();
  EXPECT_EQ(arm.path(goals, settings).points.back().status, PointStatus::not_found);
  settings.upper(1) = 2 + 1e-10;  // where the other branch is, but for rounding errors
  EXPECT_EQ(arm.path(goals, settings).points.back().status, PointStatus::beyond_limits);
  settings.upper(1) = 3;
  settings.lower(1) = 2 - 1e-10;
  EXPECT_EQ(arm.path(goals, settings).points.back().status, PointStatus::beyond_limits);
}

// Where the correction turns a joint round, the command is corrected once more for the approach that this makes.
TEST(PathSolverWhiteBox, CommandsAndApproachesFitOneAnother) {
  detail::PathSettings settings = slides_settings();
  settings.max_joint_step = 0.13;
  const BowedSlides arm{.bow = 20e-3, .lag = 1e-3};
  const detail::SolvedPath path = arm.path(line_through({1}), settings);
  ASSERT_EQ(path.points.size(), 9u);
  for (std::size_t k = 1; k < 9; ++k) {
    const detail::SolvedPoint &before = path.points[k - 1], &point = path.points[k];
    const double x = point.command(0);
    EXPECT_NEAR(point.command(1), -80e-3 * x * (1 - x) - 1e-3 * point.coming(1), 1e-15) << k;
    const detail::PathJoints coming = detail::approach_on_the_way(before.coming, before.command, point.command);
    EXPECT_NEAR(point.coming(1), coming(1), 1e-4) << k;
  }
}

}  // namespace
}  // namespace vernier::path_solver_test
