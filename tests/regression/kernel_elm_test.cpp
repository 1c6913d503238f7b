// SPDX-License-Identifier: BSD-3-Clause
// Kernel sums, kernel ridge regression and its leave-one-out errors against dense algebra written out.

#include "vernier/regression/kernel_elm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "complaint.hpp"
#include "kernel_samples.hpp"
#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/regression/detail/kernel_ridge_path.hpp"
#include "vernier/regression/detail/kernel_system.hpp"

namespace vernier::kernel_elm_test {
namespace {

using testing::same_bits;
using testing::SampleWeights;
using namespace vernier_test;

/// What the kernel sees, from the formulas: inputs to [-1, 1], or sines and cosines.
RealMatrix seen(InputMap map, const Inputs& train, const Inputs& x) {
  return map == InputMap::sines_and_cosines ? vernier_test::sines_and_cosines(x)
                                            : vernier_test::scaled_to_range_of(train, x);
}

/// Kernel ridge regression with a free mean, as one dense saddle-point system.
RealMatrix dense(InputMap map, const Inputs& x, const RealMatrix& y, const VectorX& weights, double length,
                 double lambda, const Inputs& at) {
  const Index n = x.rows();
  const RealMatrix features = seen(map, x, x), one = vernier_test::filled(n, 1, 1);
  RealMatrix k = kernels(Kernel::squared_exponential, features, features, length);
  for (Index i = 0; i < n; ++i) k(i, i) += lambda / weights(i);
  const RealMatrix system = above(beside(k, one), beside(one.transpose(), zeros(1, 1)));
  const RealMatrix solution = system.solve(above(y, zeros(1, y.cols())));
  return plus_row(kernels(Kernel::squared_exponential, seen(map, x, at), features, length) * top(solution, n),
                  solution.row(n));
}

TEST(KernelElm, EqualsADenseSolve) {
  const Inputs x = inputs(80, 1), fresh = inputs(30, 2);
  const Targets y = targets(x);
  const RealMatrix t = RealMatrix::of(y);
  const VectorX weights = random_weights(80);
  for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines})
    for (const double length : {0.2, 1.0, 3.0})
      for (const double lambda : {1e-4, 1e-1}) {
        const KernelElm recipe{.input_map = map, .length_scale = length, .lambda = lambda};
        const RealMatrix expected = dense(map, x, t, VectorX::Ones(80), length, lambda, fresh);
        EXPECT_LT(difference(recipe.fit(x, y).predict(fresh), expected), 1e-10 * 1e-3);
        const RealMatrix weighted = dense(map, x, t, weights, length, lambda, fresh);
        EXPECT_LT(difference(recipe.fit(x, y, {.weights = &weights}).predict(fresh), weighted), 1e-10 * 1e-3);
        EXPECT_GT(difference(weighted, expected), 1e-8);
      }
}

TEST(KernelElm, LeaveOneOutErrorsEqualFitsWithoutTheSample) {
  const Index n = 25;
  const Inputs x = inputs(n, 3);
  const RealMatrix y = RealMatrix::of(targets(x, 1e-4));
  const VectorX weights = random_weights(n);
  const RealMatrix features = seen(InputMap::sines_and_cosines, x, x);
  const detail::KernelRidgePath path(detail::kernel_matrix(Kernel::squared_exponential, features), y, weights);
  for (const double lambda : {1e-3, 1e-1, 1e3, std::numeric_limits<double>::infinity()}) {
    const RealMatrix residuals = path.leave_one_out_residuals(lambda);
    double error = 0;
    for (Index left = 0; left < n; ++left) {
      const std::vector<Index> rest = all_but(left, n);
      const RealMatrix t = rows_of(y, rest), w = samples_of(weights, rest);
      const RealMatrix elsewhere = std::isfinite(lambda) ? dense(InputMap::sines_and_cosines, samples_of(x, rest), t, w,
                                                                 1, lambda, part(x, left, 1))
                                                         : w.transpose() * t / w.sum();
      const RealMatrix expected = y.row(left) - elsewhere;
      EXPECT_LT(difference(residuals.row(left), expected), 1e-9 * y.largest());
      error += weights(left) * expected.squared_norm();
    }
    EXPECT_NEAR(path.leave_one_out_error(lambda), error / weights.sum(), 1e-7 * error);
  }
}

/// Length scale and ridge of the least error left out: octaves of the typical distance of two samples, from 8 down to a
/// sixteenth, then the half octaves beside the best; half decades from 100 down to 1e-8, and the mean.
std::pair<double, double> best_of_the_grid(const VectorX& x, const VectorX& y) {
  const Index n = x.size();
  const VectorX ones = VectorX::Ones(n);
  double square = 0, least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < n; ++i) square += 2 * std::pow(x(i) - x.mean(), 2) / static_cast<double>(n);
  std::pair<double, double> best{1, least};
  const auto consider = [&](double length) {
    MatrixX kernel(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) kernel(i, j) = std::exp(-0.5 * std::pow((x(i) - x(j)) / length, 2));
    const detail::KernelRidgePath path(kernel, y, ones);
    for (int k = 5; k >= -16; --k) {
      const double lambda = k == 5 ? std::numeric_limits<double>::infinity() : std::pow(10, 0.5 * k),
                   error = path.leave_one_out_error(lambda);
      if (error < least) {
        least = error;
        best = {length, lambda};
      }
    }
  };
  for (int power = 3; power >= -4; --power) consider(std::sqrt(square) * std::pow(2.0, power));
  const double octave = best.first;
  consider(octave * std::sqrt(2.0));
  consider(octave / std::sqrt(2.0));
  return best;
}

// Values that want the ends of both grids: a parabola, pairs of samples close together, noise about a curve, and a
// line whose neighbours lie on either side.
TEST(KernelElm, LooksAtTheWholeGrid) {
  const Index n = 24;
  VectorX x(n), parabola(n), pairs(n), noisy(n), line(n);
  Rng rng(21);
  for (Index i = 0; i < n; ++i) {
    x(i) = static_cast<double>(i / 2) + 0.05 * static_cast<double>(i % 2);
    parabola(i) = 0.01 * x(i) * x(i);
    pairs(i) = i % 2 == 0 ? rng.normal() : pairs(i - 1);
    noisy(i) = std::sin(x(i)) + 0.3 * rng.normal();
    line(i) = x(i) + (i % 2 == 0 ? 0.5 : -0.5);
  }
  std::set<double> lengths;
  for (const VectorX& y : {parabola, pairs, noisy, line}) {
    const auto [length, lambda] = best_of_the_grid(x, y);
    lengths.insert(length);
    ASSERT_TRUE(std::isfinite(lambda));
    const auto expected = KernelElm{.input_scaling = Scaling::none, .length_scale = length, .lambda = lambda}.fit(x, y);
    const auto found = KernelElm{.input_scaling = Scaling::none}.fit(x, y);
    EXPECT_NEAR(found.scaling().factor(0) * length, 1, 1e-9);
    for (const double at : {-1.0, 0.3, 5.5, 14.0}) {
      const Eigen::Matrix<double, 1, 1> point(at);
      EXPECT_NEAR(found.predict(point)(0), expected.predict(point)(0), 1e-6);
    }
  }
  EXPECT_EQ(lengths.size(), 4u);
  const double typical = std::sqrt(2.0) * centred(RealMatrix(x)).norm() / std::sqrt(static_cast<double>(n));
  EXPECT_NEAR(*lengths.rbegin() / typical, 8 * std::sqrt(2.0), 1e-9);
}

// Neighbouring samples of opposite sign: the mean, weighted by the samples, is best.
TEST(KernelElm, TheMeanIsWeighted) {
  VectorX x(20), y(20);
  for (Index i = 0; i < 20; ++i) {
    x(i) = static_cast<double>(i);
    y(i) = i % 2 == 0 ? 1 : -1;
  }
  const VectorX w = vernier_test::random_weights(20);
  const auto predictor = KernelElm{}.fit(x, y, {.weights = &w});
  EXPECT_EQ(predictor.alpha().norm(), 0);
  EXPECT_NEAR(predictor.predict(Eigen::Matrix<double, 1, 1>(3.0))(0), w.dot(y) / w.sum(), 1e-14);
}

// Where there is nothing to learn, the mean.
TEST(KernelElm, ConstantOutputsAndSingleSamples) {
  const Inputs x = inputs(100, 6);
  const Targets constant = Targets::Constant(100, 2, 3.25);
  EXPECT_LT(difference(KernelElm{}.fit(x, constant).predict(inputs(5, 9)), part(constant, 0, 5)), 1e-14);
  const Targets y = targets(x);
  const auto single = KernelElm{}.fit(x.topRows(1), y.topRows(1));
  EXPECT_LT((single.predict(part(x, 1, 1)) - part(y, 0, 1)).norm(), 1e-15);
}

TEST(KernelElm, ALargeFitIsDecidedByASample) {
  const Inputs x = inputs(300, 10), fresh = inputs(100, 11);
  const KernelElm recipe{.max_search_samples = 150};
  const auto predictor = recipe.fit(x, targets(x), {.seed = 3});
  EXPECT_EQ(predictor.samples(), 300);
  EXPECT_LT(difference(predictor.predict(fresh), targets(fresh)), 1e-5);
  EXPECT_TRUE(same_bits(predictor.predict(fresh), recipe.fit(x, targets(x), {.seed = 3}).predict(fresh)));
}

TEST(KernelElm, KeepsTheLaws) {
  for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines}) {
    expect_laws(KernelElm{.input_map = map, .length_scale = 1.0, .lambda = 1e-4},
                {.uses_seed = false, .weights = SampleWeights::counted});
    expect_laws(KernelElm{.input_map = map},
                {.uses_seed = false, .weights = SampleWeights::taken, .weight_tolerance = 1e-7});
  }
  expect_laws(KernelElm{.input_scaling = Scaling::standard, .max_search_samples = 30},
              {.derivative_tolerance = 1e-5, .weights = SampleWeights::taken, .weight_tolerance = 1e-7});
}

TEST(KernelPredictor, EqualsItsFormulaForBothKernels) {
  const Inputs x = inputs(37, 12), fresh = inputs(20, 13);
  const Targets alpha = targets(x);
  for (const Kernel kernel : {Kernel::squared_exponential, Kernel::matern_5_2})
    for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines}) {
      detail::KernelFeatures features(x, map, Scaling::min_max);
      features.divide(VectorX::Constant(1, 0.7));
      const KernelPredictor<3, 2> predictor(kernel, map, features.scaling, features.values, alpha, {0.1, -0.2});
      const RealMatrix features_x = seen(map, x, x), expected_k = kernels(kernel, features_x, features_x, 0.7);
      const RealMatrix expected =
          plus_row(kernels(kernel, seen(map, x, fresh), features_x, 0.7) * RealMatrix::of(alpha), {1, 2, {0.1, -0.2}});
      EXPECT_LT(difference(predictor.predict(fresh), expected), 1e-14);
      EXPECT_LT(difference(vernier_test::lower_triangle(detail::kernel_matrix(kernel, features.values)),
                           vernier_test::lower_triangle(expected_k)),
                1e-14);
      EXPECT_EQ(RealMatrix::of(predictor.alpha()), RealMatrix::of(alpha));
      EXPECT_EQ(RealMatrix(predictor.centres()), RealMatrix(features.values));
      for (Index i = 0; i < fresh.rows(); ++i) {
        const Vector3 at = point(fresh, i);
        const RealMatrix derivative = RealMatrix::of(predictor.derivative(at));
        for (int j = 0; j < 3; ++j)
          EXPECT_LT((derivative.col(j) - difference_quotient(predictor, at, j, 1e-5)).norm(), 1e-8);
      }
    }
  // at a sample the distance is zero
  const auto at_sample = KernelElm{.length_scale = 1.0, .lambda = 1e-2}.fit(x, targets(x));
  EXPECT_TRUE(at_sample.derivative(point(x, 0)).allFinite());
}

TEST(KernelPredictor, DoesNotAllocate) {
  const Inputs x = inputs(50, 14);
  const KernelElm recipe{.input_map = InputMap::sines_and_cosines, .length_scale = 1.0, .lambda = 1e-2};
  expect_no_allocations(recipe.fit(x, targets(x)));
}

TEST(KernelElm, RefusesWhatItCannotUse) {
  const Inputs x = inputs(10, 15);
  const Targets y = targets(x);
  const Inputs twice = samples_of(x, std::vector<Index>(10, 0));
  EXPECT_NE(complaint([&] {
              static_cast<void>(
                  KernelElm{.input_scaling = Scaling::none, .length_scale = 1.0, .lambda = 1e-30}.fit(twice, y));
            }).find("too small for 10 samples"),
            std::string::npos);
  EXPECT_THROW((KernelPredictor<3, 2>(Kernel::matern_5_2, InputMap::raw, {VectorX::Zero(3), VectorX::Ones(3)},
                                      MatrixX::Zero(4, 2), MatrixX::Zero(4, 2), {0, 0})),
               std::invalid_argument);
}

static_assert(Regressor<KernelElm> && Predictor<KernelPredictor<6, 3>> && !UncertainPredictor<KernelPredictor<6, 3>>);

}  // namespace
}  // namespace vernier::kernel_elm_test
