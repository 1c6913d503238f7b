// Local states, eliminated by the Schur complement with the sparse solver of Eigen.

#include "vernier/least_squares/sparse_solve.hpp"

#include <gtest/gtest.h>

#include "sparse_solver_laws.hpp"

namespace vernier::local_states_test {
namespace {

constexpr EigenSparseSolver solver;

TEST(EigenSparseSolver, SolvesAsTheDenseSystemDoes) { vernier_test::expect_dense_solution(solver); }

TEST(EigenSparseSolver, TwoByTwoByHand) { vernier_test::expect_two_by_two(solver); }

}  // namespace
}  // namespace vernier::local_states_test
