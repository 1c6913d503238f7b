#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
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

/// A design that grows. Of all rows chosen so far, P, it keeps the Cholesky factor F of `I + P P'`; a candidate with
/// rows A then has `V = A A' - known' known`, `F known = P A'`, which is brought up to date where it is looked at.
class GrowingDesign {
  /// The columns of a candidate.
  template <class M>
  auto of(M& matrix, Index c) const {
    return matrix.middleCols(c * block_, block_);
  }

 public:
  /// @param candidates p x n b, what the rows are transposed
  /// @param region     p x r, likewise
  VERNIER_API GrowingDesign(MatrixX candidates, MatrixX region, Index block, const PoseDesignOptions& options)
      : columns_(std::move(candidates)),
        region_(std::move(region)),
        block_(block),
        picks_(columns_.rows(), options.count * block),
        factor_(MatrixX::Zero(options.count * block, options.count * block)),
        known_(options.count * block, columns_.cols()),
        known_region_(options.count * block, region_.cols()),
        variance_(block, columns_.cols()),
        level_(static_cast<std::size_t>(size()), 0),
        region_variance_(region_.colwise().squaredNorm().transpose()) {
    for (Index c = 0; c < size(); ++c) of(variance_, c) = of(columns_, c).transpose().lazyProduct(of(columns_, c));
    if (options.criterion != DesignCriterion::region_variance) return;
    to_region_.setZero(region_.cols(), columns_.cols());
    add_transposed_product(to_region_, region_, columns_);
  }

  /// Number of candidates.
  Index size() const { return columns_.cols() / block_; }
  /// Whether V of a candidate is that of all choices.
  bool up_to_date(Index c) const { return level_[static_cast<std::size_t>(c)] == chosen_; }
  /// Brings V of some candidates up to date, all of which were last at the same time.
  VERNIER_API void update(Index first, Index count) {
    const Index from = level_[static_cast<std::size_t>(first)] * block_, rows = chosen_ * block_ - from;
    MatrixX tail = solved(columns_.middleCols(first * block_, count * block_),
                          known_.middleCols(first * block_, count * block_), from);
    known_.block(from, first * block_, rows, count * block_) = tail;
    for (Index c = 0; c < count; ++c) {
      of(variance_, first + c) -= of(tail, c).transpose().lazyProduct(of(tail, c));
      level_[static_cast<std::size_t>(first + c)] = chosen_;
    }
    if (to_region_.size() > 0)
      add_transposed_product(to_region_.middleCols(first * block_, count * block_),
                             known_region_.middleRows(from, rows), tail, -1);
  }
  /// Information of a candidate that is up to date [nat].
  VERNIER_API double information(Index c) const {
    return 2 * factor_of_sum(of(variance_, c)).diagonal().array().log().sum();
  }
  /// By how much it reduces the sum of the region's variances.
  VERNIER_API double reduction(Index c) const {
    const SmallMatrix factor = factor_of_sum(of(variance_, c));
    SmallMatrix sum = of(to_region_, c).transpose().lazyProduct(of(to_region_, c));
    factor.triangularView<Eigen::Lower>().solveInPlace(sum);
    factor.triangularView<Eigen::Lower>().transpose().solveInPlace(sum);
    return sum.trace();
  }
  /// Chooses a candidate that is up to date.
  VERNIER_API void choose(Index c) {
    const Index at = chosen_ * block_;
    picks_.middleCols(at, block_) = of(columns_, c);
    factor_.block(at, 0, block_, at) = of(known_, c).topRows(at).transpose();
    factor_.block(at, at, block_, block_) = factor_of_sum(of(variance_, c));
    ++chosen_;
    if (region_.cols() == 0) return;
    known_region_.middleRows(at, block_) = solved(region_, known_region_, at);
    region_variance_ -= known_region_.middleRows(at, block_).colwise().squaredNorm().transpose();
  }
  /// Mean variance of the region's points, three rows each.
  double region_variance() const { return 3 * region_variance_.sum() / static_cast<double>(region_.cols()); }

 private:
  /// Rows `from` .. of the solution of `F known = P' columns`, of which those before are known.
  VERNIER_API MatrixX solved(const ConstMatrixRef& columns, const ConstMatrixRef& known, Index from) const {
    const Index rows = chosen_ * block_ - from;
    MatrixX out = MatrixX::Zero(rows, columns.cols());
    add_transposed_product(out, picks_.middleCols(from, rows), columns);
    add_product(out, factor_.block(from, 0, rows, from), known.topRows(from), -1);
    solve_lower(factor_.block(from, from, rows, rows), out);
    return out;
  }

  MatrixX columns_, region_;
  Index block_, chosen_ = 0;
  MatrixX picks_, factor_, known_, known_region_;
  MatrixX variance_;          // V of each candidate, beside each other
  MatrixX to_region_{};       // K of each candidate, likewise
  std::vector<Index> level_;  // number of choices that V of each candidate knows
  VectorX region_variance_;   // of each row
};

/// Solves for columns in which unknowns of the prior precision I + measured' measured have the prior precision I.
VERNIER_API void account_for_measured(const ConstMatrixRef& measured, MatrixX& candidates, MatrixX& region) {
  MatrixX precision = MatrixX::Identity(measured.cols(), measured.cols());
  add_transposed_product(precision, measured, measured);
  require(cholesky(precision), "design_poses: the measured rows are not usable");
  solve_lower(precision, candidates);
  solve_lower(precision, region);
}

VERNIER_API void check_design(const ConstMatrixRef& rows, Index block, const ConstMatrixRef& measured,
                              const ConstMatrixRef& region, const PoseDesignOptions& options) {
  require(block >= 1 && block <= 6, "design_poses: ", block, " rows a candidate, must be 1 to 6");
  require(rows.rows() % block == 0, "design_poses: ", rows.rows(), " rows are no multiple of ", block);
  const Index n = rows.rows() / block, p = rows.cols();
  require(options.count >= 0 && options.count <= n, "design_poses: ", options.count, " of ", n, " candidates");
  require(measured.rows() == 0 || measured.cols() == p, "design_poses: measured rows of ", measured.cols(),
          " unknowns, candidates of ", p);
  require(region.rows() == 0 || region.cols() == p, "design_poses: a region of ", region.cols(),
          " unknowns, candidates of ", p);
  require(region.rows() % 3 == 0, "design_poses: ", region.rows(), " rows of the region are no multiple of 3");
  require(options.criterion != DesignCriterion::region_variance || region.rows() > 0,
          "design_poses: no region whose variance could be reduced");
  require(rows.allFinite() && measured.allFinite() && region.allFinite(), "design_poses: a row is not finite");
  const Eigen::MatrixXi& bins = options.coverage.bins;
  require(bins.rows() == 0 || bins.rows() == n, "design_poses: bins of ", bins.rows(), " candidates, expected ", n);
  require(bins.size() == 0 || (bins.minCoeff() >= 0 && bins.maxCoeff() < options.coverage.missing.size()),
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
    if (gain != other.gain) return gain < other.gain;
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
  MatrixX candidates = rows.transpose(),
          to_predict = region.rows() > 0 ? MatrixX(region.transpose()) : MatrixX(rows.cols(), 0);
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
  for (Index step = 0; step < options.count; ++step) {
    if (by_region && step > 0) {  // reductions may also grow by a choice
      design.update(0, design.size());
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
      missing = std::max(0, missing - 1);
    }
    design.choose(best);
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
VERNIER_API WeightedInformation weighted_information(const ConstMatrixRef& rows, Index block, const VectorX& weights) {
  MatrixX columns = rows.transpose();
  for (Index c = 0; c < weights.size(); ++c) columns.middleCols(c * block, block) *= std::sqrt(weights(c));
  MatrixX information = MatrixX::Identity(rows.cols(), rows.cols());
  add_product(information, columns, columns.transpose());
  require(cholesky(information), "information_bound: the rows are not usable");
  columns = rows.transpose();
  solve_lower(information, columns);
  WeightedInformation out{2 * information.diagonal().array().log().sum(), VectorX(weights.size())};
  for (Index c = 0; c < weights.size(); ++c) out.gradient(c) = columns.middleCols(c * block, block).squaredNorm();
  return out;
}

/// Weights of at most one whose sum is that of `total`, in proportion to others where they are below one.
VERNIER_API void share_out(double total, VectorX& weights) {
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
  require(block >= 1 && rows.rows() % block == 0, "information_bound: ", rows.rows(), " rows are no multiple of ",
          block);
  const Index n = rows.rows() / block;
  require(count >= 0 && count <= n, "information_bound: ", count, " of ", n, " candidates");
  require(iterations >= 1, "information_bound: ", iterations, " iterations, must be at least 1");
  VectorX weights = VectorX::Constant(n, static_cast<double>(count) / static_cast<double>(std::max<Index>(n, 1)));
  double best = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto at = detail::weighted_information(rows, block, weights);
    VectorX largest = at.gradient;
    std::nth_element(largest.begin(), largest.begin() + count, largest.end(), std::greater<>());
    best = std::min(best, at.value + largest.head(count).sum() - weights.dot(at.gradient));
    weights = weights.cwiseProduct(at.gradient);
    detail::share_out(static_cast<double>(count), weights);
  }
  return best;
}

}  // namespace vernier
