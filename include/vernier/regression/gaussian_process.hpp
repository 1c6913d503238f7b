#pragma once

/// @file
/// Gaussian process regression: a prediction and how far it may be off.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/regression/bounded_bfgs.hpp"
#include "vernier/regression/kernel_system.hpp"
#include "vernier/regression/marginal_likelihood.hpp"

namespace vernier {

namespace detail {

/// The inverse of a lower triangular matrix in square tiles, those on and below the diagonal row by row.
class LowerInverseTiles {
 public:
  static constexpr Index size = 64;  ///< of a tile

  /// @param factor n x n, its lower triangle; n^3 / 3 multiply-adds
  template <class Factor>
  explicit LowerInverseTiles(const Eigen::MatrixBase<Factor>& factor) {
    const Index n = factor.rows();
    rows_ = (n + size - 1) / size;
    tiles_.assign(static_cast<std::size_t>(rows_ * (rows_ + 1) / 2 * size * size), 0.0);
    MatrixX columns;
    for (Index j = 0; j < rows_; ++j) {  // a tile's columns of the inverse are zero above it
      const Index first = j * size, rest = n - first, width = std::min(size, rest);
      columns = MatrixX::Identity(rest, width);
      factor.bottomRightCorner(rest, rest).template triangularView<Eigen::Lower>().solveInPlace(columns);
      for (Index i = j; i < rows_; ++i) {
        const Index height = std::min(size, n - i * size);
        Eigen::Map<MatrixX>(tiles_.data() + offset(i, j), size, size).topLeftCorner(height, width) =
            columns.middleRows(i * size - first, height);
      }
    }
  }

  /// |M k|^2 for k that `fill(first, out)` writes tile by tile. Does not allocate; asks for a tile of k once for each
  /// row of tiles at or below it.
  template <class Fill>
  double square_of_product(Fill&& fill) const noexcept {
    double k[size], total = 0;
    for (Index i = 0; i < rows_; ++i) {
      double product[size] = {};
      for (Index j = 0; j <= i; ++j) {
        fill(j * size, k);
        add_product(tiles_.data() + offset(i, j), k, product);
      }
      for (const double part : product) total += part * part;
    }
    return total;
  }

 private:
  static std::size_t offset(Index i, Index j) { return static_cast<std::size_t>((i * (i + 1) / 2 + j) * size * size); }

  static void add_product(const double* tile, const double* k, double* product) noexcept {
    run_widest([&]<int W>() VERNIER_INLINED {
      constexpr int vectors = 4;
      typename Simd<W>::Double sum[vectors], part;
      for (Index row = 0; row < size; row += vectors * W) {
        VERNIER_UNROLL
        for (int v = 0; v < vectors; ++v) load<W>(sum[v], product + row + v * W);
        for (Index column = 0; column < size; ++column) {
          VERNIER_UNROLL
          for (int v = 0; v < vectors; ++v) {
            load<W>(part, tile + column * size + row + v * W);
            sum[v] += k[column] * part;
          }
        }
        VERNIER_UNROLL
        for (int v = 0; v < vectors; ++v) store<W>(product + row + v * W, sum[v]);
      }
    });
  }

  Index rows_ = 0;  // of tiles
  std::vector<double> tiles_;
};

}  // namespace detail

/// A fitted Gaussian process: a `KernelPredictor` that knows its uncertainty. Keeps n^2 / 2 numbers.
template <int Inputs, int Outputs>
class GaussianProcessPredictor : public KernelPredictor<Inputs, Outputs> {
  using Base = KernelPredictor<Inputs, Outputs>;

 public:
  using typename Base::Input;
  using typename Base::Output;

  /// @param base            what predicts
  /// @param system          the linear system that gave it
  /// @param signal_variance one an output
  /// @param noise_ratio     of noise to signal variance
  template <class Scalar>
  GaussianProcessPredictor(Base base, const detail::KernelSystemOf<Scalar>& system, const Output& signal_variance,
                           double noise_ratio)
      : Base(std::move(base)),
        inverse_(system.factor),
        ones_(VectorX::Zero((system.ones.size() + tile - 1) / tile * tile)),
        precision_(system.precision),
        signal_deviation_(signal_variance.cwiseSqrt()),
        noise_ratio_(noise_ratio) {
    ones_.head(system.ones.size()) = system.ones;
  }

  /// Standard deviations of the predicted function, the uncertainty of its mean included, the noise of a new
  /// measurement not. O(n^2).
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    const typename Base::Sample at = this->sample(x);
    const Index padded = (this->samples() + 7) / 8 * 8;
    const auto fill = [&](Index first, double* out) {
      const Index count = std::min(tile, padded - first);
      this->kernels(at, first, count, out);
      std::fill(out + count, out + tile, 0.0);
    };
    double k[tile], known = 0;  // 1'A^-1 k
    for (Index first = 0; first < padded; first += tile) {
      fill(first, k);
      for (Index i = 0; i < tile; ++i) known += ones_(first + i) * k[i];
    }
    const double explained = inverse_.square_of_product(fill);
    const double of_mean = (1 - known) * (1 - known) / precision_;
    return signal_deviation_ * std::sqrt(std::max(0.0, 1 - explained) + of_mean);
  }

  /// Variance of each output's function.
  Output signal_variance() const { return signal_deviation_.cwiseAbs2(); }
  /// Variance of the noise of each output, of a sample of weight one.
  Output noise_variance() const { return noise_ratio_ * signal_variance(); }
  /// Noise variance divided by signal variance, the same for all outputs.
  double noise_ratio() const { return noise_ratio_; }

 private:
  static constexpr Index tile = detail::LowerInverseTiles::size;

  detail::LowerInverseTiles inverse_;
  VectorX ones_;  // A^-1 1, padded
  double precision_;
  Output signal_deviation_;
  double noise_ratio_;
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
  /// What the kernel sees of each input.
  InputMap input_map = InputMap::raw;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  /// One an input, in units of what the kernel sees: of scaled inputs, or of sines and cosines (one is about a
  /// radian). Empty: the most likely.
  VectorX length_scales{};
  std::optional<double> noise_ratio{};  ///< noise variance divided by signal variance, positive; none: the most likely
  int starts = 3;                       ///< of the search, at least 1; the first is fixed, the others are drawn
  int iterations = 60;                  ///< of each start at most, at least 1
  /// Beyond it length scales and ratio are searched for on a seeded sample of so many, at least 2; the fit is from all.
  Index max_hyper_samples = 300;

  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the seed draws starts and the sample that decides; the executor shares out the starts
  /// @throws std::invalid_argument for unusable samples, weights or options, and where the ratio, given, is too small
  ///         for the kernel's matrix to be told from a singular one
  template <class X, class Y>
  GaussianProcessPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                                           const Eigen::MatrixBase<Y>& targets,
                                                                           const FitOptions& options = {}) const {
    constexpr int dimension = X::ColsAtCompileTime, outputs = Y::ColsAtCompileTime;
    detail::require_samples("GaussianProcess", inputs, targets, options);
    validate(dimension);
    detail::KernelFeatures features(inputs, input_map, input_scaling);
    const VectorX weights = detail::weights_or_ones(options.weights, inputs.rows());
    const VectorX found = logarithms(features.values, dimension, targets, weights, options);
    const double ratio = std::exp(found(dimension));
    features.divide(found.head(dimension).array().exp().matrix());
    const detail::KernelSystem system(detail::kernel_matrix(kernel, features.values), ratio * weights.cwiseInverse(),
                                      targets);
    require(system.solved, "GaussianProcess: noise_ratio is ", ratio, ", too small for ", inputs.rows(), " samples");
    const Eigen::Matrix<double, outputs, 1> variance =
        (system.square.array().max(0.0) * detail::varying_outputs(targets) / weights.sum()).matrix();
    return {KernelPredictor<dimension, outputs>(kernel, input_map, features.scaling, features.values, system.alpha,
                                                system.mean),
            system, variance, ratio};
  }

 private:
  void validate(int dimension) const {
    require(length_scales.size() == 0 || length_scales.size() == dimension, "GaussianProcess: ", length_scales.size(),
            " length scales for ", dimension, " inputs");
    require(length_scales.size() == 0 || (length_scales.allFinite() && length_scales.minCoeff() > 0),
            "GaussianProcess: the length scales must be positive");
    require(!noise_ratio || (*noise_ratio > 0 && std::isfinite(*noise_ratio)), "GaussianProcess: noise_ratio is ",
            noise_ratio.value_or(0), ", must be positive");
    require(starts >= 1 && iterations >= 1, "GaussianProcess: starts is ", starts, ", iterations is ", iterations,
            ", both must be at least 1");
    require(max_hyper_samples >= 2, "GaussianProcess: max_hyper_samples is ", max_hyper_samples,
            ", must be at least 2");
  }

  /// Of length scales and ratio, as given or found.
  template <class Targets>
  VectorX logarithms(const MatrixX& features, int dimension, const Eigen::MatrixBase<Targets>& targets,
                     const VectorX& weights, const FitOptions& options) const {
    const double tenfold = std::log(10.0);
    VectorX start(dimension + 1), lower(dimension + 1), upper(dimension + 1);
    for (int j = 0; j < dimension; ++j) {
      double square = 0;  // of an input's spread
      for (Index k = j; k < features.cols(); k += dimension)
        square += (features.col(k).array() - features.col(k).mean()).square().mean();
      if (!(square > 0)) square = 1;
      start(j) = 0.5 * std::log(2.0 * dimension * square);  // two samples are typically one length scale apart
      lower(j) = 0.5 * std::log(square) - 1.5 * tenfold;
      upper(j) = 0.5 * std::log(square) + 2 * tenfold;
    }
    start(dimension) = -2 * tenfold;
    lower(dimension) = -8 * tenfold;
    upper(dimension) = 3 * tenfold;
    if (length_scales.size() > 0) {
      start.head(dimension) = length_scales.array().log().matrix();
      lower.head(dimension) = upper.head(dimension) = start.head(dimension);
    }
    if (noise_ratio) lower(dimension) = upper(dimension) = start(dimension) = std::log(*noise_ratio);
    if (length_scales.size() > 0 && noise_ratio) return start;

    Rng rng(options.seed);
    const Index n = features.rows();
    std::vector<Index> rows(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) rows[static_cast<std::size_t>(i)] = i;
    if (n > max_hyper_samples) {
      rows = rng.permutation(n);
      rows.resize(static_cast<std::size_t>(max_hyper_samples));
    }
    const detail::MarginalLikelihood likelihood(kernel, features(rows, Eigen::all), dimension,
                                                MatrixX(targets)(rows, Eigen::all), weights(rows));
    std::vector<detail::BoundedMinimum> found(static_cast<std::size_t>(starts));
    for (std::size_t k = 0; k < found.size(); ++k) {
      found[k].x = start;
      if (k == 0) continue;
      for (int j = 0; j < dimension; ++j) found[k].x(j) += rng.uniform(-0.7, 0.7) * tenfold;
      found[k].x(dimension) = rng.uniform(-6, 0) * tenfold;
    }
    options.executor.for_ranges(starts, [&](Index begin, Index end) {
      for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
        found[k] = detail::minimise_within(likelihood, found[k].x, lower, upper, iterations, 1e-7);
    });
    std::size_t best = 0;
    for (std::size_t k = 1; k < found.size(); ++k)
      if (found[k].value < found[best].value) best = k;
    return found[best].x;
  }
};

}  // namespace vernier
