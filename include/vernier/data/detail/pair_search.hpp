// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Search for the pairs of poses and points that fit an arm.

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vernier/data/detail/point_alignment.hpp"
#include "vernier/data/pairing.hpp"

namespace vernier::detail {

inline constexpr std::size_t min_pairs = 6;  ///< that determine the frames with something left to check

/// Search for the pairs of poses and points of an arm whose frames are unknown; `by_order` the pairs are unknown as
/// well.
struct PairSearch {
  std::span<const Isometry3> flanges;
  PointRows points;
  bool by_order;
  std::vector<PointPair> given;  ///< pairs by name

  /// Pairs that fit, and the frames that they determine.
  struct Found {
    PointFrames frames;
    PointRows nominal{};  ///< points of the nominal arm
    std::vector<PointPair> pairs{};
    double median = 0, limit = 0;
  };

  Index rows() const { return static_cast<Index>(flanges.size()); }
  std::size_t most_pairs() const {
    return by_order ? static_cast<std::size_t>((std::min)(rows(), points.rows())) : given.size();
  }
  /// From a point to where the nominal arm was in a row [m].
  VERNIER_API double distance(const Found& found, Index row, Index measured) const;

  /// With the points of the nominal arm.
  VERNIER_API void set_frames(Found& found, const PointFrames& frames) const;

  /// Largest shift of a point against its pose at the beginning of a search.
  Index reach() const { return std::max<Index>(20, std::abs(rows() - points.rows()) + 10); }

  /// Frames from short runs of poses and points, by ascending residuals.
  VERNIER_API std::vector<PointFrames> starts() const;

  /// How many poses have a point nearby.
  VERNIER_API Index support(const Found& found, double limit) const;

  /// Pairs that are nearer than a limit.
  VERNIER_API std::vector<PointPair> aligned(const Found& found, double limit) const;

  /// Aligns and registers in turn: with a wide limit until no pairs are added, then with that of the residuals.
  VERNIER_API void settle(Found& found, double widest) const;

  /// The frames that explain most.
  VERNIER_API std::optional<Found> best() const;

  /// Whether some other order fits all points as well, e.g. along a straight line of equal steps.
  VERNIER_API bool ambiguous(const Found& found) const;

  /// Of the measured lengths against those of the nominal arm.
  VERNIER_API double scale(const Found& found) const;
};

/// The outcome of a search, with the units and handedness under which it succeeds.
VERNIER_API std::pair<PairingProof, std::optional<PairSearch::Found>> prove(const PairSearch& search);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/data/detail/pair_search.ipp"
#endif
