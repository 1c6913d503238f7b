// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Parallel evaluation of independent pieces of work: on the calling thread, on several threads or in several
/// processes. The results do not depend on which.

#include <concepts>
#include <type_traits>

#include "vernier/core/check.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// Work on the half-open range [begin, end).
using RangeFunction = FunctionRef<void(Index begin, Index end)>;

/// Splits 0..n into disjoint ranges that cover it and calls `work` on each, on any thread and in any order;
/// returns when all are done and rethrows the first exception.
template <class E>
concept Executor = requires(E& executor, Index n, RangeFunction work) {
  executor.for_ranges(n, work);
};

/// An `Executor` over several processes, which do not share memory: every process makes the same calls, and
/// `allgather(values, work)` distributes the work over them. `work(begin, end)` writes values(begin) to values(end - 1)
/// and nothing else; its calls cover 0..values.size() over all processes together, and when `allgather` returns, every
/// process has all values. An exception in one process is thrown in all. On entry `values` are the same in every
/// process that runs the same computation; an executor may check that. `for_ranges` covers its range in every process,
/// as for any other executor.
template <class E>
concept DistributedExecutor = Executor<E> && requires(E& executor, VectorRef values, RangeFunction work) {
  executor.allgather(values, work);
};

/// Everything on the calling thread.
struct SequentialExecutor {
  /// Calls `work` once, on the whole range, on the calling thread.
  void for_ranges(Index n, RangeFunction work) const {
    if (n > 0) work(0, n);
  }
};

/// One contiguous range per thread; the calling thread computes the first.
class ThreadExecutor {
 public:
  /// @param threads at least 1
  VERNIER_API explicit ThreadExecutor(int threads) : threads_(threads) {
    demand(threads >= 1, "ThreadExecutor: threads is ", threads, ", must be at least 1");
  }

  /// Number of threads, including the calling one.
  int threads() const { return threads_; }

  /// Calls `work` on a range for each thread. Starts its threads anew with every call.
  VERNIER_API void for_ranges(Index n, RangeFunction work) const;

 private:
  int threads_;
};

/// Refers to any `Executor` that outlives it; sequential by default.
class ExecutorRef {
 public:
  ExecutorRef() = default;

  /// Refers to `executor`, which must outlive this.
  template <Executor E>
    requires(!std::same_as<std::remove_cvref_t<E>, ExecutorRef>)
  ExecutorRef(E& executor)  // NOLINT(google-explicit-constructor)
      : object_(const_cast<void*>(static_cast<const void*>(&executor))),
        for_ranges_([](void* object, Index n, RangeFunction work) { static_cast<E*>(object)->for_ranges(n, work); }) {
    if constexpr (DistributedExecutor<E>)
      allgather_ = [](void* object, VectorRef values, RangeFunction work) {
        static_cast<E*>(object)->allgather(values, work);
      };
  }

  /// Calls `work` on ranges that cover 0 to n, by the executor that it refers to.
  void for_ranges(Index n, RangeFunction work) const {
    for_ranges_ != nullptr ? for_ranges_(object_, n, work) : SequentialExecutor{}.for_ranges(n, work);
  }

  /// Whether it refers to a `DistributedExecutor`.
  bool is_distributed() const { return allgather_ != nullptr; }

  /// Computes `values` over all processes; by `for_ranges` if the executor is no `DistributedExecutor`.
  VERNIER_API void allgather(VectorRef values, RangeFunction work) const;

  /// The value of `condition`, evaluated once, on the calling thread: over several processes in the first one, whose
  /// value all others receive. For what may differ between processes (a clock, a user's input).
  VERNIER_API bool broadcast(FunctionRef<bool()> condition) const;

 private:
  void* object_ = nullptr;
  void (*for_ranges_)(void*, Index, RangeFunction) = nullptr;
  void (*allgather_)(void*, VectorRef, RangeFunction) = nullptr;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/executor.ipp"
#endif
