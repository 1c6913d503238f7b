// SPDX-License-Identifier: BSD-3-Clause
// Constants against published figures, the update against its formulas written out, invariance, convergence and
// restarts.

#include "vernier/search/cma_es.hpp"

#include <gtest/gtest.h>

#include "real_matrix.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/search/minimize.hpp"

namespace vernier::cma_es_test {
namespace {

using vernier_test::RealMatrix;

const auto evaluate_bowl = [](const MatrixX& population, VectorX& fitness) {
  fitness.resize(population.cols());
  for (Index k = 0; k < population.cols(); ++k) fitness(k) = population.col(k).squaredNorm();
};

RealMatrix normal_matrix(Rng& rng, Index rows, Index columns) {
  RealMatrix out(rows, columns);
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i) out(i, j) = rng.normal();
  return out;
}

// Ten dimensions, ten individuals: the weights and effective size that Hansen's own programs print.
TEST(CmaEs, ConstantsOfTenDimensions) {
  const CmaEsConstants c(10, 10);
  EXPECT_EQ(c.mu, 5);
  const double expected[5] = {0.4563, 0.2708, 0.1622, 0.0852, 0.0255};
  for (Index i = 0; i < 5; ++i) EXPECT_NEAR(c.weights(i), expected[i], 1e-4);
  EXPECT_NEAR(c.mu_eff, 3.1673, 1e-4);
  EXPECT_NEAR(c.c_sigma, (3.1673 + 2) / (10 + 3.1673 + 5), 1e-5);
  EXPECT_NEAR(c.d_sigma, 1 + c.c_sigma, 1e-15);
  EXPECT_NEAR(c.c_c, (4 + 0.31673) / (14 + 0.63346), 1e-5);
  EXPECT_NEAR(c.c_1, 2 / (11.3 * 11.3 + 3.1673), 1e-7);
  EXPECT_NEAR(c.c_mu, 2 * (0.25 + 3.1673 + 1 / 3.1673 - 2) / (144 + 3.1673), 1e-5);
  EXPECT_NEAR(c.expected_norm, 3.0847, 1e-4);
  EXPECT_NEAR(CmaEsConstants(2, 6).expected_norm, std::sqrt(2) * (1 - 1.0 / 8 + 1.0 / 84), 1e-15);
}

// Ten dimensions, four individuals: by the tutorial's equations the negative weights sum to
// -(1 + 2 * 1.67435 / (1.45979 + 2)), for that is less than 1 + c_1 / c_mu = 3.86 and what leaves C positive
// definite, 18.
TEST(CmaEs, NegativeWeightsByHand) {
  const CmaEsConstants c(10, 4);
  EXPECT_NEAR(c.mu_eff, 1.45979, 1e-5);
  EXPECT_NEAR(c.weights(2) + c.weights(3), -1.96789, 1e-5);
  EXPECT_NEAR(c.weights(2) / c.weights(3), std::log(2.5 / 3) / std::log(2.5 / 4), 1e-12);
}

// In every dimension the rates leave C positive definite: no more than all of it is replaced, and the negative weights
// sum to no more than allows.
TEST(CmaEs, ConstantsAreSound) {
  for (const Index n : {1, 2, 5, 30, 500})
    for (const Index lambda : {2, 3, 4, 14, 100, 1000}) {
      const CmaEsConstants c(n, lambda);
      ASSERT_EQ(c.weights.size(), lambda);
      double positive = 0, negative = 0;
      for (Index i = 0; i < c.mu; ++i) {
        EXPECT_GE(c.weights(i), 0);
        positive += c.weights(i);
      }
      for (Index i = c.mu; i < lambda; ++i) {
        EXPECT_LE(c.weights(i), 0);
        negative += c.weights(i);
      }
      EXPECT_NEAR(positive, 1, 1e-12);
      EXPECT_GT(c.c_1, 0);
      EXPECT_GE(c.c_mu, 0);
      EXPECT_LE(c.c_1 + c.c_mu, 1 + 1e-15);
      EXPECT_LE(-negative * static_cast<double>(n) * c.c_mu, 1 - c.c_1 - c.c_mu + 1e-12);
      EXPECT_TRUE(std::isfinite(positive + negative));
    }
}

/// A state in the middle of a run.
CmaEs::State some_state(Index n, std::uint64_t seed) {
  Rng rng(seed);
  CmaEs::State s;
  const RealMatrix root = normal_matrix(rng, n, n);
  s.covariance = root * root.transpose() / static_cast<double>(n) + 0.1 * RealMatrix::identity(n);
  const detail::SymmetricEigen eigen = detail::symmetric_eigen(s.covariance);
  s.basis = eigen.vectors;
  s.scales = RealMatrix(eigen.values).sqrt();
  s.mean = s.path_c = s.path_sigma = VectorX::Zero(n);
  for (Index d = 0; d < n; ++d) {
    s.mean(d) = rng.uniform();
    s.path_c(d) = 0.1 * rng.normal();
    s.path_sigma(d) = 0.1 * rng.normal();
  }
  s.sigma = 0.2;
  s.updates = s.decomposed = 7;
  return s;
}

// The tutorial's equations, one after the other, with sums over points and the inverse root of C itself.
TEST(CmaEs, UpdateByItsFormulas) {
  for (const double long_path : {0.0, 3.0, 50.0}) {
    const Index n = 4, lambda = 9;
    CmaEs::State s = some_state(n, 3);
    s.path_sigma(0) += long_path;  // stops the path of C
    const CmaEs::State old = s;
    Rng rng(5);
    const RealMatrix z = normal_matrix(rng, n, lambda);
    const std::vector<Index> order{3, 1, 4, 0, 5, 8, 2, 6, 7};
    CmaEs::update(s, z, order);

    const CmaEsConstants c(n, lambda);
    const RealMatrix basis = old.basis, scales = RealMatrix::diagonal(old.scales), mean = old.mean;
    const RealMatrix inverse_root = basis * scales.inverse() * basis.transpose();
    ASSERT_LT((inverse_root * old.covariance * inverse_root - RealMatrix::identity(n)).norm(), 1e-10);
    std::vector<RealMatrix> y;
    for (const Index k : order) y.push_back(basis * scales * z.col(k));
    RealMatrix step(n, 1);
    for (Index i = 0; i < c.mu; ++i) step += c.weights(i) * y[static_cast<std::size_t>(i)];
    EXPECT_LT((s.mean - (mean + 0.2 * step)).norm(), 1e-13);
    const RealMatrix path_sigma = (1 - c.c_sigma) * RealMatrix(old.path_sigma) +
                                  std::sqrt(c.c_sigma * (2 - c.c_sigma) * c.mu_eff) * (inverse_root * step);
    EXPECT_LT((s.path_sigma - path_sigma).norm(), 1e-11);
    const double h = path_sigma.norm() / std::sqrt(1 - std::pow(1 - c.c_sigma, 16)) < (1.4 + 2.0 / 5) * c.expected_norm;
    EXPECT_EQ(h, long_path < 10 ? 1 : 0);  // a path of 3 is longer than expected, but not by 1.8 times
    const RealMatrix path_c =
        (1 - c.c_c) * RealMatrix(old.path_c) + h * std::sqrt(c.c_c * (2 - c.c_c) * c.mu_eff) * step;
    EXPECT_LT((s.path_c - path_c).norm(), 1e-12);
    EXPECT_NEAR(s.sigma,
                0.2 * std::exp(std::min(1.0, c.c_sigma / c.d_sigma * (path_sigma.norm() / c.expected_norm - 1))),
                1e-12);
    RealMatrix covariance =
        (1 + c.c_1 * (1 - h) * c.c_c * (2 - c.c_c) - c.c_1 - c.c_mu * c.weights.sum()) * RealMatrix(old.covariance) +
        c.c_1 * path_c * path_c.transpose();
    for (Index i = 0; i < lambda; ++i) {
      const RealMatrix& yi = y[static_cast<std::size_t>(i)];
      const double w = c.weights(i) * (c.weights(i) >= 0 ? 1 : 4 / (inverse_root * yi).squared_norm());
      covariance += c.c_mu * w * yi * yi.transpose();
    }
    EXPECT_LT((s.covariance - covariance).norm(), 1e-12);
    EXPECT_GT(c.weights(c.mu) - c.weights(lambda - 1), 0.1);  // negative weights are at work
    // decomposed anew
    EXPECT_EQ(s.decomposed, 8);
    const RealMatrix root = RealMatrix(s.basis) * RealMatrix::diagonal(s.scales);
    EXPECT_LT((root * root.transpose() - s.covariance).norm(), 1e-12);
  }
}

// Runs end by their tolerances, and the next has a larger population; without restarts the search is over.
TEST(CmaEs, ConvergesAndRestarts) {
  const Box box = Box::cube(3, -1, 2);
  const CmaEs once{.generations = 5000};
  const auto sphere = [](const VectorX& x) { return x.squaredNorm(); };
  const SearchResult result = minimize(once, sphere, box, {}, 1);
  EXPECT_EQ(result.status, SearchStatus::schedule_ended);
  EXPECT_LT(result.generations, 400);
  EXPECT_LT(result.best_fitness, 1e-12);

  const CmaEs ipop{.generations = 5000, .restarts = 3};
  CmaEs::State s = ipop.start(box, 1, evaluate_bowl);
  std::vector<Index> sizes{s.individuals};
  while (!ipop.done(s)) {
    ipop.step(s, box, evaluate_bowl);
    if (s.individuals != sizes.back()) {
      sizes.push_back(s.individuals);
      EXPECT_EQ(s.updates, 1);
      EXPECT_GT(s.sigma, 0.1);
    }
  }
  EXPECT_EQ(sizes, (std::vector<Index>{7, 14, 28, 56}));
  EXPECT_EQ(s.run, 3);
  EXPECT_LT(s.generation, 5000);
  // so does an objective without any finite value
  const auto nowhere = [](const VectorX&) { return std::numeric_limits<double>::infinity(); };
  EXPECT_LT(minimize(once, nowhere, box, {}, 1).generations, 60);
}

// A run ends where sigma times the largest standard deviation, the root of C's diagonal, or times the largest part of
// C's path, is below the tolerance.
TEST(CmaEs, EndsBySpread) {
  const Box box = Box::cube(3, -1, 2);
  const CmaEs cma{.tolerance_x = 1e-6, .tolerance_f = 0};
  const auto ends = [&](double sigma, double variance, double path) {
    CmaEs::State s = cma.start(box, 1, evaluate_bowl);
    s.sigma = sigma;
    s.covariance = MatrixX::Identity(3, 3) * (1e-4 * variance);
    s.covariance(1, 1) = variance;
    s.basis = MatrixX::Identity(3, 3);
    s.scales = RealMatrix(s.covariance).diagonal().sqrt();
    s.path_c = s.path_sigma = VectorX::Zero(3);
    s.path_c(2) = path / (1 - CmaEsConstants(3, s.individuals).c_c);  // what a step leaves of it
    EXPECT_FALSE(s.converged);
    cma.step(s, box, evaluate_bowl);
    return s.converged;
  };
  EXPECT_FALSE(ends(1e-3, 1e-4, 0));     // 1e-5: ten times the tolerance, whatever a step makes of it
  EXPECT_TRUE(ends(1e-3, 1e-8, 0));      // 1e-7
  EXPECT_FALSE(ends(1e-9, 1e8, 0));      // 1e-5
  EXPECT_TRUE(ends(1e-11, 1e8, 0));      // 1e-7
  EXPECT_FALSE(ends(2.5e-6, 1e-10, 1));  // by the path, in either direction; C learns a tenth of its square
  EXPECT_FALSE(ends(2.5e-6, 1e-10, -1));
  EXPECT_TRUE(ends(2.5e-7, 1e-10, 1));
  EXPECT_FALSE(ends(1e3, 1e4, 0));  // 1e5
  EXPECT_TRUE(ends(1e3, 1e8, 0));   // 1e7, wider than 1e6: it diverges
}

// The optimum in a corner: the mirrors lead there.
TEST(CmaEs, FindsACorner) {
  const auto slope = [](const VectorX& x) { return x(0) - x(1) + x(2); };
  const SearchResult result = minimize(CmaEs{}, slope, Box::cube(3, -1, 2), {}, 2);
  EXPECT_NEAR(result.best_fitness, -4, 1e-6);
}

// What was loaded is checked: a state as it is made, and with each of its members of another size.
TEST(CmaEs, InconsistentStatesAreSeen) {
  const CmaEs::State made = CmaEs{}.start(Box::cube(3, -1, 2), 1, evaluate_bowl);
  EXPECT_TRUE(made.consistent());
  for (VectorX CmaEs::State::*member :
       {&CmaEs::State::mean, &CmaEs::State::scales, &CmaEs::State::path_c, &CmaEs::State::path_sigma}) {
    CmaEs::State s = made;
    s.*member = VectorX::Zero(2);
    EXPECT_FALSE(s.consistent());
  }
  for (MatrixX CmaEs::State::*member : {&CmaEs::State::covariance, &CmaEs::State::basis})
    for (const auto& [rows, cols] : {std::pair<Index, Index>{3, 2}, {2, 3}, {2, 2}}) {
      CmaEs::State s = made;
      s.*member = MatrixX::Zero(rows, cols);
      EXPECT_FALSE(s.consistent()) << rows << " x " << cols;
    }
  CmaEs::State s = made;
  s.best = VectorX::Zero(4);
  EXPECT_FALSE(s.consistent());
  s = made;
  s.individuals = 2;
  EXPECT_TRUE(s.consistent());
  s.individuals = 1;
  EXPECT_FALSE(s.consistent());
}

}  // namespace
}  // namespace vernier::cma_es_test
