// SPDX-License-Identifier: BSD-3-Clause
// Threads of executors, and exceptions that are handed on; what else is asked of executors are laws.

#include "vernier/core/executor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "complaint.hpp"

namespace vn = vernier;

namespace executor_test {
namespace {

/// A user's own whose state changes, and near misses of the concept.
struct Changing {
  void for_ranges(vn::Index n, vn::RangeFunction work);
};
struct NoRanges {
  void for_each(vn::Index n, vn::RangeFunction work);
};
struct TakesNoWork {
  void for_ranges(vn::Index n);
};
static_assert(vn::Executor<vn::SequentialExecutor> && vn::Executor<vn::ThreadExecutor> &&
              vn::Executor<vn::ExecutorRef>);
static_assert(vn::Executor<Changing> && !vn::Executor<const Changing>);
static_assert(!vn::Executor<NoRanges> && !vn::Executor<TakesNoWork> && !vn::Executor<int>);

TEST(ThreadExecutor, UsesOneThreadAPartAndTheCallersForTheFirst) {
  for (const auto& [n, threads, parts] :
       {std::array{100, 4, 4}, std::array{3, 8, 3}, std::array{2, 2, 2}, std::array{9, 2, 2}, std::array{5, 1, 1}}) {
    std::mutex guard;
    std::set<std::thread::id> ids;
    std::thread::id first;
    vn::ThreadExecutor(threads).for_ranges(n, [&](vn::Index begin, vn::Index) {
      const std::scoped_lock lock(guard);
      ids.insert(std::this_thread::get_id());
      if (begin == 0) first = std::this_thread::get_id();
    });
    EXPECT_EQ(ids.size(), static_cast<std::size_t>(parts));
    EXPECT_EQ(first, std::this_thread::get_id());
  }
}

TEST(ThreadExecutor, RethrowsAfterTheOthersAreDone) {
  for (const vn::Index culprit : {0, 3, 7}) {  // the caller's part, a middle one, the last
    std::atomic<int> done{0};
    try {
      vn::ThreadExecutor(8).for_ranges(8, [&](vn::Index begin, vn::Index) {
        if (begin == culprit) throw std::runtime_error("part " + std::to_string(begin));
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        ++done;
      });
      FAIL() << "did not throw";
    } catch (const std::runtime_error& e) {
      EXPECT_EQ(e.what(), "part " + std::to_string(culprit));
      EXPECT_EQ(done, 7);
    }
  }
  // All of them throw: one gets through, nothing terminates.
  EXPECT_THROW(vn::ThreadExecutor(4).for_ranges(4, [](vn::Index, vn::Index) { throw std::logic_error("each"); }),
               std::logic_error);
  EXPECT_THROW(vn::SequentialExecutor{}.for_ranges(1, [](vn::Index, vn::Index) { throw std::logic_error("one"); }),
               std::logic_error);
}

/// Runs everything on a thread of its own.
struct Elsewhere {
  void for_ranges(vn::Index n, vn::RangeFunction work) const {
    std::jthread([&] { vn::SequentialExecutor{}.for_ranges(n, work); }).join();
  }
};

// A condition (a clock, a request to stop) is evaluated once, by the caller; values are computed by all threads.
TEST(ExecutorRef, AConditionIsEvaluatedOnceByTheCaller) {
  const Elsewhere elsewhere;
  const vn::ExecutorRef executor(elsewhere);
  for (const bool answer : {true, false}) {
    std::vector<std::thread::id> askers;
    EXPECT_EQ(executor.broadcast([&] {
      askers.push_back(std::this_thread::get_id());
      return answer;
    }),
              answer);
    EXPECT_EQ(askers, std::vector<std::thread::id>{std::this_thread::get_id()});
  }
  vn::VectorX values = vn::VectorX::Zero(3);
  std::thread::id computed;
  executor.allgather(values, [&](vn::Index begin, vn::Index end) {
    computed = std::this_thread::get_id();
    for (vn::Index i = begin; i < end; ++i) values(i) = static_cast<double>(i + 1);
  });
  EXPECT_EQ(values(0) + values(1) + values(2), 6);
  EXPECT_NE(computed, std::this_thread::get_id());
}

TEST(ThreadExecutor, NeedsAThread) {
  EXPECT_EQ(vn::ThreadExecutor(1).threads(), 1);
  EXPECT_EQ(vernier_test::complaint([] { vn::ThreadExecutor(0); }), "ThreadExecutor: threads is 0, must be at least 1");
}

}  // namespace
}  // namespace executor_test
