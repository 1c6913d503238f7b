// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/data/row_origin.hpp"

namespace vernier {

VERNIER_IMPL RowOrigin RowOrigin::of(std::string name, std::vector<Index> lines, std::string hash) {
  RowOrigin out;
  out.files.push_back(std::move(name));
  out.hashes.push_back(std::move(hash));
  out.file.assign(lines.size(), 0);
  out.line = std::move(lines);
  return out;
}

VERNIER_IMPL std::string RowOrigin::where(Index row) const {
  const auto i = static_cast<std::size_t>(row);
  if (i >= line.size()) return message("row ", row);
  return message(files[static_cast<std::size_t>(file[i])], ", line ", line[i]);
}

VERNIER_IMPL std::string RowOrigin::where(const std::vector<Index>& of_rows) const {
  const bool lines = files.size() == 1, several = files.size() > 1;
  std::string out =
      several ? "" : message(lines ? files[0] + ", " : "", lines ? "line" : "row", of_rows.size() == 1 ? " " : "s ");
  const std::size_t shown = of_rows.size() > 10 ? 10 : of_rows.size();
  for (std::size_t k = 0; k < shown; ++k) {
    out += k == 0 ? "" : k + 1 == of_rows.size() ? " and " : several ? "; " : ", ";
    out += several ? where(of_rows[k]) : message(lines ? line[static_cast<std::size_t>(of_rows[k])] : of_rows[k]);
  }
  if (shown < of_rows.size()) out += message(", ... (", of_rows.size(), lines ? " lines)" : " rows)");
  return out;
}

VERNIER_IMPL RowOrigin RowOrigin::rows(std::span<const Index> indices) const {
  if (empty()) return {};
  RowOrigin out;
  out.files = files;
  out.hashes = hashes;
  for (const Index i : indices) {
    out.file.push_back(file[static_cast<std::size_t>(i)]);
    out.line.push_back(line[static_cast<std::size_t>(i)]);
  }
  return out;
}

VERNIER_IMPL void RowOrigin::append(const RowOrigin& other, Index size) {
  if (other.empty() || (empty() && size > 0)) {
    *this = {};
    return;
  }
  const auto before = static_cast<int>(files.size());
  hashes.resize(files.size());  // whoever made the rows may have left them out
  files.insert(files.end(), other.files.begin(), other.files.end());
  hashes.insert(hashes.end(), other.hashes.begin(), other.hashes.end());
  hashes.resize(files.size());
  for (const int of : other.file) file.push_back(before + of);
  line.insert(line.end(), other.line.begin(), other.line.end());
}

}  // namespace vernier
