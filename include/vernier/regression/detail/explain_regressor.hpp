// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a type lacks to be a `Regressor`, in one sentence for each requirement.

#include <concepts>

#include "vernier/regression/concepts.hpp"

namespace vernier::detail {

/// Does not compile for a type that is no `Predictor` of these numbers of inputs and outputs.
template <class P, int Inputs, int Outputs>
constexpr bool explain_predictor() {
  using X = Eigen::Matrix<double, Inputs, 1>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Inputs>;
  static_assert(
      requires { requires P::inputs == Inputs&& P::outputs == Outputs; },
      "Predictor: what `fit` returns needs `static constexpr int inputs, outputs`, the numbers of columns of "
      "its samples");
  static_assert(
      requires(const P& predictor, const X& x) {
        { predictor.predict(x) }
        noexcept->std::same_as<Eigen::Matrix<double, Outputs, 1>>;
      },
      "Predictor: `predict(x)` of one sample must be const and noexcept and return Eigen::Matrix<double, outputs, 1>");
  static_assert(
      requires(const P& predictor, const Rows& rows) {
        { predictor.predict(rows) } -> std::same_as<Eigen::Matrix<double, Eigen::Dynamic, Outputs>>;
      },
      "Predictor: `predict(X)` of n samples must be const and return Eigen::Matrix<double, Eigen::Dynamic, outputs>");
  static_assert(
      requires(const P& predictor, const X& x) {
        { predictor.derivative(x) }
        noexcept->std::same_as<Eigen::Matrix<double, Outputs, Inputs>>;
      },
      "Predictor: `derivative(x)` must be const and noexcept and return Eigen::Matrix<double, outputs, inputs>");
  return true;
}

/// Does not compile for a type that is no `Regressor`: each failed assertion names one requirement. The last one is for
/// requirements that have no sentence.
template <class R>
constexpr bool explain_regressor() {
  if constexpr (!Regressor<R>) {
    static_assert(std::copyable<R>, "Regressor: the recipe must be copyable");
    if constexpr (!requires {
                    typename PredictorOf<R, 6, 3>;
                    typename PredictorOf<R, 1, 1>;
                  }) {
      static_assert(
          requires {
            typename PredictorOf<R, 6, 3>;
            typename PredictorOf<R, 1, 1>;
          },
          "Regressor: `fit(X, Y, options)` must be const and take matrices of any fixed numbers of columns "
          "and vernier::FitOptions");
    } else if constexpr (explain_predictor<PredictorOf<R, 6, 3>, 6, 3>()) {
      static_assert(Regressor<R>, "Regressor: the type does not satisfy the concept");
    }
  }
  return true;
}

}  // namespace vernier::detail
