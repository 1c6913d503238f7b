// SPDX-License-Identifier: BSD-3-Clause
// The error of poses left out as a function of priors.

#include "vernier/error_model/prior_objective.hpp"

#include <gtest/gtest.h>

#include "random_blocks.hpp"
#include "real_matrix.hpp"

namespace vernier::prior_objective_test {
namespace {

using vernier_test::RandomBlocks;
using vernier_test::RealMatrix;
using vernier_test::vector;

/// The joints with terms are the first and the last; two of the dense unknowns are elastic.
TEST(PriorObjective, IsTheErrorOfPosesLeftOutWithThePriorsItNames) {
  const RandomBlocks poses(40, 21, false);
  const NormalEquations normal = poses.normal();
  const VectorX before = VectorX::LinSpaced(15, 1, 2), steps = VectorX::Zero(15);
  const VectorX relative = vector({1, 1, 0.5, 0.5, 1, 1, 0.5, 0.5, 0.25, 0.25});
  poses.with_system([&](const BlockSystem& system) {
    const PriorObjective objective(system, normal, before, steps, 2, relative, 3);
    ASSERT_EQ(objective.dimension(), 4);  // elastic, two joints, exponent
    const Box box = objective.box();
    EXPECT_EQ(RealMatrix(box.lower), vector({-1, -1, -1, 0.5}));  // precisions of 0.1 to 1e4, exponents of 0.5 to 2
    EXPECT_EQ(RealMatrix(box.upper), vector({4, 4, 4, 2}));
    const RealMatrix at = vector({1, 2, -1, 1.5});
    const VectorX precisions = objective.precisions(at);
    for (Index k = 0; k < 3; ++k) EXPECT_EQ(precisions(k), before(k));  // of geometry
    EXPECT_DOUBLE_EQ(precisions(3), 10);
    EXPECT_DOUBLE_EQ(precisions(4), 10);
    EXPECT_DOUBLE_EQ(precisions(5), 100);          // a first harmonic
    EXPECT_DOUBLE_EQ(precisions(7), 100 / 0.5);    // the second: its amplitude falls by 2^-0.5 more than it did
    EXPECT_DOUBLE_EQ(precisions(9), 0.1);          // the last joint
    EXPECT_DOUBLE_EQ(precisions(14), 0.1 / 0.25);  // its fourth
    const FactorisedEquations solved(normal, precisions, steps);
    const RealMatrix errors = RealMatrix::of(leave_one_out_errors(system, solved, 3));
    double expected = 0;
    for (Index k = 0; k < errors.cols(); ++k) expected += errors.col(k).norm() / static_cast<double>(errors.cols());
    EXPECT_DOUBLE_EQ(objective.error(precisions), expected);
    RealMatrix population(4, 2);  // zeros, and these
    population.set_block(0, 1, at);
    VectorX fitness(2);
    objective(population, fitness);
    EXPECT_DOUBLE_EQ(fitness(1), expected);
    EXPECT_DOUBLE_EQ(fitness(0), objective.error(objective.precisions(VectorX::Zero(4))));
    EXPECT_NE(fitness(0), expected);
  });
}

// Without elastic terms the first variable is of the first joint.
TEST(PriorObjective, HasNoVariableForTermsThatAreNotThere) {
  const RandomBlocks poses(10, 21, false);
  const NormalEquations normal = poses.normal();
  poses.with_system([&](const BlockSystem& system) {
    const PriorObjective objective(system, normal, VectorX::Ones(15), VectorX::Zero(15), 0, VectorX::Ones(10), 1);
    ASSERT_EQ(objective.dimension(), 3);
    const VectorX precisions = objective.precisions(vector({2, -1, 1.5}));
    for (Index k = 0; k < 15; ++k) EXPECT_DOUBLE_EQ(precisions(k), k < 5 ? 1 : k < 9 ? 100 : 0.1) << k;
  });
}

}  // namespace
}  // namespace vernier::prior_objective_test
