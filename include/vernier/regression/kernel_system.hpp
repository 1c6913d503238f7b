#pragma once

/// @file
/// The linear system of kernel methods: (K + N) alpha = T - mean, with the mean that fits best beside it.

#include <Eigen/Cholesky>
#include <utility>

#include "vernier/regression/kernel_predictor.hpp"

namespace vernier::detail {

/// What a kernel sees of samples.
struct KernelFeatures {
  InputMap input_map;     ///< of each input
  ColumnScaling scaling;  ///< of the mapped features
  MatrixX values;         ///< n x features, mapped and scaled

  /// Mapped, scaled by what they are.
  template <class X>
  KernelFeatures(const Eigen::MatrixBase<X>& inputs, InputMap map, Scaling input_scaling) : input_map(map) {
    const HiddenLayer layer{.nodes = 1, .input_map = map, .input_scaling = input_scaling};
    const MatrixX mapped = layer.map(inputs);
    scaling = layer.scaling(mapped);
    values = scaling.apply(mapped);
  }

  /// Divides by length scales, one an input.
  void divide(const VectorX& length_scales) {
    for (Index j = 0; j < values.cols(); ++j) {
      const double length = length_scales(j % length_scales.size());
      scaling.factor(j) /= length;
      values.col(j) /= length;
    }
  }
};

/// The Cholesky factor of `A = K + diag(noise)` and what follows from it. The mean is that of generalised least
/// squares, so that alpha sums to zero: `mean = 1'A^-1 T / 1'A^-1 1`, `alpha = A^-1 (T - 1 mean)`. O(n^3).
template <class Scalar>  // a template so that only users pay for compiling it
struct KernelSystemOf {
  MatrixX factor;    ///< A's Cholesky factor, in the lower triangle
  VectorX ones;      ///< A^-1 1
  double precision;  ///< 1'A^-1 1
  VectorX mean;      ///< one an output
  MatrixX alpha;     ///< n x outputs
  VectorX square;    ///< (T - mean)'A^-1 (T - mean), one an output
  bool solved;       ///< false where A is not positive definite; then nothing else holds

  /// @param a       K, its lower triangle
  /// @param noise   added to its diagonal
  /// @param targets n x outputs
  template <class Targets>
  KernelSystemOf(MatrixX a, const VectorX& noise, const Eigen::MatrixBase<Targets>& targets) : factor(std::move(a)) {
    factor.diagonal() += noise;
    const Eigen::LLT<Eigen::Ref<MatrixX>> llt(factor);  // in place
    solved = llt.info() == Eigen::Success;
    if (!solved) return;
    const Index n = factor.rows();
    const Index m = targets.cols();
    const Eigen::RowVectorXd centre = targets.colwise().mean();  // first, so that little cancels later
    MatrixX right(n, 1 + m);
    right << VectorX::Ones(n), targets.rowwise() - centre;
    const MatrixX solution = llt.solve(right);
    ones = solution.col(0);
    precision = ones.sum();
    mean = solution.rightCols(m).colwise().sum().transpose() / precision;
    alpha = solution.rightCols(m) - ones * mean.transpose();
    square = right.rightCols(m).cwiseProduct(alpha).colwise().sum().transpose();
    mean += centre.transpose();
  }

  /// log |A|
  double log_determinant() const { return 2 * factor.diagonal().array().log().sum(); }
};

/// In double precision.
using KernelSystem = KernelSystemOf<double>;

}  // namespace vernier::detail
