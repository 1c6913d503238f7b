// SPDX-License-Identifier: BSD-3-Clause
// DH chains: tables at compile time, a case worked by hand, the laws, and the five parameters of a row.

#include "vernier/kinematics/dh_chain.hpp"

#include <gtest/gtest.h>

#include <type_traits>

#include "complaint.hpp"
#include "laws.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/literals.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/testing/kinematic_laws.hpp"

namespace vn = vernier;
using namespace vernier::literals;
using vernier_test::difference;
using vernier_test::no_violations;
using vernier_test::RealMatrix;

namespace dh_chain_test {
namespace {

constexpr double pi = std::numbers::pi;

// A table is a constant expression, with the chain's braces or the table's.
constexpr vn::DhChain<2> planar{{{
    {.a = 300_mm},
    {.a = 200_mm},
}}};
constexpr vn::DhChain<2> planar_in_two_braces{{
    {.a = 300_mm},
    {.a = 200_mm},
}};
constexpr vn::DhChain<1> one_joint{{{{.a = 300_mm}}}};
constexpr vn::DhChain<2, vn::ModifiedDh> modified{{{
    {.alpha = 90_deg, .joint = vn::JointType::prismatic},
    {.a = 200_mm},
}}};
static_assert(planar.row(0).a == 0.3 && planar.row(1).a == 0.2 && planar.row(1).joint == vn::JointType::revolute);
static_assert(planar_in_two_braces.row(0).a == 0.3 && planar_in_two_braces.row(1).a == 0.2);
static_assert(one_joint.row(0).a == 0.3);
static_assert(modified.row(0).joint == vn::JointType::prismatic && modified.row(1).a == 0.2);
static_assert(planar.dof == 2 && planar.num_parameters == 10);

// A missing or surplus row does not compile, however many braces there are.
template <class Chain>
concept OneRow = requires {
  Chain{{{.a = 1}}};
};
template <class Chain>
concept OneRowInAnotherBrace = requires {
  Chain{{{{.a = 1}}}};
};
template <class Chain>
concept TwoRows = requires {
  Chain{{{.a = 1}, {.d = 2}}};
};
template <class Chain>
concept TwoRowsInAnotherBrace = requires {
  Chain{{{{.a = 1}, {.d = 2}}}};
};
template <class Chain>
concept ThreeRows = requires {
  Chain{{{.a = 1}, {.d = 2}, {.theta = 3}}};
};
template <class Chain>
concept ThreeRowsInAnotherBrace = requires {
  Chain{{{{.a = 1}, {.d = 2}, {.theta = 3}}}};
};
static_assert(!TwoRows<vn::DhChain<1>> && !TwoRowsInAnotherBrace<vn::DhChain<1>>);
static_assert(!OneRow<vn::DhChain<2>> && !OneRowInAnotherBrace<vn::DhChain<2>>);
static_assert(TwoRows<vn::DhChain<2>> && TwoRowsInAnotherBrace<vn::DhChain<2>>);
static_assert(!ThreeRows<vn::DhChain<2>> && !ThreeRowsInAnotherBrace<vn::DhChain<2>>);
static_assert(!TwoRows<vn::DhChain<3>> && !TwoRowsInAnotherBrace<vn::DhChain<3>>);
static_assert(ThreeRows<vn::DhChain<3>> && ThreeRowsInAnotherBrace<vn::DhChain<3>>);
static_assert(!ThreeRows<vn::DhChain<6, vn::ModifiedDh>> && !ThreeRowsInAnotherBrace<vn::DhChain<6, vn::ModifiedDh>>);
static_assert(std::is_constructible_v<vn::DhChain<2>, const vn::DhRow (&)[2]>);
static_assert(!std::is_constructible_v<vn::DhChain<2>, const vn::DhRow (&)[1]>);
static_assert(!std::is_constructible_v<vn::DhChain<2>, const vn::DhRow (&)[3]>);
static_assert(!std::is_default_constructible_v<vn::DhChain<2>>);

TEST(DhChain, PlanarArmWorkedByHand) {
  // q = (30, 60) deg: the second link points along y. x = 0.3 cos 30, y = 0.3 sin 30 + 0.2.
  const vn::JointVector<2> q(30_deg, 60_deg);
  const double x = 0.3 * std::sqrt(3.0) / 2, y = 0.15 + 0.2;
  const auto [pose, jacobian] = planar.pose_and_jacobian(q);
  EXPECT_NEAR(pose(0, 3), x, 1e-15);
  EXPECT_NEAR(pose(1, 3), y, 1e-15);
  EXPECT_EQ(pose(2, 3), 0);
  const RealMatrix quarter(3, 3, {0, -1, 0, 1, 0, 0, 0, 0, 1});
  EXPECT_LE(difference(vn::rotation(pose), quarter), 1e-15);
  const RealMatrix by_hand(6, 2,
                           {-y, -0.2,  // z x (tool - joint)
                            x, 0,      //
                            0, 0,      //
                            0, 0,      //
                            0, 0,      //
                            1, 1});
  EXPECT_LE(difference(RealMatrix::of(jacobian), by_hand), 1e-15);
}

TEST(DhChain, PrismaticJointWorkedByHand) {
  // Modified: Rx(90 deg) turns the sliding axis to -y; then 0.2 along the new x, and a turn about -y.
  const vn::JointVector<2> q(0.7, 90_deg);
  const auto [pose, jacobian] = modified.pose_and_jacobian(q);
  EXPECT_LE((vn::translation(pose) - vn::Vector3(0.2, -0.7, 0)).norm(), 1e-15);
  const RealMatrix images_of_axes(3, 3, {0, 0, 1, -1, 0, 0, 0, -1, 0});  // one a row
  EXPECT_LE(difference(vn::rotation(pose), images_of_axes.transpose()), 1e-15);
  const RealMatrix by_hand(6, 2, {0, 0, -1, 0, 0, 0, 0, 0, 0, -1, 0, 0});
  EXPECT_LE(difference(RealMatrix::of(jacobian), by_hand), 1e-15);
}

// Elementary motions.
vn::Isometry3 about_x(double angle) { return vn::Isometry3(Eigen::AngleAxisd(angle, vn::Vector3(1, 0, 0))); }
vn::Isometry3 about_y(double angle) { return vn::Isometry3(Eigen::AngleAxisd(angle, vn::Vector3(0, 1, 0))); }
vn::Isometry3 about_z(double angle) { return vn::Isometry3(Eigen::AngleAxisd(angle, vn::Vector3(0, 0, 1))); }
vn::Isometry3 along(double x, double y, double z) { return vn::rigid_motion(vn::Matrix3::Identity(), {x, y, z}); }

/// A row as the product of its five elementary motions, in the order its convention states.
vn::Isometry3 link(const vn::DhRow& row, double q, vn::StandardDh) {
  const bool revolute = row.joint == vn::JointType::revolute;
  return about_z(row.theta + (revolute ? q : 0)) * along(0, 0, row.d + (revolute ? 0 : q)) * along(row.a, 0, 0) *
         about_x(row.alpha) * about_y(row.beta);
}
vn::Isometry3 link(const vn::DhRow& row, double q, vn::ModifiedDh) {
  const bool revolute = row.joint == vn::JointType::revolute;
  return about_x(row.alpha) * along(row.a, 0, 0) * about_y(row.beta) * about_z(row.theta + (revolute ? q : 0)) *
         along(0, 0, row.d + (revolute ? 0 : q));
}

template <class Convention>
class DhConvention : public ::testing::Test {};
using Conventions = ::testing::Types<vn::StandardDh, vn::ModifiedDh>;
TYPED_TEST_SUITE(DhConvention, Conventions);

TYPED_TEST(DhConvention, PoseIsTheProductOfItsElementaryMotions) {
  vn::Rng rng(11);
  for (int arm = 0; arm < 100; ++arm) {
    const auto chain = vernier_test::random_chain<5, TypeParam>(rng);
    const vn::JointVector<5> q = vernier_test::random_joints<5>(rng);
    vn::Isometry3 product = vn::Isometry3::Identity();
    for (int i = 0; i < 5; ++i) product = product * link(chain.row(i), q(i), TypeParam{});
    EXPECT_LE(difference(chain.pose(q), product), 1e-14);
  }
}

TYPED_TEST(DhConvention, RandomChainsObeyTheLaws) {
  vn::Rng rng(12);
  const auto check = [&]<int N>(std::integral_constant<int, N>) {
    for (int arm = 0; arm < 10; ++arm) {
      const auto chain = vernier_test::random_chain<N, TypeParam>(rng);
      const vn::JointRows<N> samples = vernier_test::random_joint_rows<N>(rng, 10);
      ASSERT_TRUE(no_violations(vn::testing::kinematic_model_violations(chain, samples)));
      ASSERT_TRUE(no_violations(vn::testing::parametric_model_violations(chain, samples)));
    }
  };
  check(std::integral_constant<int, 1>{});
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 6>{});
  check(std::integral_constant<int, 9>{});
}

/// Axes and their points by the columns of the Jacobian; a link's frame is where the chain ends that its row ends.
template <class Convention>
void expect_links_of_random_chains() {
  vn::Rng rng(9);
  for (int sample = 0; sample < 20; ++sample) {
    const auto chain = vernier_test::random_chain<4, Convention>(rng);
    const vn::JointVector<4> q = vernier_test::random_joints<4>(rng);
    const auto links = chain.links(q);
    const RealMatrix jacobian = RealMatrix::of(chain.jacobian(q));
    const vn::Vector3 tool = chain.position(q);
    for (int i = 0; i < 4; ++i) {
      const vn::Vector3 axis(links.axis(0, i), links.axis(1, i), links.axis(2, i));
      const vn::Vector3 lever = tool - vn::Vector3(links.point(0, i), links.point(1, i), links.point(2, i));
      const bool revolute = chain.row(i).joint == vn::JointType::revolute;
      const vn::Vector3 moved = revolute ? vn::Vector3(axis.cross(lever)) : axis;
      EXPECT_LT(difference(jacobian.block(0, i, 3, 1), moved), 1e-14) << i;
      EXPECT_LT(difference(jacobian.block(3, i, 3, 1), revolute ? axis : vn::Vector3(0, 0, 0)), 1e-14) << i;
      auto rows = chain.rows();
      vn::JointVector<4> first = q;
      for (std::size_t k = static_cast<std::size_t>(i) + 1; k < 4; ++k) {
        rows[k] = {};
        first(static_cast<vn::Index>(k)) = 0;
      }
      const vn::Vector3 end = vn::DhChain<4, Convention>::from_rows(rows).position(first);
      EXPECT_LT((end - vn::Vector3(links.origin(0, i), links.origin(1, i), links.origin(2, i))).norm(), 1e-14) << i;
    }
  }
}

TEST(DhChain, LinksAreWhereTheJointsMoveThem) {
  expect_links_of_random_chains<vn::StandardDh>();
  expect_links_of_random_chains<vn::ModifiedDh>();
}

TEST(DhChain, EqualityAndRows) {
  vn::Rng rng(14);
  const auto chain = vernier_test::random_chain<4>(rng);
  EXPECT_EQ(vn::DhChain<4>::from_rows(chain.rows()), chain);
  EXPECT_EQ(chain.with_parameters(chain.parameters()), chain);
  auto rows = chain.rows();
  rows[2].beta += 1e-15;
  EXPECT_FALSE(vn::DhChain<4>::from_rows(rows) == chain);
  EXPECT_EQ(planar, planar_in_two_braces);
}

TEST(DhChain, ParametersAreCountedRowByRow) {
  const auto names = vn::DhChain<2>::parameter_names();
  EXPECT_EQ(names, (std::vector<std::string>{"a1", "alpha1", "d1", "theta1", "beta1", "a2", "alpha2", "d2", "theta2",
                                             "beta2"}));
  const auto kinds = vn::DhChain<2>::parameter_kinds();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const bool length = names[k][0] == 'd' || (names[k][0] == 'a' && names[k][1] != 'l');
    EXPECT_EQ(kinds[k] == vn::ParameterKind::length, length) << names[k];
  }
  const auto chain = vn::DhChain<1>::from_rows({vn::DhRow{.a = 1, .alpha = 2, .d = 3, .theta = 4, .beta = 5}});
  EXPECT_EQ(RealMatrix::of(chain.parameters()), vernier_test::vector({1, 2, 3, 4, 5}));
}

TEST(DhChain, LengthsInMillimetresAndLargeAnglesAreRefused) {
  const auto refusal = [](const vn::DhRow& row) {
    return vernier_test::complaint([&] { static_cast<void>(vn::DhChain<2>{{{{.a = 1}, row}}}); });
  };
  EXPECT_EQ(refusal({.a = 400}), "DhChain: row 2: a is a length of 400 m; is the unit right?");
  EXPECT_EQ(refusal({.d = -100.5}), "DhChain: row 2: d is a length of -100.5 m; is the unit right?");
  EXPECT_EQ(refusal({.alpha = -180}), "DhChain: row 2: alpha is an angle of -180 rad; is the unit right?");
  EXPECT_EQ(refusal({.theta = 101}), "DhChain: row 2: theta is an angle of 101 rad; is the unit right?");
  EXPECT_EQ(refusal({.beta = 180}), "DhChain: row 2: beta is an angle of 180 rad; is the unit right?");
  EXPECT_EQ(refusal({.a = 100, .alpha = 100, .d = -100, .theta = -100}), "");
  // Conversions of nearly parallel axes may give any length.
  EXPECT_EQ(vn::DhChain<1>::from_rows({vn::DhRow{.d = 400}}).row(0).d, 400);
}

}  // namespace
}  // namespace dh_chain_test
