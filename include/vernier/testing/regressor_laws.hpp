#pragma once

/// @file
/// What every `Regressor` must do, as a list of violations.

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/regression/concepts.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::testing {

/// What a recipe does with `FitOptions::weights`.
enum class SampleWeights {
  refused,  ///< weights throw `std::invalid_argument`
  taken,    ///< they matter; all one, they do not; unusable ones throw
  counted,  ///< and integer weights equal repeated samples
};

/// What a recipe claims beside the concept, and how closely it is looked at.
struct RegressorLaws {
  bool uses_seed = true;               ///< another seed gives another predictor; otherwise the same one
  Index samples = 60;                  ///< rows a fit gets, at least 2
  std::uint64_t seed = 7;              ///< of the samples and the fits
  double derivative_tolerance = 1e-6;  ///< of the derivative against differences, relative to its largest entry
  SampleWeights weights = SampleWeights::refused;  ///< what becomes of weights
  double weight_tolerance = 1e-9;  ///< of predictions where weights should make no difference, relative to the largest
};

namespace detail {

/// Samples of a smooth function: joint angles in, millimetres in metres out.
template <int Inputs, int Outputs>
struct Samples {
  Eigen::Matrix<double, Eigen::Dynamic, Inputs> x;
  Eigen::Matrix<double, Eigen::Dynamic, Outputs> y;

  Samples(Index n, std::uint64_t seed) : x(n, Inputs), y(n, Outputs) {
    Rng rng(seed);
    for (Index i = 0; i < n; ++i) {
      for (int j = 0; j < Inputs; ++j) x(i, j) = rng.uniform(-1.5, 1.5);
      for (int k = 0; k < Outputs; ++k) {
        double value = 0.1 * (k + 1);
        for (int j = 0; j < Inputs; ++j) value += std::sin((1 + 0.3 * j) * x(i, j) + k) * (1 + 0.2 * x(i, 0));
        y(i, k) = 1e-3 * (k + 1) * value;
      }
    }
  }
};

/// Checks one recipe with one pair of numbers of inputs and outputs.
template <int Inputs, int Outputs, Regressor R>
class RegressorCheck {
 public:
  RegressorCheck(const R& recipe, const RegressorLaws& laws, std::vector<std::string>& violations)
      : recipe_(recipe), laws_(laws), violations_(violations), train_(laws.samples, laws.seed) {}

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
  using Sample = Eigen::Matrix<double, Inputs, 1>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Inputs>;
  using Fitted = PredictorOf<R, Inputs, Outputs>;

  template <class... Parts>
  void violate(const Parts&... parts) {
    violations_.push_back(message("regressor, ", Inputs, " inputs, ", Outputs, " outputs: ", parts...));
  }

  void expect(bool holds, const char* law) {
    if (!holds) violate(law);
  }

  Fitted fit(std::uint64_t seed, ExecutorRef executor = {}) const {
    return recipe_.fit(train_.x, train_.y, FitOptions{.seed = seed, .executor = executor});
  }

  Rows fresh() const { return Samples<Inputs, Outputs>(20, laws_.seed + 1).x; }

  void repeatability() {
    const Samples<Inputs, Outputs> kept = train_;
    const Rows x = fresh();
    const MatrixX first = fit(laws_.seed).predict(x);
    expect(same_bits(kept.x, train_.x) && same_bits(kept.y, train_.y), "fit changed its samples");
    train_ = kept;
    expect(same_bits(first, fit(laws_.seed).predict(x)), "the same seed gave another predictor");

    const Samples<Inputs, Outputs> others(laws_.samples + 3, laws_.seed + 2);
    static_cast<void>(recipe_.fit(others.x, others.y, FitOptions{.seed = laws_.seed + 1}));
    expect(same_bits(first, fit(laws_.seed).predict(x)), "a fit in between changed the next: the recipe has a memory");

    const MatrixX other_seed = fit(laws_.seed + 1).predict(x);
    if (laws_.uses_seed) {
      expect(!same_bits(first, other_seed), "another seed gave the same predictor");
    } else {
      expect(same_bits(first, other_seed), "the seed matters, though the recipe claims not to use it");
    }
    for (const int threads : {1, 2}) {
      const ThreadExecutor executor(threads);
      if (!same_bits(first, fit(laws_.seed, executor).predict(x)))
        violate("another predictor with an executor of ", threads, " threads");
    }

    Samples<Inputs, Outputs> passing = train_;
    const Fitted fitted = recipe_.fit(passing.x, passing.y, FitOptions{.seed = laws_.seed});
    passing.x.setConstant(17);
    passing.y.setConstant(17);
    expect(same_bits(first, fitted.predict(x)), "the predictor refers to the samples it was fitted on");
  }

  void predictions() {
    const Rows x = fresh();
    const Fitted predictor = fit(laws_.seed);
    const MatrixX rows = predictor.predict(x);
    expect(rows.rows() == x.rows() && rows.cols() == Outputs, "predict(rows) has the wrong shape");
    if (rows.rows() != x.rows() || rows.cols() != Outputs) return;
    expect(rows.allFinite(), "a prediction is not finite");

    MatrixX forwards(x.rows(), Outputs), backwards(x.rows(), Outputs);
    for (Index i = 0; i < x.rows(); ++i) forwards.row(i) = predictor.predict(Sample(x.row(i).transpose())).transpose();
    for (Index i = x.rows(); i-- > 0;) {
      static_cast<void>(predictor.derivative(Sample(x.row(x.rows() - 1 - i).transpose())));
      backwards.row(i) = predictor.predict(Sample(x.row(i).transpose())).transpose();
    }
    expect(same_bits(forwards, backwards), "predictions depend on the order of the calls");
    expect((rows - forwards).cwiseAbs().maxCoeff() <= 1e-12 * (rows.cwiseAbs().maxCoeff() + 1e-3),
           "predict(rows) differs from predict(sample)");
    expect(predictor.predict(Rows(0, Inputs)).rows() == 0, "no rows are predicted as some");
    const Fitted copy = predictor;  // NOLINT(performance-unnecessary-copy-initialization)
    expect(same_bits(rows, copy.predict(x)), "a copy predicts something else");

    for (Index i = 0; i < x.rows(); ++i) {
      const Sample at = x.row(i).transpose();
      const MatrixX given = predictor.derivative(at);
      const MatrixX expected = differences(predictor, at);
      const double scale = expected.cwiseAbs().maxCoeff() + 1e-3;
      const double error = (given - expected).cwiseAbs().maxCoeff();
      if (error <= laws_.derivative_tolerance * scale) continue;
      violate("derivative differs from central differences by ", error, " of ", scale);
      return;
    }
  }

  /// Central differences of fourth order: a step wide enough for predictors whose large terms cancel.
  MatrixX differences(const Fitted& predictor, const Sample& at) const {
    constexpr double step = 1e-3;
    MatrixX out(Outputs, Inputs);
    for (int j = 0; j < Inputs; ++j) {
      const auto value = [&](double steps) {
        Sample x = at;
        x(j) += steps * step;
        return VectorX(predictor.predict(x));
      };
      out.col(j) = (8 * (value(1) - value(-1)) - (value(2) - value(-2))) / (12 * step);
    }
    return out;
  }

  void certainty() {
    if constexpr (UncertainPredictor<Fitted>) {
      const Rows x = fresh();
      const Fitted predictor = fit(laws_.seed), copy = predictor;
      MatrixX forwards(x.rows(), Outputs), backwards(x.rows(), Outputs);
      for (Index i = 0; i < x.rows(); ++i)
        forwards.row(i) = predictor.standard_deviation(Sample(x.row(i).transpose())).transpose();
      for (Index i = x.rows(); i-- > 0;)
        backwards.row(i) = copy.standard_deviation(Sample(x.row(i).transpose())).transpose();
      expect(forwards.allFinite() && forwards.minCoeff() >= 0, "a standard deviation is negative or not finite");
      expect(same_bits(forwards, backwards), "the standard deviations of a copy are others");
    }
  }

  void misuse() {
    const Rows longer = Samples<Inputs, Outputs>(laws_.samples + 1, laws_.seed).x;
    expect_refused("mismatched rows",
                   [&] { static_cast<void>(recipe_.fit(longer, train_.y, FitOptions{.seed = laws_.seed})); });
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
    return recipe_.fit(train_.x, train_.y, FitOptions{.seed = laws_.seed, .weights = &weights}).predict(fresh());
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

    const MatrixX plain = fit(laws_.seed).predict(fresh());
    const auto same = [&](const MatrixX& a, const MatrixX& b) {
      return (a - b).cwiseAbs().maxCoeff() <= laws_.weight_tolerance * plain.cwiseAbs().maxCoeff();
    };
    expect(same(weighted(ones), plain), "weights of all one make a difference");
    VectorX counts(n);
    for (Index i = 0; i < n; ++i) counts(i) = static_cast<double>(1 + i % 3);
    const VectorX kept = counts;
    const MatrixX counted = weighted(counts);
    expect(same_bits(kept, counts), "fit changed its weights");
    expect(!same_bits(counted, plain), "the weights are ignored");
    if (laws_.weights != SampleWeights::counted) return;

    const auto total = static_cast<Index>(kept.sum());
    Samples<Inputs, Outputs> repeated(total, 0);
    for (Index i = 0, to = 0; i < n; ++i)
      for (double copies = 0; copies < kept(i); ++copies, ++to) {
        repeated.x.row(to) = train_.x.row(i);
        repeated.y.row(to) = train_.y.row(i);
      }
    const MatrixX expected = recipe_.fit(repeated.x, repeated.y, FitOptions{.seed = laws_.seed}).predict(fresh());
    const double error = (counted - expected).cwiseAbs().maxCoeff();
    if (!same(counted, expected))
      violate("integer weights differ from repeated samples by ", error, " of ", plain.cwiseAbs().maxCoeff());
  }

  const R& recipe_;
  const RegressorLaws& laws_;
  std::vector<std::string>& violations_;
  Samples<Inputs, Outputs> train_;
};

}  // namespace detail

/// Runs a recipe through the laws of `Regressor`, on seeded samples of three inputs and two outputs and of one each:
///
/// - the same seed gives the same bits, whatever was fitted before and whoever computes (this thread, 1 or 2 threads);
///   another seed gives another predictor, where the recipe uses it;
/// - `fit` leaves its samples unchanged, and the predictor does not refer to them;
/// - `predict(rows)` equals `predict(sample)` row by row, whatever the order of the calls;
/// - `derivative` equals central differences;
/// - `standard_deviation`, where there is one, is finite and not negative, and a copy's the same;
/// - numbers of rows that differ throw `std::invalid_argument`;
/// - weights are refused, or matter as claimed (`SampleWeights`); unusable ones throw `std::invalid_argument`.
/// @return one sentence a violation; empty when all laws hold
template <Regressor R>
std::vector<std::string> regressor_violations(const R& recipe, const RegressorLaws& laws = {}) {
  require(laws.samples >= 2, "regressor_violations: samples is ", laws.samples, ", must be at least 2");
  std::vector<std::string> violations;
  detail::RegressorCheck<3, 2, R>(recipe, laws, violations).run();
  detail::RegressorCheck<1, 1, R>(recipe, laws, violations).run();
  return violations;
}

}  // namespace vernier::testing
