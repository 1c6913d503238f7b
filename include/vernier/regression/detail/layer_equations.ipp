// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/regression/detail/layer_equations.hpp"
#include "vernier/regression/detail/tile_product_kernel.hpp"

namespace vernier::detail {

/// Arguments of the kernel: raw blocks, so that it is compiled once for each instruction set.
struct NormalEquationsBlock {
  const double* features;  // samples x inputs, column-major
  const double* targets;   // samples x outputs, column-major
  const double* weights;   // (inputs + 1) rows of `stride`, biases last
  const double* shift;     // of the nodes, taken off their outputs; or null
  const double* scale;     // of the samples, a factor of their rows; or null
  double* tile;            // tile_samples rows of `stride`, or all samples where they are kept
  double* products;        // stride x stride, zero on entry; blocks on and right of the diagonal are added to
  Index samples, inputs, outputs, nodes, stride, tile_samples;
  bool tanh, keep;
};

/// Hidden layer, activation and product, tile by tile.
template <int W, int Rows, int Vectors>
VERNIER_INLINE void normal_equations_kernel(const NormalEquationsBlock& b) {
  for (Index begin = 0; begin < b.samples; begin += b.tile_samples) {
    const Index samples = (std::min)(b.tile_samples, b.samples - begin);
    double* tile = b.tile + (b.keep ? begin * b.stride : 0);
    for (Index s = 0; s < samples; ++s) {
      double* row = tile + s * b.stride;
      for (Index j = 0; j < b.nodes; j += W) {
        typename Simd<W>::Double z, w;
        load<W>(z, b.weights + b.inputs * b.stride + j);
        for (Index f = 0; f < b.inputs; ++f) {
          load<W>(w, b.weights + f * b.stride + j);
          z += b.features[f * b.samples + begin + s] * w;
        }
        if (b.tanh) z += z;
        sigmoid<W>(z);
        if (b.tanh) z = 2.0 * z - 1.0;
        if (b.shift != nullptr) {
          load<W>(w, b.shift + j);
          z -= w;
        }
        store<W>(row + j, z);
      }
      for (Index k = 0; k < b.outputs; ++k) row[b.nodes + k] = b.targets[k * b.samples + begin + s];
      if (b.scale != nullptr)
        for (Index k = 0; k < b.nodes + b.outputs; ++k) row[k] *= b.scale[begin + s];
      for (Index k = b.nodes + b.outputs; k < b.stride; ++k) row[k] = 0;
    }
    tile_product<W, Rows, Vectors>(tile, tile, b.products, b.stride, samples, true);
  }
}

VERNIER_IMPL LayerEquations::LayerEquations(const HiddenLayer& layer, const MatrixX& features, const MatrixX& targets,
                                            InstructionSet set, bool keep, const double* scale)
    : layer_(layer), features_(features), targets_(targets), set_(set), keep_(keep), scale_(scale) {
  stride_ = (layer.nodes + targets.cols() + 7) / 8 * 8;
  tile_samples_ = std::max<Index>(8, 3072 / stride_);  // 24 KiB
  weights_.resize(static_cast<std::size_t>((features.cols() + 1) * stride_));
  tile_.resize(static_cast<std::size_t>((keep ? features.rows() : tile_samples_) * stride_));
  shift_.resize(static_cast<std::size_t>(stride_));
  products_.resize(stride_, stride_);
}

VERNIER_IMPL void LayerEquations::form(const ConstVectorRef& theta, const double* shift) {
  const Index f = features_.cols();
  for (Index k = 0; k < layer_.nodes; ++k)
    for (Index j = 0; j <= f; ++j) weights_[static_cast<std::size_t>(j * stride_ + k)] = theta(k * (f + 1) + j);
  if (shift != nullptr) std::copy(shift, shift + layer_.nodes, shift_.begin());  // padded
  products_.setZero();
  const NormalEquationsBlock block{features_.data(),
                                   targets_.data(),
                                   weights_.data(),
                                   shift != nullptr ? shift_.data() : nullptr,
                                   scale_,
                                   tile_.data(),
                                   products_.data(),
                                   features_.rows(),
                                   f,
                                   targets_.cols(),
                                   layer_.nodes,
                                   stride_,
                                   tile_samples_,
                                   layer_.activation == Activation::tanh,
                                   keep_};
  run_widest([&]<int W>() VERNIER_INLINED { normal_equations_kernel<W, block_rows<W>, block_vectors<W>>(block); },
             set_);
}

}  // namespace vernier::detail
