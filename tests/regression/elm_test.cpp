// SPDX-License-Identifier: BSD-3-Clause
// Scaling, the hidden layer, and fitted predictors against naive loops.

#include "vernier/regression/elm.hpp"

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/regression/ridge_elm.hpp"

namespace vernier::elm_test {
namespace {

using namespace vernier_test;

/// The k-th node on one sample of features, from the formulas.
double node(Activation activation, const VectorX& features, const VectorX& theta, Index k) {
  const Index first = k * (features.size() + 1);
  const double bias = theta(first + features.size());
  double z = bias, distance = 0;
  for (Index j = 0; j < features.size(); ++j) {
    const double weight = theta(first + j);
    z += features(j) * weight;
    distance += (features(j) - weight) * (features(j) - weight);
  }
  switch (activation) {
    case Activation::sigmoid: return 1 / (1 + std::exp(-z));
    case Activation::tanh: return std::tanh(z);
    case Activation::sine: return std::sin(z);
    default: return std::exp(-bias * bias * distance);
  }
}

TEST(Scaling, MinMaxByHand) {
  const RealMatrix x(3, 2, {1, 10, 3, 30, 2, 15});
  const RealMatrix scaled = ColumnScaling::fit(x, Scaling::min_max).apply(x);
  EXPECT_EQ(scaled, RealMatrix(3, 2, {-1, -1, 1, 1, 0, -0.5}));
}

TEST(Scaling, StandardByHand) {
  const RealMatrix x(4, 1, {1, 3, 5, 7});  // mean 4, mean square deviation 5
  const ColumnScaling scaling = ColumnScaling::fit(x, Scaling::standard);
  EXPECT_DOUBLE_EQ(scaling.offset(0), 4);
  EXPECT_DOUBLE_EQ(scaling.factor(0), 1 / std::sqrt(5.0));
  EXPECT_NEAR(scaling.apply(x)(3, 0), 3 / std::sqrt(5.0), 1e-15);
}

TEST(Scaling, None) {
  const RealMatrix x = inputs(5, 1);
  EXPECT_EQ(RealMatrix(ColumnScaling::fit(x, Scaling::none).apply(x)), x);
}

// A constant column becomes zero, also one that is constant but for rounding, and fresh values of it stay near zero.
TEST(Scaling, ConstantColumnIsShiftedAndNotStretched) {
  const RealMatrix x(3, 3, {0.7, 1e6, 0, 0.7, 1e6 + 1e-9, 0, 0.7 + 1e-16, 1e6, 0});
  for (const Scaling kind : {Scaling::min_max, Scaling::standard}) {
    const ColumnScaling scaling = ColumnScaling::fit(x, kind);
    EXPECT_EQ(scaling.factor, VectorX(VectorX::Ones(3)));
    EXPECT_LT(RealMatrix(scaling.apply(x)).largest(), 1e-8);
    RealMatrix other = x.row(0);
    other(0, 0) = 0.71;
    EXPECT_NEAR(scaling.apply(other)(0, 0), 0.01, 1e-12);
  }
}

// A millimetre at ten metres is signal, not rounding (which is 4e-12 of it), and so is a nanometre.
TEST(Scaling, SmallSignalOnALargeOffset) {
  const RealMatrix x(2, 1, {10, 10.001}), tiny(2, 1, {10, 10.000000001});
  EXPECT_NEAR(ColumnScaling::fit(x, Scaling::min_max).apply(x)(1, 0), 1, 1e-11);
  EXPECT_NEAR(ColumnScaling::fit(tiny, Scaling::standard).apply(tiny)(1, 0), 1, 1e-5);
}

TEST(HiddenLayer, EqualsNaiveLoops) {
  const Inputs x = inputs(7, 2);
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      const HiddenLayer layer{.nodes = 5, .activation = activation, .input_map = input_map, .weight_limit = 2};
      const Index features = input_map == InputMap::raw ? 3 : 6;
      ASSERT_EQ(layer.dimension(3), 5 * (features + 1));
      const VectorX theta = layer.draw(3, 11);
      const RealMatrix h = hidden_outputs(layer, layer.map(x), theta);
      for (Index i = 0; i < 7; ++i) {
        VectorX f(features);
        for (int j = 0; j < 3; ++j) {
          f(j) = input_map == InputMap::raw ? x(i, j) : std::sin(x(i, j));
          if (input_map != InputMap::raw) f(3 + j) = std::cos(x(i, j));
        }
        for (Index k = 0; k < 5; ++k) {
          EXPECT_NEAR(h(i, k), node(activation, f, theta, k), 1e-14);
        }
      }
    }
}

TEST(HiddenLayer, SaturatedNodesStayFinite) {
  const HiddenLayer layer{.nodes = 2};
  const RealMatrix h = hidden_outputs(layer, vector({1}), vector({1e5, 0, -1e5, 0}));
  EXPECT_EQ(h(0, 0), 1);
  EXPECT_EQ(h(0, 1), 0);
}

TEST(HiddenLayer, DrawsUniformlyFromItsBox) {
  const HiddenLayer layer{.nodes = 2000, .weight_limit = 3};
  const VectorX theta = layer.draw(3, 5);
  EXPECT_TRUE(layer.box(3).contains(theta));
  EXPECT_EQ(theta, layer.draw(3, 5));
  EXPECT_NE(theta, layer.draw(3, 6));
  EXPECT_NEAR(theta.mean(), 0, 4 * 3 / std::sqrt(3.0 * 8000));
  EXPECT_NEAR(theta.squaredNorm() / 8000, 3, 4 * 3 * std::sqrt(4.0 / 45) / std::sqrt(8000.0) * 3);
  EXPECT_GT(*std::max_element(theta.begin(), theta.end()), 2.99);
  EXPECT_LT(*std::min_element(theta.begin(), theta.end()), -2.99);
}

/// Predictions from the parts a predictor shows: map, scale, layer, output weights, offset.
template <class P>
RealMatrix rebuilt(const P& predictor, const Inputs& x) {
  const RealMatrix h =
      hidden_outputs(predictor.layer(), predictor.scaling().apply(predictor.layer().map(x)), predictor.theta());
  return plus_row(h * RealMatrix::of(predictor.beta()), RealMatrix::of(predictor.offset()).transpose());
}

template <class R>
void expect_predictor(const R& recipe) {
  const Inputs x = inputs(40, 3), fresh = inputs(15, 4);
  const auto predictor = recipe.fit(x, targets(x), {.seed = 6});
  EXPECT_EQ(predictor.theta(), recipe.layer().draw(3, 6));
  EXPECT_LT(difference(predictor.predict(fresh), rebuilt(predictor, fresh)), 1e-12);
  for (Index i = 0; i < fresh.rows(); ++i) {
    const Vector3 at = point(fresh, i);
    const RealMatrix derivative = RealMatrix::of(predictor.derivative(at));
    for (int j = 0; j < 3; ++j)
      EXPECT_LT((derivative.col(j) - difference_quotient(predictor, at, j, 1e-5)).norm(), 1e-8) << "input " << j;
  }
}

// A layer may be a single node; its bias counts.
TEST(ElmPredictor, EqualsItsParts) {
  for (const Activation activation : activations)
    for (const InputMap input_map : {InputMap::raw, InputMap::sines_and_cosines, InputMap::sine_cosine_products})
      for (const int nodes : {1, 7}) {
        expect_predictor(Elm{.hidden_nodes = nodes, .activation = activation, .input_map = input_map});
        expect_predictor(RidgeElm{.hidden_nodes = nodes, .activation = activation, .input_map = input_map});
      }
  expect_predictor(Elm{.hidden_nodes = 7, .input_scaling = Scaling::standard, .target_scaling = Scaling::standard});
}

// Elm in its own words: scale both sides, solve for beta, scale back; nothing else between samples and predictions.
TEST(Elm, EqualsTheTextbook) {
  const Inputs x = inputs(30, 5), fresh = inputs(9, 6);
  const Targets y = targets(x);
  const Elm elm{.hidden_nodes = 6};
  const VectorX theta = elm.layer().draw(3, 8);
  const auto layer = [&](const RealMatrix& scaled) {
    RealMatrix h(scaled.rows(), 6);
    for (Index i = 0; i < h.rows(); ++i)
      for (Index k = 0; k < 6; ++k) h(i, k) = node(Activation::sigmoid, scaled.row(i).transpose(), theta, k);
    return h;
  };
  const RealMatrix t = RealMatrix::of(y);
  const RealMatrix beta = layer(scaled_to_range_of(x, x)).solve(scaled_to_range_of(t, t));
  RealMatrix expected = layer(scaled_to_range_of(x, fresh)) * beta;
  for (Index j = 0; j < 2; ++j) {
    const auto [low, high] = range_of_column(t, j);
    for (Index i = 0; i < 9; ++i) expected(i, j) = (expected(i, j) + 1) * (high - low) / 2 + low;
  }
  EXPECT_LT(difference(elm.fit_at(x, y, theta).predict(fresh), expected), 1e-11);
}

// Few noisy samples and more nodes than samples: the least-norm fit follows the noise, the ridge does not.
TEST(RidgeElm, DoesNotFollowNoise) {
  const Inputs x = inputs(40, 9), fresh = inputs(200, 10);
  Rng rng(11);
  Targets noise(40, 2);
  for (double& value : elements(noise)) value = 1e-3 * rng.normal() + 0.3;
  const auto excess = [&](const auto& predictor) {
    return (predictor.predict(fresh) - Targets::Constant(200, 2, 0.3)).norm() / std::sqrt(400);
  };
  EXPECT_LT(excess(RidgeElm{.hidden_nodes = 65}.fit(x, noise, {.seed = 1})), 1e-3);
  EXPECT_GT(excess(Elm{.hidden_nodes = 65}.fit(x, noise, {.seed = 1})), 3e-3);
}

TEST(ElmPredictor, DoesNotAllocate) {
  const Inputs x = inputs(60, 12);
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      const Elm recipe{.hidden_nodes = 65, .activation = activation, .input_map = input_map};
      expect_no_allocations(recipe.fit(x, targets(x), {.seed = 1}));
    }
}

// Limits of the options have a test of their own.
TEST(Elm, RefusesMisuseWithTheNumbers) {
  const Inputs x = inputs(10, 13);
  const Targets y = targets(x), fewer = part(y, 0, 9);
  EXPECT_EQ(complaint([&] { (void)Elm{}.fit(x, fewer); }), "Elm: 10 rows of inputs, but 9 rows of targets");
  EXPECT_EQ(complaint([&] { (void)RidgeElm{}.fit(x, fewer); }), "RidgeElm: 10 rows of inputs, but 9 rows of targets");
  EXPECT_EQ(complaint([&] { (void)Elm{}.fit(Inputs(0, 3), Targets(0, 2)); }), "Elm: no samples");
  EXPECT_NE(complaint([&] { (void)Elm{.hidden_nodes = -4}.fit(x, y); }).find("is -4"), std::string::npos);
  EXPECT_NE(complaint([&] { (void)Elm{.hidden_nodes = 2}.fit_at(x, y, VectorX::Ones(7)); }).find("7 hidden weights"),
            std::string::npos);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Targets holed = y;
    holed(2, 1) = value;
    EXPECT_NE(complaint([&] { (void)Elm{}.fit(x, holed); }).find("not finite"), std::string::npos);
    Inputs holed_x = x;
    holed_x(2, 1) = value;
    EXPECT_NE(complaint([&] { (void)RidgeElm{}.fit(holed_x, y); }).find("not finite"), std::string::npos);
  }
  EXPECT_THROW((ElmPredictor<3, 2>(HiddenLayer{.nodes = 2}, ColumnScaling{VectorX::Zero(3), VectorX::Ones(3)},
                                   VectorX::Ones(8), MatrixX::Ones(3, 2), Eigen::Vector2d::Zero())),
               std::invalid_argument);
}

// One sample, one input, one output, constant columns: the smallest problems still give finite answers.
TEST(Elm, SmallestProblems) {
  const Inputs one = inputs(1, 14);
  const Targets y = targets(one);
  EXPECT_LT((Elm{.hidden_nodes = 3}.fit(one, y).predict(one) - y).norm(), 1e-12);
  EXPECT_LT((RidgeElm{.hidden_nodes = 3}.fit(one, y).predict(one) - y).norm(), 1e-12);
  Inputs constant = inputs(20, 15);
  for (Index i = 0; i < 20; ++i) constant(i, 1) = 0.4;
  const Targets level = Targets::Constant(20, 2, 7);
  EXPECT_LT((Elm{.hidden_nodes = 4}.fit(constant, level).predict(constant) - level).norm(), 1e-12);
  EXPECT_LT((RidgeElm{.hidden_nodes = 4}.fit(constant, level).predict(constant) - level).norm(), 1e-12);
}

}  // namespace
}  // namespace vernier::elm_test
