// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The laws of `Executor`, checked at run time: a list of violations.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "vernier/core/same_value.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/testing/same_bits.hpp"

namespace vernier::testing {

namespace detail {

/// Checks one executor. It makes the same calls whatever it finds, so that processes stay synchronised.
template <Executor E>
class ExecutorCheck {
 public:
  explicit ExecutorCheck(E& executor) : executor_(executor), reference_(executor) {}

  std::vector<std::string> run() {
    try {
      coverage();
      range_exceptions();
      gathering();
      gather_exceptions();
      broadcasts();
      searches();
    } catch (const std::exception& error) {
      violations_.push_back(message("executor: threw on good work: ", error.what()));
    }
    return std::move(violations_);
  }

 private:
  void expect(bool holds, const std::string& law) {
    if (!holds) violations_.push_back("executor: " + law);
  }

  void coverage() {
    for (const Index n : {0, 1, 2, 3, 7, 8, 9, 100, 1001}) {
      const std::unique_ptr<std::atomic<int>[]> seen(new std::atomic<int>[static_cast<std::size_t>(n) + 1]());
      std::atomic<int> unusable = 0, running = 0;
      executor_.for_ranges(n, [&](Index begin, Index end) {
        ++running;
        if (begin < 0 || begin >= end || end > n) ++unusable;
        // The last range is slow, which detects an executor that does not wait for it.
        if (end == n) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        for (Index i = std::max<Index>(begin, 0); i < (std::min)(end, n); ++i) ++seen[static_cast<std::size_t>(i)];
        --running;
      });
      expect(running == 0, message("returned before all work was done, n = ", n));
      expect(unusable == 0, message("an empty range or one outside 0..n, n = ", n));
      bool once = true;
      for (Index i = 0; i < n; ++i) once = once && seen[static_cast<std::size_t>(i)] == 1;
      expect(once, message("the ranges do not cover 0..n exactly once, n = ", n));
    }
  }

  void range_exceptions() {
    for (const Index culprit : {0, 5, 99}) {
      std::atomic<int> running = 0;
      std::string caught = "nothing";
      try {
        executor_.for_ranges(100, [&](Index begin, Index end) {
          ++running;
          std::this_thread::sleep_for(std::chrono::microseconds(200));
          --running;
          if (begin <= culprit && culprit < end) throw std::out_of_range("culprit");
        });
      } catch (const std::out_of_range& error) {
        caught = error.what();
      } catch (...) {
        caught = "something else";
      }
      expect(caught == "culprit", message("of an exception at ", culprit, " was rethrown: ", caught));
      expect(running == 0, message("an exception at ", culprit, " was rethrown while others still worked"));
    }
  }

  void gathering() {
    for (const Index n : {0, 1, 2, 3, 10, 101}) {
      VectorX values = VectorX::Zero(n), right(n);
      const auto value = [](Index i) { return 1 / (static_cast<double>(i) + 3); };
      for (Index i = 0; i < n; ++i) right(i) = value(i);
      reference_.allgather(values, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) values(i) = value(i);
      });
      expect(same_bits(values, right), message("values are missing or wrong after allgather, n = ", n));
    }
  }

  void gather_exceptions() {
    for (const Index culprit : {0, 5, 9}) {
      bool caught = false;
      VectorX values = VectorX::Zero(10);
      try {
        reference_.allgather(values, [&](Index begin, Index end) {
          if (begin <= culprit && culprit < end) throw std::out_of_range("culprit");
        });
      } catch (const std::exception&) {
        caught = true;
      }
      expect(caught, message("an exception at value ", culprit, " was not rethrown by allgather"));
    }
    gathering();  // and still works
  }

  void broadcasts() {
    const auto caller = std::this_thread::get_id();
    bool elsewhere = false;
    for (const bool value : {true, false}) {
      const bool received = reference_.broadcast([&] {
        elsewhere = elsewhere || std::this_thread::get_id() != caller;
        return value;
      });
      expect(received == value, message("a broadcast of ", value, " returned ", received));
    }
    expect(!elsewhere, "a condition to broadcast was evaluated on another thread");
    bool caught = false;
    try {
      static_cast<void>(reference_.broadcast([]() -> bool { throw std::out_of_range("condition"); }));
    } catch (const std::exception&) {
      caught = true;
    }
    expect(caught, "an exception of a condition to broadcast was not rethrown");
  }

  void searches() {
    const Box box = Box::cube(3, -2, 2);
    const auto scalar = [](const VectorX& x) { return (x.array() - 0.3).square().sum() + std::sin(9 * x(0)); };
    const auto batch = [&](const Eigen::Ref<const MatrixX>& population, Eigen::Ref<VectorX> fitness) {
      for (Index k = 0; k < population.cols(); ++k) fitness(k) = scalar(population.col(k));
    };
    const auto compare = [&](const auto& algorithm, const auto& objective, const char* name) {
      const SearchResult right = minimize(algorithm, objective, box, {}, 4);
      const SearchResult found = minimize(algorithm, objective, box, {}, 4, reference_);
      expect(same_bits(found.best, right.best) && same_value(found.best_fitness, right.best_fitness) &&
                 found.evaluations == right.evaluations && found.generations == right.generations,
             message("a search by ", name, " gives other bits than on one thread"));
    };
    const Pso pso{.particles = 11, .iterations = 15};
    compare(pso, scalar, "PSO");
    compare(pso, batch, "PSO");
    compare(GeneticAlgorithm{.individuals = 12, .generations = 15}, batch, "GA");
    const SearchResult stopped =
        minimize(pso, scalar, box, {}, 4, reference_, [](const Progress& progress) { return progress.generation < 4; });
    expect(stopped.generations == 4 && stopped.status == SearchStatus::observer_stopped,
           "an observer's stop had no effect");
  }

  E& executor_;
  ExecutorRef reference_;
  std::vector<std::string> violations_;
};

}  // namespace detail

/// Runs an executor through the laws of `Executor` and, where it is one, of `DistributedExecutor`:
///
/// - ranges are not empty and cover 0..n exactly once, and all work is done when the call returns;
/// - an exception is rethrown after all work has ended, and the executor can still be used;
/// - gathered values are complete and correct, in this and (where this is run in several) in all processes;
/// - a condition to broadcast is evaluated on the calling thread, and its value returned;
/// - searches give the same bits as on one thread.
/// @param executor all processes it distributes work over must call this together
/// @return one sentence per violation; empty when all laws hold
template <Executor E>
std::vector<std::string> executor_violations(E& executor) {
  return detail::ExecutorCheck<E>(executor).run();
}

}  // namespace vernier::testing
