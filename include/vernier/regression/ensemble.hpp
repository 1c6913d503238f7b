// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Bagging: many fits of one recipe on resampled data, their mean, and their spread.

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/detail/explain_regressor.hpp"
#include "vernier/regression/detail/predictor_interface.hpp"

namespace vernier {

/// Fitted members and their mean.
template <Predictor P>
class EnsemblePredictor : public detail::PredictorInterface<EnsemblePredictor<P>, P::inputs, P::outputs> {
  using Base = detail::PredictorInterface<EnsemblePredictor<P>, P::inputs, P::outputs>;

 public:
  using typename Base::Input;
  using typename Base::Output;
  using typename Base::Slope;

  /// @param members at least one
  explicit EnsemblePredictor(std::vector<P> members) : members_(std::move(members)) {
    demand(!members_.empty(), "EnsemblePredictor: no members");
  }

  /// The mean of the members' predictions, and where `slope` is not null that of their derivatives.
  void evaluate(const Input& x, Output& y, Slope* slope) const noexcept {
    const double n = static_cast<double>(members_.size());
    y.setZero();
    for (const P& member : members_) y += member.predict(x);
    y /= n;
    if (slope == nullptr) return;
    slope->setZero();
    for (const P& member : members_) *slope += member.derivative(x);
    *slope /= n;
  }

  /// Standard deviation of the members' predictions: the variability due to the choice of samples and the start of the
  /// fit, without errors that all members have in common. Zero for one member.
  template <class Derived>
    requires detail::SampleOf<Derived, P::inputs> Output standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Input at = x;
    const Output mean = this->predict(at);
    Output square = Output::Zero();
    for (const P& member : members_) square += (member.predict(at) - mean).cwiseAbs2();
    return (square / static_cast<double>(std::max<std::size_t>(members_.size() - 1, 1))).cwiseSqrt();
  }

  /// The members.
  const std::vector<P>& members() const { return members_; }

 private:
  std::vector<P> members_;
};

namespace detail {

/// Rows of a resampled data set of n rows, ascending.
VERNIER_API std::vector<Index> draw_rows(Index n, double share, bool replacement, std::uint64_t seed);

}  // namespace detail

/// Bagging: `members` fits of one recipe, each with a seed of its own on samples of its own. The executor fits
/// members in parallel, each on one thread.
/// `Ensemble{RidgeElm{}, 20}`
/// @cite Breiman 1996
/// @tparam R a `Regressor`
template <class R>
struct Ensemble {
  static_assert(detail::explain_regressor<R>());

  /// The recipe of the members.
  R regressor;
  int members = 20;  ///< at least 2
  /// Size of a member's sample, of n; in (0, 1].
  double share = 1;
  /// Whether rows are drawn with replacement: the bootstrap. A leave-one-out error is then too low, as
  /// copies of the row left out often remain; recipes that choose a ridge by it do better without replacement, at a
  /// share of 0.6. Without replacement and at a share of 1 members differ by their seeds alone.
  bool replacement = true;

  /// Rows are drawn regardless of their weights, which are passed to the recipe.
  /// The observer is called with the number of fitted members as generations and 0 as the best value; where it stops
  /// the fit, the ensemble is those, and which depends on the executor.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options seed, executor, observer, weights
  template <class X, class Y>
  EnsemblePredictor<PredictorOf<R, X::ColsAtCompileTime, Y::ColsAtCompileTime>> fit(
      const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets, const FitOptions& options = {}) const {
    using Member = PredictorOf<R, X::ColsAtCompileTime, Y::ColsAtCompileTime>;
    demand(members >= 2, "Ensemble: members is ", members, ", must be at least 2");
    demand(share > 0 && share <= 1, "Ensemble: share is ", share, ", must lie in (0, 1]");
    detail::require_samples("Ensemble", inputs, targets, options);

    std::vector<std::optional<Member>> fitted(static_cast<std::size_t>(members));
    std::mutex guard;
    Index done = 0;
    bool go_on = true;
    options.executor.for_ranges(members, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) {
        {
          const std::scoped_lock lock(guard);
          if (!go_on) return;
        }
        const auto stream = 2 * static_cast<std::uint64_t>(k);
        const std::vector<Index> rows =
            detail::draw_rows(inputs.rows(), share, replacement, child_seed(options.seed, stream));
        VectorX weights;
        FitOptions own{.seed = child_seed(options.seed, stream + 1)};
        if (options.weights != nullptr) {
          weights = detail::rows_of(*options.weights, rows);
          own.weights = &weights;
        }
        const Eigen::Matrix<double, Eigen::Dynamic, X::ColsAtCompileTime> x = detail::rows_of(inputs.derived(), rows);
        const Eigen::Matrix<double, Eigen::Dynamic, Y::ColsAtCompileTime> y = detail::rows_of(targets.derived(), rows);
        fitted[static_cast<std::size_t>(k)].emplace(regressor.fit(x, y, own));
        const std::scoped_lock lock(guard);
        ++done;
        go_on = options.observer(Progress{done, done, 0}) && go_on;
      }
    });
    std::vector<Member> there;
    there.reserve(fitted.size());
    for (std::optional<Member>& member : fitted)
      if (member) there.push_back(std::move(*member));
    return EnsemblePredictor<Member>(std::move(there));
  }
};

/// Deduction guide, for compilers that have none for aggregates.
template <class R>
Ensemble(R) -> Ensemble<R>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R>
Ensemble(R, int) -> Ensemble<R>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R>
Ensemble(R, int, double) -> Ensemble<R>;
/// Deduction guide, for compilers that have none for aggregates.
template <class R>
Ensemble(R, int, double, bool) -> Ensemble<R>;

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/ensemble.ipp"
#endif
