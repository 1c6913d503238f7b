// SPDX-License-Identifier: BSD-3-Clause
// Closed-form inverse kinematics of seven joints at a given arm angle.

#include "vernier/kinematics/arm_angle_form.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "branch_helpers.hpp"
#include "complaint.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::arm_angle_form_test {
namespace {

using namespace vernier::literals;
using vernier_test::complaint;
using vernier_test::joint_difference;
using vernier_test::random_joints;

static_assert(BranchRoots<ArmAngleForm>);

constexpr double pi = std::numbers::pi;

/// Shoulder, elbow and wrist without offsets, as arms of seven equal modules have them (lengths of a KUKA LBR iiwa 7).
DhChain<7> without_offsets() {
  return DhChain<7>{{{{.alpha = -90_deg, .d = 340_mm},
                      {.alpha = 90_deg},
                      {.alpha = 90_deg, .d = 400_mm},
                      {.alpha = -90_deg},
                      {.alpha = -90_deg, .d = 400_mm},
                      {.alpha = 90_deg},
                      {.d = 126_mm}}}};
}

// The angle between the half planes of shoulder, wrist and axis 1, and of shoulder, wrist and elbow, from points alone.
TEST(ArmAngle, IsThatOfTheElbowAboutTheLineFromShoulderToWrist) {
  const auto arm = without_offsets();
  const ArmAngleForm form(arm, 0);
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    const JointVector<7> q = random_joints<7>(rng);
    const auto links = arm.links(q);
    const Vector3 shoulder = links.point.col(1), elbow = links.point.col(3), wrist = links.point.col(5);
    const Vector3 u = (wrist - shoulder).normalized();
    const Vector3 up = (Vector3::UnitZ() - u * u.z()).normalized();
    const Vector3 out = elbow - shoulder - u * u.dot(elbow - shoulder);
    const double between = std::atan2(u.dot(up.cross(out)), up.dot(out));
    // axis 4 is at right angles to the elbow's plane: bent one way it points along, the other way against, its normal
    const Vector3 bend = (elbow - shoulder).cross(wrist - elbow);
    const double expected = bend.dot(links.axis.col(3)) > 0 ? between : between + pi;
    EXPECT_NEAR(std::remainder(form.arm_angle(q) - expected, 2 * pi), 0, 1e-9);
  }
}

template <class Arm>
void expect_all_found(const Arm& arm, int poses) {
  const ArmAngleForm any(arm, 0);
  Rng rng(7);
  double residual = 0, generating = 0, angles = 0;
  for (int i = 0; i < poses; ++i) {
    const JointVector<7> q = random_joints<7>(rng);
    const Isometry3 target = arm.pose(q);
    const ArmAngleForm form = any.at(any.arm_angle(q));
    const InverseRoots<7> roots = form.roots(target);
    EXPECT_EQ(roots.count, 8);
    double nearest = 9;
    for (const InverseRoot<7>& root : roots) {
      EXPECT_EQ(root.margin, 0);
      residual = vernier_test::larger(residual, vernier_test::difference(arm.pose(root.joints), target));
      angles = std::max(angles, std::abs(std::remainder(form.arm_angle(root.joints) - form.arm_angle(q), 2 * pi)));
      nearest = std::min(nearest, joint_difference<7>(root.joints, q));
    }
    generating = std::max(generating, nearest);
    unsigned branches = 0;
    for (const InverseRoot<7>& root : roots) branches |= 1u << form.distances(root.joints).branch();
    EXPECT_EQ(branches, 255u);  // each combination of signs once
  }
  EXPECT_LT(residual, 1e-12);
  EXPECT_LT(generating, 1e-6);
  EXPECT_LT(angles, 1e-6);
}

TEST(ArmAngleForm, FindsAllJointValuesOfRandomPoses) {
  expect_all_found(without_offsets(), 2000);
  expect_all_found(robots::barrett_wam().chain, 2000);
  Isometry3 base = Isometry3::Identity(), tool = base;
  base.translation() << 1, -2, 0.3;
  base.linear() = exp_so3(Vector3(0.4, 0.1, -0.9));
  tool.translation() << 0.02, -0.03, 0.1;
  tool.linear() = exp_so3(Vector3(-0.4, 0.7, 0.3));
  expect_all_found(Framed(robots::barrett_wam().chain, base, tool), 200);
}

TEST(ArmAngleForm, SingularAndOutOfReach) {
  const auto arm = without_offsets();
  const ArmAngleForm form(arm, 0.3);
  const auto residual = [&](const InverseRoot<7>& root, const Isometry3& target) {
    return vernier_test::difference(arm.pose(root.joints), target);
  };
  // upright: shoulder, elbow and wrist all singular, the wrist on axis 1
  const Isometry3 upright = arm.pose(JointVector<7>::Zero());
  ASSERT_GT(form.roots(upright).count, 0);
  for (const auto& root : form.roots(upright)) EXPECT_LT(residual(root, upright), 1e-7);
  // a straight wrist, and a shoulder with axes 1 and 3 in line
  JointVector<7> q{0.3, 0.8, -0.2, 1.1, 0.4, 0, 0.1}, near = JointVector<7>::Constant(0.25);
  for (int at : {5, 1}) {
    q(5) = at == 5 ? 0 : 0.6;
    q(1) = at == 1 ? 0 : 0.8;
    const Isometry3 target = arm.pose(q);
    const ArmAngleForm here = form.at(form.arm_angle(q));
    int free = 0;
    for (const auto& root : here.roots(target, near)) {
      EXPECT_LT(residual(root, target), 1e-7);
      if ((root.free & (at == 5 ? 16u : 1u)) == 0) continue;
      ++free;
      EXPECT_EQ(root.joints(at == 5 ? 4 : 0), 0.25);
    }
    EXPECT_GT(free, 0);
  }
  // 1 um, and half a metre, farther than the arm is long
  Isometry3 target = arm.pose(JointVector<7>(0, 1, 0, 0, 0, 0.5, 0));
  const Vector3 shoulder(0, 0, 0.34), wrist = target * Vector3(0, 0, -0.126);
  const Vector3 outward = (wrist - shoulder).normalized();
  ASSERT_NEAR((wrist - shoulder).norm(), 0.8, 1e-12);
  target.translation() += 1e-6 * outward;
  const auto beyond = form.roots(target);
  ASSERT_GT(beyond.count, 0);
  for (const auto& root : beyond) EXPECT_GT(root.margin, 0);
  target.translation() += 0.5 * outward;
  EXPECT_EQ(form.roots(target).count, 0);
  EXPECT_GT(form.roots(target).nearest_margin, 0.05);
  target.translation() = shoulder + target.linear() * Vector3(0, 0, 0.126);  // the wrist in the shoulder
  EXPECT_EQ(form.roots(target).count, 0);
}

// A shoulder with oblique axes does not reach every direction of the upper arm. An arm with right angles in its place
// says where the elbow must be; the margin is half the difference of the cosines of the angle of axes 1 and 3 and of
// the largest or smallest one, here 60 + 50 and 60 - 50 degrees.
TEST(ArmAngleForm, ObliqueShouldersAreOutOfReach) {
  const auto square = without_offsets();
  auto rows = square.rows();
  rows[0].alpha = -60_deg;
  rows[1].alpha = 50_deg;
  const auto oblique = DhChain<7>::from_rows(rows);
  Rng rng(19);
  int out = 0, nearly = 0;
  for (int i = 0; i < 500; ++i) {
    const Isometry3 target = square.pose(random_joints<7>(rng));
    const double angle = rng.uniform(-pi, pi);
    const auto elsewhere = ArmAngleForm(square, angle).roots(target);
    ASSERT_EQ(elsewhere.count, 8);  // each elbow four times
    double nearest = std::numeric_limits<double>::infinity(), margins = 0;
    int count = 0;
    for (const auto& root : elsewhere) {
      const double cosine = square.links(root.joints).axis(2, 2);  // of axes 1, upright, and 3
      const double margin = std::max({cosine - std::cos(10_deg), std::cos(110_deg) - cosine, 0.0}) / 2;
      count += margin == 0 ? 2 : margin <= 0.05 ? 1 : 0;
      if (margin > 0.05) nearest = std::min(nearest, margin);
      if (margin <= 0.05) margins += margin;
    }
    const auto roots = ArmAngleForm(oblique, angle).roots(target);
    EXPECT_EQ(roots.count, count / 2);  // of each elbow one or two shoulders, and two wrists
    double sum = 0;
    for (const auto& root : roots) sum += root.margin;
    EXPECT_NEAR(sum, margins / 2, 1e-10);
    if (std::isfinite(nearest)) {
      EXPECT_NEAR(roots.nearest_margin, nearest, 1e-10);
      ++out;
    } else {
      EXPECT_EQ(roots.nearest_margin, nearest);
    }
    nearly += margins > 0;
  }
  EXPECT_GT(out, 50);
  EXPECT_GT(nearly, 20);
}

// The volume that three axes span over the most that they can, and the sine of the elbow's angle, by axes and points.
TEST(ArmAngleForm, DistancesAreVolumesOfAxes) {
  auto rows = without_offsets().rows();
  rows[0].alpha = -60_deg;
  rows[1].alpha = 50_deg;
  rows[4].alpha = -75_deg;
  rows[5].alpha = 40_deg;
  for (const auto& arm : {DhChain<7>::from_rows(rows), robots::barrett_wam().chain}) {
    const ArmAngleForm form(arm, 0);
    Rng rng(20);
    for (int i = 0; i < 50; ++i) {
      const JointVector<7> q = random_joints<7>(rng);
      const auto links = arm.links(q);
      const auto axis = [&](int k) { return Vector3(links.axis(0, k), links.axis(1, k), links.axis(2, k)); };
      const auto volume = [&](int k) {
        const Vector3 one = axis(k).cross(axis(k + 1)), two = axis(k + 1).cross(axis(k + 2));
        return axis(k).dot(two) / (one.norm() * two.norm());
      };
      const SingularityDistances at = form.distances(q);
      EXPECT_NEAR(at.shoulder, volume(0), 1e-12);
      EXPECT_NEAR(at.wrist, volume(4), 1e-12);
      // shoulder and wrist, and the point of axis 4 next to both
      const auto point = [&](int k) { return Vector3(links.point(0, k), links.point(1, k), links.point(2, k)); };
      const Vector3 shoulder = point(1), wrist = point(5);
      const Vector3 elbow = point(3) + axis(3).dot(Vector3(shoulder - point(3))) * axis(3);
      const Vector3 upper = elbow - shoulder, fore = wrist - elbow;
      EXPECT_NEAR(at.elbow, axis(3).dot(upper.cross(fore)) / (upper.norm() * fore.norm()), 1e-12);
    }
  }
}

TEST(ArmAngleForm, ArmsOfOtherGeometryAreRefused) {
  const auto refused = [](const DhChain<7>& chain) { return complaint([&] { (void)ArmAngleForm(chain, 0); }); };
  const auto changed = [&](int joint, double DhRow::*entry, double value) {
    auto table = without_offsets().rows();
    table[static_cast<std::size_t>(joint)].*entry = value;
    return DhChain<7>::from_rows(table);
  };
  EXPECT_NE(refused(changed(0, &DhRow::a, 0.01)).find("joints 1 to 3 miss a common point"), std::string::npos);
  EXPECT_NE(refused(changed(5, &DhRow::a, 0.088)).find("joints 5 to 7 miss a common point"), std::string::npos);
  EXPECT_NE(refused(changed(2, &DhRow::d, 0.0)).find("axis of joint 4 passes through"), std::string::npos);
  EXPECT_NE(refused(changed(3, &DhRow::d, 0.02)).find("beside the plane"), std::string::npos);
  EXPECT_NE(refused(changed(0, &DhRow::alpha, 0.0)).find("joints 1 and 2 are parallel"), std::string::npos);
  EXPECT_NE(refused(changed(1, &DhRow::alpha, 0.0)).find("joints 2 and 3 are parallel"), std::string::npos);
  EXPECT_NE(refused(changed(4, &DhRow::alpha, 0.0)).find("joints 5 and 6 are parallel"), std::string::npos);
  EXPECT_NE(refused(changed(5, &DhRow::alpha, 0.0)).find("joints 6 and 7 are parallel"), std::string::npos);
  // axes 2 and 3 are 10 mm from axis 1: the point next to all three is a third of that from two of them
  const auto number_behind = [](const std::string& what, const std::string& words) {
    const std::size_t at = what.find(words);
    return at == std::string::npos ? -1 : std::stod(what.substr(at + words.size()));
  };
  EXPECT_NEAR(number_behind(refused(changed(0, &DhRow::a, 0.01)), "point by "), 20.0 / 3, 1e-6);
  EXPECT_NEAR(number_behind(refused(changed(3, &DhRow::d, 0.02)), "the wrist lies "), 20, 1e-6);
  EXPECT_NE(complaint([] { (void)ArmAngleForm(robots::barrett_wam().chain, std::nan("")); }).find("nan"),
            std::string::npos);
}

// On an arm that is not quite the nominal one: joint 3 stays, the others follow.
TEST(ArmAngleForm, LeadsToAllBranchesOfARealArm) {
  const auto robot = robots::barrett_wam();
  const auto actual = with_geometric_errors(robot.chain, {}, 5);
  const ArmAngleForm any(robot.chain, 0);
  Rng rng(2);
  int found = 0, expected = 0;
  for (int i = 0; i < 300; ++i) {
    const JointVector<7> q = random_joints<7>(rng);
    const Isometry3 target = robot.chain.pose(q);
    const ArmAngleForm form = any.at(any.arm_angle(q));
    const auto roots = form.roots(target);
    const auto branches = all_branches(form, actual, target);
    expected += roots.count;
    for (const auto& branch : branches) {
      EXPECT_LT(vernier_test::difference(actual.pose(branch.joints), target), 1e-9);
      double nearest = 9;
      for (const auto& root : roots) nearest = std::min(nearest, std::abs(root.joints(2) - branch.joints(2)));
      EXPECT_LT(nearest, 1e-12);
    }
    found += branches.count;
  }
  EXPECT_GT(found, 0.97 * expected);
  EXPECT_LE(found, 1.05 * expected);
}

}  // namespace
}  // namespace vernier::arm_angle_form_test
