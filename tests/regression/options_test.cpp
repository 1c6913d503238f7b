// SPDX-License-Identifier: BSD-3-Clause
// Options of all learners: the limits of what is taken.

#include <gtest/gtest.h>

#include <initializer_list>
#include <limits>
#include <optional>
#include <type_traits>

#include "limits.hpp"
#include "vernier/regression/back_propagation.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/ensemble.hpp"
#include "vernier/regression/gaussian_process.hpp"
#include "vernier/regression/kernel_elm.hpp"
#include "vernier/regression/op_elm.hpp"
#include "vernier/regression/os_elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/regression/trigonometric_regression.hpp"
#include "vernier/regression/var_pro_elm.hpp"

namespace vernier::regression_options_test {
namespace {

using vernier_test::above;
using vernier_test::below;

/// A parabola of two inputs at eight places.
struct Samples {
  Eigen::Matrix<double, Eigen::Dynamic, 2> inputs{8, 2};
  Eigen::Matrix<double, Eigen::Dynamic, 1> targets{8};
  Samples() {
    for (Index i = 0; i < 8; ++i) {
      const double x = 0.25 * static_cast<double>(i) - 0.9, y = 0.1 * static_cast<double>(3 * i % 7);
      inputs(i, 0) = x;
      inputs(i, 1) = y;
      targets(i) = x * x + 0.5 * y;
    }
  }
};

/// What is not a number is outside wherever real numbers are asked for.
template <class Learner, class Value>
void expect_limits(const Learner& valid, Value Learner::*option, std::initializer_list<Value> inside,
                   std::initializer_list<Value> outside) {
  const Samples samples;
  const auto fit = [&](const Learner& learner) { (void)learner.fit(samples.inputs, samples.targets); };
  vernier_test::expect_limits(fit, valid, option, inside, outside);
  if constexpr (std::is_same_v<Value, double>)
    vernier_test::expect_limits(fit, valid, option, {}, {std::numeric_limits<double>::quiet_NaN()});
}

TEST(RegressionOptions, LimitsOfExtremeLearningMachines) {
  const Elm elm{.hidden_nodes = 3};
  expect_limits(elm, &Elm::hidden_nodes, {1}, {0});
  expect_limits(elm, &Elm::weight_limit, {1e-9, below(1e6)}, {0.0, 1e6});
  expect_limits(elm, &Elm::rcond, {0.0, below(1)}, {below(0), 1.0});
  const Samples samples;
  const RidgeElm ridge{.hidden_nodes = 3};
  expect_limits(ridge, &RidgeElm::hidden_nodes, {1}, {0});
  expect_limits(ridge, &RidgeElm::weight_limit, {1e-9, below(1e6)}, {0.0, 1e6});
  const OpElm op{.hidden_nodes = 3};
  expect_limits(op, &OpElm::hidden_nodes, {1}, {0});
  expect_limits(op, &OpElm::weight_limit, {1e-9, below(1e6)}, {0.0, 1e6});
  const OsElm online{.hidden_nodes = 3};
  expect_limits(online, &OsElm::hidden_nodes, {1}, {0});
  expect_limits(online, &OsElm::lambda, {1e-9}, {0.0});
  expect_limits(online, &OsElm::forgetting, {1e-9, 1.0}, {0.0, above(1)});
  const VarProElm projection{.hidden_nodes = 2, .iterations = 1};
  expect_limits(projection, &VarProElm::hidden_nodes, {1}, {0});
  expect_limits(projection, &VarProElm::ridge, {1e-9, below(1)}, {0.0, 1.0});
  expect_limits(projection, &VarProElm::iterations, {0}, {-1});
  expect_limits(projection, &VarProElm::tolerance, {0.0, below(1)}, {below(0), 1.0});
  expect_limits(projection, &VarProElm::starts, {1}, {0});
  const Ensemble<Elm> ensemble{.regressor = elm, .members = 3};
  expect_limits(ensemble, &Ensemble<Elm>::members, {2}, {1});
  expect_limits(ensemble, &Ensemble<Elm>::share, {0.5, 1.0}, {0.0, above(1)});
}

TEST(RegressionOptions, LimitsOfBackPropagation) {
  using Network = BackPropagation;
  const Network network{.hidden_nodes = 2, .training = LevenbergMarquardt{.epochs = 1}};
  expect_limits(network, &Network::hidden_nodes, {1}, {0});
  expect_limits(network, &Network::weight_limit, {1e-9, below(1e6)}, {0.0, 1e6});
  expect_limits(network, &Network::weight_decay, {0.0, below(1)}, {below(0), 1.0});
  expect_limits(network, &Network::validation_share, {0.0, 0.5}, {below(0), 1.0});
  expect_limits(network, &Network::patience, {1}, {0});
  expect_limits(network, &Network::activation, {Activation::sigmoid, Activation::tanh},
                {Activation::sine, Activation::radial_basis});
  const Samples samples;
  const auto trained = [&](const auto& training) {
    (void)Network{.hidden_nodes = 2, .training = training}.fit(samples.inputs, samples.targets);
  };
  const LevenbergMarquardt steps{.epochs = 1};
  vernier_test::expect_limits(trained, steps, &LevenbergMarquardt::epochs, {0}, {-1});
  vernier_test::expect_limits(trained, steps, &LevenbergMarquardt::tolerance, {0.0, below(1)}, {below(0), 1.0});
  const Adam adam{.epochs = 1};
  vernier_test::expect_limits(trained, adam, &Adam::epochs, {0}, {-1});
  vernier_test::expect_limits(trained, adam, &Adam::batch, {1}, {0});
  vernier_test::expect_limits(trained, adam, &Adam::learning_rate, {1e-9, below(1)}, {0.0, 1.0});
  for (const auto rate : {&Adam::momentum, &Adam::memory})
    vernier_test::expect_limits(trained, adam, rate, {0.0, below(1)}, {below(0), 1.0});
}

TEST(RegressionOptions, LimitsOfKernelsAndTrigonometricSums) {
  const KernelElm kernels{.length_scale = 1.0, .lambda = 1e-3};
  expect_limits(kernels, &KernelElm::max_search_samples, {Index{2}}, {Index{1}});
  using Optional = std::optional<double>;
  expect_limits(kernels, &KernelElm::length_scale, {Optional(1e-3)}, {Optional(0.0)});
  expect_limits(kernels, &KernelElm::lambda, {Optional(1e-3)}, {Optional(0.0)});
  const GaussianProcess process{.starts = 1, .iterations = 1};
  expect_limits(process, &GaussianProcess::starts, {1}, {0});
  expect_limits(process, &GaussianProcess::iterations, {1}, {0});
  expect_limits(process, &GaussianProcess::noise_ratio, {Optional(1e-3)}, {Optional(0.0)});
  expect_limits(process, &GaussianProcess::max_hyper_samples, {Index{2}}, {Index{1}});
  using Sum = TrigonometricRegression;
  expect_limits(Sum{}, &Sum::max_degree, {0}, {-1});
  expect_limits(Sum{}, &Sum::ridge, {Optional(1e-15), Optional(below(1e15))}, {Optional(below(1e-15)), Optional(1e15)});
  expect_limits(Sum{}, &Sum::growth, {1e-3, 1e3}, {below(1e-3), above(1e3)});
}

}  // namespace
}  // namespace vernier::regression_options_test
