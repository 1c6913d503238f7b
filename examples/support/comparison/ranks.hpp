// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The processes that mpirun started together.

#include <functional>
#include <string>
#include <vector>

namespace support {

/// The processes (ranks) of a job under mpirun; one where the program was started by itself or built without MPI. The
/// first one speaks for all: what others print is dropped. A program returns 0 from the others whatever happened, so
/// that mpirun does not end the first before it has said it.
class Ranks {
 public:
  /// Meets the others.
  /// @throws std::runtime_error where several were started, but the program was built without MPI
  Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  ~Ranks();

  int rank() const { return rank_; }    ///< this process, from 0
  int count() const { return count_; }  ///< all of them
  bool first() const { return rank_ == 0; }
  bool many() const { return count_ > 1; }

  /// Works on every rank, and returns when all are done. Where one throws, all throw: this rank its own exception, the
  /// others std::runtime_error with the text of the first that did. Every rank must call it.
  void together(const std::function<void()>& work) const;

  /// A text of every rank, by rank. Every rank must call it.
  /// @throws std::runtime_error where the texts have more than 2 GB
  std::vector<std::string> gather(const std::string& text) const;

 private:
  int rank_ = 0, count_ = 1;
};

}  // namespace support
