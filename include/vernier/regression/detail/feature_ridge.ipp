#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/concepts.hpp"
#include "vernier/regression/detail/feature_ridge.hpp"

namespace vernier::detail {

VERNIER_IMPL FeatureRidge::FeatureRidge(const ConstMatrixRef& features, const ConstMatrixRef& targets,
                                        const VectorX* weights)
    : weights_(weights_or_ones(weights, features.rows())), total_(weights_.sum()) {
  const VectorX root = weights_.cwiseSqrt();
  mean_features_ = (weights_.transpose() * features) / total_;
  mean_targets_ = (weights_.transpose() * targets) / total_;
  features_ = root.asDiagonal() * (features.rowwise() - mean_features_);
  targets_ = root.asDiagonal() * (targets.rowwise() - mean_targets_);
  if (features_.cols() == 0) {
    left_.resize(features_.rows(), 0);
    projected_.resize(0, targets_.cols());
    return;
  }
  const bool dual = features_.rows() < features_.cols();
  const Index k = std::min(features_.rows(), features_.cols());
  MatrixX products = MatrixX::Zero(k, k);
  dual ? products.selfadjointView<Eigen::Lower>().rankUpdate(features_)
       : products.selfadjointView<Eigen::Lower>().rankUpdate(features_.transpose());
  const SymmetricEigen eigen = symmetric_eigen(products);
  const double top = std::max<double>(eigen.values(k - 1), 0);
  const Index rank = (eigen.values.array() > std::max(1e-14 * top, 1e-300)).count();
  squares_ = eigen.values.tail(rank);
  const VectorX inverse = squares_.cwiseSqrt().cwiseInverse();
  const auto vectors = eigen.vectors.rightCols(rank);
  left_ = dual ? MatrixX(vectors) : MatrixX(features_ * vectors * inverse.asDiagonal());
  right_ = dual ? MatrixX(features_.transpose() * vectors * inverse.asDiagonal()) : MatrixX(vectors);
  projected_ = left_.transpose() * targets_;
}

VERNIER_IMPL FeatureRidgeFit FeatureRidge::fit(double lambda) const {
  if (lambda < least * largest()) return from_samples(lambda);
  if (!std::isfinite(lambda) || squares_.size() == 0)
    return finish(lambda, MatrixX::Zero(features_.cols(), targets_.cols()), 0, {}, {}, 0);
  MatrixX beta = MatrixX::Zero(features_.cols(), targets_.cols());
  const VectorX gain = (squares_.array() + lambda).inverse();
  for (int step = 0; step < 3; ++step) {  // the products lose digits that the samples have: refinement
    const MatrixX gradient = features_.transpose() * (targets_ - features_ * beta) - lambda * beta;
    beta += right_ * (gain.asDiagonal() * (right_.transpose() * gradient));
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
    const VectorX leverage = (features_ * exact.directions).rowwise().squaredNorm();
    if (left_out_error(targets_ - features_ * exact.coefficients, 1 - weights_.array() / total_ - leverage.array()) <
        error)
      return exact;
  }
  return fit(lambdas(best));
}

VERNIER_IMPL VectorX FeatureRidge::leave_one_out(const VectorX& lambdas) const {
  const Index n = features_.rows(), k = squares_.size(), m = targets_.cols();
  MatrixX kept(k, lambdas.size());
  for (Index l = 0; l < lambdas.size(); ++l)
    kept.col(l) =
        std::isfinite(lambdas(l)) ? VectorX(lambdas(l) / (squares_.array() + lambdas(l))) : VectorX(VectorX::Ones(k));
  // What the directions do not span; where they span all centred samples, nothing but rounding.
  VectorX spare = VectorX::Zero(n);
  MatrixX rest = MatrixX::Zero(n, m);
  if (k < n - 1) {
    spare = (1 - weights_.array() / total_ - left_.rowwise().squaredNorm().array()).max(0.0);
    rest = targets_ - left_ * projected_;
  }
  const MatrixX one_minus_leverage = (left_.cwiseAbs2() * kept).colwise() + spare;
  VectorX out(lambdas.size());
  for (Index l = 0; l < lambdas.size(); ++l)
    out(l) = left_out_error(rest + left_ * (kept.col(l).asDiagonal() * projected_), one_minus_leverage.col(l));
  return out;
}

VERNIER_IMPL double FeatureRidge::left_out_error(const MatrixX& residual, const VectorX& one_minus_leverage) const {
  double sum = 0;
  for (Index i = 0; i < residual.rows(); ++i) {
    const double share = std::min(1.0, 1 / weights_(i)), left = (1 - share) + share * one_minus_leverage(i);
    sum += residual.row(i).squaredNorm() / std::max(left * left, 1e-300);
  }
  return sum / total_;
}

VERNIER_IMPL FeatureRidgeFit FeatureRidge::from_samples(double lambda) const {
  const Index n = features_.rows(), f = features_.cols();
  MatrixX stacked(n + f, f), right = MatrixX::Zero(n + f, targets_.cols());
  stacked << features_, std::sqrt(lambda) * MatrixX::Identity(f, f);
  right.topRows(n) = targets_;
  const QrSolution qr = solve_by_qr(stacked, right);
  const MatrixX inverse = qr.triangle.triangularView<Eigen::Upper>().solve(MatrixX::Identity(f, f));
  return finish(lambda, qr.solution, static_cast<double>(f) - lambda * inverse.squaredNorm(), inverse, VectorX::Ones(f),
                0);
}

VERNIER_IMPL FeatureRidgeFit FeatureRidge::finish(double lambda, const MatrixX& beta, double used,
                                                  const MatrixX& directions, const VectorX& gain, double rest) const {
  const VectorX noise =
      (targets_ - features_ * beta).colwise().squaredNorm().transpose() / std::max(total_ - 1 - used, 1e-12 * total_);
  return {lambda, beta, (mean_targets_ - mean_features_ * beta).transpose(), noise, directions, gain, rest};
}

}  // namespace vernier::detail
