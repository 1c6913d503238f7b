#pragma once

/// @file
/// How likely hyper-parameters of a Gaussian process make its targets, with the exact gradient.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "vernier/regression/kernel_system.hpp"

namespace vernier::detail {

/// Outputs that vary by more than rounding.
template <class Targets>
Eigen::ArrayXd varying_outputs(const Eigen::MatrixBase<Targets>& targets) {
  Eigen::ArrayXd out(targets.cols());
  for (Index o = 0; o < targets.cols(); ++o) {
    const double low = targets.col(o).minCoeff(), high = targets.col(o).maxCoeff();
    out(o) = high - low > 1e-12 * std::max(std::abs(low), std::abs(high)) ? 1 : 0;
  }
  return out;
}

/// The log marginal likelihood of a Gaussian process, summed over outputs that share length scales and the ratio of
/// noise to signal variance. Mean and signal variance of each output are at their best, which has a closed form
/// (`s^2 = r / N`, `r = (T - mean)' A^-1 (T - mean)`, `A = K + ratio W^-1`, N the sum of the weights), so the unknowns
/// are the logarithms of the length scales, one an input, and of the ratio, which comes last. A sample of weight w
/// counts as w samples: its likelihood is raised to the power of w. Constant outputs are left out.
/// @cite Rasmussen and Williams 2006
template <class Scalar>  // a template so that only users pay for compiling it
class MarginalLikelihoodOf {
 public:
  /// @param features n x features before length scales; feature j belongs to input j modulo `inputs`
  /// @param targets  n x outputs
  /// @param weights  n
  MarginalLikelihoodOf(Kernel kernel, MatrixX features, int inputs, MatrixX targets, VectorX weights)
      : kernel_(kernel),
        features_(std::move(features)),
        inputs_(inputs),
        targets_(std::move(targets)),
        weights_(std::move(weights)),
        varying_(varying_outputs(targets_)) {}

  /// Minus the log likelihood for each unit of weight and output, and its gradient; infinity where A is singular.
  /// O(n^3).
  double operator()(const VectorX& logarithms, VectorX& gradient) const {
    const Index n = features_.rows();
    const double ratio = std::exp(logarithms(inputs_)), total = weights_.sum(), outputs = varying_.sum();
    gradient = VectorX::Zero(inputs_ + 1);
    if (outputs == 0) return 0;
    MatrixX x = features_;
    for (Index j = 0; j < x.cols(); ++j) x.col(j) *= std::exp(-logarithms(j % inputs_));
    const VectorX noise = ratio * weights_.cwiseInverse();
    const KernelSystem system(kernel_matrix(kernel_, x), noise, targets_);
    if (!system.solved) return std::numeric_limits<double>::infinity();

    const double shared = system.log_determinant() + (total - static_cast<double>(n)) * logarithms(inputs_) +
                          weights_.array().log().sum() + total * (1 + std::log(2 * std::numbers::pi));
    double likelihood = -0.5 * outputs * shared;
    // A^-1 outputs - sum of alpha alpha' / s^2, its lower triangle
    MatrixX pull = outputs * inverse(system.factor);
    for (Index o = 0; o < targets_.cols(); ++o) {
      if (varying_(o) == 0) continue;
      const double variance = system.square(o) / total;
      if (!(variance > 0)) return std::numeric_limits<double>::infinity();
      likelihood -= 0.5 * total * std::log(variance);
      pull.template selfadjointView<Eigen::Lower>().rankUpdate(system.alpha.col(o), -1 / variance);
    }
    gradient(inputs_) = -0.5 * (pull.diagonal().dot(noise) + outputs * (total - static_cast<double>(n)));
    for (Index b = 0; b < n; ++b) {  // all pairs once, so twice the half
      const Index rest = n - b - 1;
      MatrixX square = (x.bottomRows(rest).rowwise() - x.row(b)).cwiseAbs2();
      const VectorX pulled = pull.col(b).tail(rest).cwiseProduct(slope(square.rowwise().sum()));
      for (Index j = 0; j < x.cols(); ++j) gradient(j % inputs_) -= pulled.dot(square.col(j));
    }
    const double scale = -1 / (total * outputs);
    gradient *= scale;
    return scale * likelihood;
  }

 private:
  /// From the factor in the lower triangle: the inverse, both triangles.
  static MatrixX inverse(const MatrixX& factor) {
    MatrixX out = MatrixX::Identity(factor.rows(), factor.rows());
    factor.template triangularView<Eigen::Lower>().solveInPlace(out);
    factor.template triangularView<Eigen::Lower>().transpose().solveInPlace(out);
    return out;
  }

  /// Derivative of the kernel with respect to the logarithm of a length scale, divided by the square of the distance
  /// along it.
  VectorX slope(const VectorX& square) const {
    if (kernel_ == Kernel::squared_exponential) return (-0.5 * square.array()).exp().matrix();
    const Eigen::ArrayXd s = (5 * square.array()).sqrt();
    return (5.0 / 3 * (1 + s) * (-s).exp()).matrix();
  }

  Kernel kernel_;
  MatrixX features_;
  int inputs_;
  MatrixX targets_;
  VectorX weights_;
  Eigen::ArrayXd varying_;
};

/// In double precision.
using MarginalLikelihood = MarginalLikelihoodOf<double>;

}  // namespace vernier::detail
