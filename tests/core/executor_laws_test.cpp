// SPDX-License-Identifier: BSD-3-Clause
// Every executor that needs no library through the laws of the concept, and the laws against planted faults.

#include "vernier/testing/executor_laws.hpp"

#include <gtest/gtest.h>

#include <exception>
#include <thread>

#include "laws.hpp"

namespace vernier::executor_laws_test {
namespace {

using testing::executor_violations;
using vernier_test::mentions;
using vernier_test::no_violations;

TEST(ExecutorLaws, OurOwn) {
  SequentialExecutor sequential;
  EXPECT_TRUE(no_violations(executor_violations(sequential)));
  const ExecutorRef none;
  EXPECT_TRUE(no_violations(executor_violations(none)));
  for (const int threads : {1, 2, 3, 8, 17}) {
    const ThreadExecutor executor(threads);
    const ExecutorRef reference(executor);
    EXPECT_TRUE(no_violations(executor_violations(executor))) << threads << " threads";
    EXPECT_TRUE(no_violations(executor_violations(reference))) << threads << " threads";
  }
}

enum class Fault { none, forgets_the_last, repeats_the_first, calls_for_nothing, swallows_exceptions };

/// In two halves, with one fault.
struct Halves {
  Fault fault = Fault::none;
  void for_ranges(Index n, RangeFunction work) const {
    const Index middle = n / 2, end = fault == Fault::forgets_the_last && n > 2 ? n - 1 : n;
    try {
      if (middle > 0 || fault == Fault::calls_for_nothing) work(0, middle);
      if (middle < end) work(middle, end);
      if (fault == Fault::repeats_the_first && n > 0) work(0, 1);
    } catch (const std::exception&) {
      if (fault != Fault::swallows_exceptions) throw;
    }
  }
};

enum class GatherFault { none, keeps_to_itself, rounds, throws_on_one, swallows_exceptions, evaluates_elsewhere };

/// Plays both of two processes one after the other: the second one's values come in a vector of their own.
struct TwoInOne {
  GatherFault fault = GatherFault::none;
  void for_ranges(Index n, RangeFunction work) const { Halves{}.for_ranges(n, work); }
  void allgather(VectorRef values, RangeFunction work) const {
    const VectorX before = values;
    const Index n = values.size(), middle = (n + 1) / 2;
    std::exception_ptr failure;
    try {
      if (middle < n) work(middle, n);
    } catch (...) {
      failure = std::current_exception();
    }
    if (fault == GatherFault::throws_on_one) failure = nullptr;
    if (fault == GatherFault::keeps_to_itself) values.tail(n - middle) = before.tail(n - middle);
    if (fault == GatherFault::rounds)
      values.tail(n - middle) = values.tail(n - middle).cast<float>().template cast<double>();
    if (fault == GatherFault::swallows_exceptions && n == 1) {
      try {
        work(0, 1);
      } catch (const std::exception&) {  // and goes on
      }
    } else if (middle > 0) {
      if (fault == GatherFault::evaluates_elsewhere) {
        std::exception_ptr thrown;
        std::thread([&] {
          try {
            work(0, middle);
          } catch (...) {
            thrown = std::current_exception();
          }
        }).join();
        if (thrown) failure = thrown;
      } else {
        work(0, middle);
      }
    }
    if (failure) std::rethrow_exception(failure);
  }
};
static_assert(Executor<const Halves> && !DistributedExecutor<const Halves> && DistributedExecutor<const TwoInOne>);

/// Near misses of the second concept.
struct NoRanges {
  void allgather(VectorRef values, RangeFunction work) const;
};
struct GathersNothing : Halves {
  void allgather(RangeFunction work) const;
};
static_assert(!Executor<NoRanges> && !DistributedExecutor<NoRanges> && !DistributedExecutor<GathersNothing>);

TEST(ExecutorLaws, UsersOwn) {
  const Halves halves;
  EXPECT_TRUE(no_violations(executor_violations(halves)));
  const TwoInOne two;
  EXPECT_TRUE(no_violations(executor_violations(two)));
  EXPECT_TRUE(ExecutorRef(two).is_distributed());
  EXPECT_FALSE(ExecutorRef(halves).is_distributed());
}

void expect_caught(const auto& executor, const char* sentence) {
  const auto violations = executor_violations(executor);
  EXPECT_TRUE(mentions(violations, sentence)) << sentence << no_violations(violations).message();
}

TEST(ExecutorLaws, CatchPlantedFaults) {
  expect_caught(Halves{Fault::forgets_the_last}, "do not cover 0..n exactly once, n = 3");
  expect_caught(Halves{Fault::forgets_the_last}, "values are missing or wrong after allgather, n = 3");
  expect_caught(Halves{Fault::repeats_the_first}, "do not cover 0..n exactly once, n = 1");
  expect_caught(Halves{Fault::calls_for_nothing}, "an empty range or one outside 0..n, n = 0");
  expect_caught(Halves{Fault::swallows_exceptions}, "of an exception at 5 was rethrown: nothing");
  expect_caught(Halves{Fault::swallows_exceptions}, "an exception at value 0 was not rethrown by allgather");
  expect_caught(TwoInOne{GatherFault::keeps_to_itself}, "values are missing or wrong after allgather, n = 2");
  expect_caught(TwoInOne{GatherFault::keeps_to_itself}, "gives other bits than on one thread");
  expect_caught(TwoInOne{GatherFault::rounds}, "values are missing or wrong after allgather, n = 3");
  expect_caught(TwoInOne{GatherFault::throws_on_one}, "an exception at value 9 was not rethrown by allgather");
  expect_caught(TwoInOne{GatherFault::swallows_exceptions},
                "an exception of a condition to broadcast was not rethrown");
  expect_caught(TwoInOne{GatherFault::evaluates_elsewhere}, "a condition to broadcast was evaluated on another thread");
}

// A search over a gathering executor hands it what tells one search from another, and its observer's word is one.
TEST(DistributedExecutors, InASearch) {
  struct Recorder : TwoInOne {
    std::vector<VectorX>* seen;
    void allgather(VectorRef values, RangeFunction work) const {
      if (values.size() > 1) seen->push_back(values);
      TwoInOne::allgather(values, work);
    }
  };
  std::vector<VectorX> seen;
  Recorder recorder;
  recorder.seen = &seen;
  const Box box = Box::cube(2, -1, 1);
  const auto first = [](const VectorX& x) { return x(0); };
  const SearchResult found = minimize(Pso{.particles = 5, .iterations = 3}, first, box, {}, 1, recorder);
  ASSERT_EQ(seen.size(), 4u);
  EXPECT_NE(seen[0], seen[1]);
  double least = 1;
  for (const VectorX& values : seen) least = std::min(least, values.minCoeff());
  EXPECT_EQ(found.best_fitness, least) << "the first coordinates of the populations";
}

}  // namespace
}  // namespace vernier::executor_laws_test
