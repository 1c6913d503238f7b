// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/evaluation/rank_tests.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "vernier/core/argsort.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"

namespace vernier {

VERNIER_IMPL VectorX ranks(const ConstVectorRef& values) {
  for (Index i = 0; i < values.size(); ++i) demand(!std::isnan(values(i)), "ranks: value ", i, " is not a number");
  const auto order = argsort(values);
  VectorX out(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && same_value(values(order[end]), values(order[begin]))) ++end;
    for (std::size_t i = begin; i < end; ++i) out(order[i]) = static_cast<double>(begin + end + 1) / 2;
  }
  return out;
}

namespace detail {

/// Sum of t^3 - t over groups of t equal ranks: t^2 - 1 for each of their members. O(n^2).
VERNIER_LOCAL double ties(const VectorX& ranks) {
  double sum = 0;
  for (const double rank : ranks) {
    const auto t = static_cast<double>(std::count(ranks.begin(), ranks.end(), rank));
    sum += t * t - 1;
  }
  return sum;
}

/// Two-sided p of a whole-numbered statistic, given the number of ways in which its values 0, 1, ... arise.
VERNIER_LOCAL double two_sided(const std::vector<double>& ways, double statistic) {
  const auto at = ways.begin() + static_cast<std::ptrdiff_t>(std::lround(statistic));
  const double below = std::accumulate(ways.begin(), at + 1, 0.0), above = std::accumulate(at, ways.end(), 0.0);
  return (std::min)(1.0, 2 * (std::min)(below, above) / std::accumulate(ways.begin(), ways.end(), 0.0));
}

/// Two-sided p of a statistic by a normal distribution, with the correction of 1/2 for a statistic in whole steps.
VERNIER_LOCAL double two_sided(double statistic, double mean, double variance) {
  if (!(variance > 0)) return 1;
  return std::erfc((std::max)(0.0, std::abs(statistic - mean) - 0.5) / std::sqrt(2 * variance));
}

}  // namespace detail

VERNIER_IMPL RankTest rank_sum_test(const ConstVectorRef& a, const ConstVectorRef& b, Index exact_up_to) {
  demand(a.size() >= 1 && b.size() >= 1, "rank_sum_test: samples of ", a.size(), " and ", b.size(), " values");
  const Index n = a.size(), m = b.size();
  VectorX joined(n + m);
  joined << a, b;
  const VectorX rank = ranks(joined);
  const double u = VERNIER_LATER(rank).head(n).sum() - static_cast<double>(n * (n + 1)) / 2, tied = detail::ties(rank);
  if (tied <= 0 && (std::max)(n, m) <= exact_up_to) {
    // ways(k, u): choices of k of the ranks so far with that U; rank r as the k-th chosen beats r - k of the others
    MatrixX ways = MatrixX::Zero(n * m + 1, n + 1);
    ways(0, 0) = 1;
    for (Index r = 1; r <= n + m; ++r)
      for (Index k = (std::min)(r, n); k >= std::max<Index>(1, r - m); --k)
        for (Index sum = r - k; sum <= n * m; ++sum) ways(sum, k) += ways(sum - (r - k), k - 1);
    return {u, detail::two_sided({VERNIER_LATER(ways).col(n).begin(), VERNIER_LATER(ways).col(n).end()}, u), true};
  }
  const auto pairs = static_cast<double>(n * m), all = static_cast<double>(n + m);
  return {u, detail::two_sided(u, pairs / 2, pairs / 12 * (all + 1 - tied / (all * (all - 1)))), false};
}

VERNIER_IMPL RankTest signed_rank_test(const ConstVectorRef& a, const ConstVectorRef& b, Index exact_up_to) {
  demand(a.size() == b.size() && a.size() >= 1, "signed_rank_test: ", a.size(), " and ", b.size(),
         " values are no pairs");
  std::vector<double> differences;
  for (Index i = 0; i < a.size(); ++i)
    if (!same_value(a(i), b(i))) differences.push_back(a(i) - b(i));  // equal infinities have no difference
  const auto n = static_cast<Index>(differences.size());
  VectorX sizes(n);
  for (Index i = 0; i < n; ++i) sizes(i) = std::abs(differences[static_cast<std::size_t>(i)]);
  const VectorX rank = ranks(sizes);
  double w = 0;
  for (Index i = 0; i < n; ++i) w += differences[static_cast<std::size_t>(i)] > 0 ? rank(i) : 0;
  const double tied = detail::ties(rank);
  if (tied <= 0 && n == a.size() && n <= exact_up_to) {
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

VERNIER_IMPL VectorX holm(const ConstVectorRef& p_values) {
  const Index n = p_values.size();
  for (const double p : p_values) demand(p >= 0 && p <= 1, "holm: p-value ", p, " must lie in [0, 1]");
  const auto order = argsort(p_values);
  VectorX out(n);
  double greatest = 0;
  for (Index k = 0; k < n; ++k) {
    const Index i = order[static_cast<std::size_t>(k)];
    greatest = (std::max)(greatest, (std::min)(1.0, static_cast<double>(n - k) * p_values(i)));
    out(i) = greatest;
  }
  return out;
}

VERNIER_IMPL VectorX average_ranks(const ConstMatrixRef& values) {
  demand(values.size() > 0, "average_ranks: ", values.rows(), " cases of ", values.cols(), " methods");
  VectorX sum = VectorX::Zero(values.cols());
  for (Index i = 0; i < values.rows(); ++i) sum += ranks(detail::row_of(values, i));
  return sum / static_cast<double>(values.rows());
}

VERNIER_IMPL double critical_difference(Index methods, Index cases, double alpha) {
  demand(methods >= 2 && cases >= 1, "critical_difference: ", methods, " methods over ", cases, " cases");
  demand(alpha > 0 && alpha < 1, "critical_difference: alpha is ", alpha, ", must lie in (0, 1)");
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

VERNIER_IMPL RankCorrelation rank_correlation(const VectorX& a, const VectorX& b) {
  if (a.size() < 3) return {};
  VectorX ra = ranks(a), rb = ranks(b);
  for (VectorX* one : {&ra, &rb}) {
    const double mean = one->mean();
    for (double& rank : *one) rank -= mean;
  }
  const double size = std::sqrt(ra.squaredNorm() * rb.squaredNorm());
  if (!(size > 0)) return {};
  const double rho = ra.dot(rb) / size;
  return {rho, std::erfc(std::abs(rho) * std::sqrt(static_cast<double>(a.size() - 1) / 2))};
}

}  // namespace vernier
