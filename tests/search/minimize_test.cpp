// SPDX-License-Identifier: BSD-3-Clause
// The loop: budgets, stopping, observers, executors, misuse.

#include "vernier/search/minimize.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>

#include "complaint.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"

namespace vernier::minimize_test {
namespace {

using vernier_test::complaint;

const Pso pso{.particles = 10, .iterations = 50};
const Box box = Box::cube(3, -2, 2);
double sphere(const VectorX& x) { return x.squaredNorm(); }

TEST(Minimize, ScheduleAlone) {
  std::atomic<Index> calls = 0;
  const auto counting = [&](const VectorX& x) {
    ++calls;
    return sphere(x);
  };
  const SearchResult result = minimize(pso, counting, box);
  EXPECT_EQ(result.status, SearchStatus::schedule_ended);
  EXPECT_EQ(result.generations, 50);
  EXPECT_EQ(result.evaluations, 510);
  EXPECT_EQ(calls, 510);
  EXPECT_EQ(result.best_fitness, sphere(result.best));
  EXPECT_LT(result.best_fitness, 1e-3);
}

TEST(Minimize, EvaluationBudget) {
  for (const Index budget : {10, 19, 20, 55, 505}) {
    const SearchResult result = minimize(pso, sphere, box, {.max_evaluations = budget});
    EXPECT_EQ(result.status, SearchStatus::budget_spent);
    EXPECT_EQ(result.evaluations, budget / 10 * 10);
    EXPECT_EQ(result.generations, budget / 10 - 1);
  }
  EXPECT_EQ(minimize(pso, sphere, box, {.max_evaluations = 510}).status, SearchStatus::schedule_ended);
}

TEST(Minimize, GenerationBudget) {
  for (const Index generations : {0, 1, 7}) {
    const SearchResult result = minimize(pso, sphere, box, {.max_generations = generations});
    EXPECT_EQ(result.status, SearchStatus::budget_spent);
    EXPECT_EQ(result.generations, generations);
    EXPECT_EQ(result.evaluations, 10 * (generations + 1));
  }
}

// Stops at the first generation that reaches the target, and not before.
TEST(Minimize, Target) {
  const SearchResult result = minimize(pso, sphere, box, {.target = 0.05}, 3);
  EXPECT_EQ(result.status, SearchStatus::target_reached);
  EXPECT_LE(result.best_fitness, 0.05);
  ASSERT_GT(result.generations, 0);
  EXPECT_GT(minimize(pso, sphere, box, {.max_generations = result.generations - 1}, 3).best_fitness, 0.05);
  EXPECT_EQ(minimize(pso, sphere, box, {.target = 100}).generations, 0);
  const SearchResult equal = minimize(pso, [](const VectorX&) { return 2.0; }, box, {.target = 2});
  EXPECT_EQ(equal.status, SearchStatus::target_reached);  // a value equal to the threshold suffices
  EXPECT_EQ(equal.generations, 0);
}

// An objective that never improves stalls after exactly `patience` generations; one that improves with every
// generation never does.
TEST(Minimize, Patience) {
  const auto flat = [](const VectorX&) { return 1.0; };
  const SearchResult stalled = minimize(pso, flat, box, {.patience = 6});
  EXPECT_EQ(stalled.status, SearchStatus::stalled);
  EXPECT_EQ(stalled.generations, 6);
  double value = 0;
  const auto falling = [&](const VectorX&) { return value -= 1; };
  EXPECT_EQ(minimize(pso, falling, box, {.patience = 1}).status, SearchStatus::schedule_ended);
  // improves up to generation 4 (50 evaluations), then never again
  value = 0;
  const auto levels_out = [&](const VectorX&) { return value = std::max(value - 1, -50.0); };
  const SearchResult later = minimize(pso, levels_out, box, {.patience = 3});
  EXPECT_EQ(later.status, SearchStatus::stalled);
  EXPECT_EQ(later.generations, 4 + 3);
}

// What an observer sees of every generation is tested beside the log.
TEST(Minimize, ObserverMayStop) {
  const auto stop_at_four = [](const Progress& progress) { return progress.generation < 4; };
  const SearchResult stopped = minimize(pso, sphere, box, {}, 1, {}, stop_at_four);
  EXPECT_EQ(stopped.status, SearchStatus::observer_stopped);
  EXPECT_EQ(stopped.generations, 4);
  EXPECT_EQ(stopped.best_fitness, minimize(pso, sphere, box, {.max_generations = 4}, 1).best_fitness);
}

// Scalar or batch, one thread or more: the same bits, and with two threads two threads do work.
TEST(Minimize, ExecutorsAndKindsOfObjectiveDoNotMatter) {
  const auto batch = [](const Eigen::Ref<const MatrixX>& population, Eigen::Ref<VectorX> fitness) {
    for (Index k = 0; k < population.cols(); ++k) fitness(k) = sphere(population.col(k));
  };
  const GeneticAlgorithm ga{.individuals = 11, .generations = 30};
  const ThreadExecutor two(2), three(3);
  const SearchResult by_pso = minimize(pso, sphere, box, {}, 4), by_ga = minimize(ga, sphere, box, {}, 4);
  for (const ExecutorRef executor : {ExecutorRef{}, ExecutorRef(two), ExecutorRef(three)}) {
    for (const SearchResult& other :
         {minimize(pso, sphere, box, {}, 4, executor), minimize(pso, batch, box, {}, 4, executor)}) {
      EXPECT_EQ(other.best, by_pso.best);
      EXPECT_EQ(other.best_fitness, by_pso.best_fitness);
      EXPECT_EQ(other.evaluations, by_pso.evaluations);
    }
    for (const SearchResult& other :
         {minimize(ga, sphere, box, {}, 4, executor), minimize(ga, batch, box, {}, 4, executor)}) {
      EXPECT_EQ(other.best, by_ga.best);
      EXPECT_EQ(other.best_fitness, by_ga.best_fitness);
    }
  }
  std::atomic<int> elsewhere = 0;
  const auto caller = std::this_thread::get_id();
  const auto noting = [&](const VectorX& x) {
    if (std::this_thread::get_id() != caller) ++elsewhere;
    return sphere(x);
  };
  static_cast<void>(minimize(pso, noting, box, {.max_generations = 0}, 4, two));
  EXPECT_EQ(elsewhere, 5);
}

TEST(Minimize, ValuesThatAreNotFiniteAreTheWorst) {
  for (const double unusable : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity()}) {
    const auto half = [&](const VectorX& x) { return x(0) < 0 ? unusable : sphere(x) + 1; };
    const SearchResult result = minimize(pso, half, box);
    EXPECT_GE(result.best(0), 0);
    EXPECT_GE(result.best_fitness, 1);
    EXPECT_LT(result.best_fitness, 1.1);
    const auto nowhere = [&](const VectorX&) { return unusable; };
    const SearchResult none = minimize(pso, nowhere, box);
    EXPECT_EQ(none.best_fitness, std::numeric_limits<double>::infinity());
    EXPECT_TRUE(none.best.allFinite());
    EXPECT_EQ(none.evaluations, 510);
  }
}

TEST(Minimize, ExceptionsOfTheObjectiveArrive) {
  const auto throwing = [](const VectorX& x) -> double {
    if (x(0) > 0) throw std::runtime_error("objective");
    return 0;
  };
  const ThreadExecutor two(2);
  EXPECT_THROW(minimize(pso, throwing, box), std::runtime_error);
  EXPECT_THROW(minimize(pso, throwing, box, {}, 0, two), std::runtime_error);
}

// What a box must be is tested beside it.
TEST(Minimize, RefusesBadBoxesWithTheNumbers) {
  EXPECT_EQ(complaint([] {
              (void)minimize(pso, sphere, Box{Eigen::Vector2d(0, 3), Eigen::Vector2d(1, 2.5)});
            }),
            "Box: dimension 1 has bounds [3, 2.5], must be finite and lower below upper");
}

TEST(Minimize, ResumesNoSearchInABoxThatIsNone) {
  auto search = start_search(pso, sphere, box, 1);
  EXPECT_EQ(complaint([&] { static_cast<void>(minimize(pso, sphere, Box::cube(2, -2, 2), search)); }),
            "minimize: the best point of the search has 3 entries, the box 2");
  Box reversed = box;
  reversed.lower(1) = 3;
  EXPECT_EQ(complaint([&] { static_cast<void>(minimize(pso, sphere, reversed, search)); }).rfind("Box: dimension 1", 0),
            0u);
  EXPECT_EQ(search.state.generation, 0);
}

TEST(Minimize, RefusesUnusableStops) {
  EXPECT_NE(complaint([] { static_cast<void>(minimize(pso, sphere, box, {.max_evaluations = 0})); }).find("is 0"),
            std::string::npos);
  EXPECT_NE(complaint([] { static_cast<void>(minimize(pso, sphere, box, {.patience = -2})); }).find("-2"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::minimize_test
