// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/detail/pairing_faults.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace vernier::detail {

VERNIER_IMPL FaultSearch::FaultSearch(const PairSearch& search, const PairSearch::Found& found)
    : search_(search),
      found_(found),
      point_of_(static_cast<std::size_t>(search.rows()), -1),
      row_of_(static_cast<std::size_t>(search.points.rows()), -1) {
  for (const PointPair& pair : found.pairs) join(pair);
  if (!search.by_order) {  // points that no pose names are no matter here
    named_.assign(row_of_.size(), false);
    for (const PointPair& pair : search.given) named_[static_cast<std::size_t>(pair.point)] = true;
  }
  find_moved();
}

VERNIER_IMPL std::vector<PointPair> FaultSearch::pairs() const {
  std::vector<PointPair> out;
  for (std::size_t i = 0; i < point_of_.size(); ++i)
    if (point_of_[i] >= 0) out.push_back({static_cast<Index>(i), point_of_[i]});
  return out;
}

VERNIER_IMPL std::vector<PairingFault> FaultSearch::faults() const {
  std::vector<PairingFault> out;
  add_moved(out);
  if (search_.by_order) {
    PointPair before{-1, -1};
    std::vector<PointPair> ends = found_.pairs;
    ends.push_back({search_.rows(), search_.points.rows()});
    for (const PointPair& after : ends) {
      add_gap(before, after, out);
      before = after;
    }
  } else {
    for (const PointPair& pair : search_.given)
      if (point_of(pair.row) < 0 && row_of(pair.point) < 0) add_misfit(pair, out);
  }
  return out;
}

VERNIER_IMPL Index FaultSearch::point_of(Index row) const { return point_of_[static_cast<std::size_t>(row)]; }

VERNIER_IMPL Index FaultSearch::row_of(Index point) const { return row_of_[static_cast<std::size_t>(point)]; }

VERNIER_IMPL void FaultSearch::join(const PointPair& pair) {
  point_of_[static_cast<std::size_t>(pair.row)] = pair.point;
  row_of_[static_cast<std::size_t>(pair.point)] = pair.row;
}

VERNIER_IMPL bool FaultSearch::is_near(Index row, Index point) const {
  return search_.distance(found_, row, point) <= found_.limit;
}

VERNIER_IMPL void FaultSearch::find_moved() {
  std::vector<std::pair<double, PointPair>> close;
  for (Index i = 0; i < search_.rows(); ++i)
    for (Index j = 0; point_of(i) < 0 && j < search_.points.rows(); ++j)
      if (row_of(j) < 0 && (named_.empty() || named_[static_cast<std::size_t>(j)]) && is_near(i, j))
        close.push_back({search_.distance(found_, i, j), {i, j}});
  std::sort(close.begin(), close.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.first, a.second.row, a.second.point) < std::tuple(b.first, b.second.row, b.second.point);
  });
  for (const auto& [distance, pair] : close)
    if (point_of(pair.row) < 0 && row_of(pair.point) < 0) {
      join(pair);
      moved_.push_back(pair);
    }
}

VERNIER_IMPL void FaultSearch::add_moved(std::vector<PairingFault>& out) const {
  const std::vector<PointPair> all = pairs();
  std::vector<Index> points,
      place(point_of_.size(), -1);  // place of a row's point: the row that has it by order or name
  for (const PointPair& pair : all) points.push_back(pair.point);
  std::sort(points.begin(), points.end());
  if (search_.by_order) {
    for (std::size_t k = 0; k < all.size(); ++k) place[static_cast<std::size_t>(row_of(points[k]))] = all[k].row;
  } else {
    std::map<Index, Index> owner;
    for (const PointPair& pair : search_.given) owner[pair.point] = pair.row;
    for (const PointPair& pair : all) place[static_cast<std::size_t>(pair.row)] = owner.at(pair.point);
  }
  std::vector<Index> told;
  for (const PointPair& pair : moved_) {
    if (std::find(told.begin(), told.end(), pair.row) != told.end()) continue;
    const Index other = place[static_cast<std::size_t>(pair.row)];
    const bool swapped = other != pair.row && place[static_cast<std::size_t>(other)] == pair.row;
    if (swapped) {
      const Index first = (std::min)(pair.row, other), last = (std::max)(pair.row, other);
      out.push_back({PairingFault::Kind::swapped, {first, last}, {point_of(first), point_of(last)}, 2});
      told.push_back(other);
    } else {
      out.push_back({PairingFault::Kind::out_of_order, {pair.row, pair.row}, {pair.point, pair.point}, 1});
    }
  }
}

VERNIER_IMPL void FaultSearch::add_misfit(const PointPair& pair, std::vector<PairingFault>& out) const {
  out.push_back({PairingFault::Kind::misfit,
                 {pair.row, pair.row},
                 {pair.point, pair.point},
                 1,
                 search_.distance(found_, pair.row, pair.point)});
}

VERNIER_IMPL void FaultSearch::add_gap(const PointPair& before, const PointPair& after,
                                       std::vector<PairingFault>& out) const {
  std::vector<Index> rows, points;
  for (Index i = before.row + 1; i < after.row; ++i)
    if (point_of(i) < 0) rows.push_back(i);
  for (Index j = before.point + 1; j < after.point; ++j)
    if (row_of(j) < 0) points.push_back(j);
  if (rows.size() == points.size()) {
    for (std::size_t k = 0; k < rows.size(); ++k) add_misfit({rows[k], points[k]}, out);
    return;
  }
  const auto runs = [](const std::vector<Index>& values, auto&& use) {
    for (std::size_t begin = 0, end = 0; begin < values.size(); begin = end) {
      for (end = begin + 1; end < values.size() && values[end] == values[end - 1] + 1;) ++end;
      use(IndexRange{values[begin], values[end - 1]});
    }
  };
  runs(rows, [&](const IndexRange& run) {
    IndexRange reach = run;  // as far as the gap could be moved
    for (Index k = 1; fits_at(run.first - k, run.last - k + 1, true); ++k) reach.first = run.first - k;
    for (Index k = 1; fits_at(run.last + k, run.first + k - 1, true); ++k) reach.last = run.last + k;
    out.push_back({PairingFault::Kind::missing, reach, {before.point, after.point}, run.size()});
  });
  runs(points, [&](const IndexRange& run) {
    IndexRange reach = run;
    for (Index k = 1; fits_at(run.first - k, run.last - k + 1, false); ++k) reach.first = run.first - k;
    for (Index k = 1; fits_at(run.last + k, run.first + k - 1, false); ++k) reach.last = run.last + k;
    out.push_back({PairingFault::Kind::additional, {before.row, after.row}, reach, run.size()});
  });
}

VERNIER_IMPL bool FaultSearch::fits_at(Index from, Index to, bool rows) const {
  const auto end = rows ? search_.rows() : search_.points.rows();
  if (from < 0 || from >= end || to < 0 || to >= end) return false;
  const Index partner = rows ? point_of(from) : row_of(from);
  return partner >= 0 && (rows ? is_near(to, partner) : is_near(partner, to));
}

}  // namespace vernier::detail
