// SPDX-License-Identifier: BSD-3-Clause
// Base and tool frames around a model.

#include "vernier/kinematics/framed.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "random_chains.hpp"
#include "real_matrix.hpp"

namespace vn = vernier;
using vernier_test::difference;
using vernier_test::RealMatrix;
using vernier_test::vector;

namespace framed_test {
namespace {

constexpr double pi = std::numbers::pi;

vn::Isometry3 frame(const vn::Vector3& position, const vn::Vector3& rotation) {
  return vn::rigid_motion(Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix(), position);
}

const vn::DhChain<4>& arm() {
  static const vn::DhChain<4> value = [] {
    vn::Rng rng(31);
    return vernier_test::random_chain<4>(rng);
  }();
  return value;
}

const vn::Isometry3 base = frame({1, 2, 3}, {0.4, -1.2, 2.0});
const vn::Isometry3 tool = frame({0.1, -0.05, 0.2}, {0, 0.7, -0.1});

TEST(Framed, PoseIsBaseTimesModelTimesTool) {
  const vn::Framed framed(arm(), base, tool);
  vn::Rng rng(32);
  for (int i = 0; i < 100; ++i) {
    const vn::JointVector<4> q = vernier_test::random_joints<4>(rng);
    const vn::Isometry3 product = base * arm().pose(q) * tool;
    ASSERT_LE(difference(framed.pose(q), product), 1e-14);
  }
}

TEST(Framed, AToolOnATurntableMovesAlongItsTangent) {
  // One joint about z, a tool 0.2 m out along x: the tool point moves along y at 0.2 m/rad. The base turns that to -x.
  const vn::DhChain<1> turntable = vn::DhChain<1>::from_rows({vn::DhRow{}});
  const vn::Framed framed(turntable, frame({5, 0, 0}, {0, 0, pi / 2}), frame({0.2, 0, 0}, {1, 0, 0}));
  const RealMatrix by_hand = vector({-0.2, 0, 0, 0, 0, 1});
  EXPECT_LE((RealMatrix::of(framed.jacobian(vn::JointVector<1>(0.0))) - by_hand).norm(), 1e-15);
  EXPECT_LE((framed.position(vn::JointVector<1>(0.0)) - vn::Vector3(5, 0.2, 0)).norm(), 1e-15);
}

TEST(Framed, ParametersAreBaseModelTool) {
  const vn::Framed framed(arm(), base, tool);
  const RealMatrix p = RealMatrix::of(framed.parameters());
  ASSERT_EQ(p.rows(), 32);
  EXPECT_LE((p.block(0, 0, 6, 1) - vector({1, 2, 3, 0.4, -1.2, 2.0})).norm(), 1e-14);
  EXPECT_EQ(p.block(6, 0, 20, 1), RealMatrix::of(arm().parameters()));
  EXPECT_LE((p.block(26, 0, 6, 1) - vector({0.1, -0.05, 0.2, 0, 0.7, -0.1})).norm(), 1e-14);
  const auto names = vn::Framed<vn::DhChain<4>>::parameter_names();
  EXPECT_EQ(names.at(0), "base_x");
  EXPECT_EQ(names.at(5), "base_rz");
  EXPECT_EQ(names.at(6), "a1");
  EXPECT_EQ(names.at(25), "beta4");
  EXPECT_EQ(names.at(26), "tool_x");
  EXPECT_EQ(names.at(31), "tool_rz");
  const auto kinds = vn::Framed<vn::DhChain<4>>::parameter_kinds();
  for (const std::size_t k : {0u, 1u, 2u, 6u, 8u, 26u, 28u}) EXPECT_EQ(kinds.at(k), vn::ParameterKind::length) << k;
  for (const std::size_t k : {3u, 5u, 7u, 9u, 10u, 29u, 31u}) EXPECT_EQ(kinds.at(k), vn::ParameterKind::angle) << k;
}

TEST(Framed, AFrameLeftAloneKeepsItsBits) {
  // A rotation matrix that exp(log(R)) does not give back to the bit, so that a conversion would show.
  for (const vn::Matrix3& rotation : {vn::rotation(base), vn::rotation(tool)})
    ASSERT_NE(RealMatrix(vn::exp_so3(vn::log_so3(rotation))), RealMatrix(rotation));
  const vn::Framed framed(arm(), base, tool);
  EXPECT_EQ(RealMatrix(framed.base()), RealMatrix(base));
  EXPECT_EQ(RealMatrix(framed.tool()), RealMatrix(tool));

  auto p = framed.parameters();
  p(6) += 1e-3;  // a1
  const auto other_arm = framed.with_parameters(p);
  EXPECT_EQ(RealMatrix(other_arm.base()), RealMatrix(base));
  EXPECT_EQ(RealMatrix(other_arm.tool()), RealMatrix(tool));
  EXPECT_EQ(other_arm.model().row(0).a, arm().row(0).a + 1e-3);

  p(0) += 1e-3;  // base_x
  const auto other_base = framed.with_parameters(p);
  EXPECT_EQ(other_base.base()(0, 3), base(0, 3) + 1e-3);
  EXPECT_EQ(RealMatrix(other_base.tool()), RealMatrix(tool));

  const auto same = framed.with_parameters(framed.parameters());
  vn::Rng rng(35);
  for (int i = 0; i < 20; ++i) {
    const vn::JointVector<4> q = vernier_test::random_joints<4>(rng);
    EXPECT_EQ(RealMatrix(same.pose(q)), RealMatrix(framed.pose(q)));
  }
}

TEST(Framed, AroundAnotherModelKeepsTheFrames) {
  const vn::Framed framed(arm(), base, tool);
  vn::Rng rng(36);
  const auto other = vernier_test::random_chain<2, vn::ModifiedDh>(rng);
  const auto around = framed.around(other);
  static_assert(std::is_same_v<decltype(around), const vn::Framed<vn::DhChain<2, vn::ModifiedDh>>>);
  EXPECT_EQ(RealMatrix(around.base()), RealMatrix(base));
  EXPECT_EQ(RealMatrix(around.tool()), RealMatrix(tool));
  EXPECT_EQ(around.model(), other);
}

TEST(Framed, FramesMayBeNested) {
  const vn::Framed nested(vn::Framed(arm(), base, tool), tool, base);
  const vn::Framed flat(arm(), vn::Isometry3(tool * base), vn::Isometry3(tool * base));
  vn::Rng rng(37);
  const vn::JointVector<4> q = vernier_test::random_joints<4>(rng);
  EXPECT_LE((RealMatrix(nested.pose(q)) - flat.pose(q)).norm(), 1e-14);
  EXPECT_LE((RealMatrix::of(nested.jacobian(q)) - RealMatrix::of(flat.jacobian(q))).norm(), 1e-13);
}

TEST(FrameParameters, ValuesAndMatrixAgree) {
  vn::Rng rng(38);
  for (int i = 0; i < 200; ++i) {
    const double angle = i % 2 == 0 ? rng.uniform(0, pi) : std::pow(10.0, rng.uniform(-15, 0));
    const vn::Vector3 rotation = angle * vernier_test::random_direction(rng);
    const vn::Isometry3 t = frame({rng.normal(), rng.normal(), rng.normal()}, rotation);
    const vn::FrameParameters from_matrix(t);
    const RealMatrix values = from_matrix.values();
    ASSERT_LE((values.block(3, 0, 3, 1) - rotation).norm(), 4e-15);
    const vn::FrameParameters from_values(from_matrix.values());
    ASSERT_EQ(RealMatrix(from_values.values()), values);
    ASSERT_LE(difference(from_values.isometry(), t), 4e-15);
  }
  EXPECT_EQ(RealMatrix(vn::FrameParameters().values()), RealMatrix(6, 1));
  EXPECT_EQ(RealMatrix(vn::FrameParameters().isometry()), RealMatrix::identity(4));
}

}  // namespace
}  // namespace framed_test
