// Scaling, the hidden layer, and fitted predictors against naive loops.

#include "vernier/regression/elm.hpp"

#include <gtest/gtest.h>

#include "allocation_counter.hpp"
#include "regression_samples.hpp"
#include "vernier/regression/ridge_elm.hpp"

namespace vernier::elm_test {
namespace {

using vernier_test::activations;
using vernier_test::input_maps;
using vernier_test::Inputs;
using vernier_test::inputs;
using vernier_test::Targets;
using vernier_test::targets;

/// One node on one sample of features, from the formulas.
double node(Activation activation, const VectorX& features, const VectorX& weights, double bias) {
  double z = bias, distance = 0;
  for (Index j = 0; j < features.size(); ++j) {
    z += features(j) * weights(j);
    distance += (features(j) - weights(j)) * (features(j) - weights(j));
  }
  switch (activation) {
    case Activation::sigmoid: return 1 / (1 + std::exp(-z));
    case Activation::tanh: return std::tanh(z);
    case Activation::sine: return std::sin(z);
    default: return std::exp(-bias * bias * distance);
  }
}

TEST(Scaling, MinMaxByHand) {
  const MatrixX x = (MatrixX(3, 2) << 1, 10, 3, 30, 2, 15).finished();
  const MatrixX scaled = ColumnScaling::fit(x, Scaling::min_max).apply(x);
  EXPECT_EQ(scaled, (MatrixX(3, 2) << -1, -1, 1, 1, 0, -0.5).finished());
}

TEST(Scaling, StandardByHand) {
  const MatrixX x = (MatrixX(4, 1) << 1, 3, 5, 7).finished();  // mean 4, mean square deviation 5
  const ColumnScaling scaling = ColumnScaling::fit(x, Scaling::standard);
  EXPECT_DOUBLE_EQ(scaling.offset(0), 4);
  EXPECT_DOUBLE_EQ(scaling.factor(0), 1 / std::sqrt(5.0));
  EXPECT_NEAR(scaling.apply(x)(3, 0), 3 / std::sqrt(5.0), 1e-15);
}

TEST(Scaling, None) {
  const MatrixX x = inputs(5, 1);
  EXPECT_EQ(ColumnScaling::fit(x, Scaling::none).apply(x), x);
}

// A constant column becomes zero, also one that is constant but for rounding, and fresh values of it stay near zero.
TEST(Scaling, ConstantColumnIsShiftedAndNotStretched) {
  MatrixX x(3, 3);
  x << 0.7, 1e6, 0, 0.7, 1e6 + 1e-9, 0, 0.7 + 1e-16, 1e6, 0;
  for (const Scaling kind : {Scaling::min_max, Scaling::standard}) {
    const ColumnScaling scaling = ColumnScaling::fit(x, kind);
    EXPECT_EQ(scaling.factor, VectorX::Ones(3));
    EXPECT_LT(scaling.apply(x).cwiseAbs().maxCoeff(), 1e-8);
    MatrixX other = x.topRows(1);
    other(0, 0) = 0.71;
    EXPECT_NEAR(scaling.apply(other)(0, 0), 0.01, 1e-12);
  }
}

// A millimetre at ten metres is signal, not rounding (which is 4e-12 of it).
TEST(Scaling, SmallSignalOnALargeOffset) {
  const MatrixX x = (MatrixX(2, 1) << 10, 10.001).finished();
  EXPECT_NEAR(ColumnScaling::fit(x, Scaling::min_max).apply(x)(1, 0), 1, 1e-11);
}

TEST(HiddenLayer, EqualsNaiveLoops) {
  const Inputs x = inputs(7, 2);
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      const HiddenLayer layer{.nodes = 5, .activation = activation, .input_map = input_map, .weight_limit = 2};
      const Index features = input_map == InputMap::raw ? 3 : 6;
      ASSERT_EQ(layer.dimension(3), 5 * (features + 1));
      const VectorX theta = layer.draw(3, 11);
      const MatrixX mapped = layer.map(x);
      MatrixX h;
      layer.outputs(mapped, theta, h);
      for (Index i = 0; i < 7; ++i) {
        VectorX f(features);
        for (int j = 0; j < 3; ++j) {
          f(j) = input_map == InputMap::raw ? x(i, j) : std::sin(x(i, j));
          if (input_map != InputMap::raw) f(3 + j) = std::cos(x(i, j));
        }
        for (Index k = 0; k < 5; ++k) {
          const VectorX weights = theta.segment(k * (features + 1), features);
          const double bias = theta(k * (features + 1) + features);
          EXPECT_NEAR(h(i, k), node(activation, f, weights, bias), 1e-14);
        }
      }
    }
}

TEST(HiddenLayer, SaturatedNodesStayFinite) {
  const HiddenLayer layer{.nodes = 2};
  MatrixX h;
  layer.outputs(VectorX::Constant(1, 1), (VectorX(4) << 1e5, 0, -1e5, 0).finished(), h);
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
  EXPECT_GT(theta.maxCoeff(), 2.99);
  EXPECT_LT(theta.minCoeff(), -2.99);
}

/// Predictions from the parts a predictor shows: map, scale, layer, output weights, offset.
template <class P>
MatrixX rebuilt(const P& predictor, const Inputs& x) {
  MatrixX h;
  predictor.layer().outputs(predictor.scaling().apply(predictor.layer().map(x)), predictor.theta(), h);
  return (h * predictor.beta()).rowwise() + predictor.offset().transpose();
}

template <class R>
void expect_predictor(const R& recipe) {
  const Inputs x = inputs(40, 3), fresh = inputs(15, 4);
  const auto predictor = recipe.fit(x, targets(x), {.seed = 6});
  EXPECT_EQ(predictor.theta(), recipe.layer().draw(3, 6));
  EXPECT_LT((predictor.predict(fresh) - rebuilt(predictor, fresh)).cwiseAbs().maxCoeff(), 1e-12);
  const double step = 1e-5;
  for (Index i = 0; i < fresh.rows(); ++i) {
    const Vector3 at = fresh.row(i).transpose();
    const Eigen::Matrix<double, 2, 3> derivative = predictor.derivative(at);
    for (int j = 0; j < 3; ++j) {
      const Vector3 d = step * Vector3::Unit(j);
      const Eigen::Vector2d difference =
          (predictor.predict(Vector3(at + d)) - predictor.predict(Vector3(at - d))) / (2 * step);
      EXPECT_LT((derivative.col(j) - difference).norm(), 1e-8) << "input " << j;
    }
  }
}

TEST(ElmPredictor, EqualsItsParts) {
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      expect_predictor(Elm{.hidden_nodes = 7, .activation = activation, .input_map = input_map});
      expect_predictor(RidgeElm{.hidden_nodes = 7, .activation = activation, .input_map = input_map});
    }
  expect_predictor(Elm{.hidden_nodes = 7, .input_scaling = Scaling::standard, .target_scaling = Scaling::standard});
}

// Elm in its own words: scale both sides, solve for beta, scale back; nothing else between samples and predictions.
TEST(Elm, EqualsTheTextbook) {
  const Inputs x = inputs(30, 5), fresh = inputs(9, 6);
  const Targets y = targets(x);
  const Elm elm{.hidden_nodes = 6};
  const VectorX theta = elm.layer().draw(3, 8);
  const auto scale = [](const MatrixX& m, const MatrixX& by) {
    MatrixX out = m;
    for (Index j = 0; j < m.cols(); ++j) {
      const double low = by.col(j).minCoeff(), high = by.col(j).maxCoeff();
      out.col(j) = (2 * (m.col(j).array() - low) / (high - low) - 1).matrix();
    }
    return out;
  };
  const auto layer = [&](const MatrixX& scaled) {
    MatrixX h(scaled.rows(), 6);
    for (Index i = 0; i < h.rows(); ++i)
      for (Index k = 0; k < 6; ++k)
        h(i, k) = node(Activation::sigmoid, scaled.row(i).transpose(), theta.segment(4 * k, 3), theta(4 * k + 3));
    return h;
  };
  const MatrixX beta = layer(scale(x, x)).completeOrthogonalDecomposition().solve(scale(y, y));
  MatrixX expected = layer(scale(fresh, x)) * beta;
  for (Index j = 0; j < 2; ++j) {
    const double low = y.col(j).minCoeff(), high = y.col(j).maxCoeff();
    expected.col(j) = ((expected.col(j).array() + 1) * (high - low) / 2 + low).matrix();
  }
  EXPECT_LT((elm.fit_at(x, y, theta).predict(fresh) - expected).cwiseAbs().maxCoeff(), 1e-11);
}

// Fresh samples to a twentieth of their spread, where the best linear map leaves more than half of it.
TEST(Elm, LearnsASmoothMap) {
  const Inputs x = inputs(400, 7), fresh = inputs(200, 8);
  const Targets y = targets(x), expected = targets(fresh);
  const double spread = (expected.rowwise() - expected.colwise().mean()).norm();
  MatrixX linear(400, 4), fresh_linear(200, 4);
  linear << x, VectorX::Ones(400);
  fresh_linear << fresh, VectorX::Ones(200);
  EXPECT_GT((fresh_linear * minimum_norm_solution(linear, y, 0) - expected).norm(), 0.5 * spread);
  EXPECT_LT((Elm{.hidden_nodes = 150}.fit(x, y, {.seed = 1}).predict(fresh) - expected).norm(), 0.05 * spread);
  EXPECT_LT((RidgeElm{.hidden_nodes = 150}.fit(x, y, {.seed = 1}).predict(fresh) - expected).norm(), 0.05 * spread);
}

// Few noisy samples and more nodes than samples: the least-norm fit follows the noise, the ridge does not.
TEST(RidgeElm, DoesNotFollowNoise) {
  const Inputs x = inputs(40, 9), fresh = inputs(200, 10);
  Rng rng(11);
  Targets noise(40, 2);
  for (auto& value : noise.reshaped()) value = 1e-3 * rng.normal() + 0.3;
  const auto excess = [&](const auto& predictor) {
    return std::sqrt((predictor.predict(fresh).array() - 0.3).square().mean());
  };
  EXPECT_LT(excess(RidgeElm{.hidden_nodes = 65}.fit(x, noise, {.seed = 1})), 1e-3);
  EXPECT_GT(excess(Elm{.hidden_nodes = 65}.fit(x, noise, {.seed = 1})), 3e-3);
}

TEST(ElmPredictor, DoesNotAllocate) {
  const Inputs x = inputs(60, 12);
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps) {
      const auto predictor =
          Elm{.hidden_nodes = 65, .activation = activation, .input_map = input_map}.fit(x, targets(x), {.seed = 1});
      const Vector3 at(0.1, -0.2, 0.3);
      EXPECT_EQ(vernier_test::allocations([&] {
                  vernier_test::keep(predictor.predict(at));
                  vernier_test::keep(predictor.derivative(at));
                }),
                0);
      // the counter counts: rows need memory
      EXPECT_GT(vernier_test::allocations([&] { vernier_test::keep(predictor.predict(x)); }), 0);
    }
}

/// What a call says when it refuses.
template <class Call>
std::string refusal(Call&& call) {
  try {
    static_cast<void>(call());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Elm, RefusesMisuseWithTheNumbers) {
  const Inputs x = inputs(10, 13);
  const Targets y = targets(x), fewer = y.topRows(9);
  EXPECT_EQ(refusal([&] { return Elm{}.fit(x, fewer); }), "Elm: 10 rows of inputs, but 9 rows of targets");
  EXPECT_EQ(refusal([&] { return RidgeElm{}.fit(x, fewer); }), "RidgeElm: 10 rows of inputs, but 9 rows of targets");
  EXPECT_EQ(refusal([&] { return Elm{}.fit(Inputs(0, 3), Targets(0, 2)); }), "Elm: no samples");
  EXPECT_NE(refusal([&] { return Elm{.hidden_nodes = 0}.fit(x, y); }).find("is 0"), std::string::npos);
  EXPECT_NE(refusal([&] { return Elm{.hidden_nodes = -4}.fit(x, y); }).find("is -4"), std::string::npos);
  EXPECT_NE(refusal([&] { return Elm{.weight_limit = -1}.fit(x, y); }).find("is -1"), std::string::npos);
  EXPECT_NE(refusal([&] { return Elm{.rcond = 1}.fit(x, y); }).find("rcond is 1"), std::string::npos);
  EXPECT_NE(refusal([&] { return Elm{.fitness_lambda = 0}.objective(x, y); }).find("is 0"), std::string::npos);
  EXPECT_NE(refusal([&] { return Elm{.hidden_nodes = 2}.fit_at(x, y, VectorX::Ones(7)); }).find("7 hidden weights"),
            std::string::npos);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Targets holed = y;
    holed(2, 1) = value;
    EXPECT_NE(refusal([&] { return Elm{}.fit(x, holed); }).find("not finite"), std::string::npos);
    Inputs holed_x = x;
    holed_x(2, 1) = value;
    EXPECT_NE(refusal([&] { return RidgeElm{}.fit(holed_x, y); }).find("not finite"), std::string::npos);
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
  constant.col(1).setConstant(0.4);
  const Targets level = Targets::Constant(20, 2, 7);
  EXPECT_LT((Elm{.hidden_nodes = 4}.fit(constant, level).predict(constant) - level).norm(), 1e-12);
  EXPECT_LT((RidgeElm{.hidden_nodes = 4}.fit(constant, level).predict(constant) - level).norm(), 1e-12);
}

}  // namespace
}  // namespace vernier::elm_test
