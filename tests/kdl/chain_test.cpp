// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics and Jacobians against KDL, for random chains of 1 to 9 joints in both conventions; all branches of
// an arm by KDL's forward kinematics.

#include <gtest/gtest.h>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <type_traits>
#include <utility>

#include "branch_helpers.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;

namespace chain_test {
namespace {

constexpr double tolerance = 1e-12;  // m, and entries of rotations and Jacobians, on arms of up to about 6 m

KDL::Joint kdl_joint(const vn::DhRow& row) {
  return KDL::Joint(row.joint == vn::JointType::revolute ? KDL::Joint::RotZ : KDL::Joint::TransZ);
}

/// The same arm in KDL: a segment is its joint's motion, then a fixed frame.
template <int N, class Convention>
KDL::Chain kdl_chain(const vn::DhChain<N, Convention>& arm) {
  KDL::Chain chain;
  for (const vn::DhRow& row : arm.rows()) {
    const KDL::Frame hayati(KDL::Rotation::RotY(row.beta));
    if constexpr (std::is_same_v<Convention, vn::StandardDh>) {
      chain.addSegment(KDL::Segment(kdl_joint(row), KDL::Frame::DH(row.a, row.alpha, row.d, row.theta) * hayati));
    } else {
      chain.addSegment(
          KDL::Segment(KDL::Joint(KDL::Joint::None), KDL::Frame::DH_Craig1989(row.a, row.alpha, 0, 0) * hayati));
      chain.addSegment(KDL::Segment(kdl_joint(row), KDL::Frame::DH(0, 0, row.d, row.theta)));
    }
  }
  return chain;
}

template <int N, class Convention>
void compare(vn::Rng& rng, const vernier_test::ChainOptions& options) {
  for (int arm = 0; arm < 40; ++arm) {
    const auto chain = vernier_test::random_chain<N, Convention>(rng, options);
    const KDL::Chain peer = kdl_chain(chain);
    ASSERT_EQ(peer.getNrOfJoints(), static_cast<unsigned>(N));
    KDL::ChainFkSolverPos_recursive forward(peer);
    KDL::ChainJntToJacSolver derivative(peer);
    for (int sample = 0; sample < 10; ++sample) {
      const vn::JointVector<N> q = vernier_test::random_joints<N>(rng);
      KDL::JntArray joints(N);
      joints.data = q;
      KDL::Frame frame;
      KDL::Jacobian jacobian(N);
      ASSERT_EQ(forward.JntToCart(joints, frame), 0);
      ASSERT_EQ(derivative.JntToJac(joints, jacobian), 0);

      const auto [pose, ours] = chain.pose_and_jacobian(q);
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(pose.translation()(i), frame.p(i), tolerance);
        EXPECT_NEAR(chain.position(q)(i), frame.p(i), tolerance);
        for (int j = 0; j < 3; ++j) {
          EXPECT_NEAR(pose.linear()(i, j), frame.M(i, j), tolerance);
          EXPECT_NEAR(chain.pose(q).linear()(i, j), frame.M(i, j), tolerance);
        }
      }
      EXPECT_LE((ours - jacobian.data).cwiseAbs().maxCoeff(), tolerance);
    }
    if (::testing::Test::HasFailure()) return;  // one arm says enough
  }
}

template <class Convention, int... I>
void compare_all(std::integer_sequence<int, I...>, std::uint64_t seed) {
  vn::Rng rng(seed);
  (compare<I + 1, Convention>(rng, {.prismatic = 0, .hayati = false}), ...);
  (compare<I + 1, Convention>(rng, {.prismatic = 0.4, .hayati = true}), ...);
}

using OneToNine = std::make_integer_sequence<int, 9>;

TEST(AgainstKdl, StandardChains) { compare_all<vn::StandardDh>(OneToNine{}, 1); }
TEST(AgainstKdl, ModifiedChains) { compare_all<vn::ModifiedDh>(OneToNine{}, 2); }

TEST(AgainstKdl, BranchesMeetTheirTarget) {
  vn::Rng rng(3);
  const auto nominal = vn::robots::ur10().chain;
  const vn::ClosedForm closed_form(nominal);
  int branches = 0;
  for (int i = 0; i < 200; ++i) {
    const auto arm = vernier_test::as_made(nominal, rng);
    const KDL::Chain peer = kdl_chain(arm);
    KDL::ChainFkSolverPos_recursive forward(peer);
    const auto pose_of = [&](const vn::JointVector<6>& q) {
      KDL::JntArray joints(6);
      joints.data = q;
      KDL::Frame frame;
      EXPECT_EQ(forward.JntToCart(joints, frame), 0);
      vn::Isometry3 pose = vn::Isometry3::Identity();
      for (int r = 0; r < 3; ++r) {
        pose.translation()(r) = frame.p(r);
        for (int c = 0; c < 3; ++c) pose.linear()(r, c) = frame.M(r, c);
      }
      return pose;
    };
    const vn::Isometry3 target = pose_of(vernier_test::random_joints<6>(rng));
    for (const auto& branch : all_branches(closed_form, arm, target)) {
      ++branches;
      EXPECT_LE(vernier_test::difference(pose_of(branch.joints), target), 1e-9);
    }
  }
  EXPECT_GT(branches, 1000);
}

}  // namespace
}  // namespace chain_test
