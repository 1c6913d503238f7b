// SPDX-License-Identifier: BSD-3-Clause
// Blocks of Jacobians and parameter Jacobians against those one by one, which have tests of their own.

#include <gtest/gtest.h>

#include "allocation_counter.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "turntable.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::random_chain;
using vernier_test::random_joint_rows;

namespace jacobian_blocks_test {
namespace {

template <class Convention>
class JacobianBlocks : public ::testing::Test {};
using Conventions = ::testing::Types<vn::StandardDh, vn::ModifiedDh>;
TYPED_TEST_SUITE(JacobianBlocks, Conventions);

/// Largest difference of poses and derivatives from those that `single(q)` gives.
template <int N, class Single>
double difference(const vn::PosesAndJacobians& all, const vn::JointRows<N>& joints, const Single& single) {
  EXPECT_EQ(static_cast<vn::Index>(all.poses.size()), joints.rows());
  EXPECT_EQ(all.jacobians.rows(), joints.rows());
  double worst = 0;
  for (vn::Index i = 0; i < joints.rows(); ++i) {
    const auto expected = single(vn::JointVector<N>(joints.row(i).transpose()));
    EXPECT_EQ(all.jacobians.cols(), expected.jacobian.size());
    const vn::MatrixX jacobian = all.jacobians.row(i).reshaped(6, expected.jacobian.cols());
    worst = vernier_test::larger(worst, (jacobian - expected.jacobian).cwiseAbs().maxCoeff());
    worst =
        vernier_test::larger(worst, vernier_test::difference(all.poses[static_cast<std::size_t>(i)], expected.pose));
  }
  return worst;
}

template <int N, class Convention>
void check_chain(vn::Rng& rng) {
  for (const vn::Index n : {0, 1, 3, 4, 5, 7, 8, 41}) {
    const auto arm = random_chain<N, Convention>(rng);
    const vn::JointRows<N> joints = random_joint_rows<N>(rng, n);
    EXPECT_EQ(difference(vn::poses_and_jacobians(arm, joints), joints,
                         [&](const auto& q) { return arm.pose_and_jacobian(q); }),
              0);
    EXPECT_EQ(difference(vn::poses_and_parameter_jacobians(arm, joints), joints,
                         [&](const auto& q) { return vn::pose_and_parameter_jacobian(arm, q); }),
              0);
  }
}

TYPED_TEST(JacobianBlocks, OfAChainAreThoseOneByOneToTheBit) {
  vn::Rng rng(1);
  check_chain<1, TypeParam>(rng);
  check_chain<6, TypeParam>(rng);
}

TYPED_TEST(JacobianBlocks, OfFramesToo) {
  vn::Rng rng(2);
  vn::Vector6 base, tool;
  base << 1, 2, 3, 0.1, -0.2, 3.0;
  tool << 0.1, 0, 0.2, 0, 1, 0;
  for (const vn::Index n : {1, 2, 3, 4, 5, 23}) {
    const vn::Framed model(random_chain<6, TypeParam>(rng), vn::FrameParameters(base), vn::FrameParameters(tool));
    const vn::JointRows<6> joints = random_joint_rows<6>(rng, n);
    const auto all = vn::poses_and_parameter_jacobians(model, joints);
    EXPECT_LE(difference(all, joints, [&](const auto& q) { return model.pose_and_parameter_jacobian(q); }), 2e-14);
    EXPECT_LE(difference(vn::poses_and_jacobians(model, joints), joints,
                         [&](const auto& q) { return model.pose_and_jacobian(q); }),
              2e-14);
  }
}

// Fewer configurations than a vector register holds: the tool point must not be left out.
TEST(ArmGeometry, AFewConfigurationsAreThoseOneByOne) {
  const vn::Framed arm(vn::robots::ur10().chain, vn::FrameParameters(vn::Vector6{1, 2, 3, 0.1, -0.2, 3.0}),
                       vn::FrameParameters(vn::Vector6{0.1, -0.3, 0.2, 0, 1, 0}));
  const vn::ArmGeometry geometry(arm);
  vn::Rng rng(5);
  for (const vn::Index n : {1, 2, 3, 4, 5}) {
    const vn::JointRows<6> joints = random_joint_rows<6>(rng, n);
    vn::PosesAndJacobians all;
    geometry.poses_and_parameter_jacobians(joints, all);
    EXPECT_LE(difference(all, joints, [&](const auto& q) { return arm.pose_and_parameter_jacobian(q); }), 2e-14) << n;
    const vn::PointRows points = geometry.positions(joints), of_frames = arm.positions(joints);
    const std::vector<vn::Isometry3> poses = geometry.poses(joints);
    for (vn::Index i = 0; i < n; ++i) {
      const vn::Isometry3 pose = arm.pose(joints.row(i).transpose());
      EXPECT_LE((points.row(i).transpose() - pose.translation()).norm(), 1e-14) << n;
      EXPECT_LE((of_frames.row(i).transpose() - pose.translation()).norm(), 1e-14) << n;
      EXPECT_LE((poses[static_cast<std::size_t>(i)].matrix() - pose.matrix()).norm(), 1e-14) << n;
    }
  }
}

TEST(FramedJacobianBlocks, OfAModelWithoutThemAreAskedForOneByOne) {
  vn::Vector6 tool;
  tool << 1, 0, 0, 0, 0, 0;
  const vn::Framed turntable(vernier_test::Turntable{}, {}, vn::FrameParameters(tool));
  const vn::JointRows<1> angles = vn::JointRows<1>::LinSpaced(5, 0, 1);
  EXPECT_EQ(difference(vn::poses_and_jacobians(turntable, angles), angles,
                       [&](const auto& q) { return turntable.pose_and_jacobian(q); }),
            0);
  const vn::Framed nested(vn::Framed(vn::robots::ur10().chain), {}, vn::FrameParameters(tool));
  vn::Rng rng(3);
  const vn::JointRows<6> joints = random_joint_rows<6>(rng, 9);
  EXPECT_LE(difference(vn::poses_and_parameter_jacobians(nested, joints), joints,
                       [&](const auto& q) { return nested.pose_and_parameter_jacobian(q); }),
            1e-14);
}

TEST(FramedJacobianBlocks, StorageIsUsedAgain) {
  const vn::Framed model(vn::robots::ur10().chain);
  vn::Rng rng(4);
  const vn::JointRows<6> joints = random_joint_rows<6>(rng, 100), others = random_joint_rows<6>(rng, 100);
  auto all = vn::poses_and_parameter_jacobians(model, joints);
  const long made =
      vernier_test::allocations([&] { all = vn::poses_and_parameter_jacobians(model, others, std::move(all)); });
  EXPECT_EQ(made, 0);
  EXPECT_LE(difference(all, others, [&](const auto& q) { return model.pose_and_parameter_jacobian(q); }), 1e-14);
}

}  // namespace
}  // namespace jacobian_blocks_test
