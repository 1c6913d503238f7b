// SPDX-License-Identifier: BSD-3-Clause
// Blocks of one pose are left out together: held to the problem solved again without them.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "local_states.hpp"
#include "vernier/least_squares/leave_one_out.hpp"

namespace left_out_poses_test {
namespace {

using vernier::FactorisedEquations;
using vernier::Index;
using vernier::LeftOutBlocks;
using vernier::VectorX;
using vernier_test::LocalStates;
using vernier_test::RealMatrix;

/// Poses of 40 blocks: some alone, some visited again soon, later, or often.
std::vector<Index> poses() {
  std::vector<Index> out(LocalStates::blocks);
  for (Index b = 0; b < LocalStates::blocks; ++b) out[static_cast<std::size_t>(b)] = b < 10 ? b / 2 : b % 7 + 5;
  return out;
}

LeftOutBlocks left_out(const LocalStates& problem, Index stride) {
  const auto evaluate = [&](Index first, Index count, vernier::RowBlock* out) {
    std::copy_n(problem.rows.begin() + first, count, out);
  };
  const vernier::BlockSystem system{LocalStates::blocks,
                                    LocalStates::blocks,
                                    LocalStates::dense,
                                    {},
                                    evaluate,
                                    LocalStates::states,
                                    LocalStates::size,
                                    poses()};
  const vernier::NormalEquations normal = problem.normal_equations();
  return leave_one_out(system, FactorisedEquations(normal, problem.precisions, problem.steps, problem.local_steps),
                       stride);
}

/// Residual of a block in the dense problem without all blocks of its pose.
RealMatrix by_force(const LocalStates& problem, Index block) {
  const RealMatrix prior = problem.prior(problem.precisions), jacobian = problem.jacobian();
  RealMatrix matrix = prior, gradient = prior * problem.all_steps();
  const std::vector<Index> of = poses();
  for (Index b = 0; b < LocalStates::blocks; ++b) {
    if (of[static_cast<std::size_t>(b)] == of[static_cast<std::size_t>(block)]) continue;
    const RealMatrix rows = jacobian.block(6 * b, 0, 6, jacobian.cols());
    matrix += rows.transpose() * rows;
    gradient += rows.transpose() * problem.rows[static_cast<std::size_t>(b)].residual;
  }
  const RealMatrix rows = jacobian.block(6 * block, 0, 6, jacobian.cols());
  return RealMatrix(problem.rows[static_cast<std::size_t>(block)].residual) - rows * matrix.solve(gradient);
}

TEST(LeftOutPoses, AreThoseOfSolvingWithoutAllBlocksOfThePose) {
  const LocalStates problem(3);
  for (const Index stride : {1, 3}) {
    const LeftOutBlocks found = left_out(problem, stride);
    ASSERT_EQ(found.errors.cols(), (LocalStates::blocks + stride - 1) / stride);
    for (Index k = 0; k < found.errors.cols(); ++k) {
      const RealMatrix wanted = by_force(problem, k * stride).block(0, 0, 3, 1);
      const vernier::Vector3 error = found.errors.col(k);
      EXPECT_LT((error - wanted).norm(), 1e-9 * wanted.norm()) << stride << ", " << k;
      EXPECT_EQ(found.poses[static_cast<std::size_t>(k)], poses()[static_cast<std::size_t>(k * stride)]);
    }
  }
}

TEST(LeftOutPoses, CountOnceEach) {
  LeftOutBlocks some{Eigen::Matrix3Xd::Zero(3, 5), {0, 1, 0, 2, 1}};
  for (Index k = 0; k < 5; ++k) some.errors(0, k) = static_cast<double>(k + 1);
  const VectorX norms = vernier::detail::error_norms(some);
  ASSERT_EQ(norms.size(), 3);
  EXPECT_EQ(norms(0), 2);
  EXPECT_EQ(norms(1), 3.5);
  EXPECT_EQ(norms(2), 4);
}

}  // namespace
}  // namespace left_out_poses_test
