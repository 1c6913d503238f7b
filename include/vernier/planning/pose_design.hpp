// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which of many candidate measurements determine the unknowns of a linear model best: greedy Bayesian optimal design.

#include <vector>

#include "vernier/core/types.hpp"
#include "vernier/planning/detail/candidate_rows.hpp"

namespace vernier {

/// What a design improves.
enum class DesignCriterion {
  information,     ///< D: log det of the information about all unknowns
  region_variance  ///< A: mean predicted variance over a region
};

/// Bins that the chosen candidates are to cover, e.g. ranges of each joint.
struct BinCoverage {
  Eigen::MatrixXi bins{};     ///< n x k: the k bins in which each candidate lies, from 0; no rows: no bins
  Eigen::VectorXi missing{};  ///< candidates that each bin still needs; bins that no candidate lies in count, too
};

/// Options of `design_poses`.
struct PoseDesignOptions {
  Index count = 0;                                           ///< number of candidates to choose
  DesignCriterion criterion = DesignCriterion::information;  ///< what a choice improves
  BinCoverage coverage{};  ///< covered first: a candidate that covers more missing bins comes before a better one
  /// Who watches; must outlive the call. Told after each choice, and between while many candidates are looked at. A
  /// stop ends the design with what was chosen until then.
  ObserverRef observer{};
};

/// Chosen candidates, and what they are worth.
struct PoseDesign {
  std::vector<Index> chosen{};  ///< in the order of choice; fewer than asked for where the observer stopped it
  VectorX log_det{};            ///< `log det(I + sum A'A)` after 0, 1, .. choices, relative to the start [nat]
  VectorX region_variance{};    ///< mean variance over the blocks of the region, likewise; empty without a region
  Eigen::VectorXi missing{};    ///< candidates that bins lack at the end
};

/// Chooses candidates one at a time, each the best beside those before it; of equals the first.
///
/// Unknowns are in units of their prior sizes, so the prior is N(0, I). With S the covariance given what was chosen,
/// a candidate with rows A gains `log det(I + V)`, `V = A S A'`, of information, and reduces the sum of the region's
/// variances by `tr((I + V)^-1 K K')`, `K = A S B'`. V and K are kept for each candidate and updated by the choices.
/// Information never grows by other choices, so most candidates need no update at once.
/// @param rows     whitened rows of all candidates, `block` a candidate, one column an unknown
/// @param block    rows a candidate, 1 to 6
/// @param options  how many, and by which criterion
/// @param measured whitened rows of what was measured before; may have no rows
/// @param region   rows of what is to be predicted, whose variance is meant, three a pose; may have no rows, unless the
///                 criterion is `region_variance`
/// @throws std::invalid_argument for sizes that do not match, or values that are not finite
/// @complexity O(count (n b^2 p + b p^2)) for n candidates of b rows and p unknowns, memory O(n b p + p^2) whatever the
///             count; O(p^3 + n b p^2) more where there are measured rows, O(count n b^2 r) more for `region_variance`
///             over r rows
/// @cite Chaloner and Verdinelli 1995 (criteria); Minoux 1978 (lazy greedy choice)
VERNIER_API PoseDesign design_poses(const ConstMatrixRef& rows, Index block, const PoseDesignOptions& options,
                                    const ConstMatrixRef& measured = MatrixX(),
                                    const ConstMatrixRef& region = MatrixX());

namespace detail {

/// Chooses candidates as `vernier::design_poses`, of rows that are products of few numbers.
VERNIER_API PoseDesign design_poses(const CandidateRows& rows, const PoseDesignOptions& options,
                                    const ConstMatrixRef& measured, const ConstMatrixRef& region);

}  // namespace detail

/// A bound on the information of any choice, by concavity: log det at fractional weights `0 <= w <= 1` of sum `count`,
/// plus the `count` largest entries of its gradient, less what the weights have of it. With many unknowns it is loose.
/// @param rows       as for `design_poses`
/// @param block      rows a candidate
/// @param count      number of candidates that may be chosen
/// @param iterations multiplicative updates of the weights; the smallest bound of all is returned [nat]
/// @throws std::invalid_argument for sizes that do not match
/// @complexity O(iterations (p^3 + n b p^2))
/// @cite Silvey, Titterington and Torsney 1978; Boyd and Vandenberghe 2004 (7.5)
VERNIER_API double information_bound(const ConstMatrixRef& rows, Index block, Index count, int iterations = 10);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/planning/pose_design.ipp"
#endif
