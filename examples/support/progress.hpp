// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Progress for people: on standard error, and only where that is a terminal and the program is not quiet.

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "vernier/core/fit_options.hpp"

namespace support {

/// One line that shows how far something has come and how long it will take; silent where the stream is no terminal.
/// Takes itself away at the end. Serves as an observer: `ProgressBar bar("joint PSO-ELM", 300); options.observer =
/// bar;`
class ProgressBar {
 public:
  /// @param label what is going on
  /// @param total steps (generations) it will take; 0 where unknown
  ProgressBar(std::string label, vernier::Index total);
  /// The same on another stream, shown or not.
  ProgressBar(std::string label, vernier::Index total, std::FILE* stream, bool shown);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { finish(); }

  /// Steps done. Draws ten times a second at most.
  /// @param note a word or number of what was reached
  void update(vernier::Index done, std::string_view note = {});
  /// As an observer: generations done, and the best fitness.
  void operator()(const vernier::Progress& progress);
  /// Takes the line away.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  vernier::Index total_;
  std::FILE* stream_;
  bool shown_, drawn_ = false;
  Clock::time_point start_ = Clock::now(), last_{};
};

/// The share of the time of a fit of an error model that has passed after some of its steps, on average over the fits
/// of UR10, UR5, WAM and a simulated IRB 120.
double share_of_fit(vernier::Index steps);

/// A line that shows from two seconds on what is going on, since when, and how long it will take if that is known.
/// Nothing else may be printed while it is there; it takes itself away at the end.
class Working {
 public:
  explicit Working(std::string label);
  /// The same on another stream, shown or not, and from another time on.
  Working(std::string label, std::FILE* stream, bool shown, std::chrono::milliseconds from);
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;
  ~Working() { finish(); }

  /// The share of the work that is done, 0 to 1, from any thread.
  void reach(double share);
  /// Takes the line away.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void run();

  std::string label_;
  std::FILE* stream_;
  std::chrono::milliseconds from_;
  std::mutex mutex_{};
  std::condition_variable ended_{};
  bool end_ = false;
  Clock::time_point start_ = Clock::now(), end_expected_ = start_;
  std::thread thread_{};
};

}  // namespace support
