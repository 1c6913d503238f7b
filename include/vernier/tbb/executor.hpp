// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Parallel evaluation on the threads of oneTBB, which a program may share with its other parallel work.

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "vernier/core/executor.hpp"

/// @cond
#if defined(__SANITIZE_THREAD__)
#define VERNIER_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define VERNIER_THREAD_SANITIZER 1
#endif
#endif
#ifdef VERNIER_THREAD_SANITIZER
extern "C" void __tsan_acquire(void* place);
extern "C" void __tsan_release(void* place);
#endif
/// @endcond

namespace vernier {

namespace detail {

#ifdef VERNIER_THREAD_SANITIZER
inline char before_work, after_work;  // their addresses alone matter
#endif

/// Tells the thread sanitizer what it cannot see, as oneTBB is not compiled with it: work begins after the call of
/// `for_ranges`, and ends before its return. Pieces of work stay unordered, so races among them are found.
template <bool caller>
struct SeenByThreadSanitizer {
#ifdef VERNIER_THREAD_SANITIZER
  SeenByThreadSanitizer() { caller ? __tsan_release(&before_work) : __tsan_acquire(&before_work); }
  ~SeenByThreadSanitizer() { caller ? __tsan_acquire(&after_work) : __tsan_release(&after_work); }
  SeenByThreadSanitizer(const SeenByThreadSanitizer&) = delete;
  SeenByThreadSanitizer& operator=(const SeenByThreadSanitizer&) = delete;
#endif
};

}  // namespace detail

/// An `Executor` on oneTBB's worker threads: a thread pool with work stealing, so threads are started once, and work of
/// unequal cost is balanced.
///
/// `const vernier::TbbExecutor tbb; recipe.fit(X, Y, {.seed = 1, .executor = tbb});`
///
/// After an exception, ranges that were not yet started are skipped. Copies share nothing; one object may be used from
/// several threads.
class TbbExecutor {
 public:
  /// oneTBB's default number of threads: the processors available to this program.
  TbbExecutor() = default;

  /// @param threads maximum number of threads, including the calling one; at least 1. Limited to what oneTBB allows:
  /// the number of processors, or the program's tbb::global_control.
  /// @throws std::invalid_argument for fewer than 1
  explicit TbbExecutor(int threads) : arena_(allowed(threads)) {}

  /// Number of threads, including the calling one.
  int threads() const { return arena_.max_concurrency(); }

  /// Calls `work` on ranges that cover 0 to n, on the threads of oneTBB. A range of one is computed on the calling
  /// thread.
  void for_ranges(Index n, RangeFunction work) const {
    if (n <= 1) return SequentialExecutor{}.for_ranges(n, work);
    [[maybe_unused]] const detail::SeenByThreadSanitizer<true> call{};
    arena_.execute([&] {
      [[maybe_unused]] const detail::SeenByThreadSanitizer<false> here{};
      tbb::parallel_for(tbb::blocked_range<Index>(0, n), [&](const tbb::blocked_range<Index>& range) {
        [[maybe_unused]] const detail::SeenByThreadSanitizer<false> piece{};
        work(range.begin(), range.end());
      });
    });
  }

 private:
  static int allowed(int threads) {
    demand(threads >= 1, "TbbExecutor: threads is ", threads, ", must be at least 1");
    // Beyond the limit oneTBB would print a warning.
    const auto limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    return static_cast<int>((std::min)(static_cast<std::size_t>(threads), limit));
  }

  mutable tbb::task_arena arena_;  // its first use starts it
};

static_assert(Executor<const TbbExecutor> && !DistributedExecutor<const TbbExecutor>);

}  // namespace vernier
