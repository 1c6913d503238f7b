#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/planning/pose_design.hpp"

namespace vernier {

namespace detail {

/// A symmetric positive definite matrix of at most six rows, factorised.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

/// Lower Cholesky factor of I + v.
VERNIER_API SmallMatrix factor_of_sum(const ConstMatrixRef& v) {
  const Index n = v.rows();
  SmallMatrix out = SmallMatrix::Zero(n, n);
  for (Index j = 0; j < n; ++j) {
    double pivot = 1 + v(j, j);
    for (Index k = 0; k < j; ++k) pivot -= out(j, k) * out(j, k);
    out(j, j) = std::sqrt(std::max(pivot, 1.0));  // I + v is no smaller than I
    for (Index i = j + 1; i < n; ++i) {
      double sum = v(i, j);
      for (Index k = 0; k < j; ++k) sum -= out(i, k) * out(j, k);
      out(i, j) = sum / out(j, j);
    }
  }
  return out;
}

VERNIER_API double log_det_of_factor(const SmallMatrix& factor) { return 2 * factor.diagonal().array().log().sum(); }

/// Makes the columns of rows whose unknowns have the prior precision I + measured' measured such that it is I.
VERNIER_API void account_for_measured(const ConstMatrixRef& measured, MatrixX& rows, MatrixX& region) {
  MatrixX precision = MatrixX::Identity(measured.cols(), measured.cols());
  add_transposed_product(precision, measured, measured);
  require(cholesky(precision), "design_poses: the measured rows are not usable");
  for (MatrixX* part : {&rows, &region}) {
    if (part->rows() == 0) continue;
    MatrixX columns = part->transpose();
    part->resize(0, 0);
    solve_lower(precision, columns);
    *part = columns.transpose();
  }
}

}  // namespace detail

VERNIER_IMPL PoseDesign design_poses(MatrixX rows, Index block, const ConstMatrixRef& measured, MatrixX region,
                                     const PoseDesignOptions& options) {
  require(block >= 1 && block <= 6, "design_poses: ", block, " rows a candidate, must be 1 to 6");
  require(rows.rows() % block == 0, "design_poses: ", rows.rows(), " rows are no multiple of ", block);
  const Index n = rows.rows() / block, p = rows.cols();
  require(options.count >= 0 && options.count <= n, "design_poses: ", options.count, " of ", n, " candidates");
  require(measured.rows() == 0 || measured.cols() == p, "design_poses: measured rows of ", measured.cols(),
          " unknowns, candidates of ", p);
  require(region.rows() == 0 || region.cols() == p, "design_poses: a region of ", region.cols(),
          " unknowns, candidates of ", p);
  require(region.rows() % 3 == 0, "design_poses: ", region.rows(), " rows of the region are no multiple of 3");
  const bool by_region = options.criterion == DesignCriterion::region_variance;
  require(!by_region || region.rows() > 0, "design_poses: no region whose variance could be reduced");
  require(rows.allFinite() && measured.allFinite() && region.allFinite(), "design_poses: a row is not finite");
  const Eigen::MatrixXi& bins = options.coverage.bins;
  require(bins.rows() == 0 || bins.rows() == n, "design_poses: bins of ", bins.rows(), " candidates, expected ", n);
  require(bins.size() == 0 || (bins.minCoeff() >= 0 && bins.maxCoeff() < options.coverage.missing.size()),
          "design_poses: a bin is not in 0 .. ", options.coverage.missing.size() - 1);

  if (measured.rows() > 0) detail::account_for_measured(measured, rows, region);
  const Index of_candidates = rows.rows(), of_region = region.rows(), width = options.count * block;
  PoseDesign out;
  out.missing = options.coverage.missing;
  out.log_det.setZero(options.count + 1);

  MatrixX variance(of_candidates, block);  // V of each candidate below each other
  for (Index c = 0; c < n; ++c) {
    const auto own = rows.middleRows(c * block, block);
    variance.middleRows(c * block, block) = own.lazyProduct(own.transpose());
  }
  VectorX region_variance = region.rowwise().squaredNorm();
  const auto mean_variance = [&] { return 3 * region_variance.sum() / static_cast<double>(of_region); };
  if (of_region > 0) {
    out.region_variance.resize(options.count + 1);
    out.region_variance(0) = mean_variance();
  }
  MatrixX to_region;  // K of each candidate
  if (by_region) {
    to_region.setZero(of_candidates, of_region);
    detail::add_product(to_region, rows, region.transpose());
  }
  MatrixX known(of_candidates, width), known_region(of_region, width);  // A G, B G
  MatrixX cross(of_candidates, block), cross_region(of_region, block), own(block, p);
  std::vector<bool> taken(static_cast<std::size_t>(n), false);

  for (Index step = 0; step < options.count; ++step) {
    Index best = -1;
    int best_covered = -1;
    double best_gain = -std::numeric_limits<double>::infinity();
    for (Index c = 0; c < n; ++c) {
      if (taken[static_cast<std::size_t>(c)]) continue;
      int covered = 0;
      for (Index k = 0; k < bins.cols() && bins.rows() > 0; ++k) covered += out.missing(bins(c, k)) > 0 ? 1 : 0;
      if (covered < best_covered) continue;
      const detail::SmallMatrix factor = detail::factor_of_sum(variance.middleRows(c * block, block));
      double gain = 0;
      if (by_region) {
        detail::SmallMatrix sum =
            to_region.middleRows(c * block, block).lazyProduct(to_region.middleRows(c * block, block).transpose());
        factor.triangularView<Eigen::Lower>().solveInPlace(sum);
        factor.triangularView<Eigen::Lower>().transpose().solveInPlace(sum);
        gain = sum.trace();
      } else {
        gain = detail::log_det_of_factor(factor);
      }
      if (covered == best_covered && !(gain > best_gain)) continue;
      best = c;
      best_covered = covered;
      best_gain = gain;
    }
    taken[static_cast<std::size_t>(best)] = true;
    out.chosen.push_back(best);
    for (Index k = 0; k < bins.cols() && bins.rows() > 0; ++k) {
      int& missing = out.missing(bins(best, k));
      missing = std::max(0, missing - 1);
    }
    const detail::SmallMatrix factor = detail::factor_of_sum(variance.middleRows(best * block, block));
    out.log_det(step + 1) = out.log_det(step) + detail::log_det_of_factor(factor);

    // A S A_s' = A A_s' - (A G)(A_s G)', then one more block of A G
    own = rows.middleRows(best * block, block);
    const MatrixX own_known = known.block(best * block, 0, block, step * block);
    const auto append = [&](const MatrixX& of_rows, MatrixX& of_known, MatrixX& product) {
      if (of_rows.rows() == 0) return;
      product.setZero();
      detail::add_product(product, of_rows, own.transpose());
      detail::add_product(product, of_known.leftCols(step * block), own_known.transpose(), -1);
      factor.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(product);
      of_known.middleCols(step * block, block) = product;
    };
    append(rows, known, cross);
    append(region, known_region, cross_region);
    for (Index c = 0; c < n; ++c) {
      const auto part = cross.middleRows(c * block, block);
      variance.middleRows(c * block, block) -= part.lazyProduct(part.transpose());
    }
    if (by_region) detail::add_product(to_region, cross, cross_region.transpose(), -1);
    if (of_region > 0) {
      region_variance -= cross_region.rowwise().squaredNorm();
      out.region_variance(step + 1) = mean_variance();
    }
  }
  return out;
}

VERNIER_IMPL double information_bound(const ConstMatrixRef& rows, Index block, Index count, int iterations) {
  require(block >= 1 && rows.rows() % block == 0, "information_bound: ", rows.rows(), " rows are no multiple of ",
          block);
  const Index n = rows.rows() / block, p = rows.cols();
  require(count >= 0 && count <= n, "information_bound: ", count, " of ", n, " candidates");
  require(iterations >= 1, "information_bound: ", iterations, " iterations, must be at least 1");
  const auto total = static_cast<double>(count);
  VectorX weights = VectorX::Constant(n, total / static_cast<double>(std::max<Index>(n, 1)));
  double best = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < iterations; ++iteration) {
    MatrixX columns(p, rows.rows());
    for (Index r = 0; r < rows.rows(); ++r) columns.col(r) = std::sqrt(weights(r / block)) * rows.row(r).transpose();
    MatrixX information = MatrixX::Identity(p, p);
    detail::add_product(information, columns, columns.transpose());
    require(detail::cholesky(information), "information_bound: the rows are not usable");
    columns = rows.transpose();
    detail::solve_lower(information, columns);
    VectorX gradient(n);
    for (Index c = 0; c < n; ++c) gradient(c) = columns.middleCols(c * block, block).squaredNorm();
    VectorX largest = gradient;
    std::nth_element(largest.begin(), largest.begin() + count, largest.end(), std::greater<>());
    best = std::min(best,
                    2 * information.diagonal().array().log().sum() + largest.head(count).sum() - weights.dot(gradient));
    // clipped weights keep their one, the others share what is left in proportion
    VectorX wanted = weights.cwiseProduct(gradient);
    std::vector<bool> full(static_cast<std::size_t>(n), false);
    double left = total;
    for (bool clipped = true; clipped;) {
      clipped = false;
      double sum = 0;
      for (Index c = 0; c < n; ++c) sum += full[static_cast<std::size_t>(c)] ? 0 : wanted(c);
      if (!(sum > 0)) break;
      const double factor = left / sum;
      for (Index c = 0; c < n; ++c) {
        if (full[static_cast<std::size_t>(c)]) continue;
        weights(c) = factor * wanted(c);
        if (weights(c) < 1) continue;
        weights(c) = 1;
        full[static_cast<std::size_t>(c)] = true;
        left -= 1;
        clipped = true;
      }
    }
  }
  return best;
}

}  // namespace vernier
