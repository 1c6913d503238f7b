#pragma once

/// @file
/// Who evaluates independent pieces of work: this thread, several, or several processes. The results do not depend on
/// it.

#include <algorithm>
#include <concepts>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

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

/// An `Executor` whose workers do not all share the caller's memory and may therefore, where it is told what is
/// written, share more out. `fill(values, work)`: `work(begin, end)` writes values(begin) to values(end - 1) and
/// nothing else; its calls cover 0..values.size() *somewhere*, and when `fill` returns all values are *everywhere*. An
/// exception anywhere is thrown everywhere. What `values` hold before is the same everywhere, or the workers are not at
/// the same work, which an executor may check. `for_ranges` covers its range in every process, as for any other
/// executor.
template <class E>
concept GatheringExecutor = Executor<E> && requires(E& executor, Eigen::Ref<VectorX> values, RangeFunction work) {
  executor.fill(values, work);
};

/// Everything on the calling thread.
struct SequentialExecutor {
  /// See `Executor`.
  void for_ranges(Index n, RangeFunction work) const {
    if (n > 0) work(0, n);
  }
};

/// One contiguous range per thread; the calling thread takes the first.
class ThreadExecutor {
 public:
  /// @param threads at least 1
  explicit ThreadExecutor(int threads) : threads_(threads) {
    require(threads >= 1, "ThreadExecutor: threads is ", threads, ", must be at least 1");
  }

  /// Number of threads, the calling one included.
  int threads() const { return threads_; }

  /// See `Executor`.
  void for_ranges(Index n, RangeFunction work) const {
    const Index parts = std::min<Index>(threads_, n);
    if (parts <= 1) return SequentialExecutor{}.for_ranges(n, work);
    std::exception_ptr failure;
    std::mutex guard;
    const auto run = [&](Index part) {
      try {
        work(n * part / parts, n * (part + 1) / parts);
      } catch (...) {
        const std::scoped_lock lock(guard);
        if (!failure) failure = std::current_exception();
      }
    };
    {
      std::vector<std::jthread> workers;
      workers.reserve(static_cast<std::size_t>(parts - 1));
      for (Index part = 1; part < parts; ++part) workers.emplace_back(run, part);
      run(0);
    }
    if (failure) std::rethrow_exception(failure);
  }

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
        call_([](void* object, Index n, RangeFunction work) { static_cast<E*>(object)->for_ranges(n, work); }) {
    if constexpr (GatheringExecutor<E>)
      fill_ = [](void* object, Eigen::Ref<VectorX> values, RangeFunction work) {
        static_cast<E*>(object)->fill(values, work);
      };
  }

  /// See `Executor`.
  void for_ranges(Index n, RangeFunction work) const {
    call_ != nullptr ? call_(object_, n, work) : SequentialExecutor{}.for_ranges(n, work);
  }

  /// Whether it refers to a `GatheringExecutor`.
  bool gathers() const { return fill_ != nullptr; }

  /// See `GatheringExecutor`; `for_ranges` where the executor is none.
  void fill(Eigen::Ref<VectorX> values, RangeFunction work) const {
    fill_ != nullptr ? fill_(object_, values, work) : for_ranges(values.size(), work);
  }

  /// The answer to a question that is asked once: on the calling thread, and over several processes in the first one
  /// alone, whose answer is everybody's. What might differ between processes (a clock, a person) is decided so.
  bool decide(FunctionRef<bool()> question) const {
    if (fill_ == nullptr) return question();
    VectorX answer = VectorX::Zero(1);
    fill(answer, [&](Index, Index) { answer(0) = question() ? 1 : 0; });
    return answer(0) != 0;
  }

 private:
  void* object_ = nullptr;
  void (*call_)(void*, Index, RangeFunction) = nullptr;
  void (*fill_)(void*, Eigen::Ref<VectorX>, RangeFunction) = nullptr;
};

static_assert(Executor<SequentialExecutor> && Executor<ThreadExecutor> && Executor<const ExecutorRef>);
static_assert(!GatheringExecutor<SequentialExecutor> && !GatheringExecutor<ThreadExecutor> &&
              GatheringExecutor<const ExecutorRef>);
static_assert(!Executor<int>);

}  // namespace vernier
