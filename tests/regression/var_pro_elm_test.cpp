// SPDX-License-Identifier: BSD-3-Clause
// The trained hidden layer: value, gradient and curvature against brute force, and what training brings.

#include "vernier/regression/var_pro_elm.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "complaint.hpp"
#include "regression_samples.hpp"
#include "vernier/regression/detail/common_scaling.hpp"
#include "vernier/regression/detail/variable_projection.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/least_squares.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"

namespace vernier::var_pro_elm_test {
namespace {

using namespace vernier_test;

double error(const RealMatrix& predicted, const RealMatrix& expected) {
  return (predicted - expected).norm() / centred(expected).norm();
}
double error(const Targets& predicted, const Targets& expected) {
  return error(RealMatrix::of(predicted), RealMatrix::of(expected));
}

/// The same weights for each of some nodes.
VectorX repeated(const VectorX& weights_of_a_node, Index nodes) {
  VectorX theta(nodes * weights_of_a_node.size());
  for (Index i = 0; i < theta.size(); ++i) theta(i) = weights_of_a_node(i % weights_of_a_node.size());
  return theta;
}

/// Features and targets as the objective sees them, from the words of the documentation.
struct Scaled {
  RealMatrix features, t;
  Scaled(const VarProElm& recipe, const Inputs& x, const Targets& y)
      : features(recipe.layer().map(x)), t(centred(RealMatrix::of(y))) {
    features = recipe.layer().scaling(features).apply(features);
    t = t / std::sqrt(t.squared_norm() / static_cast<double>(t.rows()));
  }
};

/// The stacked least-squares problem: [H 1; sqrt(n ridge) I 0].
RealMatrix stacked(const VarProElm& recipe, const RealMatrix& features, const VectorX& theta) {
  const RealMatrix h = hidden_outputs(recipe.layer(), features, theta);
  const double root = std::sqrt(static_cast<double>(h.rows()) * recipe.ridge);
  return above(with_ones(h), beside(root * RealMatrix::identity(h.cols()), zeros(h.cols(), 1)));
}

RealMatrix padded(const RealMatrix& t, Index rows) { return above(t, zeros(rows - t.rows(), t.cols())); }

double value(const VarProElm& recipe, const Inputs& x, const Targets& y, const VectorX& theta,
             const VectorX* weights = nullptr) {
  VectorX fitness(1);
  recipe.objective(x, y, weights)(theta, fitness);
  return fitness(0);
}

TEST(VarProObjective, IsTheLeastOverTheOutputWeights) {
  const Inputs x = inputs(50, 1);
  const Targets y = targets(x);
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps)
      for (const double ridge : {1e-2, 1e-6, 1e-10, 1e-13}) {
        const VarProElm recipe{
            .hidden_nodes = 9, .activation = activation, .input_map = input_map, .weight_limit = 2, .ridge = ridge};
        const Scaled scaled(recipe, x, y);
        const VectorX theta = recipe.layer().draw(3, 2);
        const RealMatrix a = stacked(recipe, scaled.features, theta), b = padded(scaled.t, a.rows());
        const RealMatrix solution = a.solve(b);
        const double expected = (a * solution - b).squared_norm() / 50;
        EXPECT_NEAR(value(recipe, x, y, theta), expected, 1e-6 * expected);
        detail::VariableProjection projection(recipe.layer(), scaled.features, scaled.t, ridge);
        EXPECT_NEAR(projection.evaluate(theta), expected, 1e-9 * expected);
        EXPECT_LT((projection.beta() - top(solution, 9)).norm(), 1e-5 * solution.norm());
        EXPECT_LT((projection.offset() - solution.row(9).transpose()).norm(), 1e-5 * solution.norm());
      }
}

// The mean alone has an error of 1 in units of the spread, even where the spread is a ten-millionth of the mean.
TEST(VarProObjective, ASmallSignalOnALargeOffset) {
  const Inputs x = inputs(50, 40);
  Targets y = targets(x);
  for (double& value : elements(y)) value = 1 + 1e-4 * value;
  const VarProElm recipe{.hidden_nodes = 2};
  EXPECT_NEAR(value(recipe, x, y, VectorX::Zero(recipe.dimension(3))), 1, 1e-5);
}

TEST(VarProObjective, GradientEqualsDifferences) {
  const Inputs x = inputs(40, 3);
  const Targets y = targets(x);
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      const VarProElm recipe{
          .hidden_nodes = 6, .activation = activation, .input_map = input_map, .weight_limit = 2, .ridge = 1e-6};
      const VectorX theta = recipe.layer().draw(3, 4);
      const Scaled scaled(recipe, x, y);
      detail::VariableProjection projection(recipe.layer(), scaled.features, scaled.t, recipe.ridge);
      const VectorX gradient = recipe.objective(x, y).gradient(theta);
      ASSERT_EQ(gradient.size(), theta.size());
      EXPECT_GT(gradient.norm(), 1e-4);
      const double largest = RealMatrix(gradient).largest();
      for (Index i = 0; i < theta.size(); ++i) {
        const auto at = [&](double steps) { return projection.evaluate(moved(theta, i, 1e-3 * steps)); };
        const double difference = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / 12e-3;
        EXPECT_NEAR(gradient(i), difference, 1e-7 * largest)
            << "weight " << i << ", activation " << static_cast<int>(activation);
      }
    }
}

/// Kaufman's matrix from a dense Jacobian: derivatives of H by differences, times beta, less what the columns of the
/// stacked problem take over.
RealMatrix dense_curvature(const VarProElm& recipe, const Scaled& scaled, const VectorX& theta) {
  const RealMatrix a = stacked(recipe, scaled.features, theta);
  const RealMatrix beta = top(a.solve(padded(scaled.t, a.rows())), recipe.hidden_nodes);
  const Index n = scaled.t.rows();
  const auto outputs = [&](Index weight, double step) {
    return hidden_outputs(recipe.layer(), scaled.features, moved(theta, weight, step));
  };
  RealMatrix out(theta.size(), theta.size());
  for (Index o = 0; o < scaled.t.cols(); ++o) {
    RealMatrix jacobian(a.rows(), theta.size());
    for (Index i = 0; i < theta.size(); ++i)
      jacobian.set_block(0, i, (outputs(i, 1e-5) - outputs(i, -1e-5)) * beta.col(o) / 2e-5);
    jacobian -= a * a.solve(jacobian);
    out += 2 / static_cast<double>(n) * jacobian.transpose() * jacobian;
  }
  return out;
}

TEST(VarProObjective, CurvatureEqualsTheDenseOne) {
  for (const Index n : {30, 300, 1100}) {
    const Inputs x = inputs(n, 5);
    const Targets y = targets(x);
    for (const Activation activation : activations)
      for (const InputMap input_map : input_maps) {
        const VarProElm recipe{
            .hidden_nodes = 7, .activation = activation, .input_map = input_map, .weight_limit = 2, .ridge = 1e-5};
        const VectorX theta = recipe.layer().draw(3, 6);
        const Scaled scaled(recipe, x, y);
        const RealMatrix expected = dense_curvature(recipe, scaled, theta);
        for (const auto set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
          if (set > widest_instruction_set()) continue;
          detail::VariableProjection projection(recipe.layer(), scaled.features, scaled.t, recipe.ridge, nullptr, set);
          projection.evaluate(theta);
          MatrixX curvature, threaded;
          projection.curvature(curvature);
          EXPECT_LT(lower_triangle(curvature - expected).norm(), 1e-7 * expected.norm())
              << n << " samples, activation " << static_cast<int>(activation);
          const ThreadExecutor threads(3);
          projection.curvature(threaded, threads);
          EXPECT_EQ(lower_triangle(threaded), lower_triangle(curvature));
        }
      }
  }
}

// A sample of weight k is k samples: value, gradient and curvature, also where the products cannot be factorised.
TEST(VarProObjective, WeightsAreRepeatedSamples) {
  const Inputs x = inputs(70, 5);
  const Targets y = targets(x);
  for (const Activation activation : activations)
    for (const bool equal_nodes : {false, true}) {
      const VarProElm recipe{
          .hidden_nodes = 6, .activation = activation, .weight_limit = 2, .ridge = equal_nodes ? 1e-14 : 1e-5};
      VectorX theta = recipe.layer().draw(3, 6);
      const Index node = theta.size() / 6;
      if (equal_nodes)
        for (Index i = node; i < theta.size(); ++i) theta(i) = theta(i - node);
      const Scaled scaled(recipe, x, y);
      VectorX weights(70);
      for (Index i = 0; i < 70; ++i) weights(i) = static_cast<double>(1 + i % 3);
      std::vector<Index> rows;
      for (Index i = 0; i < 70; ++i) rows.insert(rows.end(), static_cast<std::size_t>(weights(i)), i);
      const RealMatrix features = rows_of(scaled.features, rows), t = rows_of(scaled.t, rows);

      detail::VariableProjection weighted(recipe.layer(), scaled.features, scaled.t, recipe.ridge, &weights),
          repeated(recipe.layer(), features, t, recipe.ridge);
      EXPECT_NEAR(weighted.evaluate(theta) / repeated.evaluate(theta), 1, 1e-10);
      // as a search sees it
      EXPECT_NEAR(value(recipe, x, y, theta, &weights) / value(recipe, samples_of(x, rows), samples_of(y, rows), theta),
                  1, 1e-8);
      if (equal_nodes) continue;  // which of them is used for what is a matter of rounding
      EXPECT_LT((weighted.beta() - repeated.beta()).norm(), 1e-8 * repeated.beta().norm());
      EXPECT_LT((weighted.offset() - repeated.offset()).norm(), 1e-8 * repeated.offset().norm());
      const VectorX gradient = repeated.gradient();
      EXPECT_LT((weighted.gradient() - gradient).norm(), 1e-9 * gradient.norm());
      MatrixX a, b;
      weighted.curvature(a);
      repeated.curvature(b);
      EXPECT_LT((lower_triangle(a) - lower_triangle(b)).norm(), 1e-9 * lower_triangle(b).norm());
    }
}

TEST(VarProObjective, EqualNodes) {
  const Inputs x = inputs(60, 7);
  const Targets y = targets(x);
  const VarProElm recipe{.hidden_nodes = 8, .input_map = InputMap::raw, .ridge = 1e-17};
  const VarProElm one{.hidden_nodes = 1, .input_map = InputMap::raw, .ridge = 1e-17};
  const VectorX node = one.layer().draw(3, 8), theta = repeated(node, 8);
  EXPECT_NEAR(value(recipe, x, y, theta), value(one, x, y, node), 1e-6);
  EXPECT_TRUE(recipe.objective(x, y).gradient(theta).allFinite());
}

TEST(VarProElm, WithoutIterationsIsARidgeAtTheDrawnWeights) {
  const Inputs x = inputs(50, 9), fresh = inputs(20, 10);
  const Targets y = targets(x);
  const VarProElm recipe{.hidden_nodes = 9, .ridge = 1e-5, .iterations = 0};
  const auto predictor = recipe.fit(x, y, {.seed = 3});
  const VectorX theta = recipe.layer().draw(3, 3);
  EXPECT_EQ(predictor.theta(), theta);
  const RealMatrix h = hidden_outputs(recipe.layer(), recipe.layer().map(x), theta);
  const RealMatrix at = hidden_outputs(recipe.layer(), recipe.layer().map(fresh), theta);
  const RidgePath path(h, y);
  const MatrixX beta = path.beta(50 * 1e-5);
  const RealMatrix offset = path.offset(beta);
  EXPECT_LT(error(RealMatrix::of(predictor.predict(fresh)), plus_row(at * beta, offset.transpose())), 1e-8);
}

TEST(VarProElm, TheObjectiveNeverRisesAndIsTheOneOfThePredictor) {
  const Inputs x = inputs(300, 11);
  const Targets y = targets(x);
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      const VarProElm recipe{.hidden_nodes = 8, .activation = activation, .input_map = input_map, .iterations = 30};
      std::vector<Progress> seen;
      const auto observer = [&](const Progress& progress) { seen.push_back(progress); };
      const auto predictor = recipe.fit(x, y, {.seed = 5, .observer = observer});
      ASSERT_GE(seen.size(), 11u);
      for (std::size_t i = 0; i < seen.size(); ++i) {
        EXPECT_EQ(seen[i].generation, static_cast<Index>(i));
        EXPECT_LE(seen[i].best, seen[std::max<std::size_t>(i, 1) - 1].best);
      }
      EXPECT_NEAR(seen.front().best, value(recipe, x, y, recipe.layer().draw(3, 5)), 1e-6 * seen.front().best);
      EXPECT_LT(seen.back().best, 0.5 * seen.front().best) << static_cast<int>(activation);
      EXPECT_NEAR(seen.back().best, value(recipe, x, y, predictor.theta()), 1e-6 * seen.back().best);
      const double spread = centred(RealMatrix::of(y)).squared_norm();
      const double penalty = recipe.ridge * 300 * predictor.beta().squaredNorm() / spread;
      EXPECT_NEAR(seen.back().best, (predictor.predict(x) - y).squaredNorm() / spread + penalty,
                  1e-6 * seen.back().best);
    }
}

/// The hidden weights of a network whose outputs a fit with as many nodes can meet perfectly.
VectorX planted_weights(Activation activation) {
  VectorX theta = HiddenLayer{.nodes = 4, .weight_limit = 1.5}.draw(3, 77);
  if (activation == Activation::radial_basis)  // widths that show within the samples
    for (Index k = 0; const double width : {0.6, 0.7, 0.8, 0.9}) theta(4 * k++ + 3) = width;
  return theta;
}

Targets planted(const Inputs& x, Activation activation) {
  const RealMatrix h = hidden_outputs({.nodes = 4, .activation = activation}, x, planted_weights(activation));
  return as_targets(h * RealMatrix(4, 2, {1, -2, 3, 1, -2, 2, 1, 1}));
}

TEST(VarProElm, RecoversAPlantedNetwork) {
  const Inputs x = inputs(400, 13), fresh = inputs(200, 14);
  Rng rng(12);
  for (const Activation activation : activations) {
    const VarProElm recipe{.hidden_nodes = 4,
                           .activation = activation,
                           .input_map = InputMap::raw,
                           .input_scaling = Scaling::none,
                           .ridge = 1e-16,
                           .iterations = 200,
                           .tolerance = 0,
                           .starts = 10};
    const Targets y = planted(x, activation), expected = planted(fresh, activation);
    const VectorX weights = planted_weights(activation);
    VectorX near = weights;
    for (auto& weight : near) weight += rng.uniform(-0.2, 0.2);
    const auto found = recipe.fit_at(x, y, near);
    EXPECT_LT(error(found.predict(fresh), expected), 1e-7) << static_cast<int>(activation);
    EXPECT_LT((found.theta() - weights).norm(), 1e-5 * weights.norm()) << static_cast<int>(activation);
    if (activation == Activation::radial_basis) continue;  // from afar it ends in other minima
    EXPECT_LT(error(recipe.fit(x, y, {.seed = 1}).predict(fresh), expected), 1e-7) << static_cast<int>(activation);
    EXPECT_GT(error(Elm{.hidden_nodes = 4, .activation = activation}.fit(x, y, {.seed = 1}).predict(fresh), expected),
              1e-2);
  }
}

TEST(VarProElm, TheBestOfSeveralStartsIsKept) {
  const Inputs x = inputs(150, 21);
  const Targets y = targets(x);
  VarProElm recipe{.hidden_nodes = 4, .iterations = 15};
  const auto trained = [&](const VectorX& theta) { return value(recipe, x, y, recipe.fit_at(x, y, theta).theta()); };
  double least = std::numeric_limits<double>::infinity();
  for (std::uint64_t start = 0; start < 4; ++start)
    least = std::min(least, trained(recipe.layer().draw(3, start == 0 ? 6 : child_seed(6, start))));
  EXPECT_LT(least, trained(recipe.layer().draw(3, 6)));  // or the test would not see the first one being kept
  recipe.starts = 4;
  EXPECT_EQ(value(recipe, x, y, recipe.fit(x, y, {.seed = 6}).theta()), least);
}

// The first start is what an ELM of the same seed draws, the observer is told the best of all starts so far.
TEST(VarProElm, TheObserverIsToldTheBestOfAllStarts) {
  const Inputs x = inputs(100, 41);
  const Targets y = targets(x);
  VarProElm recipe{.hidden_nodes = 3, .iterations = 6, .tolerance = 0, .starts = 5};
  std::vector<double> seen;
  const auto observer = [&](const Progress& progress) {
    EXPECT_EQ(progress.generation, static_cast<Index>(seen.size()));
    seen.push_back(progress.best);
  };
  const auto found = recipe.fit(x, y, {.seed = 2, .observer = observer});
  for (std::size_t k = 1; k < seen.size(); ++k) EXPECT_LE(seen[k], seen[k - 1]);
  EXPECT_NEAR(seen.back(), value(recipe, x, y, found.theta()), 1e-9 * seen.back());
  EXPECT_NEAR(seen.front(), value(recipe, x, y, recipe.layer().draw(3, 2)), 1e-9 * seen.front());
}

TEST(VarProElm, AnObserverStopsIt) {
  const Inputs x = inputs(100, 22);
  const Targets y = targets(x);
  Index calls = 0;
  const auto observer = [&](const Progress&) { return ++calls < 4; };
  const auto stopped = VarProElm{.hidden_nodes = 5, .starts = 3}.fit(x, y, {.seed = 1, .observer = observer});
  EXPECT_EQ(calls, 4);
  EXPECT_EQ(stopped.theta(), (VarProElm{.hidden_nodes = 5, .iterations = 3}.fit(x, y, {.seed = 1}).theta()));
}

TEST(VarProElm, StopsWhenSteadyOrPerfect) {
  const Inputs x = inputs(100, 23);
  Index calls = 0;
  const auto count = [&](const VarProElm& recipe, const Targets& y) {
    calls = 0;
    const auto observer = [&](const Progress&) { ++calls; };
    static_cast<void>(recipe.fit(x, y, {.seed = 1, .observer = observer}));
    return calls;
  };
  EXPECT_EQ(count({.hidden_nodes = 5, .iterations = 400}, Targets::Constant(100, 2, 0.3)), 1);
  EXPECT_LT(count({.hidden_nodes = 5, .iterations = 400, .tolerance = 0.5}, targets(x)), 100);
  EXPECT_GT(count({.hidden_nodes = 5, .iterations = 400, .tolerance = 0}, targets(x)), 50);
}

// The search chooses where the training starts, by the same objective.
TEST(VarProElm, FinishesWhatASearchBegan) {
  const Inputs x = inputs(200, 24);
  const Targets y = targets(x);
  const VarProElm recipe{.hidden_nodes = 6, .iterations = 12};
  const Pso pso{.particles = 10, .iterations = 8};
  std::vector<Progress> seen;
  const auto observer = [&](const Progress& progress) { seen.push_back(progress); };
  const auto hybrid = Tuned{recipe, pso}.fit(x, y, {.seed = 4, .observer = observer});
  const SearchResult found = minimize(pso, recipe.objective(x, y), recipe.box(3), {}, 4);
  EXPECT_EQ(hybrid.theta(), recipe.fit_at(x, y, found.best).theta());
  EXPECT_NE(hybrid.theta(), found.best);
  ASSERT_EQ(seen.size(), 9u + 13u);
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_LE(seen[i].best, seen[i - 1].best * (1 + 1e-6));
    EXPECT_GE(seen[i].generation, seen[i - 1].generation);
  }
  EXPECT_EQ(seen[8].evaluations, 90);
  EXPECT_EQ(seen.back().evaluations, 90 + 13);
  EXPECT_NEAR(seen[9].best, found.best_fitness, 1e-6 * found.best_fitness);
  EXPECT_LT(seen.back().best, found.best_fitness);
}

// One sample, fewer samples than nodes, constant columns, one output: finite, and as good as it can be.
TEST(VarProElm, SmallestProblems) {
  for (const Activation activation : activations) {
    const VarProElm recipe{.hidden_nodes = 12, .activation = activation, .iterations = 20};
    const Inputs one = inputs(1, 25), few = inputs(7, 26);
    EXPECT_LT((recipe.fit(one, targets(one)).predict(one) - targets(one)).norm(), 1e-12);
    EXPECT_LT(error(recipe.fit(few, targets(few)).predict(few), targets(few)), 1e-3);
    EXPECT_TRUE(recipe.fit(few, targets(few)).predict(inputs(50, 27)).allFinite());
    Inputs constant = inputs(60, 28);
    for (Index i = 0; i < 60; ++i) constant(i, 1) = 0.4;
    EXPECT_LT(error(recipe.fit(constant, targets(constant)).predict(constant), targets(constant)), 0.1);
    EXPECT_LT(error(VarProElm{.hidden_nodes = 12, .activation = activation, .input_map = InputMap::raw}
                        .fit(constant, targets(constant))
                        .predict(constant),
                    targets(constant)),
              0.1);
    const Targets level = Targets::Constant(60, 2, 7);
    EXPECT_LT((recipe.fit(constant, level).predict(constant) - level).norm(), 1e-12);
    const VectorX single = RealMatrix::of(targets(constant)).col(1);
    EXPECT_LT(error(RealMatrix::of(recipe.fit(constant, single).predict(constant)), single), 0.1);
  }
}

/// Saturated everywhere: nothing to learn from, nothing to divide by.
TEST(VarProElm, SaturatedNodes) {
  const Inputs x = inputs(50, 29);
  const Targets y = targets(x);
  const VarProElm recipe{.hidden_nodes = 3, .input_map = InputMap::raw};
  const VectorX theta = repeated(vernier_test::vector({0, 0, 0, 1e4}), 3);
  const auto predictor = recipe.fit_at(x, y, theta);
  EXPECT_EQ(predictor.theta(), theta);
  EXPECT_LT(plus_row(RealMatrix::of(predictor.predict(x)), -column_means(RealMatrix::of(y))).norm(), 1e-12);
}

// Limits of the options have a test of their own; the objective has the same.
TEST(VarProElm, RefusesMisuseWithTheNumbers) {
  const Inputs x = inputs(10, 30);
  const Targets y = targets(x);
  const auto says = [](const auto& call, const char* text) {
    const std::string said = complaint(call);
    EXPECT_NE(said.find(text), std::string::npos) << said;
  };
  says([&] { (void)VarProElm{}.fit(x, part(y, 0, 9)); }, "VarProElm: 10 rows of inputs, but 9 rows of targets");
  says([&] { (void)VarProElm{.ridge = 1}.objective(x, y); }, "VarProElm: ridge is 1");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const VarProElm two{.hidden_nodes = 2, .input_map = InputMap::raw};
  says([&] { (void)two.fit_at(x, y, VectorX::Ones(7)); }, "7 hidden weights, expected 8");
  says([&] { (void)two.objective(x, y).gradient(VectorX::Ones(9)); }, "9 hidden weights, expected 8");
  says([&] { (void)two.fit_at(x, y, VectorX::Constant(8, nan)); }, "not finite");
}

}  // namespace
}  // namespace vernier::var_pro_elm_test
