// Online sequential ELM: what was learned piece by piece against all at once.

#include "vernier/regression/os_elm.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "laws.hpp"
#include "regression_samples.hpp"
#include "vernier/testing/regressor_laws.hpp"

namespace vernier::os_elm_test {
namespace {

using testing::regressor_violations;
using testing::same_bits;
using testing::SampleWeights;
using vernier_test::complaint;
using vernier_test::no_violations;

using vernier_test::Inputs;
using vernier_test::inputs;
using vernier_test::Targets;
using Fitted = OsElmPredictor<3, 2>;

using vernier_test::activations;

Targets targets(const Inputs& x, double noise = 0) {
  Rng rng(99);
  Targets y(x.rows(), 2);
  y.col(0) = (2 * x.col(0).array()).sin() * x.col(1).array() + 0.5;
  y.col(1) = (x.col(2).array() - x.col(0).array()).cos();
  for (auto& value : y.reshaped()) value += noise * rng.normal();
  return y;
}

VectorX random_weights(Index n) {
  Rng rng(5);
  VectorX w(n);
  for (auto& value : w) value = rng.uniform(0.2, 4);
  return w;
}

/// Weighted ridge regression on the hidden layer and a free constant, by normal equations with every piece explicit.
struct Batch {
  MatrixX coefficients, inverse;
  VectorX variance;

  Batch(const HiddenLayer& layer, std::uint64_t seed, const Inputs& x, const Targets& y, const VectorX& w,
        double lambda) {
    const MatrixX h = hidden(layer, seed, x);
    MatrixX gram = h.transpose() * w.asDiagonal() * h;
    gram.diagonal().head(layer.nodes).array() += lambda;
    const Eigen::FullPivLU<MatrixX> lu(gram);
    coefficients = lu.solve(h.transpose() * w.asDiagonal() * y);
    inverse = lu.inverse();
    const MatrixX residual = w.cwiseSqrt().asDiagonal() * (y - h * coefficients);
    variance = (residual.colwise().squaredNorm() + lambda * coefficients.topRows(layer.nodes).colwise().squaredNorm())
                   .transpose() /
               w.sum();
  }
  static MatrixX hidden(const HiddenLayer& layer, std::uint64_t seed, const Inputs& x) {
    MatrixX nodes;
    layer.outputs(layer.map(x), layer.draw(3, seed), nodes);
    MatrixX h(x.rows(), layer.nodes + 1);
    h << nodes, VectorX::Ones(x.rows());
    return h;
  }
};

double difference(const Fitted& a, const Fitted& b) {
  const Inputs fresh = inputs(50, 77);
  double out = (a.predict(fresh) - b.predict(fresh)).cwiseAbs().maxCoeff();
  for (Index i = 0; i < 50; ++i) {
    const Vector3 at = fresh.row(i).transpose();
    out = std::max(out, (a.standard_deviation(at) - b.standard_deviation(at)).cwiseAbs().maxCoeff());
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
      const MatrixX h = Batch::hidden(recipe.layer(), 3, fresh);
      EXPECT_LT((predictor.predict(fresh) - h * batch.coefficients).cwiseAbs().maxCoeff(), 1e-10);
      EXPECT_LT((predictor.covariance() - batch.inverse).cwiseAbs().maxCoeff(), 1e-8 * batch.inverse.norm());
      EXPECT_LT((predictor.noise_variance() - batch.variance).norm(), 1e-10 * batch.variance.norm());
      for (Index i = 0; i < 20; ++i) {
        const VectorX expected = (batch.variance * h.row(i).dot(batch.inverse * h.row(i).transpose())).cwiseSqrt();
        EXPECT_LT((predictor.standard_deviation(fresh.row(i).transpose()) - expected).norm(), 1e-9 * expected.norm());
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
      const VectorX first = w.head(prefix);
      Fitted one_by_one = recipe.fit(x.topRows(prefix), y.topRows(prefix), {.seed = 5});
      Fitted weighted = recipe.fit(x.topRows(prefix), y.topRows(prefix), {.seed = 5, .weights = &first});
      Fitted block = one_by_one;
      EXPECT_GT(difference(one_by_one, all), 1e-7);
      for (Index i = prefix; i < 400; ++i) {
        one_by_one.update(x.row(i).transpose(), y.row(i).transpose());
        weighted.update(x.row(i).transpose(), y.row(i).transpose(), w(i));
      }
      block.update(x.bottomRows(400 - prefix), y.bottomRows(400 - prefix));
      EXPECT_LT(difference(one_by_one, all), 1e-9) << prefix;
      EXPECT_LT(difference(weighted, all_weighted), 1e-9) << prefix;
      EXPECT_LT(difference(block, all), 1e-9) << prefix;
    }
  }
}

TEST(OsElm, OneInputAndOneOutput) {
  const Eigen::Matrix<double, Eigen::Dynamic, 1> x = VectorX::LinSpaced(50, -1, 1), y = x.array().cube();
  const OsElm recipe{.hidden_nodes = 5, .lambda = 1e-3};
  const auto all = recipe.fit(x, y);
  auto single = recipe.fit(x.topRows(10).eval(), y.topRows(10).eval()), block = single;
  for (Index i = 10; i < 50; ++i) single.update(Eigen::Matrix<double, 1, 1>(x(i)), Eigen::Matrix<double, 1, 1>(y(i)));
  block.update(x.bottomRows(40).eval(), y.bottomRows(40).eval());
  EXPECT_LT((single.predict(x) - all.predict(x)).norm(), 1e-10);
  EXPECT_LT((block.predict(x) - all.predict(x)).norm(), 1e-10);
}

TEST(OsElm, AnIntegerWeightCountsAsSoManySamples) {
  const Inputs x = inputs(100, 6);
  const Targets y = targets(x, 0.01);
  Fitted once = OsElm{}.fit(x, y), thrice = once;
  once.update(Vector3(0.1, 0.2, 0.3), Eigen::Vector2d(1, 2), 3);
  for (int i = 0; i < 3; ++i) thrice.update(Vector3(0.1, 0.2, 0.3), Eigen::Vector2d(1, 2));
  EXPECT_LT(difference(once, thrice), 1e-10);
}

// What lies back k updates counts mu^k; a block is one moment.
TEST(OsElm, ForgettingEqualsAnExponentiallyWeightedBatch) {
  const double mu = 0.97, lambda = 1e-2;
  const Inputs x = inputs(300, 7), fresh = inputs(30, 8);
  const Targets y = targets(x, 0.01);
  const OsElm recipe{.hidden_nodes = 20, .lambda = lambda, .forgetting = mu};
  Fitted single = recipe.fit(x.topRows(200), y.topRows(200), {.seed = 9}), block = single;
  for (Index i = 200; i < 300; ++i) single.update(x.row(i).transpose(), y.row(i).transpose());
  for (Index i = 200; i < 300; i += 25) block.update(x.middleRows(i, 25), y.middleRows(i, 25));
  const auto check = [&](const Fitted& predictor, Index at_once) {
    VectorX w(300);
    const auto updates = static_cast<double>(100 / at_once);
    for (Index i = 0; i < 300; ++i) {
      const Index done = i < 200 ? 0 : 1 + (i - 200) / at_once;
      w(i) = std::pow(mu, updates - static_cast<double>(done));
    }
    const Batch batch(recipe.layer(), 9, x, y, w, lambda * std::pow(mu, updates));
    const MatrixX h = Batch::hidden(recipe.layer(), 9, fresh);
    EXPECT_LT((predictor.predict(fresh) - h * batch.coefficients).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((predictor.covariance() - batch.inverse).norm(), 1e-7 * batch.inverse.norm());
    EXPECT_LT((predictor.noise_variance() - batch.variance).norm(), 1e-9 * batch.variance.norm());
  };
  check(single, 1);
  check(block, 25);
}

// A change of the robot is followed with forgetting, and averaged over without.
TEST(OsElm, ForgettingFollowsAChange) {
  const Inputs before = inputs(1000, 10), after = inputs(1000, 11), fresh = inputs(100, 12);
  const auto error = [&](double mu) {
    auto predictor = OsElm{.hidden_nodes = 40, .forgetting = mu}.fit(before, targets(before, 0.01));
    const Targets y = targets(after, 0.01).array() + 1;
    for (Index i = 0; i < 1000; ++i) predictor.update(after.row(i).transpose(), y.row(i).transpose());
    return (targets(fresh) - predictor.predict(fresh)).mean() + 1;
  };
  EXPECT_LT(std::abs(error(0.995)), 0.05);
  EXPECT_GT(error(1), 0.3);
}

// Ten thousand updates: still the batch without forgetting, still the window's with it, P still symmetric.
TEST(OsElm, LongRuns) {
  const Inputs x = inputs(10000, 13);
  const Targets y = targets(x, 0.01);
  for (const double mu : {1.0, 0.99}) {
    const OsElm recipe{.hidden_nodes = 20, .lambda = 1e-3, .forgetting = mu};
    Fitted predictor = recipe.fit(x.topRows(10), y.topRows(10), {.seed = 14});
    for (Index i = 10; i < x.rows(); ++i) predictor.update(x.row(i).transpose(), y.row(i).transpose());
    const MatrixX p = predictor.covariance();
    EXPECT_EQ(p, p.transpose());
    VectorX w(x.rows());
    const Index recent = mu < 1 ? 3000 : x.rows();  // 0.99^3000 = 1e-13
    for (Index i = 0; i < x.rows(); ++i) w(i) = std::pow(mu, static_cast<double>(x.rows() - 1 - i));
    const Batch batch(recipe.layer(), 14, x.bottomRows(recent), y.bottomRows(recent), w.tail(recent),
                      mu < 1 ? 0 : 1e-3);
    const Inputs fresh = inputs(30, 15);
    EXPECT_LT((predictor.predict(fresh) - Batch::hidden(recipe.layer(), 14, fresh) * batch.coefficients)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-8)
        << mu;
    EXPECT_LT((predictor.noise_variance() - batch.variance).norm(), 1e-8 * batch.variance.norm());
  }
}

TEST(OsElm, KeepsTheLaws) {
  for (const Activation activation : activations)
    for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines})
      EXPECT_TRUE(no_violations(regressor_violations(
          OsElm{.hidden_nodes = 9, .activation = activation, .input_map = map}, {.weights = SampleWeights::counted})));
  EXPECT_TRUE(no_violations(regressor_violations(OsElm{.hidden_nodes = 80}, {.weights = SampleWeights::counted})));
}

TEST(OsElm, PredictionsDoNotAllocate) {
  const Inputs x = inputs(100, 16);
  const auto predictor = OsElm{}.fit(x, targets(x));
  const Vector3 at(0.1, 0.2, 0.3);
  EXPECT_EQ(vernier_test::allocations([&] {
              vernier_test::keep(predictor.predict(at));
              vernier_test::keep(predictor.derivative(at));
              vernier_test::keep(predictor.standard_deviation(at));
            }),
            0);
}

TEST(OsElm, RefusesWhatItCannotUse) {
  const Inputs x = inputs(10, 17);
  const Targets y = targets(x);
  const auto told = [&](const OsElm& recipe, const char* sentence) {
    const std::string text = complaint([&] { static_cast<void>(recipe.fit(x, y)); });
    EXPECT_NE(text.find(sentence), std::string::npos) << text;
  };
  told({.hidden_nodes = 0}, "hidden_nodes is 0");
  told({.lambda = 0}, "lambda is 0");
  told({.forgetting = 0}, "forgetting is 0");
  told({.forgetting = 1.01}, "forgetting is 1.01");

  Fitted predictor = OsElm{}.fit(x, y);
  const Fitted before = predictor;
  EXPECT_THROW(predictor.update(Vector3(0, 0, std::nan("")), Eigen::Vector2d(0, 0)), std::invalid_argument);
  EXPECT_THROW(predictor.update(Vector3(0, 0, 0), Eigen::Vector2d(0, std::nan(""))), std::invalid_argument);
  EXPECT_THROW(predictor.update(Vector3(0, 0, 0), Eigen::Vector2d(0, 0), 0), std::invalid_argument);
  EXPECT_THROW(predictor.update(x, y.topRows(3)), std::invalid_argument);
  predictor.update(x.topRows(0), y.topRows(0));
  EXPECT_EQ(difference(predictor, before), 0);
}

static_assert(Regressor<OsElm> && UncertainPredictor<OsElmPredictor<6, 3>> && UncertainPredictor<OsElmPredictor<1, 1>>);

}  // namespace
}  // namespace vernier::os_elm_test
