// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What is wrong with the poses and points that are in no pair.

#include <vector>

#include "vernier/data/detail/pair_search.hpp"

namespace vernier::detail {

/// Search for faults among the poses and points that are in no pair; it finds the pairs in other places, too.
class FaultSearch {
 public:
  /// Keeps references to both.
  VERNIER_API FaultSearch(const PairSearch& search, const PairSearch::Found& found);

  /// All pairs, those in other places among them, in ascending rows.
  VERNIER_API std::vector<PointPair> pairs() const;

  /// All faults.
  VERNIER_API std::vector<PairingFault> faults() const;

 private:
  /// Partner of a row; -1 without one.
  VERNIER_API Index point_of(Index row) const;
  /// Partner of a point; -1 without one.
  VERNIER_API Index row_of(Index point) const;
  VERNIER_API void join(const PointPair& pair);
  VERNIER_API bool is_near(Index row, Index point) const;

  /// Joins rows and points that fit but are in other places, the nearest first.
  VERNIER_API void find_moved();

  /// Two moved points that would be in their places if they were exchanged, else single ones.
  VERNIER_API void add_moved(std::vector<PairingFault>& out) const;

  VERNIER_API void add_misfit(const PointPair& pair, std::vector<PairingFault>& out) const;

  /// What is left between two pairs in order.
  VERNIER_API void add_gap(const PointPair& before, const PointPair& after, std::vector<PairingFault>& out) const;

  /// Whether the partner of a row (or point) would fit another one as well.
  VERNIER_API bool fits_at(Index from, Index to, bool rows) const;

  const PairSearch& search_;
  const PairSearch::Found& found_;
  std::vector<Index> point_of_, row_of_;
  std::vector<bool> named_;
  std::vector<PointPair> moved_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/data/detail/pairing_faults.ipp"
#endif
