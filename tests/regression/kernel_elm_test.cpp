// Kernel sums, kernel ridge regression and its leave-one-out errors against dense algebra written out.

#include "vernier/regression/kernel_elm.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "allocation_counter.hpp"
#include "complaint.hpp"
#include "laws.hpp"
#include "regression_samples.hpp"
#include "vernier/regression/detail/kernel_ridge_path.hpp"
#include "vernier/regression/detail/kernel_system.hpp"
#include "vernier/testing/regressor_laws.hpp"

namespace vernier::kernel_elm_test {
namespace {

using testing::regressor_violations;
using testing::same_bits;
using testing::SampleWeights;
using vernier_test::complaint;
using vernier_test::no_violations;

using vernier_test::Inputs;
using vernier_test::inputs;
using vernier_test::Targets;
using vernier_test::targets;

VectorX random_weights(Index n) {
  Rng rng(5);
  VectorX w(n);
  for (auto& value : w) value = rng.uniform(0.2, 4);
  return w;
}

/// What the kernel sees, from the formulas: inputs to [-1, 1], or sines and cosines.
MatrixX seen(InputMap map, const Inputs& train, const Inputs& x) {
  if (map == InputMap::sines_and_cosines) {
    MatrixX out(x.rows(), 6);
    out << x.array().sin().matrix(), x.array().cos().matrix();
    return out;
  }
  MatrixX out = x;
  for (int j = 0; j < 3; ++j) {
    const double low = train.col(j).minCoeff(), high = train.col(j).maxCoeff();
    out.col(j) = (2 * (x.col(j).array() - low) / (high - low) - 1).matrix();
  }
  return out;
}

double kernel_of(Kernel kernel, double r) {
  if (kernel == Kernel::squared_exponential) return std::exp(-r * r / 2);
  const double s = std::sqrt(5.0) * r;
  return (1 + s + s * s / 3) * std::exp(-s);
}

MatrixX kernels(Kernel kernel, const MatrixX& a, const MatrixX& b, double length) {
  MatrixX k(a.rows(), b.rows());
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < b.rows(); ++j) k(i, j) = kernel_of(kernel, (a.row(i) - b.row(j)).norm() / length);
  return k;
}

/// Kernel ridge regression with a free mean, as one dense saddle-point system.
MatrixX dense(InputMap map, const Inputs& x, const MatrixX& y, const VectorX& weights, double length, double lambda,
              const Inputs& at) {
  const Index n = x.rows();
  const MatrixX features = seen(map, x, x);
  MatrixX system = MatrixX::Zero(n + 1, n + 1), right = MatrixX::Zero(n + 1, y.cols());
  system.topLeftCorner(n, n) = kernels(Kernel::squared_exponential, features, features, length);
  system.diagonal().head(n) += lambda * weights.cwiseInverse();
  system.col(n).head(n).setOnes();
  system.row(n).head(n).setOnes();
  right.topRows(n) = y;
  const MatrixX solution = Eigen::FullPivLU<MatrixX>(system).solve(right);
  return (kernels(Kernel::squared_exponential, seen(map, x, at), features, length) * solution.topRows(n)).rowwise() +
         solution.row(n);
}

TEST(KernelElm, EqualsADenseSolve) {
  const Inputs x = inputs(80, 1), fresh = inputs(30, 2);
  const Targets y = targets(x);
  const VectorX weights = random_weights(80);
  for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines})
    for (const double length : {0.2, 1.0, 3.0})
      for (const double lambda : {1e-4, 1e-1}) {
        const KernelElm recipe{.input_map = map, .length_scale = length, .lambda = lambda};
        const MatrixX expected = dense(map, x, y, VectorX::Ones(80), length, lambda, fresh);
        EXPECT_LT((recipe.fit(x, y).predict(fresh) - expected).cwiseAbs().maxCoeff(), 1e-10 * 1e-3);
        const MatrixX weighted = dense(map, x, y, weights, length, lambda, fresh);
        EXPECT_LT((recipe.fit(x, y, {.weights = &weights}).predict(fresh) - weighted).cwiseAbs().maxCoeff(),
                  1e-10 * 1e-3);
        EXPECT_GT((weighted - expected).cwiseAbs().maxCoeff(), 1e-8);
      }
}

// One sample of each side by hand: K = [1 k; k 1], alpha = +-d / (2 (1 + lambda - k)).
TEST(KernelElm, TwoSamplesByHand) {
  const Eigen::Matrix<double, Eigen::Dynamic, 1> x = Eigen::Vector2d(-1, 1), y = Eigen::Vector2d(2, 3);
  const auto predictor = KernelElm{.length_scale = 2.0, .lambda = 0.5}.fit(x, y);
  const double k = std::exp(-0.5), alpha = 0.5 / (1.5 - k);
  EXPECT_NEAR(predictor.mean()(0), 2.5, 1e-15);
  EXPECT_NEAR(predictor.alpha()(1), alpha, 1e-15);
  EXPECT_NEAR(predictor.predict(Eigen::Matrix<double, 1, 1>(1.0))(0), 2.5 + alpha * (1 - k), 1e-15);
  EXPECT_NEAR(predictor.derivative(Eigen::Matrix<double, 1, 1>(0.0))(0), alpha * 2 * 0.25 * std::exp(-0.125), 1e-15);
}

TEST(KernelElm, OneSampleIsPredictedEverywhere) {
  const Eigen::Matrix<double, Eigen::Dynamic, 1> x = VectorX::Constant(1, 0.3), y = VectorX::Constant(1, 7);
  const VectorX weights = VectorX::Constant(1, 4);
  const auto predictor = KernelElm{}.fit(x, y, {.weights = &weights});
  EXPECT_NEAR(predictor.predict(Eigen::Matrix<double, 1, 1>(-2.0))(0), 7, 1e-14);
}

TEST(KernelElm, LeaveOneOutErrorsEqualFitsWithoutTheSample) {
  const Index n = 25;
  const Inputs x = inputs(n, 3);
  const Targets y = targets(x, 1e-4);
  const VectorX weights = random_weights(n);
  const MatrixX features = seen(InputMap::sines_and_cosines, x, x);
  const detail::KernelRidgePath path(detail::kernel_matrix(Kernel::squared_exponential, features), y, weights);
  for (const double lambda : {1e-3, 1e-1, 1e3, std::numeric_limits<double>::infinity()}) {
    const MatrixX residuals = path.leave_one_out_residuals(lambda);
    double error = 0;
    for (Index left = 0; left < n; ++left) {
      std::vector<Index> rest;
      for (Index i = 0; i < n; ++i)
        if (i != left) rest.push_back(i);
      const Inputs others = x(rest, Eigen::all), at = x.row(left);
      const MatrixX t = y(rest, Eigen::all);
      const VectorX w = weights(rest);
      const MatrixX expected =
          y.row(left) - (std::isfinite(lambda) ? dense(InputMap::sines_and_cosines, others, t, w, 1, lambda, at)
                                               : MatrixX(w.transpose() * t / w.sum()));
      EXPECT_LT((residuals.row(left) - expected).cwiseAbs().maxCoeff(), 1e-9 * y.cwiseAbs().maxCoeff());
      error += weights(left) * expected.squaredNorm();
    }
    EXPECT_NEAR(path.leave_one_out_error(lambda), error / weights.sum(), 1e-7 * error);
  }
}

// What is chosen has the least error left out of all that could have been, and predicts well.
TEST(KernelElm, ChoosesByLeaveOneOut) {
  const Inputs x = inputs(150, 4), fresh = inputs(200, 5);
  const Targets y = targets(x, 2e-5), truth = targets(fresh);
  const auto rms = [&](const KernelElm& recipe) {
    return std::sqrt((recipe.fit(x, y).predict(fresh) - truth).squaredNorm() / 200);
  };
  const double chosen = rms({});
  EXPECT_LT(chosen, 4e-5);
  double best = 1;
  for (const double length : {0.25, 0.5, 1.0, 2.0, 4.0})
    for (const double lambda : {1e-8, 1e-6, 1e-4, 1e-2, 1.0})
      best = std::min(best, rms({.length_scale = length, .lambda = lambda}));
  EXPECT_LT(chosen, 1.2 * best);
  EXPECT_LT(rms({.lambda = 1e-3}), 2 * best);
  EXPECT_LT(rms({.length_scale = 1.0}), 1.2 * best);
}

// Where there is nothing to learn, the mean.
TEST(KernelElm, NoiseAloneGivesTheMean) {
  const Inputs x = inputs(100, 6);
  Rng rng(7);
  Targets y(100, 2);
  for (auto& value : y.reshaped()) value = 5 + rng.normal();
  const auto predictor = KernelElm{}.fit(x, y);
  const MatrixX off = predictor.predict(inputs(50, 8)).rowwise() - y.colwise().mean();
  EXPECT_LT(std::sqrt(off.squaredNorm() / 100), 0.2);
  const Targets constant = Targets::Constant(100, 2, 3.25);
  EXPECT_LT((KernelElm{}.fit(x, constant).predict(inputs(5, 9)).array() - 3.25).abs().maxCoeff(), 1e-14);
  EXPECT_LT((KernelElm{}.fit(x.topRows(1), y.topRows(1)).predict(x.row(1).eval()) - y.row(0)).norm(), 1e-15);
}

TEST(KernelElm, ALargeFitIsDecidedByASample) {
  const Inputs x = inputs(300, 10), fresh = inputs(100, 11);
  const KernelElm recipe{.max_search_samples = 150};
  const auto predictor = recipe.fit(x, targets(x), {.seed = 3});
  EXPECT_EQ(predictor.samples(), 300);
  EXPECT_LT((predictor.predict(fresh) - targets(fresh)).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_TRUE(same_bits(predictor.predict(fresh), recipe.fit(x, targets(x), {.seed = 3}).predict(fresh)));
}

TEST(KernelElm, KeepsTheLaws) {
  for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines}) {
    EXPECT_TRUE(no_violations(regressor_violations(KernelElm{.input_map = map, .length_scale = 1.0, .lambda = 1e-4},
                                                   {.uses_seed = false, .weights = SampleWeights::counted})));
    EXPECT_TRUE(no_violations(regressor_violations(
        KernelElm{.input_map = map}, {.uses_seed = false, .weights = SampleWeights::taken, .weight_tolerance = 1e-7})));
  }
  EXPECT_TRUE(no_violations(
      regressor_violations(KernelElm{.input_scaling = Scaling::standard, .max_search_samples = 30},
                           {.derivative_tolerance = 1e-5, .weights = SampleWeights::taken, .weight_tolerance = 1e-7})));
}

TEST(KernelPredictor, EqualsItsFormulaForBothKernels) {
  const Inputs x = inputs(37, 12), fresh = inputs(20, 13);
  const MatrixX alpha = targets(x);
  for (const Kernel kernel : {Kernel::squared_exponential, Kernel::matern_5_2})
    for (const InputMap map : {InputMap::raw, InputMap::sines_and_cosines}) {
      detail::KernelFeatures features(x, map, Scaling::min_max);
      features.divide(VectorX::Constant(1, 0.7));
      const KernelPredictor<3, 2> predictor(kernel, map, features.scaling, features.values, alpha, {0.1, -0.2});
      const MatrixX expected = (kernels(kernel, seen(map, x, fresh), seen(map, x, x), 0.7) * alpha).rowwise() +
                               Eigen::RowVector2d(0.1, -0.2);
      EXPECT_LT((predictor.predict(fresh) - expected).cwiseAbs().maxCoeff(), 1e-14);
      EXPECT_LT((MatrixX(detail::kernel_matrix(kernel, features.values).selfadjointView<Eigen::Lower>()) -
                 kernels(kernel, seen(map, x, x), seen(map, x, x), 0.7))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-14);
      EXPECT_LT((predictor.alpha() - alpha).norm() + (predictor.centres() - features.values).norm(), 1e-300);
      constexpr double step = 1e-5;
      for (Index i = 0; i < fresh.rows(); ++i)
        for (int j = 0; j < 3; ++j) {
          const Vector3 at = fresh.row(i).transpose(), along = step * Vector3::Unit(j);
          EXPECT_LT((predictor.derivative(at).col(j) -
                     (predictor.predict(at + along) - predictor.predict(at - along)) / (2 * step))
                        .norm(),
                    1e-8);
        }
    }
  // at a sample the distance is zero
  const auto at_sample = KernelElm{.length_scale = 1.0, .lambda = 1e-2}.fit(x, targets(x));
  EXPECT_TRUE(at_sample.derivative(x.row(0).transpose()).allFinite());
}

TEST(KernelPredictor, DoesNotAllocate) {
  const Inputs x = inputs(50, 14);
  const auto predictor =
      KernelElm{.input_map = InputMap::sines_and_cosines, .length_scale = 1.0, .lambda = 1e-2}.fit(x, targets(x));
  const Vector3 at(0.1, 0.2, 0.3);
  EXPECT_EQ(vernier_test::allocations([&] {
              vernier_test::keep(predictor.predict(at));
              vernier_test::keep(predictor.derivative(at));
            }),
            0);
}

TEST(KernelElm, RefusesWhatItCannotUse) {
  const Inputs x = inputs(10, 15);
  const Targets y = targets(x);
  EXPECT_NE(complaint([&] { static_cast<void>(KernelElm{.length_scale = 0.0}.fit(x, y)); }).find("length_scale is 0"),
            std::string::npos);
  EXPECT_NE(complaint([&] { static_cast<void>(KernelElm{.lambda = -1.0}.fit(x, y)); }).find("lambda is -1"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              static_cast<void>(KernelElm{.max_search_samples = 1}.fit(x, y));
            }).find("max_search_samples is 1"),
            std::string::npos);
  const Inputs twice = x.row(0).replicate(10, 1);
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
