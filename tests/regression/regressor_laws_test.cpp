// SPDX-License-Identifier: BSD-3-Clause
// Every model through the laws of its concept, and the laws against planted faults.

#include "vernier/testing/regressor_laws.hpp"

#include <gtest/gtest.h>

#include "regression_samples.hpp"
#include "regressor_checks.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/regression/var_pro_elm.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"

namespace vernier::regressor_laws_test {
namespace {

using testing::regressor_violations;
using testing::RegressorLaws;
using testing::SampleWeights;
using namespace vernier_test;

constexpr RegressorLaws taken{.weights = SampleWeights::taken}, counted{.weights = SampleWeights::counted};

TEST(RegressorLaws, ElmWithEachActivationAndInputMap) {
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps)
      expect_laws(Elm{.hidden_nodes = 9, .activation = activation, .input_map = input_map}, counted);
}

TEST(RegressorLaws, ElmWithEachScalingAndMoreNodesThanSamples) {
  for (const Scaling scaling : {Scaling::none, Scaling::min_max, Scaling::standard})
    expect_laws(Elm{.hidden_nodes = 9, .input_scaling = scaling, .target_scaling = scaling}, taken);
  expect_laws(Elm{.hidden_nodes = 80, .rcond = 1e-8}, taken);
}

TEST(RegressorLaws, RidgeElmWithEachActivationAndInputMap) {
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps)
      expect_laws(RidgeElm{.hidden_nodes = 9, .activation = activation, .input_map = input_map}, taken);
  expect_laws(RidgeElm{.hidden_nodes = 80}, taken);
}

TEST(RegressorLaws, VarProElmWithEachActivationAndInputMap) {
  for (const Activation activation : activations)
    for (const InputMap input_map : input_maps)
      expect_laws(VarProElm{.hidden_nodes = 9, .activation = activation, .input_map = input_map, .iterations = 8},
                  taken);
  expect_laws(VarProElm{.hidden_nodes = 80, .ridge = 1e-6, .iterations = 3}, taken);
  const RegressorLaws repeated{.weights = SampleWeights::counted, .weight_tolerance = 1e-6};  // rounding is trained on
  expect_laws(VarProElm{.hidden_nodes = 4, .iterations = 5, .starts = 3}, repeated);
}

TEST(RegressorLaws, TunedElm) {
  const Pso pso{.particles = 6, .iterations = 4};
  const GeneticAlgorithm ga{.individuals = 6, .generations = 4};
  expect_laws(Tuned{Elm{.hidden_nodes = 5}, pso}, taken);
  expect_laws(Tuned{Elm{.hidden_nodes = 5}, ga}, taken);
  expect_laws(Tuned{RidgeElm{.hidden_nodes = 5}, pso}, taken);
  expect_laws(Tuned{VarProElm{.hidden_nodes = 5, .iterations = 4}, pso}, taken);
}

/// A user's own: y = A x + b by least squares, no randomness; and the base of the faults below.
template <int Inputs, int Outputs>
struct LinearMap {
  static constexpr int inputs = Inputs;
  static constexpr int outputs = Outputs;
  Eigen::Matrix<double, Outputs, Inputs> a;
  Eigen::Matrix<double, Outputs, 1> b;
  bool calls_count = false, wrong_rows = false;
  double slope_error = 0, deviation = 1e-3;
  mutable int calls = 0;

  Eigen::Matrix<double, Outputs, 1> predict(const Eigen::Matrix<double, Inputs, 1>& x) const noexcept {
    Eigen::Matrix<double, Outputs, 1> y = b;
    for (int i = 0; i < Inputs; ++i)
      for (int o = 0; o < Outputs; ++o) y(o) += a(o, i) * x(i);
    if (calls_count) y(0) += 1e-9 * ++calls;
    return y;
  }
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> predict(
      const Eigen::Matrix<double, Eigen::Dynamic, Inputs>& rows) const {
    Eigen::Matrix<double, Eigen::Dynamic, Outputs> y(rows.rows(), Outputs);
    for (Index r = 0; r < rows.rows(); ++r)
      for (int o = 0; o < Outputs; ++o) {
        y(r, o) = b(o);
        for (int i = 0; i < Inputs; ++i) y(r, o) += a(o, i) * rows(r, i);
        if (wrong_rows && r == 3) y(r, o) *= 1 + 1e-9;
      }
    return y;
  }
  Eigen::Matrix<double, Outputs, Inputs> derivative(const Eigen::Matrix<double, Inputs, 1>&) const noexcept {
    return a * (1 + slope_error);
  }
  Eigen::Matrix<double, Outputs, 1> standard_deviation(const Eigen::Matrix<double, Inputs, 1>&) const noexcept {
    return Eigen::Matrix<double, Outputs, 1>::Constant(calls_count ? deviation * ++calls : deviation);
  }
};

enum class Fault {
  none,
  call_order,
  rows_differ,
  derivative,
  changes_inputs,
  changes_targets,
  ignores_rows,
  throws_something_else,
  remembers_fits,
  asks_executor,
  ignores_weights,
  ignores_usable_weights,
  takes_any_weights,
  scales_with_weights,
  changes_weights,
  squares_weights,
  negative_deviation,
  infinite_deviation,
};

struct Linear {
  Fault fault = Fault::none;
  bool uses_seed = false;
  mutable int fits = 0;

  template <int Inputs, int Outputs>
  LinearMap<Inputs, Outputs> fit(const Eigen::Matrix<double, Eigen::Dynamic, Inputs>& x,
                                 const Eigen::Matrix<double, Eigen::Dynamic, Outputs>& y,
                                 const FitOptions& options = {}) const {
    if (fault == Fault::throws_something_else && x.rows() != y.rows()) throw std::runtime_error("rows");
    const bool any_weights = fault == Fault::takes_any_weights || fault == Fault::ignores_weights;
    if (fault != Fault::ignores_rows) {
      any_weights ? detail::require_samples("Linear", x, y) : detail::require_samples("Linear", x, y, options);
    }
    const Index n = std::min(x.rows(), y.rows());
    const RealMatrix h = with_ones(top(RealMatrix::of(x), n));
    RealMatrix root = vernier_test::filled(n, 1, 1);
    if (options.weights != nullptr && fault != Fault::ignores_weights && fault != Fault::ignores_usable_weights) {
      for (Index i = 0; i < std::min(n, options.weights->size()); ++i) {
        const double weight = (*options.weights)(i);
        root(i) = fault == Fault::squares_weights ? weight : std::sqrt(std::abs(weight));
      }
      if (fault == Fault::changes_weights) const_cast<double&>((*options.weights)(0)) += 1e-9;
    }
    RealMatrix solution = scaled_rows(root, h).solve(scaled_rows(root, top(RealMatrix::of(y), n)));
    if (fault == Fault::scales_with_weights && options.weights != nullptr) solution *= 1 + 1e-6;
    LinearMap<Inputs, Outputs> map;
    for (int o = 0; o < Outputs; ++o) {
      for (int i = 0; i < Inputs; ++i) map.a(o, i) = solution(i, o);
      map.b(o) = solution(Inputs, o);
    }
    if (uses_seed)
      for (double& value : map.b) value += 1e-6 * Rng(options.seed).uniform();
    map.calls_count = fault == Fault::call_order;
    map.wrong_rows = fault == Fault::rows_differ;
    map.slope_error = fault == Fault::derivative ? 1e-5 : 0;
    if (fault == Fault::negative_deviation) map.deviation = -1e-3;
    if (fault == Fault::infinite_deviation) map.deviation = std::numeric_limits<double>::infinity();
    if (fault == Fault::changes_inputs) const_cast<double&>(x(0, 0)) += 1e-9;
    if (fault == Fault::changes_targets) const_cast<double&>(y(0, 0)) += 1e-9;
    if (fault == Fault::remembers_fits) map.b(0) += 1e-9 * fits++;
    if (fault == Fault::asks_executor) {
      double parts = 0;
      options.executor.for_ranges(2, [&](Index begin, Index) {
        if (begin > 0) parts = 1;
      });
      map.b(0) += 1e-9 * parts;
    }
    return map;
  }
};

/// Keeps a pointer to its samples: right for as long as they live unchanged.
template <int Inputs, int Outputs>
struct NearestMap {
  static constexpr int inputs = Inputs;
  static constexpr int outputs = Outputs;
  const Eigen::Matrix<double, Eigen::Dynamic, Outputs>* y;

  Eigen::Matrix<double, Outputs, 1> predict(const Eigen::Matrix<double, Inputs, 1>&) const noexcept {
    return y->row(0).transpose();
  }
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> predict(
      const Eigen::Matrix<double, Eigen::Dynamic, Inputs>& rows) const {
    return y->row(0).replicate(rows.rows(), 1);
  }
  Eigen::Matrix<double, Outputs, Inputs> derivative(const Eigen::Matrix<double, Inputs, 1>&) const noexcept {
    return Eigen::Matrix<double, Outputs, Inputs>::Zero();
  }
};
struct Nearest {
  template <int Inputs, int Outputs>
  NearestMap<Inputs, Outputs> fit(const Eigen::Matrix<double, Eigen::Dynamic, Inputs>& x,
                                  const Eigen::Matrix<double, Eigen::Dynamic, Outputs>& y,
                                  const FitOptions& = {}) const {
    detail::require_samples("Nearest", x, y);
    return {&y};
  }
};

/// An ELM that forgets to pass the seed on.
struct SeedlessElm {
  template <class X, class Y>
  auto fit(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y, const FitOptions& = {}) const {
    return Elm{.hidden_nodes = 5}.fit(x, y, {.seed = 1});
  }
};

static_assert(Regressor<Elm> && Regressor<RidgeElm> && Regressor<VarProElm> && Regressor<Linear> &&
              Regressor<Nearest> && Regressor<SeedlessElm>);
static_assert(Regressor<Tuned<Elm, Pso>> && Regressor<Tuned<RidgeElm, GeneticAlgorithm>>);
static_assert(TunableRegressor<Elm> && TunableRegressor<RidgeElm> && TunableRegressor<VarProElm>);
static_assert(!TunableRegressor<Linear>, "nothing to search for");
static_assert(UncertainPredictor<LinearMap<3, 2>> && !UncertainPredictor<ElmPredictor<6, 3>>);
static_assert(Predictor<ElmPredictor<6, 3>> && Predictor<ElmPredictor<1, 1>> && Predictor<LinearMap<3, 2>>);

/// Near misses of the concepts.
struct ThrowingMap : LinearMap<3, 2> {
  using LinearMap<3, 2>::predict;
  Eigen::Vector2d predict(const Vector3& x) const { return LinearMap<3, 2>::predict(x); }  // not noexcept
};
struct NoDerivative {
  static constexpr int inputs = 3;
  static constexpr int outputs = 2;
  Eigen::Vector2d predict(const Vector3&) const noexcept;
  Eigen::Matrix<double, Eigen::Dynamic, 2> predict(const Eigen::Matrix<double, Eigen::Dynamic, 3>&) const;
};
struct FitNotConst {
  template <class X, class Y>
  auto fit(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y, const FitOptions& options) {
    return Elm{}.fit(x, y, options);
  }
};
struct FitGivesNothing {
  template <class X, class Y>
  void fit(const Eigen::MatrixBase<X>&, const Eigen::MatrixBase<Y>&, const FitOptions&) const {}
};
static_assert(!Predictor<ThrowingMap> && !Predictor<NoDerivative> && !Predictor<int>);
static_assert(!Regressor<FitNotConst> && !Regressor<FitGivesNothing> && !Regressor<Pso> && !Regressor<int>);

TEST(RegressorLaws, UsersOwnRegressor) {
  expect_laws(Linear{}, {.uses_seed = false, .weights = SampleWeights::counted});
  expect_laws(Linear{.uses_seed = true}, counted);
  expect_laws(Linear{}, {.uses_seed = false, .weights = SampleWeights::counted, .weight_tolerance = 1e-12});
}

void expect_caught(Fault fault, const char* sentence) {
  const auto violations =
      regressor_violations(Linear{.fault = fault}, {.uses_seed = false, .weights = SampleWeights::counted});
  EXPECT_TRUE(mentions(violations, sentence)) << sentence << no_violations(violations).message();
}

TEST(RegressorLaws, CatchPlantedFaults) {
  expect_caught(Fault::call_order, "predictions depend on the order of the calls");
  expect_caught(Fault::rows_differ, "predict(rows) differs from predict(sample)");
  expect_caught(Fault::derivative, "derivative differs from central differences");
  expect_caught(Fault::changes_inputs, "fit changed its samples");
  expect_caught(Fault::changes_targets, "fit changed its samples");
  expect_caught(Fault::ignores_rows, "mismatched rows did not throw");
  expect_caught(Fault::throws_something_else, "something other than std::invalid_argument");
  expect_caught(Fault::remembers_fits, "the same seed gave another predictor");
  expect_caught(Fault::asks_executor, "with an executor of 2 threads");
}

TEST(RegressorLaws, CatchFaultsOfWeights) {
  expect_caught(Fault::ignores_weights, "the weights are ignored");
  expect_caught(Fault::ignores_usable_weights, "the weights are ignored");
  for (const char* sentence :
       {"too many weights did not throw", "too few weights did not throw", "a weight of zero did not throw",
        "a negative weight did not throw", "a weight that is no number did not throw"})
    expect_caught(Fault::takes_any_weights, sentence);
  expect_caught(Fault::scales_with_weights, "weights of all one make a difference");
  expect_caught(Fault::changes_weights, "fit changed its weights");
  expect_caught(Fault::squares_weights, "integer weights differ from repeated samples");
  // Who claims less is not told off for less, who claims to refuse is.
  expect_laws(Linear{.fault = Fault::squares_weights}, {.uses_seed = false, .weights = SampleWeights::taken});
  EXPECT_TRUE(mentions(regressor_violations(Linear{}, {.uses_seed = false, .weights = SampleWeights::refused}),
                       "claims not to take did not throw"));
}

TEST(RegressorLaws, CatchFaultsOfStandardDeviations) {
  expect_caught(Fault::negative_deviation, "a standard deviation is negative or not finite");
  expect_caught(Fault::infinite_deviation, "a standard deviation is negative or not finite");
  expect_caught(Fault::call_order, "the standard deviations of a copy are others");
}

TEST(RegressorLaws, CatchFaultsOfSeedAndLifetime) {
  EXPECT_TRUE(mentions(regressor_violations(SeedlessElm{}), "another seed gave the same predictor"));
  EXPECT_TRUE(mentions(regressor_violations(Elm{.hidden_nodes = 5}, {.uses_seed = false}), "the seed matters"));
  EXPECT_TRUE(mentions(regressor_violations(Nearest{}, {.uses_seed = false}), "the predictor refers to the samples"));
}

// Each fault is one violation for either pair of sizes, not an avalanche.
TEST(RegressorLaws, NameOnlyWhatIsWrong) {
  EXPECT_EQ(
      regressor_violations(Linear{.fault = Fault::derivative}, {.uses_seed = false, .weights = SampleWeights::counted})
          .size(),
      2u);
  EXPECT_EQ(regressor_violations(Linear{.fault = Fault::ignores_usable_weights},
                                 {.uses_seed = false, .weights = SampleWeights::taken})
                .size(),
            2u);
  EXPECT_THROW(regressor_violations(Linear{}, {.samples = 1}), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::regressor_laws_test
