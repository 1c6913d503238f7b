#include "vernier/least_squares/estimate_covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "vernier/core/rng.hpp"

namespace vernier::estimate_covariance_test {
namespace {

MatrixX random_matrix(Index rows, Index columns, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(rows, columns);
  for (auto& x : out.reshaped()) x = rng.normal();
  return out;
}

TEST(EstimateCovariance, EqualsTheTextbookCovariance) {
  const MatrixX j = random_matrix(40, 5, 3);
  const EstimateCovariance p(j, VectorX::Constant(40, 0.25), VectorX::Zero(5), VectorX::Zero(5));
  const MatrixX expected = 0.25 * (j.transpose() * j).inverse();
  EXPECT_LT((p.covariance - expected).norm() / expected.norm(), 1e-12);
  EXPECT_EQ(p.rank, 5);
  const VectorX s = Eigen::JacobiSVD<MatrixX>(j).singularValues();
  EXPECT_NEAR(p.condition, s(0) / s(4), 1e-10);
}

// J = diag(1, 2), rows of variances 4 and 9, a prior of weight 3 and variance 5 on the first unknown:
// A = diag(4, 4), A^-1 diag(1 * 4 + 9 * 5, 4 * 9) A^-1 = diag(49 / 16, 36 / 16).
TEST(EstimateCovariance, ByHandWithAPrior) {
  const EstimateCovariance c(Eigen::Vector2d(1, 2).asDiagonal().toDenseMatrix(), Eigen::Vector2d(4, 9),
                             Eigen::Vector2d(3, 0), Eigen::Vector2d(5, 100));
  EXPECT_LT((c.inverse - MatrixX::Identity(2, 2) / 4).norm(), 1e-15);
  EXPECT_LT((c.covariance - Eigen::Vector2d(49.0 / 16, 36.0 / 16).asDiagonal().toDenseMatrix()).norm(), 1e-14);
  EXPECT_EQ(c.rank, 2);
  EXPECT_NEAR(c.condition, 2, 1e-14);  // of the rows alone
  EXPECT_LT((c.singular_values - Eigen::Vector2d(2, 1)).norm(), 1e-14);
}

TEST(EstimateCovariance, EqualsTheSandwichOfDenseMatrices) {
  const MatrixX j = random_matrix(12, 4, 5);  // few rows
  const VectorX rows = random_matrix(12, 1, 6).cwiseAbs2(), prior = Eigen::Vector4d(0.5, 0, 20, 0),
                variance = Eigen::Vector4d(4, 7, 0.1, 9);
  const MatrixX a = (j.transpose() * j + MatrixX(prior.asDiagonal())).inverse();
  const MatrixX middle =
      j.transpose() * rows.asDiagonal() * j + MatrixX(prior.cwiseProduct(variance).cwiseProduct(prior).asDiagonal());
  const EstimateCovariance c(j, rows, prior, variance);
  EXPECT_LT((c.inverse - a).norm(), 1e-12 * a.norm());
  EXPECT_LT((c.covariance - a * middle * a).norm(), 1e-12 * (a * middle * a).norm());
}

// Where the assumed variances are the true ones, it is the posterior: (J'J / s^2 + 1 / w^2)^-1.
TEST(EstimateCovariance, IsThePosteriorWhereAssumptionsHold) {
  const MatrixX j = random_matrix(9, 3, 7);
  constexpr double s = 0.3, w = 0.05;
  const EstimateCovariance c(j, VectorX::Constant(9, s * s), VectorX::Constant(3, s * s / (w * w)),
                             VectorX::Constant(3, w * w));
  const MatrixX posterior = (j.transpose() * j / (s * s) + MatrixX::Identity(3, 3) / (w * w)).inverse();
  EXPECT_LT((c.covariance - posterior).norm(), 1e-12 * posterior.norm());
  EXPECT_LT(c.covariance.diagonal().maxCoeff(), w * w);
}

TEST(EstimateCovariance, SaysWhenTheRankIsDeficient) {
  MatrixX j = random_matrix(40, 3, 4);
  j.col(2) = j.col(0) + j.col(1);
  const EstimateCovariance p(j, VectorX::Ones(40), VectorX::Zero(3), VectorX::Zero(3));
  EXPECT_EQ(p.rank, 2);
  EXPECT_TRUE(std::isinf(p.condition));
  EXPECT_EQ(p.covariance.size(), 0);
  EXPECT_EQ(EstimateCovariance(j, VectorX::Ones(40), VectorX::Ones(3), VectorX::Ones(3)).covariance.rows(), 3);
}

}  // namespace
}  // namespace vernier::estimate_covariance_test
