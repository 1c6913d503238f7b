// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/planning/measurement_constraints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "complaint.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier::measurement_constraints_test {
namespace {

constexpr double half_turn = std::numbers::pi;

/// Three links of 1 m in the plane x-y, stretched along x at zero; the tool looks along its z, which is that of the
/// base.
ArmGeometry planar_arm() {
  const DhChain<3> chain{{{{.a = 1}, {.a = 1}, {.a = 1}}}};
  return ArmGeometry(in_frames(chain));
}

Rejection checked(const MeasurementConstraints& constraints, const Vector3& q) {
  return MeasurementScene(planar_arm(), constraints).rejection(q);
}

TEST(MeasurementConstraints, WithoutAnyAllIsPossible) { EXPECT_EQ(checked({}, {100, -3, 7}), Rejection::none); }

TEST(MeasurementConstraints, JointLimitsWithAMargin) {
  const MeasurementConstraints c{.lower = VectorX::Constant(3, -1), .upper = VectorX::Constant(3, 1)};
  EXPECT_EQ(checked(c, {0.94, -0.94, 0}), Rejection::none);
  EXPECT_EQ(checked(c, {0.96, 0, 0}), Rejection::joint_limits);
  EXPECT_EQ(checked(c, {0, 0, -0.96}), Rejection::joint_limits);
}

// What lies on a boundary is still possible: limits without a margin, sides of a box, a range.
TEST(MeasurementConstraints, BoundariesBelongToWhatIsPossible) {
  const MeasurementConstraints limits{
      .lower = VectorX::Constant(3, -1), .upper = VectorX::Constant(3, 1), .joint_margin = 0};
  EXPECT_EQ(checked(limits, {-1, 1, -1}), Rejection::none);
  const MeasurementConstraints box{.tool_box = ToolBox{{3, 0, 0}, {4, 1, 1}}},
      other_box{.tool_box = ToolBox{{2, -1, -1}, {3, 0, 0}}};  // the tool is at a corner of each
  EXPECT_EQ(checked(box, {0, 0, 0}), Rejection::none);
  EXPECT_EQ(checked(other_box, {0, 0, 0}), Rejection::none);
  for (const double range : {3.0, 7.0}) {  // the shortest or the longest possible
    const Tracker tracker{.position = {3 + range, 0, 0}, .min_range = 3, .max_range = 7};
    EXPECT_EQ(checked({.tracker = tracker}, {0, 0, 0}), Rejection::none) << range;
  }
}

TEST(MeasurementConstraints, LimitsOfOneJointCount) {
  const ArmGeometry arm(in_frames(DhChain<1>{{{{.a = 1}}}}));
  const auto checked_at = [&](const MeasurementConstraints& c, double q) {
    return MeasurementScene(arm, c).rejection(VectorX::Constant(1, q));
  };
  EXPECT_EQ(checked_at({.lower = VectorX::Constant(1, -1)}, -2), Rejection::joint_limits);
  EXPECT_EQ(checked_at({.upper = VectorX::Constant(1, 1)}, 2), Rejection::joint_limits);
  EXPECT_EQ(checked_at({.lower = VectorX::Constant(1, -1)}, 2), Rejection::none);
  EXPECT_EQ(checked_at({.upper = VectorX::Constant(1, 1)}, -2), Rejection::none);
}

TEST(MeasurementConstraints, TheToolStaysInItsBox) {
  const MeasurementConstraints c{.tool_box = ToolBox{{2.5, -1, -0.1}, {3.5, 1, 0.1}}};
  EXPECT_EQ(checked(c, {0, 0, 0}), Rejection::none);
  EXPECT_EQ(checked(c, {1, 0, 0}), Rejection::tool_box);
  // the tool at (3, 0, 0) out of each side of a box by a tenth
  for (Index k = 0; k < 3; ++k)
    for (const double side : {-0.4, 0.4}) {
      ToolBox box{{2.7, -0.3, -0.3}, {3.3, 0.3, 0.3}};
      box.lower(k) += side;
      box.upper(k) += side;
      EXPECT_EQ(checked({.tool_box = box}, {0, 0, 0}), Rejection::tool_box) << k << ' ' << side;
    }
}

TEST(MeasurementConstraints, RangeOfTheTracker) {
  const MeasurementConstraints c{.tracker = Tracker{.position = {10, 0, 0}, .min_range = 6.9, .max_range = 8}};
  EXPECT_EQ(checked(c, {0, 0, 0}), Rejection::none);
  EXPECT_EQ(checked(c, {half_turn / 2, 0, 0}), Rejection::range);  // sqrt(109) m
  EXPECT_EQ(checked({.tracker = Tracker{.position = {3.5, 0, 0}, .min_range = 1}}, {0, 0, 0}), Rejection::range);
}

TEST(MeasurementConstraints, AcceptanceOfTheReflector) {
  // the reflector looks along the tool's x, the tracker stands on the axis of the stretched arm
  MeasurementConstraints c{.tracker = Tracker{.position = {10, 0, 0}, .reflector_direction = {2, 0, 0}}};
  c.tracker->acceptance = 0.5;
  EXPECT_EQ(checked(c, {0, 0, 0}), Rejection::none);
  EXPECT_EQ(checked(c, {0, 0, 0.4}), Rejection::none);  // the beam turns a little, too
  EXPECT_EQ(checked(c, {0, 0, 0.5}), Rejection::acceptance);
  EXPECT_EQ(checked(c, {0, 0, half_turn}), Rejection::acceptance);
  c.tracker->acceptance = 3;  // hardly anything is turned away, but half a turn is
  EXPECT_EQ(checked(c, {0, 0, half_turn}), Rejection::acceptance);
  c.tracker->acceptance = half_turn;
  EXPECT_EQ(checked(c, {0, 0, half_turn}), Rejection::none);
  c.tracker->acceptance = 0.5;
  c.tracker->reflector_direction = {0, 0, 1};
  EXPECT_EQ(checked(c, {0, 0, 0}), Rejection::acceptance);
}

// The beam from the tool at (0, 1) to (1, -1, 1.5) passes the first link, along x, at 0.6 m and the second, along y, at
// 1.5 / sqrt(3.25) = 0.832 m: a link blocks it where its radius and that of the beam are larger together.
TEST(MeasurementConstraints, BeamsKeepTheirRadiusFromEachLink) {
  const auto seen = [](double first, double second) {
    const MeasurementConstraints c{.tracker = Tracker{.position = {1, -1, 1.5}, .beam_radius = 0.05},
                                   .link_radii = {first, second, 0.1}};
    return checked(c, {0, half_turn / 2, half_turn / 2});
  };
  EXPECT_EQ(seen(0.54, 0.1), Rejection::none);
  EXPECT_EQ(seen(0.56, 0.1), Rejection::line_of_sight);
  EXPECT_EQ(seen(0.1, 0.78), Rejection::none);
  EXPECT_EQ(seen(0.1, 0.79), Rejection::line_of_sight);
  // the first link is 2 m from the reflector along the arm: beside it is only what is farther away than it is wide
  EXPECT_EQ(seen(1.5, 0.1), Rejection::line_of_sight);
  EXPECT_EQ(seen(1.96, 0.1), Rejection::none);
}

// Half a metre of tool carries the reflector away from the last link, which then may hide it.
TEST(MeasurementConstraints, TheToolIsPartOfTheWayToTheReflector) {
  const DhChain<3> chain{{{{.a = 1}, {.a = 1}, {.a = 1}}}};
  const ArmGeometry arm(
      Framed<DhChain<3>>(chain, Isometry3::Identity(), rigid_motion(Matrix3::Identity(), {0.5, 0, 0})));
  const VectorX bent = Vector3(0, 0, half_turn / 2);  // the last link from (2, 0) to (2, 1), the tool at (2, 1.5)
  for (const double radius : {0.4, 0.6}) {
    const MeasurementConstraints c{.tracker = Tracker{.position = {2, -5, 0}, .beam_radius = 0},
                                   .link_radii = {0, 0, radius}};
    EXPECT_EQ(MeasurementScene(arm, c).rejection(bent), radius < 0.5 ? Rejection::line_of_sight : Rejection::none);
  }
}

// The third link ends 0.4 m above the first, with a link of 1 m between them.
TEST(MeasurementConstraints, LinksThatAreNearerThanTheirRadiiCollide) {
  const Vector3 q(0, half_turn / 2, half_turn / 2 + std::asin(0.6));
  const auto with = [&](double first, double third) { return checked({.link_radii = {first, 0, third}}, q); };
  EXPECT_EQ(with(0.1, 0.29), Rejection::none);
  EXPECT_EQ(with(0.1, 0.31), Rejection::self_collision);
  EXPECT_EQ(with(0.29, 0.1), Rejection::none);
  EXPECT_EQ(with(0.31, 0.1), Rejection::self_collision);
  EXPECT_EQ(with(0.5, 0.49), Rejection::self_collision);
  EXPECT_EQ(with(0.5, 0.51), Rejection::none);  // as wide as the link between them is long
}

// The fourth link comes back to 0.2 m from the first: both overlap, but for the 2 m of links between them.
TEST(MeasurementConstraints, AllLinksBetweenTwoKeepThemApart) {
  const DhChain<4> chain{{{{.a = 1}, {.a = 1}, {.a = 1}, {.a = 0.8}}}};
  VectorX square = VectorX::Constant(4, half_turn / 2);
  square(0) = 0;
  for (const double radius : {0.7, 1.1}) {
    const MeasurementScene scene(ArmGeometry(in_frames(chain)), {.link_radii = {radius, 0, 0, radius}});
    EXPECT_EQ(scene.rejection(square), radius < 1 ? Rejection::self_collision : Rejection::none) << radius;
  }
}

/// Three links of lengths of their own, the second and the third each at a right angle to the one before, and a tool
/// that goes on along the third.
Rejection checked_square(double second, double third, double tool, const MeasurementConstraints& constraints) {
  const DhChain<3> chain{{{{.a = 1}, {.a = second}, {.a = third}}}};
  const ArmGeometry arm(
      Framed<DhChain<3>>(chain, Isometry3::Identity(), rigid_motion(Matrix3::Identity(), {tool, 0, 0})));
  return MeasurementScene(arm, constraints).rejection(Vector3(0, half_turn / 2, half_turn / 2));
}

// A beam straight down from the end of the third link passes the first, which hides it unless the links between
// reflector and first link are shorter together than the first is wide.
TEST(MeasurementConstraints, TheWayToTheReflectorIsThatOfAllLinksBetween) {
  const auto seen = [](double second, double third, double radius) {
    const Tracker tracker{.position = {1 - third, -5, 0}, .beam_radius = 0};
    return checked_square(second, third, 0, {.tracker = tracker, .link_radii = {radius, 0, 0}});
  };
  EXPECT_EQ(seen(0.5, 0.25, 0.7), Rejection::line_of_sight);
  EXPECT_EQ(seen(0.5, 0.25, 0.8), Rejection::none);
  EXPECT_EQ(seen(0.25, 0.5, 0.7), Rejection::line_of_sight);
  EXPECT_EQ(seen(0.25, 0.5, 0.8), Rejection::none);
}

// What counts between two links is the second one alone, however long the third is; nor is the tool a link.
TEST(MeasurementConstraints, ALinkEndsBeforeTheTool) {
  const DhChain<3> chain{{{{.a = 1}, {.a = 0.5}, {.a = 0.6}}}};
  const Vector3 q(0, half_turn / 2, 2.5);  // down to the left, crossing the first link only with its tool
  const double down = std::cos(2.5), height = 0.5 + 0.6 * down, tip = 0.5 + 0.9 * down;
  ASSERT_GT(height, 0.01);
  ASSERT_LT(tip, 0);
  const ArmGeometry arm(
      Framed<DhChain<3>>(chain, Isometry3::Identity(), rigid_motion(Matrix3::Identity(), {0.3, 0, 0})));
  for (const double radius : {0.9, 1.1})
    EXPECT_EQ(MeasurementScene(arm, {.link_radii = {radius * height, 0, 0}}).rejection(q),
              radius < 1 ? Rejection::none : Rejection::self_collision);
  // folded over: the third link 0.2 m away at both of its ends, wide links that the second alone keeps apart
  EXPECT_EQ(checked_square(0.2, 0.9, 0, {.link_radii = {0.15, 0, 0.15}}), Rejection::none);
  EXPECT_EQ(checked_square(0.4, 0.1, 0, {.link_radii = {0.15, 0, 0.2}}), Rejection::none);
}

// Arm, box and tracker moved together by a base: what is rejected does not change.
TEST(MeasurementConstraints, HoldInTheFrameOfTheBase) {
  const DhChain<3> chain{{{{.a = 1}, {.a = 1}, {.a = 1}}}};
  const Vector3 moved(20, -30, 40);
  const ArmGeometry there(Framed<DhChain<3>>(chain, rigid_motion(Matrix3::Identity(), moved), Isometry3::Identity()));
  MeasurementConstraints c{.tracker = Tracker{.position = Vector3(0.5, -5, 0) + moved, .beam_radius = 0.05},
                           .link_radii = {0.1, 0.1, 0.1}};
  const VectorX square = Vector3(0, half_turn / 2, half_turn / 2), crossed = Vector3(0, 2.4, 2.4);
  EXPECT_EQ(MeasurementScene(there, c).rejection(square), Rejection::line_of_sight);
  c.tracker->position.z() += 40;
  EXPECT_EQ(MeasurementScene(there, c).rejection(square), Rejection::none);
  EXPECT_EQ(MeasurementScene(there, c).rejection(crossed), Rejection::self_collision);
}

TEST(MeasurementConstraints, DistancesOfSegmentsEqualAFineSearch) {
  Rng rng(4);
  const auto point = [&] { return Vector3(rng.normal(), rng.normal(), rng.normal()); };
  for (int i = 0; i < 50; ++i) {
    const Vector3 a = point(), b = point(), c = point(), d = i % 5 == 0 ? Vector3(c + 2 * (b - a)) : point();
    double smallest = 1e9;
    constexpr int steps = 1000;
    for (int s = 0; s <= steps; ++s) {
      const Vector3 from = a + (b - a) * s / steps;
      const double t = std::clamp((from - c).dot(d - c) / (d - c).squaredNorm(), 0.0, 1.0);
      smallest = std::min(smallest, (from - c - (d - c) * t).norm());
    }
    const double found = segment_distance(a, b, c, d);
    EXPECT_LE(found, smallest + 1e-12);
    EXPECT_GE(found, smallest - (b - a).norm() / (2 * steps));
    EXPECT_NEAR(found, segment_distance(d, c, b, a), 1e-12);
  }
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}), 5);
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {0, 0, 0}, {-1, 1, 0}, {1, 1, 0}), 1);
}

TEST(MeasurementConstraints, RefusesWhatIsNotUsable) {
  const auto complaint = [](const MeasurementConstraints& c) {
    return vernier_test::complaint([&] { (void)MeasurementScene(planar_arm(), c); });
  };
  EXPECT_EQ(complaint({.lower = VectorX::Zero(2)}), "MeasurementScene: limits of 2 joints for an arm of 3");
  EXPECT_EQ(complaint({.link_radii = {0.1}}), "MeasurementScene: radii of 1 links for an arm of 3");
  EXPECT_EQ(complaint({.tool_box = ToolBox{{0, 0, 0}, {1, 0, 1}}}),
            "MeasurementScene: the lower corner of the tool box is not below the upper one");
  EXPECT_EQ(complaint({.tracker = Tracker{.acceptance = 0}}), "MeasurementScene: acceptance is 0, must be positive");
  EXPECT_EQ(complaint({.joint_margin = -0.5}), "MeasurementScene: joint_margin is -0.5, must not be negative");
  EXPECT_EQ(complaint({.joint_margin = 0}), "");
  EXPECT_EQ(complaint({.upper = VectorX::Zero(4)}), "MeasurementScene: limits of 4 joints for an arm of 3");
  EXPECT_EQ(complaint({.link_radii = {0, 0.5, -1}}), "MeasurementScene: the radius of a link is -1");
  EXPECT_EQ(complaint({.link_radii = {0, 0.5, 1 / 0.0}}), "MeasurementScene: the radius of a link is inf");
  EXPECT_EQ(complaint({.tracker = Tracker{.position = {0, std::nan(""), 0}}}),
            "MeasurementScene: the tracker's position is not finite");
  EXPECT_EQ(complaint({.tracker = Tracker{.reflector_direction = {0, 0, 0}}}),
            "MeasurementScene: the reflector has no direction");
  EXPECT_EQ(complaint({.tracker = Tracker{.min_range = 2, .max_range = 2}}),
            "MeasurementScene: the tracker's range is empty");
  EXPECT_EQ(vernier_test::complaint([&] { (void)MeasurementScene(planar_arm(), {}).rejection(VectorX::Zero(2)); }),
            "MeasurementScene: 2 joint values for an arm of 3");
}

}  // namespace
}  // namespace vernier::measurement_constraints_test
