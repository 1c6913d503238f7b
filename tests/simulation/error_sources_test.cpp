// SPDX-License-Identifier: BSD-3-Clause
// Simulated arms with every error source: drawn joint errors, backlash, outliers; sizes as asked for, seeds that decide
// alone, sources that do not disturb each other.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vernier/core/rigid_motions.hpp>
#include <vernier/kinematics/framed.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/error_sources.hpp>
#include <vernier/testing/kinematic_laws.hpp>

#include "complaint.hpp"
#include "larger.hpp"
#include "laws.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace error_sources_test {
namespace {

using namespace vernier;
using vernier_test::complaint;
using vernier_test::RealMatrix;

using Chain = DhChain<6>;
const Chain nominal = robots::abb_irb120().chain;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// The coefficient of a name.
double coefficient(const JointErrors& errors, const std::string& name) {
  const auto names = errors.terms().names();
  const auto at = std::find(names.begin(), names.end(), name);
  EXPECT_NE(at, names.end()) << name;
  return at == names.end() ? not_a_number : errors.coefficients()(at - names.begin());
}

JointRows<6> some_joints(Index n) {
  Rng rng(9);
  return vernier_test::random_joint_rows<6>(rng, n, 2.0);
}

TEST(DrawJointErrors, HasEverySourceByDefault) {
  const auto errors = draw_joint_errors(nominal);
  EXPECT_EQ(errors.coefficients().size(), 6 + 5 + 21 + 6 * 2 * 3);
  for (const double coefficient : errors.coefficients()) EXPECT_NE(coefficient, 0);
}

TEST(DrawJointErrors, HasTheSizesItClaims) {
  const JointErrorSizes sizes{
      .gear_ratio = 0.3e-3, .coupling = 0.1e-3, .harmonics = 2, .decay = 2, .ripple = 0.05e-3, .ripple_harmonic = 4};
  const Index n = 1000;
  VectorX sum = VectorX::Zero(6 + 5 + 21 + 6 * 6), squares = sum;
  const double harmonics[] = {0.2e-3, 0.2e-3, 0.05e-3, 0.05e-3, 0.05e-3, 0.05e-3};  // of each joint
  VectorX expected = sum;
  for (Index k = 0; k < expected.size(); ++k)
    expected(k) = k < 6    ? sizes.gear_ratio
                  : k < 11 ? sizes.coupling
                  : k < 32 ? sizes.compliance
                           : harmonics[(k - 32) % 6];
  for (Index seed = 0; seed < n; ++seed) {
    const VectorX beta = draw_joint_errors(nominal, sizes, static_cast<std::uint64_t>(seed)).coefficients();
    ASSERT_EQ(beta.size(), sum.size());
    for (Index k = 0; k < beta.size(); ++k) {
      if (k >= 11 && k < 32) {
        ASSERT_GT(beta(k), 0);  // weights pull down, springs yield
      }
      sum(k) += beta(k);
      squares(k) += beta(k) * beta(k);
    }
  }
  // five deviations of each estimate from n normals; the mean of a positive one is sqrt(2/pi)
  const double mean_bound = 5 / std::sqrt(static_cast<double>(n)), variance_bound = mean_bound * std::sqrt(2.0);
  for (Index k = 0; k < sum.size(); ++k) {
    const double mean = k >= 11 && k < 32 ? 0.797885 : 0;
    EXPECT_NEAR(sum(k) / expected(k) / static_cast<double>(n), mean, mean_bound) << k;
    EXPECT_NEAR(squares(k) / (expected(k) * expected(k)) / static_cast<double>(n), 1, variance_bound) << k;
  }
}

TEST(DrawJointErrors, SeedsDecideAlone) {
  const auto beta = [](std::uint64_t seed) { return draw_joint_errors(nominal, {}, seed).coefficients(); };
  EXPECT_EQ(RealMatrix(beta(1)), RealMatrix(beta(1)));
  const VectorX one = beta(1), two = beta(2);
  for (Index k = 0; k < one.size(); ++k) EXPECT_NE(one(k), two(k));
}

TEST(DrawJointErrors, SwitchingOneOffLeavesTheOthers) {
  const JointErrorSizes all{.harmonics = 3, .ripple = 1e-5, .ripple_harmonic = 20};
  const auto with = draw_joint_errors(nominal, all, 7);
  struct Case {
    const char* name;
    double JointErrorSizes::*size;
    Index terms;
  };
  for (const Case& source :
       {Case{"gear", &JointErrorSizes::gear_ratio, 6}, Case{"coupling", &JointErrorSizes::coupling, 5},
        Case{"sag", &JointErrorSizes::compliance, 21}, Case{"harmonic", &JointErrorSizes::harmonic, 6 * 2 * 3},
        Case{"ripple", &JointErrorSizes::ripple, 6 * 2}}) {
    JointErrorSizes sizes = all;
    sizes.*source.size = 0;
    const auto without = draw_joint_errors(nominal, sizes, 7);
    EXPECT_EQ(with.coefficients().size() - without.coefficients().size(), source.terms) << source.name;
    for (const std::string& name : without.terms().names()) {
      const double kept = coefficient(without, name);
      if (kept != 0) {
        EXPECT_EQ(kept, coefficient(with, name)) << name;
      }
    }
  }
  EXPECT_TRUE(draw_joint_errors(nominal, {0, 0, 0, 0}, 7).empty());
}

// Sources of the same size differ in every coefficient: each joint of each has its own random numbers.
TEST(DrawJointErrors, NoRandomNumberIsUsedTwice) {
  const auto errors = draw_joint_errors(nominal, {1, 1, 1, 1, 3, 0, 1, 20}, 7);
  std::vector<double> sizes;
  for (const double coefficient : errors.coefficients()) sizes.push_back(std::abs(coefficient));
  ASSERT_EQ(sizes.size(), 6u + 5u + 21u + 6u * 2u * 4u);
  std::sort(sizes.begin(), sizes.end());
  for (std::size_t k = 1; k < sizes.size(); ++k) EXPECT_GT(sizes[k], sizes[k - 1]);
}

TEST(DrawJointErrors, MoreHarmonicsKeepTheFormer) {
  const auto few = draw_joint_errors(nominal, {.harmonics = 3}, 8);
  const auto many = draw_joint_errors(nominal, {.harmonics = 60}, 8);
  EXPECT_EQ(many.coefficients().size() - few.coefficients().size(), 6 * 2 * 57);
  for (const std::string& name : few.terms().names()) EXPECT_EQ(coefficient(few, name), coefficient(many, name));
}

TEST(DrawJointErrors, PrismaticJointsHaveNoHarmonics) {
  const DhChain<2> arm({{.a = 0.3}, {.alpha = 1, .joint = JointType::prismatic}});
  const auto errors = draw_joint_errors(arm, {.ripple = 1e-5});
  EXPECT_EQ(errors.terms().transmission[0].size(), 2 * 4);
  EXPECT_EQ(errors.terms().transmission[1].size(), 0);
  EXPECT_EQ(errors.coefficients().size(), 2 + 1 + 3 + 2 * 4);
}

TEST(DrawJointErrors, ASingleJointHasNoCoupling) {
  const DhChain<1> turntable({{.a = 0.2, .alpha = 1}});
  const auto errors = draw_joint_errors(turntable, {.harmonics = 1});
  EXPECT_EQ(errors.terms().names(), (std::vector<std::string>{"gear1", "sag1_1", "cos1_1", "sin1_1"}));
}

TEST(DrawJointErrors, GravityPullsWhereItIsTold) {
  const auto errors = draw_joint_errors(nominal, {.down = Vector3::UnitX()}, 1);
  EXPECT_EQ(errors.terms().gravity->down(), Vector3(Vector3::UnitX()));
}

TEST(DrawJointErrors, UnusableSizesAreNamed) {
  const auto says = [](const JointErrorSizes& bad) {
    return complaint([&] { (void)draw_joint_errors(nominal, bad); });
  };
  EXPECT_EQ(says({.gear_ratio = -0.25}), "JointErrorSizes: gear_ratio is -0.25, must be 0 or more and finite");
  EXPECT_NE(says({.coupling = not_a_number}).find("coupling is nan"), std::string::npos);
  EXPECT_NE(says({.compliance = -1}).find("compliance is -1"), std::string::npos);
  EXPECT_NE(says({.harmonic = 1 / 0.0}).find("harmonic is inf"), std::string::npos);
  EXPECT_NE(says({.harmonics = -3}).find("harmonics is -3"), std::string::npos);
  EXPECT_NE(says({.harmonics = 501}).find("harmonics is 501"), std::string::npos);
  EXPECT_NE(says({.decay = -2}).find("decay is -2"), std::string::npos);
  EXPECT_NE(says({.ripple = -4}).find("ripple is -4"), std::string::npos);
  EXPECT_NE(says({.harmonics = 12, .ripple = 1e-5, .ripple_harmonic = 12}).find("ripple_harmonic is 12"),
            std::string::npos);
  EXPECT_NE(says({.ripple = 1e-5, .ripple_harmonic = 501}).find("ripple_harmonic is 501"), std::string::npos);
  EXPECT_NE(says({.down = Vector3(0, 0, -9.81)}).find("9.81"), std::string::npos);
  EXPECT_EQ(says({.ripple_harmonic = -1}), "");  // no ripple, so its harmonic says nothing
}

TEST(SimulatedArm, IsAModelLikeAnyOther) {
  const Isometry3 base = rigid_motion(Matrix3::Identity(), Vector3(1, 2, 0.5)),
                  tool = rigid_motion(Matrix3::Identity(), Vector3(0.05, 0, 0.1));
  const JointErrorSizes sizes{.harmonics = 10, .ripple = 2e-5};
  const Framed actual(WithJointErrors<Chain>(nominal, draw_joint_errors(nominal, sizes, 3)), base, tool);
  static_assert(KinematicModel<std::remove_const_t<decltype(actual)>>);
  const auto q = some_joints(40);
  EXPECT_TRUE(vernier_test::no_violations(vernier::testing::kinematic_model_violations(actual, q)));

  const auto data = measure(actual, q);
  const Framed ideal(nominal, base, tool);
  double largest = 0;
  for (Index i = 0; i < q.rows(); ++i) {
    EXPECT_EQ(data.position(i), translation(actual.pose(data.joints(i))));
    largest = vernier_test::larger(largest, (data.position(i) - ideal.position(data.joints(i))).norm());
  }
  EXPECT_GT(largest, 0.1e-3);  // the defaults are tenths of a millimetre at this arm's reach of 0.6 m
  EXPECT_LT(largest, 5e-3);
}

TEST(ApproachDirections, AreSignsOfTheLastMove) {
  JointRows<2> q(6, 2);
  q << 0, -1,  // from the start at zero: joint 1 has not moved
      1, -1,   // a joint that stands still was still approached from above
      2, 3,    //
      2, 2,    //
      -1, 2,   //
      -1, 2;
  RealMatrix expected(6, 2, {0, -1, 1, -1, 1, 1, 1, -1, -1, -1, -1, -1});
  EXPECT_EQ(RealMatrix::of(approach_directions(q)), expected);
  expected(0, 0) = -1;
  EXPECT_EQ(RealMatrix::of(approach_directions(q, JointVector<2>(0.5, 0))), expected);
  EXPECT_EQ(approach_directions(JointRows<2>(0, 2)).rows(), 0);
}

TEST(Backlash, LagsBehindTheMove) {
  // One joint about z, its tool 1 m out: half a gap of 0.01 rad.
  const DhChain<1> turntable({{.a = 1}});
  const JointRows<1> q = vernier_test::vector({0.5, 0.5, 0.5}), approach = vernier_test::vector({1, -1, 0});
  const auto data = measure_with_backlash(turntable, q, JointVector<1>(0.01), approach);
  EXPECT_EQ(RealMatrix(data.joints()), RealMatrix(q));
  const double angles[] = {0.49, 0.51, 0.5};
  for (Index i = 0; i < 3; ++i)
    EXPECT_LE((data.position(i) - Vector3(std::cos(angles[i]), std::sin(angles[i]), 0)).norm(), 1e-15) << i;
}

TEST(Backlash, IsTheModelAtTheJointsWithinTheirGaps) {
  const WithJointErrors<Chain> actual(nominal, draw_joint_errors(nominal, {}, 4));
  const auto q = some_joints(30);
  const JointVector<6> backlash{1e-4, 2e-4, 0, 3e-4, 5e-4, 1e-3};
  const auto approach = approach_directions(q);
  const auto data = measure_with_backlash(actual, q, backlash, approach);
  for (Index i = 0; i < q.rows(); ++i) {
    JointVector<6> effective;
    for (int j = 0; j < 6; ++j) effective(j) = q(i, j) - approach(i, j) * backlash(j);
    EXPECT_LE((data.position(i) - actual.position(effective)).norm(), 1e-15);
    EXPECT_LE((data.orientation(i) - rotation(actual.pose(effective))).norm(), 1e-14);
  }
}

TEST(Backlash, NoneIsMeasureToTheBit) {
  const MeasurementNoise noise{.position = 0.02e-3, .orientation = 0.1e-3};
  const auto q = some_joints(20);
  const auto with = measure_with_backlash(nominal, q, JointVector<6>::Zero(), approach_directions(q), noise, 5);
  const auto without = measure(nominal, q, noise, 5);
  EXPECT_EQ(RealMatrix(with.positions()), RealMatrix(without.positions()));
  EXPECT_EQ(RealMatrix(with.orientations()), RealMatrix(without.orientations()));
  EXPECT_FALSE(
      measure_with_backlash(nominal, q, JointVector<6>::Zero(), JointRows<6>::Zero(20, 6), {.with_orientations = false})
          .has_orientations());
}

TEST(Backlash, UnusableGapsAndDirectionsAreNamed) {
  const auto q = some_joints(3);
  const auto says = [&](const JointVector<6>& backlash, const JointRows<6>& approach) {
    return complaint([&] { (void)measure_with_backlash(nominal, q, backlash, approach); });
  };
  const JointVector<6> none = JointVector<6>::Zero();
  const JointRows<6> rising = JointRows<6>::Ones(3, 6);
  JointVector<6> negative = none;
  negative(2) = -0.25;
  JointRows<6> odd = rising;
  odd(1, 3) = 0.5;
  EXPECT_EQ(says(none, rising), "");
  EXPECT_NE(says(negative, rising).find("joint 3 is -0.25"), std::string::npos);
  EXPECT_NE(says(JointVector<6>::Constant(not_a_number), rising).find("joint 1 is nan"), std::string::npos);
  EXPECT_NE(says(none, JointRows<6>::Ones(2, 6)).find("2 rows of directions for 3"), std::string::npos);
  EXPECT_NE(says(none, odd).find("row 1, joint 4 is approached from 0.5"), std::string::npos);
  odd(1, 3) = not_a_number;
  EXPECT_NE(says(none, odd).find("row 1, joint 4"), std::string::npos);
}

TEST(Outliers, AreAsManyAndAsFarAsAskedFor) {
  const auto data = measure(nominal, some_joints(200));
  const auto out = with_outliers(data, 0.1, 5e-3, 11);
  ASSERT_EQ(out.rows.size(), 20u);
  EXPECT_TRUE(std::is_sorted(out.rows.begin(), out.rows.end()));
  EXPECT_EQ(RealMatrix(out.data.joints()), RealMatrix(data.joints()));
  EXPECT_EQ(RealMatrix(out.data.orientations()), RealMatrix(data.orientations()));
  std::vector<Index> moved;
  for (Index i = 0; i < data.size(); ++i) {
    const double distance = (out.data.position(i) - data.position(i)).norm();
    if (distance == 0) continue;
    moved.push_back(i);
    EXPECT_NEAR(distance, 5e-3, 1e-15);
  }
  EXPECT_EQ(moved, out.rows);
}

TEST(Outliers, PointEverywhere) {
  const auto data = measure(nominal, some_joints(3000), {.with_orientations = false});
  const auto out = with_outliers(data, 1, 1, 12);
  ASSERT_EQ(out.rows.size(), 3000u);
  const RealMatrix directions = RealMatrix(out.data.positions()) - data.positions();
  for (int k = 0; k < 3; ++k) {  // five deviations of the means of a component and of its square on a sphere
    EXPECT_NEAR(directions.col(k).mean(), 0, 5 / std::sqrt(3 * 3000.0));
    EXPECT_NEAR(directions.col(k).squared_norm() / 3000, 1 / 3.0, 5 * std::sqrt(4 / 45.0 / 3000));
  }
}

TEST(Outliers, SeedsDecideAlone) {
  const auto data = measure(nominal, some_joints(100));
  const auto a = with_outliers(data, 0.2, 1e-3, 1), b = with_outliers(data, 0.2, 1e-3, 1),
             c = with_outliers(data, 0.2, 1e-3, 2);
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(RealMatrix(a.data.positions()), RealMatrix(b.data.positions()));
  EXPECT_NE(a.rows, c.rows);
}

TEST(Outliers, MayBeNoneOrAll) {
  const auto data = measure(nominal, some_joints(7));
  EXPECT_TRUE(with_outliers(data, 0, 1, 1).rows.empty());
  EXPECT_EQ(RealMatrix(with_outliers(data, 0, 1, 1).data.positions()), RealMatrix(data.positions()));
  EXPECT_EQ(with_outliers(data, 1, 1, 1).rows, (std::vector<Index>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(with_outliers(data, 0.2, 1, 1).rows.size(), 1u);  // 1.4
  EXPECT_TRUE(with_outliers(Dataset<6>(), 0.5, 1, 1).rows.empty());
}

TEST(Outliers, UnusableOptionsAreNamed) {
  const auto data = measure(nominal, some_joints(7));
  const auto says = [&](double share, double size) {
    return complaint([&] { (void)with_outliers(data, share, size, 1); });
  };
  EXPECT_NE(says(1.5, 1).find("share is 1.5"), std::string::npos);
  EXPECT_NE(says(-0.5, 1).find("share is -0.5"), std::string::npos);
  EXPECT_NE(says(not_a_number, 1).find("share is nan"), std::string::npos);
  EXPECT_NE(says(0.5, -2).find("size is -2"), std::string::npos);
  EXPECT_NE(says(0.5, not_a_number).find("size is nan"), std::string::npos);
}

}  // namespace
}  // namespace error_sources_test
