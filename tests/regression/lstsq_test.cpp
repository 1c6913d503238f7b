// SPDX-License-Identifier: BSD-3-Clause
// Output weights against SciPy's lstsq.

#include <gtest/gtest.h>

#include "lstsq_cases.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::lstsq_test {
namespace {

MatrixX matrix(const std::vector<double>& values, Index rows, Index cols) {
  EXPECT_EQ(static_cast<Index>(values.size()), rows * cols);
  return Eigen::Map<const MatrixX>(values.data(), rows, cols);
}

struct Matrices {
  explicit Matrices(const lstsq::Case& c)
      : x(matrix(c.x, c.samples, c.inputs)),
        theta(matrix(c.theta, (c.inputs + 1) * c.nodes, 1)),
        h(matrix(c.h, c.samples, c.nodes)),
        t(matrix(c.t, c.samples, c.outputs)),
        beta(matrix(c.beta, c.nodes, c.outputs)) {}
  MatrixX x;
  VectorX theta;
  MatrixX h, t, beta;
};

// Through the public door: an Elm without scaling, fitted at the stored weights. Every case has two inputs.
TEST(Lstsq, ElmGivesTheSameOutputWeights) {
  for (const lstsq::Case& c : lstsq::cases) {
    const Matrices m(c);
    const Eigen::Matrix<double, Eigen::Dynamic, 2> x = m.x;
    const Eigen::Matrix<double, Eigen::Dynamic, 1> t = m.t.col(0);
    const Elm elm{.hidden_nodes = static_cast<int>(c.nodes),
                  .activation = c.activation,
                  .input_scaling = Scaling::none,
                  .target_scaling = Scaling::none,
                  .rcond = c.rcond};
    const VectorX expected = m.beta.col(0), error = elm.fit_at(x, t, m.theta).beta() - expected;
    if (c.compare_beta) {
      EXPECT_LT(error.norm(), 1e-9 * expected.norm()) << c.name;
    } else {
      EXPECT_LT((m.h * error).norm(), 1e-9 * (m.h * expected).norm()) << c.name;
    }
  }
}

TEST(LstsqCut, ZeroMatrixGivesZero) {
  EXPECT_EQ(minimum_norm_solution(MatrixX::Zero(5, 2), MatrixX::Ones(5, 3), 1e-12), MatrixX::Zero(2, 3));
}

// Singular values 1, 1e-3, 1e-6: those at or below the cut are dropped, the others kept.
TEST(LstsqCut, RcondIsRelativeToTheLargestSingularValue) {
  MatrixX h = MatrixX::Zero(7, 3);
  h(0, 0) = 100;
  h(1, 1) = 0.1;
  h(2, 2) = 1e-4;
  const MatrixX t = MatrixX::Ones(7, 1);
  const MatrixX all = minimum_norm_solution(h, t, 1e-7);
  EXPECT_NEAR(all(2, 0), 1e4, 1e-6);
  const MatrixX two = minimum_norm_solution(h, t, 1e-5);
  EXPECT_NEAR(two(1, 0), 10, 1e-9);
  EXPECT_NEAR(two(2, 0), 0, 1e-9);
}

}  // namespace
}  // namespace vernier::lstsq_test
