// SPDX-License-Identifier: BSD-3-Clause
// Regressors whose inner weights a search finds: PSO-ELM, GA-ELM, and a user's own metaheuristic.

#include "vernier/search/tuned.hpp"

#include <gtest/gtest.h>

#include "vernier/regression/elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"

namespace vernier::tuned_test {
namespace {

using Inputs = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Targets = Eigen::Matrix<double, Eigen::Dynamic, 2>;

struct Samples {
  Inputs x;
  Targets y;
  Samples(Index n, std::uint64_t seed) : x(n, 3), y(n, 2) {
    Rng rng(seed);
    for (Index i = 0; i < n; ++i) {
      for (int j = 0; j < 3; ++j) x(i, j) = rng.uniform(-1.5, 1.5);
      y(i, 0) = std::sin(2 * x(i, 0)) * std::cos(x(i, 1));
      y(i, 1) = std::cos(x(i, 0) + 2 * x(i, 2)) + 0.1 * x(i, 1);
    }
  }
};

template <class P>
double error(const P& predictor, const Samples& samples) {
  return (predictor.predict(samples.x) - samples.y).squaredNorm() / static_cast<double>(samples.x.rows());
}

/// A user's own: random search.
struct RandomSearch {
  Index points = 10, rounds = 30;
  struct State {
    VectorX best;
    double best_fitness;
    Index generation;
    Rng rng;
  };
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    State s{box.lower, std::numeric_limits<double>::infinity(), -1, Rng(seed)};
    step(s, box, evaluate);
    return s;
  }
  void step(State& s, const Box& box, Evaluate evaluate) const {
    MatrixX x(box.dimension(), points);
    for (Index k = 0; k < points; ++k)
      for (Index d = 0; d < x.rows(); ++d) x(d, k) = s.rng.uniform(box.lower(d), box.upper(d));
    VectorX values;
    evaluate(x, values);
    for (Index k = 0; k < points; ++k)
      if (values(k) < s.best_fitness) {
        s.best = x.col(k);
        s.best_fitness = values(k);
      }
    ++s.generation;
  }
  bool done(const State& s) const { return s.generation >= rounds; }
  Index next_evaluations(const State&) const { return points; }
};
static_assert(Metaheuristic<RandomSearch>);

const Samples train(150, 1), fresh(300, 2);
const Elm elm{.hidden_nodes = 12};
const Pso pso{.particles = 20, .iterations = 40};
const GeneticAlgorithm ga{.individuals = 20, .generations = 40};

/// Fits with the whole search and with its first population alone, on the same seed: the search must better the
/// fitness by `factor` in every one of five seeds, and the error on fresh samples in the sum of them.
template <class R, class A>
void expect_search_pays(const R& regressor, const A& algorithm, double factor) {
  double fresh_first = 0, fresh_tuned = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<double> best;
    const auto watch = [&](const Progress& progress) { best.push_back(progress.best); };
    const auto tuned = Tuned{regressor, algorithm}.fit(train.x, train.y, {.seed = seed, .observer = watch});
    const auto first =
        Tuned{regressor, algorithm, StoppingCriteria{.max_generations = 0}}.fit(train.x, train.y, {.seed = seed});
    EXPECT_LT(best.back(), factor * best.front()) << "seed " << seed;
    EXPECT_LT(error(tuned, train), error(first, train)) << "seed " << seed;
    fresh_tuned += error(tuned, fresh);
    fresh_first += error(first, fresh);
  }
  EXPECT_LT(fresh_tuned, fresh_first);
}

TEST(Tuned, PsoElmBeatsItsFirstPopulation) { expect_search_pays(elm, pso, 0.5); }
TEST(Tuned, GaElmBeatsItsFirstPopulation) { expect_search_pays(elm, ga, 0.85); }
TEST(Tuned, UsersOwnMetaheuristicWorksUnchanged) { expect_search_pays(elm, RandomSearch{}, 0.95); }
TEST(Tuned, RidgeElmIsSearchedByItsLeaveOneOutError) {
  expect_search_pays(RidgeElm{.hidden_nodes = 8, .input_map = InputMap::raw}, pso, 0.7);
}

// The fit is the one at the weights the search reports, no other.
TEST(Tuned, FitsAtWhatTheSearchFound) {
  const auto predictor = Tuned{elm, pso}.fit(train.x, train.y, {.seed = 9});
  const SearchResult found = minimize(pso, elm.objective(train.x, train.y), elm.box(3), {}, 9);
  EXPECT_EQ(predictor.theta(), found.best);
  EXPECT_EQ(predictor.predict(fresh.x), elm.fit_at(train.x, train.y, found.best).predict(fresh.x));
  // the fitness is the training error in scaled targets, but for the ridge
  const VectorX half_width = (train.y.colwise().maxCoeff() - train.y.colwise().minCoeff()).transpose() / 2;
  const double scaled_error =
      ((predictor.predict(train.x) - train.y) * half_width.cwiseInverse().asDiagonal()).squaredNorm() / 150;
  EXPECT_NEAR(found.best_fitness, scaled_error, 0.02 * scaled_error);
  EXPECT_LE(scaled_error, found.best_fitness * (1 + 1e-9));
}

TEST(Tuned, SameBitsWithTwoThreads) {
  const ThreadExecutor two(2);
  const Tuned pso_elm{elm, pso};
  EXPECT_EQ(pso_elm.fit(train.x, train.y, {.seed = 3}).theta(),
            pso_elm.fit(train.x, train.y, {.seed = 3, .executor = two}).theta());
  const Tuned ga_elm{elm, ga};
  EXPECT_EQ(ga_elm.fit(train.x, train.y, {.seed = 3}).theta(),
            ga_elm.fit(train.x, train.y, {.seed = 3, .executor = two}).theta());
}

// The search sees a part of the samples, always the same for a seed; the fit has all of them.
TEST(Tuned, ASearchByAPartOfTheSamples) {
  const auto fit = [](std::uint64_t seed, Index samples) {
    return Tuned{elm, pso, StoppingCriteria{}, samples}.fit(train.x, train.y, {.seed = seed});
  };
  const auto found = fit(4, 60);
  EXPECT_EQ(found.theta(), fit(4, 60).theta());
  EXPECT_NE(found.theta(), fit(5, 60).theta());
  EXPECT_NE(found.theta(), fit(4, 150).theta());
  EXPECT_EQ(fit(4, 150).theta(), (Tuned{elm, pso}.fit(train.x, train.y, {.seed = 4}).theta()));
  EXPECT_EQ(found.beta(), elm.fit_at(train.x, train.y, found.theta()).beta());
  // it is worth it: better than no search at all
  EXPECT_LT(error(found, fresh), error(elm.fit(train.x, train.y, {.seed = 4}), fresh));
  EXPECT_THROW(static_cast<void>(fit(1, -1)), std::invalid_argument);
}

// Weights reach the search and the fit; a regressor without use for them refuses.
/// One whose objective knows nothing of weights.
struct Unweighted : Elm {
  template <class X, class Y>
  auto objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets) const {
    return Elm::objective(inputs, targets);
  }
};

TEST(Tuned, PassesWeightsOn) {
  VectorX weights = VectorX::Ones(150);
  weights.tail(50) *= 10;
  const Pso short_pso{.particles = 10, .iterations = 5};
  const auto weighted = Tuned{elm, short_pso}.fit(train.x, train.y, {.seed = 4, .weights = &weights});
  const SearchResult found = minimize(short_pso, elm.objective(train.x, train.y, &weights), elm.box(3), {}, 4);
  EXPECT_EQ(weighted.theta(), found.best);
  EXPECT_EQ(weighted.beta(), elm.fit_at(train.x, train.y, found.best, {.weights = &weights}).beta());
  const auto of_part =
      Tuned{elm, short_pso, StoppingCriteria{}, 60}.fit(train.x, train.y, {.seed = 4, .weights = &weights});
  EXPECT_NE(of_part.theta(),
            (Tuned{elm, short_pso, StoppingCriteria{}, 60}.fit(train.x, train.y, {.seed = 4}).theta()));
  EXPECT_THROW(
      static_cast<void>(Tuned{Unweighted{elm}, short_pso}.fit(train.x, train.y, {.seed = 4, .weights = &weights})),
      std::invalid_argument);
}

TEST(Tuned, RefusesWhatItsPartsRefuse) {
  const Inputs fewer = train.x.topRows(149);
  EXPECT_THROW(static_cast<void>(Tuned{elm, pso}.fit(fewer, train.y)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Tuned{Elm{.hidden_nodes = 0}, pso}.fit(train.x, train.y)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Tuned{elm, Pso{.particles = 0}}.fit(train.x, train.y)), std::invalid_argument);
  Inputs holed = train.x;
  holed(4, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(Tuned{elm, pso}.fit(holed, train.y)), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::tuned_test
