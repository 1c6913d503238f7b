// SPDX-License-Identifier: BSD-3-Clause
// Targets out of reach of closed-form inverse kinematics: by how much, from points and axes alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "closed_form_arms.hpp"
#include "random_chains.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::closed_form_reach_test {
namespace {

using namespace vernier_test::closed_forms;
using vernier_test::random_joints;

TEST(OutOfReach, MarginSaysByHowMuch) {
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  const double forearm = std::hypot(0.07, 0.302);
  JointVector<6> q{0.3, 0.4, -std::atan2(0.302, 0.07), 0.6, 0.9, 0.8};
  ASSERT_NEAR(form.distances(q).elbow, 0, 1e-12);
  const Isometry3 stretched = irb.pose(q);
  const Vector3 shoulder_point(0, 0, 0.29);
  const Vector3 tool = translation(stretched), direction(stretched(0, 2), stretched(1, 2), stretched(2, 2));
  const Vector3 centre = tool - 0.072 * direction;
  const Vector3 outward = (centre - shoulder_point).normalized();
  ASSERT_NEAR((centre - shoulder_point).norm(), 0.27 + forearm, 1e-12);
  const auto roots_at = [&](double beyond) {
    return form.roots(rigid_motion(rotation(stretched), tool + beyond * outward));
  };
  EXPECT_EQ(roots_at(-1e-6).count, 8);
  for (const auto& root : roots_at(-1e-6)) EXPECT_EQ(root.margin, 0);
  double before = 0;
  for (const double beyond : {1e-6, 1e-4, 1e-3, 5e-3}) {
    const auto roots = roots_at(beyond);
    EXPECT_GT(roots.count, 0);
    for (const auto& root : roots) {
      EXPECT_GT(root.margin, before);
      // the joints at the boundary come nearest
      EXPECT_NEAR((irb.position(root.joints) - tool).norm(), 0, 1e-2);
    }
    before = roots.begin()->margin;
  }
  const auto far = roots_at(0.5);
  EXPECT_EQ(far.count, 0);
  // by the law of cosines: that of the elbow's angle, less one
  const double reach = 0.27 + forearm + 0.5;
  EXPECT_NEAR(far.nearest_margin, (reach * reach - 0.27 * 0.27 - forearm * forearm) / (2 * 0.27 * forearm) - 1, 1e-12);
}

/// Half the difference of cosines by which an angle lies outside the range of three axes, of which neighbours enclose a
/// and b: the first and the last enclose |a - b| to a + b.
double outside(double cosine, double a, double b) {
  return std::max({cosine - std::cos(a - b), std::cos(a + b) - cosine, 0.0}) / 2;
}

/// A target turned about a point.
Isometry3 turned_about(const Isometry3& target, const Vector3& centre, const Matrix3& orientation) {
  const Vector3 lever = translation(inverse_of(target) * rigid_motion(Matrix3::Identity(), centre));
  const Vector3 there = transformed(rigid_motion(orientation, Vector3::Zero()), lever);
  return rigid_motion(orientation, centre - there);
}

// Wrists with oblique axes do not reach every orientation. An arm with right angles in its place says where the first
// joints must be, and the angle of axes 4 and 6 there by how much.
TEST(OutOfReach, OfObliqueWrists) {
  const DhChain<6> oblique = cases()[4].chain;
  auto rows = oblique.rows();
  rows[3].alpha = 90_deg;
  rows[4].alpha = -90_deg;
  const auto square = DhChain<6>::from_rows(rows);
  const ClosedForm form(oblique), any(square), mirrored(mirror_image(oblique));
  ASSERT_EQ(cases()[4].name, "oblique wrist");
  Rng rng(17);
  int all_out = 0, some_out = 0, nearly = 0;
  for (int i = 0; i < 1000; ++i) {
    const Isometry3 target = square.pose(random_joints<6>(rng));
    const auto elsewhere = any.roots(target);
    ASSERT_EQ(elsewhere.count, 8);  // each arm branch twice
    double nearest = std::numeric_limits<double>::infinity(), margins = 0;
    int count = 0;
    for (const auto& root : elsewhere) {
      const auto links = square.links(root.joints);
      double cosine = 0;
      for (int k = 0; k < 3; ++k) cosine += links.axis(k, 3) * target(k, 2);
      const double margin = outside(cosine, 60_deg, 50_deg);
      count += margin == 0 ? 2 : margin <= 0.05 ? 1 : 0;
      if (margin > 0.05) nearest = std::min(nearest, margin);
      if (margin <= 0.05) margins += margin;
    }
    const auto roots = form.roots(target);
    EXPECT_EQ(roots.count, count / 2);
    double sum = 0;
    for (const auto& root : roots) sum += root.margin;
    EXPECT_NEAR(sum, margins / 2, 1e-12);
    for (const double found : {roots.nearest_margin, mirrored.roots(inverse_of(target)).nearest_margin})
      if (std::isfinite(nearest)) {
        EXPECT_NEAR(found, nearest, 1e-12);
      } else {
        EXPECT_EQ(found, nearest);
      }
    all_out += count == 0;
    some_out += count > 0 && std::isfinite(nearest);
    nearly += margins > 0;
  }
  EXPECT_GT(all_out, 10);
  EXPECT_GT(some_out, 100);
  EXPECT_GT(nearly, 50);
}

// The same behind three parallel axes: the orientation is a matter of joint 1, which keeps the wrist at its distance
// along axis 2; that distance is a sine of the joint.
TEST(OutOfReach, OfObliqueWristsBehindThreeParallelAxes) {
  ASSERT_EQ(cases().back().name, "three parallel, oblique");
  const DhChain<6>& chain = cases().back().chain;
  const ClosedForm form(chain), mirrored(mirror_image(chain));
  const auto axis_2 = [&](double q1) {
    const auto axis = chain.links({q1, 0, 0, 0, 0, 0}).axis;
    return Vector3(axis(0, 1), axis(1, 1), axis(2, 1));
  };
  Rng rng(18);
  int all_out = 0;
  for (int i = 0; i < 3000; ++i) {
    const JointVector<6> q = random_joints<6>(rng);
    const auto links = chain.links(q);
    const Vector3 wrist(links.origin(0, 4), links.origin(1, 4), links.origin(2, 4));
    const Matrix3 orientation = exp_so3(3.0 * vernier_test::random_direction(rng));
    const Isometry3 target = turned_about(chain.pose(q), wrist, orientation);
    const Vector3 last(target(0, 2), target(1, 2), target(2, 2));
    // axis_2(q1) . wrist = A cos q1 + B sin q1 + C
    const auto along = [&](double q1) { return axis_2(q1).dot(wrist); };
    const double c = (along(0) + along(pi)) / 2, a = (along(0) - along(pi)) / 2, b = along(pi / 2) - c;
    const double half = std::acos((along(q(0)) - c) / std::hypot(a, b));
    double nearest = 9;
    bool out = true;
    for (const double q1 : {std::atan2(b, a) + half, std::atan2(b, a) - half}) {
      ASSERT_NEAR(along(q1), along(q(0)), 1e-12);
      const double margin = outside(axis_2(q1).dot(last), 70_deg, 60_deg);
      nearest = std::min(nearest, margin);
      out = out && margin > 0.05;
    }
    if (!out) continue;
    ++all_out;
    EXPECT_EQ(form.roots(target).count, 0);
    EXPECT_NEAR(form.roots(target).nearest_margin, nearest, 1e-9);
    EXPECT_NEAR(mirrored.roots(inverse_of(target)).nearest_margin, nearest, 1e-9);
  }
  EXPECT_GT(all_out, 20);
}

// The upper arm and forearm of a UR arm are a triangle with the distance of axes 2 and 4, which follows from the
// direction of axis 2 and a sign of axis 5: four triangles, by points and the law of cosines alone.
TEST(OutOfReach, OfTheElbowOfAThreeParallelArm) {
  const ClosedForm form(robots::ur10().chain), mirrored(mirror_image(robots::ur10().chain));
  constexpr double upper = 0.612, fore = 0.5723, offset = 0.163941, last = 0.1157;
  Rng rng(20);
  int out = 0, inside = 0;
  for (int i = 0; i < 500; ++i) {
    const Matrix3 orientation = exp_so3(3.0 * vernier_test::random_direction(rng));
    const Vector3 wrist = rng.uniform(0.9, 2) * vernier_test::random_direction(rng), axis_6 = orientation.col(2);
    const double across = std::hypot(wrist.x(), wrist.y());
    if (across < 0.2) continue;
    double nearest = std::numeric_limits<double>::infinity(), margins = 0;
    int count = 0;
    for (const double side : {-1.0, 1.0})
      for (const double sign : {-1.0, 1.0}) {
        const double angle = std::atan2(wrist.y(), wrist.x()) + side * std::acos(offset / across);
        const Vector3 axis_2(std::cos(angle), std::sin(angle), 0), axis_5 = sign * axis_2.cross(axis_6).normalized();
        const Vector3 middle = wrist - last * axis_5 - offset * axis_2 - Vector3(0, 0, 0.1273);
        const double cosine = (middle.squaredNorm() - upper * upper - fore * fore) / (2 * upper * fore);
        const double margin = std::max(std::abs(cosine) - 1, 0.0);
        count += margin == 0 ? 2 : margin <= 0.05 ? 1 : 0;
        if (margin > 0.05) nearest = std::min(nearest, margin);
        if (margin <= 0.05) margins += margin;
      }
    const Vector3 tool = wrist + 0.0922 * axis_6;
    const Isometry3 target = rigid_motion(orientation, tool);
    for (const auto& roots : {form.roots(target), mirrored.roots(inverse_of(target))}) {
      EXPECT_EQ(roots.count, count);
      double sum = 0;
      for (const auto& root : roots) sum += root.margin;
      EXPECT_NEAR(sum, margins, 1e-9);
      if (std::isfinite(nearest)) {
        EXPECT_NEAR(roots.nearest_margin, nearest, 1e-9);
      } else {
        EXPECT_EQ(roots.nearest_margin, nearest);
      }
    }
    ++(count == 0 ? out : inside);
  }
  EXPECT_GT(out, 100);
  EXPECT_GT(inside, 100);
}

/// A function of one joint, `middle + size cos(joint - phase)`, by three of its values.
struct Cosine {
  double middle, size, phase;
  template <class F>
  explicit Cosine(const F& f) {
    const double at[] = {f(0.0), f(pi / 2), f(pi)};
    middle = (at[0] + at[2]) / 2;
    size = std::hypot(at[0] - middle, at[1] - middle);
    phase = std::atan2(at[1] - middle, at[0] - middle);
  }
  /// By how much, relatively, a value lies outside.
  double outside(double value) const { return std::max(std::abs(value - middle) / size - 1, 0.0); }
  double joint(double value, int side) const { return phase + side * std::acos((value - middle) / size); }
};

// Joints 1 to 3 of arms with a spherical wrist: one of them follows from the target, and gives way to another. What
// both must meet is a height, a distance or a length along an axis: a cosine of the joint, here by points of the chain.
TEST(OutOfReach, OfTheFirstThreeJointsOfEveryKind) {
  for (const Case& arm : cases()) {
    if (arm.kind == ArmKind::second_parallel_to_third || arm.kind == ArmKind::three_parallel) continue;
    const ClosedForm form(arm.chain), mirrored(mirror_image(arm.chain));
    const auto point = [](const auto& points, int k) { return Vector3(points(0, k), points(1, k), points(2, k)); };
    const auto wrist_at = [&](double q2, double q3) { return point(arm.chain.links({0, q2, q3, 0, 0, 0}).origin, 3); };
    const auto square = [](const Vector3& v) { return v.squaredNorm(); };
    Rng rng(21);
    int first_out = 0, second_out = 0, inside = 0;
    for (int i = 0; i < 400; ++i) {
      const Matrix3 orientation = exp_so3(3.0 * vernier_test::random_direction(rng));
      const Vector3 wrist = rng.uniform(0.05, 1.2) * vernier_test::random_direction(rng) + Vector3(0, 0, 0.3),
                    tool = wrist + 0.072 * orientation.col(2);
      // of the joint that the target determines, and of the next, with the values that they must take
      const auto one = [&](double q) {
        if (arm.kind == ArmKind::first_parallel_to_second) return wrist_at(0, q).z();
        if (arm.kind == ArmKind::first_meets_second) return square(wrist_at(0, q) - Vector3(0, 0, 0.3));
        return square(wrist - point(arm.chain.links({q, 0, 0, 0, 0, 0}).origin, 1));
      };
      const auto other = [&](double first, double q) {
        if (arm.kind == ArmKind::first_parallel_to_second)
          return square(Vector3(wrist_at(q, first).cwiseProduct(Vector3(1, 1, 0))));
        if (arm.kind == ArmKind::first_meets_second) return wrist_at(q, first).z();
        const auto links = arm.chain.links({first, 0, q, 0, 0, 0});
        return point(links.axis, 1).dot(point(links.origin, 3) - point(links.origin, 1));
      };
      const auto wanted_of_other = [&](double first) {
        if (arm.kind == ArmKind::first_parallel_to_second) return square(Vector3(wrist.x(), wrist.y(), 0));
        if (arm.kind == ArmKind::first_meets_second) return wrist.z();
        const auto links = arm.chain.links({first, 0, 0, 0, 0, 0});
        return point(links.axis, 1).dot(wrist - point(links.origin, 1));
      };
      const auto shoulder = arm.chain.links(JointVector<6>::Zero()).origin;
      const double wanted = arm.kind == ArmKind::first_parallel_to_second ? wrist.z()
                            : arm.kind == ArmKind::first_meets_second     ? square(wrist - Vector3(0, 0, 0.3))
                                                                      : square(point(shoulder, 3) - point(shoulder, 1));
      const Cosine of_one(one);
      double nearest = std::numeric_limits<double>::infinity();
      int count = 0;
      bool unclear = false;  // between out and in
      const auto count_margin = [&](double margin) {
        unclear = unclear || (margin > 0 && margin <= 0.05);
        if (margin > 0.05) nearest = std::min(nearest, margin);
        return margin == 0;
      };
      if (count_margin(of_one.outside(wanted)))
        for (const int side : {-1, 1}) {
          const double first = of_one.joint(wanted, side);
          const Cosine of_other([&](double q) { return other(first, q); });
          if (count_margin(of_other.outside(wanted_of_other(first)))) count += 4;
        }
      if (unclear) continue;
      const Isometry3 target = rigid_motion(orientation, tool);
      for (const auto& roots : {form.roots(target), mirrored.roots(inverse_of(target))}) {
        EXPECT_EQ(roots.count, count) << arm.name;
        if (std::isfinite(nearest)) {
          EXPECT_NEAR(roots.nearest_margin / nearest, 1, 1e-9) << arm.name;
        } else {
          EXPECT_EQ(roots.nearest_margin, nearest) << arm.name;
        }
      }
      ++(count > 0 ? inside : of_one.outside(wanted) > 0 ? first_out : second_out);
    }
    EXPECT_GT(first_out, 20) << arm.name;
    // (what the third kind's first joint leaves, its third reaches, but for a narrow band)
    if (arm.kind != ArmKind::second_meets_third) {
      EXPECT_GT(second_out, 5) << arm.name;
    }
    EXPECT_GT(inside, 20) << arm.name;
  }
}

// A wrist centre next to axis 1, nearer than the shoulder's offset: that offset over the distance, less one.
TEST(OutOfReach, InsideTheOffsetOfTheShoulder) {
  const auto expect_margin = [](const DhChain<6>& chain, double offset, double tool) {
    const ClosedForm form(chain), mirrored(mirror_image(chain));
    for (const double share : {0.3, 0.8, 0.99}) {
      const Vector3 wrist(share * offset * std::cos(0.7), share * offset * std::sin(0.7), 0.6);
      const Matrix3 orientation = exp_so3(Vector3(pi, 0, 0));  // the tool down
      const Isometry3 target = rigid_motion(orientation, wrist - Vector3(0, 0, tool));
      for (const auto& roots : {form.roots(target), mirrored.roots(inverse_of(target))}) {
        if (share < 0.95) {
          EXPECT_EQ(roots.count, 0);
          EXPECT_NEAR(roots.nearest_margin, 1 / share - 1, 1e-12);
        } else {
          EXPECT_GT(roots.count, 0);
          for (const auto& root : roots) EXPECT_NEAR(root.margin, 1 / share - 1, 1e-12);
        }
      }
    }
  };
  auto rows = robots::abb_irb120().chain.rows();
  rows[1].d = 90_mm;
  expect_margin(DhChain<6>::from_rows(rows), 0.09, 0.072);
  expect_margin(robots::ur10().chain, 0.163941, 0.0922);
}

}  // namespace
}  // namespace vernier::closed_form_reach_test
