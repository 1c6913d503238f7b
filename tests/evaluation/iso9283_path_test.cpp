// SPDX-License-Identifier: BSD-3-Clause
// Accuracy and repeatability of paths after ISO 9283, by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "complaint.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/evaluation/iso9283_path.hpp"

namespace iso9283_path_test {
namespace {

using namespace vernier;
using vernier_test::complaint;
using Poses = std::vector<Isometry3>;

Isometry3 pose_at(const Vector3& position, const Vector3& rotation = Vector3::Zero()) {
  return rigid_motion(exp_so3(rotation), position);
}

/// Poses along the corners of a path, `step` apart, each moved by `offset` of its arc length.
template <class Offset>
Poses run_along(const std::vector<Vector3>& corners, double step, Offset offset) {
  Poses out;
  double arc = 0;
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    const Vector3 leg = corners[k + 1] - corners[k];
    for (double s = 0; s < leg.norm(); s += step)
      out.push_back(pose_at(corners[k] + s * leg.normalized() + offset(arc + s)));
    arc += leg.norm();
  }
  out.push_back(pose_at(corners.back() + offset(arc)));
  return out;
}

Poses path_of(const std::vector<Vector3>& corners) {
  Poses out;
  for (const Vector3& corner : corners) out.push_back(pose_at(corner));
  return out;
}

TEST(Iso9283Path, LineByHand) {
  // 1 m along x, turning about x by 0.2 rad; two runs beside it
  const Poses path{pose_at({0, 0, 0}), pose_at({1, 0, 0}, {0.2, 0, 0})};
  std::vector<Poses> runs(2);
  for (int k = 0; k <= 37; ++k) {  // at other places than the points
    const double x = k / 37.0, x2 = -0.01 + 1.02 * k / 37.0;
    runs[0].push_back(pose_at({x, 1e-3, 0}, {0.2 * x, 0, 0}));
    runs[1].push_back(pose_at({x2, 3e-3 + 4e-3 * x2, 0}, {0.2 * x2 + 0.01, 0, 0}));
  }
  const Iso9283Path result = iso9283_path(path, runs, {.points = 4});
  ASSERT_EQ(result.points.size(), 4u);
  EXPECT_EQ(result.length, 1);
  EXPECT_EQ(result.runs, 2);
  for (std::size_t i = 0; i < 4; ++i) {
    const Iso9283PathPoint& point = result.points[i];
    const double x = 0.125 + 0.25 * static_cast<double>(i);
    EXPECT_NEAR(point.arc_length, x, 1e-15);
    EXPECT_LT((point.commanded.matrix() - pose_at({x, 0, 0}, {0.2 * x, 0, 0}).matrix()).norm(), 1e-14);
    EXPECT_LT((point.mean.matrix() - pose_at({x, 2e-3 + 2e-3 * x, 0}, {0.2 * x + 5e-3, 0, 0}).matrix()).norm(), 1e-13);
    // y: 1 and 3 + 4 x: barycentre 2 + 2 x, both 1 + 2 x from it
    EXPECT_NEAR(point.at, 2e-3 + 2e-3 * x, 1e-14);
    EXPECT_NEAR(point.rt, 1e-3 + 2e-3 * x, 1e-14);
    // angles beside the command: 0 and 10 mrad
    EXPECT_LT((point.at_abc - Vector3(5e-3, 0, 0)).norm(), 1e-13);
    EXPECT_LT((point.rt_abc - Vector3(3 * std::sqrt(5e-5), 0, 0)).norm(), 1e-13);
  }
  EXPECT_EQ(result.at, result.points[3].at);
  EXPECT_EQ(result.rt, result.points[3].rt);
  EXPECT_NEAR(result.at_abc.x(), 5e-3, 1e-13);
  ASSERT_EQ(result.departures.size(), 2u);
  EXPECT_EQ(result.departures[0], "4 points, the norm asks for 10");
  EXPECT_EQ(result.departures[1], "2 runs, the norm asks for 10");
}

// Errors that shrink from the beginning on, and one that grows: the largest are those of the first point, and of the
// last, whatever their sign.
TEST(Iso9283Path, TheLargestErrorMayBeThatOfAnyPoint) {
  const Poses path{pose_at({0, 0, 0}), pose_at({1, 0, 0})};
  std::vector<Poses> runs(2);
  for (int k = 0; k <= 40; ++k) {
    const double x = k / 40.0, left = 1 - x;  // both runs on one side, their scatter shrinks likewise
    runs[0].push_back(pose_at({x, 4e-3 * left, 0}, {-4e-3 * left, 1e-3 * left, -2e-3 * x}));
    runs[1].push_back(pose_at({x, 6e-3 * left, 0}, {-8e-3 * left, 3e-3 * left, -2e-3 * x}));
  }
  const Iso9283Path result = iso9283_path(path, runs, {.points = 4});
  const double left = 0.875;  // at the first of four points
  EXPECT_NEAR(result.at, 5e-3 * left, 1e-12);
  EXPECT_NEAR(result.rt, 1e-3 * left, 1e-12);
  EXPECT_LT((result.points[0].at_abc - Vector3(-6e-3 * left, 2e-3 * left, -0.25e-3)).norm(), 1e-5);  // of 6 mrad
  EXPECT_LT((result.at_abc - left * Vector3(6e-3, 2e-3, 2e-3)).norm(), 1e-5);
  // deviations of -4 and -8, 1 and 3
  EXPECT_LT((result.rt_abc - 3e-3 * left * Vector3(std::sqrt(8), std::sqrt(2), 0)).norm(), 1e-5);
  ASSERT_EQ(result.departures.size(), 2u);
}

// A run that stays near a corner for a while passes it at the first of the nearest points.
TEST(Iso9283Path, ACornerIsPassedWhereItIsReachedFirst) {
  const Poses path = path_of({{0, 0, 0}, {0.25, 0, 0}, {0.25, 0.25, 0}});
  const Poses run = path_of({{0, 0, 0}, {0.25, 0, 1e-3}, {0.251, -1e-3, 5e-3}, {0.25, 0.25, 0}});
  const Iso9283Path result = iso9283_path(path, std::vector<Poses>{run}, {.points = 1});  // at the corner
  EXPECT_EQ(result.points[0].arc_length, 0.25);
  EXPECT_NEAR(result.points[0].at, 1e-3, 1e-12);
}

// Poses farther apart than the compared points are reported as a gap.
TEST(Iso9283Path, PosesFartherApartThanThePointsAreToldOf) {
  const Poses path = path_of({{0, 0, 0}, {1, 0, 0}});
  const auto told = [&](double step) {
    const auto none = [](double) { return Vector3(0, 0, 0); };
    return iso9283_path(path, std::vector<Poses>(10, run_along({{0, 0, 0}, {1, 0, 0}}, step, none))).departures.size();
  };
  EXPECT_EQ(told(0.099), 0u);
  EXPECT_EQ(told(0.101), 10u);
  // steps of a quarter are those of four points; the first step may be the largest
  const auto of_four = [&](const Poses& run) {
    return iso9283_path(path, std::vector<Poses>(10, run), {.points = 4}).departures;
  };
  EXPECT_EQ(of_four(path_of({{0, 0, 0}, {0.25, 0, 0}, {0.5, 0, 0}, {0.75, 0, 0}, {1, 0, 0}})).size(), 1u);
  const auto first = of_four(path_of({{0, 0, 0}, {0.5, 0, 0}, {0.75, 0, 0}, {1, 0, 0}}));
  ASSERT_EQ(first.size(), 11u);
  EXPECT_EQ(first[0], "run 1: poses are up to 0.5 m apart, the points to compare 0.25 m: interpolated between them");
}

// A run may begin and end at the outermost points to compare, and stand still there.
TEST(Iso9283Path, ARunFromTheFirstPointToTheLast) {
  const Poses path = path_of({{0, 0, 0}, {1, 0, 0}});
  const Poses run = path_of({{0.125, 1e-3, 0}, {0.125, 1e-3, 0}, {0.5, 1e-3, 0}, {0.875, 2e-3, 0}});
  const Iso9283Path result = iso9283_path(path, std::vector<Poses>{run}, {.points = 4});
  EXPECT_NEAR(result.points[0].at, 1e-3, 1e-15);
  EXPECT_NEAR(result.points[3].at, 2e-3, 1e-15);
}

// A run that begins shortly before the middle, where the only point to compare is.
TEST(Iso9283Path, ARunBeginsAnywhereInTheFirstHalf) {
  const Poses path = path_of({{0, 0, 0}, {1, 0, 0}}), run = path_of({{0.45, 0, 0}, {0.75, 0, 3e-3}, {1, 0, 0}});
  const Iso9283Path result = iso9283_path(path, std::vector<Poses>{run}, {.points = 1});
  EXPECT_NEAR(result.at, 3e-3 / 6, 1e-12);
}

// At its beginning a run nearer to the leg back is on the leg out.
TEST(Iso9283Path, AHairpinBeginsOnItsFirstLeg) {
  const std::vector<Vector3> corners{{0, 0, 0}, {1, 0, 0}, {0, 0.01, 0}};
  const auto aside = [](double arc) { return Vector3(0, arc < 1 ? 0.006 : 0.0, 0); };
  const Poses run = run_along(corners, 5e-3, aside);
  const Iso9283Path result = iso9283_path(path_of(corners), std::vector<Poses>{run}, {.points = 20});
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(result.points[i].at, 0.006, 1e-12) << i;  // then it turns
}

// Legs 20 mm apart, and a run 12 mm beside each: nearer to the next leg but one. That is sought within three times the
// way since the last pose and its distance from the path, 3 x (10 + 12) mm. At d before the corner it is 2 d + 20 mm
// ahead, so beyond that for d = 30 mm. Where the path lies does not matter.
TEST(Iso9283Path, ALegBesideIsNotTakenForTheNext) {
  const Vector3 away(3, -2, 1);
  std::vector<Vector3> corners;
  for (const Vector3& corner : {Vector3(0, 0, 0), Vector3(0.5, 0, 0), Vector3(0.5, 0.02, 0), Vector3(0, 0.02, 0)})
    corners.push_back(away + corner);
  const Vector3 aside(0, 0.012, 0);
  const Poses run = run_along(corners, 0.01, [&](double) { return aside; });
  const Iso9283Path result = iso9283_path(path_of(corners), std::vector<Poses>{run}, {.points = 51});
  for (std::size_t i = 0; i < 24; ++i) {  // up to 0.47 m
    const Iso9283PathPoint& point = result.points[i];
    EXPECT_LT((point.mean.translation() - point.commanded.translation() - aside).norm(), 1e-12) << i;
  }
}

// A path that comes back to its second corner 5 mm beside it: a run through that corner has passed it already.
TEST(Iso9283Path, ACornerThatWasPassedIsNotPassedAgain) {
  const std::vector<Vector3> corners{{0, 0, 0}, {0.5, 0, 0}, {0.8, 0.3, 0}, {0.505, 0.3, 0}, {0.505, -0.3, 0}};
  const double last = 0.5 + 0.3 * std::numbers::sqrt2 + 0.295;  // beginning of the last leg
  const auto aside = [&](double arc) { return Vector3(arc < last ? 0.0 : -0.005, 0, 0); };
  const Poses run = run_along(corners, 0.01, aside);
  const Iso9283Path result = iso9283_path(path_of(corners), std::vector<Poses>(10, run), {.points = 60});
  EXPECT_TRUE(result.departures.empty());
  EXPECT_NEAR(result.points.back().at, 0.005, 1e-12);
  for (const Iso9283PathPoint& point : result.points)
    if (point.arc_length > last + 0.02) {
      EXPECT_NEAR(point.at, 0.005, 1e-12) << point.arc_length;
    }
}

TEST(Iso9283Path, RepeatabilityIsTheMeanPlusThreeDeviations) {
  const Poses path = path_of({{0, 0, 0}, {1, 0, 0}});
  std::vector<Poses> runs;
  for (const double y : {1.0, 3.0, 2.0, 2.0, 2.0}) {  // l = 1 1 0 0 0: mean 0.4, variance (2 x 0.36 + 3 x 0.16) / 4
    const Vector3 offset(0, y * 1e-3, 0);
    runs.push_back(run_along({{0, 0, 0}, {1, 0, 0}}, 0.03, [&](double) { return offset; }));
  }
  const Iso9283Path result = iso9283_path(path, runs);
  EXPECT_NEAR(result.at, 2e-3, 1e-14);
  EXPECT_NEAR(result.rt, (0.4 + 3 * std::sqrt(0.3)) * 1e-3, 1e-14);
}

// A path that crosses itself and ends where it began; offsets of each leg tell whether legs are mixed up.
TEST(Iso9283Path, CrossingAndClosedPaths) {
  const std::vector<Vector3> eight{{0, 0, 0}, {0.2, 0.2, 0}, {0.2, 0, 0}, {0, 0.2, 0}, {0, 0, 0}};
  const std::vector<Vector3> square{{0, 0, 0}, {0.2, 0, 0}, {0.2, 0.2, 0}, {0, 0.2, 0}, {0, 0, 0}};
  for (const auto& corners : {eight, square}) {
    std::vector<double> ends{0};
    for (std::size_t k = 1; k < 5; ++k) ends.push_back(ends.back() + (corners[k] - corners[k - 1]).norm());
    const auto height = [&](double arc) {  // by leg: 1, 2, 3, 4 mm
      return Vector3(0, 0, arc < ends[1] ? 1e-3 : arc < ends[2] ? 2e-3 : arc < ends[3] ? 3e-3 : 4e-3);
    };
    const std::vector<Poses> runs(10, run_along(corners, 2e-3, height));
    const Iso9283Path result = iso9283_path(path_of(corners), runs, {.points = 37});
    EXPECT_TRUE(result.departures.empty());
    for (const Iso9283PathPoint& point : result.points) {
      EXPECT_LT((point.mean.translation() - point.commanded.translation() - height(point.arc_length)).norm(), 1e-12);
      EXPECT_NEAR(point.rt, 0, 1e-12);
    }
    EXPECT_NEAR(result.at, 4e-3, 1e-12);
  }
}

// A corner cut by a quarter of a circle of radius r leaves the path by r (sqrt(2) - 1) along the bisector. There the
// nearest point of the path jumps over the corner.
TEST(Iso9283Path, CornersCutShort) {
  const double r = 0.02;
  Poses path = path_of({{0, 0, 0}, {0.2, 0, 0}, {0.2, 0.2, 0}}), run;
  for (int k = 0; k <= 90; ++k) run.push_back(pose_at({0.18 * k / 90, 0, 0}));
  for (int k = 1; k < 50; ++k) {
    const double angle = std::numbers::pi / 2 * k / 50;
    run.push_back(pose_at({0.18 + r * std::sin(angle), r - r * std::cos(angle), 0}));
  }
  for (int k = 0; k <= 90; ++k) run.push_back(pose_at({0.2, r + 0.18 * k / 90, 0}));
  const Iso9283Path result = iso9283_path(path, std::vector<Poses>(10, run), {.points = 21});  // the 11th at the corner
  EXPECT_NEAR(result.points[10].at, r * (std::numbers::sqrt2 - 1), 2e-4);
  EXPECT_EQ(result.at, result.points[10].at);
  EXPECT_LT(result.points[0].at, 1e-12);
  EXPECT_LT(result.points[20].at, 1e-12);
}

TEST(Iso9283Path, WithoutOrientationsAndSparse) {
  const Poses path{pose_at({0, 0, 0}, {0.3, 0, 0}), pose_at({1, 0, 0}, {0, 0.3, 0})};
  std::vector<Poses> runs(10, path_of({{0, 1e-3, 0}, {0.5, 1e-3, 0}, {1, 1e-3, 0}}));
  for (Isometry3& pose : runs[3]) pose.linear().setZero();
  const Iso9283Path result = iso9283_path(path, runs, {.orientations = false});
  EXPECT_NEAR(result.at, 1e-3, 1e-15);
  EXPECT_EQ(result.points[4].commanded.linear(), Matrix3(Matrix3::Identity()));  // and not what the path says
  EXPECT_TRUE(result.at_abc.array().isNaN().all() && result.rt_abc.array().isNaN().all());
  ASSERT_EQ(result.departures.size(), 11u);
  EXPECT_EQ(result.departures[0],
            "run 1: poses are up to 0.5 m apart, the points to compare 0.1 m: interpolated between them");
  EXPECT_EQ(result.departures[10], "no orientations were measured: AT and RT of positions only");
  EXPECT_TRUE(std::isnan(iso9283_path(path, std::vector<Poses>{runs[0]}).rt));
}

TEST(Iso9283Path, RefusesWhatCannotBe) {
  const Poses path = path_of({{0, 0, 0}, {1, 0, 0}});
  const std::vector<Poses> runs{path};
  const auto told = [&](const Poses& commanded, const std::vector<Poses>& measured, int points = 10) {
    return complaint([&] { (void)iso9283_path(commanded, measured, {.points = points}); });
  };
  EXPECT_EQ(told({path[0]}, runs), "iso9283_path: 1 commanded pose, a path has at least 2");
  EXPECT_EQ(told({path[0], path[0]}, runs), "iso9283_path: commanded poses 1 and 2 have the same position");
  EXPECT_EQ(told(path, {}), "iso9283_path: no runs");
  EXPECT_EQ(told(path, runs, 0), "iso9283_path: 0 points, must be at least 1");
  EXPECT_EQ(told(path, {path, {path[0]}}), "iso9283_path: run 2 has 1 poses, must be at least 2");
  EXPECT_EQ(
      told(path, {path_of({{0, 0, 0}, {0.75, 0, 0}})}, 4),
      "iso9283_path: run 1 passes the path from 0 m to 0.75 m, the points to compare lie from 0.125 m to 0.875 m");
  EXPECT_EQ(told(path, {path_of({{0, 0, 0}, {std::nan(""), 0, 0}})}),
            "iso9283_path: run 1, pose 2: the position is not finite");
  EXPECT_EQ(told(path, {path_of({{std::nan(""), 0, 0}, {1, 0, 0}})}),
            "iso9283_path: run 1, pose 1: the position is not finite");
}

}  // namespace
}  // namespace iso9283_path_test
