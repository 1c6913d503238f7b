// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Regressors of any type and any numbers of inputs and outputs as one type, so that their laws are compiled once.

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "vernier/regression/concepts.hpp"

namespace vernier::testing::detail {

/// Samples of a smooth function: joint angles in, millimetres in metres out.
struct Samples {
  MatrixX x, y;

  VERNIER_API Samples(Index n, Index inputs, Index outputs, std::uint64_t seed);
};

/// A predictor of any type.
struct AnyPredictor {
  AnyPredictor() = default;
  AnyPredictor(const AnyPredictor&) = default;
  AnyPredictor& operator=(const AnyPredictor&) = default;
  virtual ~AnyPredictor() = default;
  virtual MatrixX predict_rows(const MatrixX& x) const = 0;
  virtual VectorX predict(const VectorX& x) const = 0;
  virtual MatrixX derivative(const VectorX& x) const = 0;
  virtual std::optional<VectorX> standard_deviation(const VectorX& x) const = 0;
  virtual std::unique_ptr<AnyPredictor> copy() const = 0;
  virtual void overwrite_samples() = 0;
};

/// A recipe for one pair of numbers of inputs and outputs, likewise.
struct AnyRecipe {
  Index inputs, outputs;

  AnyRecipe(Index i, Index o) : inputs(i), outputs(o) {}
  AnyRecipe(const AnyRecipe&) = delete;
  AnyRecipe& operator=(const AnyRecipe&) = delete;
  virtual ~AnyRecipe() = default;
  /// Fits; `samples` are those of the call, which a wrong `fit` may have changed.
  virtual std::unique_ptr<AnyPredictor> fit(Samples& samples, const FitOptions& options) const = 0;
};

template <class R, int Inputs, int Outputs>
class RecipeOf final : public AnyRecipe {
 public:
  explicit RecipeOf(const R& recipe) : AnyRecipe(Inputs, Outputs), recipe_(recipe) {}

  std::unique_ptr<AnyPredictor> fit(Samples& samples, const FitOptions& options) const override {
    const auto passed = std::make_shared<Passed>(Passed{samples.x, samples.y});
    auto out =
        std::make_unique<Predictor>(recipe_.fit(std::as_const(passed->x), std::as_const(passed->y), options), passed);
    samples.x = passed->x;
    samples.y = passed->y;
    return out;
  }

 private:
  struct Passed {
    Eigen::Matrix<double, Eigen::Dynamic, Inputs> x;
    Eigen::Matrix<double, Eigen::Dynamic, Outputs> y;
  };

  struct Predictor final : AnyPredictor {
    using Sample = Eigen::Matrix<double, Inputs, 1>;
    PredictorOf<R, Inputs, Outputs> fitted;
    std::shared_ptr<Passed> passed;

    Predictor(PredictorOf<R, Inputs, Outputs> f, std::shared_ptr<Passed> p)
        : fitted(std::move(f)), passed(std::move(p)) {}

    MatrixX predict_rows(const MatrixX& x) const override {
      return fitted.predict(Eigen::Matrix<double, Eigen::Dynamic, Inputs>(x));
    }
    VectorX predict(const VectorX& x) const override { return fitted.predict(Sample(x)); }
    MatrixX derivative(const VectorX& x) const override { return fitted.derivative(Sample(x)); }
    std::optional<VectorX> standard_deviation(const VectorX& x) const override {
      if constexpr (UncertainPredictor<PredictorOf<R, Inputs, Outputs>>)
        return VectorX(fitted.standard_deviation(Sample(x)));
      else
        return std::nullopt;
    }
    std::unique_ptr<AnyPredictor> copy() const override { return std::make_unique<Predictor>(*this); }
    void overwrite_samples() override {
      passed->x.setConstant(17);
      passed->y.setConstant(17);
    }
  };

  const R& recipe_;
};

}  // namespace vernier::testing::detail

#if VERNIER_HEADER_ONLY
#include "vernier/testing/any_regressor.ipp"
#endif
