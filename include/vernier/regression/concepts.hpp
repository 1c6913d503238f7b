// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Recipes that learn a map from samples, and the fitted maps.

#include <concepts>

#include "vernier/core/check.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A fitted map from `P::inputs` to `P::outputs` real numbers, both compile-time constants.
///
/// - `predict(x)`: one sample, a column; does not allocate or throw
/// - `predict(X)`: n x inputs to n x outputs; row i equals `predict` of row i
/// - `derivative(x)`: outputs x inputs, the exact derivative at x; does not allocate or throw
template <class P>
concept Predictor = requires(const P& predictor, const Eigen::Matrix<double, P::inputs, 1>& x,
                             const Eigen::Matrix<double, Eigen::Dynamic, P::inputs>& rows) {
  { predictor.predict(x) }
  noexcept->std::same_as<Eigen::Matrix<double, P::outputs, 1>>;
  { predictor.predict(rows) } -> std::same_as<Eigen::Matrix<double, Eigen::Dynamic, P::outputs>>;
  { predictor.derivative(x) }
  noexcept->std::same_as<Eigen::Matrix<double, P::outputs, P::inputs>>;
};

/// A predictor with standard deviations.
///
/// - `standard_deviation(x)`: of each predicted output, without the noise of a new measurement; does not throw
template <class P>
concept UncertainPredictor = Predictor<P> &&
    requires(const P& predictor, const Eigen::Matrix<double, P::inputs, 1>& x) {
  { predictor.standard_deviation(x) }
  noexcept->std::same_as<Eigen::Matrix<double, P::outputs, 1>>;
};

/// The type that `R::fit` returns for these numbers of inputs and outputs.
template <class R, int Inputs, int Outputs>
using PredictorOf = decltype(std::declval<const R&>().fit(
    std::declval<const Eigen::Matrix<double, Eigen::Dynamic, Inputs>&>(),
    std::declval<const Eigen::Matrix<double, Eigen::Dynamic, Outputs>&>(), std::declval<const FitOptions&>()));

/// A recipe: `fit(X, Y, options)` is const and returns a fitted `Predictor`. X is n x inputs, Y n x
/// outputs, one sample a row; the numbers of columns are compile-time constants of any size. Same seed, same bits.
template <class R>
concept Regressor = std::copyable<R> && Predictor<PredictorOf<R, 6, 3>> && Predictor<PredictorOf<R, 1, 1>> &&
                    (PredictorOf<R, 6, 3>::inputs == 6) &&
                    (PredictorOf<R, 6, 3>::outputs == 3);

namespace detail {

struct RunTimeFit;  // fits recipes to matrices whose numbers of columns are known at run time

/// A column vector of a predictor's inputs, known at compile time.
template <class Derived, int Inputs>
concept SampleOf = (Derived::ColsAtCompileTime == 1 && Derived::RowsAtCompileTime == Inputs);

/// Samples as rows.
template <class Derived, int Inputs>
concept SampleRowsOf = (Derived::ColsAtCompileTime == Inputs && !SampleOf<Derived, Inputs>);

/// Throws `std::invalid_argument` for unusable samples or weights.
VERNIER_API void check_samples(const char* caller, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                               const VectorX* weights);

/// The checks every `fit` makes of its samples.
template <class X, class Y>
void require_samples(const char* caller, const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                     const FitOptions& options = {}) {
  static_assert(
      X::ColsAtCompileTime != Eigen::Dynamic && Y::ColsAtCompileTime != Eigen::Dynamic,
      "the numbers of inputs and outputs are compile-time constants: pass matrices with fixed numbers of columns");
  check_samples(caller, inputs.derived(), targets.derived(), options.weights);
}

/// The weights of n samples; ones where there are none.
VERNIER_API VectorX weights_or_ones(const VectorX* weights, Index n);

/// For recipes that have no use for weights.
VERNIER_API void require_no_weights(const char* caller, const FitOptions& options);

}  // namespace detail
}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/concepts.ipp"
#endif
