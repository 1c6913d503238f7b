// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// In which order to visit configurations: a short path through all of them.

#include <vector>

#include "vernier/core/fit_options.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A short open path through configurations. From one to the next takes `max_j |dq_j| / v_j`: the joints move at once,
/// and the slowest decides. Nearest neighbours first, then segments are reversed (2-opt) or moved (or-opt) while that
/// shortens the path.
/// @param joints n x joints [rad, m]
/// @param speeds of the joints [rad/s, m/s], in any common proportion; empty: equal
/// @param fixed  number of rows that stay first, in their order; the path starts at the last of them, or at row 0
/// @param observer told after each sweep; a stop leaves the path as short as it is then
/// @return the rows in the order of their visits
/// @throws std::invalid_argument for values that are not finite, or speeds that are not positive
/// @complexity O(n^2) a sweep over the path
/// @cite Croes 1958 (2-opt); Or 1976
VERNIER_API std::vector<Index> visiting_order(const ConstMatrixRef& joints, const VectorX& speeds = VectorX(),
                                              Index fixed = 1, const ObserverRef& observer = {});

/// Time of a path, see `visiting_order`.
VERNIER_API double path_time(const ConstMatrixRef& joints, const std::vector<Index>& order,
                             const VectorX& speeds = VectorX());

/// The order with its first visit repeated after every `every` visits and at the end: what changes from one of these to
/// the next is drift or a lack of repeatability, and not the arm's model.
/// @throws std::invalid_argument unless `every` is at least 1
VERNIER_API std::vector<Index> with_check_visits(const std::vector<Index>& order, Index every = 20);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/planning/visiting_order.ipp"
#endif
