// SPDX-License-Identifier: BSD-3-Clause
// References to callables: work for ranges, observers of progress.

#include "vernier/core/function_ref.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <type_traits>

#include "vernier/core/fit_options.hpp"

namespace vn = vernier;

namespace function_ref_test {
namespace {

using Unary = vn::FunctionRef<int(int)>;
static_assert(sizeof(Unary) == 2 * sizeof(void*) && std::is_trivially_copyable_v<Unary>);
static_assert(std::is_constructible_v<Unary, int (*&)(int)>);
static_assert(!std::is_constructible_v<Unary, std::string&>, "not callable");
static_assert(!std::is_constructible_v<Unary, int (*&)(std::string)>, "another argument");
static_assert(!std::is_constructible_v<Unary, std::string (*&)(int)>, "another result");

int twice(int x) { return 2 * x; }

struct Counter {
  int calls = 0;
  int operator()(int x) {
    ++calls;
    return x + calls;
  }
};
struct ConstOnly {
  int operator()(int x) const { return x + 1; }
  int operator()(int x) { return x - 1; }
};
struct HidesItsAddress {
  int operator()(int x) { return x; }
  void operator&() const = delete;
};

TEST(FunctionRef, CallsWhatItRefersTo) {
  Counter counter;
  const Unary reference(counter);
  EXPECT_EQ(reference(10), 11);
  EXPECT_EQ(reference(10), 12);
  EXPECT_EQ(counter.calls, 2);
  const Unary copy = reference;
  copy(0);
  EXPECT_EQ(counter.calls, 3);

  int offset = 5;
  const auto lambda = [&](int x) { return x + offset; };
  EXPECT_EQ(Unary(lambda)(1), 6);
  const ConstOnly constant;
  EXPECT_EQ(Unary(constant)(1), 2);
  HidesItsAddress hidden;
  EXPECT_EQ(Unary(hidden)(7), 7);
  int (*pointer)(int) = twice;
  EXPECT_EQ(Unary(pointer)(4), 8);
}

TEST(FunctionRef, IsEmptyUnlessItRefers) {
  EXPECT_FALSE(Unary());
  EXPECT_TRUE(Unary(twice));
  EXPECT_EQ(Unary(twice)(21), 42);
}

TEST(FunctionRef, PassesReferencesAndMovesArguments) {
  const auto set = [](int& x) -> int& { return x = 9; };
  int target = 0;
  const vn::FunctionRef<int&(int&)> by_reference(set);
  EXPECT_EQ(&by_reference(target), &target);
  EXPECT_EQ(target, 9);
  const auto take = [](std::unique_ptr<int> p) { return *p; };
  const vn::FunctionRef<int(std::unique_ptr<int>)> moves(take);
  EXPECT_EQ(moves(std::make_unique<int>(3)), 3);
  const auto throws = [](int) -> int { throw std::runtime_error("through"); };
  EXPECT_THROW((void)Unary(throws)(1), std::runtime_error);
}

static_assert(std::is_constructible_v<vn::ObserverRef, void (*&)(const vn::Progress&)>);
static_assert(!std::is_constructible_v<vn::ObserverRef, void (*&)(int)>);

TEST(ObserverRef, ReportsAndMayAskToStop) {
  EXPECT_TRUE(vn::ObserverRef()(vn::Progress{})) << "nobody watches: go on";
  vn::Index seen = 0;
  const auto watch = [&](const vn::Progress& progress) { seen = progress.generation; };
  EXPECT_TRUE(vn::ObserverRef(watch)({.generation = 4}));
  EXPECT_EQ(seen, 4);
  struct Stateful {
    int calls = 0;
    bool operator()(const vn::Progress&) { return ++calls < 3; }
  } stateful;
  const vn::ObserverRef counting(stateful);
  EXPECT_TRUE(counting({}));
  EXPECT_TRUE(counting({}));
  EXPECT_FALSE(counting({}));
  EXPECT_EQ(stateful.calls, 3);
}

bool never(const vn::Progress&) { return false; }

TEST(ObserverRef, TakesAPlainFunction) {
  const vn::FitOptions options{.seed = 1, .observer = never};
  EXPECT_FALSE(options.observer({}));
}

}  // namespace
}  // namespace function_ref_test
