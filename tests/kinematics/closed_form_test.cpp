// Closed-form inverse kinematics: every arm of the catalogue and one of each family, random and singular poses.

#include "vernier/kinematics/closed_form.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "branch_helpers.hpp"
#include "complaint.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::closed_form_test {
namespace {

using namespace vernier::literals;
using detail::ArmKind;
using vernier_test::complaint;
using vernier_test::difference;
using vernier_test::joint_difference;
using vernier_test::random_joints;
using vernier_test::RealMatrix;

constexpr double pi = std::numbers::pi;
constexpr double exact = 1e-10;  // m, and entries of rotations
/// A margin below this is a rounding error: the target is on the boundary.
constexpr double rounding = 1e-12;

template <int N, class Convention>
ClosedForm<N> closed_form(const DhChain<N, Convention>& arm, HeldJoint held = {-1, 0}) {
  if constexpr (N == 7) {
    return ClosedForm<7>(arm, held);
  } else {
    return ClosedForm<6>(arm);
  }
}

/// What the roots of one target are like.
struct Quality {
  int roots = 0;          ///< that meet the target, by their margin
  double residual = 0;    ///< worst of them
  double generating = 9;  ///< distance of the nearest of them from the joints that made the target [rad]
  double nearest = 9;     ///< smallest distance of two of them [rad]
  bool in_range = true;   ///< moving joints in (-pi, pi]
};

template <class Arm, int N>
Quality quality(const Arm& arm, const InverseRoots<N>& roots, const Isometry3& target, const JointVector<N>& q) {
  Quality out;
  for (const InverseRoot<N>& root : roots) {
    for (const double angle : root.joints) out.in_range = out.in_range && angle > -pi && angle <= pi;
    if (root.margin > rounding) continue;
    ++out.roots;
    out.residual = vernier_test::larger(out.residual, difference(arm.pose(root.joints), target));
    out.generating = std::min(out.generating, joint_difference<N>(root.joints, q));
    for (const InverseRoot<N>* other = roots.begin(); other != &root; ++other)
      if (other->margin <= rounding)
        out.nearest = std::min(out.nearest, joint_difference<N>(root.joints, other->joints));
  }
  return out;
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
// arms

struct Case {
  std::string name;
  DhChain<6> chain;
  ArmKind kind;
};

constexpr DhRow wrist_4{.a = 0_mm, .alpha = 90_deg, .d = 302_mm}, wrist_5{.a = 0_mm, .alpha = -90_deg, .d = 0_mm},
    wrist_6{.a = 0_mm, .alpha = 0_deg, .d = 72_mm, .theta = 180_deg};

/// An arm of the UR kind whose axes 3 and 4 may run against axis 2.
DhChain<6> three_parallel(double alpha2, double alpha3) {
  return DhChain<6>{{{
      {.a = 0_mm, .alpha = 90_deg, .d = 127.3_mm},
      {.a = -612_mm, .alpha = alpha2, .d = 20_mm},
      {.a = -572.3_mm, .alpha = alpha3, .d = -35_mm},
      {.a = 0_mm, .alpha = 90_deg, .d = 163.941_mm},
      {.a = 0_mm, .alpha = -90_deg, .d = 115.7_mm},
      {.a = 0_mm, .alpha = 0_deg, .d = 92.2_mm},
  }}};
}

/// An arm of every kind, and variants in which what is usually orthogonal, parallel or zero is not.
const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"irb 120", robots::abb_irb120().chain, ArmKind::second_parallel_to_third},
      {"puma 560", robots::puma560().chain, ArmKind::second_parallel_to_third},
      {"offset shoulder, oblique first axis",
       DhChain<6>{{{{.a = 50_mm, .alpha = -70_deg, .d = 290_mm},
                    {.a = 270_mm, .alpha = 0_deg, .d = 40_mm, .theta = -90_deg},
                    {.a = 70_mm, .alpha = -60_deg, .d = -15_mm},
                    wrist_4,
                    wrist_5,
                    wrist_6}}},
       ArmKind::second_parallel_to_third},
      {"third against second",
       DhChain<6>{{{{.a = 30_mm, .alpha = -90_deg, .d = 290_mm},
                    {.a = 270_mm, .alpha = 180_deg, .d = 10_mm, .theta = -90_deg},
                    {.a = 70_mm, .alpha = 90_deg, .d = 0_mm},
                    wrist_4,
                    wrist_5,
                    wrist_6}}},
       ArmKind::second_parallel_to_third},
      {"oblique wrist",
       DhChain<6>{{{{.a = 0_mm, .alpha = -90_deg, .d = 290_mm},
                    {.a = 270_mm, .alpha = 0_deg, .d = 0_mm, .theta = -90_deg},
                    {.a = 70_mm, .alpha = -90_deg, .d = 0_mm},
                    {.a = 0_mm, .alpha = 60_deg, .d = 302_mm},
                    {.a = 0_mm, .alpha = -50_deg, .d = 0_mm},
                    wrist_6}}},
       ArmKind::second_parallel_to_third},
      {"first parallel to second",
       DhChain<6>{{{{.a = 400_mm, .alpha = 0_deg, .d = 200_mm},
                    {.a = 300_mm, .alpha = 90_deg, .d = 50_mm},
                    {.a = 70_mm, .alpha = -90_deg, .d = 25_mm},
                    wrist_4,
                    wrist_5,
                    wrist_6}}},
       ArmKind::first_parallel_to_second},
      {"second against first",
       DhChain<6>{{{{.a = 400_mm, .alpha = 180_deg, .d = 200_mm},
                    {.a = 300_mm, .alpha = 75_deg, .d = 50_mm},
                    {.a = 70_mm, .alpha = -90_deg, .d = 0_mm},
                    wrist_4,
                    wrist_5,
                    wrist_6}}},
       ArmKind::first_parallel_to_second},
      {"first meets second",
       DhChain<6>{{{{.a = 0_mm, .alpha = -80_deg, .d = 300_mm},
                    {.a = 100_mm, .alpha = 70_deg, .d = 250_mm},
                    {.a = 60_mm, .alpha = -90_deg, .d = 0_mm},
                    wrist_4,
                    wrist_5,
                    wrist_6}}},
       ArmKind::first_meets_second},
      {"second meets third",
       DhChain<6>{{{{.a = 150_mm, .alpha = -80_deg, .d = 300_mm},
                    {.a = 0_mm, .alpha = 90_deg, .d = 40_mm},
                    {.a = 200_mm, .alpha = -90_deg, .d = 120_mm},
                    wrist_4,
                    wrist_5,
                    wrist_6}}},
       ArmKind::second_meets_third},
      {"ur10", robots::ur10().chain, ArmKind::three_parallel},
      {"three parallel, third against second", three_parallel(180_deg, 180_deg), ArmKind::three_parallel},
      {"three parallel, third and fourth against second", three_parallel(180_deg, 0_deg), ArmKind::three_parallel},
      {"three parallel, fourth against second", three_parallel(0_deg, 180_deg), ArmKind::three_parallel},
      {"three parallel, oblique",
       DhChain<6>{{{{.a = 40_mm, .alpha = 75_deg, .d = 127.3_mm},
                    {.a = -612_mm, .alpha = 0_deg, .d = 0_mm},
                    {.a = -572.3_mm, .alpha = 0_deg, .d = 0_mm},
                    {.a = 0_mm, .alpha = 70_deg, .d = 163.941_mm},
                    {.a = 0_mm, .alpha = -60_deg, .d = 115.7_mm},
                    {.a = 0_mm, .alpha = 0_deg, .d = 92.2_mm}}}},
       ArmKind::three_parallel},
  };
  return all;
}

/// The arm held by its tool: its joint i is joint 7 - i of the other, turned backwards. The inverse of a row of the
/// standard convention is one of the modified convention.
DhChain<6, ModifiedDh> mirror_image(const DhChain<6>& arm) {
  std::array<DhRow, 6> rows;
  for (int i = 0; i < 6; ++i) {
    const DhRow& row = arm.row(5 - i);
    rows[static_cast<std::size_t>(i)] = {.a = -row.a, .alpha = -row.alpha, .d = -row.d, .theta = -row.theta};
  }
  return DhChain<6, ModifiedDh>::from_rows(rows);
}

template <class Arm>
detail::ClosedFormArm internals(const Arm& arm) {
  return {detail::six_axes_of(arm, {-1, 0}), 1e-6};
}

/// Calls `f(name, chain)` for all arms and their mirror images.
template <class F>
void for_all_arms(const F& f) {
  for (const Case& arm : cases()) {
    f(arm.name, arm.chain);
    f(arm.name + ", mirrored", mirror_image(arm.chain));
  }
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

TEST(ClosedForm, BothConventionsOfThePumaHaveTheSameRoots) {
  const auto standard = robots::puma560().chain;
  const ClosedForm one(standard), other(robots::puma560_modified().chain);
  Rng rng(2);
  for (int i = 0; i < 200; ++i) {
    const Isometry3 target = standard.pose(random_joints<6>(rng));
    const auto a = one.roots(target), b = other.roots(target);
    ASSERT_EQ(a.count, b.count);
    for (const auto& root : a) {
      double nearest = 9;
      for (const auto& same : b) nearest = std::min(nearest, joint_difference<6>(root.joints, same.joints));
      EXPECT_LT(nearest, 1e-6);
    }
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
  }
  for_all_arms(
      [](const std::string& name, const auto& chain) { expect_all_found(chain, closed_form(chain), 2000, name); });
}

TEST(ClosedForm, OfMirrorImages) {
  Rng rng(4);
  for (const Case& arm : cases()) {
    const auto mirror = mirror_image(arm.chain);
    const JointVector<6> q = random_joints<6>(rng);
    JointVector<6> backwards;
    for (int j = 0; j < 6; ++j) backwards(j) = -q(5 - j);
    EXPECT_LT(difference(mirror.pose(backwards), inverse_of(arm.chain.pose(q))), 1e-14) << arm.name;
    const auto inside = internals(mirror);
    EXPECT_TRUE(inside.mirrored()) << arm.name;
    EXPECT_EQ(inside.kind(), arm.kind) << arm.name;
  }
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

TEST(ClosedForm, RefusesAWristOnAnArmThatDoesNotBend) {
  // Joint 4 of the WAM is its elbow: without it, two spheres are left.
  const std::string what = complaint([] { ClosedForm(robots::barrett_wam().chain, HeldJoint{3, 0.3}); });
  EXPECT_NE(what.find("the last three axes meet in a point, but the other three"), std::string::npos) << what;
}

TEST(ClosedForm, RefusesAnArmWithoutUpperArm) {
  auto rows = robots::abb_irb120().chain.rows();
  rows[1].a = 0;  // joints 2 and 3 turn about the same axis
  const std::string what = complaint([&] { ClosedForm{DhChain<6>::from_rows(rows)}; });
  EXPECT_NE(what.find("bend the arm"), std::string::npos) << what;
}

TEST(ClosedForm, RefusesPrismaticJoints) {
  auto rows = robots::abb_irb120().chain.rows();
  rows[2].joint = JointType::prismatic;
  const std::string what = complaint([&] { ClosedForm{DhChain<6>::from_rows(rows)}; });
  EXPECT_NE(what.find("joint 3 is prismatic"), std::string::npos) << what;
}

TEST(ClosedForm, RefusesToHoldAJointThatIsNotThere) {
  for (const int joint : {-1, 7, 100}) {
    const std::string what = complaint([&] { ClosedForm(robots::barrett_wam().chain, HeldJoint{joint, 0}); });
    EXPECT_NE(what.find("no joint " + std::to_string(joint + 1)), std::string::npos) << what;
  }
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

// ---------------------------------------------------------------------------------------------------------------------
// singular poses

enum Factor { shoulder, elbow, wrist };

/// Turns one joint until a factor of the determinant is zero. @return whether there is such a value
template <int N>
bool make_singular(const ClosedForm<N>& form, Factor factor, JointVector<N>& q) {
  constexpr int steps = 90;
  for (int joint = N - 1; joint >= 0; --joint) {
    if (joint == form.held_joint()) continue;
    const auto value = [&](double x) {
      JointVector<N> at = q;
      at(joint) = x;
      return form.distances(at).values()[static_cast<std::size_t>(factor)];
    };
    for (int k = 0; k < steps; ++k) {
      double low = q(joint) + 2 * pi * k / steps, high = q(joint) + 2 * pi * (k + 1) / steps;
      const double start = value(low);
      if (std::abs(start - value(high)) < 1e-9 || start * value(high) > 0) continue;
      for (int i = 0; i < 80; ++i) {
        const double middle = 0.5 * (low + high);
        (start * value(middle) > 0 ? low : high) = middle;
      }
      q(joint) = vernier_test::without_turns(low);
      return true;
    }
  }
  return false;
}

/// Roots at singular joint values that are also `near`: exact, and the generating ones among them. Where two roots
/// meet, joints keep half of their digits.
template <int N, class Convention>
void expect_roots_at(const DhChain<N, Convention>& arm, const ClosedForm<N>& form, const JointVector<N>& q,
                     const std::string& name, double generating) {
  const Isometry3 target = arm.pose(q);
  const auto roots = form.roots(target, q);
  const Quality at = quality(arm, roots, target, q);
  EXPECT_GE(at.roots, 1) << name;
  EXPECT_LT(at.residual, exact) << name << " at " << ::testing::PrintToString(RealMatrix::of(q));
  EXPECT_LT(at.generating, generating) << name << " at " << ::testing::PrintToString(RealMatrix::of(q));
}

constexpr double offsets[] = {0, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4, 1e-3};

TEST(SingularPoses, StraightWrists) {
  Rng rng(9);
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (int i = 0; i < 20; ++i) {
      JointVector<6> q = random_joints<6>(rng);
      ASSERT_TRUE(make_singular(form, wrist, q)) << name;
      for (const double offset : offsets)
        for (const double side : {-1.0, 1.0}) {
          JointVector<6> off = q;
          off(form.mirrored() ? 1 : 4) += side * offset;
          // joints 4 and 6 are known to the rounding errors of a pose over the offset
          expect_roots_at(chain, form, off, name + ", wrist off by " + std::to_string(side * offset * 1e9) + " nrad",
                          offset > 1e-11 ? std::max(1e-6, 1e-12 / offset) : 1e-6);
        }
    }
  });
}

TEST(SingularPoses, StretchedElbows) {
  Rng rng(10);
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (int i = 0; i < 20; ++i) {
      JointVector<6> q = random_joints<6>(rng);
      if (!make_singular(form, elbow, q) || std::abs(form.distances(q).wrist) < 0.01) continue;
      for (const double offset : offsets) {
        JointVector<6> off = q;
        off(form.mirrored() ? 3 : 2) += offset;
        expect_roots_at(chain, form, off, name + ", elbow", 1e-3);
      }
    }
  });
}

TEST(SingularPoses, WristCentresOnShoulderSurfaces) {
  Rng rng(11);
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (int i = 0; i < 20; ++i) {
      JointVector<6> q = random_joints<6>(rng);
      if (!make_singular(form, shoulder, q) || std::abs(form.distances(q).wrist) < 0.01) continue;
      for (const double offset : offsets) {
        JointVector<6> off = q;
        off(form.mirrored() ? 4 : 1) += offset;
        expect_roots_at(chain, form, off, name + ", shoulder", 1e-3);
      }
    }
  });
}

TEST(SingularPoses, Crossings) {
  Rng rng(12);
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (int i = 0; i < 20; ++i) {
      JointVector<6> q = random_joints<6>(rng);
      // the wrist's distance depends on no other joint, that of the shoulder on those of the elbow
      ASSERT_TRUE(make_singular(form, wrist, q));
      if (i % 2 == 0 && !make_singular(form, elbow, q)) continue;
      if (i % 4 != 0 && !make_singular(form, shoulder, q)) continue;
      // elbow and shoulder keep half of their digits, so joint 4 is any value or noise: all are exact
      expect_roots_at(chain, form, q, name + ", crossing " + std::to_string(i % 4), 10);
    }
  });
}

TEST(SingularPoses, CommonAngles) {
  const double common[] = {0, pi / 2, -pi / 2, pi};
  const auto expect_met = [&](const auto& chain, const char* name) {
    const ClosedForm form(chain);
    int none = 0;
    double residual = 0;
    for (int code = 0; code < 4096; ++code) {
      JointVector<6> q;
      for (int j = 0; j < 6; ++j) q(j) = common[code >> (2 * j) & 3];
      // near matters: with the wrist of a UR arm straight, q2 + q3 + q4 is arbitrary, but not every value is in reach
      const Quality at = quality(chain, form.roots(chain.pose(q), q), chain.pose(q), q);
      none += at.roots == 0;
      residual = std::max(residual, at.residual);
    }
    EXPECT_EQ(none, 0) << name;
    EXPECT_LT(residual, exact) << name;
  };
  expect_met(robots::ur10().chain, "ur10");
  expect_met(robots::ur5().chain, "ur5");
  expect_met(robots::abb_irb120().chain, "irb120");
  expect_met(robots::puma560().chain, "puma560");
  expect_met(robots::puma560_modified().chain, "puma560_modified");
  for (const Case& arm : cases()) expect_met(arm.chain, arm.name.c_str());
}

TEST(SingularPoses, StretchedIsNotOutOfReach) {
  // margins are 0 or say that the target is out of reach: rounding errors do not
  const auto ur10 = robots::ur10().chain;
  const ClosedForm form(ur10);
  Rng rng(14);
  int outside = 0;
  for (int i = 0; i < 1000; ++i) {
    JointVector<6> q = random_joints<6>(rng);
    q(2) = 0;
    for (const auto& root : form.roots(ur10.pose(q))) outside += root.margin > 0 && root.margin < rounding;
  }
  EXPECT_EQ(outside, 0);
}

TEST(SingularPoses, WristCentresOnAxisOne) {
  // where axes 2 and 3 meet, joint 1 is arbitrary there
  const auto found = std::find_if(cases().begin(), cases().end(),
                                  [](const Case& arm) { return arm.kind == ArmKind::second_meets_third; });
  const DhChain<6>& chain = found->chain;
  const ClosedForm form(chain);
  Rng rng(16);
  const auto off_axis = [&](const JointVector<6>& q) {
    const auto origins = chain.links(q).origin;
    return vernier_test::vector({origins(0, 3), origins(1, 3)});
  };
  int targets = 0;
  for (int i = 0; i < 50; ++i) {
    JointVector<6> q = random_joints<6>(rng);
    for (int k = 0; k < 60; ++k) {  // Newton's method on joints 2 and 3
      RealMatrix derivative(2, 2);
      for (int j = 0; j < 2; ++j) {
        JointVector<6> ahead = q;
        ahead(1 + j) += 1e-6;
        derivative.set_block(0, j, (off_axis(ahead) - off_axis(q)) / 1e-6);
      }
      const RealMatrix step = derivative.solve(off_axis(q));
      for (int j = 0; j < 2; ++j) q(1 + j) -= step(j) * std::min(1.0, 0.3 / step.norm());
    }
    if (!(off_axis(q).norm() < 1e-15)) continue;
    ++targets;
    expect_roots_at(chain, form, q, found->name, 1e-6);
    for (const auto& root : form.roots(chain.pose(q), q)) EXPECT_EQ(root.free & 1u, 1u);
  }
  EXPECT_GT(targets, 20);
}

TEST(SingularPoses, NearDecidesTheJointThatIsFree) {
  // straight wrist: joints 4 and 6 turn about one axis
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  JointVector<6> q{0.3, 0.4, -0.5, 0.6, 0, 0.8};
  for (const double value : {-2.0, 0.0, 1.25}) {
    JointVector<6> near = JointVector<6>::Zero();
    near(3) = value;
    int straight = 0;
    for (const auto& root : form.roots(irb.pose(q), near)) {
      if (std::abs(root.joints(4)) > 1e-9) continue;
      ++straight;
      EXPECT_EQ(root.free, 1u << 3);
      EXPECT_EQ(root.joints(3), value);
      EXPECT_LT(difference(irb.pose(root.joints), irb.pose(q)), exact);
    }
    EXPECT_EQ(straight, 1);
  }

  // the same arm held by its tool: joints 3 and 1 turn about one axis
  const auto mirror = mirror_image(irb);
  const JointVector<6> backwards{-0.8, 0, -0.6, 0.5, -0.4, -0.3};
  for (const double value : {-2.0, 0.0, 1.25}) {
    JointVector<6> near = JointVector<6>::Zero();
    near(2) = value;
    int straight = 0;
    for (const auto& root : ClosedForm(mirror).roots(mirror.pose(backwards), near)) {
      if (std::abs(root.joints(1)) > 1e-9) continue;
      ++straight;
      EXPECT_EQ(root.free, 1u << 2);
      EXPECT_EQ(root.joints(2), value);
      EXPECT_LT(difference(mirror.pose(root.joints), mirror.pose(backwards)), exact);
    }
    EXPECT_EQ(straight, 1);
  }

  // wrist centre on axis 1
  q = {0.3, 0.4, -0.5, 0.6, 0.9, 0.8};
  ASSERT_TRUE(make_singular(form, shoulder, q));
  for (const double value : {-2.0, 0.0, 1.25}) {
    JointVector<6> near = JointVector<6>::Zero();
    near(0) = value;
    const auto roots = form.roots(irb.pose(q), near);
    EXPECT_GT(roots.count, 0);
    for (const auto& root : roots) {
      EXPECT_EQ(root.free, 1u);
      EXPECT_EQ(root.joints(0), value);
      EXPECT_LT(difference(irb.pose(root.joints), irb.pose(q)), exact);
    }
  }
}

// With the wrist of a UR arm straight, the sum of joints 2 to 4 is arbitrary, but near the end of the reach few values
// bring the arm there: not the one that is near, but one is found.
TEST(SingularPoses, AStraightWristTakesASumThatTheArmReaches) {
  const auto ur10 = robots::ur10().chain;
  const ClosedForm form(ur10);
  int away = 0;
  for (const auto& [bent, turned] : {std::pair{0.3, 0.5},
                                     {0.6, 0.5},
                                     {0.1, 0.0},
                                     {0.1, 0.8},
                                     {0.1, 1.6},
                                     {0.1, 2.4},
                                     {0.1, 3.2},
                                     {0.1, 4.0},
                                     {0.1, 4.8},
                                     {0.1, 5.6}}) {
    const JointVector<6> q{0.4, -0.8, bent, turned, 0, 0.7};
    const Isometry3 target = ur10.pose(q);
    for (int k = 0; k < 16; ++k) {
      JointVector<6> near = q;
      near(3) += k * pi / 8 + 0.03;
      int straight = 0;
      for (const auto& root : form.roots(target, near)) {
        if (root.margin > 0 || std::abs(std::sin(root.joints(4))) > 1e-6) continue;
        ++straight;
        EXPECT_LT(difference(ur10.pose(root.joints), target), exact);
        const double sum = root.joints(1) + root.joints(2) + root.joints(3);
        away += std::abs(vernier_test::without_turns(sum - near(1) - near(2) - near(3))) > 0.1;
      }
      EXPECT_GT(straight, 0) << bent << ' ' << turned << ' ' << k;
    }
  }
  EXPECT_GT(away, 5);
}

// Axes 1 and 2 parallel, and forearm and upper arm of the same length: folded, the wrist centre is on axis 2, and
// joint 2 is any value; here that of `near`.
TEST(SingularPoses, NearDecidesTheSecondJointOfAFoldedArm) {
  const DhChain<6> arm{{{{.a = 400_mm, .alpha = 0_deg, .d = 200_mm},
                         {.a = 300_mm, .alpha = 90_deg, .d = 50_mm},
                         {.a = 300_mm, .alpha = -90_deg, .d = 0_mm},
                         {.a = 0_mm, .alpha = 90_deg, .d = 0_mm},
                         wrist_5,
                         wrist_6}}};
  ASSERT_EQ(internals(arm).kind(), ArmKind::first_parallel_to_second);
  const JointVector<6> q{0.3, 0.4, pi, 0.5, 0.6, 0.7};
  const Isometry3 target = arm.pose(q);
  JointVector<6> near = JointVector<6>::Constant(9);
  for (const double value : {-2.0, 0.25, 1.25}) {
    near(1) = value;
    int folded = 0;
    for (const auto& root : ClosedForm(arm).roots(target, near)) {
      EXPECT_LT(difference(arm.pose(root.joints), target), exact);
      if ((root.free & 2u) == 0) continue;
      ++folded;
      EXPECT_EQ(root.joints(1), value);
      EXPECT_NEAR(vernier_test::without_turns(root.joints(0) - q(0)), 0, 1e-9);  // the wrist is where axis 2 is
    }
    EXPECT_EQ(folded, 2);  // two wrists
  }
}

TEST(SingularPoses, SamplesOnRequest) {
  const auto irb = robots::abb_irb120().chain;
  const ClosedForm form(irb);
  const JointVector<6> q{0.3, 0.4, -0.5, 0.6, 0.003, 0.8};
  const auto plain = form.roots(irb.pose(q)), sampled = form.roots(irb.pose(q), q, 0.01);
  EXPECT_GT(sampled.count, plain.count);
  EXPECT_LE(sampled.count, detail::SixAxisRoots::capacity);
  for (const auto& root : sampled) {
    // a sample has joint 4 at some value and misses by no more than the width
    EXPECT_LT(difference(irb.pose(root.joints), irb.pose(q)), root.margin > 0 ? 0.01 : exact);
  }
  const JointVector<6> regular{0.3, 0.4, -0.5, 0.6, 0.5, 0.8};
  EXPECT_EQ(form.roots(irb.pose(regular)).count, form.roots(irb.pose(regular), q, 0.01).count);
}

// Sampled roots are marked as such; without them the roots are those of a call that asks for no samples.
TEST(SingularPoses, SamplesAreMarked) {
  Rng rng(22);
  int samples = 0;
  for_all_arms([&](const std::string& name, const auto& chain) {
    const ClosedForm form(chain);
    for (const Factor factor : {shoulder, elbow, wrist}) {
      JointVector<6> q = random_joints<6>(rng);
      if (!make_singular(form, factor, q)) continue;
      for (double& value : q) value += 1e-4;
      const auto plain = form.roots(chain.pose(q), q), sampled = form.roots(chain.pose(q), q, 0.01);
      int met = 0, met_of_plain = 0, unmarked = 0;
      for (const auto& root : plain) met_of_plain += root.margin == 0;
      for (const auto& root : sampled) {
        met += root.margin == 0 && !root.sampled;
        samples += root.sampled;
        unmarked += !root.sampled;
      }
      // behind three parallel axes those of a straight wrist are always to be tried
      if (factor != wrist || internals(chain).kind() != ArmKind::three_parallel) {
        EXPECT_LE(unmarked, 8) << name << ' ' << factor;
      }
      EXPECT_EQ(met, met_of_plain) << name << ' ' << factor;
    }
  });
  EXPECT_GT(samples, 100);
}

// ---------------------------------------------------------------------------------------------------------------------
// out of reach

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
