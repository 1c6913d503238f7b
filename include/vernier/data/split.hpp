#pragma once

/// @file
/// Ways to hold rows out: at random, every k-th, by region of space, by time.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/data/dataset.hpp"

namespace vernier {

/// Rows to learn from and rows to judge by; disjoint, together everything.
template <int N>
struct Split {
  Dataset<N> train;  ///< rows to learn from
  Dataset<N> test;   ///< rows to judge by
};

/// Options of `split`.
struct SplitOptions {
  double test_fraction = 0.2;  ///< share of rows held out, in (0, 1)
  std::uint64_t seed = 0;      ///< of the shuffle
};

/// A face of the measured box of positions.
enum class Face { x_low, x_high, y_low, y_high, z_low, z_high };

/// Options of `split_region`.
struct RegionOptions {
  double test_fraction = 0.2;  ///< share of rows held out, in (0, 1)
  Face face = Face::x_high;    ///< the rows nearest to this face are held out
};

namespace detail {

/// Rows held out of n; at least one on each side.
inline Index test_rows(const char* caller, Index n, double fraction) {
  require(fraction > 0 && fraction < 1, caller, ": test_fraction is ", fraction, ", must lie strictly between 0 and 1");
  require(n >= 2, caller, ": ", n, " rows cannot be split, at least 2 are needed");
  return std::clamp<Index>(static_cast<Index>(std::llround(fraction * static_cast<double>(n))), 1, n - 1);
}

/// Both sides in ascending row order.
template <int N>
Split<N> split_rows(const Dataset<N>& data, std::vector<Index> order, Index tests) {
  std::sort(order.begin(), order.begin() + tests);
  std::sort(order.begin() + tests, order.end());
  const std::span<const Index> all(order);
  const auto cut = static_cast<std::size_t>(tests);
  return {data.rows(all.subspan(cut)), data.rows(all.first(cut))};
}

}  // namespace detail

/// A seeded random share of the rows held out. Random splits flatter: neighbours of the test rows are in the training
/// set.
/// @throws std::invalid_argument for fewer than 2 rows or a fraction outside (0, 1)
template <int N>
Split<N> split(const Dataset<N>& data, const SplitOptions& options = {}) {
  const Index tests = detail::test_rows("split", data.size(), options.test_fraction);
  return detail::split_rows(data, Rng(options.seed).permutation(data.size()), tests);
}

/// Row i is a test row when i % k == 0.
/// @throws std::invalid_argument for k < 2 or fewer than 2 rows
template <int N>
Split<N> split_every(const Dataset<N>& data, Index k) {
  require(k >= 2, "split_every: k is ", k, ", must be at least 2");
  require(data.size() >= 2, "split_every: ", data.size(), " rows cannot be split, at least 2 are needed");
  std::vector<Index> train, test;
  for (Index i = 0; i < data.size(); ++i) (i % k == 0 ? test : train).push_back(i);
  return {data.rows(train), data.rows(test)};
}

/// The rows nearest to one face of the measured box held out: judges extrapolation in space.
/// @throws std::invalid_argument for fewer than 2 rows or a fraction outside (0, 1)
template <int N>
Split<N> split_region(const Dataset<N>& data, const RegionOptions& options = {}) {
  const Index tests = detail::test_rows("split_region", data.size(), options.test_fraction);
  const int axis = static_cast<int>(options.face) / 2;
  const double sign = static_cast<int>(options.face) % 2 == 0 ? 1 : -1;
  std::vector<Index> order(static_cast<std::size_t>(data.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    const double at_a = sign * data.positions()(a, axis), at_b = sign * data.positions()(b, axis);
    return at_a != at_b ? at_a < at_b : a < b;
  });
  return detail::split_rows(data, std::move(order), tests);
}

/// The last rows of the file held out: judges drift and habit. Row order is taken as time.
/// @throws std::invalid_argument for fewer than 2 rows or a fraction outside (0, 1)
template <int N>
Split<N> split_time(const Dataset<N>& data, double test_fraction = 0.2) {
  const Index tests = detail::test_rows("split_time", data.size(), test_fraction);
  std::vector<Index> order(static_cast<std::size_t>(data.size()));
  std::iota(order.rbegin(), order.rend(), Index{0});
  return detail::split_rows(data, std::move(order), tests);
}

}  // namespace vernier
