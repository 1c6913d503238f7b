#pragma once

/// @file
/// Linear least squares for output weights: minimum norm, ridge, and closed-form leave-one-out.

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/types.hpp"

namespace vernier {

namespace detail {

/// Thin singular value decomposition `H = U diag(s) V'`: QR of the longer side, then one-sided work on the square rest.
/// (Jacobi: the most accurate one, and Eigen's divide and conquer would cost every user half a minute to compile.)
struct ThinSvd {
  MatrixX u;  ///< n x k, k = min(n, h)
  VectorX s;  ///< k, descending
  MatrixX v;  ///< h x k

  template <class Derived>  // a template, as all below, so that only its users pay for compiling the decompositions
  explicit ThinSvd(const Eigen::MatrixBase<Derived>& expression) {
    const MatrixX h = expression;
    const bool tall = h.rows() >= h.cols();
    const Index k = std::min(h.rows(), h.cols());
    const Eigen::HouseholderQR<MatrixX> qr(tall ? h : MatrixX(h.transpose()));
    const MatrixX square = qr.matrixQR().topRows(k).template triangularView<Eigen::Upper>();
    const Eigen::JacobiSVD<MatrixX, Eigen::NoQRPreconditioner> svd(square, Eigen::ComputeFullU | Eigen::ComputeFullV);
    s = svd.singularValues();
    MatrixX longer = MatrixX::Zero(std::max(h.rows(), h.cols()), k);
    longer.topRows(k) = svd.matrixU();
    longer.applyOnTheLeft(qr.householderQ());
    u = tall ? longer : svd.matrixV();
    v = tall ? svd.matrixV() : longer;
  }
};

}  // namespace detail

/// Minimum-norm solution of `min |H beta - T|`: singular values below `rcond` times the largest count as zero.
/// @param h     n x nodes
/// @param t     n x outputs
/// @param rcond relative cut, in [0, 1)
/// @return      nodes x outputs
template <class H, class T>
MatrixX minimum_norm_solution(const Eigen::MatrixBase<H>& h, const Eigen::MatrixBase<T>& t, double rcond) {
  const detail::ThinSvd svd(h);
  const double cut = rcond * (svd.s.size() > 0 ? svd.s(0) : 0.0);
  VectorX inverse = VectorX::Zero(svd.s.size());
  for (Index j = 0; j < svd.s.size(); ++j)
    if (svd.s(j) > cut) inverse(j) = 1 / svd.s(j);
  return svd.v * (inverse.asDiagonal() * (svd.u.transpose() * t));
}

/// Value and solution of a regularised least-squares problem.
struct RidgeSolution {
  MatrixX beta;      ///< nodes x outputs
  double objective;  ///< `|H beta - T|^2 + lambda |beta|^2`
};

/// `min |H beta - T|^2 + lambda |beta|^2` with lambda = `relative_lambda` tr(H'H) / h, by normal equations. The ridge
/// bounds the condition of the Gram matrix by h / relative_lambda; should the factorisation fail all the same, QR of
/// the stacked system takes over. The objective is computed from the residual, so an error of beta enters it squared.
template <class H, class T>
RidgeSolution relative_ridge(const Eigen::MatrixBase<H>& h, const Eigen::MatrixBase<T>& t, double relative_lambda) {
  const Index nodes = h.cols();
  MatrixX gram = MatrixX::Zero(nodes, nodes);
  gram.selfadjointView<Eigen::Lower>().rankUpdate(h.transpose());
  const double lambda = relative_lambda * gram.trace() / static_cast<double>(nodes);
  gram.diagonal().array() += lambda;
  RidgeSolution out;
  if (!(lambda > 0) || !std::isfinite(lambda)) {  // H is zero, or not finite
    out.beta = MatrixX::Zero(nodes, t.cols());
    out.objective = std::isfinite(lambda) ? t.squaredNorm() : std::numeric_limits<double>::infinity();
    return out;
  }
  const Eigen::LLT<MatrixX> factor(gram);
  if (factor.info() == Eigen::Success) {
    out.beta = factor.solve(h.transpose() * t);
  } else {
    MatrixX stacked(h.rows() + nodes, nodes), right = MatrixX::Zero(h.rows() + nodes, t.cols());
    stacked << h, std::sqrt(lambda) * MatrixX::Identity(nodes, nodes);
    right.topRows(t.rows()) = t;
    out.beta = Eigen::HouseholderQR<MatrixX>(stacked).solve(right);
  }
  out.objective = (h * out.beta - t).squaredNorm() + lambda * out.beta.squaredNorm();
  return out;
}

/// Output weights, nodes x outputs, of `min |H beta - T|^2 + lambda |beta|^2` from the products alone; empty where they
/// are too badly conditioned.
/// @param gram   H'H, its lower triangle
/// @param right  T'H, outputs x nodes
/// @param lambda absolute
template <class Gram, class Right>
MatrixX ridge_weights(const Eigen::MatrixBase<Gram>& gram, const Eigen::MatrixBase<Right>& right, double lambda) {
  if (!(lambda > 0) || !std::isfinite(lambda)) return {};
  MatrixX regularised = gram;
  regularised.diagonal().array() += lambda;
  const Eigen::LLT<Eigen::Ref<MatrixX>> factor(regularised);  // in place
  if (factor.info() != Eigen::Success) return {};
  return factor.solve(right.transpose());
}

/// `|H beta - T|^2 + lambda |beta|^2` from the products alone: no second pass over the samples, but digits are lost
/// where the fit is nearly perfect or beta is huge. Returns -1 where fewer than seven digits would be left.
/// @param gram          H'H, its lower triangle
/// @param right         T'H, outputs x nodes
/// @param target_square |T|^2
/// @param beta          nodes x outputs, or empty
/// @param lambda        absolute
/// @param trace         of H'H as summed up, before anything was subtracted from it
template <class Gram, class Right>
double objective_from_products(const Eigen::MatrixBase<Gram>& gram, const Eigen::MatrixBase<Right>& right,
                               double target_square, const MatrixX& beta, double lambda, double trace) {
  if (beta.size() == 0) return -1;
  const double size = beta.squaredNorm();
  // quadratic in beta, so that an error of beta enters squared where beta is the best
  const double objective = target_square - 2 * right.transpose().cwiseProduct(beta).sum() +
                           beta.cwiseProduct(gram.template selfadjointView<Eigen::Lower>() * beta).sum() +
                           lambda * size;
  return objective > 1e-7 * target_square && objective > 1e-8 * trace * size ? objective : -1;
}

/// The objective of `relative_ridge` from the products alone, see `objective_from_products`.
/// @param gram            H'H, its lower triangle
/// @param right           T'H, outputs x nodes
/// @param target_square   |T|^2
/// @param relative_lambda as in `relative_ridge`
template <class Gram, class Right>
double relative_ridge_objective(const Eigen::MatrixBase<Gram>& gram, const Eigen::MatrixBase<Right>& right,
                                double target_square, double relative_lambda) {
  const double trace = gram.trace(), lambda = relative_lambda * trace / static_cast<double>(gram.rows());
  return objective_from_products(gram, right, target_square, ridge_weights(gram, right, lambda), lambda, trace);
}

/// Ridge regression with an unpenalised mean, for every lambda from one decomposition. Samples may have weights, which
/// count relative to their mean.
/// @cite Allen 1974 (PRESS); Huang 2012
template <class Scalar>
class RidgePathOf {
 public:
  /// @param h       n x nodes, centred here
  /// @param t       n x outputs, centred here
  /// @param weights of the samples, positive; null: all the same
  template <class H, class T>
  RidgePathOf(const Eigen::MatrixBase<H>& h, const Eigen::MatrixBase<T>& t, const VectorX* weights = nullptr)
      : shares_(weights != nullptr ? VectorX(*weights / weights->sum())
                                   : VectorX(VectorX::Constant(h.rows(), 1 / static_cast<double>(h.rows())))),
        mean_h_(weights != nullptr ? Row(shares_.transpose() * h) : Row(h.colwise().mean())),
        mean_t_(weights != nullptr ? Row(shares_.transpose() * t) : Row(t.colwise().mean())),
        centred_t_(scaled(t.rowwise() - mean_t_, weights != nullptr)),
        svd_(scaled(h.rowwise() - mean_h_, weights != nullptr)) {
    projected_ = svd_.u.transpose() * centred_t_;
    if (rank() == 0) svd_.s.setZero();
  }

  /// Numerical rank of the centred hidden layer.
  Index rank() const {
    const double cut =
        svd_.s.size() > 0 ? svd_.s(0) * 1e-14 * static_cast<double>(std::max(svd_.u.rows(), svd_.v.rows())) : 0;
    return (svd_.s.array() > std::max(cut, 1e-300)).count();
  }

  /// Squares of the largest singular value: the natural unit of lambda.
  double scale() const { return svd_.s.size() > 0 ? svd_.s(0) * svd_.s(0) : 0; }

  /// nodes x outputs at `lambda` > 0; infinity gives zero.
  MatrixX beta(double lambda) const {
    if (!std::isfinite(lambda)) return MatrixX::Zero(svd_.v.rows(), centred_t_.cols());
    return svd_.v * (svd_.s.array() / (svd_.s.array().square() + lambda)).matrix().asDiagonal() * projected_;
  }

  /// What is added to H beta: `mean(T) - mean(H) beta`.
  VectorX offset(const MatrixX& beta) const { return (mean_t_ - mean_h_ * beta).transpose(); }

  /// Residuals of leaving each sample out, n x outputs, at `lambda` > 0; infinity is the mean alone. Those of samples
  /// with weights are multiplied by the square root of the weight relative to the mean weight. With as many nodes
  /// as samples the residual and `1 - leverage` are sums over lambda / (s^2 + lambda), never differences that cancel.
  MatrixX leave_one_out_residuals(double lambda) const {
    const Index n = centred_t_.rows();
    if (!std::isfinite(lambda)) return (1 - shares_.array()).inverse().matrix().asDiagonal() * centred_t_;
    const Index r = rank();
    const auto u = svd_.u.leftCols(r);
    const Eigen::ArrayXd s2 = svd_.s.head(r).array().square();
    const VectorX kept = (lambda / (s2 + lambda)).matrix();
    VectorX one_minus_leverage = u.cwiseAbs2() * kept;
    MatrixX residual = u * (kept.asDiagonal() * projected_.topRows(r));
    if (r < n - 1) {  // what U does not span; where it spans all centred samples, nothing but rounding
      one_minus_leverage.array() += (1 - shares_.array() - u.rowwise().squaredNorm().array()).max(0.0);
      residual += centred_t_ - u * projected_.topRows(r);
    }
    for (Index i = 0; i < n; ++i) residual.row(i) /= std::max(one_minus_leverage(i), 1e-300);
    return residual;
  }

 private:
  using Row = Eigen::RowVectorXd;

  template <class Derived>
  MatrixX scaled(const Eigen::MatrixBase<Derived>& rows, bool weighted) const {
    if (!weighted) return rows;
    return (shares_ * static_cast<double>(shares_.size())).cwiseSqrt().asDiagonal() * rows;
  }

  VectorX shares_;  // of the samples, sum 1
  Row mean_h_, mean_t_;
  MatrixX centred_t_;
  detail::ThinSvd svd_;
  MatrixX projected_;
};

/// The path in double precision. (A template, so that only its users pay for compiling it.)
using RidgePath = RidgePathOf<double>;

/// A ridge and the error it leaves.
struct LeaveOneOutChoice {
  double lambda;              ///< absolute; infinity: the mean alone
  double mean_squared_error;  ///< leave-one-out, per sample, summed over outputs
};

/// The lambda of least leave-one-out error over a grid of half decades relative to the problem's scale; infinity, the
/// mean alone, is a candidate.
template <class Scalar>
LeaveOneOutChoice choose_lambda(const RidgePathOf<Scalar>& path, Index samples) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  LeaveOneOutChoice best{infinity, infinity};
  if (samples < 2) return best;
  const auto consider = [&](double candidate) {
    const double error = path.leave_one_out_residuals(candidate).squaredNorm() / static_cast<double>(samples);
    if (error < best.mean_squared_error) best = {candidate, error};
  };
  consider(infinity);
  if (path.rank() > 0)
    for (int exponent = 0; exponent >= -24; --exponent) consider(path.scale() * std::pow(10.0, exponent / 2.0));
  return best;
}

/// How many standard errors the leave-one-out error at `lambda` lies below that of the mean alone: the mean over
/// samples of the difference of squared errors, divided by its standard error. Zero for the mean itself.
template <class Scalar>
double evidence_against_mean(const RidgePathOf<Scalar>& path, double lambda, Index samples) {
  if (!std::isfinite(lambda) || samples < 3) return 0;
  const VectorX gain = path.leave_one_out_residuals(std::numeric_limits<double>::infinity()).rowwise().squaredNorm() -
                       path.leave_one_out_residuals(lambda).rowwise().squaredNorm();
  const double mean = gain.mean(), n = static_cast<double>(samples);
  const double standard_error = std::sqrt((gain.array() - mean).square().sum() / (n * (n - 1)));
  return standard_error > 0 ? mean / standard_error : mean > 0 ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace vernier
