// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Gaussian process regression: predictions with standard deviations.

#include <optional>

#include "vernier/regression/detail/process_spread.hpp"
#include "vernier/regression/kernel_predictor.hpp"

namespace vernier {

namespace detail {

/// A fitted Gaussian process.
struct FittedProcess {
  FittedKernels kernels;  ///< its prediction
  ProcessSpread spread;   ///< its uncertainty
};

}  // namespace detail

/// A fitted Gaussian process: a `KernelPredictor` with standard deviations. Keeps n^2 / 2 numbers.
template <int Inputs, int Outputs>
class GaussianProcessPredictor : public KernelPredictor<Inputs, Outputs> {
  using Base = KernelPredictor<Inputs, Outputs>;

 public:
  using typename Base::Input;
  using typename Base::Output;

  /// The process of `Inputs` inputs and `Outputs` outputs.
  explicit GaussianProcessPredictor(const detail::FittedProcess& fitted)
      : Base(fitted.kernels), spread_(fitted.spread) {}

  /// Standard deviations of the predicted function, with the uncertainty of its mean, without the noise of a new
  /// measurement. O(n^2).
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const Input at = x;
    Output out;
    double workspace[detail::NodeSum::workspace(Inputs)];
    spread_.standard_deviation(this->kernels(), at.data(), out.data(), workspace);
    return out;
  }

  /// Variance of each output's function.
  Output signal_variance() const { return spread_.signal_deviation().cwiseAbs2(); }
  /// Variance of the noise of each output, of a sample of weight one.
  Output noise_variance() const { return noise_ratio() * signal_variance(); }
  /// Noise variance divided by signal variance, the same for all outputs.
  double noise_ratio() const { return spread_.noise_ratio(); }

 private:
  detail::ProcessSpread spread_;
};

/// Gaussian process with a constant mean. Outputs share the length scales, one an input, and the ratio of noise to
/// signal variance; each has its own mean and signal variance, at their best in closed form. Length scales and ratio
/// are, where not given, those of the greatest marginal likelihood, found by a bounded quasi-Newton method in their
/// logarithms from several starts; O(n^3) a step. A sample of weight w counts as w samples: its noise variance is
/// divided by w. The fit is O(n^3) and holds n^2 numbers.
/// @cite Rasmussen and Williams 2006
struct GaussianProcess {
  /// Between samples.
  Kernel kernel = Kernel::squared_exponential;
  /// Features of the inputs; not `InputMap::sine_cosine_products`, where an input has no length scale of its own.
  InputMap input_map = InputMap::raw;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  /// One an input, in units of the features: of scaled inputs, or of sines and cosines (one is about a
  /// radian). Empty: the most likely.
  VectorX length_scales{};
  std::optional<double> noise_ratio{};  ///< noise variance divided by signal variance, positive; none: the most likely
  int starts = 3;                       ///< of the search, at least 1; the first is fixed, the others are drawn
  int iterations = 60;                  ///< of each start at most, at least 1
  /// Largest number of samples, drawn from the seed, that length scales and ratio are chosen on, at least 2; the fit
  /// uses all.
  Index max_hyper_samples = 300;

  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the seed draws starts and the samples for the choice; the executor runs the starts in parallel
  /// @throws std::invalid_argument for unusable samples, weights or options, and where the ratio, given, is too
  ///         small: the kernel's matrix is numerically singular
  template <class X, class Y>
  GaussianProcessPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                                           const Eigen::MatrixBase<Y>& targets,
                                                                           const FitOptions& options = {}) const {
    detail::require_samples("GaussianProcess", inputs, targets, options);
    return GaussianProcessPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime>(
        solve(inputs.derived(), targets.derived(), options));
  }

 private:
  friend struct detail::RunTimeFit;

  VERNIER_API void validate(Index dimension) const;
  VERNIER_API detail::FittedProcess solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                          const FitOptions& options) const;
  /// Of length scales and ratio, as given or found.
  VERNIER_API VectorX logarithms(const MatrixX& features, int dimension, const ConstMatrixRef& targets,
                                 const VectorX& weights, const FitOptions& options) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/gaussian_process.ipp"
#endif
