// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/leave_one_out.hpp"
#include "vernier/regression/detail/tile_product_kernel.hpp"

namespace vernier::detail {

/// Adds rows x inner times inner x cols, all by rows; `cols` is a multiple of 8.
template <int W, int Rows, int Vectors>
VERNIER_INLINE void row_product_block(const double* a, Index lda, const double* b, Index ldb, double* out, Index ldo,
                                      Index inner) {
  typename Simd<W>::Double sum[Rows][Vectors], right[Vectors];
  VERNIER_UNROLL
  for (int r = 0; r < Rows; ++r) {
    VERNIER_UNROLL
    for (int v = 0; v < Vectors; ++v) load<W>(sum[r][v], out + r * ldo + v * W);
  }
  for (Index k = 0; k < inner; ++k) {
    VERNIER_UNROLL
    for (int v = 0; v < Vectors; ++v) load<W>(right[v], b + k * ldb + v * W);
    VERNIER_UNROLL
    for (int r = 0; r < Rows; ++r) {
      VERNIER_UNROLL
      for (int v = 0; v < Vectors; ++v) sum[r][v] += a[r * lda + k] * right[v];
    }
  }
  VERNIER_UNROLL
  for (int r = 0; r < Rows; ++r) {
    VERNIER_UNROLL
    for (int v = 0; v < Vectors; ++v) store<W>(out + r * ldo + v * W, sum[r][v]);
  }
}

/// As `row_product_block`, any number of rows and columns.
template <int W, int Rows, int Vectors>
VERNIER_INLINE void row_product(const double* a, Index lda, const double* b, Index cols, double* out, Index rows,
                                Index inner) {
  Index j = 0;
  const auto panel = [&]<int Width>() VERNIER_INLINED {
    Index i = 0;
    for (; i + Rows <= rows; i += Rows)
      row_product_block<W, Rows, Width>(a + i * lda, lda, b + j, cols, out + i * cols + j, cols, inner);
    for (; i < rows; ++i)
      row_product_block<W, 1, Width>(a + i * lda, lda, b + j, cols, out + i * cols + j, cols, inner);
    j += Width * W;
  };
  while (j + Vectors * W <= cols) panel.template operator()<Vectors>();
  while (j < cols) panel.template operator()<1>();
}

/// Arguments of the second pass. Columns of all matrices are padded to multiples of 8.
struct LeaveOneOutBlock {
  const double* hidden;    // samples rows of `stride`: outputs of the nodes, then the targets
  const double* rotation;  // nodes x rotated
  const double* start;     // rotated: minus the mean of the rotated outputs
  const double* shares;    // nodes x lambdas: 1 / (s_j^2 + lambda)
  const double* weights;   // nodes x (outputs lambdas): of the rotated outputs
  const double* mean;      // of the targets
  double* scratch;         // tile_samples (2 rotated + (1 + outputs) lambdas)
  double* sums;            // lambdas, added to: squared left-out errors
  double* least;           // lambdas, lowered to: the least 1 - leverage
  Index samples, stride, nodes, outputs, rotated, lambdas;

  static constexpr Index tile_samples = 32;
};

template <int W, int Rows, int Vectors>
VERNIER_INLINE void leave_one_out_kernel(const LeaveOneOutBlock& b) {
  double* p = b.scratch;
  double* squares = p + b.tile_samples * b.rotated;
  double* leverage = squares + b.tile_samples * b.rotated;
  double* fit = leverage + b.tile_samples * b.lambdas;
  const double mean_share = 1 / static_cast<double>(b.samples);
  const Index width = b.outputs * b.lambdas;
  for (Index begin = 0; begin < b.samples; begin += b.tile_samples) {
    const Index n = (std::min)(b.tile_samples, b.samples - begin);
    const double* rows = b.hidden + begin * b.stride;
    for (Index s = 0; s < n; ++s) std::copy(b.start, b.start + b.rotated, p + s * b.rotated);
    row_product<W, Rows, Vectors>(rows, b.stride, b.rotation, b.rotated, p, n, b.nodes);
    for (Index k = 0; k < n * b.rotated; ++k) squares[k] = p[k] * p[k];
    std::fill(leverage, leverage + n * b.lambdas, mean_share);
    row_product<W, Rows, Vectors>(squares, b.rotated, b.shares, b.lambdas, leverage, n, b.nodes);
    std::fill(fit, fit + n * width, 0.0);
    row_product<W, Rows, Vectors>(p, b.rotated, b.weights, width, fit, n, b.nodes);
    for (Index s = 0; s < n; ++s) {
      double* square = squares;  // of each lambda; what was there has been used
      std::fill(square, square + b.lambdas, 0.0);
      for (Index o = 0; o < b.outputs; ++o) {
        const double target = rows[s * b.stride + b.nodes + o] - b.mean[o];
        const double* predicted = fit + s * width + o * b.lambdas;
        for (Index l = 0; l < b.lambdas; ++l) square[l] += (target - predicted[l]) * (target - predicted[l]);
      }
      const double* of_sample = leverage + s * b.lambdas;
      for (Index l = 0; l < b.lambdas; ++l) {
        const double rest = 1 - of_sample[l];
        b.sums[l] += square[l] / (rest * rest);
        b.least[l] = rest < b.least[l] ? rest : b.least[l];
      }
    }
  }
}

VERNIER_IMPL LeaveOneOutError::LeaveOneOutError(const HiddenLayer& layer, const MatrixX& features,
                                                const MatrixX& targets, InstructionSet set)
    : layer_(layer),
      samples_(features.rows()),
      outputs_(targets.cols()),
      rotated_((layer.nodes + 7) / 8 * 8),
      set_(set),
      mean_target_(column_means(targets)),
      mean_feature_(VERNIER_LATER(column_means(features)).transpose()),
      targets_and_ones_(samples_, outputs_ + 1),
      equations_(layer, features, targets_and_ones_, set, true) {
  VERNIER_LATER(targets_and_ones_).leftCols(outputs_) = targets;
  VERNIER_LATER(targets_and_ones_).col(outputs_).setOnes();
  centred_square_ = rows_minus(targets, mean_target_).squaredNorm();
  scratch_.resize(
      static_cast<std::size_t>(LeaveOneOutBlock::tile_samples * (2 * rotated_ + (1 + outputs_) * padded_lambdas)));
}

VERNIER_IMPL double LeaveOneOutError::operator()(const ConstVectorRef& theta) {
  const double n = static_cast<double>(samples_);
  const Index h = layer_.nodes;
  // nodes less their output at the mean features, so that centring cancels little
  layer_.outputs(mean_feature_, theta, shift_);
  equations_.form(theta, shift_.data());
  const ConstMatrixRef products = equations_.right();
  const VectorX mean = row_of(products, outputs_) / n;
  MatrixX gram = equations_.gram();
  const double raw = diagonal_of(gram).sum();
  for (Index c = 0; c < h; ++c)
    for (Index r = c; r < h; ++r) gram(r, c) -= n * mean(r) * mean(c);
  const SymmetricEigen eigen = symmetric_eigen(gram);
  const double mean_alone = centred_square_ * (n / (n - 1)) * (n / (n - 1));
  const double scale = eigen.values(h - 1);
  if (!eigen.converged || !(scale * 100 > raw) || !std::isfinite(scale)) return -1;

  MatrixX right(h, outputs_);
  for (Index o = 0; o < outputs_; ++o)
    for (Index k = 0; k < h; ++k) right(k, o) = products(o, k) - mean(k) * (n * mean_target_(o));
  const MatrixX rotated_right = transposed_matrix_product(eigen.vectors, right);
  MatrixX rotation = MatrixX::Zero(rotated_, h), shares = MatrixX::Zero(padded_lambdas, h),
          weights = MatrixX::Zero(outputs_ * padded_lambdas, h);
  VERNIER_LATER(rotation).topRows(h) = VERNIER_LATER(eigen.vectors).transpose();
  const VectorX start = -product(rotation, mean);
  for (Index l = 0; l < lambdas; ++l) {
    const double lambda = scale * std::pow(10.0, -0.5 * static_cast<double>(l));
    for (Index k = 0; k < h; ++k) {
      shares(l, k) = 1 / ((std::max)(eigen.values(k), 0.0) + lambda);
      for (Index o = 0; o < outputs_; ++o) weights(o * padded_lambdas + l, k) = rotated_right(k, o) * shares(l, k);
    }
  }
  VectorX sums = VectorX::Zero(padded_lambdas), least = VectorX::Ones(padded_lambdas);
  const LeaveOneOutBlock block{.hidden = equations_.outputs(),
                               .rotation = rotation.data(),
                               .start = start.data(),
                               .shares = shares.data(),
                               .weights = weights.data(),
                               .mean = mean_target_.data(),
                               .scratch = scratch_.data(),
                               .sums = sums.data(),
                               .least = least.data(),
                               .samples = samples_,
                               .stride = equations_.stride(),
                               .nodes = h,
                               .outputs = outputs_,
                               .rotated = rotated_,
                               .lambdas = padded_lambdas};
  run_widest([&]<int W>() VERNIER_INLINED { leave_one_out_kernel<W, block_rows<W>, block_vectors<W>>(block); }, set_);
  const Index at = std::min_element(sums.data(), sums.data() + lambdas) - sums.data();
  const double best = sums(at);
  if (at >= trusted || !(least(at) > 1e-2) || !std::isfinite(best)) return -1;
  return (std::min)(best, mean_alone) / n;
}

}  // namespace vernier::detail
