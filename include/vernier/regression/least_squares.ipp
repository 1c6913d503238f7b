#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/regression/least_squares.hpp"

namespace vernier {

VERNIER_IMPL MatrixX minimum_norm_solution(const ConstMatrixRef& h, const ConstMatrixRef& t, double rcond) {
  const detail::ThinSvd svd = detail::thin_svd(h);
  const double cut = rcond * (svd.s.size() > 0 ? svd.s(0) : 0.0);
  VectorX inverse = VectorX::Zero(svd.s.size());
  for (Index j = 0; j < svd.s.size(); ++j)
    if (svd.s(j) > cut) inverse(j) = 1 / svd.s(j);
  return svd.v * (inverse.asDiagonal() * (svd.u.transpose() * t));
}

VERNIER_IMPL RidgeSolution relative_ridge(const ConstMatrixRef& h, const ConstMatrixRef& t, double relative_lambda) {
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
    out.beta = detail::solve_by_qr(stacked, right).solution;
  }
  out.objective = (h * out.beta - t).squaredNorm() + lambda * out.beta.squaredNorm();
  return out;
}

VERNIER_IMPL MatrixX ridge_weights(const ConstMatrixRef& gram, const ConstMatrixRef& right, double lambda) {
  if (!(lambda > 0) || !std::isfinite(lambda)) return {};
  MatrixX regularised = gram;
  regularised.diagonal().array() += lambda;
  const Eigen::LLT<Eigen::Ref<MatrixX>> factor(regularised);  // in place
  if (factor.info() != Eigen::Success) return {};
  return factor.solve(right.transpose());
}

VERNIER_IMPL double objective_from_products(const ConstMatrixRef& gram, const ConstMatrixRef& right,
                                            double target_square, const MatrixX& beta, double lambda, double trace) {
  if (beta.size() == 0) return -1;
  const double size = beta.squaredNorm();
  // quadratic in beta, so that an error of beta enters squared where beta is the best
  const double objective = target_square - 2 * right.transpose().cwiseProduct(beta).sum() +
                           beta.cwiseProduct(gram.selfadjointView<Eigen::Lower>() * beta).sum() + lambda * size;
  return objective > 1e-7 * target_square && objective > 1e-8 * trace * size ? objective : -1;
}

VERNIER_IMPL double relative_ridge_objective(const ConstMatrixRef& gram, const ConstMatrixRef& right,
                                             double target_square, double relative_lambda) {
  const double trace = gram.trace(), lambda = relative_lambda * trace / static_cast<double>(gram.rows());
  return objective_from_products(gram, right, target_square, ridge_weights(gram, right, lambda), lambda, trace);
}

VERNIER_IMPL RidgePath::RidgePath(const ConstMatrixRef& h, const ConstMatrixRef& t, const VectorX* weights)
    : shares_(weights != nullptr ? VectorX(*weights / weights->sum())
                                 : VectorX(VectorX::Constant(h.rows(), 1 / static_cast<double>(h.rows())))),
      mean_h_(weights != nullptr ? Row(shares_.transpose() * h) : Row(h.colwise().mean())),
      mean_t_(weights != nullptr ? Row(shares_.transpose() * t) : Row(t.colwise().mean())),
      centred_t_(scaled(t.rowwise() - mean_t_, weights != nullptr)),
      svd_(detail::thin_svd(scaled(h.rowwise() - mean_h_, weights != nullptr))) {
  projected_ = svd_.u.transpose() * centred_t_;
  if (rank() == 0) svd_.s.setZero();
}

VERNIER_IMPL Index RidgePath::rank() const {
  const double cut =
      svd_.s.size() > 0 ? svd_.s(0) * 1e-14 * static_cast<double>(std::max(svd_.u.rows(), svd_.v.rows())) : 0;
  return (svd_.s.array() > std::max(cut, 1e-300)).count();
}

VERNIER_IMPL double RidgePath::scale() const { return svd_.s.size() > 0 ? svd_.s(0) * svd_.s(0) : 0; }

VERNIER_IMPL MatrixX RidgePath::beta(double lambda) const {
  if (!std::isfinite(lambda)) return MatrixX::Zero(svd_.v.rows(), centred_t_.cols());
  return svd_.v * (svd_.s.array() / (svd_.s.array().square() + lambda)).matrix().asDiagonal() * projected_;
}

VERNIER_IMPL VectorX RidgePath::offset(const MatrixX& beta) const { return (mean_t_ - mean_h_ * beta).transpose(); }

VERNIER_IMPL MatrixX RidgePath::leave_one_out_residuals(double lambda) const {
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

VERNIER_IMPL MatrixX RidgePath::scaled(const ConstMatrixRef& rows, bool weighted) const {
  if (!weighted) return rows;
  return (shares_ * static_cast<double>(shares_.size())).cwiseSqrt().asDiagonal() * rows;
}

VERNIER_IMPL LeaveOneOutChoice choose_lambda(const RidgePath& path, Index samples) {
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

VERNIER_IMPL double evidence_against_mean(const RidgePath& path, double lambda, Index samples) {
  if (!std::isfinite(lambda) || samples < 3) return 0;
  const VectorX gain = path.leave_one_out_residuals(std::numeric_limits<double>::infinity()).rowwise().squaredNorm() -
                       path.leave_one_out_residuals(lambda).rowwise().squaredNorm();
  const double mean = gain.mean(), n = static_cast<double>(samples);
  const double standard_error = std::sqrt((gain.array() - mean).square().sum() / (n * (n - 1)));
  return standard_error > 0 ? mean / standard_error : mean > 0 ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace vernier
