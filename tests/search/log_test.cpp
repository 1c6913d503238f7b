// SPDX-License-Identifier: BSD-3-Clause
// What a log writes down, and whom it asks.

#include "vernier/search/log.hpp"

#include <gtest/gtest.h>

#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"

namespace vernier::log_test {
namespace {

const Pso pso{.particles = 10, .iterations = 30};
const Box box = Box::cube(3, -2, 2);
double sphere(const VectorX& x) { return x.squaredNorm(); }

TEST(SearchLog, WritesDownEveryGeneration) {
  SearchLog log;
  const SearchResult result = minimize(pso, sphere, box, {}, 1, {}, log);
  ASSERT_EQ(log.entries().size(), 31u);
  for (std::size_t i = 0; i < 31; ++i) {
    const SearchLog::Entry& entry = log.entries()[i];
    EXPECT_EQ(entry.generation, static_cast<Index>(i));
    EXPECT_EQ(entry.evaluations, 10 * static_cast<Index>(i + 1));
    EXPECT_GE(entry.seconds, i == 0 ? 0 : log.entries()[i - 1].seconds);
    EXPECT_EQ(entry.best, minimize(pso, sphere, box, {.max_generations = entry.generation}, 1).best_fitness);
  }
  EXPECT_GT(log.entries().back().seconds, 0);
  EXPECT_LT(log.entries().back().seconds, 10);
  EXPECT_EQ(log.entries().back().best, result.best_fitness);

  EXPECT_EQ(log.best_after(9), std::numeric_limits<double>::infinity());
  EXPECT_EQ(log.best_after(10), log.entries()[0].best);
  EXPECT_EQ(log.best_after(155), log.entries()[14].best);
  const double target = log.entries()[20].best;
  const Index needed = log.evaluations_to(target);
  EXPECT_LE(log.best_after(needed), target);
  EXPECT_GT(log.best_after(needed - 10), target);
  EXPECT_EQ(log.evaluations_to(-1), -1);
}

TEST(SearchLog, AsksTheNextObserver) {
  Index seen = 0;
  const auto stop_at_four = [&](const Progress& progress) { return ++seen, progress.generation < 4; };
  SearchLog log(stop_at_four);
  EXPECT_EQ(minimize(pso, sphere, box, {}, 1, {}, log).status, SearchStatus::observer_stopped);
  EXPECT_EQ(seen, 5);
  EXPECT_EQ(log.entries().size(), 5u);
}

// A search in two calls is one log, without a generation twice.
TEST(SearchLog, GoesOnWithASearch) {
  SearchLog log, whole;
  auto search = start_search(pso, sphere, box, 1);
  minimize(pso, sphere, box, search, {.max_evaluations = 125}, {}, log);
  minimize(pso, sphere, box, search, {}, {}, log);
  minimize(pso, sphere, box, {}, 1, {}, whole);
  ASSERT_EQ(log.entries().size(), whole.entries().size());
  for (std::size_t i = 0; i < log.entries().size(); ++i) {
    EXPECT_EQ(log.entries()[i].evaluations, whole.entries()[i].evaluations);
    EXPECT_EQ(log.entries()[i].best, whole.entries()[i].best);
  }
}

}  // namespace
}  // namespace vernier::log_test
