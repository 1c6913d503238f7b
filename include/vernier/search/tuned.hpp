// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Hybrids: a regressor whose inner parameters a metaheuristic optimizes. PSO-ELM is `Tuned{Elm{}, Pso{}}`.

#include <utility>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/concepts.hpp"
#include "vernier/search/detail/explain_search.hpp"
#include "vernier/search/minimize.hpp"

namespace vernier {

/// A recipe whose inner parameters can be optimized.
///
/// - `dimension(inputs)`, `box(inputs)`: of the parameter vector theta
/// - `objective(X, Y)`: an `Objective` of theta
/// - `fit_at(X, Y, theta)`: the predictor at theta
template <class R>
concept TunableRegressor = std::copyable<R> &&
    requires(const R& regressor, const Eigen::Matrix<double, Eigen::Dynamic, 6>& x,
             const Eigen::Matrix<double, Eigen::Dynamic, 3>& y, const VectorX& theta) {
  { regressor.dimension(6) } -> std::convertible_to<Index>;
  { regressor.box(6) } -> std::same_as<Box>;
  { regressor.objective(x, y) } -> Objective;
  { regressor.fit_at(x, y, theta) } -> Predictor;
};

namespace detail {

/// Does not compile for a type that is no `TunableRegressor`: each failed assertion names one requirement. The last one
/// is for requirements that have no sentence.
template <class R>
constexpr bool explain_tunable_regressor() {
  if constexpr (!TunableRegressor<R>) {
    using X = Eigen::Matrix<double, Eigen::Dynamic, 6>;
    using Y = Eigen::Matrix<double, Eigen::Dynamic, 3>;
    static_assert(std::copyable<R>, "TunableRegressor: the recipe must be copyable");
    static_assert(
        requires(const R& regressor) {
          { regressor.dimension(6) } -> std::convertible_to<Index>;
        },
        "TunableRegressor: `dimension(inputs)` must be const and return the number of inner parameters");
    static_assert(
        requires(const R& regressor) {
          { regressor.box(6) } -> std::same_as<Box>;
        },
        "TunableRegressor: `box(inputs)` must be const and return vernier::Box, the bounds of the inner parameters");
    static_assert(
        requires(const R& regressor, const X& x, const Y& y) {
          { regressor.objective(x, y) } -> Objective;
        },
        "TunableRegressor: `objective(X, Y)` must be const and return a vernier::Objective of the inner parameters");
    static_assert(
        requires(const R& regressor, const X& x, const Y& y, const VectorX& theta) {
          { regressor.fit_at(x, y, theta) } -> Predictor;
        },
        "TunableRegressor: `fit_at(X, Y, theta)` must be const and return a vernier::Predictor");
    static_assert(TunableRegressor<R>, "TunableRegressor: the type does not satisfy the concept");
  }
  return true;
}

}  // namespace detail

/// A regressor fitted at the best inner parameters a search finds.
/// `const Tuned pso_elm{Elm{.hidden_nodes = 65}, Pso{.particles = 50, .iterations = 300}};`
/// @tparam R a `TunableRegressor`
/// @tparam A a `Metaheuristic`
/// @cite Feng, Dong, Jin
template <class R, class A>
struct Tuned {
  static_assert(detail::explain_tunable_regressor<R>());
  static_assert(detail::explain_metaheuristic<A>());

  /// The regressor fitted.
  R regressor;
  /// The search.
  A algorithm;
  StoppingCriteria stop{};  ///< beside the algorithm's own schedule
  Index search_samples =
      0;  ///< number of samples, drawn at random, that the search evaluates; the fit uses all. 0: all

  /// The search, then the fit at its best point. The observer of the options is called for every generation, then for
  /// the steps of the fit if it has any. `objective` may have sample weights as a third parameter, `fit_at` the options
  /// as a fourth.
  template <class X, class Y>
  auto fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
           const FitOptions& options = {}) const
      -> decltype(std::declval<const R&>().fit_at(inputs, targets, VectorX())) {  // known without compiling the body
    detail::require_samples("Tuned", inputs, targets, options);
    demand(search_samples >= 0, "Tuned: search_samples is ", search_samples, ", must not be negative");
    const SearchResult found = search_samples > 0 && search_samples < inputs.rows()
                                   ? search_part(inputs, targets, options)
                                   : search(inputs, targets, options.weights, options);
    if constexpr (requires { regressor.fit_at(inputs, targets, found.best, options); }) {
      const auto further = [&](const Progress& p) {
        return options.observer(Progress{found.generations + p.generation, found.evaluations + p.evaluations, p.best});
      };
      const FitOptions rest{options.seed, options.executor, further, options.weights};
      return regressor.fit_at(inputs, targets, found.best, rest);
    } else {
      return regressor.fit_at(inputs, targets, found.best);
    }
  }

 private:
  template <class X, class Y>
  SearchResult search(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets, const VectorX* weights,
                      const FitOptions& options) const {
    const auto at_best = [&](const auto& objective) {
      return minimize(algorithm, objective, regressor.box(X::ColsAtCompileTime), stop, options.seed, options.executor,
                      options.observer);
    };
    if constexpr (requires { regressor.objective(inputs, targets, weights); }) {
      return at_best(regressor.objective(inputs, targets, weights));
    } else {
      detail::require_no_weights("Tuned: the regressor's objective", options);
      return at_best(regressor.objective(inputs, targets));
    }
  }

  /// On rows drawn without replacement.
  template <class X, class Y>
  SearchResult search_part(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                           const FitOptions& options) const {
    std::vector<Index> rows = Rng(child_seed(options.seed, 1)).permutation(inputs.rows());
    rows.resize(static_cast<std::size_t>(search_samples));
    const Eigen::Matrix<double, Eigen::Dynamic, X::ColsAtCompileTime> x = detail::rows_of(inputs.derived(), rows);
    const Eigen::Matrix<double, Eigen::Dynamic, Y::ColsAtCompileTime> y = detail::rows_of(targets.derived(), rows);
    if (options.weights == nullptr) return search(x, y, nullptr, options);
    const VectorX weights = detail::rows_of(*options.weights, rows);
    return search(x, y, &weights, options);
  }
};

/// Deduction guide, for compilers that have none for aggregates.
template <class R, class A>
Tuned(R, A) -> Tuned<R, A>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R, class A>
Tuned(R, A, StoppingCriteria) -> Tuned<R, A>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R, class A>
Tuned(R, A, StoppingCriteria, Index) -> Tuned<R, A>;

}  // namespace vernier
