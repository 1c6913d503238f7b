// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/detail/pair_search.hpp"

#include <cmath>

#include "vernier/core/same_value.hpp"

namespace vernier::detail {

/// The median, by choice the upper one.
VERNIER_LOCAL double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median distance from the point of median coordinates.
VERNIER_LOCAL double median_spread(const PointRows& points) {
  Vector3 centre;
  for (int k = 0; k < 3; ++k) centre(k) = middle_of({points.col(k).begin(), points.col(k).end()});
  const VectorX distances = distances_from(points, centre);
  return middle_of({distances.begin(), distances.end()});
}

VERNIER_IMPL double PairSearch::distance(const Found& found, Index row, Index measured) const {
  return (point(found.nominal, row) - point(points, measured)).norm();
}

VERNIER_IMPL void PairSearch::set_frames(Found& found, const PointFrames& frames) const {
  found.frames = frames;
  found.nominal.resize(rows(), 3);
  for (Index i = 0; i < rows(); ++i) set_point(found.nominal, i, frames.point(flanges[static_cast<std::size_t>(i)]));
}

VERNIER_IMPL std::vector<PointFrames> PairSearch::starts() const {
  constexpr std::size_t max_runs = 24, kept = 40;
  const std::size_t n = most_pairs();
  std::vector<PointFrames> out;
  std::vector<PointPair> run;
  for (const std::size_t length :
       {std::clamp(n / 3, min_pairs, std::size_t{12}), std::clamp(n / 2, min_pairs, std::size_t{60})}) {
    const std::size_t last = (by_order ? flanges.size() : n) - length, count = (std::min)(last + 1, max_runs);
    for (std::size_t r = 0; r < count; ++r) {
      const std::size_t first = count == 1 ? 0 : r * last / (count - 1);
      for (Index shift = by_order ? -reach() : 0; shift <= (by_order ? reach() : 0); ++shift) {
        run.clear();
        for (std::size_t k = first; k < first + length; ++k)
          run.push_back(by_order ? PointPair{static_cast<Index>(k), static_cast<Index>(k) + shift} : given[k]);
        if (run.front().point < 0 || run.back().point >= points.rows()) continue;
        out.push_back(fit_point_frames(flanges, points, run, 5));
      }
    }
  }
  std::erase_if(out, [](const PointFrames& one) { return !std::isfinite(one.rms); });
  std::sort(out.begin(), out.end(), [](const PointFrames& a, const PointFrames& b) { return a.rms < b.rms; });
  if (out.size() > kept) out.resize(kept);
  return out;
}

VERNIER_IMPL Index PairSearch::support(const Found& found, double limit) const {
  Index out = 0;
  if (!by_order) {
    for (const PointPair& pair : given) out += distance(found, pair.row, pair.point) <= limit;
    return out;
  }
  for (Index i = 0; i < rows(); ++i)
    for (Index j = std::max<Index>(0, i - reach()); j <= (std::min)(points.rows() - 1, i + reach()); ++j)
      if (distance(found, i, j) <= limit) {
        ++out;
        break;
      }
  return out;
}

VERNIER_IMPL std::vector<PointPair> PairSearch::aligned(const Found& found, double limit) const {
  if (by_order)
    return align_with_gaps(rows(), points.rows(), [&](Index i, Index j) {
      return (point(found.nominal, i) - point(points, j)).squaredNorm() / (limit * limit);
    });
  std::vector<PointPair> out;
  for (const PointPair& pair : given)
    if (distance(found, pair.row, pair.point) < limit) out.push_back(pair);
  return out;
}

VERNIER_IMPL void PairSearch::settle(Found& found, double widest) const {
  constexpr double smallest = 1e-4;  // a tracker's own errors
  constexpr int max_rounds = 20;
  found.limit = widest;
  found.pairs = aligned(found, widest);
  bool wide = true;
  for (int round = 0; round < max_rounds && found.pairs.size() >= min_pairs; ++round) {
    set_frames(found, fit_point_frames(flanges, points, found.pairs));
    std::vector<double> distances;
    for (const PointPair& pair : found.pairs) distances.push_back(distance(found, pair.row, pair.point));
    std::sort(distances.begin(), distances.end());
    const std::size_t n = distances.size();
    found.median = distances[n / 2];
    // what the fit has made of nine unknowns is missing in few residuals
    const double typical = distances[9 * n / 10] * std::sqrt(static_cast<double>(n) / static_cast<double>(n - 3));
    const double limit = wide ? widest : std::clamp((std::min)(3 * typical, 6 * found.median), smallest, 2 * widest);
    std::vector<PointPair> pairs = aligned(found, limit);
    const bool grown = pairs.size() > found.pairs.size(), same = pairs == found.pairs && same_value(limit, found.limit);
    found.limit = limit;
    found.pairs = std::move(pairs);
    if (same && !wide) break;
    wide = wide && grown;
  }
}

VERNIER_IMPL std::optional<PairSearch::Found> PairSearch::best() const {
  constexpr std::size_t settled = 8;
  const double spread = median_spread(points), widest = 0.05 * spread;
  if (!(spread > 0)) return {};
  std::vector<std::pair<Index, std::size_t>> order;
  const std::vector<PointFrames> candidates = starts();
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    Found one;
    set_frames(one, candidates[k]);
    order.emplace_back(-support(one, widest), k);
  }
  std::sort(order.begin(), order.end());
  std::optional<Found> out;
  for (std::size_t k = 0; k < (std::min)(order.size(), settled); ++k) {
    Found one;
    set_frames(one, candidates[order[k].second]);
    settle(one, widest);
    const bool enough = one.pairs.size() >= min_pairs && 10 * one.pairs.size() >= 6 * most_pairs();
    if (enough && one.median <= 0.02 * spread && (!out || one.pairs.size() > out->pairs.size())) out = std::move(one);
    if (out && 10 * out->pairs.size() >= 9 * most_pairs()) break;
  }
  return out;
}

VERNIER_IMPL bool PairSearch::ambiguous(const Found& found) const {
  const auto n = static_cast<Index>(found.pairs.size());
  for (const Index shift : {-3, -2, -1, 1, 2, 3}) {
    std::vector<PointPair> shifted;
    for (Index k = std::max<Index>(0, -shift); k < (std::min)(n, n - shift); ++k)
      shifted.push_back(
          {found.pairs[static_cast<std::size_t>(k)].row, found.pairs[static_cast<std::size_t>(k + shift)].point});
    if (shifted.size() < min_pairs) continue;
    Found other;
    set_frames(other, fit_point_frames(flanges, points, shifted));
    Index outside = 0;
    for (const PointPair& pair : shifted) outside += distance(other, pair.row, pair.point) > found.limit;
    if (outside <= 1) return true;
  }
  return false;
}

VERNIER_IMPL double PairSearch::scale(const Found& found) const {
  Vector3 nominal_mean = Vector3::Zero(), mean = Vector3::Zero();
  for (const PointPair& pair : found.pairs) {
    nominal_mean += point(found.nominal, pair.row) / static_cast<double>(found.pairs.size());
    mean += point(points, pair.point) / static_cast<double>(found.pairs.size());
  }
  double product = 0, square = 0;
  for (const PointPair& pair : found.pairs) {
    const Vector3 nominal = point(found.nominal, pair.row) - nominal_mean, arm = point(points, pair.point) - mean;
    product += nominal.dot(arm);
    square += nominal.squaredNorm();
  }
  return product / square;
}

VERNIER_IMPL std::pair<PairingProof, std::optional<PairSearch::Found>> prove(const PairSearch& search) {
  PairingProof proof;
  if (search.most_pairs() < min_pairs) return {proof, {}};
  PointRows positions(search.rows(), 3);
  for (Index i = 0; i < search.rows(); ++i)
    set_point(positions, i, translation(search.flanges[static_cast<std::size_t>(i)]));
  proof.spread_ratio = median_spread(search.points) / median_spread(positions);
  proof.status = PairingStatus::unrelated;
  std::vector<double> factors{1};
  for (const double unit : {1e3, 25.4, 1 / 0.0254, 10.0, 100.0, 304.8, 1e6})
    for (const double factor : {unit, 1 / unit}) factors.push_back(factor);
  // the reflector's offset, too, spreads points
  std::erase_if(factors,
                [&](double factor) { return !(std::abs(std::log(proof.spread_ratio / factor)) < std::log(3)); });
  for (const double factor : factors)
    for (const double sign : {1.0, -1.0}) {
      PairSearch changed = search;
      for (Index i = 0; i < changed.points.rows(); ++i) {
        set_point(changed.points, i, point(changed.points, i) / factor);
        changed.points(i, 0) *= sign;
      }
      auto found = changed.best();
      if (!found) continue;
      proof.base = found->frames.base;
      proof.offset = found->frames.offset;
      proof.median = found->median;
      proof.limit = found->limit;
      proof.scale = factor * changed.scale(*found);
      for (Index i = 1; i < search.rows(); ++i)
        proof.indistinct += (point(found->nominal, i) - point(found->nominal, i - 1)).norm() <= found->limit;
      proof.status = !same_value(factor, 1)                         ? PairingStatus::wrong_unit
                     : sign < 0                                     ? PairingStatus::mirrored
                     : search.by_order && changed.ambiguous(*found) ? PairingStatus::ambiguous
                                                                    : PairingStatus::proven;
      return {proof, std::move(found)};
    }
  return {proof, {}};
}

}  // namespace vernier::detail
