// SPDX-License-Identifier: BSD-3-Clause
// Bagging against its own words: members refitted by hand, their mean and spread.

#include "vernier/regression/ensemble.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/trigonometric_regression.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"

namespace vernier::ensemble_test {
namespace {

using namespace vernier_test;

static_assert(Regressor<Ensemble<Elm>> && Regressor<Ensemble<Tuned<Elm, Pso>>>);
static_assert(UncertainPredictor<PredictorOf<Ensemble<Elm>, 6, 3>>);

TEST(Ensemble, KeepsTheLaws) {
  const testing::RegressorLaws taken{.weights = testing::SampleWeights::taken};
  expect_laws(Ensemble{Elm{.hidden_nodes = 5}, 5}, taken);
  expect_laws(Ensemble{TrigonometricRegression{.max_degree = 1}, 3}, taken);
  expect_laws(Ensemble{Tuned{Elm{.hidden_nodes = 3}, Pso{.particles = 4, .iterations = 3}}, 3, 0.6, false}, taken);
}

TEST(EnsemblePredictor, IsTheMeanAndTheSpreadOfItsMembers) {
  const Inputs x = inputs(60, 1), fresh = inputs(10, 2);
  const auto ensemble = Ensemble{Elm{.hidden_nodes = 6}, 7}.fit(x, targets(x), {.seed = 3});
  ASSERT_EQ(ensemble.members().size(), 7u);
  for (Index i = 0; i < 10; ++i) {
    const Vector3 at = point(fresh, i);
    for (int o = 0; o < 2; ++o) {
      RealMatrix values(7, 1), slopes(7, 1);
      for (Index k = 0; k < 7; ++k) {
        values(k) = ensemble.members()[static_cast<std::size_t>(k)].predict(at)(o);
        slopes(k) = ensemble.members()[static_cast<std::size_t>(k)].derivative(at)(o, 1);
      }
      const double spread = centred(values).norm() / std::sqrt(6);
      EXPECT_GT(spread, 1e-6);
      EXPECT_NEAR(ensemble.predict(at)(o), values.mean(), 1e-14);
      EXPECT_NEAR(ensemble.derivative(at)(o, 1), slopes.mean(), 1e-14);
      EXPECT_NEAR(ensemble.standard_deviation(at)(o), spread, 1e-12);
    }
  }
}

/// Notes which rows a fit gets: inputs are their numbers.
struct Noted {
  std::vector<double> rows, weights;
  std::uint64_t seed = 0;
};

struct NotedMap : PredictorOf<Elm, 1, 1> {
  Noted noted;
};

struct Noting {
  template <class X, class Y>
  auto fit(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y, const FitOptions& options = {}) const {
    if constexpr (X::ColsAtCompileTime == 1 && Y::ColsAtCompileTime == 1) {
      NotedMap map{Elm{.hidden_nodes = 2}.fit(x, y), {}};
      map.noted.seed = options.seed;
      for (Index i = 0; i < x.rows(); ++i) {
        EXPECT_EQ(y(i, 0), 100 + x(i, 0));  // targets stay with their inputs
        map.noted.rows.push_back(x(i, 0));
        map.noted.weights.push_back(options.weights != nullptr ? (*options.weights)(i) : -1);
      }
      return map;
    } else {
      return Elm{}.fit(x, y, options);
    }
  }
};

TEST(Ensemble, DrawsRowsAndSeedsForEachMember) {
  const Index n = 500;
  VectorX x(n), y(n), weights(n);
  for (Index i = 0; i < n; ++i) {
    x(i) = static_cast<double>(i);
    y(i) = x(i) + 100;
    weights(i) = x(i) + 1;
  }
  const auto noted = [&](const Ensemble<Noting>& recipe, const VectorX* q) {
    std::vector<Noted> out;
    const auto ensemble = recipe.fit(x, y, {.seed = 5, .weights = q});
    for (const NotedMap& member : ensemble.members()) out.push_back(member.noted);
    return out;
  };
  const auto distinct = [](const Noted& member) {
    return std::set<double>(member.rows.begin(), member.rows.end()).size();
  };

  const auto bootstrap = noted({Noting{}, 20}, &weights);
  ASSERT_EQ(bootstrap.size(), 20u);
  double sum = 0;
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_EQ(bootstrap[k].rows.size(), 500u);
    // (1 - 1/n)^n of the rows are never drawn: 1/e
    EXPECT_NEAR(static_cast<double>(distinct(bootstrap[k])) / 500, 0.632, 0.07);
    for (std::size_t i = 0; i < 500; ++i) {
      EXPECT_EQ(bootstrap[k].weights[i], bootstrap[k].rows[i] + 1);  // weights stay with their rows
      sum += bootstrap[k].rows[i];
    }
    for (std::size_t l = 0; l < k; ++l) {
      EXPECT_NE(bootstrap[k].seed, bootstrap[l].seed);
      EXPECT_NE(bootstrap[k].rows, bootstrap[l].rows);
    }
  }
  EXPECT_NEAR(sum / 10000, 249.5, 4 * 144.3 / 100);  // all rows alike

  for (const Noted& member : noted({Noting{}, 4, 0.6, false}, nullptr)) {
    EXPECT_EQ(member.rows.size(), 300u);
    EXPECT_EQ(distinct(member), 300u);
    EXPECT_EQ(member.weights[0], -1);
  }
  const auto all = noted({Noting{}, 2, 1, false}, nullptr);
  EXPECT_EQ(distinct(all[0]), 500u);
  EXPECT_EQ(all[0].rows, all[1].rows);
  EXPECT_NE(all[0].seed, all[1].seed);
}

// The nearest whole number of rows, and at least one.
TEST(DrawRows, Counts) {
  for (const bool replacement : {true, false}) {
    EXPECT_EQ(detail::draw_rows(10, 0.26, replacement, 1).size(), 3u);
    EXPECT_EQ(detail::draw_rows(10, 0.24, replacement, 1).size(), 2u);
    EXPECT_EQ(detail::draw_rows(10, 0.01, replacement, 1).size(), 1u);
    EXPECT_EQ(detail::draw_rows(10, 1, replacement, 1).size(), 10u);
  }
}

TEST(Ensemble, TheObserverCountsMembersAndStopsThem) {
  const Inputs x = inputs(40, 13);
  const Targets y = targets(x);
  const Ensemble recipe{Elm{.hidden_nodes = 3}, 6};
  std::vector<Index> seen;
  const auto watch = [&](const Progress& progress) { seen.push_back(progress.generation); };
  const ThreadExecutor threads(2);
  static_cast<void>(recipe.fit(x, y, {.executor = threads, .observer = watch}));
  EXPECT_EQ(seen, (std::vector<Index>{1, 2, 3, 4, 5, 6}));
  const auto stop = [](const Progress& progress) { return progress.generation < 2; };
  const auto stopped = recipe.fit(x, y, {.observer = stop});
  ASSERT_EQ(stopped.members().size(), 2u);
  EXPECT_EQ(stopped.members()[1].theta(), recipe.fit(x, y).members()[1].theta());
}

TEST(EnsemblePredictor, DoesNotAllocate) {
  const Inputs x = inputs(60, 14);
  expect_no_allocations(Ensemble{Elm{.hidden_nodes = 9}, 4}.fit(x, targets(x), {.seed = 1}));
}

TEST(Ensemble, RefusesWhatItsMembersRefuse) {
  const Inputs x = inputs(10, 15);
  const Ensemble<Elm> recipe{Elm{.hidden_nodes = 0}, 5};
  EXPECT_NE(complaint([&] { (void)recipe.fit(x, targets(x)); }).find("hidden_nodes is 0"), std::string::npos);
  EXPECT_THROW((EnsemblePredictor<ElmPredictor<3, 2>>({})), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::ensemble_test
