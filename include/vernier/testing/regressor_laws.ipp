// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/executor.hpp"
#include "vernier/testing/regressor_laws.hpp"

namespace vernier::testing::detail {

using vernier::detail::all_finite;
using vernier::detail::row_of;

VERNIER_LOCAL inline void set_row(MatrixX& matrix, Index i, const VectorX& values) {
  for (Index c = 0; c < matrix.cols(); ++c) matrix(i, c) = values(c);
}

/// The largest absolute element; infinite where one is not finite.
VERNIER_LOCAL inline double largest_of(const MatrixX& matrix) {
  if (!all_finite(matrix)) return std::numeric_limits<double>::infinity();
  double out = 0;
  for (Index k = 0; k < matrix.size(); ++k) out = (std::max)(out, std::abs(matrix.data()[k]));
  return out;
}

/// Checks one recipe for one pair of numbers of inputs and outputs. A template, so that it is compiled where it is
/// used.
template <class Recipe>
class RegressorCheck {
 public:
  RegressorCheck(const Recipe& recipe, const RegressorLaws& laws, std::vector<std::string>& violations)
      : recipe_(recipe), laws_(laws), violations_(violations), train_(samples(laws.samples, laws.seed)) {}

  void run() {
    try {
      repeatability();
      predictions();
      certainty();
      misuse();
      weights();
    } catch (const std::exception& error) {
      violate("threw on good samples: ", error.what());
    }
  }

 private:
  using Fitted = std::unique_ptr<AnyPredictor>;

  template <class... Parts>
  void violate(const Parts&... parts) {
    violations_.push_back(message("regressor, ", recipe_.inputs, " inputs, ", recipe_.outputs, " outputs: ", parts...));
  }

  void expect(bool holds, const char* law) {
    if (!holds) violate(law);
  }

  Samples samples(Index n, std::uint64_t seed) const { return {n, recipe_.inputs, recipe_.outputs, seed}; }

  Fitted fit(Samples passed, const FitOptions& options) const { return recipe_.fit(passed, options); }

  Fitted fit(std::uint64_t seed, ExecutorRef executor = {}) const {
    return fit(train_, FitOptions{.seed = seed, .executor = executor});
  }

  MatrixX fresh() const { return samples(20, laws_.seed + 1).x; }

  void repeatability() {
    const MatrixX x = fresh();
    Samples passed = train_;
    const Fitted fitted = recipe_.fit(passed, FitOptions{.seed = laws_.seed});
    const MatrixX first = fitted->predict_rows(x);
    expect(same_bits(passed.x, train_.x) && same_bits(passed.y, train_.y), "fit changed its samples");
    expect(same_bits(first, fit(laws_.seed)->predict_rows(x)), "the same seed gave another predictor");

    static_cast<void>(fit(samples(laws_.samples + 3, laws_.seed + 2), FitOptions{.seed = laws_.seed + 1}));
    expect(same_bits(first, fit(laws_.seed)->predict_rows(x)),
           "a fit in between changed the next: the recipe has a memory");

    const MatrixX other_seed = fit(laws_.seed + 1)->predict_rows(x);
    if (laws_.uses_seed) {
      expect(!same_bits(first, other_seed), "another seed gave the same predictor");
    } else {
      expect(same_bits(first, other_seed), "the seed matters, though the recipe claims not to use it");
    }
    for (const int threads : {1, 2}) {
      const ThreadExecutor executor(threads);
      if (!same_bits(first, fit(laws_.seed, executor)->predict_rows(x)))
        violate("another predictor with an executor of ", threads, " threads");
    }
    fitted->overwrite_samples();
    expect(same_bits(first, fitted->predict_rows(x)), "the predictor refers to the samples it was fitted on");
  }

  void predictions() {
    const MatrixX x = fresh();
    const Fitted predictor = fit(laws_.seed);
    const MatrixX rows = predictor->predict_rows(x);
    expect(rows.rows() == x.rows() && rows.cols() == recipe_.outputs, "predict(rows) has the wrong shape");
    if (rows.rows() != x.rows() || rows.cols() != recipe_.outputs) return;
    expect(all_finite(rows), "a prediction is not finite");

    MatrixX forwards(x.rows(), rows.cols()), backwards(x.rows(), rows.cols());
    for (Index i = 0; i < x.rows(); ++i) set_row(forwards, i, predictor->predict(row_of(x, i)));
    for (Index i = x.rows(); i-- > 0;) {
      static_cast<void>(predictor->derivative(row_of(x, x.rows() - 1 - i)));
      set_row(backwards, i, predictor->predict(row_of(x, i)));
    }
    expect(same_bits(forwards, backwards), "predictions depend on the order of the calls");
    expect(largest_of(rows - forwards) <= 1e-12 * (largest_of(rows) + 1e-3),
           "predict(rows) differs from predict(sample)");
    expect(predictor->predict_rows(MatrixX(0, recipe_.inputs)).rows() == 0, "no rows are predicted as some");
    expect(same_bits(rows, predictor->copy()->predict_rows(x)), "a copy predicts something else");

    for (Index i = 0; i < x.rows(); ++i) {
      const VectorX at = row_of(x, i);
      const MatrixX given = predictor->derivative(at);
      const MatrixX expected = differences(*predictor, at);
      const double scale = largest_of(expected) + 1e-3;
      const double error = largest_of(given - expected);
      if (error <= laws_.derivative_tolerance * scale) continue;
      violate("derivative differs from central differences by ", error, " of ", scale);
      return;
    }
  }

  /// Central differences of fourth order: a step wide enough for predictors whose large terms cancel.
  MatrixX differences(const AnyPredictor& predictor, const VectorX& at) const {
    constexpr double step = 1e-3;
    MatrixX out(recipe_.outputs, recipe_.inputs);
    for (Index j = 0; j < recipe_.inputs; ++j) {
      const auto value = [&](double steps) {
        VectorX x = at;
        x(j) += steps * step;
        return predictor.predict(x);
      };
      const VectorX inner = value(1) - value(-1), outer = value(2) - value(-2);
      for (Index k = 0; k < recipe_.outputs; ++k) out(k, j) = (8 * inner(k) - outer(k)) / (12 * step);
    }
    return out;
  }

  void certainty() {
    const MatrixX x = fresh();
    const Fitted predictor = fit(laws_.seed), copy = predictor->copy();
    if (!predictor->standard_deviation(row_of(x, 0))) return;
    MatrixX forwards(x.rows(), recipe_.outputs), backwards(x.rows(), recipe_.outputs);
    for (Index i = 0; i < x.rows(); ++i) set_row(forwards, i, *predictor->standard_deviation(row_of(x, i)));
    for (Index i = x.rows(); i-- > 0;) set_row(backwards, i, *copy->standard_deviation(row_of(x, i)));
    expect(all_finite(forwards) && forwards.minCoeff() >= 0, "a standard deviation is negative or not finite");
    expect(same_bits(forwards, backwards), "the standard deviations of a copy are others");
  }

  void misuse() {
    Samples mismatched = train_;
    mismatched.x = samples(laws_.samples + 1, laws_.seed).x;
    expect_refused("mismatched rows", [&] { static_cast<void>(fit(mismatched, FitOptions{.seed = laws_.seed})); });
  }

  template <class Work>
  void expect_refused(const char* what, Work&& work) {
    try {
      work();
    } catch (const std::invalid_argument&) {
      return;
    } catch (const std::exception& error) {
      violate(what, " threw something other than std::invalid_argument: ", error.what());
      return;
    }
    violate(what, " did not throw");
  }

  MatrixX weighted(const VectorX& weights) const {
    return fit(train_, FitOptions{.seed = laws_.seed, .weights = &weights})->predict_rows(fresh());
  }

  void weights() {
    const Index n = train_.x.rows();
    const VectorX ones = VectorX::Ones(n);
    if (laws_.weights == SampleWeights::refused)
      return expect_refused("weights that the recipe claims not to take", [&] { static_cast<void>(weighted(ones)); });

    const auto unusable = [&](const char* what, const VectorX& weights) {
      expect_refused(what, [&] { static_cast<void>(weighted(weights)); });
    };
    unusable("too many weights", VectorX::Ones(n + 1));
    unusable("too few weights", VectorX::Ones(n - 1));
    for (const auto& [what, value] : {std::pair{"a weight of zero", 0.0}, std::pair{"a negative weight", -1.0},
                                      std::pair{"a weight that is no number", std::nan("")}}) {
      VectorX weights = ones;
      weights(n / 2) = value;
      unusable(what, weights);
    }

    const MatrixX plain = fit(laws_.seed)->predict_rows(fresh());
    const auto same = [&](const MatrixX& a, const MatrixX& b) {
      return largest_of(a - b) <= laws_.weight_tolerance * largest_of(plain);
    };
    expect(same(weighted(ones), plain), "weights of all one make a difference");
    VectorX counts(n);
    for (Index i = 0; i < n; ++i) counts(i) = static_cast<double>(1 + i % 3);
    const VectorX kept = counts;
    const MatrixX counted = weighted(counts);
    expect(same_bits(kept, counts), "fit changed its weights");
    expect(!same_bits(counted, plain), "the weights are ignored");
    if (laws_.weights != SampleWeights::counted) return;

    Samples repeated = samples(static_cast<Index>(kept.sum()), 0);
    for (Index i = 0, to = 0; i < n; ++i)
      for (double copies = 0; copies < kept(i); ++copies, ++to) {
        set_row(repeated.x, to, row_of(train_.x, i));
        set_row(repeated.y, to, row_of(train_.y, i));
      }
    const MatrixX expected = fit(repeated, FitOptions{.seed = laws_.seed})->predict_rows(fresh());
    if (!same(counted, expected))
      violate("integer weights differ from repeated samples by ", largest_of(counted - expected), " of ",
              largest_of(plain));
  }

  const Recipe& recipe_;
  const RegressorLaws& laws_;
  std::vector<std::string>& violations_;
  Samples train_;
};

VERNIER_IMPL void check_regressor(const AnyRecipe& recipe, const RegressorLaws& laws,
                                  std::vector<std::string>& violations) {
  RegressorCheck(recipe, laws, violations).run();
}

}  // namespace vernier::testing::detail
