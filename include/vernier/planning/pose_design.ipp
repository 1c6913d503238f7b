// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/planning/pose_design.hpp"

namespace vernier {

namespace detail {

/// Lower Cholesky factor of I + v, v of at most six rows; I where v has none.
VERNIER_LOCAL Matrix6 factor_of_sum(const ConstMatrixRef& v) {
  const Index n = v.rows();
  Matrix6 out = Matrix6::Identity();
  for (Index j = 0; j < n; ++j) {
    double pivot = 1 + v(j, j);
    for (Index k = 0; k < j; ++k) pivot -= out(j, k) * out(j, k);
    out(j, j) = std::sqrt((std::max)(pivot, 1.0));  // I + v is no smaller than I
    for (Index i = j + 1; i < n; ++i) {
      double sum = v(i, j);
      for (Index k = 0; k < j; ++k) sum -= out(i, k) * out(j, k);
      out(i, j) = sum / out(j, j);
    }
  }
  return out;
}

/// Solves for columns in which unknowns of the prior precision I + measured' measured have the prior precision I.
VERNIER_LOCAL void account_for_measured(const ConstMatrixRef& measured, MatrixX& candidates, MatrixX& region) {
  MatrixX precision = MatrixX::Identity(measured.cols(), measured.cols());
  add_transposed_product(precision, measured, measured);
  demand(cholesky(precision), "design_poses: the rows are not usable");
  solve_lower(precision, candidates);
  solve_lower(precision, region);
}

/// A design that grows. Of rows chosen so far, P, it keeps the Cholesky factor F of `I + P P'`; a candidate with
/// rows A then has `V = A A' - known' known`, `F known = P A'`, which is brought up to date where it is looked at. P
/// has at most as many rows as there are unknowns: then all columns are solved for unknowns with the prior I again, and
/// P begins anew. So memory and time of a choice do not grow with the number of choices.
class GrowingDesign {
 public:
  /// @param candidates p x n b, what the rows are transposed
  /// @param region     p x r, likewise
  VERNIER_LOCAL GrowingDesign(MatrixX candidates, MatrixX region, Index block, const PoseDesignOptions& options)
      : columns_(std::move(candidates)),
        region_(std::move(region)),
        block_(block),
        kept_((std::min)(options.count, (columns_.rows() + block - 1) / block)),
        picks_(columns_.rows(), kept_ * block),
        factor_(MatrixX::Zero(kept_ * block, kept_ * block)),
        known_(kept_ * block, columns_.cols()),
        known_region_(kept_ * block, region_.cols()),
        variance_(block, columns_.cols()),
        level_(static_cast<std::size_t>(size()), 0),
        by_region_(options.criterion == DesignCriterion::region_variance),
        region_variance_(squared_column_norms(region_)) {
    begin();
  }

  /// Number of candidates.
  Index size() const { return columns_.cols() / block_; }
  /// Whether V of a candidate is that of all choices.
  bool up_to_date(Index c) const { return level_[static_cast<std::size_t>(c)] == chosen_; }
  /// Brings V of some candidates up to date, all of which were last at the same time.
  VERNIER_LOCAL void update(Index first, Index count) {
    const Index from = level_[static_cast<std::size_t>(first)] * block_, rows = chosen_ * block_ - from;
    const MatrixX tail = solved(columns_, known_, first * block_, count * block_, from);
    VERNIER_LATER(known_).block(from, first * block_, rows, count * block_) = tail;
    for (Index c = 0; c < count; ++c) {
      add_to_variance(first + c, products(tail, c), -1);
      level_[static_cast<std::size_t>(first + c)] = chosen_;
    }
    if (to_region_.size() > 0)
      add_transposed_product(VERNIER_LATER(to_region_).middleCols(first * block_, count * block_),
                             VERNIER_LATER(known_region_).middleRows(from, rows), tail, -1);
  }
  /// Information of a candidate that is up to date [nat].
  VERNIER_LOCAL double information(Index c) const { return cholesky_log_determinant(factor(c)); }
  /// By how much it reduces the sum of the region's variances.
  VERNIER_LOCAL double reduction(Index c) const {
    Matrix6 sum = products(to_region_, c);
    solve_cholesky(factor(c), sum);
    return sum.trace();
  }
  /// Chooses a candidate that is up to date.
  /// @return whether all others are up to date then, because P began anew
  VERNIER_LOCAL bool choose(Index c) {
    const Index at = chosen_ * block_;
    VERNIER_LATER(picks_).middleCols(at, block_) = VERNIER_LATER(columns_).middleCols(c * block_, block_);
    const Matrix6 own = factor(c);
    for (Index a = 0; a < block_; ++a) {
      for (Index k = 0; k < at; ++k) factor_(at + a, k) = known_(k, c * block_ + a);
      for (Index b = 0; b < block_; ++b) factor_(at + a, at + b) = own(a, b);
    }
    ++chosen_;
    if (region_.cols() > 0) {
      const MatrixX tail = solved(region_, known_region_, 0, region_.cols(), at);
      VERNIER_LATER(known_region_).middleRows(at, block_) = tail;
      region_variance_ -= squared_column_norms(tail);
    }
    if (chosen_ < kept_) return false;
    account_for_measured(VERNIER_LATER(picks_).transpose(), columns_, region_);
    chosen_ = 0;
    begin();
    return true;
  }
  /// Mean variance of the region's points, three rows each.
  VERNIER_LOCAL double region_variance() const {
    return 3 * region_variance_.sum() / static_cast<double>(region_.cols());
  }

 private:
  /// V of all candidates, of which none is chosen.
  VERNIER_LOCAL void begin() {
    variance_.setZero();
    std::fill(level_.begin(), level_.end(), Index{0});
    for (Index c = 0; c < size(); ++c) add_to_variance(c, products(columns_, c), 1);
    if (!by_region_) return;
    to_region_.setZero(region_.cols(), columns_.cols());
    add_transposed_product(to_region_, region_, columns_);
  }
  /// Products of a candidate's columns with each other; zero beyond them.
  VERNIER_LOCAL Matrix6 products(const MatrixX& columns, Index c) const {
    Matrix6 out = Matrix6::Zero();
    for (Index a = 0; a < block_; ++a)
      for (Index b = 0; b <= a; ++b)
        out(a, b) = out(b, a) =
            VERNIER_LATER(columns).col(c * block_ + a).dot(VERNIER_LATER(columns).col(c * block_ + b));
    return out;
  }
  VERNIER_LOCAL void add_to_variance(Index c, const Matrix6& change, double sign) {
    for (Index b = 0; b < block_; ++b)
      for (Index a = 0; a < block_; ++a) variance_(a, c * block_ + b) += sign * change(a, b);
  }
  /// Cholesky factor of I + V of a candidate.
  VERNIER_LOCAL Matrix6 factor(Index c) const {
    return factor_of_sum(VERNIER_LATER(variance_).middleCols(c * block_, block_));
  }
  /// Rows `from` .. of some columns of the solution of `F known = P' columns`, of which those before are known.
  VERNIER_LOCAL MatrixX solved(const MatrixX& columns, const MatrixX& known, Index first, Index count,
                               Index from) const {
    const Index rows = chosen_ * block_ - from;
    MatrixX out = MatrixX::Zero(rows, count);
    add_transposed_product(out, VERNIER_LATER(picks_).middleCols(from, rows),
                           VERNIER_LATER(columns).middleCols(first, count));
    add_product(out, VERNIER_LATER(factor_).block(from, 0, rows, from),
                VERNIER_LATER(known).block(0, first, from, count), -1);
    solve_lower(VERNIER_LATER(factor_).block(from, from, rows, rows), out);
    return out;
  }

  MatrixX columns_, region_;
  Index block_, chosen_ = 0;
  Index kept_;  // choices after which P begins anew
  MatrixX picks_, factor_, known_, known_region_;
  MatrixX variance_;          // V of each candidate, beside each other
  MatrixX to_region_{};       // K of each candidate, likewise
  std::vector<Index> level_;  // number of choices that V of each candidate knows
  bool by_region_;
  VectorX region_variance_;  // of each row
};

VERNIER_LOCAL void check_design(const ConstMatrixRef& rows, Index block, const ConstMatrixRef& measured,
                                const ConstMatrixRef& region, const PoseDesignOptions& options) {
  demand(block >= 1 && block <= 6, "design_poses: ", block, " rows a candidate, must be 1 to 6");
  demand(rows.rows() % block == 0, "design_poses: ", rows.rows(), " rows are no multiple of ", block);
  const Index n = rows.rows() / block, p = rows.cols();
  demand(options.count >= 0 && options.count <= n, "design_poses: ", options.count, " of ", n, " candidates");
  demand(measured.rows() == 0 || measured.cols() == p, "design_poses: measured rows of ", measured.cols(),
         " unknowns, candidates of ", p);
  demand(region.rows() == 0 || region.cols() == p, "design_poses: a region of ", region.cols(),
         " unknowns, candidates of ", p);
  demand(region.rows() % 3 == 0, "design_poses: ", region.rows(), " rows of the region are no multiple of 3");
  demand(options.criterion != DesignCriterion::region_variance || region.rows() > 0,
         "design_poses: no region whose variance could be reduced");
  demand(all_finite(rows) && all_finite(measured) && all_finite(region), "design_poses: a row is not finite");
  const Eigen::MatrixXi& bins = options.coverage.bins;
  demand(bins.rows() == 0 || bins.rows() == n, "design_poses: bins of ", bins.rows(), " candidates, expected ", n);
  demand(bins.size() == 0 ||
             (VERNIER_LATER(bins).minCoeff() >= 0 && VERNIER_LATER(bins).maxCoeff() < options.coverage.missing.size()),
         "design_poses: a bin is not in 0 .. ", options.coverage.missing.size() - 1);
}

/// What a candidate offers; the greatest is chosen.
struct DesignOffer {
  int covered;  ///< missing bins
  double gain;
  Index candidate;

  /// Of equals the first candidate comes first.
  bool operator<(const DesignOffer& other) const {
    if (covered != other.covered) return covered < other.covered;
    if (!same_value(gain, other.gain)) return gain < other.gain;
    return candidate > other.candidate;
  }
};

}  // namespace detail

VERNIER_IMPL PoseDesign design_poses(const ConstMatrixRef& rows, Index block, const PoseDesignOptions& options,
                                     const ConstMatrixRef& measured, const ConstMatrixRef& region) {
  detail::check_design(rows, block, measured, region, options);
  const Eigen::MatrixXi& bins = options.coverage.bins;
  const bool by_region = options.criterion == DesignCriterion::region_variance;
  PoseDesign out;
  out.missing = options.coverage.missing;
  out.log_det.setZero(options.count + 1);
  MatrixX candidates = VERNIER_LATER(rows).transpose(),
          to_predict = region.rows() > 0 ? MatrixX(VERNIER_LATER(region).transpose()) : MatrixX(rows.cols(), 0);
  if (measured.rows() > 0) detail::account_for_measured(measured, candidates, to_predict);
  detail::GrowingDesign design(std::move(candidates), std::move(to_predict), block, options);
  if (region.rows() > 0) {
    out.region_variance.resize(options.count + 1);
    out.region_variance(0) = design.region_variance();
  }
  const auto covered = [&](Index c) {
    int sum = 0;
    for (Index k = 0; bins.rows() > 0 && k < bins.cols(); ++k) sum += out.missing(bins(c, k)) > 0 ? 1 : 0;
    return sum;
  };
  const auto offer = [&](Index c) {
    return detail::DesignOffer{covered(c), by_region ? design.reduction(c) : design.information(c), c};
  };
  std::vector<detail::DesignOffer> heap;
  for (Index c = 0; c < design.size(); ++c) heap.push_back(offer(c));
  std::make_heap(heap.begin(), heap.end());
  bool all_known = false;
  for (Index step = 0; step < options.count; ++step) {
    if (by_region && step > 0 && !all_known) design.update(0, design.size());  // reductions may also grow by a choice
    if (all_known || (by_region && step > 0)) {
      for (detail::DesignOffer& of : heap) of = offer(of.candidate);
      std::make_heap(heap.begin(), heap.end());
    }
    // information and missing bins never grow by a choice, so offers of before are upper bounds
    while (!design.up_to_date(heap.front().candidate)) {
      std::pop_heap(heap.begin(), heap.end());
      const Index c = heap.back().candidate;
      design.update(c, 1);
      heap.back() = offer(c);
      std::push_heap(heap.begin(), heap.end());
    }
    std::pop_heap(heap.begin(), heap.end());
    const Index best = heap.back().candidate;
    heap.pop_back();
    out.chosen.push_back(best);
    out.log_det(step + 1) = out.log_det(step) + design.information(best);
    for (Index k = 0; bins.rows() > 0 && k < bins.cols(); ++k) {
      int& missing = out.missing(bins(best, k));
      missing = (std::max)(0, missing - 1);
    }
    all_known = design.choose(best);
    if (region.rows() > 0) out.region_variance(step + 1) = design.region_variance();
  }
  return out;
}

namespace detail {

/// A concave function of weights, log det of the information, and its gradient.
struct WeightedInformation {
  double value;
  VectorX gradient;
};
VERNIER_LOCAL WeightedInformation weighted_information(const ConstMatrixRef& rows, Index block,
                                                       const VectorX& weights) {
  VectorX roots(rows.rows());
  for (Index i = 0; i < roots.size(); ++i) roots(i) = std::sqrt(weights(i / block));
  const MatrixX weighted = rows_scaled(roots, rows);
  MatrixX information = MatrixX::Identity(rows.cols(), rows.cols()), columns = VERNIER_LATER(rows).transpose();
  add_transposed_product(information, weighted, weighted);
  demand(cholesky(information), "information_bound: the rows are not usable");
  solve_lower(information, columns);
  const VectorX squares = squared_column_norms(columns);
  WeightedInformation out{cholesky_log_determinant(information), VectorX::Zero(weights.size())};
  for (Index i = 0; i < squares.size(); ++i) out.gradient(i / block) += squares(i);
  return out;
}

/// Weights of at most one whose sum is that of `total`, in proportion to others where they are below one.
VERNIER_LOCAL void share_out(double total, VectorX& weights) {
  std::vector<bool> full(static_cast<std::size_t>(weights.size()), false);
  for (bool clipped = true; clipped;) {
    clipped = false;
    double sum = 0;
    for (Index c = 0; c < weights.size(); ++c) sum += full[static_cast<std::size_t>(c)] ? 0 : weights(c);
    if (!(sum > 0)) return;
    const double factor = total / sum;
    for (Index c = 0; c < weights.size(); ++c) {
      if (full[static_cast<std::size_t>(c)]) continue;
      weights(c) *= factor;
      if (weights(c) < 1) continue;
      weights(c) = 1;
      full[static_cast<std::size_t>(c)] = true;
      total -= 1;
      clipped = true;
    }
  }
}

}  // namespace detail

VERNIER_IMPL double information_bound(const ConstMatrixRef& rows, Index block, Index count, int iterations) {
  demand(block >= 1 && rows.rows() % block == 0, "information_bound: ", rows.rows(), " rows are no multiple of ",
         block);
  const Index n = rows.rows() / block;
  demand(count >= 0 && count <= n, "information_bound: ", count, " of ", n, " candidates");
  demand(iterations >= 1, "information_bound: ", iterations, " iterations, must be at least 1");
  VectorX weights = VectorX::Constant(n, static_cast<double>(count) / static_cast<double>(std::max<Index>(n, 1)));
  double best = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto at = detail::weighted_information(rows, block, weights);
    VectorX largest = at.gradient;
    std::nth_element(largest.begin(), largest.begin() + count, largest.end(), std::greater<>());
    best = (std::min)(best, at.value + VERNIER_LATER(largest).head(count).sum() - weights.dot(at.gradient));
    weights = VERNIER_LATER(weights).cwiseProduct(at.gradient);
    detail::share_out(static_cast<double>(count), weights);
  }
  return best;
}

}  // namespace vernier
