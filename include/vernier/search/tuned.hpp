#pragma once

/// @file
/// Joins the two worlds: a regressor whose inner weights a metaheuristic finds. PSO-ELM is `Tuned{Elm{}, Pso{}}`.

#include <utility>

#include "vernier/regression/concepts.hpp"
#include "vernier/search/minimize.hpp"

namespace vernier {

/// A recipe whose inner parameters can be searched for.
///
/// - `dimension(inputs)`, `box(inputs)`: of the vector a search moves
/// - `objective(X, Y)`: an `Objective` of such vectors
/// - `fit_at(X, Y, theta)`: the predictor at one of them
template <class R>
concept TunableRegressor = std::copyable<R> &&
    requires(const R& regressor, const Eigen::Matrix<double, Eigen::Dynamic, 6>& x,
             const Eigen::Matrix<double, Eigen::Dynamic, 3>& y, const VectorX& theta) {
  { regressor.dimension(6) } -> std::convertible_to<Index>;
  { regressor.box(6) } -> std::same_as<Box>;
  { regressor.objective(x, y) } -> Objective;
  { regressor.fit_at(x, y, theta) } -> Predictor;
};

/// A regressor that is fitted at the best inner parameters a search finds.
/// `const Tuned pso_elm{Elm{.hidden_nodes = 65}, Pso{.particles = 50, .iterations = 300}};`
/// @cite Feng, Dong, Jin
template <TunableRegressor R, Metaheuristic A>
struct Tuned {
  /// What is fitted.
  R regressor;
  /// What searches.
  A algorithm;
  Stop stop{};  ///< beside the algorithm's own schedule

  /// The search, then the fit at what it found. The observer of the options sees every generation, then the steps of
  /// the fit where that has some: a regressor may take the options as a fourth argument of `fit_at`.
  template <class X, class Y>
  auto fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
           const FitOptions& options = {}) const
      -> decltype(std::declval<const R&>().fit_at(inputs, targets, VectorX())) {  // known without compiling the body
    const SearchResult found =
        minimize(algorithm, regressor.objective(inputs, targets), regressor.box(X::ColsAtCompileTime), stop,
                 options.seed, options.executor, options.observer);
    if constexpr (requires { regressor.fit_at(inputs, targets, found.best, options); }) {
      const auto further = [&](const Progress& p) {
        return options.observer(Progress{found.generations + p.generation, found.evaluations + p.evaluations, p.best});
      };
      return regressor.fit_at(inputs, targets, found.best, {options.seed, options.executor, further});
    } else {
      return regressor.fit_at(inputs, targets, found.best);
    }
  }
};

/// Deduction guide, for compilers that have none for aggregates.
template <class R, class A>
Tuned(R, A) -> Tuned<R, A>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R, class A>
Tuned(R, A, Stop) -> Tuned<R, A>;

}  // namespace vernier
