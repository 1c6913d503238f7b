#pragma once

/// @file
/// Work on the threads of oneTBB, which a program may share with its other parallel work.

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "vernier/core/executor.hpp"

namespace vernier {

/// An `Executor` on oneTBB's worker threads: they are kept from one generation to the next, and whoever is done takes
/// over part of what others still have to do, so pieces of unequal cost are no loss.
///
/// `const vernier::TbbExecutor tbb; recipe.fit(X, Y, {.seed = 1, .executor = tbb});`
///
/// After an exception ranges that were not yet begun are left out. Copies share nothing; one object may be used from
/// several threads.
class TbbExecutor {
 public:
  /// As many threads as oneTBB finds fit: the processors this program may use.
  TbbExecutor() = default;

  /// @param threads at most so many work at a time, the calling one included; at least 1. More than oneTBB allows are
  /// not asked for: the processors, or what the program set by tbb::global_control.
  /// @throws std::invalid_argument where there is none
  explicit TbbExecutor(int threads) : arena_(allowed(threads)) {}

  /// Number of threads, the calling one included.
  int threads() const { return arena_.max_concurrency(); }

  /// See `Executor`. A single piece of work is done on the calling thread.
  void for_ranges(Index n, RangeFunction work) const {
    if (n <= 1) return SequentialExecutor{}.for_ranges(n, work);
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<Index>(0, n),
                        [&](const tbb::blocked_range<Index>& range) { work(range.begin(), range.end()); });
    });
  }

 private:
  static int allowed(int threads) {
    require(threads >= 1, "TbbExecutor: threads is ", threads, ", must be at least 1");
    // Asked for more, oneTBB would print a warning.
    const auto limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    return static_cast<int>(std::min(static_cast<std::size_t>(threads), limit));
  }

  mutable tbb::task_arena arena_;  // its first use starts it
};

static_assert(Executor<const TbbExecutor> && !GatheringExecutor<const TbbExecutor>);

}  // namespace vernier
