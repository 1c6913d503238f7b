// SPDX-License-Identifier: BSD-3-Clause
// Learned errors whose kind is known at run time: what they predict is what they were made of, in any frame.

#include "vernier/compensation/learned_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/kernel_elm.hpp"

namespace vernier::learned_error_test {
namespace {

using vernier_test::RealMatrix;

/// Joint values of two joints, and an error that depends on both.
struct Samples {
  JointRows<2> joints = JointRows<2>(30, 2);
  PointRows errors = PointRows(30, 3);
  Samples() {
    Rng rng(1);
    for (Index i = 0; i < 30; ++i) {
      for (Index j = 0; j < 2; ++j) joints(i, j) = rng.uniform(-1, 1);
      errors(i, 0) = 1e-3 * (1 + std::sin(joints(i, 0)));
      errors(i, 1) = 2e-3 * joints(i, 1);
      errors(i, 2) = -1e-3 + 1e-3 * joints(i, 0) * joints(i, 1);
    }
  }
};

/// Predictions and derivatives are those of what it is made of; turned, they are turned.
template <class Fitted>
void expect_the_same(const Fitted& fitted, const LearnedError<2>& learned) {
  const Matrix3 rotation = exp_so3(Vector3(0.4, -0.7, 1.1));
  const LearnedError<2> turned = learned.turned(rotation);
  EXPECT_FALSE(learned.constant());
  EXPECT_FALSE(turned.constant());
  EXPECT_EQ(turned.network() == nullptr, learned.network() == nullptr);
  EXPECT_EQ(turned.kernels() == nullptr, learned.kernels() == nullptr);
  Rng rng(2);
  const JointRows<2> rows = vernier_test::random_joint_rows<2>(rng, 5, 1);
  const RealMatrix of_rows = RealMatrix::of(learned.predict(rows));
  for (Index i = 0; i < 5; ++i) {
    const JointVector<2> q = configuration(rows, i);
    const Vector3 error = learned.predict(q);
    EXPECT_EQ(error, Vector3(fitted.predict(q)));
    EXPECT_LT((RealMatrix(error) - of_rows.row(i).transpose()).norm(), 1e-12);
    EXPECT_GT(error.norm(), 1e-4);
    EXPECT_LT((RealMatrix(Vector3(turned.predict(q))) - RealMatrix(rotation) * error).norm(), 1e-12);
    const RealMatrix slope = RealMatrix::of(learned.derivative(q));
    EXPECT_EQ(slope, RealMatrix::of(fitted.derivative(q)));
    EXPECT_LT((RealMatrix::of(turned.derivative(q)) - RealMatrix(rotation) * slope).norm(), 1e-12);
  }
}

TEST(LearnedError, OfANetwork) {
  const Samples samples;
  const ElmPredictor<2, 3> network = Elm{.hidden_nodes = 8}.fit(samples.joints, samples.errors, {.seed = 3});
  const LearnedError<2> learned(network);
  EXPECT_NE(learned.network(), nullptr);
  EXPECT_EQ(learned.kernels(), nullptr);
  expect_the_same(network, learned);
}

TEST(LearnedError, OfKernels) {
  const Samples samples;
  const KernelPredictor<2, 3> kernels = KernelElm{}.fit(samples.joints, samples.errors, {});
  const LearnedError<2> learned(kernels);
  EXPECT_EQ(learned.network(), nullptr);
  EXPECT_NE(learned.kernels(), nullptr);
  expect_the_same(kernels, learned);
}

}  // namespace
}  // namespace vernier::learned_error_test
