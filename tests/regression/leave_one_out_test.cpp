// SPDX-License-Identifier: BSD-3-Clause
// Closed-form leave-one-out error against refits, and the ridge it chooses.

#include <gtest/gtest.h>

#include <limits>

#include "instruction_sets.hpp"
#include "regression_samples.hpp"
#include "vernier/regression/detail/leave_one_out.hpp"
#include "vernier/regression/least_squares.hpp"
#include "vernier/regression/ridge_elm.hpp"

namespace vernier::leave_one_out_test {
namespace {

using namespace vernier_test;

constexpr double infinity = std::numeric_limits<double>::infinity();

RealMatrix random_matrix(Index rows, Index cols, std::uint64_t seed, double mean = 0) {
  Rng rng(seed);
  MatrixX m(rows, cols);
  for (double& value : elements(m)) value = rng.normal() + mean;
  return m;
}

/// Ridge with an unpenalised intercept by QR of the stacked system, in long double: no centring, no decomposition
/// shared with the code, and digits to spare for a small lambda. By Gram and Schmidt: as a loop it compiles in no time.
RealMatrix ridge_with_intercept(const RealMatrix& h, const RealMatrix& t, double lambda) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Index n = h.rows(), unknowns = h.cols() + 1, columns = unknowns + t.cols();
  const RealMatrix samples = beside(beside(filled(n, 1, 1), h), t);
  Matrix a = Matrix::Zero(n + unknowns, columns), r = Matrix::Zero(unknowns, columns);  // [1 h t; 0 sqrt(lambda) I 0]
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < n; ++i) a(i, j) = static_cast<long double>(samples(i, j));
  for (Index k = 1; k < unknowns; ++k) a(n + k, k) = std::sqrt(static_cast<long double>(lambda));
  const auto dot = [&](Index j, Index k) {
    long double sum = 0;
    for (Index i = 0; i < a.rows(); ++i) sum += a(i, j) * a(i, k);
    return sum;
  };
  for (Index k = 0; k < unknowns; ++k) {  // each column is taken out of those that follow
    const long double norm = std::sqrt(dot(k, k));
    r(k, k) = norm;
    for (Index j = k + 1; j < columns; ++j) {
      r(k, j) = dot(k, j) / norm;
      for (Index i = 0; i < a.rows(); ++i) a(i, j) -= r(k, j) / norm * a(i, k);
    }
  }
  RealMatrix out(unknowns, t.cols());
  for (Index o = unknowns; o < columns; ++o)
    for (Index k = unknowns - 1; k >= 0; --k) {  // R x = Q't
      for (Index j = k + 1; j < unknowns; ++j) r(k, o) -= r(k, j) * r(j, o);
      r(k, o) /= r(k, k);
      out(k, o - unknowns) = static_cast<double>(r(k, o));
    }
  return out;
}

/// Residual of each sample at the fit of all others.
RealMatrix refitted_residuals(const RealMatrix& h, const RealMatrix& t, double lambda) {
  const Index n = h.rows();
  RealMatrix out(n, t.cols());
  for (Index i = 0; i < n; ++i) {
    const std::vector<Index> others = vernier_test::all_but(i, n);
    const RealMatrix beta = ridge_with_intercept(rows_of(h, others), rows_of(t, others), lambda);
    out.set_block(i, 0, t.row(i) - beta.row(0) - h.row(i) * bottom(beta, h.cols()));
  }
  return out;
}

// Fewer nodes than samples (through QR and not), as many, one less, and more: the closed form is exact.
TEST(LeaveOneOut, EqualsRefits) {
  for (const auto& [n, nodes] : {std::pair<Index, Index>{25, 5}, {12, 8}, {10, 9}, {10, 10}, {10, 30}, {2, 4}}) {
    const RealMatrix h = random_matrix(n, nodes, 1, 3);  // a mean that centring must deal with
    const RealMatrix t = random_matrix(n, 3, 2, 5);
    const RidgePath path(h, t);
    for (const double relative : {1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
      const double lambda = relative * path.scale();
      const RealMatrix expected = refitted_residuals(h, t, lambda);
      EXPECT_LT((expected - path.leave_one_out_residuals(lambda)).norm(), 1e-9 * expected.norm())
          << n << " samples, " << nodes << " nodes, lambda " << relative;
    }
  }
}

// The same with columns that repeat, so that fewer directions remain than nodes.
TEST(LeaveOneOut, EqualsRefitsWhenNodesRepeat) {
  for (const Index n : {9, 30}) {
    const RealMatrix four = random_matrix(n, 4, 3), h = beside(beside(four, four), four);
    const RealMatrix t = random_matrix(n, 2, 4);
    const RidgePath path(h, t);
    EXPECT_EQ(path.rank(), 4);
    for (const double relative : {1e-1, 1e-4}) {
      const RealMatrix expected = refitted_residuals(h, t, relative * path.scale());
      EXPECT_LT((expected - path.leave_one_out_residuals(relative * path.scale())).norm(), 1e-9 * expected.norm());
    }
  }
}

TEST(LeaveOneOut, OfTheMeanAlone) {
  const RealMatrix t = random_matrix(7, 2, 5, 2);
  const RidgePath path(random_matrix(7, 3, 6), t);
  const MatrixX residuals = path.leave_one_out_residuals(infinity);
  for (Index i = 0; i < 7; ++i)
    for (Index k = 0; k < 2; ++k) {
      const double mean_of_others = (t.col(k).sum() - t(i, k)) / 6;
      EXPECT_NEAR(residuals(i, k), t(i, k) - mean_of_others, 1e-14);
    }
  EXPECT_EQ(RealMatrix(path.beta(infinity)), zeros(3, 2));
  EXPECT_NEAR((column_means(t).transpose() - path.offset(path.beta(infinity))).norm(), 0, 1e-15);
}

TEST(RidgePath, SolvesTheRidgeProblem) {
  for (const auto& [n, nodes] : {std::pair<Index, Index>{40, 6}, {8, 6}, {6, 15}}) {
    const RealMatrix h = random_matrix(n, nodes, 9, 1), t = random_matrix(n, 2, 10, -4);
    const RidgePath path(h, t);
    for (const double relative : {1.0, 1e-3, 1e-6}) {
      const RealMatrix expected = ridge_with_intercept(h, t, relative * path.scale());
      const MatrixX beta = path.beta(relative * path.scale());
      EXPECT_LT((beta - bottom(expected, nodes)).norm(), 1e-9 * expected.norm());
      EXPECT_LT((path.offset(beta) - expected.row(0).transpose()).norm(), 1e-9 * expected.norm());
    }
  }
}

TEST(ChooseLambda, HasTheLeastErrorOfItsGrid) {
  const RealMatrix h = random_matrix(20, 8, 11), t = h * random_matrix(8, 2, 12) + 0.5 * random_matrix(20, 2, 13);
  const RidgePath path(h, t);
  const LeaveOneOutChoice choice = choose_lambda(path, 20);
  ASSERT_TRUE(std::isfinite(choice.lambda));
  EXPECT_NEAR(choice.mean_squared_error, refitted_residuals(h, t, choice.lambda).squared_norm() / 20,
              1e-9 * choice.mean_squared_error);
  for (int half_decades = 0; half_decades <= 24; ++half_decades) {
    const double lambda = path.scale() * std::pow(10, -half_decades / 2.0);
    EXPECT_LE(choice.mean_squared_error, refitted_residuals(h, t, lambda).squared_norm() / 20 * (1 + 1e-9));
  }
  EXPECT_LT(choice.mean_squared_error, path.leave_one_out_residuals(infinity).squaredNorm() / 20);
}

TEST(ChooseLambda, FewSamplesAndConstantNodes) {
  EXPECT_EQ(choose_lambda(RidgePath(random_matrix(1, 3, 16), random_matrix(1, 1, 17)), 1).lambda, infinity);
  EXPECT_EQ(choose_lambda(RidgePath(filled(5, 3, 0.5), random_matrix(5, 1, 18)), 5).lambda, infinity);
}

// Targets that are constant are those of the mean alone, targets that the nodes make exactly want the least ridge.
TEST(ChooseLambda, EndsOfItsGrid) {
  const RealMatrix h = random_matrix(30, 4, 19);
  EXPECT_EQ(choose_lambda(RidgePath(h, filled(30, 1, 0.25)), 30).lambda, infinity);
  const RidgePath exact(h, h * random_matrix(4, 1, 20));
  EXPECT_NEAR(choose_lambda(exact, 30).lambda / exact.scale(), 1e-12, 1e-18);
}

// The t-statistic of the differences of squared left-out errors.
TEST(EvidenceAgainstMean, IsAMeanOverItsStandardError) {
  for (const Index n : {3, 5, 40}) {
    const RealMatrix h = random_matrix(n, 2, 21), t = h * random_matrix(2, 2, 22) + random_matrix(n, 2, 23);
    const RidgePath path(h, t);
    const double lambda = 0.1 * path.scale(), count = static_cast<double>(n);
    const RealMatrix off = refitted_residuals(h, t, lambda);
    double sum = 0, squares = 0;
    for (Index i = 0; i < n; ++i) {
      double gain = -off.row(i).squared_norm();
      for (Index o = 0; o < 2; ++o) gain += std::pow((t(i, o) - t.col(o).mean()) * count / (count - 1), 2);
      sum += gain;
      squares += gain * gain;
    }
    const double mean = sum / count, variance = (squares - sum * mean) / (count - 1);
    EXPECT_NEAR(evidence_against_mean(path, lambda, n), mean / std::sqrt(variance / count), 1e-8);
    EXPECT_EQ(evidence_against_mean(path, infinity, n), 0);
  }
}

/// Samples of a smooth function with noise, and hidden weights of some size.
struct Layer {
  MatrixX features, targets;
  HiddenLayer layer;
  VectorX theta;
  Layer(Index samples, int nodes, double size, Activation activation, double noise = 0.05, int outputs = 3)
      : features(samples, 4), targets(samples, outputs), layer{.nodes = nodes, .activation = activation} {
    Rng rng(7);
    for (double& value : elements(features)) value = rng.uniform(-1, 1);
    for (Index i = 0; i < samples; ++i)
      for (Index o = 0; o < outputs; ++o)
        targets(i, o) = 4 + std::sin(3 * features(i, o % 3) + features(i, 3)) + noise * rng.normal();
    theta.resize(nodes * 5);
    for (auto& value : theta) value = size * rng.uniform(-1, 1);
  }
  /// By singular values.
  double expected() const {
    return choose_lambda(RidgePath(hidden_outputs(layer, features, theta), targets), targets.rows()).mean_squared_error;
  }
};

TEST(LeaveOneOutError, FromProductsIsThatOfSingularValues) {
  for (const auto activation : {Activation::sigmoid, Activation::tanh})
    for (const auto& [samples, nodes] :
         {std::pair<Index, int>{331, 17}, {500, 24}, {96, 40}, {64, 1}, {45, 40}, {42, 40}})
      for (const double size : {0.3, 1.0, 5.0})
        for (const int outputs : {1, 3}) {
          const Layer at(samples, nodes, size, activation, 0.05, outputs);
          const double expected = at.expected();
          for (const InstructionSet set : instruction_sets()) {
            detail::LeaveOneOutError error(at.layer, at.features, at.targets, set);
            const double found = error(at.theta);
            EXPECT_EQ(error(at.theta), found);      // keeps nothing
            if (size < 1 && found == -1) continue;  // small weights ask for a ridge below what products tell
            EXPECT_NEAR(found / expected, 1, 1e-8) << samples << ' ' << nodes << ' ' << size;
          }
        }
}

// For pure noise the mean alone is often best, also when errors are computed from products.
TEST(LeaveOneOutError, OfTheMeanAlone) {
  int mean_wins = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Layer of(40, 6, 1, Activation::tanh);
    of.targets = random_matrix(40, 3, 300 + seed, 2);
    const LeaveOneOutChoice expected =
        choose_lambda(RidgePath(hidden_outputs(of.layer, of.features, of.theta), of.targets), 40);
    mean_wins += !std::isfinite(expected.lambda);
    EXPECT_NEAR(detail::LeaveOneOutError(of.layer, of.features, of.targets)(of.theta), expected.mean_squared_error,
                1e-8 * expected.mean_squared_error);
  }
  EXPECT_GE(mean_wins, 3);
}

TEST(LeaveOneOutError, SaysWhereProductsDoNotTell) {
  const auto says = [](const Layer& at) {
    return detail::LeaveOneOutError(at.layer, at.features, at.targets)(at.theta);
  };
  EXPECT_EQ(says(Layer(400, 30, 1e-3, Activation::sigmoid, 0)), -1);  // nearly linear nodes, and nothing but signal
  Layer constant(400, 5, 1, Activation::sigmoid);
  constant.theta.setZero();  // equal, constant nodes
  EXPECT_EQ(says(constant), -1);
  Layer unusable(400, 5, 1, Activation::sigmoid);
  unusable.theta(3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(says(unusable), -1);
  EXPECT_FALSE(detail::LeaveOneOutError::supports({.nodes = 10, .activation = Activation::sine}, 1000));
  EXPECT_FALSE(detail::LeaveOneOutError::supports({.nodes = 10}, 11));
  EXPECT_TRUE(detail::LeaveOneOutError::supports({.nodes = 10}, 12));
}

// A node that is one at a single sample and zero at all others fits that sample alone: its leverage is one, and what is
// left of it is a difference of nearly equal numbers. At twenty samples it is a node like any other.
TEST(LeaveOneOutError, SaysWhereASampleStandsAlone) {
  Layer at(400, 3, 0, Activation::sigmoid);
  Rng rng(2);
  for (Index i = 0; i < 400; ++i)
    for (Index o = 0; o < 3; ++o)
      at.targets(i, o) = std::tanh(at.features(i, 0)) + 0.5 * std::tanh(at.features(i, 1)) + 0.05 * rng.normal();
  at.theta(0) = at.theta(5 + 1) = 2;  // two nodes for the signal
  at.theta(10 + 3) = 60;              // and one for the last input, a step from 0 to 1
  at.theta(10 + 4) = -30;
  for (const Index alone : {1, 20}) {
    for (Index i = 0; i < 400; ++i) at.features(i, 3) = i < alone ? 1 : 0;
    const double said = detail::LeaveOneOutError(at.layer, at.features, at.targets)(at.theta);
    if (alone == 1) {
      EXPECT_EQ(said, -1);
    } else {
      EXPECT_NEAR(said / at.expected(), 1, 1e-8);
    }
  }
}

TEST(LeaveOneOutError, TheObjectiveIsRightWhateverTheWeights) {
  for (const double size : {0.0, 1e-6, 1e-3, 1.0, 1e3})
    for (const double noise : {0.0, 0.1}) {
      const Layer at(300, 12, size, Activation::sigmoid, noise);
      const RidgeElm elm{.hidden_nodes = 12, .input_map = InputMap::raw, .input_scaling = Scaling::none};
      VectorX fitness(1);
      elm.objective(Eigen::Matrix<double, Eigen::Dynamic, 4>(at.features), PointRows(at.targets))(at.theta, fitness);
      EXPECT_NEAR(fitness(0) / at.expected(), 1, 1e-6) << size << ' ' << noise;
    }
}

}  // namespace
}  // namespace vernier::leave_one_out_test
