// SPDX-License-Identifier: BSD-3-Clause
// Blocks of poses against poses one by one, and both against the chain written with the standard library's functions.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "turntable.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::difference;
using vernier_test::random_chain;
using vernier_test::random_joint_rows;
using vernier_test::RealMatrix;

namespace pose_blocks_test {
namespace {

template <class Convention>
class PoseBlocks : public ::testing::Test {};
using Conventions = ::testing::Types<vn::StandardDh, vn::ModifiedDh>;
TYPED_TEST_SUITE(PoseBlocks, Conventions);

template <class Convention>
class PoseBlocksWhiteBox : public ::testing::Test {};
TYPED_TEST_SUITE(PoseBlocksWhiteBox, Conventions);

template <class Check>
void for_all_sizes(const Check& check) {
  check(std::integral_constant<int, 1>{});
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 3>{});
  check(std::integral_constant<int, 4>{});
  check(std::integral_constant<int, 5>{});
  check(std::integral_constant<int, 6>{});
  check(std::integral_constant<int, 7>{});
  check(std::integral_constant<int, 9>{});
}

TYPED_TEST(PoseBlocks, AreThePosesOneByOneToTheBit) {
  vn::Rng rng(1);
  for_all_sizes([&]<int N>(std::integral_constant<int, N>) {
    for (const vn::Index n : {0, 1, 2, 3, 4, 5, 7, 8, 9, 13, 100}) {
      const auto arm = random_chain<N, TypeParam>(rng);
      const vn::JointRows<N> joints = random_joint_rows<N>(rng, n);
      const vn::PointRows points = vn::positions(arm, joints);
      const std::vector<vn::Isometry3> all = vn::poses(arm, joints);
      ASSERT_EQ(points.rows(), n);
      ASSERT_EQ(all.size(), static_cast<std::size_t>(n));
      for (vn::Index i = 0; i < n; ++i) {
        const vn::JointVector<N> q = vn::configuration<N>(joints, i);
        EXPECT_EQ(RealMatrix(vn::point(points, i)), RealMatrix(arm.position(q)));
        EXPECT_EQ(RealMatrix(all[static_cast<std::size_t>(i)]), RealMatrix(arm.pose(q)));
      }
    }
  });
}

TYPED_TEST(PoseBlocks, PointsOfTheToolAreWhereThePosePutsThem) {
  vn::Rng rng(3);
  const auto arm = random_chain<6, TypeParam>(rng);
  const vn::JointRows<6> joints = random_joint_rows<6>(rng, 50);
  for (const vn::Vector3& point : {vn::Vector3(0.1, -0.2, 0.3), vn::Vector3(0, 0, 1e-9)}) {
    const vn::PointRows points = arm.positions(joints, point);
    for (vn::Index i = 0; i < joints.rows(); ++i) {
      const vn::Vector3 expected = arm.pose(vn::configuration<6>(joints, i)) * point;
      EXPECT_LE(difference(vn::point(points, i), expected), 1e-15);
    }
  }
}

TYPED_TEST(PoseBlocks, StrangeJointValuesStayInTheirRow) {
  vn::Rng rng(5);
  const auto arm = random_chain<6, TypeParam>(rng, {.prismatic = 0});
  const vn::JointRows<6> calm = random_joint_rows<6>(rng, 11);
  const vn::PointRows expected = vn::positions(arm, calm);
  const auto finite = [](const RealMatrix& a) { return std::isfinite(a.largest()); };
  for (const double strange : {std::nan(""), std::numeric_limits<double>::infinity(), 3e7}) {
    for (vn::Index row = 0; row < calm.rows(); ++row) {
      vn::JointRows<6> joints = calm;
      joints(row, 2) = strange;
      const vn::PointRows points = vn::positions(arm, joints);
      const vn::JointVector<6> q = vn::configuration<6>(joints, row);
      for (vn::Index i = 0; i < calm.rows(); ++i) {
        const RealMatrix found = vn::point(points, i);
        if (i != row) {
          ASSERT_EQ(found, RealMatrix(vn::point(expected, i)));
        } else if (std::isfinite(strange)) {
          ASSERT_EQ(found, RealMatrix(arm.position(q)));
          ASSERT_LE(difference(arm.pose(q), arm.template pose<double>(q, arm.parameters())), 1e-14);
        } else {
          ASSERT_FALSE(finite(found) || finite(arm.position(q)) || finite(vn::rotation(arm.pose(q))));
          ASSERT_EQ(RealMatrix(arm.pose(q)).row(3), RealMatrix(1, 4, {0, 0, 0, 1}));
        }
      }
    }
  }
}

TYPED_TEST(PoseBlocksWhiteBox, TheInstructionSetDoesNotChangeABit) {
  vn::Rng rng(4);
  for_all_sizes([&]<int N>(std::integral_constant<int, N>) {
    const auto arm = random_chain<N, TypeParam>(rng);
    const vn::JointRows<N> joints = random_joint_rows<N>(rng, 41);
    const vn::JointVector<N> q = vn::configuration<N>(joints, 0);
    vn::Isometry3 poses[2];
    vn::PointRows points[2] = {vn::PointRows(41, 3), vn::PointRows(41, 3)};
    for (const int k : {0, 1}) {
      const auto set = k == 0 ? vn::InstructionSet::baseline : vn::widest_instruction_set();
      vn::detail::chain_pose<TypeParam, N>(arm.view(), q.data(), poses[k].data(), set);
      vn::detail::evaluate_chain(arm.view(), {}, joints.data(), 41, 41, {.positions = points[k].data()}, set);
    }
    EXPECT_EQ(RealMatrix(poses[0]), RealMatrix(poses[1]));
    EXPECT_EQ(RealMatrix(points[0]), RealMatrix(points[1]));
    EXPECT_EQ(RealMatrix(points[0]), RealMatrix(vn::positions(arm, joints)));
  });
}

// Each pose as 16 numbers, row by row; of fewer rows than a vector has lanes, too.
TEST(MatricesWhiteBox, AreThePosesRowByRow) {
  const vn::Framed arm(vn::robots::ur10().chain, vn::FrameParameters(vn::Vector6(1, 2, 3, 0.1, -0.2, 3.0)),
                       vn::FrameParameters(vn::Vector6(0.1, 0, 0.2, 0, 1, 0)));
  const double* tool = arm.tool().data();
  vn::Rng rng(7);
  for (const vn::Index n : {1, 2, 3, 4, 5, 41})
    for (const auto set : {vn::InstructionSet::baseline, vn::widest_instruction_set()}) {
      const vn::JointRows<6> joints = random_joint_rows<6>(rng, n);
      std::vector<double> matrices(static_cast<std::size_t>(16 * n), -7);
      vn::detail::BlockResults results;
      results.matrices = matrices.data();
      vn::detail::evaluate_chain(arm.chain().view(), {.base = arm.base().data(), .point = tool + 12, .tool = tool},
                                 joints.data(), n, n, results, set);
      for (vn::Index i = 0; i < n; ++i) {
        const auto pose = arm.pose(vn::configuration<6>(joints, i)).matrix();
        for (int r = 0; r < 4; ++r)
          for (int c = 0; c < 4; ++c)
            ASSERT_NEAR(matrices[static_cast<std::size_t>(16 * i + 4 * r + c)], pose(r, c), 1e-14) << n << ' ' << i;
      }
    }
}

TEST(FramedPoseBlocks, AreThePosesOneByOne) {
  const vn::Vector6 base{1, 2, 3, 0.1, -0.2, 3.0}, tool{0.1, 0, 0.2, 0, 1, 0}, outer{-0.5, 0.2, 0.1, 1, 0.3, -0.4};
  const vn::Framed inner(vn::robots::barrett_wam().chain, vn::FrameParameters(base), vn::FrameParameters(tool));
  const vn::Framed nested(inner, vn::FrameParameters(outer), vn::FrameParameters(base));
  vn::Rng rng(6);
  const vn::JointRows<7> joints = random_joint_rows<7>(rng, 21);
  const auto check = [&](const auto& model) {
    const vn::PointRows points = vn::positions(model, joints);
    const std::vector<vn::Isometry3> all = vn::poses(model, joints);
    for (vn::Index i = 0; i < joints.rows(); ++i) {
      const vn::JointVector<7> q = vn::configuration<7>(joints, i);
      EXPECT_LE(difference(vn::point(points, i), model.position(q)), 1e-14);
      EXPECT_LE(difference(all[static_cast<std::size_t>(i)], model.pose(q)), 1e-14);
    }
  };
  check(inner);
  check(nested);
  EXPECT_EQ(vn::positions(nested, vn::JointRows<7>(0, 7)).rows(), 0);
}

/// Framed around a model that knows nothing of blocks.
TEST(FramedPoseBlocks, AModelWithoutThemIsAskedOneByOne) {
  const vn::Vector6 tool{1, 0, 0, 0, 0, 0};
  const vn::Framed model(vernier_test::Turntable{}, {}, vn::FrameParameters(tool));
  vn::JointRows<1> joints(5, 1);
  for (vn::Index i = 0; i < 5; ++i) joints(i) = 0.25 * static_cast<double>(i);
  const vn::PointRows points = vn::positions(model, joints);
  for (vn::Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(points(i, 0), std::cos(joints(i)), 1e-15);
    EXPECT_NEAR(points(i, 1), std::sin(joints(i)), 1e-15);
    EXPECT_EQ(RealMatrix(vn::poses(model, joints)[static_cast<std::size_t>(i)]),
              RealMatrix(model.pose(vn::JointVector<1>(joints(i)))));
  }
}

}  // namespace
}  // namespace pose_blocks_test
