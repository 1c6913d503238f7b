// SPDX-License-Identifier: BSD-3-Clause
// oneTBB's threads through the laws of executors, and whole fits on them.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "laws.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/tbb.hpp"
#include "vernier/testing/executor_laws.hpp"

namespace vernier::executor_test {
namespace {

using vernier_test::no_violations;

/// Three threads also where there are fewer processors.
struct ThreeAllowed {
  tbb::global_control limit{tbb::global_control::max_allowed_parallelism, 3};
};

TEST(TbbExecutor, KeepsTheLaws) {
  const ThreeAllowed allowed;
  const TbbExecutor by_default;
  EXPECT_GE(by_default.threads(), 1);
  EXPECT_TRUE(no_violations(testing::executor_violations(by_default)));
  for (const int threads : {1, 2, 3}) {
    const TbbExecutor executor(threads);
    EXPECT_EQ(executor.threads(), threads);
    EXPECT_TRUE(no_violations(testing::executor_violations(executor))) << threads << " threads";
  }
}

// Two pieces that wait for each other can only end if two threads are at work, and a third never is.
TEST(TbbExecutor, WorksOnAsManyThreadsAsItSays) {
  const ThreeAllowed allowed;
  std::atomic<int> met = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  TbbExecutor(2).for_ranges(2, [&](Index, Index) {
    ++met;
    while (met < 2 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  });
  EXPECT_EQ(met, 2);
  for (const int threads : {1, 2}) {
    std::mutex guard;
    std::set<std::thread::id> ids;
    TbbExecutor(threads).for_ranges(200, [&](Index begin, Index end) {
      std::this_thread::sleep_for(std::chrono::microseconds(50 * (end - begin)));
      const std::scoped_lock lock(guard);
      ids.insert(std::this_thread::get_id());
    });
    EXPECT_LE(ids.size(), static_cast<std::size_t>(threads));
  }
}

TEST(TbbExecutor, AsksForNoMoreThanIsAllowed) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(TbbExecutor(64).threads(), 2);
  EXPECT_EQ(TbbExecutor(1).threads(), 1);
}

TEST(TbbExecutor, OneObjectServesSeveralThreads) {
  const TbbExecutor executor(2);
  std::array<std::atomic<Index>, 3> sums{};
  {
    std::vector<std::jthread> callers;
    for (auto& sum : sums)
      callers.emplace_back([&] {
        for (int i = 0; i < 20; ++i) executor.for_ranges(100, [&](Index begin, Index end) { sum += end - begin; });
      });
  }
  for (const auto& sum : sums) EXPECT_EQ(sum, 2000);
}

TEST(TbbExecutor, SameFitAsOnOneThread) {
  const ThreeAllowed allowed;
  const JointRows<3> x = JointRows<3>::Random(120, 3);
  const PointRows y = x.array().sin() * x.rowwise().sum().array().replicate<1, 3>();
  const Tuned pso_elm{Elm{.hidden_nodes = 8}, Pso{.particles = 10, .iterations = 10}};
  const auto alone = pso_elm.fit(x, y, {.seed = 3});
  for (const int threads : {1, 2, 3}) {
    const TbbExecutor executor(threads);
    const auto fitted = pso_elm.fit(x, y, {.seed = 3, .executor = executor});
    EXPECT_TRUE(testing::same_bits(fitted.theta(), alone.theta())) << threads << " threads";
    EXPECT_TRUE(testing::same_bits(fitted.beta(), alone.beta())) << threads << " threads";
  }
}

TEST(TbbExecutor, NeedsAThread) {
  for (const int threads : {0, -1}) {
    try {
      const TbbExecutor executor(threads);
      FAIL() << "did not throw";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), message("TbbExecutor: threads is ", threads, ", must be at least 1"));
    }
  }
}

}  // namespace
}  // namespace vernier::executor_test
