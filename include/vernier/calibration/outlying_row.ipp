// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/calibration/outlying_row.hpp"
#include "vernier/data/row_origin.hpp"

namespace vernier {

VERNIER_IMPL std::string where(const std::vector<OutlyingRow>& rows) {
  RowOrigin origin;
  std::vector<Index> numbers, places;
  for (const OutlyingRow& one : rows) {
    numbers.push_back(one.row);
    places.push_back(static_cast<Index>(places.size()));
    auto file = std::find(origin.files.begin(), origin.files.end(), one.file);
    if (file == origin.files.end()) file = origin.files.insert(file, one.file);
    origin.file.push_back(static_cast<int>(file - origin.files.begin()));
    origin.line.push_back(one.line);
  }
  const bool known = std::none_of(rows.begin(), rows.end(), [](const OutlyingRow& one) { return one.file.empty(); });
  return known ? origin.where(places) : RowOrigin{}.where(numbers);
}

}  // namespace vernier
