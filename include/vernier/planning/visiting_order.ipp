// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/planning/visiting_order.hpp"

namespace vernier {

namespace detail {

/// Times from every configuration to every other.
VERNIER_LOCAL MatrixX travel_times(const ConstMatrixRef& joints, const VectorX& speeds) {
  demand(all_finite(joints), "visiting_order: a joint value is not finite");
  demand(speeds.size() == 0 || speeds.size() == joints.cols(), "visiting_order: ", speeds.size(), " speeds of ",
         joints.cols(), " joints");
  demand(speeds.size() == 0 || (all_finite(speeds) && VERNIER_LATER(speeds).minCoeff() > 0),
         "visiting_order: a speed is not positive");
  MatrixX scaled = VERNIER_LATER(joints).transpose();
  for (Index k = 0; k < speeds.size(); ++k)
    for (Index i = 0; i < scaled.cols(); ++i) scaled(k, i) *= 1 / speeds(k);
  const Index n = joints.rows();
  MatrixX out = MatrixX::Zero(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j) {
      double slowest = 0;  // of the joints
      for (Index k = 0; k < scaled.rows(); ++k) slowest = (std::max)(slowest, std::abs(scaled(k, i) - scaled(k, j)));
      out(i, j) = out(j, i) = slowest;
    }
  return out;
}

/// An open path whose first visits stay, and what makes it shorter.
class OpenPath {
 public:
  VERNIER_LOCAL OpenPath(const MatrixX& times, std::vector<Index> order, Index fixed)
      : times_(times), order_(std::move(order)), fixed_(fixed) {}

  const std::vector<Index>& order() const { return order_; }

  /// Reverses stretches where that is shorter.
  VERNIER_LOCAL bool reverse_stretches() {
    bool any = false;
    const Index n = size();
    for (Index i = fixed_; i + 1 < n; ++i)
      for (Index j = i + 1; j < n; ++j) {
        const double before = time(i - 1, i) + time(j, j + 1), after = time(i - 1, j) + time(i, j + 1);
        if (!(after < before - tiny)) continue;
        std::reverse(order_.begin() + i, order_.begin() + j + 1);
        any = true;
      }
    return any;
  }
  /// Moves one to three visits elsewhere where that is shorter.
  VERNIER_LOCAL bool move_stretches() {
    bool any = false;
    const Index n = size();
    for (Index length = 1; length <= 3; ++length)
      for (Index i = fixed_; i + length <= n; ++i)
        for (Index j = fixed_ - 1; j < n; ++j) {  // between j and j + 1
          const Index last = i + length - 1;
          if (j >= i - 1 && j <= last) continue;
          const double removed = time(i - 1, i) + time(last, last + 1) - time(i - 1, last + 1);
          const double added =
              (std::min)(time(j, i) + time(last, j + 1), time(j, last) + time(i, j + 1)) - time(j, j + 1);
          if (!(added < removed - tiny)) continue;
          if (time(j, last) + time(i, j + 1) < time(j, i) + time(last, j + 1))
            std::reverse(order_.begin() + i, order_.begin() + last + 1);
          if (j > last)
            std::rotate(order_.begin() + i, order_.begin() + last + 1, order_.begin() + j + 1);
          else
            std::rotate(order_.begin() + j + 1, order_.begin() + i, order_.begin() + last + 1);
          any = true;
          break;
        }
    return any;
  }

 private:
  static constexpr double tiny = 1e-12;  // ties would turn in circles
  Index size() const { return static_cast<Index>(order_.size()); }
  /// From visit i to visit j; nothing leads on from the last.
  double time(Index i, Index j) const {
    return j >= size() ? 0 : times_(order_[static_cast<std::size_t>(i)], order_[static_cast<std::size_t>(j)]);
  }

  const MatrixX& times_;
  std::vector<Index> order_;
  Index fixed_;
};

}  // namespace detail

VERNIER_IMPL std::vector<Index> visiting_order(const ConstMatrixRef& joints, const VectorX& speeds, Index fixed,
                                               const ObserverRef& observer) {
  const Index n = joints.rows();
  demand(fixed >= 0 && fixed <= std::max<Index>(n, 1), "visiting_order: ", fixed, " of ", n, " rows are to stay first");
  if (n == 0) return {};
  const MatrixX times = detail::travel_times(joints, speeds);
  fixed = std::max<Index>(fixed, 1);
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  for (Index i = fixed; i < n; ++i) {
    const auto here = order.begin() + i;
    const Index from = *(here - 1);
    std::iter_swap(here, std::min_element(here, order.end(), [&](Index a, Index b) {
                     return times(from, a) < times(from, b) || (same_value(times(from, a), times(from, b)) && a < b);
                   }));
  }
  detail::OpenPath path(times, std::move(order), fixed);
  constexpr int max_sweeps = 100;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    const bool reversed = path.reverse_stretches(), moved = path.move_stretches();
    if ((!reversed && !moved) || !observer({sweep + 1, 0, 0})) break;
  }
  return path.order();
}

VERNIER_IMPL double path_time(const ConstMatrixRef& joints, const std::vector<Index>& order, const VectorX& speeds) {
  const MatrixX times = detail::travel_times(joints, speeds);
  double sum = 0;
  for (std::size_t i = 1; i < order.size(); ++i) sum += times(order[i - 1], order[i]);
  return sum;
}

VERNIER_IMPL std::vector<Index> with_check_visits(const std::vector<Index>& order, Index every) {
  demand(every >= 1, "with_check_visits: every is ", every, ", must be at least 1");
  std::vector<Index> out;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && i % static_cast<std::size_t>(every) == 0) out.push_back(order.front());
    out.push_back(order[i]);
  }
  if (order.size() > 1) out.push_back(order.front());
  return out;
}

}  // namespace vernier
