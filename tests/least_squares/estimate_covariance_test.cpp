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
