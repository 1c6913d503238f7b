// The classical network: gradient and curvature against differences, and what its two trainings reach.

#include "vernier/regression/back_propagation.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "laws.hpp"
#include "regression_samples.hpp"
#include "vernier/regression/detail/network_error.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/testing/regressor_laws.hpp"

namespace vernier::back_propagation_test {
namespace {

using detail::NetworkError;
using testing::regressor_violations;
using vernier_test::complaint;
using vernier_test::no_violations;

constexpr Activation activations[] = {Activation::sigmoid, Activation::tanh};
using vernier_test::input_maps;

static_assert(Regressor<BackPropagation>);

using vernier_test::above;
using vernier_test::as_targets;
using vernier_test::elements;
using vernier_test::Inputs;
using vernier_test::inputs;
using vernier_test::lower_triangle;
using vernier_test::moved;
using vernier_test::RealMatrix;
using vernier_test::samples_of;
using vernier_test::scaled_rows;
using vernier_test::small_whole_weights;
using vernier_test::Targets;
using vernier_test::targets;

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

TEST(NetworkError, IsTheWeightedMeanSquareAndTheDecay) {
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
  }
}

TEST(NetworkError, GradientEqualsDifferences) {
  const Index n = 300;
  const RealMatrix x = inputs(n, 5), t = random_targets(n, 6);
  for (const Activation activation : activations) {
    NetworkError problem({.nodes = 5, .activation = activation}, x, t, small_whole_weights(n, 7), 1e-2);
    const VectorX theta = random_vector(32, 8);
    problem.evaluate(theta);
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
      EXPECT_TRUE(no_violations(regressor_violations(recipe, taken)));
      recipe.training = Adam{.epochs = 5, .batch = 16};
      EXPECT_TRUE(no_violations(regressor_violations(recipe, taken)));
    }
  EXPECT_TRUE(no_violations(regressor_violations(
      BackPropagation{
          .hidden_nodes = 6, .training = LevenbergMarquardt{.epochs = 8}, .validation_share = 0.3, .patience = 3},
      taken)));
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

TEST(BackPropagation, TrainingBeatsDrawing) {
  const Inputs x = inputs(500, 24), fresh = inputs(300, 25);
  const Targets y = targets(x), expected = targets(fresh);
  const double drawn = error(Elm{.hidden_nodes = 15}.fit(x, y, {.seed = 1}).predict(fresh), expected);
  BackPropagation recipe{.hidden_nodes = 15, .input_map = InputMap::raw};
  EXPECT_LT(error(recipe.fit(x, y, {.seed = 1}).predict(fresh), expected), 0.1 * drawn);
  recipe.training = Adam{.epochs = 300, .batch = 20};
  EXPECT_LT(error(recipe.fit(x, y, {.seed = 1}).predict(fresh), expected), 0.5 * drawn);
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

TEST(BackPropagation, AWeightIsSoManySamples) {
  const Index n = 40;
  const Inputs x = inputs(n, 29), fresh = inputs(20, 30);
  const Targets y = targets(x);
  const VectorX q = small_whole_weights(n, 31);
  std::vector<Index> rows;
  for (Index i = 0; i < n; ++i) rows.insert(rows.end(), static_cast<std::size_t>(q(i)), i);
  const Inputs repeated_x = samples_of(x, rows);
  const Targets repeated_y = samples_of(y, rows);
  BackPropagation recipe{.hidden_nodes = 5, .training = LevenbergMarquardt{.epochs = 5}};
  for (const bool adam : {false, true}) {
    if (adam) recipe.training = Adam{.epochs = 10, .batch = 1000};  // all samples at once
    const auto weighted = recipe.fit(x, y, {.seed = 1, .weights = &q}).predict(fresh);
    EXPECT_LT(error(recipe.fit(repeated_x, repeated_y, {.seed = 1}).predict(fresh), weighted), 1e-9);
    EXPECT_GT(error(recipe.fit(x, y, {.seed = 1}).predict(fresh), weighted), 1e-4);
  }
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

TEST(BackPropagation, RefusesMisuseWithTheNumbers) {
  const Inputs x = inputs(10, 35);
  const Targets y = targets(x);
  const auto says = [&](const BackPropagation& recipe) {
    return complaint([&] { static_cast<void>(recipe.fit(x, y)); });
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(has(says({.hidden_nodes = 0}), "hidden_nodes is 0"));
  EXPECT_TRUE(has(says({.activation = Activation::sine}), "must be sigmoid or tanh"));
  EXPECT_TRUE(has(says({.activation = Activation::radial_basis}), "must be sigmoid or tanh"));
  EXPECT_TRUE(has(says({.weight_decay = -1}), "weight_decay is -1"));
  EXPECT_TRUE(has(says({.validation_share = 1}), "validation_share is 1"));
  EXPECT_TRUE(has(says({.patience = 0}), "patience is 0"));
  EXPECT_TRUE(has(says({.training = LevenbergMarquardt{.epochs = -1}}), "epochs is -1"));
  EXPECT_TRUE(has(says({.training = LevenbergMarquardt{.tolerance = 1}}), "tolerance is 1"));
  EXPECT_TRUE(has(says({.training = Adam{.epochs = -2}}), "epochs is -2"));
  EXPECT_TRUE(has(says({.training = Adam{.batch = 0}}), "batch is 0"));
  EXPECT_TRUE(has(says({.training = Adam{.learning_rate = 0}}), "learning_rate is 0"));
  EXPECT_TRUE(has(says({.training = Adam{.momentum = 1}}), "momentum is 1"));
  EXPECT_TRUE(has(says({.training = Adam{.memory = -0.5}}), "memory is -0.5"));
  const VectorX nine = VectorX::Ones(9), zero = VectorX::Zero(10);
  EXPECT_TRUE(has(complaint([&] { static_cast<void>(BackPropagation{}.fit(x, y, {.weights = &nine})); }),
                  "9 weights for 10 samples"));
  EXPECT_TRUE(has(complaint([&] { static_cast<void>(BackPropagation{}.fit(x, y, {.weights = &zero})); }),
                  "weights go down to 0"));
}

}  // namespace
}  // namespace vernier::back_propagation_test
