// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A comparison of methods: problems, methods, numbers of poses and seeds span a grid, whose cells are computed one by
/// one and kept in a file.

#include <any>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "csv_options.hpp"
#include "json_file.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// An arm, and where its poses come from.
struct Problem {
  std::string name;
  std::string robot = "abb_irb120";  ///< of the catalogue, or a robot file
  // simulated
  std::string errors = "geometric";  ///< geometric; full: joint errors too
  std::string region;   ///< operating (of the IRB 120, and its default); full: the joint limits; empty: the default
  double noise_mm = 0;  ///< of the measured positions, per component
  // measured
  std::filesystem::path data{};  ///< measured poses; empty: simulated
  CsvOptions csv{};              ///< how that file is written
  std::string split = "random";  ///< random, region, time: what is held out, a fifth
  // from `prepare` on, so that every cell has the same
  vernier::RobotDescription arm{};  ///< that `robot` names
  std::any poses{};                 ///< `Dataset<N>` of `data`, positions alone; empty: simulated
  std::string fingerprint{};        ///< of the files that describe it, whose names alone say too little

  bool measured() const { return !data.empty(); }
};

/// `[geometry+|jointwise+][SEARCH:]LEARNER[@MAP]`, or one of the classical ones: none, geometry, jointwise, approach.
struct Method {
  std::string text;                        ///< as it was written
  std::string base{};                      ///< the classical method that leaves what is learned; empty for `none`
  std::string search{}, learner{}, map{};  ///< empty where there is none, or the learner's own

  /// @throws UsageError naming the part that is not known
  static Method parse(const std::string& text);
  /// Whether nothing is learned.
  bool classical() const;
  bool operator==(const Method&) const = default;
};

/// What is to be computed.
struct Plan {
  std::vector<Problem> problems;
  std::vector<Method> methods;
  std::vector<vernier::Index> poses{100, 1000};  ///< to learn from
  std::vector<std::uint64_t> seeds{1, 2, 3, 4, 5};
  vernier::Index evaluations = 2000;  ///< of every search
  double seconds = 0;                 ///< of every fit that can be longer or shorter; 0: by evaluations
  int nodes = 65;                     ///< of hidden layers

  /// From a JSON file; its values are for `prepare` to check.
  /// @throws UsageError naming what is wrong
  /// @throws vernier::DataError on what is no JSON, or larger than JSON files may be
  static Plan read(const std::filesystem::path& path);
  /// Reads the files of the problems with their fingerprints, and checks everything that can be checked before any
  /// work.
  /// @throws UsageError where something is missing or not known, or more poses are asked for than there are
  /// @throws vernier::DataError on measured poses that cannot be read
  void prepare();
};

/// One point of the grid.
struct Cell {
  std::size_t problem = 0, method = 0;
  vernier::Index poses = 0;
  std::uint64_t seed = 0;
};

/// Best fitness of a search at a number of evaluations and seconds.
struct Convergence {
  std::vector<double> evaluations, seconds, best;
};

/// What a cell gave.
struct Outcome {
  double mean = 0, median = 0, rms = 0, p95 = 0, max = 0;  ///< of held-out position errors [mm]
  std::vector<double> quantiles{};                         ///< of the same, 0 to 100 % in steps of 5 %
  double before = 0;                                       ///< mean without learning [mm]
  double seconds = 0;                                      ///< of the fit
  double learned_from = 0;                                 ///< poses
  Convergence convergence{};                               ///< of the search, where there is one
  std::string failure{};                                   ///< why there are no errors

  bool failed() const { return !failure.empty(); }
};

/// A method by its name in `--list`.
struct Named {
  const char* name;
  const char* title;
};

/// All learners.
const std::vector<Named>& learner_names();
/// All searches.
const std::vector<Named>& search_names();
/// The classical methods, which are no learners.
const std::vector<Named>& classical_names();

/// Computes a cell: the same bits for the same plan, times apart.
Outcome compute(const Plan& plan, const Cell& cell, vernier::ObserverRef observer = {});

}  // namespace support
