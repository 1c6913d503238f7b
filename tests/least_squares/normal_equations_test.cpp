// SPDX-License-Identifier: BSD-3-Clause
// Normal equations of blocks of rows, their solution, and leave-one-block-out errors.

#include "vernier/least_squares/leave_one_out.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "complaint.hpp"
#include "random_blocks.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier::normal_equations_test {
namespace {

using namespace vernier_test;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(RowBlock, ExpandIsColumnTimesFunctions) {
  const RandomBlocks blocks(3, 1);
  for (Index b = 0; b < 3; ++b) {
    const RowBlock& p = blocks.row(b);
    const RealMatrix all = blocks.expanded(b), factor = p.factor;
    EXPECT_EQ(all.block(0, 0, 6, 5), RealMatrix(p.dense));
    for (Index k = 0; k < 10; ++k)  // joint 1 has four functions, joint 2 none, joint 3 six
      EXPECT_EQ(all.col(5 + k), factor.col(k < 4 ? 0 : 2) * p.functions(k));
  }
  RandomBlocks single(1, 1);
  single.group_sizes = {1, 3, 6};
  const RealMatrix factor = single.row(0).factor;
  for (Index k = 0; k < 10; ++k)
    EXPECT_EQ(RealMatrix(single.expanded(0)).col(5 + k), factor.col(k < 1   ? 0
                                                                    : k < 4 ? 1
                                                                            : 2) *
                                                             single.row(0).functions(k));
}

TEST(NormalEquations, AreThoseOfTheExpandedRows) {
  // also more blocks than are taken at once, and no dense unknowns
  for (const auto& [n, dense] : {std::pair<Index, Index>{15, 5}, {256, 5}, {600, 5}, {15, 0}}) {
    const RandomBlocks blocks(n, 2, true, dense);
    RealMatrix jacobian(6 * n, blocks.unknowns()), residual(6 * n, 1);
    for (Index b = 0; b < n; ++b) {
      jacobian.set_block(6 * b, 0, blocks.expanded(b));
      residual.set_block(6 * b, 0, blocks.row(b).residual);
    }
    const NormalEquations normal = blocks.normal();
    const RealMatrix matrix = jacobian.transpose() * jacobian, gradient = jacobian.transpose() * residual;
    EXPECT_LT((normal.matrix - matrix).norm(), 1e-12 * matrix.norm()) << n;
    EXPECT_LT((normal.gradient - gradient).norm(), 1e-12 * gradient.norm()) << n;
    EXPECT_NEAR(normal.cost, residual.squared_norm(), 1e-12 * residual.squared_norm()) << n;
    EXPECT_EQ(RealMatrix(normal.matrix), RealMatrix(normal.matrix).transpose());
  }
}

// Sums of factored unknowns are those of equations with two dense unknowns less, and no others are.
TEST(NormalEquations, TakeSumsOfTheSameFunctions) {
  const RandomBlocks blocks(300, 7);
  RandomBlocks fewer = blocks;
  fewer.dense = 3;
  for (RowBlock& row : fewer.rows) {
    Rows6 some(6, 3);
    std::copy_n(row.dense.data(), some.size(), some.data());
    row.dense = some;
  }
  NormalEquations known = fewer.normal();
  const NormalEquations wanted = blocks.normal();
  const auto with_known = [&] {
    return blocks.with_system([&](const BlockSystem& system) { return NormalEquations(system, {}, {}, &known); });
  };
  EXPECT_EQ(RealMatrix(with_known().matrix), RealMatrix(wanted.matrix));
  EXPECT_EQ(RealMatrix(with_known().gradient), RealMatrix(wanted.gradient));
  known.matrix *= 2;
  RealMatrix doubled = wanted.matrix;
  for (Index c = 5; c < 15; ++c)
    for (Index r = 5; r < 15; ++r) doubled(r, c) *= 2;
  EXPECT_EQ(RealMatrix(with_known().matrix), doubled);
  known.prior = MatrixX::Identity(13, 13);  // it would be counted twice
  EXPECT_NE(complaint([&] { (void)with_known(); }).find("or a joint prior"), std::string::npos);
  known = NormalEquations(RandomBlocks(3, 1).normal());
  known.matrix = MatrixX::Identity(9, 9);  // of ten functions
  EXPECT_NE(complaint([&] { (void)with_known(); }).find("fewer unknowns"), std::string::npos);
}

// A prior with correlations, as rows of its Cholesky factor would be.
TEST(NormalEquations, AJointPriorActsAsMeasurements) {
  const RandomBlocks blocks(15, 4);
  Rng rng(6);
  RealMatrix half(15, 15);
  for (Index k = 0; k < 15; ++k) half.set_block(0, k, random_vector(rng, 15));
  half.set_block(0, 3, RealMatrix(15, 1));  // no prior
  const VectorX mean = random_vector(rng, 15), steps = random_vector(rng, 15), none = VectorX::Zero(15);
  const JointPrior prior{half.transpose() * half, mean, 14};
  NormalEquations normal = blocks.normal();
  const RealMatrix rows = half * (RealMatrix(steps) - mean);  // residuals of the prior
  const RealMatrix matrix = normal.matrix + half.transpose() * half;
  const RealMatrix gradient = normal.gradient + half.transpose() * rows;
  const double cost = normal.cost + rows.squared_norm();
  EXPECT_NEAR(prior.cost(steps), rows.squared_norm(), 1e-10 * cost);
  normal.add(prior, steps);
  EXPECT_NEAR(normal.cost, cost, 1e-12 * cost);
  const FactorisedEquations solved(normal, none, steps);
  ASSERT_TRUE(solved.usable());
  const RealMatrix wanted = -matrix.solve(gradient);
  EXPECT_LT((solved.step() - wanted).norm(), 1e-8 * wanted.norm());
}

TEST(FactorisedEquations, WhatNothingDeterminesStays) {
  RandomBlocks blocks(15, 6);
  for (RowBlock& p : blocks.rows)
    for (Index r = 0; r < 6; ++r) p.dense(r, 2) = 0;
  const NormalEquations normal = blocks.normal();
  const FactorisedEquations solved(normal, VectorX::Zero(15), VectorX::Zero(15));
  ASSERT_TRUE(solved.usable());
  EXPECT_EQ(solved.step()(2), 0);
}

TEST(FactorisedEquations, ATightPriorHoldsItsOwnUnknownsAlone) {
  const RandomBlocks blocks(15, 19);
  VectorX precisions = VectorX::Zero(15);
  for (Index k = 5; k < 15; ++k) precisions(k) = suppressing_precision;
  const NormalEquations normal = blocks.normal();
  const FactorisedEquations solved(normal, precisions, VectorX::Zero(15));
  const RealMatrix matrix = normal.matrix, gradient = normal.gradient, step = solved.step();
  const RealMatrix alone = -matrix.block(0, 0, 5, 5).solve(gradient.block(0, 0, 5, 1));
  EXPECT_LT((step.block(0, 0, 5, 1) - alone).norm(), 1e-8 * alone.norm());
  EXPECT_LT(step.block(5, 0, 10, 1).norm(), 1e-8);
}

TEST(LeaveOneOutErrors, AreThoseOfSolvingWithoutThePose) {
  // 70 blocks at stride 1: more than are taken at once
  for (const auto& [n, stride] : {std::pair<Index, Index>{15, 1}, {15, 4}, {70, 1}, {70, 3}})
    for (const bool plain : {true, false}) {
      const RandomBlocks blocks(n, 7, plain);
      Rng rng(8);
      const VectorX precisions = random_squares(rng, 15, 0.5), steps = random_vector(rng, 15);
      const NormalEquations normal = blocks.normal();
      const FactorisedEquations solved(normal, precisions, steps);
      const Eigen::Matrix3Xd errors = blocks.with_system(
          [&, every = stride](const BlockSystem& s) { return leave_one_out_errors(s, solved, every); });
      ASSERT_EQ(errors.cols(), (n + stride - 1) / stride);
      for (Index k = 0; k < errors.cols(); ++k) {
        const Vector3 wanted = left_out_by_force(blocks, precisions, steps, k * stride);
        EXPECT_LT((Vector3(errors.col(k)) - wanted).norm(), 1e-9 * wanted.norm()) << n << ", " << stride << ", " << k;
      }
    }
}

// A prior with correlations, however tight, leaves the unknowns that it does not contain to the data.
TEST(FactorisedEquations, ATightJointPriorHoldsItsOwnUnknownsAlone) {
  const RandomBlocks blocks(15, 19);
  RealMatrix precision(15, 15);
  for (const Index k : {2, 7}) precision(k, k) = 1e18;
  NormalEquations normal = blocks.normal();
  const RealMatrix matrix = normal.matrix, gradient = normal.gradient;
  normal.add({precision, VectorX::Zero(15), 2}, VectorX::Zero(15));
  const FactorisedEquations solved(normal, VectorX::Zero(15), VectorX::Zero(15));
  const RealMatrix step = solved.step();
  RealMatrix held = matrix;
  for (const Index k : {2, 7}) held(k, k) = 1e18;
  EXPECT_LT((step + held.solve_by_cholesky(gradient)).norm(), 1e-8 * step.norm());
  EXPECT_LT(std::abs(step(2)) + std::abs(step(7)), 1e-12);
}

TEST(LeaveOneOutErrors, AreInfiniteWhereNothingCouldBeSolved) {
  const RandomBlocks blocks(15, 9);
  const NormalEquations normal = blocks.normal();
  const FactorisedEquations broken(normal, VectorX::Constant(15, nan), VectorX::Zero(15));
  EXPECT_FALSE(broken.usable());
  const Eigen::Matrix3Xd errors =
      blocks.with_system([&](const BlockSystem& s) { return leave_one_out_errors(s, broken, 2); });
  EXPECT_EQ(errors.cols(), 8);
  EXPECT_EQ(std::count(errors.data(), errors.data() + errors.size(), infinity), errors.size());
}

TEST(LeaveOneOutErrors, OfValidationBlocksAlone) {
  const RandomBlocks blocks(20, 5, false);
  const NormalEquations normal = blocks.normal();
  const FactorisedEquations solved(normal, VectorX::Ones(15), VectorX::Zero(15));
  blocks.with_system([&](BlockSystem system) {
    const Eigen::Matrix3Xd all = leave_one_out_errors(system, solved, 2);
    system.validation_blocks = 7;
    const Eigen::Matrix3Xd some = leave_one_out_errors(system, solved, 2);
    ASSERT_EQ(some.cols(), 4);
    EXPECT_TRUE(std::equal(some.data(), some.data() + some.size(), all.data()));
  });
}

/// Blocks that depend on local states, and their priors, as one dense problem: dense and factored unknowns, then the
/// states.
struct RandomStates {
  RandomBlocks blocks;
  Index unknowns, states, size;
  std::vector<LocalPrior> priors;
  VectorX precisions, steps, local_steps;

  explicit RandomStates(Index n, Index dense = 5, Index of_states = 4, Index of_size = 2)
      : blocks(n, 31, false, dense), unknowns(dense + 10), states(of_states), size(of_size) {
    Rng rng(32);
    for (Index b = 0; b < n; ++b) {
      RowBlock& rows = blocks.rows[static_cast<std::size_t>(b)];
      for (const Index k : {0, 1}) {  // of none, one or two states, in either order
        if ((b + k) % 3 == 0 || k >= states) continue;
        RowBlock::Local& local = rows.local[static_cast<std::size_t>(k)];
        local.state = (b + 3 * k) % states;
        local.columns.resize(6, size);
        fill(rng, local.columns);
      }
    }
    for (Index s = 0; s < states; ++s) priors.push_back({s, s, 20 * MatrixX::Identity(size, size)});
    for (Index s = 0; s + 1 < states; ++s) {
      MatrixX coupling(size, size);  // not symmetric
      fill(rng, coupling, 2);
      priors.push_back({s + 1, s, coupling});
    }
    precisions = random_squares(rng, unknowns, 0.5);
    steps = random_vector(rng, unknowns);
    local_steps = random_vector(rng, states * size);
  }

  template <class F>
  decltype(auto) with_system(F&& f) const {
    return blocks.with_system([&](BlockSystem system) {
      system.local_states = states;
      system.local_size = size;
      return f(system);
    });
  }
  RealMatrix row(Index b) const {
    RealMatrix out(6, unknowns + states * size);
    out.set_block(0, 0, blocks.expanded(b));
    for (const RowBlock::Local& local : blocks.row(b).local)
      if (local.state >= 0) out.add_block(0, unknowns + local.state * size, local.columns);
    return out;
  }
  RealMatrix prior() const {
    RealMatrix out(unknowns + states * size, unknowns + states * size);
    out.set_block(0, 0, RealMatrix::diagonal(precisions));
    for (const LocalPrior& p : priors) {
      const Index a = unknowns + p.first * size, b = unknowns + p.second * size;
      out.add_block(a, b, p.precision);
      if (a != b) out.add_block(b, a, RealMatrix(p.precision).transpose());
    }
    return out;
  }
  /// Matrix and gradient, one block left out where it is not negative.
  std::pair<RealMatrix, RealMatrix> dense(Index without) const {
    RealMatrix matrix = prior(), all(unknowns + states * size, 1);
    all.set_block(0, 0, steps);
    all.set_block(unknowns, 0, local_steps);
    RealMatrix gradient = matrix * all;
    for (Index b = 0; b < blocks.size(); ++b) {
      if (b == without) continue;
      matrix += row(b).transpose() * row(b);
      gradient += row(b).transpose() * blocks.row(b).residual;
    }
    return {matrix, gradient};
  }
};

/// Expects the steps and the inverse that the dense problem has.
void expect_dense_solution(const RandomStates& problem, const NormalEquations& normal) {
  const Index unknowns = problem.unknowns, local = problem.states * problem.size;
  const FactorisedEquations solved(normal, problem.precisions, problem.steps, problem.local_steps);
  ASSERT_TRUE(solved.usable());
  const auto [matrix, gradient] = problem.dense(-1);
  const RealMatrix inverse = matrix.inverse(), step = -(inverse * gradient),
                   covariance = inverse.block(0, 0, unknowns, unknowns);
  EXPECT_LT((solved.step() - step.block(0, 0, unknowns, 1)).norm(), 1e-9 * step.norm());
  EXPECT_LT((solved.local_step() - step.block(unknowns, 0, local, 1)).norm(), 1e-9 * step.norm());
  EXPECT_LT((solved.inverse() - covariance).norm(), 1e-9 * covariance.norm());
  EXPECT_LT((solved.inverse_diagonal() - covariance.diagonal()).norm(), 1e-9 * covariance.norm());
  EXPECT_NEAR(solved.log_determinant(), matrix.log_determinant(), 1e-9 * std::abs(matrix.log_determinant()));
}

TEST(LocalStates, AreEliminatedExactly) {
  for (const Index dense : {5, 300}) {  // in one panel of columns, and in several
    const RandomStates problem(30, dense);
    problem.with_system(
        [&](const BlockSystem& system) { expect_dense_solution(problem, NormalEquations(system, problem.priors)); });
  }
}

/// Error of a block in the dense problem without it.
RealMatrix left_out_by_force(const RandomStates& problem, Index b) {
  const auto [matrix, gradient] = problem.dense(b);
  const RowBlock& rows = problem.blocks.row(b);
  const RealMatrix residual = rows.residual - problem.row(b) * matrix.solve(gradient);
  return (rows.unwhiten * residual).block(0, 0, 3, 1) * rows.position_sigma;
}

/// Expects the errors that the dense problem has without each block.
void expect_left_out(const RandomStates& problem, const BlockSystem& system, const NormalEquations& normal) {
  const FactorisedEquations solved(normal, problem.precisions, problem.steps, problem.local_steps);
  const Eigen::Matrix3Xd errors = leave_one_out_errors(system, solved, 1);
  for (Index b = 0; b < problem.blocks.size(); ++b) {
    const RealMatrix wanted = left_out_by_force(problem, b);
    EXPECT_LT((Vector3(errors.col(b)) - wanted).norm(), 1e-9 * wanted.norm()) << b;
  }
}

// A state like any other: the smallest problem with local unknowns.
TEST(LocalStates, OneStateOfOneUnknown) {
  const RandomStates problem(12, 5, 1, 1);
  problem.with_system([&](const BlockSystem& system) {
    const NormalEquations normal(system, problem.priors);
    expect_dense_solution(problem, normal);
    const double at = problem.local_steps(0);  // the prior's precision is 20
    EXPECT_NEAR(local_prior_cost(normal, problem.local_steps), 20 * at * at, 1e-12 * (1 + 20 * at * at));
    const double slope = normal.local_gradient(0) + 20 * at;
    EXPECT_NEAR(local_gain(normal, VectorX::Constant(1, 3), problem.local_steps), 3 * slope,
                1e-12 * (1 + std::abs(slope)));
    expect_left_out(problem, system, normal);
  });
}

// Neither does a state need a prior of its own, nor two states a block in common for a prior that couples them.
TEST(LocalStates, PriorsOfStatesThatNoBlockCouples) {
  RandomStates problem(40);
  for (RowBlock& rows : problem.blocks.rows) rows.local[1] = {};
  std::erase_if(problem.priors, [](const LocalPrior& prior) { return prior.first == prior.second; });
  problem.priors.push_back({0, 2, MatrixX::Constant(2, 2, 0.5)});
  problem.with_system(
      [&](const BlockSystem& system) { expect_dense_solution(problem, NormalEquations(system, problem.priors)); });
}

TEST(LocalStates, OtherPriorsOfTheOtherUnknowns) {
  const RandomStates problem(30);
  problem.with_system([&](const BlockSystem& system) {
    const NormalEquations normal(system, problem.priors);
    const FactorisedEquations solved(normal, problem.precisions, problem.steps, problem.local_steps);
    const VectorX others = 3 * problem.precisions, steps = -problem.steps;
    const FactorisedEquations expected(normal, others, steps, problem.local_steps);
    const FactorisedEquations again = solved.with(others, steps);
    EXPECT_EQ(again.step(), expected.step());
    EXPECT_EQ(again.local_step(), expected.local_step());
    EXPECT_EQ(again.log_determinant(), expected.log_determinant());
    EXPECT_NE(again.log_determinant(), solved.log_determinant());
    EXPECT_TRUE(solved.with(problem.precisions, problem.steps).usable());
    EXPECT_FALSE(solved.with(VectorX::Constant(problem.unknowns, -1e9), steps).usable());
  });
}

TEST(LocalStates, WithoutASolutionThereIsNone) {
  RandomStates problem(30);
  problem.priors.push_back({2, 2, -1e6 * MatrixX::Identity(2, 2)});
  problem.with_system([&](const BlockSystem& system) {
    const NormalEquations normal(system, problem.priors);
    const VectorX tight = 1e9 * problem.precisions;  // what is left is positive definite in any case
    const FactorisedEquations solved(normal, tight, problem.steps, problem.local_steps);
    EXPECT_FALSE(solved.usable());
    EXPECT_FALSE(solved.with(tight, problem.steps).usable());
  });
}

TEST(LocalStates, ABlockDependsOnAStateOnce) {
  for (const Index state : {0, 3}) {
    RandomStates problem(30);
    RowBlock& rows = problem.blocks.rows[4];
    rows.local[0] = rows.local[1] = {state, Rows6::Ones(6, 2)};
    problem.with_system([&](const BlockSystem& system) {
      EXPECT_EQ(vernier_test::complaint([&] { (void)NormalEquations(system, problem.priors); }),
                "NormalEquations: a block depends twice on local state " + std::to_string(state));
    });
  }
}

TEST(LocalStates, ThreadsChangeNoBit) {
  const RandomStates problem(100, 300);
  const ThreadExecutor threads(3);
  problem.with_system([&](const BlockSystem& system) {
    const NormalEquations normal(system, problem.priors), shared(system, problem.priors, threads);
    EXPECT_EQ(normal.matrix, shared.matrix);
    EXPECT_EQ(normal.gradient, shared.gradient);
    const FactorisedEquations solved(normal, problem.precisions, problem.steps, problem.local_steps);
    const FactorisedEquations by_threads(shared, problem.precisions, problem.steps, problem.local_steps);
    EXPECT_EQ(solved.step(), by_threads.step());
    EXPECT_EQ(solved.local_step(), by_threads.local_step());
    EXPECT_EQ(solved.inverse_diagonal(), by_threads.inverse_diagonal());
    EXPECT_EQ(leave_one_out_errors(system, solved, 1), leave_one_out_errors(system, by_threads, 1));
  });
}

TEST(LocalStates, LeaveOneOutErrorsAreThoseOfSolvingWithoutTheBlock) {
  const RandomStates problem(40);
  problem.with_system(
      [&](const BlockSystem& system) { expect_left_out(problem, system, NormalEquations(system, problem.priors)); });
}

}  // namespace
}  // namespace vernier::normal_equations_test
