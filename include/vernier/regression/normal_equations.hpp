#pragma once

/// @file
/// Normal equations of a sigmoid hidden layer in one pass over the samples: the inner loop of every ELM search.
///
/// A tile of samples goes through hidden layer, activation and symmetric product while it stays in the first-level
/// cache. Targets are further columns of the tile, so H'T and T'T fall out of the same product.

#include <algorithm>
#include <vector>

#include "vernier/regression/hidden_layer.hpp"
#include "vernier/regression/tile_product.hpp"

namespace vernier::detail {

/// What the kernel reads and writes; raw blocks, so that it is compiled once for each instruction set.
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
    const Index samples = std::min(b.tile_samples, b.samples - begin);
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

/// H'H, H'T and T'T of hidden weights, for layers of sigmoid or tanh nodes. Allocates once, in the constructor.
class NormalEquations {
 public:
  static bool supports(Activation activation) {
    return activation == Activation::sigmoid || activation == Activation::tanh;
  }

  /// @param layer    its nodes are sigmoid or tanh
  /// @param features samples x inputs, scaled; must outlive this
  /// @param targets  samples x outputs; must outlive this
  /// @param set      instructions to use; must be there
  /// @param keep     whether the outputs of all nodes are kept
  /// @param scale    factors of the rows of H and T, one a sample, which must outlive this; null for 1
  NormalEquations(const HiddenLayer& layer, const MatrixX& features, const MatrixX& targets,
                  InstructionSet set = widest_instruction_set(), bool keep = false, const double* scale = nullptr)
      : layer_(layer), features_(features), targets_(targets), set_(set), keep_(keep), scale_(scale) {
    stride_ = (layer.nodes + targets.cols() + 7) / 8 * 8;
    tile_samples_ = std::max<Index>(8, 3072 / stride_);  // 24 KiB
    weights_.resize(static_cast<std::size_t>((features.cols() + 1) * stride_));
    tile_.resize(static_cast<std::size_t>((keep ? features.rows() : tile_samples_) * stride_));
    shift_.resize(static_cast<std::size_t>(stride_));
    products_.resize(static_cast<std::size_t>(stride_ * stride_));
  }

  /// Forms the products at weights `theta`, node by node.
  /// @param shift taken off the outputs of the nodes; null for nothing
  void form(const Eigen::Ref<const VectorX>& theta, const double* shift = nullptr) {
    const Index f = features_.cols();
    for (Index k = 0; k < layer_.nodes; ++k)
      for (Index j = 0; j <= f; ++j) weights_[static_cast<std::size_t>(j * stride_ + k)] = theta(k * (f + 1) + j);
    if (shift != nullptr) std::copy(shift, shift + layer_.nodes, shift_.begin());  // padded
    std::fill(products_.begin(), products_.end(), 0.0);
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

  /// Where they are kept: a row a sample, `stride()` apart, outputs of the nodes (less their shift), then the targets.
  const double* outputs() const { return tile_.data(); }
  Index stride() const { return stride_; }
  /// H'H, nodes x nodes; its lower triangle.
  auto gram() const { return view().topLeftCorner(layer_.nodes, layer_.nodes); }
  /// T'H, outputs x nodes.
  auto right() const { return view().block(layer_.nodes, 0, targets_.cols(), layer_.nodes); }
  /// |T|^2.
  double target_square() const { return view().diagonal().segment(layer_.nodes, targets_.cols()).sum(); }

 private:
  Eigen::Map<const MatrixX> view() const { return {products_.data(), stride_, stride_}; }  // transposed: lower triangle

  HiddenLayer layer_;
  const MatrixX& features_;
  const MatrixX& targets_;
  InstructionSet set_;
  bool keep_;
  const double* scale_;
  Index stride_ = 0, tile_samples_ = 0;
  std::vector<double> weights_, shift_, tile_, products_;
};

}  // namespace vernier::detail
