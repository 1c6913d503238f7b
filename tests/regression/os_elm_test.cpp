// SPDX-License-Identifier: BSD-3-Clause
// Online sequential ELM: what was learned piece by piece against all at once.

#include "vernier/regression/os_elm.hpp"

#include <gtest/gtest.h>

#include "larger.hpp"
#include "regression_samples.hpp"
#include "regressor_checks.hpp"

namespace vernier::os_elm_test {
namespace {

using testing::same_bits;
using testing::SampleWeights;
using namespace vernier_test;

using vernier_test::difference;
using Fitted = OsElmPredictor<3, 2>;

Targets targets(const Inputs& x, double noise = 0) {
  Rng rng(99);
  Targets y(x.rows(), 2);
  for (Index i = 0; i < x.rows(); ++i) {
    y(i, 0) = std::sin(2 * x(i, 0)) * x(i, 1) + 0.5;
    y(i, 1) = std::cos(x(i, 2) - x(i, 0));
  }
  for (double& value : elements(y)) value += noise * rng.normal();
  return y;
}

/// Weighted ridge regression on the hidden layer and a free constant, by normal equations with every piece explicit.
struct Batch {
  RealMatrix coefficients, inverse, variance;

  Batch(const HiddenLayer& layer, std::uint64_t seed, const Inputs& x, const Targets& targets, const RealMatrix& w,
        double lambda) {
    const RealMatrix h = hidden(layer, seed, x), weighted = scaled_rows(w, h).transpose(), y = RealMatrix::of(targets);
    RealMatrix gram = weighted * h;
    for (Index k = 0; k < layer.nodes; ++k) gram(k, k) += lambda;
    inverse = gram.inverse();
    coefficients = gram.solve(weighted * y);
    const RealMatrix residual = scaled_rows(w.sqrt(), y - h * coefficients), beta = top(coefficients, layer.nodes);
    variance = zeros(2, 1);
    for (Index o = 0; o < 2; ++o)
      variance(o) = (residual.col(o).squared_norm() + lambda * beta.col(o).squared_norm()) / w.sum();
  }
  static RealMatrix hidden(const HiddenLayer& layer, std::uint64_t seed, const Inputs& x) {
    return with_ones(hidden_outputs(layer, layer.map(x), layer.draw(3, seed)));
  }
};

double difference(const Fitted& a, const Fitted& b) {
  const Inputs fresh = inputs(50, 77);
  double out = difference(a.predict(fresh), b.predict(fresh));
  for (Index i = 0; i < 50; ++i) {
    const Eigen::Vector2d of_a = a.standard_deviation(point(fresh, i)), of_b = b.standard_deviation(point(fresh, i));
    for (int o = 0; o < 2; ++o) out = vernier_test::larger(out, std::abs(of_a(o) - of_b(o)));
  }
  return out;
}

TEST(OsElm, FitIsTheBatchSolution) {
  const Inputs x = inputs(120, 1), fresh = inputs(20, 2);
  const Targets y = targets(x, 0.01);
  const VectorX w = random_weights(120);
  for (const Activation activation : activations)
    for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines}) {
      const OsElm recipe{.hidden_nodes = 40, .activation = activation, .input_map = map, .lambda = 1e-3};
      const auto predictor = recipe.fit(x, y, {.seed = 3, .weights = &w});
      const Batch batch(recipe.layer(), 3, x, y, w, 1e-3);
      const RealMatrix h = Batch::hidden(recipe.layer(), 3, fresh);
      EXPECT_LT(difference(predictor.predict(fresh), h * batch.coefficients), 1e-10);
      EXPECT_LT(difference(predictor.covariance(), batch.inverse), 1e-8 * batch.inverse.norm());
      EXPECT_LT((RealMatrix::of(predictor.noise_variance()) - batch.variance).norm(), 1e-10 * batch.variance.norm());
      for (Index i = 0; i < 20; ++i) {
        const RealMatrix expected = (batch.variance * (h.row(i) * batch.inverse).dot(h.row(i))).sqrt();
        const RealMatrix found = RealMatrix::of(predictor.standard_deviation(point(fresh, i)));
        EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm());
      }
    }
}

TEST(OsElm, UpdatesFromAnyPrefixEqualTheBatch) {
  const Inputs x = inputs(400, 4);
  const Targets y = targets(x, 0.01);
  const VectorX w = random_weights(400);
  for (const OsElm& recipe :
       {OsElm{}, OsElm{.hidden_nodes = 30, .activation = Activation::tanh, .input_map = InputMap::raw},
        OsElm{.activation = Activation::radial_basis, .lambda = 1e-4}}) {
    const Fitted all = recipe.fit(x, y, {.seed = 5}), all_weighted = recipe.fit(x, y, {.seed = 5, .weights = &w});
    EXPECT_GT(difference(all, all_weighted), 1e-4);
    for (const Index prefix : {1, 30, 65, 399}) {
      const VectorX first = part(w, 0, prefix);
      const Inputs first_x = part(x, 0, prefix);
      const Targets first_y = part(y, 0, prefix);
      Fitted one_by_one = recipe.fit(first_x, first_y, {.seed = 5});
      Fitted weighted = recipe.fit(first_x, first_y, {.seed = 5, .weights = &first});
      Fitted block = one_by_one;
      EXPECT_GT(difference(one_by_one, all), 1e-7);
      for (Index i = prefix; i < 400; ++i) {
        one_by_one.update(point(x, i), target(y, i));
        weighted.update(point(x, i), target(y, i), w(i));
      }
      block.update(part(x, prefix, 400 - prefix), part(y, prefix, 400 - prefix));
      EXPECT_LT(difference(one_by_one, all), 1e-9) << prefix;
      EXPECT_LT(difference(weighted, all_weighted), 1e-9) << prefix;
      EXPECT_LT(difference(block, all), 1e-9) << prefix;
    }
  }
}

// What lies back k updates counts mu^k; a block is one moment.
TEST(OsElm, ForgettingEqualsAnExponentiallyWeightedBatch) {
  const double mu = 0.97, lambda = 1e-2;
  const Inputs x = inputs(300, 7), fresh = inputs(30, 8);
  const Targets y = targets(x, 0.01);
  const OsElm recipe{.hidden_nodes = 20, .lambda = lambda, .forgetting = mu};
  Fitted single = recipe.fit(part(x, 0, 200), part(y, 0, 200), {.seed = 9}), block = single;
  for (Index i = 200; i < 300; ++i) single.update(point(x, i), target(y, i));
  for (Index i = 200; i < 300; i += 25) block.update(part(x, i, 25), part(y, i, 25));
  const auto check = [&](const Fitted& predictor, Index at_once) {
    VectorX w(300);
    const auto updates = static_cast<double>(100 / at_once);
    for (Index i = 0; i < 300; ++i) {
      const Index done = i < 200 ? 0 : 1 + (i - 200) / at_once;
      w(i) = std::pow(mu, updates - static_cast<double>(done));
    }
    const Batch batch(recipe.layer(), 9, x, y, w, lambda * std::pow(mu, updates));
    const RealMatrix h = Batch::hidden(recipe.layer(), 9, fresh);
    EXPECT_LT(difference(predictor.predict(fresh), h * batch.coefficients), 1e-9);
    EXPECT_LT((predictor.covariance() - batch.inverse).norm(), 1e-7 * batch.inverse.norm());
    EXPECT_LT((RealMatrix::of(predictor.noise_variance()) - batch.variance).norm(), 1e-9 * batch.variance.norm());
  };
  check(single, 1);
  check(block, 25);
}

// Ten thousand updates: still the batch without forgetting, still the window's with it, P still symmetric.
TEST(OsElm, LongRuns) {
  const Inputs x = inputs(10000, 13);
  const Targets y = targets(x, 0.01);
  for (const double mu : {1.0, 0.99}) {
    const OsElm recipe{.hidden_nodes = 20, .lambda = 1e-3, .forgetting = mu};
    Fitted predictor = recipe.fit(part(x, 0, 10), part(y, 0, 10), {.seed = 14});
    for (Index i = 10; i < x.rows(); ++i) predictor.update(point(x, i), target(y, i));
    const RealMatrix p = predictor.covariance();
    EXPECT_EQ(p, p.transpose());
    VectorX w(x.rows());
    const Index recent = mu < 1 ? 3000 : x.rows();  // 0.99^3000 = 1e-13
    for (Index i = 0; i < x.rows(); ++i) w(i) = std::pow(mu, static_cast<double>(x.rows() - 1 - i));
    const Index first = x.rows() - recent;
    const Batch batch(recipe.layer(), 14, part(x, first, recent), part(y, first, recent), part(w, first, recent),
                      mu < 1 ? 0 : 1e-3);
    const Inputs fresh = inputs(30, 15);
    EXPECT_LT(difference(predictor.predict(fresh), Batch::hidden(recipe.layer(), 14, fresh) * batch.coefficients), 1e-8)
        << mu;
    EXPECT_LT((RealMatrix::of(predictor.noise_variance()) - batch.variance).norm(), 1e-8 * batch.variance.norm());
  }
}

TEST(OsElm, KeepsTheLaws) {
  for (const Activation activation : activations)
    for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines})
      expect_laws(OsElm{.hidden_nodes = 9, .activation = activation, .input_map = map},
                  {.weights = SampleWeights::counted});
  expect_laws(OsElm{.hidden_nodes = 80}, {.weights = SampleWeights::counted});
}

TEST(OsElm, PredictionsDoNotAllocate) {
  const Inputs x = inputs(100, 16);
  expect_no_allocations(OsElm{}.fit(x, targets(x)));
}

TEST(OsElm, RefusesWhatItCannotUse) {
  const Inputs x = inputs(10, 17);
  const Targets y = targets(x);
  Fitted predictor = OsElm{}.fit(x, y);
  const Fitted before = predictor;
  EXPECT_THROW(predictor.update(Vector3(0, 0, std::nan("")), Eigen::Vector2d(0, 0)), std::invalid_argument);
  EXPECT_THROW(predictor.update(Vector3(0, 0, 0), Eigen::Vector2d(0, std::nan(""))), std::invalid_argument);
  EXPECT_THROW(predictor.update(Vector3(0, 0, 0), Eigen::Vector2d(0, 0), 0), std::invalid_argument);
  EXPECT_THROW(predictor.update(x, part(y, 0, 3)), std::invalid_argument);
  predictor.update(x.topRows(0), y.topRows(0));
  EXPECT_EQ(difference(predictor, before), 0);
}

static_assert(Regressor<OsElm> && UncertainPredictor<OsElmPredictor<6, 3>> && UncertainPredictor<OsElmPredictor<1, 1>>);

}  // namespace
}  // namespace vernier::os_elm_test
