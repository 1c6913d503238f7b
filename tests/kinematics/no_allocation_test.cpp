// SPDX-License-Identifier: BSD-3-Clause
// The calls that a controller makes do not allocate.

#include <gtest/gtest.h>

#include <cstdlib>

#include "allocation_counter.hpp"
#include "random_chains.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;
using vernier_test::allocations;
using vernier_test::keep;

namespace no_allocation_test {
namespace {

TEST(AllocationCounter, SeesEveryWayToAllocate) {
  EXPECT_EQ(allocations([] {}), 0);
  EXPECT_EQ(allocations([] {
              int* volatile p = new int(1);
              delete p;
            }),
            1);
  EXPECT_EQ(allocations([] {
              struct alignas(64) Wide {
                double x[8] = {};
              };
              Wide* volatile p = new Wide;
              delete p;
            }),
            1);
  EXPECT_EQ(allocations([] {
              void* volatile p = std::malloc(8);
              std::free(p);
            }),
            1);
  EXPECT_EQ(allocations([] {
              void* volatile p = std::calloc(8, 8);
              std::free(p);
            }),
            1);
  EXPECT_EQ(allocations([] {
              const Eigen::VectorXd v(64);
              keep(v);
            }),
            1);
  EXPECT_GE(allocations([] {
              const std::string s(100, 'x');
              keep(s);
            }),
            1);
}

template <class Model>
void expect_no_allocation(const Model& model) {
  constexpr int N = Model::dof;
  vn::Rng rng(1);
  const vn::JointVector<N> q = vernier_test::random_joints<N>(rng, 1.0);
  const vn::JointVector<N> seed = q + 0.05 * vernier_test::random_joints<N>(rng, 1.0);
  const vn::Isometry3 target = model.pose(q);
  const vn::Vector3 out_of_reach = vn::Vector3::Constant(20.0);
  EXPECT_EQ(allocations([&] { keep(model.pose(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(model.position(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(model.jacobian(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(model.pose_and_jacobian(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(model.parameter_jacobian(q)); }), 0);
  EXPECT_EQ(allocations([&] { keep(inverse_kinematics(model, target, seed)); }), 0);
  EXPECT_EQ(allocations([&] { keep(inverse_kinematics(model, vn::Vector3(target.translation()), seed)); }), 0);
  EXPECT_EQ(allocations([&] { keep(inverse_kinematics(model, out_of_reach, seed)); }), 0);
}

TEST(NoAllocation, DhChains) {
  expect_no_allocation(vn::robots::abb_irb120().chain);
  expect_no_allocation(vn::robots::barrett_wam().chain);
  expect_no_allocation(vn::robots::puma560_modified().chain);
  vn::Rng rng(2);
  expect_no_allocation(vernier_test::random_chain<1>(rng));
  expect_no_allocation(vernier_test::random_chain<9>(rng));
}

TEST(NoAllocation, FramedChains) {
  vn::Vector6 base, tool;
  base << 1, 2, 3, 0.1, 0.2, 0.3;
  tool << 0.1, 0, 0.2, 0, 1, 0;
  expect_no_allocation(vn::Framed(vn::robots::ur10().chain, vn::FrameParameters(base), vn::FrameParameters(tool)));
  expect_no_allocation(
      vn::Framed(vn::robots::barrett_wam().chain, vn::FrameParameters(base), vn::FrameParameters(tool)));
}

}  // namespace
}  // namespace no_allocation_test
