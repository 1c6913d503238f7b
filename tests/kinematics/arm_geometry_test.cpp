// SPDX-License-Identifier: BSD-3-Clause
// Arms whose number of joints is known at run time: their parameters, and the arm that these make.

#include "vernier/kinematics/arm_geometry.hpp"

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier::arm_geometry_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

/// Each parameter alone changes what it is named after, and nothing else; the arm is that of the same chain.
template <class Convention>
void expect_each_parameter_counts() {
  Rng rng(1);
  const auto chain = vernier_test::random_chain<3, Convention>(rng);
  const Framed<DhChain<3, Convention>> framed(chain, FrameParameters(Vector6{0.1, 0.2, 0.3, 0.4, -0.5, 0.6}),
                                              FrameParameters(Vector6{-0.1, 0.3, 0.2, 1, 0.5, -0.4}));
  const ArmGeometry arm(framed);
  const MatrixX q = vernier_test::random_joint_rows<3>(rng, 5);
  const VectorX values = arm.parameters();
  ASSERT_EQ(values.size(), 6 + 15 + 6);
  ASSERT_EQ(arm.num_parameters(), values.size());
  for (Index k = 0; k < values.size(); ++k) {
    VectorX changed = values;
    changed(k) += 0.1;
    const ArmGeometry other = arm.with_parameters(changed);
    EXPECT_EQ(RealMatrix(other.parameters()), RealMatrix(changed)) << k;
    EXPECT_EQ(other.chain().modified(), Convention::modified);
    const auto expected = framed.with_parameters(changed);
    const auto poses = other.poses(q);
    const PointRows positions = other.positions(q);
    for (Index i = 0; i < 5; ++i) {
      JointVector<3> joints;
      for (Index j = 0; j < 3; ++j) joints(j) = q(i, j);
      const Isometry3 pose = expected.pose(joints);
      EXPECT_LT(difference(poses[static_cast<std::size_t>(i)], pose), 1e-14) << k;
      EXPECT_LT((point(positions, i) - translation(pose)).norm(), 1e-14) << k;
      EXPECT_GT(difference(pose, framed.pose(joints)), 1e-4) << k;
    }
  }
}

TEST(ArmGeometry, EachParameterCounts) {
  expect_each_parameter_counts<StandardDh>();
  expect_each_parameter_counts<ModifiedDh>();
}

TEST(ArmGeometry, ParametersHaveNamesAndKinds) {
  const DhChain<1> chain({{.a = 1}});
  const ArmGeometry arm(in_frames(chain));
  EXPECT_EQ(
      arm.parameter_names(),
      (std::vector<std::string>{"base_x", "base_y", "base_z", "base_rx", "base_ry", "base_rz", "a1", "alpha1", "d1",
                                "theta1", "beta1", "tool_x", "tool_y", "tool_z", "tool_rx", "tool_ry", "tool_rz"}));
  std::string lengths;
  for (const ParameterKind kind : arm.parameter_kinds()) lengths += kind == ParameterKind::length ? 'm' : 'r';
  EXPECT_EQ(lengths, "mmmrrrmrmrrmmmrrr");
}

// Either difference alone is one too many.
TEST(ArmGeometry, RefusesToBeAnArmOfOtherJointsOrOfTheOtherConvention) {
  Rng rng(2);
  const ArmGeometry arm(in_frames(vernier_test::random_chain<3>(rng)));
  EXPECT_EQ(vernier_test::complaint([&] { (void)arm.framed(vernier_test::random_chain<2>(rng)); }),
            "ArmGeometry: an arm of 3 joints in the standard convention, expected 2 in the standard one");
  EXPECT_EQ(vernier_test::complaint([&] { (void)arm.framed(vernier_test::random_chain<3, ModifiedDh>(rng)); }),
            "ArmGeometry: an arm of 3 joints in the standard convention, expected 3 in the modified one");
  const ArmGeometry modified(in_frames(vernier_test::random_chain<3, ModifiedDh>(rng)));
  EXPECT_EQ(vernier_test::complaint([&] { (void)modified.framed(vernier_test::random_chain<3>(rng)); }),
            "ArmGeometry: an arm of 3 joints in the modified convention, expected 3 in the standard one");
  EXPECT_EQ(vernier_test::complaint([&] { (void)arm.framed(vernier_test::random_chain<3>(rng)); }), "");
}

}  // namespace
}  // namespace vernier::arm_geometry_test
