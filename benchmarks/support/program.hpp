// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the benchmarks share: a command line, a table of medians, and ratios to peers measured in the same run.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "vernier/evaluation/quantile.hpp"

namespace bench {

/// Median and quartiles of the repetitions of one benchmark, time of one call [ns].
struct Timing {
  double lower_quartile = 0, median = 0, upper_quartile = 0;
  bool wall = false;  ///< of the clock on the wall, not of the processor
};

/// A duration in a unit that suits it.
inline std::string duration(double nanoseconds) {
  const auto [unit, size] = nanoseconds < 1e3   ? std::pair{"ns", 1.0}
                            : nanoseconds < 1e6 ? std::pair{"us", 1e3}
                            : nanoseconds < 1e9 ? std::pair{"ms", 1e6}
                                                : std::pair{"s", 1e9};
  char text[32];
  std::snprintf(text, sizeof text, "%.4g %s", nanoseconds / size, unit);
  return text;
}

/// Repetitions in, quartiles out.
class Reporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override {
    PrintBasicContext(&GetErrorStream(), context);
    return true;
  }

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<double> times;
    const bool wall = runs.front().run_name.time_type == "real_time";
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration && run.iterations > 0)
        times.push_back((wall ? run.real_accumulated_time : run.cpu_accumulated_time) /
                        static_cast<double>(run.iterations) * 1e9);
    if (times.empty()) return;
    const Eigen::Map<const vernier::VectorX> all(times.data(), static_cast<vernier::Index>(times.size()));
    const auto quantile = [&](double probability) { return vernier::quantile(all, probability); };
    const Timing timing{quantile(0.25), quantile(0.5), quantile(0.75), wall};
    timings_.insert_or_assign(runs.front().run_name.function_name, timing);
  }

  const std::map<std::string, Timing>& timings() const { return timings_; }

 private:
  std::map<std::string, Timing> timings_;
};

/// One benchmark program. What it measures is called `topic/who`; where who is `vernier` and others measured the same
/// topic, the run ends with the ratio of each of them to it.
class Program {
 public:
  /// @param about the text of `--help` before the options
  explicit Program(std::string about) : about_(std::move(about)) {}

  /// Adds a benchmark: `call(i)` with i = 0, 1, ... is timed, and what it returns is kept from being optimised away.
  template <class Call>
  void measure(const std::string& topic, const std::string& who, Call call) {
    add(topic, who, call);
  }

  /// The same by the clock on the wall, for what works on several threads.
  template <class Call>
  void measure_wall(const std::string& topic, const std::string& who, Call call) {
    add(topic, who, call)->UseRealTime();
  }

  /// Runs everything, prints the ratios.
  /// @param repetitions of each, unless the command line gives another number
  /// @return 0, or 2 for wrong usage
  int run(int argc, char** argv, int repetitions = 9) {
    // Defaults come first, so that the user's own options win.
    std::string defaults[] = {"--benchmark_repetitions=" + std::to_string(repetitions), "--benchmark_min_time=0.05",
                              "--benchmark_enable_random_interleaving=true"};
    std::vector<char*> arguments{argv[0]};
    for (std::string& argument : defaults) arguments.push_back(argument.data());
    arguments.insert(arguments.end(), argv + 1, argv + argc);
    int count = static_cast<int>(arguments.size());
    benchmark::Initialize(&count, arguments.data());
    if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
    benchmark::RunSpecifiedBenchmarks(&reporter_);
    print_table();
    print_ratios();
    return 0;
  }

  /// Prints the help where the command line requests it.
  bool wants_help(int argc, char** argv) const {
    for (int i = 1; i < argc; ++i) {
      if (std::strcmp(argv[i], "--help") != 0 && std::strcmp(argv[i], "-h") != 0) continue;
      std::printf("%s\n%s", about_.c_str(), R"(
Repetitions of all benchmarks are run in random order. The table gives the median and the quartiles of the processor
time of one call, or of the time on the wall where it says so. At the end stands, for every peer, its median divided by
Vernier's (above 1: Vernier is faster); in brackets what the quartiles make of it at worst and at best.

options (of Google Benchmark)
  --benchmark_filter=REGEX      only the benchmarks whose name topic/who matches
  --benchmark_list_tests        names only
  --benchmark_repetitions=N     default 9, of what takes seconds 3
  --benchmark_min_time=SECONDS  of one repetition, default 0.05
  --benchmark_out=FILE          all repetitions as JSON
  --help                        this text
)");
      return true;
    }
    return false;
  }

  /// Median of a benchmark [ns]; 0 where it was not run.
  double median(const std::string& topic, const std::string& who) const {
    const auto found = reporter_.timings().find(topic + "/" + who);
    return found == reporter_.timings().end() ? 0 : found->second.median;
  }

 private:
  template <class Call>
  benchmark::internal::Benchmark* add(const std::string& topic, const std::string& who, Call call) {
    topics_.emplace_back(topic, who);
    return benchmark::RegisterBenchmark((topic + "/" + who).c_str(), [call](benchmark::State& state) mutable {
      std::size_t i = 0;
      for (auto _ : state) {
        auto result = call(i++);
        benchmark::DoNotOptimize(result);
      }
    });
  }

  void print_table() const {
    if (reporter_.timings().empty()) return;
    std::printf("%-50s %12s   %s\n", "processor time of one call", "median", "quartiles");
    for (const auto& [topic, who] : topics_) {
      const auto found = reporter_.timings().find(topic + "/" + who);
      if (found == reporter_.timings().end()) continue;
      const auto& [lower, median, upper, wall] = found->second;
      std::printf("%-50s %12s   %s .. %s%s\n", found->first.c_str(), duration(median).c_str(), duration(lower).c_str(),
                  duration(upper).c_str(), wall ? "   (wall)" : "");
    }
  }

  void print_ratios() const {
    bool titled = false;
    for (const auto& [topic, who] : topics_) {
      const auto ours = reporter_.timings().find(topic + "/vernier"),
                 peer = reporter_.timings().find(topic + "/" + who);
      if (who == "vernier" || ours == reporter_.timings().end() || peer == reporter_.timings().end()) continue;
      if (!std::exchange(titled, true)) std::printf("\nratio of the peer's time to Vernier's\n");
      const Timing &a = ours->second, &b = peer->second;
      std::printf("ratio  %-26s %-30s %7.2f  [%.2f .. %.2f]\n", topic.c_str(), who.c_str(), b.median / a.median,
                  b.lower_quartile / a.upper_quartile, b.upper_quartile / a.lower_quartile);
    }
  }

  std::string about_;
  std::vector<std::pair<std::string, std::string>> topics_;
  Reporter reporter_;
};

/// Stops a program whose peers do not compute the same: their times would mean nothing.
inline void require_agreement(const char* what, double difference, double tolerance) {
  if (difference <= tolerance) return;
  char text[200];
  std::snprintf(text, sizeof text, "%s differ by %.3g, which is more than %.3g", what, difference, tolerance);
  throw std::runtime_error(text);
}

/// Runs a benchmark's `main`: help, then `work`; an exception becomes one line and exit code 1.
template <class Work>
int run_program(const char* about, int argc, char** argv, Work&& work) {
  Program program(about);
  if (program.wants_help(argc, argv)) return 0;
  try {
    return work(program);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace bench
