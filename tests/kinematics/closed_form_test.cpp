// SPDX-License-Identifier: BSD-3-Clause
// Closed-form inverse kinematics: every arm of the catalogue and one of each family, random and singular poses.

#include "vernier/kinematics/closed_form.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "branch_helpers.hpp"
#include "complaint.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::closed_form_test {
namespace {

using namespace vernier_test::closed_forms;
using vernier_test::complaint;
using vernier_test::joint_difference;
using vernier_test::random_joints;
using vernier_test::RealMatrix;

template <int N, class Convention>
ClosedForm<N> closed_form(const DhChain<N, Convention>& arm, HeldJoint held = {-1, 0}) {
  if constexpr (N == 7) {
    return ClosedForm<7>(arm, held);
  } else {
    return ClosedForm<6>(arm);
  }
}

/// The laws of random poses. @return how many roots there were of each number
template <class Arm, int N>
std::array<int, 17> expect_all_found(const Arm& arm, const ClosedForm<N>& form, int poses, const std::string& name,
                                     double held_value = 0) {
  Rng rng(11);
  std::array<int, 17> counts{};
  Quality worst;
  worst.generating = 0;
  for (int i = 0; i < poses; ++i) {
    JointVector<N> q = random_joints<N>(rng);
    if (form.held_joint() >= 0) q(form.held_joint()) = held_value;
    const Isometry3 target = arm.pose(q);
    const InverseRoots<N> roots = form.roots(target);
    const Quality at = quality(arm, roots, target, q);
    if (at.roots < 17) ++counts[static_cast<std::size_t>(at.roots)];
    worst.roots = std::max(worst.roots, at.roots);
    worst.residual = vernier_test::larger(worst.residual, at.residual);
    worst.generating = vernier_test::larger(worst.generating, at.generating);
    worst.nearest = std::min(worst.nearest, at.nearest);
    worst.in_range = worst.in_range && at.in_range;
  }
  EXPECT_LT(worst.residual, exact) << name;
  EXPECT_LT(worst.generating, 1e-6) << name;
  EXPECT_GT(worst.nearest, 1e-7) << name;
  EXPECT_TRUE(worst.in_range) << name;
  EXPECT_LE(worst.roots, 8) << name;  // 16 in general; arms with a closed form of this kind have 8
  return counts;
}

// ---------------------------------------------------------------------------------------------------------------------
// random poses

TEST(ClosedForm, FindsAllThatCatalogueArmsDo) {
  constexpr int poses = 20000;
  expect_all_found(robots::ur10().chain, closed_form(robots::ur10().chain), poses, "ur10");
  expect_all_found(robots::ur5().chain, closed_form(robots::ur5().chain), poses, "ur5");
  expect_all_found(robots::puma560().chain, closed_form(robots::puma560().chain), poses, "puma560");
  expect_all_found(robots::puma560_modified().chain, closed_form(robots::puma560_modified().chain), poses,
                   "puma560_modified");
  const auto counts =
      expect_all_found(robots::abb_irb120().chain, closed_form(robots::abb_irb120().chain), poses, "irb120");
  EXPECT_EQ(counts[8], poses);
}

TEST(ClosedForm, FindsAllThatTheWamDoesWithOneJointHeld) {
  const auto wam = robots::barrett_wam().chain;
  for (int joint = 0; joint < 7; ++joint) {
    if (joint == 3) continue;
    const ClosedForm form(wam, HeldJoint{joint, 0.3});
    EXPECT_EQ(form.held_joint(), joint);
    EXPECT_EQ(form.mirrored(), joint > 3);  // with a joint of the wrist held, the shoulder is the sphere
    expect_all_found(wam, form, 20000, "joint " + std::to_string(joint + 1), 0.3);
    Rng rng(1);
    JointVector<7> q = random_joints<7>(rng);
    q(joint) = 0.3;
    for (const auto& root : form.roots(wam.pose(q))) EXPECT_EQ(root.joints(joint), 0.3);
  }
}

TEST(ClosedForm, OfArmsBetweenFrames) {
  Rng rng(3);
  for (const Case& arm : cases()) {
    Vector6 base, tool;
    for (int i = 0; i < 6; ++i) {
      base(i) = rng.uniform(-1, 1);
      tool(i) = rng.uniform(-0.3, 0.3);
    }
    const Framed framed(arm.chain, FrameParameters(base), FrameParameters(tool));
    expect_all_found(framed, ClosedForm(framed), 1000, arm.name);
  }
}

TEST(ClosedForm, OfEveryKind) {
  for (const Case& arm : cases()) {
    EXPECT_EQ(internals(arm.chain).kind(), arm.kind) << arm.name;
    EXPECT_FALSE(internals(arm.chain).mirrored()) << arm.name;
    const auto mirrored = internals(mirror_image(arm.chain));
    EXPECT_EQ(mirrored.kind(), arm.kind) << arm.name;
    EXPECT_TRUE(mirrored.mirrored()) << arm.name;
  }
  for_all_arms(
      [](const std::string& name, const auto& chain) { expect_all_found(chain, closed_form(chain), 2000, name); });
}

TEST(ClosedForm, ToleranceAdmitsArmsThatAreAlmostOfAKind) {
  auto rows = robots::ur10().chain.rows();
  rows[1].alpha = 1e-4;
  const auto bent = DhChain<6>::from_rows(rows);
  EXPECT_NE(complaint([&] { ClosedForm{bent}; }), "");
  const ClosedForm form(bent, 1e-3);
  Rng rng(5);
  for (int i = 0; i < 100; ++i) {
    const JointVector<6> q = random_joints<6>(rng);
    EXPECT_LT(quality(bent, form.roots(bent.pose(q)), bent.pose(q), q).residual, 1e-3);
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// refusals

TEST(ClosedForm, RefusesArmsThatHaveNoneAndSaysWhatMisses) {
  Rng rng(6);
  for (int i = 0; i < 20; ++i) {
    const auto arm = vernier_test::random_chain<6>(rng, {.prismatic = 0, .hayati = false});
    const std::string what = complaint([&] { ClosedForm{arm}; });
    for (const char* part :
         {"seen from the base", "seen from the tool", "miss a common point by", "mm", "from parallel"})
      EXPECT_NE(what.find(part), std::string::npos) << what;
  }
  const auto identified = vernier_test::as_made(robots::ur10().chain, rng);
  EXPECT_NE(complaint([&] { ClosedForm{identified}; }), "");
}

// Axes 4 and 6 of a UR10 are 115.7 mm apart, so the point nearest to them half of that from each; here axis 3 is off by
// 10 mrad, which is 0.573 degrees.
TEST(ClosedForm, SaysByHowMuchAnArmMisses) {
  auto rows = robots::ur10().chain.rows();
  rows[1].alpha = 0.01;
  const std::string what = complaint([&] { ClosedForm{DhChain<6>::from_rows(rows)}; });
  const auto number_behind = [&](const std::string& words) {
    const std::size_t at = what.find(words);
    return at == std::string::npos ? -1 : std::stod(what.substr(at + words.size()));
  };
  EXPECT_NEAR(number_behind("miss a common point by "), 57.85, 1e-6) << what;
  EXPECT_NEAR(number_behind("the middle three are "), 0.01 * 180 / pi, 1e-6) << what;
}

TEST(ClosedForm, NamesWhatOneJointIsRefusedFor) {
  auto straight = robots::abb_irb120().chain.rows(), sliding = straight;
  straight[1].a = 0;  // joints 2 and 3 turn about the same axis
  sliding[2].joint = JointType::prismatic;
  const auto expect = [](const std::string& what, const std::string& words) {
    EXPECT_NE(what.find(words), std::string::npos) << what;
  };
  expect(complaint([&] { ClosedForm{DhChain<6>::from_rows(straight)}; }), "bend the arm");
  expect(complaint([&] { ClosedForm{DhChain<6>::from_rows(sliding)}; }), "joint 3 is prismatic");
  const auto holding = [](int joint) {
    return complaint([&] { ClosedForm(robots::barrett_wam().chain, HeldJoint{joint, 0.3}); });
  };
  // joint 4 of the WAM is its elbow: without it, two spheres are left
  expect(holding(3), "the last three axes meet in a point, but the other three");
  for (const int joint : {-1, 7, 100}) expect(holding(joint), "no joint " + std::to_string(joint + 1));
}

// ---------------------------------------------------------------------------------------------------------------------
// distances from singularities

/// Jacobian of the moving joints.
template <int N, class Convention>
RealMatrix moving_jacobian(const DhChain<N, Convention>& arm, const ClosedForm<N>& form, const JointVector<N>& q) {
  const RealMatrix all = RealMatrix::of(arm.jacobian(q));
  RealMatrix out(6, 6);
  for (int j = 0, k = 0; j < N; ++j)
    if (j != form.held_joint()) out.set_block(0, k++, all.col(j));
  return out;
}

/// The product of the three is the determinant of the Jacobian, but for a factor that the arm determines.
template <int N, class Convention>
void expect_factors_of_determinant(const DhChain<N, Convention>& arm, const ClosedForm<N>& form,
                                   const std::string& name, double held_value = 0) {
  Rng rng(7);
  double products[500], determinants[500];
  int widest = 0;
  for (int i = 0; i < 500; ++i) {
    JointVector<N> q = random_joints<N>(rng);
    if (form.held_joint() >= 0) q(form.held_joint()) = held_value;
    const SingularityDistances at = form.distances(q);
    for (const double value : at.values()) EXPECT_LE(std::abs(value), 1 + 1e-12) << name;
    products[i] = at.shoulder * at.elbow * at.wrist;
    determinants[i] = moving_jacobian(arm, form, q).determinant();
    if (std::abs(products[i]) > std::abs(products[widest])) widest = i;
  }
  const double ratio = determinants[widest] / products[widest];
  double worst = 0;
  for (int i = 0; i < 500; ++i)
    worst =
        vernier_test::larger(worst, std::abs(determinants[i] - ratio * products[i]) / std::abs(determinants[widest]));
  EXPECT_LT(worst, 1e-9) << name;
  EXPECT_GT(std::abs(products[widest]), 0.01) << name;
}

TEST(SingularityDistances, MultiplyToTheDeterminantOfTheJacobian) {
  for_all_arms([](const std::string& name, const auto& chain) {
    expect_factors_of_determinant(chain, closed_form(chain), name);
  });
  const auto wam = robots::barrett_wam().chain;
  for (const int joint : {0, 1, 2, 4, 5, 6})
    expect_factors_of_determinant(wam, ClosedForm(wam, HeldJoint{joint, 0.3}), "wam " + std::to_string(joint + 1), 0.3);
}

TEST(SingularityDistances, SignsNameTheBranch) {
  Rng rng(8);
  const auto expect_names = [&](const auto& chain, const char* name) {
    const ClosedForm form(chain);
    int full = 0;
    for (int i = 0; i < 500; ++i) {
      const auto roots = form.roots(chain.pose(random_joints<6>(rng)));
      unsigned seen = 0;
      for (const auto& root : roots) seen |= 1u << form.distances(root.joints).branch();
      EXPECT_EQ(std::popcount(seen), roots.count) << name;
      full += roots.count == 8;
    }
    EXPECT_GT(full, 50) << name;
  };
  expect_names(robots::ur10().chain, "ur10");
  expect_names(robots::ur5().chain, "ur5");
  expect_names(robots::abb_irb120().chain, "irb120");
  expect_names(robots::puma560().chain, "puma560");
  expect_names(robots::puma560_modified().chain, "puma560_modified");
}

TEST(SingularityDistances, NameTheNearestSingularity) {
  const SingularityDistances at{.shoulder = -0.5, .elbow = 0.25, .wrist = -0.1};
  EXPECT_EQ(at.branch(), 1 + 4);
  EXPECT_EQ(at.nearest(), "wrist");
  EXPECT_NEAR(at.nearest_angle(), std::asin(0.1), 1e-15);
  EXPECT_EQ((SingularityDistances{.shoulder = 0.1, .elbow = 0.3, .wrist = 1}.nearest()), "shoulder");
  EXPECT_EQ((SingularityDistances{.shoulder = 0.4, .elbow = -0.3, .wrist = 1}.nearest()), "elbow");
  // the wrist of a UR arm is straight where joint 5 is, its elbow where joint 3 is
  const ClosedForm form(robots::ur10().chain);
  JointVector<6> q{0.3, -1.1, 0.8, 0.4, 0.02, 1};
  EXPECT_EQ(form.distances(q).nearest(), "wrist");
  EXPECT_NEAR(form.distances(q).nearest_angle(), 0.02, 1e-12);
  EXPECT_NEAR(std::abs(form.distances(q).elbow), std::sin(0.8), 1e-12);
}

// Joint values and tool positions of a UR10 in the manufacturer's simulator, as published with the driver's calibration
// tests (Universal_Robots_ROS2_Driver, ur_calibration/test/calibration_test.cpp).
TEST(ClosedForm, AgreesWithTheSimulatorOfUniversalRobots) {
  const auto arm = robots::ur10().chain;
  const ClosedForm<6> form(arm);
  const JointVector<6> joints[] = {{-1.60070020357240840, -1.72710019746888930, -2.20299989381890530,
                                    -0.807999912892476860, 1.59510004520416260, -0.0309999624835413101},
                                   {1.32645022869110107, 2.42600774765014648, 5.95157289505004883, 1.27409040927886963,
                                    -0.541052166615621388, 0.122173048555850983}};
  const Vector3 positions[] = {{-0.179925914147547, -0.606869755162764, 0.230789102067257},
                               {0.399229880032804, 0.596883650693405, -0.667781904037628}};
  for (int i = 0; i < 2; ++i) {
    SCOPED_TRACE(i);
    const Isometry3 pose = arm.pose(joints[i]);
    EXPECT_LT((translation(pose) - positions[i]).norm(), 1e-9);
    const Isometry3 target = rigid_motion(rotation(pose), positions[i]);  // what the simulator printed
    double nearest = 9;
    for (const auto& root : form.roots(target)) {
      EXPECT_EQ(root.margin, 0);
      EXPECT_LT((arm.position(root.joints) - positions[i]).norm(), 1e-12);
      nearest = std::min(nearest, joint_difference<6>(root.joints, joints[i]));
    }
    EXPECT_LT(nearest, 1e-8);
  }
}

}  // namespace
}  // namespace vernier::closed_form_test
