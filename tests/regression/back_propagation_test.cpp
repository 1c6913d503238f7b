// SPDX-License-Identifier: BSD-3-Clause
// The classical network: gradient and curvature against differences, and what its two trainings reach.

#include "vernier/regression/back_propagation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/regression/detail/network_error.hpp"

namespace vernier::back_propagation_test {
namespace {

using detail::NetworkError;
using namespace vernier_test;

constexpr Activation activations[] = {Activation::sigmoid, Activation::tanh};

static_assert(Regressor<BackPropagation>);

double error(const Targets& predicted, const Targets& expected) {
  return (predicted - expected).norm() / centred(RealMatrix::of(expected)).norm();
}

VectorX random_vector(Index size, std::uint64_t seed) {
  Rng rng(seed);
  VectorX out(size);
  for (auto& value : out) value = rng.uniform(-1.5, 1.5);
  return out;
}

/// Targets without meaning.
RealMatrix random_targets(Index n, std::uint64_t seed) {
  const VectorX values = random_vector(2 * n, seed);
  RealMatrix out(n, 2);
  for (Index i = 0; i < 2 * n; ++i) out(i % n, i / n) = values(i);
  return out;
}

/// The network in naive loops: residuals of all samples and outputs, one output after the other.
RealMatrix residuals(const HiddenLayer& layer, const RealMatrix& x, const RealMatrix& t, const VectorX& theta) {
  const Index n = x.rows(), f = x.cols(), h = layer.nodes, m = t.cols();
  RealMatrix out(n * m, 1);
  for (Index i = 0; i < n; ++i)
    for (Index o = 0; o < m; ++o) {
      const Index outputs = h * (f + 1) + o * (h + 1);
      double y = theta(outputs + h);
      for (Index k = 0; k < h; ++k) {
        double z = theta(k * (f + 1) + f);
        for (Index j = 0; j < f; ++j) z += theta(k * (f + 1) + j) * x(i, j);
        y += theta(outputs + k) * (layer.activation == Activation::tanh ? std::tanh(z) : 1 / (1 + std::exp(-z)));
      }
      out(o * n + i) = y - t(i, o);
    }
  return out;
}

/// All weights but biases.
VectorX without_biases(const HiddenLayer& layer, Index f, VectorX theta) {
  for (Index k = 0; k < layer.nodes; ++k) theta(k * (f + 1) + f) = 0;
  for (Index c = layer.dimension(static_cast<int>(f)) + layer.nodes; c < theta.size(); c += layer.nodes + 1)
    theta(c) = 0;
  return theta;
}

TEST(NetworkError, IsTheWeightedMeanSquareAndTheDecayAndItsGradientEqualsDifferences) {
  const Index n = 300;
  const RealMatrix x = inputs(n, 1), t = random_targets(n, 2);
  const VectorX q = small_whole_weights(n, 3);
  for (const Activation activation : activations) {
    const HiddenLayer layer{.nodes = 5, .activation = activation};
    NetworkError problem(layer, x, t, q, 1e-2);
    ASSERT_EQ(problem.dimension(), 5 * 4 + 6 * 2);
    const VectorX theta = random_vector(32, 4);
    const RealMatrix r = residuals(layer, x, t, theta), squares = r.times(r);
    const double expected =
        (top(squares, n) + bottom(squares, n)).dot(q) / q.sum() + 1e-2 * without_biases(layer, 3, theta).squaredNorm();
    EXPECT_NEAR(problem.evaluate(theta), expected, 1e-13 * expected);
    const VectorX gradient = problem.gradient();
    for (Index i = 0; i < 32; ++i) {
      const auto at = [&](double steps) { return problem.evaluate(moved(theta, i, 1e-3 * steps)); };
      const double difference = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / 12e-3;
      EXPECT_NEAR(gradient(i), difference, 1e-9 * gradient.norm()) << "weight " << i;
    }
  }
}

// With batches of one size their mean gradient is the gradient, decay and weights included.
TEST(NetworkError, BatchesAddUpToTheGradient) {
  const RealMatrix x = inputs(60, 9), t = random_targets(60, 10);
  NetworkError problem({.nodes = 4}, x, t, small_whole_weights(60, 11), 1e-2);
  const VectorX theta = random_vector(problem.dimension(), 12);
  const double value = problem.evaluate(theta);
  const VectorX gradient = problem.gradient();
  const std::vector<Index> order = Rng(13).permutation(60);
  RealMatrix sum(theta.size(), 1);
  VectorX part;
  double values = 0;
  for (int b = 0; b < 4; ++b) {
    values += problem.batch(theta, {order.begin() + 15 * b, order.begin() + 15 * (b + 1)}, part) / 4;
    sum += RealMatrix(part) / 4;
  }
  EXPECT_NEAR(values, value, 1e-13 * value);
  EXPECT_LT((sum - gradient).norm(), 1e-13 * gradient.norm());
}

TEST(NetworkError, CurvatureIsTheJacobiansSquare) {
  for (const Index n : {30, 1100}) {
    const RealMatrix x = inputs(n, 14), t = random_targets(n, 15);
    const VectorX q = small_whole_weights(n, 16);
    for (const Activation activation : activations) {
      const HiddenLayer layer{.nodes = 7, .activation = activation};
      const VectorX theta = random_vector(7 * 4 + 8 * 2, 17);
      RealMatrix jacobian(2 * n, theta.size());
      for (Index i = 0; i < theta.size(); ++i)
        jacobian.set_block(
            0, i,
            (residuals(layer, x, t, moved(theta, i, 1e-5)) - residuals(layer, x, t, moved(theta, i, -1e-5))) / 2e-5);
      const RealMatrix weights = above(q, q) / q.sum();
      const RealMatrix decayed = without_biases(layer, 3, VectorX::Constant(theta.size(), 2e-2));
      const RealMatrix expected =
          2 * jacobian.transpose() * scaled_rows(weights, jacobian) + RealMatrix::diagonal(decayed);
      for (const auto set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
        if (set > widest_instruction_set()) continue;
        NetworkError problem(layer, x, t, q, 1e-2, set);
        problem.evaluate(random_vector(theta.size(), 18));
        MatrixX curvature, threaded;
        problem.curvature(curvature);  // of other weights: what it leaves behind must not matter
        problem.evaluate(theta);
        problem.curvature(curvature);
        EXPECT_LT(lower_triangle(curvature - expected).norm(), 1e-8 * expected.norm());
        const ThreadExecutor threads(3);
        problem.curvature(threaded, threads);
        EXPECT_EQ(RealMatrix(threaded), RealMatrix(curvature));
      }
    }
  }
}

TEST(BackPropagation, KeepsTheLaws) {
  const testing::RegressorLaws taken{.weights = testing::SampleWeights::taken};
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      BackPropagation recipe{.hidden_nodes = 6, .activation = activation, .input_map = input_map};
      recipe.training = LevenbergMarquardt{.epochs = 8};
      expect_laws(recipe, taken);
      recipe.training = Adam{.epochs = 5, .batch = 16};
      expect_laws(recipe, taken);
    }
  expect_laws(
      BackPropagation{
          .hidden_nodes = 6, .training = LevenbergMarquardt{.epochs = 8}, .validation_share = 0.3, .patience = 3},
      taken);
}

/// What the observer is told, against the predictor that comes out.
TEST(BackPropagation, TheObserverSeesEveryEpochAndTheObjectiveIsThePredictors) {
  const Inputs x = inputs(200, 20);
  const Targets y = targets(x);
  const VectorX q = small_whole_weights(200, 21);
  const RealMatrix values = RealMatrix::of(y), mean = RealMatrix(q).transpose() * values / q.sum();
  const auto square = [&](const RealMatrix& r) { return scaled_rows(RealMatrix(q).sqrt(), r).squared_norm(); };
  const double spread = square(plus_row(values, -mean));
  for (const bool adam : {false, true}) {
    BackPropagation recipe{.hidden_nodes = 8, .weight_decay = 1e-4};
    if (adam) {
      recipe.training = Adam{.epochs = 60, .batch = 20};
    } else {
      recipe.training = LevenbergMarquardt{.epochs = 30, .tolerance = 0};
    }
    std::vector<Progress> seen;
    const auto observer = [&](const Progress& progress) { seen.push_back(progress); };
    const auto predictor = recipe.fit(x, y, {.seed = 5, .observer = observer, .weights = &q});
    ASSERT_EQ(seen.size(), adam ? 61u : 31u);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      EXPECT_EQ(seen[i].generation, static_cast<Index>(i));
      EXPECT_LE(seen[i].best, seen[std::max<std::size_t>(i, 1) - 1].best);
    }
    EXPECT_LT(seen.back().best, (adam ? 0.6 : 0.1) * seen.front().best);
    double decay = predictor.beta().squaredNorm() / (spread / q.sum());
    for (Index i = 0; i < 56; ++i)
      if (i % 7 < 6) decay += predictor.theta()(i) * predictor.theta()(i);
    EXPECT_NEAR(seen.back().best, square(RealMatrix::of(predictor.predict(x)) - values) / spread + 1e-4 * decay,
                1e-9 * seen.back().best);
  }
}

/// The outputs of a network of four nodes.
Targets planted(const Inputs& x, Activation activation) {
  const HiddenLayer layer{.nodes = 4, .activation = activation, .weight_limit = 1.5};
  const RealMatrix h = vernier_test::hidden_outputs(layer, x, layer.draw(3, 77));
  return as_targets(h * RealMatrix(4, 2, {1, -2, 3, 1, -2, 2, 1, 1}));
}

/// The smallest network, `v tanh(w x + b) + c`, trained by Adam as the paper has it: moments of gradient and square,
/// both divided by their bias, and a rate that falls as half a cosine over all steps.
struct SmallestNetwork {
  static constexpr double decay = 0.01;
  VectorX x, t;  // targets in units of their spread

  /// F of some samples, and its gradient by w, b, v, c.
  double error(const VectorX& theta, const std::vector<Index>& rows, VectorX& gradient) const {
    gradient = VectorX::Zero(4);
    for (const Index k : {0, 2}) gradient(k) = 2 * decay * theta(k);
    double value = decay * (theta(0) * theta(0) + theta(2) * theta(2));
    for (const Index i : rows) {
      const double h = std::tanh(theta(0) * x(i) + theta(1)), left = theta(2) * h + theta(3) - t(i),
                   share = 2 * left / static_cast<double>(rows.size()), back = share * theta(2) * (1 - h * h);
      value += left * left / static_cast<double>(rows.size());
      const double parts[] = {back * x(i), back, share * h, share};
      for (Index k = 0; k < 4; ++k) gradient(k) += parts[k];
    }
    return value;
  }

  /// The best weights after some epochs of batches, and the error before and after each.
  VectorX trained(VectorX theta, const Adam& adam, const std::vector<std::vector<std::vector<Index>>>& epochs,
                  std::vector<double>& errors) const {
    const std::vector<Index> all{0, 1, 2, 3};
    VectorX gradient, mean = VectorX::Zero(4), square = VectorX::Zero(4), best = theta;
    errors = {error(theta, all, gradient)};
    double steps = 0, step = 0;
    for (const auto& batches : epochs) steps += static_cast<double>(batches.size());
    for (const auto& batches : epochs) {
      for (const std::vector<Index>& rows : batches) {
        error(theta, rows, gradient);
        const double rate = adam.learning_rate * (1 + std::cos(std::numbers::pi * step / steps)) / 2;
        step += 1;
        for (Index k = 0; k < 4; ++k) {
          mean(k) = adam.momentum * mean(k) + (1 - adam.momentum) * gradient(k);
          square(k) = adam.memory * square(k) + (1 - adam.memory) * gradient(k) * gradient(k);
          theta(k) -= rate * mean(k) / (1 - std::pow(adam.momentum, step)) /
                      (std::sqrt(square(k) / (1 - std::pow(adam.memory, step))) + 1e-8);
        }
      }
      errors.push_back(error(theta, all, gradient));
      if (errors.back() < *std::min_element(errors.begin(), errors.end() - 1)) best = theta;
    }
    return best;
  }
};

/// The four samples of the smallest network, and what a fit makes of its weights.
class BackPropagationByHand : public ::testing::Test {
 protected:
  BackPropagationByHand() : x_(4), y_(4) {
    for (Index i = 0; i < 4; ++i) {
      x_(i) = i == 0 ? -1.2 : 0.7 * static_cast<double>(i) - 1;
      y_(i) = 3 + 0.5 * x_(i) * x_(i) - x_(i);
    }
    mean_ = y_.mean();
    double sum = 0;
    for (const double value : y_) sum += (value - mean_) * (value - mean_);
    spread_ = std::sqrt(sum / 4);
    network_.x = network_.t = x_;
    for (Index i = 0; i < 4; ++i) network_.t(i) = (y_(i) - mean_) / spread_;
  }

  VectorX fitted(const Adam& adam, std::uint64_t seed, std::vector<double>* seen = nullptr) const {
    const BackPropagation recipe{.hidden_nodes = 1,
                                 .activation = Activation::tanh,
                                 .input_map = InputMap::raw,
                                 .input_scaling = Scaling::none,
                                 .weight_decay = SmallestNetwork::decay,
                                 .training = adam};
    const auto observer = [&](const Progress& progress) {
      if (seen != nullptr) seen->push_back(progress.best);
    };
    const auto network = recipe.fit(x_, y_, {.seed = seed, .observer = observer});
    const Eigen::Matrix<double, 1, 1> none(0.0);
    const double at_zero = network.predict(none)(0), v = network.beta()(0, 0);
    return vernier_test::vector({network.theta()(0), network.theta()(1), v / spread_,
                                 (at_zero - v * std::tanh(network.theta()(1)) - mean_) / spread_});
  }

  VectorX x_, y_;
  double mean_ = 0, spread_ = 0;
  SmallestNetwork network_;
};

TEST_F(BackPropagationByHand, AdamOnAllSamplesAtOnce) {
  const Adam none{.epochs = 0}, adam{.epochs = 6, .batch = 9, .learning_rate = 0.05, .momentum = 0.5, .memory = 0.9};
  for (const std::uint64_t seed : {1u, 2u}) {
    std::vector<double> seen, expected;
    const VectorX start = fitted(none, seed), found = fitted(adam, seed, &seen);
    const std::vector<std::vector<Index>> one_batch{{0, 1, 2, 3}};
    const VectorX best = network_.trained(start, adam, std::vector(6, one_batch), expected);
    EXPECT_LT((found - best).norm(), 1e-9);
    EXPECT_GT((found - start).norm(), 0.1);
    ASSERT_EQ(seen.size(), 7u);
    double least = expected[0];
    for (std::size_t k = 0; k < 7; ++k) {
      least = std::min(least, expected[k]);
      EXPECT_NEAR(seen[k], least, 1e-12);
    }
  }
}

// Two batches of two samples: each epoch is one of six orders, drawn from the seed, and anew.
TEST_F(BackPropagationByHand, AdamDrawsItsBatchesAnew) {
  const std::vector<std::vector<std::vector<Index>>> orders{{{0, 1}, {2, 3}}, {{0, 2}, {1, 3}}, {{0, 3}, {1, 2}},
                                                            {{1, 2}, {0, 3}}, {{1, 3}, {0, 2}}, {{2, 3}, {0, 1}}};
  const Adam none{.epochs = 0}, adam{.epochs = 2, .batch = 2, .learning_rate = 0.01, .momentum = 0.5, .memory = 0.9};
  std::set<std::size_t> first;
  bool anew = false;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const VectorX start = fitted(none, seed), found = fitted(adam, seed);
    std::vector<std::pair<std::size_t, std::size_t>> same;
    std::vector<double> errors;
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = 0; b < 6; ++b)
        if ((network_.trained(start, adam, {orders[a], orders[b]}, errors) - found).norm() < 1e-10)
          same.emplace_back(a, b);
    ASSERT_FALSE(same.empty()) << seed;
    if (same.size() > 1) continue;
    first.insert(same[0].first);
    anew = anew || same[0].first != same[0].second;
  }
  EXPECT_GE(first.size(), 3u);
  EXPECT_TRUE(anew);
}

// Output weights start in [-1, 1] over the number of nodes, in units of the spread.
TEST(BackPropagation, StartsWithSmallOutputWeights) {
  const Inputs x = inputs(30, 36);
  const Targets y = targets(x);
  const BackPropagation recipe{.hidden_nodes = 100, .training = Adam{.epochs = 0}};
  const double spread = centred(RealMatrix::of(y)).norm() / std::sqrt(30.0);
  const RealMatrix beta = RealMatrix::of(recipe.fit(x, y, {.seed = 1}).beta());
  EXPECT_LE(beta.largest(), spread / 100);
  EXPECT_GT(beta.largest(), 0.9 * spread / 100);
  EXPECT_NEAR(beta.norm(), spread / 100 * std::sqrt(200.0 / 3), 0.1 * beta.norm());  // uniform: variance 1/3
}

// Training ends where ten steps that lowered the objective lowered it by less than the tolerance together.
TEST(BackPropagation, TenStepsThatHardlyHelpEndIt) {
  const Inputs x = inputs(150, 38);
  const Targets y = targets(x, 2e-4);
  for (const double tolerance : {0.02, 0.2}) {
    std::vector<double> lowered;
    const auto observer = [&](const Progress& progress) {
      if (lowered.empty() || progress.best < lowered.back()) lowered.push_back(progress.best);
    };
    const BackPropagation recipe{.hidden_nodes = 6,
                                 .training = LevenbergMarquardt{.epochs = 2000, .tolerance = tolerance}};
    static_cast<void>(recipe.fit(x, y, {.seed = 1, .observer = observer}));
    const std::size_t steps = lowered.size() - 1;
    EXPECT_EQ(steps % 10, 0u);
    for (std::size_t k = 10; k <= steps; k += 10)
      EXPECT_EQ(lowered[k - 10] - lowered[k] < tolerance * lowered[k], k == steps) << k;
  }
}

// Patience counts epochs after the best one: training that ends there gives the same network, one epoch earlier
// another.
TEST(BackPropagation, PatienceCountsFromTheBestEpoch) {
  const Inputs x = inputs(60, 39);
  const Targets y = targets(x, 4e-4);
  BackPropagation recipe{.hidden_nodes = 12, .validation_share = 0.5, .patience = 5};
  const auto trained = [&](int epochs, Index& last) {
    recipe.training = LevenbergMarquardt{.epochs = epochs, .tolerance = 0};
    const auto observer = [&](const Progress& progress) { last = progress.generation; };
    return RealMatrix(recipe.fit(x, y, {.seed = 1, .observer = observer}).theta());
  };
  Index last = 0, unused = 0;
  const RealMatrix found = trained(500, last);
  ASSERT_LT(last, 500);
  ASSERT_GT(last, 5);
  EXPECT_EQ(trained(static_cast<int>(last) - 5, unused), found);
  EXPECT_FALSE(trained(static_cast<int>(last) - 6, unused) == found);
}

TEST(BackPropagation, RecoversAPlantedNetwork) {
  const Inputs x = inputs(400, 22), fresh = inputs(200, 23);
  for (const Activation activation : activations) {
    const BackPropagation recipe{.hidden_nodes = 4,
                                 .activation = activation,
                                 .input_map = InputMap::raw,
                                 .weight_decay = 0,
                                 .training = LevenbergMarquardt{.epochs = 500, .tolerance = 0}};
    const Targets y = planted(x, activation), expected = planted(fresh, activation);
    double least = 1;
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
      least = std::min(least, error(recipe.fit(x, y, {.seed = seed}).predict(fresh), expected));
    EXPECT_LT(least, 1e-6) << static_cast<int>(activation);
  }
}

// Noisy samples and many nodes: what is judged by other samples stops in time.
TEST(BackPropagation, StopsEarly) {
  const Inputs x = inputs(200, 26), fresh = inputs(300, 27);
  const Targets expected = targets(fresh);
  Targets y = targets(x);
  Rng rng(28);
  for (double& value : elements(y)) value += 6e-4 * rng.normal();
  for (const bool adam : {false, true}) {
    BackPropagation recipe{.hidden_nodes = 30, .weight_decay = 0, .patience = adam ? 100 : 10};
    if (adam) recipe.training = Adam{.epochs = 1000, .batch = 20};
    double followed = 0, stopped = 0;
    for (const std::uint64_t seed : {1u, 2u}) {
      recipe.validation_share = 0;
      followed += error(recipe.fit(x, y, {.seed = seed}).predict(fresh), expected);
      recipe.validation_share = 0.25;
      Index epochs = 0;
      const auto count = [&](const Progress& progress) { epochs = progress.generation; };
      stopped += error(recipe.fit(x, y, {.seed = seed, .observer = count}).predict(fresh), expected);
      EXPECT_GE(epochs, recipe.patience);
      EXPECT_LT(epochs, adam ? 500 : 60);
    }
    EXPECT_LT(stopped, 0.8 * followed);
  }
}

// Decay that only shrinks the weights lowers the training objective, but not the validation error, which decides.
TEST(BackPropagation, ValidationCountsErrorsAlone) {
  const Inputs x = inputs(40, 41);
  const Targets y = targets(x);
  BackPropagation recipe{.hidden_nodes = 4, .weight_decay = 0.9, .validation_share = 0.5};
  int kept = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    recipe.training = LevenbergMarquardt{.epochs = 0};
    const RealMatrix start(recipe.fit(x, y, {.seed = seed}).theta());
    recipe.training = LevenbergMarquardt{.epochs = 1};
    kept += start == RealMatrix(recipe.fit(x, y, {.seed = seed}).theta());
  }
  EXPECT_GE(kept, 3);
  EXPECT_LE(kept, 27);
}

TEST(BackPropagation, AnObserverStopsIt) {
  const Inputs x = inputs(100, 32);
  const Targets y = targets(x);
  for (const bool adam : {false, true}) {
    BackPropagation recipe{.hidden_nodes = 5};
    if (adam) recipe.training = Adam{.batch = 10};
    Index calls = 0;
    const auto observer = [&](const Progress&) { return ++calls < 4; };
    static_cast<void>(recipe.fit(x, y, {.seed = 1, .observer = observer}));
    EXPECT_EQ(calls, 4);
  }
}

TEST(BackPropagation, SmallestProblems) {
  const Inputs one = inputs(1, 33), some = inputs(20, 34);
  const Targets y = targets(one), level = Targets::Constant(20, 2, 7);
  for (const bool adam : {false, true}) {
    BackPropagation recipe{.hidden_nodes = 3, .validation_share = 0.5};
    if (adam) recipe.training = Adam{.epochs = 500};
    EXPECT_LT((recipe.fit(one, y).predict(one) - y).norm(), 0.1);
    EXPECT_LT((recipe.fit(some, level).predict(some) - level).norm(), 0.1);
  }
}

}  // namespace
}  // namespace vernier::back_propagation_test
