#pragma once

#include "vernier/data/pair_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/data/detail/point_alignment.hpp"
#include "vernier/data/detail/text_lines.hpp"

namespace vernier {

namespace detail {

constexpr std::size_t min_pairs = 6;

/// Index of every name.
/// @throws DataError where one is there twice
VERNIER_API std::map<std::string, Index> unique_names(const std::vector<std::string>& names,
                                                      const std::vector<Index>& lines, const std::string& file,
                                                      const std::string& column) {
  std::map<std::string, Index> out;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (const auto [known, added] = out.emplace(names[i], static_cast<Index>(i)); !added)
      throw DataError(message(file, ", line ", lines[i], ", column ", column, ": '", printable(names[i]),
                              "' is in line ", lines[static_cast<std::size_t>(known->second)], " already"));
  return out;
}

/// The median, by choice the upper one.
VERNIER_API double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median distance from the point of median coordinates.
VERNIER_API double median_spread(const PointRows& points) {
  Vector3 centre;
  for (int k = 0; k < 3; ++k) centre(k) = middle_of({points.col(k).begin(), points.col(k).end()});
  const VectorX distances = (points.rowwise() - centre.transpose()).rowwise().norm();
  return middle_of({distances.begin(), distances.end()});
}

/// Search for pairs of poses and points, of which neither frames nor order, or the frames alone, are unknown.
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

  VERNIER_API Index rows() const { return static_cast<Index>(flanges.size()); }
  VERNIER_API std::size_t most_pairs() const {
    return by_order ? static_cast<std::size_t>(std::min(rows(), points.rows())) : given.size();
  }
  VERNIER_API double distance(const Found& found, Index row, Index point) const {
    return (found.nominal.row(row) - points.row(point)).norm();
  }

  VERNIER_API void set_frames(Found& found, const PointFrames& frames) const {
    found.frames = frames;
    found.nominal.resize(rows(), 3);
    for (Index i = 0; i < rows(); ++i)
      found.nominal.row(i) = frames.point(flanges[static_cast<std::size_t>(i)]).transpose();
  }

  /// Largest shift of a point against its pose at the beginning of a search.
  VERNIER_API Index reach() const { return std::max<Index>(20, std::abs(rows() - points.rows()) + 10); }

  /// Frames from short runs of poses and points, by ascending residuals.
  VERNIER_API std::vector<PointFrames> starts() const {
    constexpr std::size_t max_runs = 24, kept = 40;
    const std::size_t n = most_pairs();
    std::vector<PointFrames> out;
    std::vector<PointPair> run;
    for (const std::size_t length :
         {std::clamp(n / 3, min_pairs, std::size_t{12}), std::clamp(n / 2, min_pairs, std::size_t{60})}) {
      const std::size_t last = (by_order ? flanges.size() : n) - length, count = std::min(last + 1, max_runs);
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

  /// How many poses have a point nearby.
  VERNIER_API Index support(const Found& found, double limit) const {
    Index out = 0;
    if (!by_order) {
      for (const PointPair& pair : given) out += distance(found, pair.row, pair.point) <= limit;
      return out;
    }
    for (Index i = 0; i < rows(); ++i)
      for (Index j = std::max<Index>(0, i - reach()); j <= std::min(points.rows() - 1, i + reach()); ++j)
        if (distance(found, i, j) <= limit) {
          ++out;
          break;
        }
    return out;
  }

  VERNIER_API std::vector<PointPair> aligned(const Found& found, double limit) const {
    if (by_order)
      return align_with_gaps(rows(), points.rows(), [&](Index i, Index j) {
        return (found.nominal.row(i) - points.row(j)).squaredNorm() / (limit * limit);
      });
    std::vector<PointPair> out;
    for (const PointPair& pair : given)
      if (distance(found, pair.row, pair.point) < limit) out.push_back(pair);
    return out;
  }

  /// Aligns and registers in turn: with a wide limit until no pairs are added, then with that of the residuals.
  VERNIER_API void settle(Found& found, double widest) const {
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
      const double limit = wide ? widest : std::clamp(std::min(3 * typical, 6 * found.median), smallest, 2 * widest);
      std::vector<PointPair> pairs = aligned(found, limit);
      const bool grown = pairs.size() > found.pairs.size(), same = pairs == found.pairs && limit == found.limit;
      found.limit = limit;
      found.pairs = std::move(pairs);
      if (same && !wide) break;
      wide = wide && grown;
    }
  }

  /// The frames that explain most.
  VERNIER_API std::optional<Found> best() const {
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
    for (std::size_t k = 0; k < std::min(order.size(), settled); ++k) {
      Found one;
      set_frames(one, candidates[order[k].second]);
      settle(one, widest);
      const bool enough = one.pairs.size() >= min_pairs && 10 * one.pairs.size() >= 6 * most_pairs();
      if (enough && one.median <= 0.02 * spread && (!out || one.pairs.size() > out->pairs.size())) out = std::move(one);
      if (out && 10 * out->pairs.size() >= 9 * most_pairs()) break;
    }
    return out;
  }

  /// Whether some other order fits all points as well, e.g. along a straight line of equal steps.
  VERNIER_API bool ambiguous(const Found& found) const {
    const auto n = static_cast<Index>(found.pairs.size());
    for (const Index shift : {-3, -2, -1, 1, 2, 3}) {
      std::vector<PointPair> shifted;
      for (Index k = std::max<Index>(0, -shift); k < std::min(n, n - shift); ++k)
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

  /// Of the measured lengths against those of the nominal arm.
  VERNIER_API double scale(const Found& found) const {
    Vector3 nominal_mean = Vector3::Zero(), mean = Vector3::Zero();
    for (const PointPair& pair : found.pairs) {
      nominal_mean += found.nominal.row(pair.row).transpose() / static_cast<double>(found.pairs.size());
      mean += points.row(pair.point).transpose() / static_cast<double>(found.pairs.size());
    }
    double product = 0, square = 0;
    for (const PointPair& pair : found.pairs) {
      const Vector3 nominal = found.nominal.row(pair.row).transpose() - nominal_mean;
      product += nominal.dot(points.row(pair.point).transpose() - mean);
      square += nominal.squaredNorm();
    }
    return product / square;
  }
};

/// The outcome of a search, with the units and handedness under which it succeeds.
VERNIER_API std::pair<PairingProof, std::optional<PairSearch::Found>> prove(const PairSearch& search) {
  PairingProof proof;
  if (search.most_pairs() < min_pairs) return {proof, {}};
  PointRows positions(search.rows(), 3);
  for (Index i = 0; i < search.rows(); ++i)
    positions.row(i) = search.flanges[static_cast<std::size_t>(i)].translation().transpose();
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
      changed.points /= factor;
      changed.points.col(0) *= sign;
      auto found = changed.best();
      if (!found) continue;
      proof.base = found->frames.base;
      proof.offset = found->frames.offset;
      proof.median = found->median;
      proof.limit = found->limit;
      proof.scale = factor * changed.scale(*found);
      for (Index i = 1; i < search.rows(); ++i)
        proof.indistinct += (found->nominal.row(i) - found->nominal.row(i - 1)).norm() <= found->limit;
      proof.status = factor != 1                                    ? PairingStatus::wrong_unit
                     : sign < 0                                     ? PairingStatus::mirrored
                     : search.by_order && changed.ambiguous(*found) ? PairingStatus::ambiguous
                                                                    : PairingStatus::proven;
      return {proof, std::move(found)};
    }
  return {proof, {}};
}

/// What pairs leave over, with the pairs that are found among it.
class LeftOver {
 public:
  VERNIER_API LeftOver(const PairSearch& search, const PairSearch::Found& found)
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

  VERNIER_API std::vector<PointPair> pairs() const {
    std::vector<PointPair> out;
    for (std::size_t i = 0; i < point_of_.size(); ++i)
      if (point_of_[i] >= 0) out.push_back({static_cast<Index>(i), point_of_[i]});
    return out;
  }

  VERNIER_API std::vector<PairingFault> faults() const {
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

 private:
  VERNIER_API Index point_of(Index row) const { return point_of_[static_cast<std::size_t>(row)]; }
  VERNIER_API Index row_of(Index point) const { return row_of_[static_cast<std::size_t>(point)]; }
  VERNIER_API void join(const PointPair& pair) {
    point_of_[static_cast<std::size_t>(pair.row)] = pair.point;
    row_of_[static_cast<std::size_t>(pair.point)] = pair.row;
  }
  VERNIER_API bool near(Index row, Index point) const { return search_.distance(found_, row, point) <= found_.limit; }

  VERNIER_API void find_moved() {
    std::vector<std::pair<double, PointPair>> close;
    for (Index i = 0; i < search_.rows(); ++i)
      for (Index j = 0; point_of(i) < 0 && j < search_.points.rows(); ++j)
        if (row_of(j) < 0 && (named_.empty() || named_[static_cast<std::size_t>(j)]) && near(i, j))
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

  /// Two moved points that would be in their places if they were exchanged, else single ones.
  VERNIER_API void add_moved(std::vector<PairingFault>& out) const {
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
        const Index first = std::min(pair.row, other), last = std::max(pair.row, other);
        out.push_back({PairingFault::Kind::swapped, {first, last}, {point_of(first), point_of(last)}, 2});
        told.push_back(other);
      } else {
        out.push_back({PairingFault::Kind::out_of_order, {pair.row, pair.row}, {pair.point, pair.point}, 1});
      }
    }
  }

  VERNIER_API void add_misfit(const PointPair& pair, std::vector<PairingFault>& out) const {
    out.push_back({PairingFault::Kind::misfit,
                   {pair.row, pair.row},
                   {pair.point, pair.point},
                   1,
                   search_.distance(found_, pair.row, pair.point)});
  }

  /// What is left between two pairs in order.
  VERNIER_API void add_gap(const PointPair& before, const PointPair& after, std::vector<PairingFault>& out) const {
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

  /// Whether the partner of a row (or point) would fit another one as well.
  VERNIER_API bool fits_at(Index from, Index to, bool rows) const {
    const auto end = rows ? search_.rows() : search_.points.rows();
    if (from < 0 || from >= end || to < 0 || to >= end) return false;
    const Index partner = rows ? point_of(from) : row_of(from);
    return partner >= 0 && (rows ? near(to, partner) : near(partner, to));
  }

  const PairSearch& search_;
  const PairSearch::Found& found_;
  std::vector<Index> point_of_, row_of_;
  std::vector<bool> named_;
  std::vector<PointPair> moved_;
};

VERNIER_API Pairing proven_pairing(const PairSearch& search, std::vector<PairingFault> faults) {
  auto [proof, found] = prove(search);
  if (proof.status != PairingStatus::proven) return {{}, std::move(faults), proof};
  const LeftOver left(search, *found);
  for (const PairingFault& fault : left.faults()) faults.push_back(fault);
  std::sort(faults.begin(), faults.end(), [](const PairingFault& a, const PairingFault& b) {
    return std::tuple(a.rows.first, a.points.first, a.kind) < std::tuple(b.rows.first, b.points.first, b.kind);
  });
  return {left.pairs(), std::move(faults), proof};
}

}  // namespace detail

VERNIER_IMPL Pairing pair_by_name(const CsvText& commanded, const std::string& key, const PointTable& points) {
  const auto column = std::find(commanded.header.begin(), commanded.header.end(), key);
  if (column == commanded.header.end())
    throw DataError(message(commanded.file, ": no column ", detail::printable(key), " in the header"));
  if (points.names.empty()) throw DataError(message(points.file, ": no column name is declared"));
  const auto at = static_cast<std::size_t>(column - commanded.header.begin());
  std::vector<std::string> names;
  for (const auto& row : commanded.rows) names.push_back(row[at]);
  (void)detail::unique_names(names, commanded.lines, commanded.file, key);
  const auto known = detail::unique_names(points.names, points.lines, points.file, "name");
  Pairing out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto row = static_cast<Index>(i);
    if (const auto found = known.find(names[i]); found != known.end())
      out.pairs.push_back({row, found->second});
    else
      out.faults.push_back({PairingFault::Kind::missing, {row, row}, {}, 1});
  }
  return out;
}

VERNIER_IMPL Pairing check_pairs(const Pairing& pairing, std::span<const Isometry3> flanges, const PointRows& points) {
  for (const PointPair& pair : pairing.pairs)
    require(
        pair.row >= 0 && pair.row < static_cast<Index>(flanges.size()) && pair.point >= 0 && pair.point < points.rows(),
        "check_pairs: row ", pair.row, " of ", flanges.size(), ", point ", pair.point, " of ", points.rows());
  return detail::proven_pairing({flanges, points, false, pairing.pairs}, pairing.faults);
}

VERNIER_IMPL Pairing pair_by_order(std::span<const Isometry3> flanges, const PointRows& points) {
  require(static_cast<double>(flanges.size()) * static_cast<double>(points.rows()) <= 1e8,
          "pair_by_order: ", flanges.size(), " rows and ", points.rows(), " points are too many: pair them by name");
  return detail::proven_pairing({flanges, points, true, {}}, {});
}

VERNIER_IMPL std::string describe(const PairingFault& fault, const CsvText& commanded, const PointTable& points) {
  const auto line = [](const std::vector<Index>& lines, Index i) { return lines[static_cast<std::size_t>(i)]; };
  const auto lines = [&](const std::vector<Index>& of, const IndexRange& range, Index count) {
    std::string out = range.size() == 1 ? message("line ", line(of, range.first))
                                        : message("lines ", line(of, range.first), " to ", line(of, range.last));
    return count < range.size() ? message(count, " of ", out) : out;
  };
  // between two neighbours, of which one may not exist
  const auto between = [&](const std::vector<Index>& of, const IndexRange& range) {
    const bool begins = range.first < 0, ends = range.last >= static_cast<Index>(of.size());
    return begins && ends ? std::string("anywhere")
           : begins       ? message("before line ", line(of, range.last))
           : ends         ? message("after line ", line(of, range.first))
                          : message("between lines ", line(of, range.first), " and ", line(of, range.last));
  };
  const std::string& c = commanded.file;
  const std::string& p = points.file;
  switch (fault.kind) {
    case PairingFault::Kind::missing:
      return message(c, ", ", lines(commanded.lines, fault.rows, fault.count), ": no point in ", p,
                     fault.points.last < 0 ? "" : ", expected " + between(points.lines, fault.points));
    case PairingFault::Kind::additional:
      return message(p, ", ", lines(points.lines, fault.points, fault.count), ": no pose in ", c, ", expected ",
                     between(commanded.lines, fault.rows));
    case PairingFault::Kind::swapped:
      return message(p, ", lines ", line(points.lines, std::min(fault.points.first, fault.points.last)), " and ",
                     line(points.lines, std::max(fault.points.first, fault.points.last)), ": swapped; line ",
                     line(points.lines, fault.points.first), " belongs to line ",
                     line(commanded.lines, fault.rows.first), " of ", c, ", line ",
                     line(points.lines, fault.points.last), " to line ", line(commanded.lines, fault.rows.last));
    case PairingFault::Kind::out_of_order:
      return message(p, ", line ", line(points.lines, fault.points.first), ": in the wrong place; belongs to line ",
                     line(commanded.lines, fault.rows.first), " of ", c);
    default:
      return message(p, ", line ", line(points.lines, fault.points.first), ": ", std::round(1e4 * fault.distance) / 10,
                     " mm from where the arm was in line ", line(commanded.lines, fault.rows.first), " of ", c);
  }
}

VERNIER_IMPL std::string describe(const PairingProof& proof) {
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  switch (proof.status) {
    case PairingStatus::wrong_unit:
      return message("the points would fit the arm if their coordinates were ", rounded(1 / proof.scale),
                     " times as large (their spread is ", rounded(proof.spread_ratio),
                     " times that of the flange): wrong unit");
    case PairingStatus::mirrored:
      return "the points would fit the arm if they were mirrored: their frame is left-handed; exchange two of x, y, z";
    case PairingStatus::ambiguous:
      return "the order cannot be proven: shifted by a row the points would fit the arm as well; pair them by name";
    case PairingStatus::unrelated:
      return message("the points fit the arm in no order (their spread is ", rounded(proof.spread_ratio),
                     " times that of the flange): wrong file, robot, unit or columns, or too many points missing");
    case PairingStatus::too_few: return "a proof needs at least six poses with points";
    default: return "";
  }
}

}  // namespace vernier
