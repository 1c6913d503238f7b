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

/// A design that grows, with S, the covariance of the unknowns. A candidate of rows A has `V = A S A'`. A choice takes
/// `G G'` off S, `G = S A' F^-T` for the Cholesky factor F of I + V, so it takes `W' W`, `W = G' A'`, off V of another.
/// V is brought up to date where it is looked at, and that of all candidates after every eighth choice, by products of
/// large matrices. S follows then, too. So memory and time of a choice do not grow with the number of choices.
class GrowingDesign {
 public:
  /// @param region unknowns x r, rows transposed
  VERNIER_LOCAL GrowingDesign(const CandidateRows& rows, const ConstMatrixRef& measured, MatrixX region,
                              const PoseDesignOptions& options)
      : rows_(rows),
        region_(std::move(region)),
        block_(rows.block),
        observer_(options.observer),
        covariance_(MatrixX::Identity(rows.unknowns(), rows.unknowns())),
        directions_(rows.unknowns(), kept * block_),
        of_region_(region_.cols(), kept * block_),
        variance_(MatrixX::Zero(block_, rows.dense.cols())),
        level_(static_cast<std::size_t>(size()), 0) {
    MatrixX factor(0, 0);  // of the precision, where there are measured rows
    if (measured.rows() > 0) {
      factor = covariance_;
      add_transposed_product(factor, measured, measured);
      demand(cholesky(factor), "design_poses: the rows are not usable");
      covariance_ = inverse_from_cholesky(factor);
    }
    MatrixX region_then = region_;
    if (factor.size() > 0) solve_lower(factor, region_then);
    region_variance_ = squared_column_norms(region_then);
    const bool by_region = options.criterion == DesignCriterion::region_variance;
    if (by_region) to_region_ = MatrixX::Zero(region_.cols(), rows.dense.cols());
    in_parts(
        [&](Index first, Index count) {
          MatrixX columns = rows_.columns(first, count);
          if (factor.size() > 0) solve_lower(factor, columns);
          for (Index c = 0; c < count; ++c) add_to_variance(first + c, squared_in(columns, c), 1);
          if (by_region)
            add_transposed_product(VERNIER_LATER(to_region_).middleCols(first * block_, count * block_), region_then,
                                   columns);
        },
        factor.size() > 0 ? part / 8 : part);  // a solution takes longest
  }

  /// Number of candidates.
  Index size() const { return rows_.size(); }
  /// Whether V of a candidate is that of all choices.
  bool up_to_date(Index c) const { return level_[static_cast<std::size_t>(c)] == chosen_; }
  /// Brings V of some candidates up to date.
  VERNIER_LOCAL void update(Index first, Index count) {
    const auto level = [&](Index c) -> Index& { return level_[static_cast<std::size_t>(c)]; };
    Index oldest = level(first);
    for (Index c = first; c < first + count; ++c) oldest = (std::min)(oldest, level(c));
    const Index from = oldest * block_, rows = chosen_ * block_ - from;
    if (rows == 0) return;
    const MatrixX change = rows_.products(VERNIER_LATER(directions_).middleCols(from, rows), first, count);
    for (Index c = first; c < first + count; ++c) {
      add_to_variance(c, squared_in(change, c - first, level(c) * block_ - from), -1);
      level(c) = chosen_;
    }
    if (to_region_.size() > 0)  // by a region all candidates are always of one level
      add_product(VERNIER_LATER(to_region_).middleCols(first * block_, count * block_),
                  VERNIER_LATER(of_region_).middleCols(from, rows), change, -1);
  }
  /// Brings V of all candidates up to date, and the covariance as well when that is due.
  VERNIER_LOCAL void update_all() {
    in_parts([&](Index first, Index count) { update(first, count); });
    if (chosen_ < kept) return;
    add_product(covariance_, directions_, VERNIER_LATER(directions_).transpose(), -1);
    chosen_ = 0;
    std::fill(level_.begin(), level_.end(), Index{0});
  }
  /// Information of a candidate that is up to date [nat].
  VERNIER_LOCAL double information(Index c) const { return cholesky_log_determinant(factor(c)); }
  /// By how much it reduces the sum of the region's variances.
  VERNIER_LOCAL double reduction(Index c) const {
    Matrix6 sum = squared_in(to_region_, c);
    solve_cholesky(factor(c), sum);
    return sum.trace();
  }
  /// Chooses a candidate that is up to date.
  VERNIER_LOCAL void choose(Index c) {
    const Index at = chosen_ * block_;
    MatrixX gain = VERNIER_LATER(rows_.products(covariance_, c, 1));  // S A', S as of the last eighth choice
    const auto before = VERNIER_LATER(directions_).leftCols(at);
    add_product(gain, before, rows_.products(before, c, 1), -1);
    const Matrix6 own = factor(c);
    for (Index a = 0; a < block_; ++a) {  // G F' = S A'
      for (Index b = 0; b < a; ++b)
        for (Index k = 0; k < gain.rows(); ++k) gain(k, a) -= own(a, b) * gain(k, b);
      for (Index k = 0; k < gain.rows(); ++k) gain(k, a) /= own(a, a);
    }
    VERNIER_LATER(directions_).middleCols(at, block_) = gain;
    if (region_.cols() > 0) {
      const MatrixX change = transposed_matrix_product(region_, gain);
      VERNIER_LATER(of_region_).middleCols(at, block_) = change;
      region_variance_ -= squared_row_norms(change);
    }
    ++chosen_;
    ++progress_.generation;
  }
  /// Whether `update_all` is due.
  bool full() const { return chosen_ == kept; }
  /// Mean variance of the region's points, three rows each.
  VERNIER_LOCAL double region_variance() const {
    return 3 * region_variance_.sum() / static_cast<double>(region_.cols());
  }

 private:
  static constexpr Index kept = 8;  // choices from one renewal to the next
  static constexpr Index part = 256;

  /// Calls f(first, count) for all candidates, some at a time, and reports.
  template <class F>
  void in_parts(const F& f, Index at_a_time = part) const {
    for (Index first = 0; first < size(); first += at_a_time) {
      report_planning(observer_, progress_);
      f(first, (std::min)(at_a_time, size() - first));
    }
  }
  /// Products of a candidate's columns with each other; zero beyond them.
  /// @param from first row that counts
  VERNIER_LOCAL Matrix6 squared_in(const MatrixX& columns, Index c, Index from = 0) const {
    const Index rows = columns.rows() - from;
    const auto column = [&](Index k) { return VERNIER_LATER(columns).col(c * block_ + k).tail(rows); };
    Matrix6 out = Matrix6::Zero();
    for (Index a = 0; a < block_; ++a)
      for (Index b = 0; b <= a; ++b) out(a, b) = out(b, a) = column(a).dot(column(b));
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

  const CandidateRows& rows_;
  MatrixX region_;
  Index block_, chosen_ = 0;  // choices since the last renewal
  const ObserverRef& observer_;
  Progress progress_{};
  MatrixX covariance_;         // S as of then
  MatrixX directions_;         // G of each choice since, beside each other
  MatrixX of_region_;          // products of the region's rows and those
  MatrixX variance_;           // V of each candidate, beside each other
  MatrixX to_region_{};        // K of each candidate, likewise
  std::vector<Index> level_;   // number of choices since then that V of each candidate knows
  VectorX region_variance_{};  // of each row
};

VERNIER_LOCAL void check_design(const CandidateRows& rows, const ConstMatrixRef& measured, const ConstMatrixRef& region,
                                const PoseDesignOptions& options) {
  const Index n = rows.size(), p = rows.unknowns();
  demand(options.count >= 0 && options.count <= n, "design_poses: ", options.count, " of ", n, " candidates");
  demand(measured.rows() == 0 || measured.cols() == p, "design_poses: measured rows of ", measured.cols(),
         " unknowns, candidates of ", p);
  demand(region.rows() == 0 || region.cols() == p, "design_poses: a region of ", region.cols(),
         " unknowns, candidates of ", p);
  demand(region.rows() % 3 == 0, "design_poses: ", region.rows(), " rows of the region are no multiple of 3");
  demand(options.criterion != DesignCriterion::region_variance || region.rows() > 0,
         "design_poses: no region whose variance could be reduced");
  demand(rows.finite() && all_finite(measured) && all_finite(region), "design_poses: a row is not finite");
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

/// Makes all choices; those made are in `out` whenever it ends.
/// @throws PlanningStopped where the observer requests a stop
VERNIER_LOCAL void choose_poses(const CandidateRows& rows, const PoseDesignOptions& options,
                                const ConstMatrixRef& measured, const ConstMatrixRef& region, PoseDesign& out) {
  const Eigen::MatrixXi& bins = options.coverage.bins;
  const bool by_region = options.criterion == DesignCriterion::region_variance;
  GrowingDesign design(rows, measured,
                       region.rows() > 0 ? MatrixX(VERNIER_LATER(region).transpose()) : MatrixX(rows.unknowns(), 0),
                       options);
  if (region.rows() > 0) out.region_variance(0) = design.region_variance();
  const auto covered = [&](Index c) {
    int sum = 0;
    for (Index k = 0; bins.rows() > 0 && k < bins.cols(); ++k) sum += out.missing(bins(c, k)) > 0 ? 1 : 0;
    return sum;
  };
  const auto offer = [&](Index c) {
    return DesignOffer{covered(c), by_region ? design.reduction(c) : design.information(c), c};
  };
  std::vector<DesignOffer> heap;
  for (Index c = 0; c < design.size(); ++c) heap.push_back(offer(c));
  std::make_heap(heap.begin(), heap.end());
  for (Index step = 0; step < options.count; ++step) {
    if (design.full() || (by_region && step > 0)) {  // reductions may also grow by a choice
      design.update_all();
      for (DesignOffer& of : heap) of = offer(of.candidate);
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
    design.choose(best);
    if (region.rows() > 0) out.region_variance(step + 1) = design.region_variance();
    report_planning(options.observer, {step + 1, 0, out.log_det(step + 1)});
  }
}

VERNIER_IMPL PoseDesign design_poses(const CandidateRows& rows, const PoseDesignOptions& options,
                                     const ConstMatrixRef& measured, const ConstMatrixRef& region) {
  check_design(rows, measured, region, options);
  PoseDesign out;
  out.missing = options.coverage.missing;
  out.log_det.setZero(options.count + 1);
  if (region.rows() > 0) out.region_variance.setZero(options.count + 1);
  try {
    choose_poses(rows, options, measured, region, out);
  } catch (const PlanningStopped&) {
    const auto made = static_cast<Index>(out.chosen.size());
    out.log_det.conservativeResize(made + 1);
    if (region.rows() > 0) out.region_variance.conservativeResize(made + 1);
  }
  return out;
}

}  // namespace detail

VERNIER_IMPL PoseDesign design_poses(const ConstMatrixRef& rows, Index block, const PoseDesignOptions& options,
                                     const ConstMatrixRef& measured, const ConstMatrixRef& region) {
  demand(block >= 1 && block <= 6, "design_poses: ", block, " rows a candidate, must be 1 to 6");
  demand(rows.rows() % block == 0, "design_poses: ", rows.rows(), " rows are no multiple of ", block);
  detail::CandidateRows candidates{.block = block};
  candidates.dense = VERNIER_LATER(rows).transpose();
  return detail::design_poses(candidates, options, measured, region);
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
