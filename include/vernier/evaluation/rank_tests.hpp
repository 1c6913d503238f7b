#pragma once

/// @file
/// Whether one method is better than another, from ranks alone: Wilcoxon's two tests, Holm's correction, average ranks.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "vernier/core/argsort.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// What a two-sided rank test says.
struct RankTest {
  double statistic = 0;  ///< U of the first sample, or the sum of the ranks of positive differences
  double p_value = 1;    ///< two-sided: how likely a statistic at least as far from its mean is where nothing differs
  bool exact = false;    ///< from all arrangements; else from a normal distribution
};

/// Ranks 1 .. n of values in rising order; equal ones share the mean of theirs.
/// @throws std::invalid_argument for a value that is not a number
inline VectorX ranks(const Eigen::Ref<const VectorX>& values) {
  for (Index i = 0; i < values.size(); ++i) require(!std::isnan(values(i)), "ranks: value ", i, " is not a number");
  const auto order = argsort(values);
  VectorX out(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && values(order[end]) == values(order[begin])) ++end;
    for (std::size_t i = begin; i < end; ++i) out(order[i]) = static_cast<double>(begin + end + 1) / 2;
  }
  return out;
}

namespace detail {

/// Sum of t^3 - t over groups of t equal ranks: t^2 - 1 for each of their members. O(n^2).
inline double ties(const VectorX& ranks) {
  double sum = 0;
  for (const double rank : ranks) {
    const auto t = static_cast<double>((ranks.array() == rank).count());
    sum += t * t - 1;
  }
  return sum;
}

/// Two-sided p of a whole-numbered statistic whose values 0, 1, ... arise in so many ways.
inline double two_sided(const std::vector<double>& ways, double statistic) {
  const auto at = ways.begin() + static_cast<std::ptrdiff_t>(std::lround(statistic));
  const double below = std::accumulate(ways.begin(), at + 1, 0.0), above = std::accumulate(at, ways.end(), 0.0);
  return std::min(1.0, 2 * std::min(below, above) / std::accumulate(ways.begin(), ways.end(), 0.0));
}

/// The same from a normal distribution, with the correction of 1/2 for a statistic in whole steps.
inline double two_sided(double statistic, double mean, double variance) {
  if (!(variance > 0)) return 1;
  return std::erfc(std::max(0.0, std::abs(statistic - mean) - 0.5) / std::sqrt(2 * variance));
}

}  // namespace detail

/// Wilcoxon's rank-sum test (Mann and Whitney's U) of two independent samples, two-sided. Infinite values are the
/// greatest or least. Exact without ties where neither sample is larger than `exact_up_to`; otherwise normal, with the
/// corrections for ties and continuity. O(n m (n + m) min(n, m)) where exact.
/// @throws std::invalid_argument for an empty sample or a value that is not a number
/// @cite Wilcoxon 1945; Mann and Whitney 1947
inline RankTest rank_sum_test(const Eigen::Ref<const VectorX>& a, const Eigen::Ref<const VectorX>& b,
                              Index exact_up_to = 49) {
  require(a.size() >= 1 && b.size() >= 1, "rank_sum_test: samples of ", a.size(), " and ", b.size(), " values");
  const Index n = a.size(), m = b.size();
  VectorX joined(n + m);
  joined << a, b;
  const VectorX rank = ranks(joined);
  const double u = rank.head(n).sum() - static_cast<double>(n * (n + 1)) / 2, tied = detail::ties(rank);
  if (tied == 0 && std::max(n, m) <= exact_up_to) {
    // ways(k, u): choices of k of the ranks so far with that U; rank r as the k-th chosen beats r - k of the others
    MatrixX ways = MatrixX::Zero(n * m + 1, n + 1);
    ways(0, 0) = 1;
    for (Index r = 1; r <= n + m; ++r)
      for (Index k = std::min(r, n); k >= std::max<Index>(1, r - m); --k)
        ways.col(k).tail(n * m + 1 - (r - k)) += ways.col(k - 1).head(n * m + 1 - (r - k));
    return {u, detail::two_sided({ways.col(n).begin(), ways.col(n).end()}, u), true};
  }
  const auto pairs = static_cast<double>(n * m), all = static_cast<double>(n + m);
  return {u, detail::two_sided(u, pairs / 2, pairs / 12 * (all + 1 - tied / (all * (all - 1)))), false};
}

/// Wilcoxon's signed-rank test of paired samples, two-sided: `a(i)` and `b(i)` belong together. Pairs without a
/// difference are left out. Exact where no two differences have one size, none is zero and there are at most
/// `exact_up_to`; otherwise normal, with the corrections for ties and continuity.
/// @throws std::invalid_argument for samples of unequal size or differences that are not numbers
/// @cite Wilcoxon 1945
inline RankTest signed_rank_test(const Eigen::Ref<const VectorX>& a, const Eigen::Ref<const VectorX>& b,
                                 Index exact_up_to = 49) {
  require(a.size() == b.size() && a.size() >= 1, "signed_rank_test: ", a.size(), " and ", b.size(),
          " values are no pairs");
  std::vector<double> differences;
  for (Index i = 0; i < a.size(); ++i)
    if (a(i) != b(i)) differences.push_back(a(i) - b(i));  // equal infinities have no difference
  const auto n = static_cast<Index>(differences.size());
  const Eigen::Map<const VectorX> difference(differences.data(), n);
  const VectorX rank = ranks(difference.cwiseAbs());
  const double w = (difference.array() > 0).select(rank, 0).sum(), tied = detail::ties(rank);
  if (tied == 0 && n == a.size() && n <= exact_up_to) {
    std::vector<double> ways(static_cast<std::size_t>(n * (n + 1) / 2 + 1));
    ways[0] = 1;
    for (std::size_t r = 1; r <= static_cast<std::size_t>(n); ++r)
      for (std::size_t sum = ways.size() - 1; sum >= r; --sum) ways[sum] += ways[sum - r];
    return {w, detail::two_sided(ways, w), true};
  }
  const auto count = static_cast<double>(n);
  const double squares = count * (count + 1) * (2 * count + 1);
  return {w, detail::two_sided(w, count * (count + 1) / 4, squares / 24 - tied / 48), false};
}

/// p-values of several tests, corrected so that the chance of any false alarm among them stays what one of them says;
/// in the order given.
/// @throws std::invalid_argument for a value outside [0, 1]
/// @cite Holm 1979
inline VectorX holm(const Eigen::Ref<const VectorX>& p_values) {
  const Index n = p_values.size();
  for (const double p : p_values) require(p >= 0 && p <= 1, "holm: p-value ", p, " must lie in [0, 1]");
  const auto order = argsort(p_values);
  VectorX out(n);
  double greatest = 0;
  for (Index k = 0; k < n; ++k) {
    const Index i = order[static_cast<std::size_t>(k)];
    greatest = std::max(greatest, std::min(1.0, static_cast<double>(n - k) * p_values(i)));
    out(i) = greatest;
  }
  return out;
}

/// Mean rank of each method over cases, 1 the best, for a critical-difference figure.
/// @param values cases x methods, smaller is better
/// @return one number a method, of mean (methods + 1) / 2
/// @throws std::invalid_argument without cases or methods, or for a value that is not a number
/// @cite Demsar 2006
inline VectorX average_ranks(const Eigen::Ref<const MatrixX>& values) {
  require(values.size() > 0, "average_ranks: ", values.rows(), " cases of ", values.cols(), " methods");
  VectorX sum = VectorX::Zero(values.cols());
  for (Index i = 0; i < values.rows(); ++i) sum += ranks(values.row(i).transpose());
  return sum / static_cast<double>(values.rows());
}

/// By how much the average ranks of two of k methods over n cases must differ to show anything at level `alpha`
/// (Nemenyi's test): `q sqrt(k (k + 1) / (12 n))`, q the quantile of the range of k standard normal values.
/// @throws std::invalid_argument unless methods >= 2, cases >= 1 and alpha lies in (0, 1)
/// @cite Nemenyi 1963; Demsar 2006
inline double critical_difference(Index methods, Index cases, double alpha = 0.05) {
  require(methods >= 2 && cases >= 1, "critical_difference: ", methods, " methods over ", cases, " cases");
  require(alpha > 0 && alpha < 1, "critical_difference: alpha is ", alpha, ", must lie in (0, 1)");
  const auto normal = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  // P(range <= q): one value is the largest, at z, and all others lie within q below it
  const auto within = [&](double q) {
    constexpr double step = 0.01;
    double sum = 0;
    for (int i = -800; i <= 800; ++i) {
      const double z = i * step;
      sum += std::exp(-z * z / 2) * std::pow(normal(z) - normal(z - q), static_cast<double>(methods - 1));
    }
    return static_cast<double>(methods) * sum * step / std::sqrt(2 * 3.14159265358979323846);
  };
  double low = 0, high = 40;
  for (int i = 0; i < 60; ++i) (within((low + high) / 2) < 1 - alpha ? low : high) = (low + high) / 2;
  const auto k = static_cast<double>(methods);
  return high * std::sqrt(k * (k + 1) / (12 * static_cast<double>(cases)));
}

}  // namespace vernier
