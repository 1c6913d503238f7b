// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/pair_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/data/detail/pairing_faults.hpp"
#include "vernier/data/detail/text_lines.hpp"

namespace vernier {

namespace detail {

/// Index of every name.
/// @throws DataError where one is there twice
VERNIER_LOCAL std::map<std::string, Index> unique_names(const std::vector<std::string>& names,
                                                        const std::vector<Index>& lines, const std::string& file,
                                                        const std::string& column) {
  std::map<std::string, Index> out;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (const auto [known, added] = out.emplace(names[i], static_cast<Index>(i)); !added)
      throw DataError(message(file, ", line ", lines[i], ", column ", column, ": '", printable(names[i]),
                              "' is in line ", lines[static_cast<std::size_t>(known->second)], " already"));
  return out;
}

VERNIER_LOCAL Pairing proven_pairing(const PairSearch& search, std::vector<PairingFault> faults) {
  auto [proof, found] = prove(search);
  if (proof.status != PairingStatus::proven) return {{}, std::move(faults), proof};
  const FaultSearch unpaired(search, *found);
  for (const PairingFault& fault : unpaired.faults()) faults.push_back(fault);
  std::sort(faults.begin(), faults.end(), [](const PairingFault& a, const PairingFault& b) {
    return std::tuple(a.rows.first, a.points.first, a.kind) < std::tuple(b.rows.first, b.points.first, b.kind);
  });
  return {unpaired.pairs(), std::move(faults), proof};
}

}  // namespace detail

VERNIER_IMPL Pairing pair_by_name(const CsvText& commanded, const std::string& key, const PointTable& points) {
  const auto column = std::find(commanded.header.begin(), commanded.header.end(), key);
  if (column == commanded.header.end())
    throw DataError(message(commanded.file, ": no column ", detail::printable(key), " in the header"));
  if (std::count(commanded.header.begin(), commanded.header.end(), key) > 1)
    throw DataError(message(commanded.file, ": column ", detail::printable(key), " is there twice"));
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
    demand(
        pair.row >= 0 && pair.row < static_cast<Index>(flanges.size()) && pair.point >= 0 && pair.point < points.rows(),
        "check_pairs: row ", pair.row, " of ", flanges.size(), ", point ", pair.point, " of ", points.rows());
  return detail::proven_pairing({flanges, points, false, pairing.pairs}, pairing.faults);
}

VERNIER_IMPL Pairing pair_by_order(std::span<const Isometry3> flanges, const PointRows& points) {
  demand(static_cast<double>(flanges.size()) * static_cast<double>(points.rows()) <= 1e8,
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
      return message(p, ", lines ", line(points.lines, (std::min)(fault.points.first, fault.points.last)), " and ",
                     line(points.lines, (std::max)(fault.points.first, fault.points.last)), ": swapped; line ",
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
