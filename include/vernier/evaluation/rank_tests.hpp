// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Nonparametric comparison of methods: Wilcoxon's rank-sum and signed-rank tests, Holm's correction, average ranks and
/// Nemenyi's critical difference.

#include "vernier/core/types.hpp"

namespace vernier {

/// Outcome of a two-sided rank test.
struct RankTest {
  double statistic = 0;  ///< U of the first sample, or the sum of the ranks of positive differences
  double p_value = 1;    ///< probability, under the null hypothesis, of a statistic at least as far from its mean
  bool exact = false;    ///< from all arrangements; else from the normal approximation
};

/// Ranks 1 .. n of values in ascending order; ties share their mean rank.
/// @throws std::invalid_argument for a value that is not a number
VERNIER_API VectorX ranks(const ConstVectorRef& values);

/// Wilcoxon's rank-sum test (Mann and Whitney's U) of two independent samples, two-sided. Infinite values rank highest
/// or lowest. Exact without ties where neither sample is larger than `exact_up_to`; otherwise the normal approximation
/// with corrections for ties and continuity.
/// @throws std::invalid_argument for an empty sample or a value that is not a number
/// @complexity O(n m (n + m) min(n, m)) where exact
/// @cite Wilcoxon 1945; Mann and Whitney 1947
VERNIER_API RankTest rank_sum_test(const ConstVectorRef& a, const ConstVectorRef& b, Index exact_up_to = 49);

/// Wilcoxon's signed-rank test of paired samples, two-sided: `a(i)` and `b(i)` are a pair. Pairs without a difference
/// are dropped. Exact without ties and zero differences and for at most `exact_up_to` pairs; otherwise the normal
/// approximation with corrections for ties and continuity.
/// @throws std::invalid_argument for samples of unequal size or differences that are not numbers
/// @cite Wilcoxon 1945
VERNIER_API RankTest signed_rank_test(const ConstVectorRef& a, const ConstVectorRef& b, Index exact_up_to = 49);

/// p-values of several tests, adjusted so that their family-wise error rate is controlled; in the order given.
/// @throws std::invalid_argument for a value outside [0, 1]
/// @cite Holm 1979
VERNIER_API VectorX holm(const ConstVectorRef& p_values);

/// Mean rank of each method over cases, 1 the best, for a critical-difference diagram.
/// @param values cases x methods, smaller is better
/// @return one number a method; their mean is (methods + 1) / 2
/// @throws std::invalid_argument without cases or methods, or for a value that is not a number
/// @cite Demsar 2006
VERNIER_API VectorX average_ranks(const ConstMatrixRef& values);

/// Least difference of two average ranks, of k methods over n cases, that is significant at level `alpha` (Nemenyi's
/// test): `q sqrt(k (k + 1) / (12 n))`, q the quantile of the range of k standard normal values.
/// @throws std::invalid_argument unless methods >= 2, cases >= 1 and alpha lies in (0, 1)
/// @cite Nemenyi 1963; Demsar 2006
VERNIER_API double critical_difference(Index methods, Index cases, double alpha = 0.05);

/// A rank correlation.
struct RankCorrelation {
  double rho = 0;      ///< in [-1, 1]
  double p_value = 1;  ///< two-sided
};

/// Spearman's rank correlation of paired samples, with a p-value by the normal approximation. Fewer than three pairs,
/// and samples of equal values, have none: 0 with p = 1.
/// @cite Spearman 1904
VERNIER_API RankCorrelation rank_correlation(const VectorX& a, const VectorX& b);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/rank_tests.ipp"
#endif
