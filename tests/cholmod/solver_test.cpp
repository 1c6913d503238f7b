// SPDX-License-Identifier: BSD-3-Clause
// CHOLMOD in place of Eigen for local states.

#include "vernier/cholmod/solver.hpp"

#include <gtest/gtest.h>

#include "sparse_solver_laws.hpp"

namespace vernier::cholmod_solver_test {
namespace {

constexpr CholmodSolver solver;

TEST(CholmodSolver, SolvesAsTheDenseSystemDoes) { vernier_test::expect_dense_solution(solver); }

TEST(CholmodSolver, TwoByTwoByHand) { vernier_test::expect_two_by_two(solver); }

}  // namespace
}  // namespace vernier::cholmod_solver_test
