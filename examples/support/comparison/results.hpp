// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The outcomes of comparisons in files that only grow, one line of JSON each.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "comparison.hpp"
#include "json_file.hpp"

namespace support {

/// All that decides the outcome of a cell, as one line of JSON with its members in alphabetical order.
std::string cell_key(const Plan& plan, const Cell& cell);

/// An outcome as JSON.
Json to_json(const Outcome& outcome);
/// @throws std::invalid_argument saying which member is none
Outcome outcome_from_json(const nlohmann::json& json);

/// A line of a results file.
struct ResultLine {
  std::size_t number;  ///< from 1
  std::string key;     ///< see `cell_key`
  Outcome outcome;
  std::string text;  ///< as it stands there, without its end
};

/// A results file, read.
struct ResultsFile {
  std::vector<ResultLine> lines;
  std::size_t whole = 0;  ///< bytes up to the end of the last whole line
  bool cut_off = false;   ///< whether more follows: the beginning of a line
};

/// @throws std::invalid_argument naming file and line of what is no result
ResultsFile read_results(const std::filesystem::path& path);

/// The outcomes so far; a cell is known by all that decides its outcome, so plans may share a file. The first rank of a
/// job writes the file itself, another rank one beside it: `results.jsonl.rank3`.
class Results {
 public:
  /// Opens the file, or begins it. A last line that was cut off is dropped. The first rank takes in what is left beside
  /// it where a job ended early.
  /// @throws std::invalid_argument where a line is none of ours
  /// @throws std::runtime_error where it cannot be written
  explicit Results(const std::filesystem::path& path, int rank = 0);

  std::size_t size() const { return known_.size(); }
  std::optional<Outcome> find(const Plan& plan, const Cell& cell) const;
  /// Appends at once.
  /// @param outcome one that did not fail: failures are to be tried again
  void add(const Plan& plan, const Cell& cell, const Outcome& outcome);
  /// Removes the file, after the first rank has it all.
  void remove() const;

 private:
  void take_in_ranks();

  std::filesystem::path path_;
  std::map<std::string, Outcome> known_;
};

/// Adds all cells of some results files to another one, written whole or not at all.
/// @return a sentence for each file and all that was left out of it, and one for the result
/// @throws std::invalid_argument on a line that is no result, or naming both lines where the outcomes of a cell differ
std::vector<std::string> merge_results(const std::vector<std::filesystem::path>& from, const std::filesystem::path& to);

}  // namespace support
