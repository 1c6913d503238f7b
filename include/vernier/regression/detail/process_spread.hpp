// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The posterior standard deviation of a Gaussian process.

#include <vector>

#include "vernier/regression/detail/kernel_system.hpp"

namespace vernier::detail {

/// The inverse of a lower triangular matrix in square tiles, those on and below the diagonal row by row.
class LowerInverseTiles {
 public:
  static constexpr Index size = 64;  ///< of a tile

  /// @param factor n x n, its lower triangle; n^3 / 3 multiply-adds
  VERNIER_API explicit LowerInverseTiles(const MatrixX& factor);
  /// Values that `values` returned.
  /// @throws std::invalid_argument where they are no triangle of tiles
  VERNIER_API explicit LowerInverseTiles(std::vector<double> values);

  /// All values, tile by tile.
  const std::vector<double>& values() const { return tiles_; }
  /// Number of rows, a multiple of `size`.
  Index rows() const { return rows_ * size; }

  /// |M k|^2 for the values k of nodes at a sample, which are evaluated tile by tile: once for each row of tiles at or
  /// below them. Does not allocate.
  VERNIER_API double square_of_product(const NodeSum& nodes, const double* features) const noexcept;

 private:
  static std::size_t offset(Index i, Index j) { return static_cast<std::size_t>((i * (i + 1) / 2 + j) * size * size); }

  Index rows_ = 0;  // of tiles
  std::vector<double> tiles_;
};

/// What a `ProcessSpread` is made of.
struct SpreadParts {
  std::vector<double> inverse{};  ///< of the Cholesky factor, as `LowerInverseTiles::values` has it
  VectorX ones{};                 ///< A^-1 1, zero beyond the samples
  double precision = 0;           ///< 1' A^-1 1
  VectorX signal_deviation{};     ///< one an output
  double noise_ratio = 0;         ///< of noise to signal variance
};

/// The uncertainty of a `GaussianProcessPredictor`.
class ProcessSpread {
 public:
  /// @param system          the linear system of the fit
  /// @param signal_variance one an output
  /// @param noise_ratio     of noise to signal variance
  VERNIER_API ProcessSpread(const KernelSystem& system, const VectorX& signal_variance, double noise_ratio);
  /// Of its parts.
  /// @throws std::invalid_argument for sizes that do not fit together
  VERNIER_API explicit ProcessSpread(const SpreadParts& parts);

  /// What it is made of.
  SpreadParts parts() const { return {inverse_.values(), ones_, precision_, signal_deviation_, noise_ratio_}; }
  /// Number of samples, rounded up to a multiple of `LowerInverseTiles::size`.
  Index padded_samples() const { return inverse_.rows(); }

  /// Standard deviation of each output at a sample. Does not allocate.
  /// @param kernels   of the fit
  /// @param x         inputs
  /// @param out       outputs
  /// @param workspace `NodeSum::workspace(inputs)` numbers
  VERNIER_API void standard_deviation(const NodeSum& kernels, const double* x, double* out,
                                      double* workspace) const noexcept;

  /// Standard deviation of each output's function.
  const VectorX& signal_deviation() const { return signal_deviation_; }
  /// Noise variance divided by signal variance.
  double noise_ratio() const { return noise_ratio_; }

 private:
  LowerInverseTiles inverse_;
  VectorX ones_;  // A^-1 1, padded
  double precision_;
  VectorX signal_deviation_;
  double noise_ratio_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/process_spread.ipp"
#endif
