// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/concepts.hpp"
#include "vernier/regression/detail/feature_ridge.hpp"

namespace vernier::detail {

/// Lower triangle of a'a.
VERNIER_LOCAL MatrixX lower_gram(const MatrixX& a) {
  constexpr Index width = 128;
  MatrixX out = MatrixX::Zero(a.cols(), a.cols());
  for (Index first = 0; first < a.cols(); first += width) {
    const Index rest = a.cols() - first, count = (std::min)(width, rest);
    add_transposed_product(VERNIER_LATER(out).block(first, first, rest, count),
                           VERNIER_LATER(a).middleCols(first, rest), VERNIER_LATER(a).middleCols(first, count));
  }
  return out;
}

VERNIER_IMPL FeatureRidge::FeatureRidge(const ConstMatrixRef& features, const ConstMatrixRef& targets,
                                        const VectorX* weights)
    : weights_(weights_or_ones(weights, features.rows())),
      total_(weights_.sum()),
      mean_features_(transposed_product(features, weights_) / total_),
      mean_targets_(transposed_product(targets, weights_) / total_) {
  const VectorX root = VERNIER_LATER(weights_).cwiseSqrt();
  features_ = rows_scaled(root, rows_minus(features, mean_features_));
  targets_ = rows_scaled(root, rows_minus(targets, mean_targets_));
  if (features_.cols() == 0) {
    left_.resize(features_.rows(), 0);
    projected_.resize(0, targets_.cols());
    return;
  }
  const bool dual = features_.rows() < features_.cols();
  SymmetricEigen eigen =
      symmetric_eigen(dual ? lower_gram(VERNIER_LATER(features_).transpose()) : lower_gram(features_));
  const Index k = eigen.values.size();
  const double top = std::max<double>(eigen.values(k - 1), 0), threshold = (std::max)(1e-14 * top, 1e-300);
  Index rank = 0;
  while (rank < k && eigen.values(k - 1 - rank) > threshold) ++rank;
  squares_ = VERNIER_LATER(eigen.values).tail(rank);
  VectorX inverse = squares_;
  for (double& value : inverse) value = 1 / std::sqrt(value);
  const MatrixX vectors = VERNIER_LATER(eigen.vectors).rightCols(rank), scaled = columns_scaled(vectors, inverse);
  left_ = dual ? vectors : matrix_product(features_, scaled);
  right_ = dual ? transposed_matrix_product(features_, scaled) : vectors;
  projected_ = transposed_matrix_product(left_, targets_);
}

VERNIER_IMPL FeatureRidgeFit FeatureRidge::fit(double lambda) const {
  if (lambda < least * largest()) return from_samples(lambda);
  MatrixX beta = MatrixX::Zero(features_.cols(), targets_.cols());
  if (!std::isfinite(lambda) || squares_.size() == 0) return finish(lambda, beta, 0, {}, {}, 0);
  VectorX gain = squares_;
  for (double& value : gain) value = 1 / (value + lambda);
  for (int step = 0; step < 3; ++step) {  // the products lose digits that the samples have: refinement
    MatrixX gradient = transposed_matrix_product(features_, residual_of(beta));
    gradient -= lambda * beta;
    add_product(beta, right_, rows_scaled(gain, transposed_matrix_product(right_, gradient)));
  }
  return finish(lambda, beta, squares_.dot(gain), right_, gain, squares_.size() < features_.cols() ? 1 / lambda : 0);
}

VERNIER_IMPL FeatureRidgeFit FeatureRidge::best_fit() const {
  constexpr Index candidates = 27;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (features_.rows() < 2 || squares_.size() == 0) return fit(infinity);
  VectorX lambdas(candidates + 1);
  for (Index l = 0; l < candidates; ++l) lambdas(l) = largest() * least * std::pow(10.0, 0.5 * static_cast<double>(l));
  lambdas(candidates) = infinity;
  Index best = 0;
  const double error = leave_one_out(lambdas).minCoeff(&best);
  if (best == 0 && features_.rows() > features_.cols() + 1) {
    FeatureRidgeFit exact = from_samples(1e-20 * largest());
    VectorX left = squared_row_norms(matrix_product(features_, exact.directions));
    for (Index i = 0; i < left.size(); ++i) left(i) = 1 - weights_(i) / total_ - left(i);
    if (left_out_error(residual_of(exact.coefficients), left) < error) return exact;
  }
  return fit(lambdas(best));
}

VERNIER_IMPL VectorX FeatureRidge::leave_one_out(const VectorX& lambdas) const {
  const Index n = features_.rows(), k = squares_.size(), m = targets_.cols();
  MatrixX kept = MatrixX::Ones(k, lambdas.size());
  for (Index l = 0; l < lambdas.size(); ++l)
    for (Index d = 0; d < k && std::isfinite(lambdas(l)); ++d) kept(d, l) = lambdas(l) / (squares_(d) + lambdas(l));
  // What the directions do not span; where they span all centred samples, nothing but rounding.
  VectorX spare = VectorX::Zero(n);
  MatrixX rest = MatrixX::Zero(n, m);
  if (k < n - 1) {
    const VectorX spanned = squared_row_norms(left_);
    for (Index i = 0; i < n; ++i) spare(i) = (std::max)(1 - weights_(i) / total_ - spanned(i), 0.0);
    rest = targets_;
    add_product(rest, left_, projected_, -1);
  }
  const MatrixX share = matrix_product(VERNIER_LATER(left_).cwiseAbs2(), kept);
  VectorX out(lambdas.size());
  for (Index l = 0; l < lambdas.size(); ++l) {
    MatrixX residual = rest;
    add_product(residual, left_, rows_scaled(VERNIER_LATER(kept).col(l), projected_));
    VectorX one_minus_leverage = VERNIER_LATER(share).col(l);
    one_minus_leverage += spare;
    out(l) = left_out_error(residual, one_minus_leverage);
  }
  return out;
}

VERNIER_IMPL MatrixX FeatureRidge::residual_of(const MatrixX& beta) const {
  MatrixX out = targets_;
  add_product(out, features_, beta, -1);
  return out;
}

VERNIER_IMPL double FeatureRidge::left_out_error(const MatrixX& residual, const VectorX& one_minus_leverage) const {
  const VectorX squares = squared_row_norms(residual);
  double sum = 0;
  for (Index i = 0; i < squares.size(); ++i) {
    const double share = (std::min)(1.0, 1 / weights_(i)), left = (1 - share) + share * one_minus_leverage(i);
    sum += squares(i) / (std::max)(left * left, 1e-300);
  }
  return sum / total_;
}

VERNIER_IMPL FeatureRidgeFit FeatureRidge::from_samples(double lambda) const {
  const Index n = features_.rows(), f = features_.cols();
  MatrixX stacked = MatrixX::Zero(n + f, f), right = MatrixX::Zero(n + f, targets_.cols());
  VERNIER_LATER(stacked).topRows(n) = features_;
  VERNIER_LATER(right).topRows(n) = targets_;
  for (Index k = 0; k < f; ++k) stacked(n + k, k) = std::sqrt(lambda);
  const QrSolution qr = solve_by_qr(stacked, right);
  MatrixX inverse = MatrixX::Identity(f, f);
  solve_lower_transposed(VERNIER_LATER(qr.triangle).transpose(), inverse);
  return finish(lambda, qr.solution, static_cast<double>(f) - lambda * inverse.squaredNorm(), inverse, VectorX::Ones(f),
                0);
}

VERNIER_IMPL FeatureRidgeFit FeatureRidge::finish(double lambda, const MatrixX& beta, double used,
                                                  const MatrixX& directions, const VectorX& gain, double rest) const {
  const double freedom = (std::max)(total_ - 1 - used, 1e-12 * total_);
  const VectorX offset = mean_targets_ - transposed_product(beta, mean_features_);
  return {lambda, beta, offset, squared_column_norms(residual_of(beta)) / freedom, directions, gain, rest};
}

}  // namespace vernier::detail
