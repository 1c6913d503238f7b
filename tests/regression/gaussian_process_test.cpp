// SPDX-License-Identifier: BSD-3-Clause
// Gaussian processes: likelihood, prediction and variance against dense algebra written out, gradients against
// differences.

#include "vernier/regression/gaussian_process.hpp"

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "kernel_samples.hpp"
#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/regression/detail/bounded_bfgs.hpp"
#include "vernier/regression/detail/marginal_likelihood.hpp"

namespace vernier::gaussian_process_test {
namespace {

using testing::same_bits;
using testing::SampleWeights;
using namespace vernier_test;

constexpr Kernel both_kernels[] = {Kernel::squared_exponential, Kernel::matern_5_2};

/// Inputs as they are, or their sines and cosines, divided by the length scales.
RealMatrix seen(InputMap map, const Inputs& x, const Vector3& lengths) {
  RealMatrix out = map == InputMap::raw ? RealMatrix(x) : vernier_test::sines_and_cosines(x);
  for (Index i = 0; i < out.rows(); ++i)
    for (Index j = 0; j < out.cols(); ++j) out(i, j) /= lengths(j % 3);
  return out;
}

/// What the textbook says, by explicit inverses.
struct Dense {
  RealMatrix mean, deviation;  // at the fresh inputs
  RealMatrix variance;

  Dense(Kernel kernel, InputMap map, const Inputs& x, const Targets& y, const VectorX& weights, const Vector3& lengths,
        double ratio, const Inputs& at)
      : deviation(at.rows(), 2), variance(2, 1) {
    const Index n = x.rows();
    RealMatrix a = kernels(kernel, seen(map, x, lengths), seen(map, x, lengths));
    for (Index i = 0; i < n; ++i) a(i, i) += ratio / weights(i);
    const RealMatrix inverse = a.inverse(), one = filled(n, 1, 1), known = inverse * one;
    const RealMatrix constant = known.transpose() * RealMatrix::of(y) / known.sum();
    const RealMatrix centred = plus_row(RealMatrix::of(y), -constant);
    variance = (centred.transpose() * inverse * centred).diagonal() / weights.sum();
    const RealMatrix k = kernels(kernel, seen(map, at, lengths), seen(map, x, lengths));
    mean = plus_row(k * inverse * centred, constant);
    for (Index i = 0; i < at.rows(); ++i) {
      const RealMatrix row = k.row(i), left = row * inverse;
      const double unit = 1 - left.dot(row) + std::pow(1 - left.sum(), 2) / known.sum();
      deviation.set_block(i, 0, (variance * unit).sqrt().transpose());
    }
  }
};

TEST(GaussianProcess, PredictionAndVarianceEqualADenseSolve) {
  const Vector3 lengths(0.8, 1.7, 3.0);
  for (const Index n : {40, 64, 150}) {  // fewer than a tile, one, several
    const Inputs x = inputs(n, 1), fresh = inputs(30, 2);
    const Targets y = targets(x, 1e-4);
    const VectorX weights = random_weights(n);
    for (const Kernel kernel : both_kernels)
      for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines})
        for (const VectorX* w : {static_cast<const VectorX*>(nullptr), &weights}) {
          const GaussianProcess recipe{.kernel = kernel,
                                       .input_map = map,
                                       .input_scaling = Scaling::none,
                                       .length_scales = lengths,
                                       .noise_ratio = 1e-2};
          const auto predictor = recipe.fit(x, y, {.weights = w});
          const Dense expected(kernel, map, x, y, w != nullptr ? *w : VectorX(VectorX::Ones(n)), lengths, 1e-2, fresh);
          EXPECT_LT(difference(predictor.predict(fresh), expected.mean), 1e-10 * 1e-3);
          EXPECT_LT(difference(RealMatrix::of(predictor.signal_variance()), expected.variance),
                    1e-10 * expected.variance.largest());
          EXPECT_LT((predictor.noise_variance() - 1e-2 * predictor.signal_variance()).norm(), 1e-20);
          for (Index i = 0; i < fresh.rows(); ++i) {
            const RealMatrix given = RealMatrix::of(predictor.standard_deviation(point(fresh, i)));
            EXPECT_LT(difference(given.transpose(), expected.deviation.row(i)), 1e-10 * expected.deviation.largest());
          }
        }
  }
}

/// Minus the log likelihood of samples a unit of weight, from determinant and inverse, with mean and variance scanned
/// by nobody: their closed forms are checked by the test below.
double minus_log_likelihood(Kernel kernel, const RealMatrix& features, const RealMatrix& y, double ratio,
                            double variance, double mean) {
  const Index n = features.rows();
  const RealMatrix covariance = variance * (kernels(kernel, features, features) + ratio * RealMatrix::identity(n));
  const RealMatrix off = y - filled(n, 1, mean);
  return 0.5 * (off.dot(covariance.inverse() * off) + covariance.log_determinant() +
                static_cast<double>(n) * std::log(2 * std::numbers::pi));
}

TEST(MarginalLikelihood, IsThatOfTheBestMeanAndVariance) {
  const Index n = 25;
  const Inputs x = inputs(n, 3);
  const Targets y = targets(x, 1e-4);
  const Vector3 lengths(0.8, 1.7, 3.0);
  const double ratio = 0.03;
  for (const Kernel kernel : both_kernels) {
    const RealMatrix features = seen(InputMap::raw, x, lengths);
    const Dense dense(kernel, InputMap::raw, x, y, VectorX::Ones(n), lengths, ratio, x);
    const RealMatrix a = kernels(kernel, features, features) + ratio * RealMatrix::identity(n);
    const RealMatrix ones = a.solve(filled(n, 1, 1));
    double sum = 0;
    for (int o = 0; o < 2; ++o) {
      const RealMatrix output = RealMatrix::of(y).col(o);
      const double mean = ones.dot(output) / ones.sum();
      const double best = minus_log_likelihood(kernel, features, output, ratio, dense.variance(o), mean);
      sum += best;
      for (const double factor : {0.99, 1.01})
        EXPECT_GT(minus_log_likelihood(kernel, features, output, ratio, factor * dense.variance(o), mean), best);
      for (const double shift : {-1e-5, 1e-5})
        EXPECT_GT(minus_log_likelihood(kernel, features, output, ratio, dense.variance(o), mean + shift), best);
    }
    const detail::MarginalLikelihood likelihood(kernel, x, 3, y, VectorX::Ones(n));
    const VectorX logarithms =
        vector({std::log(lengths(0)), std::log(lengths(1)), std::log(lengths(2)), std::log(ratio)});
    VectorX gradient;
    EXPECT_NEAR(likelihood(logarithms, gradient), sum / (2 * n), 1e-10 * std::abs(sum) / (2 * n));
  }
}

TEST(MarginalLikelihood, GradientEqualsDifferences) {
  const Index n = 40;
  const Inputs x = inputs(n, 4);
  Targets y = targets(x, 1e-4);
  const VectorX weights = random_weights(n);
  Rng rng(6);
  for (const bool constant : {false, true}) {
    if (constant)
      for (Index i = 0; i < n; ++i) y(i, 1) = 0.3;
    for (const Kernel kernel : both_kernels)
      for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines}) {
        const detail::MarginalLikelihood likelihood(kernel, seen(map, x, Vector3::Ones()), 3, y, weights);
        for (int repeat = 0; repeat < 5; ++repeat) {
          VectorX at(4), gradient, unused;
          for (auto& value : at) value = rng.uniform(-1, 1);
          at(3) = rng.uniform(-6, 1);
          EXPECT_TRUE(std::isfinite(likelihood(at, gradient)));
          for (Index j = 0; j < 4; ++j) {
            const auto value = [&](double steps) { return likelihood(moved(at, j, steps * 1e-3), unused); };
            const double expected = (8 * (value(1) - value(-1)) - (value(2) - value(-2))) / (12e-3);
            EXPECT_NEAR(gradient(j), expected, 1e-8 * (1 + RealMatrix(gradient).largest()));
          }
        }
      }
  }
}

TEST(BoundedBfgs, FindsRosenbrocksMinimumAndThatAtABound) {
  const auto rosenbrock = [](const VectorX& x, VectorX& g) {
    const double u = 1 - x(0), v = x(1) - x(0) * x(0);
    g(0) = -2 * u - 400 * x(0) * v;
    g(1) = 200 * v;
    return u * u + 100 * v * v;
  };
  const VectorX start = vector({-1.2, 1}), wide = VectorX::Constant(2, 5), below = VectorX::Constant(2, -5);
  const auto free = detail::minimise_within(rosenbrock, start, below, wide, 200, 1e-10);
  EXPECT_LT((free.x - vector({1, 1})).norm(), 1e-8);
  // x <= 0.5: the minimum is (0.5, 0.25); x >= 1.5: (1.5, 2.25)
  const auto low = detail::minimise_within(rosenbrock, start, below, vector({0.5, 5}), 200, 1e-10);
  EXPECT_LT((low.x - vector({0.5, 0.25})).norm(), 1e-8);
  const auto high = detail::minimise_within(rosenbrock, vector({3, 1}), vector({1.5, -5}), wide, 200, 1e-10);
  EXPECT_LT((high.x - vector({1.5, 2.25})).norm(), 1e-8);
  EXPECT_EQ(high.x(0), 1.5);
}

// Two gradients determine a parabola: after a first step of length 1 along the negative gradient the second reaches the
// minimum.
TEST(BoundedBfgs, TakesWholeStepsOfAtMostTwo) {
  std::vector<double> visited;
  const auto search_from = [&](double from, double minimum, double bend) {
    visited.clear();
    const auto parabola = [&](const VectorX& x, VectorX& g) {
      visited.push_back(x(0));
      g(0) = bend * (x(0) - minimum);
      return 0.5 * bend * (x(0) - minimum) * (x(0) - minimum);
    };
    const VectorX wide = VectorX::Constant(1, 100);
    return detail::minimise_within(parabola, vector({from}), vector({-100}), wide, 50, 1e-8);
  };
  EXPECT_NEAR(search_from(1, -1.5, 3).x(0), -1.5, 1e-12);
  ASSERT_EQ(visited.size(), 3u);  // 1, one less, the minimum
  EXPECT_NEAR(visited[1], 0, 1e-15);
  EXPECT_NEAR(visited[2], -1.5, 1e-14);
  // a slope below 1 is the step itself
  EXPECT_NEAR(search_from(1, 0.9, 2).x(0), 0.9, 1e-12);
  EXPECT_NEAR(visited[1], 0.8, 1e-15);
  EXPECT_LE(visited.size(), 4u);
  // far off, steps of two
  EXPECT_NEAR(search_from(0, 8, 1).x(0), 8, 1e-12);
  ASSERT_EQ(visited.size(), 6u);
  const double expected[] = {0, 1, 3, 5, 7, 8};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(visited[k], expected[k], 1e-12);
}

// Values that alternate from neighbour to neighbour are more than noise, values of a polynomial have none: the ratio is
// the largest and the smallest that is looked at.
TEST(GaussianProcess, NoiseRatiosHaveBounds) {
  const Index n = 40;
  RealMatrix x(n, 1), alternating(n, 1), smooth(n, 1);
  for (Index i = 0; i < n; ++i) {
    x(i) = static_cast<double>(i);
    alternating(i) = i % 2 == 0 ? 1 : -1;
    smooth(i) = x(i) * x(i);
  }
  const GaussianProcess process{.length_scales = vector({1})};
  const auto ratio = [&](const RealMatrix& y) { return process.fit(VectorX(x), VectorX(y)).noise_ratio(); };
  EXPECT_NEAR(ratio(alternating) / 1e3, 1, 1e-9);
  EXPECT_NEAR(ratio(smooth) / 1e-8, 1, 1e-9);
}

// Length scales lie between a thirtieth and a hundred times the spread of their input: values that alternate want the
// one, an input that does not matter the other.
TEST(GaussianProcess, LengthScalesHaveBounds) {
  const Index n = 40;
  VectorX alternating(n), smooth(n);
  Eigen::Matrix<double, Eigen::Dynamic, 2> two(n, 2), angles(n, 2);
  Rng rng(20);
  for (Index i = 0; i < n; ++i) {
    alternating(i) = i % 2 == 0 ? 1 : -1;
    two(i, 0) = rng.uniform(-1, 1);
    two(i, 1) = rng.uniform(-1, 1);
    smooth(i) = std::sin(3 * two(i, 0));
    angles(i, 0) = 0.05 * static_cast<double>(i);
    angles(i, 1) = 1e-3 * static_cast<double>(i % 3);
  }
  const auto spread = [](const RealMatrix& column) {
    return vernier_test::centred(column).norm() / std::sqrt(static_cast<double>(column.rows()));
  };
  GaussianProcess process{.input_scaling = Scaling::none, .noise_ratio = 1e-6};
  EXPECT_NEAR(process.fit(two, smooth).scaling().factor(1) * spread(RealMatrix::of(two).col(1)) * 100, 1, 1e-9);
  // of an angle the spread is that of its sine and cosine together
  process.input_map = InputMap::sines_and_cosines;
  const RealMatrix seen = vernier_test::sines_and_cosines(RealMatrix::of(angles));
  EXPECT_NEAR(process.fit(angles, alternating).scaling().factor(0) *
                  std::hypot(spread(seen.col(0)), spread(seen.col(2))) * std::pow(10, -1.5),
              1, 1e-9);
}

// Few samples have several explanations: of all starts the most likely one is kept.
TEST(GaussianProcess, TheBestOfSeveralStartsIsKept) {
  Rng rng(22);
  double gained = 0;
  for (int repeat = 0; repeat < 12; ++repeat) {
    VectorX x(8), y(8);
    for (Index i = 0; i < 8; ++i) {
      x(i) = rng.uniform(-3, 3);
      y(i) = rng.normal();
    }
    const detail::MarginalLikelihood likelihood(Kernel::squared_exponential, RealMatrix(x), 1, RealMatrix(y),
                                                VectorX::Ones(8));
    const auto value = [&](int starts) {
      const auto found = GaussianProcess{.input_scaling = Scaling::none, .starts = starts}.fit(x, y, {.seed = 3});
      VectorX unused;
      return likelihood(vector({-std::log(found.scaling().factor(0)), std::log(found.noise_ratio())}), unused);
    };
    const double first = value(1), best = value(6);
    EXPECT_LE(best, first + 1e-9);
    gained = std::max(gained, first - best);
  }
  EXPECT_GT(gained, 1e-3);
}

// A hundred-millionth of an offset is a signal, and as certain as the same signal alone.
TEST(GaussianProcess, ASmallSignalOnALargeOffset) {
  const Inputs x = inputs(30, 23);
  const Targets y = targets(x);
  Targets small = y;
  for (double& value : elements(small)) value = 1 + 1e-5 * value;
  const GaussianProcess recipe{.length_scales = Vector3(1, 2, 3), .noise_ratio = 1e-2};
  const auto alone = recipe.fit(x, y), offset = recipe.fit(x, small);
  const Vector3 at(0.1, 0.2, 0.3);
  for (int o = 0; o < 2; ++o) {
    EXPECT_NEAR(offset.standard_deviation(at)(o) / alone.standard_deviation(at)(o), 1e-5, 1e-10);
    EXPECT_NEAR((offset.predict(at)(o) - 1) / alone.predict(at)(o), 1e-5, 1e-10);
  }
}

TEST(GaussianProcess, ConstantOutputsAndSingleSamples) {
  const Inputs x = inputs(30, 12);
  Targets y = targets(x);
  for (Index i = 0; i < 30; ++i) y(i, 1) = 0.1;
  const auto one = GaussianProcess{.starts = 1}.fit(x, y);
  EXPECT_NEAR(one.predict(Vector3(0.1, 0.2, 0.3))(1), 0.1, 1e-14);
  EXPECT_EQ(one.standard_deviation(Vector3(0.1, 0.2, 0.3))(1), 0);
  EXPECT_GT(one.standard_deviation(Vector3(0.1, 0.2, 0.3))(0), 0);
  const auto single = GaussianProcess{}.fit(x.topRows(1), y.topRows(1));
  EXPECT_LT((single.predict(Vector3(0, 0, 0)) - target(y, 0)).norm(), 1e-15);
  EXPECT_EQ(single.standard_deviation(Vector3(0, 0, 0)), Eigen::Vector2d(0, 0));
}

TEST(GaussianProcess, KeepsTheLaws) {
  for (const Kernel kernel : both_kernels)
    for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines}) {
      expect_laws(GaussianProcess{.kernel = kernel, .input_map = map, .noise_ratio = 1e-4, .starts = 1},
                  {.uses_seed = false, .weights = SampleWeights::counted, .weight_tolerance = 1e-5});
    }
  expect_laws(GaussianProcess{.noise_ratio = 1e-3, .starts = 2, .max_hyper_samples = 30},
              {.weights = SampleWeights::taken, .weight_tolerance = 1e-6});
}

TEST(GaussianProcess, ALargeFitIsDecidedByASample) {
  const Inputs x = inputs(300, 13), fresh = inputs(100, 14);
  const GaussianProcess recipe{.starts = 2, .max_hyper_samples = 80};
  const auto predictor = recipe.fit(x, targets(x), {.seed = 3});
  EXPECT_EQ(predictor.samples(), 300);
  EXPECT_LT(difference(predictor.predict(fresh), targets(fresh)), 1e-5);
}

TEST(GaussianProcess, DoesNotAllocate) {
  const Inputs x = inputs(150, 15);
  const GaussianProcess recipe{.kernel = Kernel::matern_5_2,
                               .input_map = InputMap::sines_and_cosines,
                               .length_scales = Vector3(1, 2, 3),
                               .noise_ratio = 1e-3};
  expect_no_allocations(recipe.fit(x, targets(x)));
}

TEST(GaussianProcess, RefusesWhatItCannotUse) {
  const Inputs x = inputs(10, 16);
  const Targets y = targets(x);
  const auto told = [&](const GaussianProcess& recipe, const char* sentence) {
    const std::string text = complaint([&] { static_cast<void>(recipe.fit(x, y)); });
    EXPECT_NE(text.find(sentence), std::string::npos) << text;
  };
  told({.length_scales = VectorX::Ones(2)}, "2 length scales for 3 inputs");
  told({.length_scales = Vector3(1, 0, 1)}, "length scales must be positive");
  told({.length_scales = Vector3::Constant(1e9), .noise_ratio = 1e-30}, "too small for 10 samples");
}

static_assert(Regressor<GaussianProcess> && UncertainPredictor<GaussianProcessPredictor<6, 3>> &&
              UncertainPredictor<GaussianProcessPredictor<1, 1>>);

}  // namespace
}  // namespace vernier::gaussian_process_test
