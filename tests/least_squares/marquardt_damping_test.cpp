// SPDX-License-Identifier: BSD-3-Clause
// The step control of Levenberg-Marquardt by hand, and damped steps.

#include "vernier/least_squares/marquardt_damping.hpp"

#include <gtest/gtest.h>

#include "random_blocks.hpp"

namespace vernier::marquardt_damping_test {
namespace {

using vernier_test::RealMatrix;

TEST(MarquardtDamping, RaisesEverFasterAndStartsWhereThereWasNone) {
  MarquardtDamping damping;
  EXPECT_EQ(damping.value(), 0);
  damping.reject();
  EXPECT_EQ(damping.value(), 1e-3);
  damping.reject();
  EXPECT_EQ(damping.value(), 4e-3);  // factors 2 (spent on the start), 4, 8
  damping.reject();
  EXPECT_EQ(damping.value(), 32e-3);
}

TEST(MarquardtDamping, FollowsTheRatioOfDecreases) {
  MarquardtDamping damping(0.9);
  damping.accept(1, 1);  // a model that was exact: a third
  EXPECT_NEAR(damping.value(), 0.3, 1e-15);
  damping.accept(0.5, 1);  // half of the predicted decrease: unchanged
  EXPECT_NEAR(damping.value(), 0.3, 1e-15);
  damping.accept(0.25, 1);  // 1 - (-1/2)^3 = 9/8
  EXPECT_NEAR(damping.value(), 0.3 * 9 / 8, 1e-15);
  damping.reject();
  damping.accept(0.5, 1);
  damping.reject();  // the factor starts again at 2
  EXPECT_NEAR(damping.value(), 0.3 * 9 / 8 * 2 * 2, 1e-15);
}

// Only the ratio counts, not the unit of the cost.
TEST(MarquardtDamping, DecreasesInAnyUnit) {
  for (const double unit : {1e-6, 4.0, 1e6}) {
    MarquardtDamping damping(0.8);
    damping.accept(0.5 * unit, unit);
    EXPECT_NEAR(damping.value(), 0.8, 1e-15);
    damping.accept(0.25 * unit, unit);
    EXPECT_NEAR(damping.value(), 0.9, 1e-15);
  }
}

TEST(MarquardtDamping, ADampedStepSolvesTheRaisedSystem) {
  const vernier_test::RandomBlocks blocks(15, 4);
  Rng rng(5);
  const VectorX precisions = vernier_test::random_squares(rng, 15), steps = vernier_test::random_vector(rng, 15);
  const NormalEquations normal = blocks.normal();
  const double damping = 0.3;
  const FactorisedEquations solved(normal, precisions, steps, {}, eigen_sparse_solver, damping);
  const RealMatrix prior = RealMatrix::diagonal(precisions);
  RealMatrix matrix = normal.matrix + prior;
  for (Index k = 0; k < 15; ++k) matrix(k, k) *= 1 + damping;
  const RealMatrix step = -(matrix.inverse() * (normal.gradient + prior * steps));
  EXPECT_LT((solved.step() - step).norm(), 1e-9 * step.norm());
}

}  // namespace
}  // namespace vernier::marquardt_damping_test
