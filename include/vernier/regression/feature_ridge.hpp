#pragma once

/// @file
/// Ridge regression on many given features: for every lambda, with sample weights, from one symmetric decomposition.

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/regression/concepts.hpp"

namespace vernier::detail {

/// One ridge regression, and what it leaves unknown: along a direction d of features the coefficients have the variance
/// `sum_k gain_k (direction_k'd)^2 + rest (|d|^2 - sum_k (direction_k'd)^2)`, in units of the variance of the noise.
struct FeatureRidgeFit {
  double lambda;         ///< infinity: the mean alone
  MatrixX coefficients;  ///< f x m
  VectorX offset;        ///< m
  VectorX noise;         ///< variance of a measurement of weight 1, m
  MatrixX directions;    ///< f x k
  VectorX gain;          ///< k
  double rest;           ///< 0 where the directions are all there are
};

/// `min sum_i q_i |y_i - c - B'z_i|^2 + lambda |B|^2`, the mean c free, as a function of lambda.
///
/// What `RidgePath` is to a hidden layer, for hundreds of features: the eigenvectors of the products of features, or of
/// samples where those are fewer (the dual form), stand for the singular vectors. Products know no singular value below
/// 1e-7 of the largest; where lambda is so small that those count, a QR decomposition of the samples takes over.
/// @complexity n f min(n, f) + 9 min(n, f)^3, then n min(n, f) for each lambda
template <class Scalar>  // a template so that only its users pay for compiling the decomposition
class FeatureRidgeOf {
 public:
  /// @param features n x f
  /// @param targets  n x m
  /// @param weights  q, n; null for ones
  template <class Features, class Targets>
  FeatureRidgeOf(const Eigen::MatrixBase<Features>& features, const Eigen::MatrixBase<Targets>& targets,
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
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>> eigen(products);
    const double top = std::max<double>(eigen.eigenvalues()(k - 1), 0);
    const Index rank = (eigen.eigenvalues().array() > std::max(1e-14 * top, 1e-300)).count();
    squares_ = eigen.eigenvalues().tail(rank);
    const VectorX inverse = squares_.cwiseSqrt().cwiseInverse();
    const auto vectors = eigen.eigenvectors().rightCols(rank);
    left_ = dual ? MatrixX(vectors) : MatrixX(features_ * vectors * inverse.asDiagonal());
    right_ = dual ? MatrixX(features_.transpose() * vectors * inverse.asDiagonal()) : MatrixX(vectors);
    projected_ = left_.transpose() * targets_;
  }

  /// Sum of the weights.
  double total_weight() const { return total_; }
  /// Weighted mean of the features.
  const Eigen::RowVectorXd& mean_features() const { return mean_features_; }

  /// At `lambda` > 0; infinity is the mean alone.
  FeatureRidgeFit fit(double lambda) const {
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

  /// The fit of least leave-one-out error among half decades of lambda from the largest square down to 1e-13 of it,
  /// and infinity. Where the least one is best and the samples are more than the features, 1e-20 is tried as well:
  /// such samples have no noise.
  FeatureRidgeFit best_fit() const {
    constexpr Index candidates = 27;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (features_.rows() < 2 || squares_.size() == 0) return fit(infinity);
    VectorX lambdas(candidates + 1);
    for (Index l = 0; l < candidates; ++l)
      lambdas(l) = largest() * least * std::pow(10.0, 0.5 * static_cast<double>(l));
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

  /// Mean squared error of leaving out one unit of weight at a time (a whole sample where that has less), each of
  /// `lambdas` > 0; infinity is the mean alone. @cite Allen 1974
  VectorX leave_one_out(const VectorX& lambdas) const {
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

 private:
  static constexpr double least = 1e-13;  // lambda, in units of the largest square, that products can tell

  double largest() const { return squares_.size() > 0 ? squares_(squares_.size() - 1) : 0; }

  double left_out_error(const MatrixX& residual, const VectorX& one_minus_leverage) const {
    double sum = 0;
    for (Index i = 0; i < residual.rows(); ++i) {
      const double share = std::min(1.0, 1 / weights_(i)), left = (1 - share) + share * one_minus_leverage(i);
      sum += residual.row(i).squaredNorm() / std::max(left * left, 1e-300);
    }
    return sum / total_;
  }

  FeatureRidgeFit from_samples(double lambda) const {
    const Index n = features_.rows(), f = features_.cols();
    MatrixX stacked(n + f, f), right = MatrixX::Zero(n + f, targets_.cols());
    stacked << features_, std::sqrt(lambda) * MatrixX::Identity(f, f);
    right.topRows(n) = targets_;
    const Eigen::HouseholderQR<MatrixX> qr(stacked);
    const auto triangle = qr.matrixQR().topRows(f).template triangularView<Eigen::Upper>();
    const MatrixX inverse = triangle.solve(MatrixX::Identity(f, f));
    return finish(lambda, qr.solve(right), static_cast<double>(f) - lambda * inverse.squaredNorm(), inverse,
                  VectorX::Ones(f), 0);
  }

  FeatureRidgeFit finish(double lambda, const MatrixX& beta, double used, const MatrixX& directions,
                         const VectorX& gain, double rest) const {
    const VectorX noise =
        (targets_ - features_ * beta).colwise().squaredNorm().transpose() / std::max(total_ - 1 - used, 1e-12 * total_);
    return {lambda, beta, (mean_targets_ - mean_features_ * beta).transpose(), noise, directions, gain, rest};
  }

  VectorX weights_;
  double total_;
  Eigen::RowVectorXd mean_features_, mean_targets_;
  MatrixX features_, targets_;  // centred, times the roots of the weights
  VectorX squares_;
  MatrixX left_, right_, projected_;  // singular vectors, n x k and f x k; left' targets
};

/// In double precision.
using FeatureRidge = FeatureRidgeOf<double>;

}  // namespace vernier::detail
