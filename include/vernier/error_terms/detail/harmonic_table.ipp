// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/simd.hpp"
#include "vernier/error_terms/detail/harmonic_table.hpp"

namespace vernier::detail {

inline constexpr int harmonic_lanes = 8;

VERNIER_IMPL HarmonicTable::HarmonicTable(const std::vector<Fourier>& joints, std::span<const double> coefficients) {
  for (const Fourier& joint : joints) orders_.insert(orders_.end(), joint.orders.begin(), joint.orders.end());
  std::sort(orders_.begin(), orders_.end());
  orders_.erase(std::unique(orders_.begin(), orders_.end()), orders_.end());
  const std::size_t groups = (joints.size() + harmonic_lanes - 1) / harmonic_lanes;
  table_.assign(groups * orders_.size() * 2 * harmonic_lanes, 0.0);
  std::size_t from = 0;
  for (std::size_t j = 0; j < joints.size(); ++j)
    for (const int order : joints[j].orders) {
      const auto row =
          static_cast<std::size_t>(std::lower_bound(orders_.begin(), orders_.end(), order) - orders_.begin());
      double* to = table_.data() + (j / harmonic_lanes * orders_.size() + row) * 2 * harmonic_lanes;
      to[j % harmonic_lanes] = coefficients[from++];
      to[harmonic_lanes + j % harmonic_lanes] = coefficients[from++];
    }
}

/// Rotations of as many angles as there are lanes.
template <int W>
struct Rotations {
  static constexpr int vectors = harmonic_lanes / W;
  using Double = typename Simd<W>::Double;
  Double c[vectors], s[vectors];

  /// Turns these on by others.
  VERNIER_INLINE void turn(const Rotations& by) {
    VERNIER_UNROLL
    for (int v = 0; v < vectors; ++v) {
      const Double next = c[v] * by.c[v] - s[v] * by.s[v];
      s[v] = c[v] * by.s[v] + s[v] * by.c[v];
      c[v] = next;
    }
  }
};

/// Sums of one order.
template <int W>
VERNIER_INLINE void add_order(const Rotations<W>& at, double order, const double* coefficients, Rotations<W>& sums) {
  using Double = typename Simd<W>::Double;
  VERNIER_UNROLL
  for (int v = 0; v < Rotations<W>::vectors; ++v) {
    Double a, b;
    load<W>(a, coefficients + v * W);
    load<W>(b, coefficients + harmonic_lanes + v * W);
    sums.c[v] += a * at.c[v] + b * at.s[v];
    sums.s[v] += order * (b * at.c[v] - a * at.s[v]);
  }
}

VERNIER_IMPL void HarmonicTable::add(const double* q, int n, double* effective, double* derivative) const noexcept {
  const auto count = static_cast<int>(orders_.size());
  if (count == 0) return;
  const int* orders = orders_.data();
  const double* table = table_.data();
  for (int first = 0; first < n; first += harmonic_lanes, table += count * 2 * harmonic_lanes) {
    const int lanes = (std::min)(harmonic_lanes, n - first);
    double cosines[harmonic_lanes] = {}, sines[harmonic_lanes] = {};
    double values[harmonic_lanes], slopes[harmonic_lanes];
    for (int j = 0; j < lanes; ++j) {
      cosines[j] = std::cos(q[first + j]);
      sines[j] = std::sin(q[first + j]);
    }
    run_widest([&]<int W>() VERNIER_INLINED {
      constexpr int chains = 4;  // orders k .. k + 3 at once: a rotation waits for the one before it
      Rotations<W> one, four, sums{}, at[chains], now;
      for (int v = 0; v < Rotations<W>::vectors; ++v) {
        load<W>(one.c[v], cosines + v * W);
        load<W>(one.s[v], sines + v * W);
        now.c[v] = typename Simd<W>::Double{} + 1.0;
        now.s[v] = typename Simd<W>::Double{};
      }
      four = one;
      four.turn(one);
      const Rotations<W> two = four;
      four.turn(two);
      int order = 0;
      for (int k = 0; k < count;) {
        Rotations<W> power = one;  // of the gap before the next order
        for (int gap = orders[k] - order; gap > 0; gap >>= 1) {
          if (gap & 1) now.turn(power);
          const Rotations<W> base = power;
          power.turn(base);
        }
        order = orders[k];
        int run = 1;  // orders without gap
        while (k + run < count && orders[k + run] == order + run) ++run;
        if (run >= chains) {
          at[0] = now;
          for (int i = 1; i < chains; ++i) {
            at[i] = at[i - 1];
            at[i].turn(one);
          }
          for (;; run -= chains) {
            VERNIER_UNROLL
            for (int i = 0; i < chains; ++i) {
              add_order<W>(at[i], order + i, table + (k + i) * 2 * harmonic_lanes, sums);
              now = at[i];
              at[i].turn(four);
            }
            k += chains;
            order += chains;
            if (run < 2 * chains) break;
          }
          --order;  // where `now` is
        } else {
          add_order<W>(now, order, table + k * 2 * harmonic_lanes, sums);
          ++k;
        }
      }
      for (int v = 0; v < Rotations<W>::vectors; ++v) {
        store<W>(values + v * W, sums.c[v]);
        store<W>(slopes + v * W, sums.s[v]);
      }
    });
    for (int j = 0; j < lanes; ++j) {
      effective[first + j] += values[j];
      derivative[(first + j) * n + first + j] += slopes[j];
    }
  }
}

}  // namespace vernier::detail
