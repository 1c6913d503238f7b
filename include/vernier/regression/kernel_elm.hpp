// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The kernel extreme learning machine: the limit of infinitely many hidden nodes, given by its kernel.

#include <limits>
#include <optional>

#include "vernier/core/fit_options.hpp"
#include "vernier/regression/kernel_predictor.hpp"

namespace vernier {

/// Kernel ELM with a Gaussian kernel: `f(x) = mean + k(x)' (K + lambda I)^-1 (T - mean)`, the mean not penalised (that
/// of generalised least squares). A sample of weight w has lambda / w. Length scale and lambda, where not given, are
/// those of least leave-one-out error in closed form, the mean alone among the candidates. Targets keep their units, so
/// outputs weigh as they are. O(n^3), and n^2 numbers while it is fitted.
/// @cite Huang 2012; Dubrule 1983
struct KernelElm {
  /// Features of the inputs.
  InputMap input_map = InputMap::raw;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  /// Of the kernel, in units of the features: of scaled inputs, or of sines and cosines (one is about a radian).
  std::optional<double> length_scale{};
  std::optional<double> lambda{};  ///< beside a kernel of at most 1; positive
  /// Largest number of samples, drawn from the seed, that length scale and lambda are chosen on, at least 2; the fit
  /// uses all.
  Index max_search_samples = 500;

  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the seed draws the sample for the choice; the executor runs the length scales tried in parallel
  /// @throws std::invalid_argument for unusable samples, weights or options, and where lambda, given, is too small:
  ///         the kernel's matrix is numerically singular
  template <class X, class Y>
  KernelPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                                  const Eigen::MatrixBase<Y>& targets,
                                                                  const FitOptions& options = {}) const {
    detail::require_samples("KernelElm", inputs, targets, options);
    return KernelPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime>(
        solve(inputs.derived(), targets.derived(), options));
  }

 private:
  friend struct detail::RunTimeFit;

  struct Choice {
    double length_scale = 1, lambda = 1, error = std::numeric_limits<double>::infinity();
  };

  VERNIER_API detail::FittedKernels solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                          const FitOptions& options) const;
  VERNIER_API Choice choose(const MatrixX& features, const ConstMatrixRef& targets, const VectorX& weights,
                            const FitOptions& options) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/kernel_elm.ipp"
#endif
