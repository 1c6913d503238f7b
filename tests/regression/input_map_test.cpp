// SPDX-License-Identifier: BSD-3-Clause
// Maps of inputs: features by brute force, gradients by differences, and learners behind them.

#include "vernier/regression/input_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "complaint.hpp"
#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/regression/gaussian_process.hpp"
#include "vernier/regression/kernel_elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"

namespace vernier::input_map_test {
namespace {

using namespace vernier_test;

constexpr InputMap all_maps[] = {InputMap::raw, InputMap::sines_and_cosines, InputMap::sine_cosine_products};

struct Mapped {
  VectorX features, sine, cosine;
  Mapped(InputMap map, const VectorX& x)
      : features(detail::feature_count(map, static_cast<int>(x.size()))), sine(x.size()), cosine(x.size()) {
    detail::map_inputs(map, x.data(), x.size(), features.data(), sine.data(), cosine.data());
  }
};

VectorX angles(Index n, std::uint64_t seed) {
  Rng rng(seed);
  VectorX x(n);
  for (double& value : x) value = rng.uniform(-4, 4);
  return x;
}

// All numbers to base 3 with one or two digits that are not 0, and the products they stand for.
TEST(InputMap, ProductsAreThoseOfDifferentAngles) {
  for (const Index n : {1, 2, 3, 6, 9}) {
    const VectorX x = angles(n, 2), found = Mapped(InputMap::sine_cosine_products, x).features;
    Index at = 0, all = 1;
    for (Index j = 0; j < n; ++j) all *= 3;
    for (Index f = 1; f < all; ++f) {
      double product = 1;
      int degree = 0;
      Index digits = f;
      for (Index j = n - 1; j >= 0; --j, digits /= 3) {
        if (digits % 3 == 0) continue;
        ++degree;
        product *= digits % 3 == 1 ? std::sin(x(j)) : std::cos(x(j));
      }
      if (degree > 2) continue;
      ASSERT_LT(at, found.size());
      EXPECT_NEAR(found(at++), product, 1e-14) << f;
    }
    EXPECT_EQ(at, found.size());
  }
}

TEST(InputMap, SinesAndCosinesOfAnyNumberOfAngles) {
  for (const Index n : {1, 4, 7, 8, 9, 17}) {
    const VectorX x = angles(n, 3);
    const Mapped found(InputMap::sines_and_cosines, x);
    for (Index j = 0; j < n; ++j) {
      EXPECT_NEAR(found.features(j), std::sin(x(j)), 1e-15);
      EXPECT_NEAR(found.features(n + j), std::cos(x(j)), 1e-15);
    }
  }
}

// The gradient of g'features at x, by central differences of fourth order.
TEST(InputMap, GradientsEqualDifferences) {
  for (const InputMap map : all_maps)
    for (const Index n : {1, 2, 3, 6}) {
      const VectorX x = angles(n, 4), g = angles(detail::feature_count(map, static_cast<int>(n)), 5);
      const Mapped at(map, x);
      VectorX gradient = VectorX::Constant(2 * n, 0.25);  // a stride of two; entries between are left alone
      detail::add_input_gradient(map, g.data(), at.sine.data(), at.cosine.data(), n, gradient.data(), 2);
      for (Index j = 0; j < n; ++j) {
        const auto value = [&](double steps) {
          VectorX moved = x;
          moved(j) += 1e-3 * steps;
          return g.dot(Mapped(map, moved).features);
        };
        EXPECT_NEAR(gradient(2 * j) - 0.25, (8 * (value(1) - value(-1)) - (value(2) - value(-2))) / 12e-3, 1e-9);
        EXPECT_EQ(gradient(2 * j + 1), 0.25);
      }
    }
}

TEST(InputMap, TheLayerSeesTheFeatures) {
  const auto x = inputs(5, 3);
  for (const InputMap map : all_maps) {
    const MatrixX mapped = HiddenLayer{.nodes = 5, .input_map = map}.map(x);
    for (Index i = 0; i < 5; ++i) {
      const RealMatrix features = Mapped(map, point(x, i)).features;
      EXPECT_LT((features.transpose() - RealMatrix(mapped).row(i)).norm(), 1e-14);
    }
  }
}

// Products have a range of their own, sines and cosines do not need one.
TEST(InputMap, ProductsAreScaledLikeRawInputs) {
  const MatrixX mapped = MatrixX::Random(10, 4);
  HiddenLayer layer{.input_map = InputMap::sine_cosine_products};
  EXPECT_EQ(layer.scaling(mapped).factor, ColumnScaling::fit(mapped, Scaling::min_max).factor);
  layer.input_map = InputMap::sines_and_cosines;
  EXPECT_EQ(layer.scaling(mapped).factor, VectorX(VectorX::Ones(4)));
}

TEST(InputMap, LearnersOnProductsKeepTheLaws) {
  const RidgeElm ridge{.hidden_nodes = 9, .input_map = InputMap::sine_cosine_products};
  const testing::RegressorLaws taken{.weights = testing::SampleWeights::taken};
  expect_laws(ridge, taken);
  expect_laws(Tuned{ridge, Pso{.particles = 6, .iterations = 4}}, taken);
  expect_laws(KernelElm{.input_map = InputMap::sine_cosine_products},
              {.uses_seed = false, .weights = taken.weights, .weight_tolerance = 1e-7});
}

TEST(InputMap, PredictionsDoNotAllocate) {
  const auto x = inputs(30, 3);
  for (const InputMap map : all_maps)
    expect_no_allocations(RidgeElm{.hidden_nodes = 9, .input_map = map}.fit(x, targets(x)));
}

TEST(InputMap, RefusesMisuse) {
  const auto x = inputs(30, 3);
  const auto y = targets(x);
  EXPECT_NE(complaint([&] {
              static_cast<void>(GaussianProcess{.input_map = InputMap::sine_cosine_products}.fit(x, y));
            }).find("no length scale"),
            std::string::npos);
  EXPECT_NE(complaint([] {
              static_cast<void>(HiddenLayer{.input_map = InputMap::sine_cosine_products}.map(MatrixX::Zero(2, 33)));
            }).find("33 inputs"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::input_map_test
