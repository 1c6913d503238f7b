// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The fitted predictor of kernel methods: a constant and a sum of kernels around the samples.

#include "vernier/regression/detail/node_sum.hpp"
#include "vernier/regression/detail/predictor_interface.hpp"

namespace vernier {

/// Covariance of two samples as a function of their distance r in length scales.
/// @cite Rasmussen and Williams 2006
enum class Kernel {
  squared_exponential,  ///< exp(-r^2 / 2), the Gaussian: infinitely smooth
  matern_5_2,           ///< (1 + s + s^2 / 3) exp(-s), s = sqrt(5) r: twice differentiable
};

namespace detail {

/// Exponential of each value, in place.
VERNIER_API void exponentiate(VectorX& values);

/// Squared distances in length scales to values of a kernel, in place.
VERNIER_API void kernel_values(Kernel kernel, VectorX& squares);

/// Kernels of n samples around themselves, features in length scales, n x features; the lower triangle is filled.
VERNIER_API MatrixX kernel_matrix(Kernel kernel, const ConstMatrixRef& features);

/// A fitted sum of kernels.
struct FittedKernels {
  Kernel kernel;          ///< between samples
  InputMap input_map;     ///< features of the inputs
  ColumnScaling scaling;  ///< of the features, length scales included
  MatrixX centres;        ///< n x features, scaled
  MatrixX alpha;          ///< n x outputs
  VectorX mean;           ///< added to every prediction
};

/// @throws std::invalid_argument when the sizes do not fit together
VERNIER_API NodeSum node_sum_of(const FittedKernels& fitted, int inputs);

}  // namespace detail

/// A fitted kernel method: `y = mean + sum_i alpha_i k(x, x_i)`. A prediction costs n exponentials.
template <int Inputs, int Outputs>
class KernelPredictor : public detail::PredictorInterface<KernelPredictor<Inputs, Outputs>, Inputs, Outputs> {
  using Base = detail::PredictorInterface<KernelPredictor<Inputs, Outputs>, Inputs, Outputs>;

 public:
  using typename Base::Input;
  using typename Base::Output;
  using typename Base::Slope;
  /// Coefficients, samples x outputs.
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, Outputs>;

  /// @param kernel    between samples
  /// @param input_map features of the inputs
  /// @param scaling   of the features, length scales included
  /// @param centres   n x features, scaled
  /// @param alpha     n x outputs
  /// @param mean      added to every prediction
  /// @throws std::invalid_argument when the sizes do not fit together
  KernelPredictor(Kernel kernel, InputMap input_map, const ColumnScaling& scaling, const MatrixX& centres,
                  const Coefficients& alpha, const Output& mean)
      : KernelPredictor(detail::FittedKernels{kernel, input_map, scaling, centres, alpha, mean}) {}

  /// The sum for `Inputs` inputs and `Outputs` outputs.
  explicit KernelPredictor(const detail::FittedKernels& fitted)
      : kernel_(fitted.kernel), input_map_(fitted.input_map), sum_(detail::node_sum_of(fitted, Inputs)) {}

  /// The prediction, and where `slope` is not null the derivative.
  void evaluate(const Input& x, Output& y, Slope* slope) const noexcept {
    double workspace[detail::NodeSum::workspace(Inputs)];
    sum_.evaluate(x.data(), y.data(), slope != nullptr ? slope->data() : nullptr, workspace);
  }
  /// Predictions of samples, one a row.
  void evaluate_rows(const ConstMatrixRef& x, MatrixRef y) const { sum_.evaluate_rows(x, y); }

  /// The kernel.
  Kernel kernel() const { return kernel_; }
  /// Features of the inputs.
  InputMap input_map() const { return input_map_; }
  /// Scaling of the features, length scales included.
  const ColumnScaling& scaling() const { return sum_.scaling(); }
  /// Number of samples it was fitted on.
  Index samples() const { return sum_.nodes(); }
  /// The scaled samples, n x features.
  MatrixX centres() const { return sum_.weights().transpose(); }
  /// Coefficients of the kernels, n x outputs.
  Coefficients alpha() const { return sum_.coefficients(); }
  /// Added to every prediction.
  Output mean() const { return sum_.offset(); }

 protected:
  /// The kernels around the samples.
  const detail::NodeSum& kernels() const noexcept { return sum_; }

 private:
  Kernel kernel_;
  InputMap input_map_;
  detail::NodeSum sum_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/kernel_predictor.ipp"
#endif
