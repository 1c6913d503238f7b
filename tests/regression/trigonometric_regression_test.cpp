// SPDX-License-Identifier: BSD-3-Clause
// Products of sines and cosines: features, ridge, leave-one-out and spread against brute force; and an arm, exactly.

#include "vernier/regression/trigonometric_regression.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/detail/feature_ridge.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::trigonometric_regression_test {
namespace {

using testing::RegressorLaws;
using namespace vernier_test;

static_assert(Regressor<TrigonometricRegression> && UncertainPredictor<TrigonometricPredictor<6, 3>>);

/// One feature of one sample, in the words of the documentation; and how many angles it has.
double feature(Index f, const Vector3& x, int* degree = nullptr) {
  const std::array<Index, 3> digits{f / 9, f / 3 % 3, f % 3};
  double product = 1;
  if (degree != nullptr) *degree = 0;
  for (int j = 0; j < 3; ++j) {
    const Index digit = digits[static_cast<std::size_t>(j)];
    if (digit == 1) product *= std::sin(x(j));
    if (digit == 2) product *= std::cos(x(j));
    if (degree != nullptr && digit != 0) ++*degree;
  }
  return product;
}

/// All of them, n x 27, and the ridge of each for a growth.
RealMatrix features(const Inputs& x) {
  RealMatrix phi(x.rows(), 27);
  for (Index i = 0; i < x.rows(); ++i)
    for (Index f = 0; f < 27; ++f) phi(i, f) = feature(f, point(x, i));
  return phi;
}
RealMatrix penalties(double growth) {
  RealMatrix out(27, 1);
  for (Index f = 0; f < 27; ++f) {
    int degree = 0;
    feature(f, Vector3::Zero(), &degree);
    out(f) = degree == 0 ? 0 : std::pow(growth, degree);
  }
  return out;
}

TEST(TrigonometricRegression, KeepsTheLaws) {
  const RegressorLaws laws{.uses_seed = false, .weights = testing::SampleWeights::taken};
  expect_laws(TrigonometricRegression{}, laws);
  expect_laws(TrigonometricRegression{.max_degree = 1}, laws);
  expect_laws(TrigonometricRegression{.max_degree = 0}, laws);
  expect_laws(TrigonometricRegression{.ridge = 1e-3, .growth = 1}, laws);
  expect_laws(TrigonometricRegression{}, {.uses_seed = false, .samples = 12, .weights = testing::SampleWeights::taken});
}

TEST(TrigonometricPredictor, IsTheSumOfItsFeatures) {
  Rng rng(1);
  TrigonometricPredictor<3, 2>::Coefficients b(27, 2);
  for (double& value : elements(b)) value = rng.uniform(-1, 1);
  const TrigonometricPredictor<3, 2> predictor(b, {});
  const Inputs x = inputs(10, 2);
  EXPECT_LT((RealMatrix::of(predictor.predict(x)) - features(x) * RealMatrix::of(b)).norm(), 1e-13);
  for (Index i = 0; i < 10; ++i) {
    const Vector3 at = point(x, i);
    const auto both = predictor.predict_and_derivative(at);
    EXPECT_EQ(both.first, predictor.predict(at));
    EXPECT_EQ(both.second, predictor.derivative(at));
    for (int j = 0; j < 3; ++j) {  // the derivative of a sine is the sine a quarter of a turn on
      Vector3 quarter = at;
      quarter(j) += std::acos(-1.0) / 2;
      double expected[] = {0, 0};
      const Index place = j == 0 ? 9 : j == 1 ? 3 : 1;
      for (Index f = 0; f < 27; ++f)
        for (int o = 0; o < 2; ++o)
          if (f / place % 3 != 0) expected[o] += feature(f, quarter) * b(f, o);
      EXPECT_LT(std::hypot(both.second(0, j) - expected[0], both.second(1, j) - expected[1]), 1e-13) << "input " << j;
    }
  }
}

/// Coefficients from the normal equations with the free mean among the unknowns.
RealMatrix dense(const RealMatrix& phi, const RealMatrix& y, const RealMatrix& q, const RealMatrix& ridge) {
  const RealMatrix weighted = scaled_rows(q, phi).transpose();
  return (weighted * phi + RealMatrix::diagonal(ridge)).solve(weighted * y);
}

TEST(TrigonometricRegression, IsTheRidgeThatGrowsWithTheDegree) {
  for (const Index n : {15, 26, 27, 28, 60}) {  // fewer samples than features, and more
    const Inputs x = inputs(n, 3);
    const Targets y = targets(x, 1e-4);
    for (const bool weighted : {false, true})
      for (const double growth : {0.5, 1.0, 3.0}) {
        const VectorX q = weighted ? small_whole_weights(n, 4) : VectorX(VectorX::Ones(n));
        const double ridge = 1e-4;
        const auto predictor =
            TrigonometricRegression{.ridge = ridge, .growth = growth}.fit(x, y, {.weights = weighted ? &q : nullptr});
        const RealMatrix expected = dense(features(x), RealMatrix::of(y), q, ridge * q.sum() * penalties(growth));
        EXPECT_LT((RealMatrix::of(predictor.coefficients()) - expected).norm(), 1e-9 * expected.norm())
            << n << " samples, growth " << growth;
      }
  }
}

TEST(TrigonometricRegression, TinyRidgesAreSolvedFromTheSamples) {
  for (const Index n : {20, 200}) {
    const Inputs x = inputs(n, 5);
    const Targets y = targets(x, 1e-4);
    const RealMatrix phi = features(x);
    for (const double ridge : {1e-15, 1e-9}) {
      const RealMatrix roots = (static_cast<double>(n) * ridge * penalties(2)).sqrt();
      const RealMatrix expected = above(phi, RealMatrix::diagonal(roots)).solve(above(RealMatrix::of(y), zeros(27, 2)));
      EXPECT_LT((RealMatrix::of(TrigonometricRegression{.ridge = ridge}.fit(x, y).predict(x)) - phi * expected).norm(),
                1e-8 * y.norm());
    }
  }
}

TEST(TrigonometricRegression, LeavesHighDegreesOut) {
  const Inputs x = inputs(60, 6);
  const auto predictor = TrigonometricRegression{.max_degree = 2, .ridge = 1e-6}.fit(x, targets(x));
  for (Index f = 0; f < 27; ++f) {
    int degree = 0;
    feature(f, Vector3::Zero(), &degree);
    EXPECT_EQ(RealMatrix::of(predictor.coefficients()).row(f).largest() == 0, degree > 2) << f;
  }
  const auto mean = TrigonometricRegression{.max_degree = 0}.fit(x, targets(x));
  const RealMatrix means = column_means(RealMatrix::of(targets(x)));
  EXPECT_LT(plus_row(RealMatrix::of(mean.predict(x)), -means).norm(), 1e-14);
}

TEST(FeatureRidge, LeaveOneOutIsLeavingOneOut) {
  for (const Index n : {12, 40})
    for (const bool weighted : {false, true}) {
      const Inputs x = inputs(n, 7);
      const RealMatrix y = RealMatrix::of(targets(x, 1e-4));
      VectorX q = weighted ? small_whole_weights(n, 8) : VectorX(VectorX::Ones(n));
      if (weighted) q(0) = 0.4;  // less than a unit: it goes whole
      const RealMatrix phi = features(x), one = phi.col(0);
      const detail::FeatureRidge path(phi.block(0, 1, n, 26), y, weighted ? &q : nullptr);
      const VectorX lambdas = vernier_test::vector({1e-5, 1e-2, 10, std::numeric_limits<double>::infinity()});
      const VectorX errors = path.leave_one_out(lambdas);
      for (Index l = 0; l < lambdas.size(); ++l) {
        const bool mean = !std::isfinite(lambdas(l));
        double sum = 0;
        for (Index i = 0; i < n; ++i) {
          VectorX rest = q;
          rest(i) -= std::min(1.0, q(i));
          const RealMatrix expected = mean ? one.row(i) * dense(one, y, rest, zeros(1, 1))
                                           : phi.row(i) * dense(phi, y, rest, lambdas(l) * penalties(1));
          sum += q(i) * (y.row(i) - expected).squared_norm();
        }
        EXPECT_NEAR(errors(l), sum / q.sum(), 1e-6 * errors(l)) << n << " samples, lambda " << lambdas(l);
      }
    }
}

TEST(FeatureRidge, TheBestFitHasTheLeastError) {
  const Inputs x = inputs(40, 9);
  const Targets y = targets(x, 3e-4);
  const detail::FeatureRidge path(features(x).block(0, 1, 40, 26), y, nullptr);
  const double best = path.best_fit().lambda;
  ASSERT_TRUE(std::isfinite(best));
  const VectorX errors =
      path.leave_one_out(vernier_test::vector({best / 10, best / 3.16, best, best * 3.16, best * 10}));
  EXPECT_EQ(std::min_element(errors.begin(), errors.end()) - errors.begin(), 2);
}

// Nothing but noise: the mean alone.
TEST(TrigonometricRegression, DoesNotFollowNoise) {
  const Inputs x = inputs(40, 10), fresh = inputs(200, 11);
  Rng rng(12);
  Targets noise(40, 2);
  for (double& value : elements(noise)) value = 1e-3 * rng.normal() + 0.3;
  const auto excess = [&](const auto& predictor) {
    return (RealMatrix::of(predictor.predict(fresh)) - filled(200, 2, 0.3)).norm() / std::sqrt(400);
  };
  EXPECT_LT(excess(TrigonometricRegression{}.fit(x, noise)), 5e-4);
  EXPECT_GT(excess(TrigonometricRegression{.ridge = 1e-12}.fit(x, noise)), 1e-3);
}

// The textbook: covariance s^2 (Phi'Q Phi + ridge)^-1, the mean among the unknowns; s^2 from the residuals.
TEST(TrigonometricPredictor, StandardDeviationIsTheBayesianOne) {
  for (const Index n : {15, 60})
    for (const double ridge : {1e-2, 1e-6, 1e-14}) {
      if (n < 27 && ridge < 1e-12) continue;  // the dense inverse knows nothing there
      const Inputs x = inputs(n, 16), fresh = inputs(10, 17);
      const Targets y = targets(x, 1e-4);
      const VectorX q = small_whole_weights(n, 18);
      const auto predictor = TrigonometricRegression{.ridge = ridge}.fit(x, y, {.weights = &q});
      const RealMatrix phi = features(x), at = features(fresh), weighted = scaled_rows(q, phi).transpose();
      const RealMatrix penalty = ridge * q.sum() * penalties(2), gram = weighted * phi;
      const RealMatrix inverse = (gram + RealMatrix::diagonal(penalty)).solve(RealMatrix::identity(27));
      const double used = (inverse * gram).trace();
      const RealMatrix residual = RealMatrix::of(y) - phi * dense(phi, RealMatrix::of(y), q, penalty);
      for (int o = 0; o < 2; ++o) {
        const RealMatrix off = residual.col(o);
        const double noise = std::sqrt(off.times(off).dot(q) / (q.sum() - used));
        EXPECT_NEAR(predictor.noise()(o), noise, 1e-5 * noise);
        for (Index i = 0; i < 10; ++i) {
          const double expected = noise * std::sqrt((at.row(i) * inverse).dot(at.row(i)));
          EXPECT_NEAR(predictor.standard_deviation(point(fresh, i))(o), expected, 1e-4 * expected)
              << n << " samples, ridge " << ridge;
        }
      }
    }
}

TEST(TrigonometricPredictor, DoesNotAllocate) {
  const Inputs x = inputs(60, 19);
  expect_no_allocations(TrigonometricRegression{}.fit(x, targets(x, 1e-4)));
}

/// Position errors of an arm with geometric errors at the angles its nominal model believes in.
PointRows errors_of(const DhChain<6>& nominal, const DhChain<6>& actual, const JointRows<6>& joints) {
  PointRows out(joints.rows(), 3);
  for (Index i = 0; i < joints.rows(); ++i) {
    const JointVector<6> q = configuration(joints, i);
    set_point(out, i, actual.position(q) - nominal.position(q));
  }
  return out;
}

// Errors of geometry are exactly linear in the features: 1,000 poses without noise leave less than a nanometre of the
// millimetres at any fresh pose.
TEST(TrigonometricRegression, KnowsAnArmExactly) {
  const DhChain<6> nominal = robots::abb_irb120().chain, actual = with_geometric_errors(nominal, {}, 1);
  const OperatingRegion<6> region = abb_irb120_operating_region();
  const JointRows<6> joints = region.sample(nominal, 1000, 2), fresh = region.sample(nominal, 300, 3);
  const PointRows y = errors_of(nominal, actual, joints), expected = errors_of(nominal, actual, fresh);
  const auto lengths = [](const RealMatrix& errors) {
    RealMatrix out(errors.rows(), 1);
    for (Index i = 0; i < out.rows(); ++i) out(i) = errors.row(i).norm();
    return out;
  };
  EXPECT_GT(lengths(expected).mean(), 1e-3);
  const auto exact = TrigonometricRegression{}.fit(joints, y);
  EXPECT_LT(lengths(RealMatrix(exact.predict(fresh)) - expected).largest(), 1e-12);
}

// Samples at two angles determine a mean and a difference, whatever the number of features: two degrees of freedom are
// used, and the noise is what is left within both groups.
TEST(TrigonometricRegression, NoiseCountsWhatWasUsed) {
  VectorX x(8), y(8);
  double within = 0;
  for (Index i = 0; i < 8; ++i) {
    const double off = 0.01 * static_cast<double>(i / 2) * static_cast<double>(i / 2);  // 0 1 4 9: a mean of 3.5
    x(i) = i % 2 == 0 ? 0.3 : 1.1;
    y(i) = (i % 2 == 0 ? 1 : -2) + off;
    within += (off - 0.035) * (off - 0.035);
  }
  const Eigen::Matrix<double, 1, 1> first(0.3), second(1.1);
  for (const double ridge : {1e-15, 1e-9}) {
    const auto found = TrigonometricRegression{.ridge = ridge}.fit(x, y);
    EXPECT_NEAR(found.predict(first)(0), 1.035, 1e-6);
    EXPECT_NEAR(found.predict(second)(0), -1.965, 1e-6);
    EXPECT_NEAR(found.noise()(0), std::sqrt(within / 6), 1e-6) << ridge;
  }
}

TEST(TrigonometricRegression, SmallestProblems) {
  const Inputs one = inputs(1, 20);
  const Targets y = targets(one);
  for (const auto& recipe : {TrigonometricRegression{}, TrigonometricRegression{.ridge = 1e-4}}) {
    const auto predictor = recipe.fit(one, y);
    EXPECT_LT((predictor.predict(one) - y).norm(), 1e-15);
    EXPECT_TRUE(predictor.standard_deviation(Vector3(1, 2, 3)).allFinite());
  }
  Inputs constant = inputs(40, 21);
  for (Index i = 0; i < 40; ++i) constant(i, 1) = 0.4;
  const Targets level = Targets::Constant(40, 2, 7);
  EXPECT_LT((TrigonometricRegression{}.fit(constant, level).predict(constant) - level).norm(), 1e-12);
  const Targets varied = targets(constant);
  EXPECT_LT((TrigonometricRegression{}.fit(constant, varied).predict(constant) - varied).norm(), 1e-3);
  const std::vector<Index> twenty_times(20, 0);
  const Inputs same = samples_of(one, twenty_times);
  const Targets seen = samples_of(y, twenty_times);
  EXPECT_LT((TrigonometricRegression{}.fit(same, seen).predict(same) - seen).norm(), 1e-14);
  EXPECT_LT((TrigonometricRegression{.ridge = 1e-6}.fit(same, seen).predict(same) - seen).norm(), 1e-14);
}

TEST(TrigonometricPredictor, HasACoefficientForEachFeature) {
  EXPECT_THROW((TrigonometricPredictor<3, 2>(MatrixX::Zero(26, 2), {})), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::trigonometric_regression_test
