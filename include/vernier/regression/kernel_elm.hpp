#pragma once

/// @file
/// The kernel extreme learning machine: a hidden layer of infinitely many nodes, known by its kernel alone.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/regression/kernel_system.hpp"

namespace vernier {

namespace detail {

/// Leave-one-out errors of kernel ridge regression with a mean of its own, for every lambda from one decomposition of
/// the weighted kernel matrix, `W^1/2 K W^1/2 = V diag(d) V'`. A sample is left out with all its weight. O(n^3) once,
/// then O(n^2) a lambda.
/// @cite Dubrule 1983
template <class Scalar>  // a template so that only users pay for compiling it
class KernelRidgePathOf {
 public:
  /// @param k       K, its lower triangle
  /// @param targets n x outputs
  /// @param weights n
  KernelRidgePathOf(MatrixX k, MatrixX targets, const VectorX& weights)
      : root_(weights.cwiseSqrt()), targets_(std::move(targets)) {
    k = root_.asDiagonal() * k * root_.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixX> eigen(k);
    vectors_ = eigen.eigenvectors();
    values_ = eigen.eigenvalues().cwiseMax(0.0);  // below: rounding
    MatrixX right(root_.size(), 1 + targets_.cols());
    right << root_, root_.asDiagonal() * targets_;
    projected_ = vectors_.transpose() * right;
  }

  /// Errors of leaving each sample out, n x outputs; an infinite lambda is the mean alone.
  MatrixX leave_one_out_residuals(double lambda) const {
    const VectorX weights = root_.cwiseAbs2();
    if (!std::isfinite(lambda)) {
      const double total = weights.sum();
      const Eigen::RowVectorXd mean = weights.transpose() * targets_ / total;
      return (1 - weights.array() / total).inverse().matrix().asDiagonal() * (targets_.rowwise() - mean);
    }
    const VectorX shares = (values_.array() + lambda).inverse().matrix();
    const VectorX ones = shares.cwiseProduct(projected_.col(0));
    const double precision = ones.dot(projected_.col(0));
    const auto targets = projected_.rightCols(targets_.cols());
    const Eigen::RowVectorXd mean = ones.transpose() * targets / precision;
    const MatrixX alpha = root_.asDiagonal() * (vectors_ * (shares.asDiagonal() * targets - ones * mean));
    // of (K + lambda / W)^-1 with the mean projected out
    const VectorX diagonal =
        weights.cwiseProduct(vectors_.cwiseAbs2() * shares - (vectors_ * ones).cwiseAbs2() / precision);
    return diagonal.cwiseInverse().asDiagonal() * alpha;
  }

  /// Their weighted mean square, summed over outputs.
  double leave_one_out_error(double lambda) const {
    return (root_.asDiagonal() * leave_one_out_residuals(lambda)).squaredNorm() / root_.squaredNorm();
  }

 private:
  VectorX root_;
  MatrixX targets_, vectors_, projected_;
  VectorX values_;
};

/// In double precision.
using KernelRidgePath = KernelRidgePathOf<double>;

}  // namespace detail

/// Kernel ELM with a Gaussian kernel: `f(x) = mean + k(x)' (K + lambda I)^-1 (T - mean)`, the mean not penalised (that
/// of generalised least squares). A sample of weight w has lambda / w. Length scale and lambda, where not given, are
/// those of least leave-one-out error in closed form, the mean alone among the candidates. Targets keep their units, so
/// outputs weigh as they are. O(n^3), and n^2 numbers while it is fitted.
/// @cite Huang 2012; Dubrule 1983
struct KernelElm {
  /// What the kernel sees of each input.
  InputMap input_map = InputMap::raw;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  /// Of the kernel, in units of what it sees: of scaled inputs, or of sines and cosines (one is about a radian).
  std::optional<double> length_scale{};
  std::optional<double> lambda{};  ///< beside a kernel of at most 1; positive
  /// Beyond it a seeded sample of so many decides on length scale and lambda, at least 2; the fit is from all.
  Index max_search_samples = 500;

  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the seed draws the sample that decides; the executor shares out the length scales tried
  /// @throws std::invalid_argument for unusable samples, weights or options, and where lambda, given, is too small for
  ///         the kernel's matrix to be told from a singular one
  template <class X, class Y>
  KernelPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                                  const Eigen::MatrixBase<Y>& targets,
                                                                  const FitOptions& options = {}) const {
    detail::require_samples("KernelElm", inputs, targets, options);
    require(!length_scale || (*length_scale > 0 && std::isfinite(*length_scale)), "KernelElm: length_scale is ",
            length_scale.value_or(0), ", must be positive");
    require(!lambda || (*lambda > 0 && std::isfinite(*lambda)), "KernelElm: lambda is ", lambda.value_or(0),
            ", must be positive");
    require(max_search_samples >= 2, "KernelElm: max_search_samples is ", max_search_samples, ", must be at least 2");
    detail::KernelFeatures features(inputs, input_map, input_scaling);
    const VectorX weights = detail::weights_or_ones(options.weights, inputs.rows());
    const Choice chosen = choose(features.values, targets, weights, options);
    features.divide(VectorX::Constant(1, chosen.length_scale));
    using Predictor = KernelPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime>;
    if (!std::isfinite(chosen.lambda)) {
      const VectorX mean = targets.transpose() * weights / weights.sum();
      return Predictor(Kernel::squared_exponential, input_map, features.scaling, features.values,
                       MatrixX::Zero(targets.rows(), targets.cols()), mean);
    }
    const detail::KernelSystem system(detail::kernel_matrix(Kernel::squared_exponential, features.values),
                                      chosen.lambda * weights.cwiseInverse(), targets);
    require(system.solved, "KernelElm: lambda is ", chosen.lambda, ", too small for ", inputs.rows(),
            " samples at a length scale of ", chosen.length_scale);
    return Predictor(Kernel::squared_exponential, input_map, features.scaling, features.values, system.alpha,
                     system.mean);
  }

 private:
  struct Choice {
    double length_scale = 1, lambda = 1, error = std::numeric_limits<double>::infinity();
  };

  template <class Features>  // a template so that only users pay for compiling the decomposition
  Choice choose(const Features& features, const MatrixX& targets, const VectorX& weights,
                const FitOptions& options) const {
    if (length_scale && lambda) return {*length_scale, *lambda, 0};
    const Index n = features.rows(), m = std::min(n, max_search_samples);
    if (n < 2) return {length_scale.value_or(1), lambda.value_or(std::numeric_limits<double>::infinity()), 0};
    std::vector<Index> rows = Rng(options.seed).permutation(n);
    rows.resize(static_cast<std::size_t>(m));
    if (m == n)  // which order is no matter of chance then
      for (Index i = 0; i < n; ++i) rows[static_cast<std::size_t>(i)] = i;
    const MatrixX x = features(rows, Eigen::all), t = targets(rows, Eigen::all);
    const VectorX w = weights(rows);

    const auto at = [&](double length) {
      const detail::KernelRidgePath path(detail::kernel_matrix(Kernel::squared_exponential, x / length), t, w);
      Choice best{length};
      const auto consider = [&](double candidate) {
        const double error = path.leave_one_out_error(candidate);
        if (error < best.error) best = {length, candidate, error};
      };
      if (lambda) {
        consider(*lambda);
      } else {
        consider(std::numeric_limits<double>::infinity());
        // below, coefficients grow so large that what is left of their sum has few digits
        for (int exponent = 4; exponent >= -16; --exponent) consider(std::pow(10.0, exponent / 2.0));
      }
      return best;
    };
    if (length_scale) return at(*length_scale);

    // Octaves around the typical distance of two samples, then half octaves beside the best.
    double typical = std::sqrt(2 * (x.rowwise() - x.colwise().mean()).squaredNorm() / static_cast<double>(m));
    if (!(typical > 0)) typical = 1;
    Choice best;
    const auto try_all = [&](const std::vector<double>& lengths) {
      std::vector<Choice> found(lengths.size());
      options.executor.for_ranges(static_cast<Index>(lengths.size()), [&](Index begin, Index end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
          found[k] = at(lengths[k]);
      });
      for (const Choice& choice : found)
        if (choice.error < best.error) best = choice;
    };
    std::vector<double> octaves;
    for (int power = 3; power >= -4; --power) octaves.push_back(std::ldexp(typical, power));
    try_all(octaves);
    try_all({best.length_scale * std::sqrt(2.0), best.length_scale / std::sqrt(2.0)});
    return best;
  }
};

}  // namespace vernier
