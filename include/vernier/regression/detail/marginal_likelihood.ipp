#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "vernier/regression/detail/kernel_system.hpp"
#include "vernier/regression/detail/marginal_likelihood.hpp"

namespace vernier::detail {

VERNIER_IMPL Eigen::ArrayXd varying_outputs(const ConstMatrixRef& targets) {
  Eigen::ArrayXd out(targets.cols());
  for (Index o = 0; o < targets.cols(); ++o) {
    const double low = targets.col(o).minCoeff(), high = targets.col(o).maxCoeff();
    out(o) = high - low > 1e-12 * std::max(std::abs(low), std::abs(high)) ? 1 : 0;
  }
  return out;
}

VERNIER_IMPL double MarginalLikelihood::operator()(const VectorX& logarithms, VectorX& gradient) const {
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
    pull.selfadjointView<Eigen::Lower>().rankUpdate(system.alpha.col(o), -1 / variance);
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

VERNIER_IMPL MatrixX MarginalLikelihood::inverse(const MatrixX& factor) {
  MatrixX out = MatrixX::Identity(factor.rows(), factor.rows());
  factor.triangularView<Eigen::Lower>().solveInPlace(out);
  factor.triangularView<Eigen::Lower>().transpose().solveInPlace(out);
  return out;
}

VERNIER_IMPL VectorX MarginalLikelihood::slope(const VectorX& square) const {
  if (kernel_ == Kernel::squared_exponential) return (-0.5 * square.array()).exp().matrix();
  const Eigen::ArrayXd s = (5 * square.array()).sqrt();
  return (5.0 / 3 * (1 + s) * (-s).exp()).matrix();
}

}  // namespace vernier::detail
