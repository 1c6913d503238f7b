// Maps of inputs: features by brute force, derivatives by the chain rule, and regressors behind them.

#include "vernier/regression/on_features.hpp"

#include <gtest/gtest.h>

#include <string>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "laws.hpp"
#include "regression_samples.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/testing/regressor_laws.hpp"

namespace vernier::on_features_test {
namespace {

using testing::regressor_violations;
using vernier_test::complaint;
using vernier_test::no_violations;

using vernier_test::Inputs;
using vernier_test::inputs;
using vernier_test::Targets;
using vernier_test::targets;

using RidgeOnProducts = OnFeatures<SineCosineProducts<2>, RidgeElm>;
static_assert(FeatureMap<RawAngles> && FeatureMap<SinesAndCosines> && FeatureMap<SineCosineProducts<2>>);
static_assert(Regressor<RidgeOnProducts> && TunableRegressor<RidgeOnProducts>);
static_assert(Regressor<Tuned<RidgeOnProducts, Pso>> && Regressor<OnFeatures<RawAngles, Tuned<Elm, Pso>>>);
static_assert(!TunableRegressor<OnFeatures<RawAngles, Tuned<Elm, Pso>>>, "nothing is left to search for");
static_assert(!UncertainPredictor<PredictorOf<RidgeOnProducts, 6, 3>>);

/// Near misses of the concept.
struct NotNoexcept : RawAngles {
  template <int N>
  Eigen::Matrix<double, N, 1> map(const Eigen::Matrix<double, N, 1>& x) const {
    return x;
  }
};
struct NoDerivative {
  static constexpr int features(int inputs) { return inputs; }
  template <int N>
  Eigen::Matrix<double, N, 1> map(const Eigen::Matrix<double, N, 1>& x) const noexcept {
    return x;
  }
};
struct WrongCount : RawAngles {
  static constexpr int features(int inputs) { return inputs + 1; }
};
static_assert(!FeatureMap<NotNoexcept> && !FeatureMap<NoDerivative> && !FeatureMap<WrongCount> && !FeatureMap<int>);

template <int N, class Map>
void expect_derivative(const Map& map) {
  Rng rng(1);
  for (int sample = 0; sample < 5; ++sample) {
    Eigen::Matrix<double, N, 1> x;
    for (double& value : x) value = rng.uniform(-4, 4);
    const auto derivative = map.derivative(x);
    for (int j = 0; j < N; ++j) {
      const auto at = [&](double steps) {
        Eigen::Matrix<double, N, 1> moved = x;
        moved(j) += 1e-3 * steps;
        return VectorX(map.map(moved));
      };
      EXPECT_LT((derivative.col(j) - (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / 12e-3).norm(), 1e-10);
    }
  }
}

TEST(FeatureMap, DerivativesEqualDifferences) {
  expect_derivative<3>(RawAngles{});
  expect_derivative<1>(SinesAndCosines{});
  expect_derivative<6>(SinesAndCosines{});
  expect_derivative<1>(SineCosineProducts<2>{});
  expect_derivative<3>(SineCosineProducts<1>{});
  expect_derivative<3>(SineCosineProducts<3>{});
  expect_derivative<6>(SineCosineProducts<2>{});
  expect_derivative<6>(SineCosineProducts<3>{});
}

/// All numbers to base 3 with one to `Degree` digits that are not 0, and the products they stand for.
template <int Degree, int N>
void expect_products() {
  Rng rng(2);
  Eigen::Matrix<double, N, 1> x;
  for (double& value : x) value = rng.uniform(-4, 4);
  const VectorX found = SineCosineProducts<Degree>{}.map(x);
  Index at = 0, all = 1;
  for (int j = 0; j < N; ++j) all *= 3;
  for (Index f = 1; f < all; ++f) {
    double product = 1;
    int degree = 0;
    Index digits = f;
    for (int j = N - 1; j >= 0; --j, digits /= 3) {
      if (digits % 3 == 0) continue;
      ++degree;
      product *= digits % 3 == 1 ? std::sin(x(j)) : std::cos(x(j));
    }
    if (degree > Degree) continue;
    ASSERT_LT(at, found.size());
    EXPECT_NEAR(found(at++), product, 1e-14) << f;
  }
  EXPECT_EQ(at, found.size());
}

TEST(SineCosineProducts, AreAllProductsOfDifferentAngles) {
  expect_products<1, 6>();
  expect_products<2, 6>();
  expect_products<3, 6>();
  expect_products<6, 6>();
  expect_products<2, 3>();
  expect_products<5, 3>();  // more than there are angles
  expect_products<2, 1>();
  EXPECT_EQ(SineCosineProducts<2>::features(6), 72);
  EXPECT_EQ(SineCosineProducts<3>::features(6), 232);
  EXPECT_EQ(SineCosineProducts<6>::features(6), 728);
}

TEST(SinesAndCosines, AreWhatTheHiddenLayerSees) {
  const Inputs x = inputs(5, 3);
  const MatrixX expected = HiddenLayer{.input_map = InputMap::sines_and_cosines}.map(x);
  for (Index i = 0; i < 5; ++i)
    EXPECT_LT((SinesAndCosines{}.map(Vector3(x.row(i).transpose())).transpose() - expected.row(i)).norm(), 1e-15);
}

TEST(OnFeatures, KeepsTheLaws) {
  const RidgeElm ridge{.hidden_nodes = 9, .input_map = InputMap::raw};
  const testing::RegressorLaws taken{.weights = testing::SampleWeights::taken};
  EXPECT_TRUE(no_violations(regressor_violations(OnFeatures{RawAngles{}, ridge}, taken)));
  EXPECT_TRUE(no_violations(regressor_violations(OnFeatures{SinesAndCosines{}, ridge}, taken)));
  EXPECT_TRUE(no_violations(regressor_violations(OnFeatures{SineCosineProducts<2>{}, ridge}, taken)));
  const Pso pso{.particles = 6, .iterations = 4};
  EXPECT_TRUE(no_violations(regressor_violations(Tuned{OnFeatures{SineCosineProducts<2>{}, ridge}, pso}, taken)));
  EXPECT_TRUE(no_violations(regressor_violations(OnFeatures{SinesAndCosines{}, Tuned{ridge, pso}}, taken)));
}

// A map that changes nothing changes nothing; and sines and cosines are what the ELM would make of the inputs itself.
TEST(OnFeatures, IsTheRegressorOnTheFeatures) {
  const Inputs x = inputs(50, 4), fresh = inputs(20, 5);
  const Targets y = targets(x);
  const Elm elm{.hidden_nodes = 7};
  EXPECT_EQ((OnFeatures{RawAngles{}, elm}.fit(x, y, {.seed = 3}).predict(fresh)),
            elm.fit(x, y, {.seed = 3}).predict(fresh));
  const Elm on_raw{.hidden_nodes = 7, .input_scaling = Scaling::none};
  const Elm own{.hidden_nodes = 7, .input_map = InputMap::sines_and_cosines};
  EXPECT_LT((OnFeatures{SinesAndCosines{}, on_raw}.fit(x, y, {.seed = 3}).predict(fresh) -
             own.fit(x, y, {.seed = 3}).predict(fresh))
                .norm(),
            1e-9);
}

// All that a search asks for passes through, the features' number in place of the inputs'.
TEST(OnFeatures, IsTunedAsItsRegressorIs) {
  const Inputs x = inputs(60, 6), fresh = inputs(20, 7);
  const Targets y = targets(x);
  const RidgeElm ridge{.hidden_nodes = 5, .input_map = InputMap::raw};
  const OnFeatures recipe{SineCosineProducts<2>{}, ridge};
  EXPECT_EQ(recipe.dimension(3), 5 * (18 + 1));
  EXPECT_EQ(recipe.dimension(6), 5 * (72 + 1));
  EXPECT_EQ(recipe.box(3).dimension(), recipe.dimension(3));
  Eigen::Matrix<double, Eigen::Dynamic, 18> z(60, 18);
  for (Index i = 0; i < 60; ++i) z.row(i) = recipe.map.map(Vector3(x.row(i).transpose())).transpose();
  const VectorX theta = ridge.layer().draw(18, 8);
  VectorX found(1), expected(1);
  recipe.objective(x, y)(theta, found);
  ridge.objective(z, y)(theta, expected);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(recipe.fit_at(x, y, theta).predictor().theta(), theta);
  EXPECT_EQ(recipe.fit_at(x, y, theta).predictor().beta(), ridge.fit_at(z, y, theta).beta());

  const Pso pso{.particles = 8, .iterations = 10};
  const auto loss = [&](const auto& predictor) {
    recipe.objective(x, y)(predictor.predictor().theta(), found);
    return found(0);
  };
  EXPECT_LT(loss(Tuned{recipe, pso}.fit(x, y, {.seed = 1})), 0.8 * loss(recipe.fit(x, y, {.seed = 1})));
}

/// Takes the options of a fit wherever it can, and keeps what it was told.
struct Constant {
  static constexpr int inputs = 4;
  static constexpr int outputs = 2;
  std::uint64_t seed = 0;
  double weight = 0;
  Eigen::Vector2d predict(const Eigen::Vector4d&) const noexcept { return Eigen::Vector2d::Zero(); }
  Targets predict(const Eigen::Matrix<double, Eigen::Dynamic, 4>& x) const { return Targets::Zero(x.rows(), 2); }
  Eigen::Matrix<double, 2, 4> derivative(const Eigen::Vector4d&) const noexcept {
    return Eigen::Matrix<double, 2, 4>::Zero();
  }
  Eigen::Vector2d standard_deviation(const Eigen::Vector4d& x) const noexcept { return {x(0), x(3)}; }
};
static_assert(UncertainPredictor<Constant>);

TEST(FeaturePredictor, PassesTheStandardDeviationOn) {
  const FeaturePredictor<SinesAndCosines, Constant, 2> predictor({}, Constant{});
  static_assert(UncertainPredictor<FeaturePredictor<SinesAndCosines, Constant, 2>>);
  const Eigen::Vector2d x(0.3, 0.7);
  EXPECT_NEAR(predictor.standard_deviation(x)(0), std::sin(0.3), 1e-15);
  EXPECT_NEAR(predictor.standard_deviation(x)(1), std::cos(0.7), 1e-15);
}

/// A recipe that refuses weights and wants a certain seed: options arrive as they are.
struct Particular {
  template <class X, class Y>
  PredictorOf<Elm, X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& x,
                                                                   const Eigen::MatrixBase<Y>& y,
                                                                   const FitOptions& options = {}) const {
    detail::require_no_weights("Particular", options);
    require(options.seed == 4, "Particular: seed is ", options.seed);
    return Elm{.hidden_nodes = 3}.fit(x, y, options);
  }
};

TEST(OnFeatures, PassesOptionsAndComplaintsOn) {
  const Inputs x = inputs(20, 9);
  const Targets y = targets(x), fewer = y.topRows(19);
  const OnFeatures recipe{RawAngles{}, Particular{}};
  const VectorX weights = VectorX::Ones(20);
  EXPECT_EQ(complaint([&] { static_cast<void>(recipe.fit(x, y, {.seed = 4})); }), "");
  EXPECT_EQ(complaint([&] { static_cast<void>(recipe.fit(x, y, {.seed = 5})); }), "Particular: seed is 5");
  EXPECT_EQ(complaint([&] { static_cast<void>(recipe.fit(x, y, {.seed = 4, .weights = &weights})); }),
            "Particular takes no weights");
  EXPECT_EQ(complaint([&] {
              static_cast<void>(OnFeatures{SinesAndCosines{}, Elm{}}.fit(x, fewer));
            }),
            "Elm: 20 rows of inputs, but 19 rows of targets");
}

TEST(FeaturePredictor, DoesNotAllocate) {
  const Inputs x = inputs(60, 10);
  const auto predictor =
      OnFeatures{SineCosineProducts<2>{}, RidgeElm{.hidden_nodes = 30, .input_map = InputMap::raw}}.fit(x, targets(x));
  Eigen::Matrix<double, Eigen::Dynamic, 6> x6(60, 6);
  x6 << x, x.rowwise().reverse();
  const auto six = OnFeatures{SineCosineProducts<3>{}, Elm{.hidden_nodes = 10}}.fit(x6, targets(x));
  const Vector3 at(0.1, -0.2, 0.3);
  const Vector6 at6 = x6.row(0).transpose();
  EXPECT_EQ(vernier_test::allocations([&] {
              vernier_test::keep(predictor.predict(at));
              vernier_test::keep(predictor.derivative(at));
              vernier_test::keep(six.predict(at6));
              vernier_test::keep(six.derivative(at6));
            }),
            0);
  EXPECT_GT(vernier_test::allocations([&] { vernier_test::keep(predictor.predict(x)); }), 0);
}

}  // namespace
}  // namespace vernier::on_features_test
