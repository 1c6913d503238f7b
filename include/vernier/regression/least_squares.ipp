// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
  const MatrixX projected = detail::transposed_matrix_product(svd.u, t);
  return detail::matrix_product(svd.v, detail::rows_scaled(inverse, projected));
}

VERNIER_IMPL RidgeSolution relative_ridge(const ConstMatrixRef& h, const ConstMatrixRef& t, double relative_lambda) {
  const Index nodes = h.cols();
  MatrixX gram = MatrixX::Zero(nodes, nodes);  // its lower triangle, and blocks of the diagonal
  for (Index first = 0, width = 32; first < nodes; first += width) {
    const Index rest = nodes - first, columns = (std::min)(width, rest);
    detail::add_transposed_product(VERNIER_LATER(gram).block(first, first, rest, columns),
                                   VERNIER_LATER(h).rightCols(rest), VERNIER_LATER(h).middleCols(first, columns));
  }
  const double lambda = relative_lambda * detail::diagonal_of(gram).sum() / static_cast<double>(nodes);
  RidgeSolution out;
  if (!(lambda > 0) || !std::isfinite(lambda)) {  // H is zero, or not finite
    out.beta = MatrixX::Zero(nodes, t.cols());
    out.objective =
        std::isfinite(lambda) ? detail::squared_column_norms(t).sum() : std::numeric_limits<double>::infinity();
    return out;
  }
  for (Index k = 0; k < nodes; ++k) gram(k, k) += lambda;
  if (detail::cholesky(gram)) {
    out.beta = detail::transposed_matrix_product(h, t);
    detail::solve_cholesky(gram, out.beta);
  } else {
    MatrixX stacked = MatrixX::Zero(h.rows() + nodes, nodes), right = MatrixX::Zero(h.rows() + nodes, t.cols());
    VERNIER_LATER(stacked).topRows(h.rows()) = h;
    VERNIER_LATER(right).topRows(t.rows()) = t;
    for (Index k = 0; k < nodes; ++k) stacked(h.rows() + k, k) = std::sqrt(lambda);
    out.beta = detail::solve_by_qr(stacked, right).solution;
  }
  MatrixX residual = t;
  detail::add_product(residual, h, out.beta, -1);
  out.objective = residual.squaredNorm() + lambda * out.beta.squaredNorm();
  return out;
}

VERNIER_IMPL MatrixX ridge_weights(const ConstMatrixRef& gram, const ConstMatrixRef& right, double lambda) {
  if (!(lambda > 0) || !std::isfinite(lambda)) return {};
  MatrixX regularised = gram;
  for (Index k = 0; k < regularised.rows(); ++k) regularised(k, k) += lambda;
  if (!detail::cholesky(regularised)) return {};
  MatrixX beta = VERNIER_LATER(right).transpose();
  detail::solve_cholesky(regularised, beta);
  return beta;
}

VERNIER_IMPL double objective_from_products(const ConstMatrixRef& gram, const ConstMatrixRef& right,
                                            double target_square, const MatrixX& beta, double lambda, double trace) {
  if (beta.size() == 0) return -1;
  MatrixX symmetric = gram;
  for (Index c = 0; c < gram.cols(); ++c)
    for (Index r = 0; r < c; ++r) symmetric(r, c) = gram(c, r);
  const MatrixX product = detail::matrix_product(symmetric, beta);
  double linear = 0, quadratic = 0;
  for (Index o = 0; o < beta.cols(); ++o)
    for (Index k = 0; k < beta.rows(); ++k) {
      linear += right(o, k) * beta(k, o);
      quadratic += product(k, o) * beta(k, o);
    }
  const double size = beta.squaredNorm();
  // quadratic in beta, so that an error of beta enters squared where beta is the best
  const double objective = target_square - 2 * linear + quadratic + lambda * size;
  return objective > 1e-7 * target_square && objective > 1e-8 * trace * size ? objective : -1;
}

VERNIER_IMPL double relative_ridge_objective(const ConstMatrixRef& gram, const ConstMatrixRef& right,
                                             double target_square, double relative_lambda) {
  const double trace = detail::diagonal_of(gram).sum(),
               lambda = relative_lambda * trace / static_cast<double>(gram.rows());
  return objective_from_products(gram, right, target_square, ridge_weights(gram, right, lambda), lambda, trace);
}

namespace detail {

/// Shares of samples in the sum of their weights.
/// @param weights null: all the same
VERNIER_LOCAL VectorX shares_of(const VectorX* weights, Index samples) {
  if (weights != nullptr) return VERNIER_LATER(*weights) / weights->sum();
  return VectorX::Constant(samples, 1 / static_cast<double>(samples));
}

}  // namespace detail

VERNIER_IMPL RidgePath::RidgePath(const ConstMatrixRef& h, const ConstMatrixRef& t, const VectorX* weights)
    : shares_(detail::shares_of(weights, h.rows())),
      mean_h_(weights != nullptr ? detail::transposed_product(h, shares_) : detail::column_means(h)),
      mean_t_(weights != nullptr ? detail::transposed_product(t, shares_) : detail::column_means(t)),
      centred_t_(scaled(detail::rows_minus(t, mean_t_), weights != nullptr)),
      svd_(detail::thin_svd(scaled(detail::rows_minus(h, mean_h_), weights != nullptr))),
      squares_(VERNIER_LATER(svd_.u).cwiseAbs2()),
      projected_(detail::transposed_matrix_product(svd_.u, centred_t_)) {
  if (rank() == 0) svd_.s.setZero();
}

VERNIER_IMPL Index RidgePath::rank() const {
  const Index k = svd_.s.size();
  const double cut = k > 0 ? svd_.s(0) * 1e-14 * static_cast<double>((std::max)(svd_.u.rows(), svd_.v.rows())) : 0;
  return std::count_if(svd_.s.data(), svd_.s.data() + k, [&](double s) { return s > (std::max)(cut, 1e-300); });
}

VERNIER_IMPL double RidgePath::scale() const { return svd_.s.size() > 0 ? svd_.s(0) * svd_.s(0) : 0; }

VERNIER_IMPL MatrixX RidgePath::beta(double lambda) const {
  if (!std::isfinite(lambda)) return MatrixX::Zero(svd_.v.rows(), centred_t_.cols());
  VectorX inverse = svd_.s;
  for (double& s : inverse) s /= s * s + lambda;
  return detail::matrix_product(svd_.v, detail::rows_scaled(inverse, projected_));
}

VERNIER_IMPL VectorX RidgePath::offset(const MatrixX& beta) const {
  return VERNIER_LATER(mean_t_) - detail::transposed_product(beta, mean_h_);
}

VERNIER_IMPL MatrixX RidgePath::leave_one_out_residuals(double lambda) const {
  const Index n = centred_t_.rows();
  MatrixX residual = centred_t_;
  VectorX one_minus_leverage(n);
  for (Index i = 0; i < n; ++i) one_minus_leverage(i) = 1 - shares_(i);
  if (std::isfinite(lambda)) {
    const Index r = rank();
    const auto u = VERNIER_LATER(svd_.u).leftCols(r), squares = VERNIER_LATER(squares_).leftCols(r);
    const MatrixX projected = VERNIER_LATER(projected_).topRows(r);
    VectorX kept(r);
    for (Index j = 0; j < r; ++j) kept(j) = lambda / (svd_.s(j) * svd_.s(j) + lambda);
    if (r < n - 1) {  // what U does not span; where it spans all centred samples, nothing but rounding
      const VectorX spanned = detail::product(squares, VectorX::Ones(r));
      for (Index i = 0; i < n; ++i) one_minus_leverage(i) = (std::max)(one_minus_leverage(i) - spanned(i), 0.0);
      detail::add_product(residual, u, projected, -1);
    } else {
      one_minus_leverage.setZero();
      residual.setZero();
    }
    one_minus_leverage += detail::product(squares, kept);
    detail::add_product(residual, u, detail::rows_scaled(kept, projected));
  }
  for (Index o = 0; o < residual.cols(); ++o)
    for (Index i = 0; i < n; ++i) residual(i, o) /= (std::max)(one_minus_leverage(i), 1e-300);
  return residual;
}

VERNIER_IMPL MatrixX RidgePath::scaled(const ConstMatrixRef& rows, bool weighted) const {
  if (!weighted) return rows;
  const VectorX relative = static_cast<double>(shares_.size()) * VERNIER_LATER(shares_);
  return detail::rows_scaled(VERNIER_LATER(relative).cwiseSqrt(), rows);
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
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!std::isfinite(lambda) || samples < 3) return 0;
  const VectorX of_mean = detail::squared_row_norms(path.leave_one_out_residuals(infinity)),
                of_path = detail::squared_row_norms(path.leave_one_out_residuals(lambda)),
                gain = VERNIER_LATER(of_mean) - of_path;
  const double mean = gain.mean(), n = static_cast<double>(samples);
  double sum = 0;
  for (const double value : gain) sum += (value - mean) * (value - mean);
  const double standard_error = std::sqrt(sum / (n * (n - 1)));
  return standard_error > 0 ? mean / standard_error : mean > 0 ? infinity : 0;
}

}  // namespace vernier
