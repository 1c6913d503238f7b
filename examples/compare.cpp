// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Learners and searches on equal terms: a grid of problems, methods, numbers of poses and seeds, its tables, tests and
/// figures.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <thread>
#include <tuple>

#include "cli.hpp"
#include "comparison.hpp"
#include "figures.hpp"
#include "progress.hpp"
#include "ranks.hpp"
#include "results.hpp"
#include "vernier/core/argsort.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/evaluation/rank_tests.hpp"

namespace {

namespace vn = vernier;
using namespace support;

/// Outcomes of a whole grid. Several ranks share what is missing; in the end the first has it all.
class Grid {
 public:
  /// @throws std::runtime_error where ranks differ in what they were given
  Grid(const Plan& plan, const Results& results, const Ranks& ranks) : plan_(plan), ranks_(ranks) {
    for (std::size_t p = 0; p < plan.problems.size(); ++p)
      for (const vn::Index poses : plan.poses)
        for (const std::uint64_t seed : plan.seeds)
          for (std::size_t m = 0; m < plan.methods.size(); ++m) cells_.push_back({p, m, poses, seed});
    std::string keys, there;
    for (const Cell& cell : cells_) {
      outcomes_.push_back(results.find(plan, cell));
      keys += cell_key(plan, cell);
      there += outcomes_.back() ? '1' : '0';
    }
    for (const std::string& digest : ranks.gather(vn::sha256(keys)))
      if (digest != vn::sha256(keys)) throw std::runtime_error("ranks read different files of the same name");
    const std::vector<std::string> known = ranks.gather(there);
    for (std::size_t c = 0; c < cells_.size(); ++c)
      if (std::all_of(known.begin(), known.end(), [&](const std::string& of) { return of[c] == '0'; }))
        missing_.push_back(c);
  }

  std::size_t cells() const { return cells_.size(); }
  /// Of all ranks.
  std::size_t missing() const { return missing_.size(); }

  std::size_t failed() const {
    return static_cast<std::size_t>(
        std::count_if(outcomes_.begin(), outcomes_.end(), [](const auto& o) { return o && o->failed(); }));
  }

  /// Computes what is missing, several cells at a time; what is done is kept whatever happens next, and what failed is
  /// not, so that it is tried again.
  void compute_missing(Results& results, int threads) {
    ranks_.together([&] { compute(share(), results, threads); });
    if (ranks_.many()) collect(results);
  }

  /// Outcomes of one method on one problem, by seed.
  std::vector<const Outcome*> of(std::size_t problem, std::size_t method, vn::Index poses) const {
    std::vector<const Outcome*> out;
    for (std::size_t c = 0; c < cells_.size(); ++c)
      if (cells_[c].problem == problem && cells_[c].method == method && cells_[c].poses == poses)
        out.push_back(&*outcomes_[c]);
    return out;
  }

 private:
  /// This rank's share. Dealt like cards, cells of one method after another, so that each rank has as many slow ones.
  std::vector<std::size_t> share() const {
    std::vector<std::size_t> order = missing_, out;
    if (ranks_.many())
      std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const auto rank_of = [&](std::size_t c) {
          return std::tuple(cells_[c].method, cells_[c].problem, cells_[c].poses, c);
        };
        return rank_of(a) < rank_of(b);
      });
    for (std::size_t k = 0; k < order.size(); ++k)
      if (static_cast<int>(k % static_cast<std::size_t>(ranks_.count())) == ranks_.rank()) out.push_back(order[k]);
    return out;
  }

  void compute(const std::vector<std::size_t>& cells, Results& results, int threads) {
    ProgressBar bar(ranks_.many() ? "cells of the first rank" : "cells", static_cast<vn::Index>(cells.size()));
    std::atomic<std::size_t> next = 0;
    vn::Index done = 0;
    std::mutex mutex;
    std::exception_ptr broken;
    const auto work = [&] {
      for (std::size_t k; (k = next++) < cells.size();) {
        const std::size_t c = cells[k];
        Outcome outcome;
        try {
          outcome = support::compute(plan_, cells_[c]);
        } catch (const std::bad_alloc&) {
          outcome.failure = "out of memory";
        } catch (const std::exception& error) {
          outcome.failure = error.what();
        }
        const std::lock_guard lock(mutex);
        try {
          if (!outcome.failed()) results.add(plan_, cells_[c], outcome);
        } catch (...) {
          if (!broken) broken = std::current_exception();
          next = cells.size();
          return;
        }
        outcomes_[c] = std::move(outcome);
        bar.update(++done, plan_.methods[cells_[c].method].text);
      }
    };
    std::vector<std::thread> others;
    for (int t = 1; t < threads; ++t) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    if (broken) std::rethrow_exception(broken);
  }

  /// Sends what the other ranks have to the first, which keeps it; then their own files are not needed any more.
  void collect(Results& results) {
    Json mine = Json::array();
    for (std::size_t c = 0; c < cells_.size() && !ranks_.first(); ++c)
      if (outcomes_[c]) mine.push_back({c, to_json(*outcomes_[c])});
    const std::vector<std::string> all = ranks_.gather(mine.dump(-1, ' ', false, Json::error_handler_t::replace));
    ranks_.together([&] {
      for (std::size_t r = 1; r < all.size() && ranks_.first(); ++r)
        for (const nlohmann::json& one : nlohmann::json::parse(all[r])) {
          const auto c = one[0].get<std::size_t>();
          if (outcomes_[c]) continue;
          outcomes_[c] = outcome_from_json(one[1]);
          if (!outcomes_[c]->failed()) results.add(plan_, cells_[c], *outcomes_[c]);
        }
    });
    if (!ranks_.first()) results.remove();
  }

  const Plan& plan_;
  const Ranks& ranks_;
  std::vector<Cell> cells_;
  std::vector<std::optional<Outcome>> outcomes_;
  std::vector<std::size_t> missing_;  // cells
};

constexpr double infinity = std::numeric_limits<double>::infinity();

/// One number of each outcome; infinite where it failed.
template <class Of>
vn::VectorX values(const std::vector<const Outcome*>& outcomes, const Of& of) {
  vn::VectorX out(static_cast<vn::Index>(outcomes.size()));
  for (std::size_t k = 0; k < outcomes.size(); ++k)
    out(static_cast<vn::Index>(k)) = outcomes[k]->failed() ? infinity : of(*outcomes[k]);
  return out;
}

/// A method's line in a table.
struct Row {
  std::size_t method;
  vn::VectorX mean;  ///< by seed
  double median, lower, upper, p95, max, seconds, p_value = 1;
  vn::Index failures;
};

/// All methods on one problem, best first, and whether the others differ from the best: paired over seeds, corrected
/// for as many tests as there are.
std::vector<Row> ranked(const Grid& grid, const Plan& plan, std::size_t problem, vn::Index poses) {
  std::vector<Row> rows;
  for (std::size_t m = 0; m < plan.methods.size(); ++m) {
    const auto outcomes = grid.of(problem, m, poses);
    const vn::VectorX mean = values(outcomes, [](const Outcome& o) { return o.mean; });
    const auto median_of = [&](const auto& of) { return vn::quantile(values(outcomes, of), 0.5); };
    rows.push_back({m, mean, vn::quantile(mean, 0.5), vn::quantile(mean, 0.25), vn::quantile(mean, 0.75),
                    median_of([](const Outcome& o) { return o.p95; }),
                    median_of([](const Outcome& o) { return o.max; }),
                    median_of([](const Outcome& o) { return o.seconds; }), 1,
                    static_cast<vn::Index>(std::count_if(outcomes.begin(), outcomes.end(),
                                                         [](const Outcome* o) { return o->failed(); }))});
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.median < b.median; });
  if (plan.seeds.size() < 2 || rows.size() < 2) return rows;
  vn::VectorX p(static_cast<vn::Index>(rows.size()) - 1);
  for (std::size_t k = 1; k < rows.size(); ++k)
    p(static_cast<vn::Index>(k) - 1) = vn::signed_rank_test(rows[k].mean, rows[0].mean).p_value;
  const vn::VectorX corrected = vn::holm(p);
  for (std::size_t k = 1; k < rows.size(); ++k) rows[k].p_value = corrected(static_cast<vn::Index>(k) - 1);
  return rows;
}

std::string poses_words(vn::Index poses) { return poses == 0 ? "all poses" : fmt::format("{} poses", poses); }

void print_table(const Grid& grid, const Plan& plan, std::size_t problem, vn::Index poses) {
  const auto before = grid.of(problem, 0, poses);
  fmt::print("{}, {} to learn from, {} seed{}; without learning {:.4g} mm\n", plan.problems[problem].name,
             poses_words(poses), plan.seeds.size(), plan.seeds.size() == 1 ? "" : "s",
             vn::quantile(values(before, [](const Outcome& o) { return o.before; }), 0.5));
  fmt::print("  {:<33} {:>9}  {:<21} {:>9} {:>9} {:>8} {:>8}\n", "mean error [mm]", "median", "quartiles", "p95", "max",
             "seconds", "p");
  bool first = true;
  for (const Row& row : ranked(grid, plan, problem, poses)) {
    fmt::print("  {:<33} {:>9.4g}  {:<21} {:>9.4g} {:>9.4g} {:>8.3g} {:>8}{}\n", plan.methods[row.method].text,
               row.median, fmt::format("[{:.4g}, {:.4g}]", row.lower, row.upper), row.p95, row.max, row.seconds,
               first || plan.seeds.size() < 2 ? "" : fmt::format("{:.2g}", row.p_value),
               row.failures > 0 ? fmt::format("  ({} failed: {})", row.failures,
                                              [&] {
                                                for (const Outcome* o : grid.of(problem, row.method, poses))
                                                  if (o->failed()) return o->failure;
                                                return std::string();
                                              }())
                                : "");
    first = false;
  }
  fmt::print("\n");
}

/// Cases x methods: mean errors of every problem, number of poses and seed.
vn::MatrixX all_cases(const Grid& grid, const Plan& plan) {
  const auto seeds = static_cast<vn::Index>(plan.seeds.size()), methods = static_cast<vn::Index>(plan.methods.size());
  vn::MatrixX out(seeds * static_cast<vn::Index>(plan.problems.size() * plan.poses.size()), methods);
  for (vn::Index m = 0; m < methods; ++m) {
    vn::Index at = 0;
    for (std::size_t p = 0; p < plan.problems.size(); ++p)
      for (const vn::Index poses : plan.poses) {
        out.col(m).segment(at, seeds) =
            values(grid.of(p, static_cast<std::size_t>(m), poses), [](const Outcome& o) { return o.mean; });
        at += seeds;
      }
  }
  return out;
}

void print_ranks(const Plan& plan, const vn::MatrixX& cases) {
  const vn::VectorX ranks = vn::average_ranks(cases);
  fmt::print(
      "Average rank over {} cases (1 is best; two differ by Nemenyi's test where their ranks are {:.2f} apart)\n",
      cases.rows(), vn::critical_difference(cases.cols(), cases.rows()));
  for (const vn::Index m : vn::argsort(ranks))
    fmt::print("  {:<34}{:>10.2f}\n", plan.methods[static_cast<std::size_t>(m)].text, ranks(m));
  fmt::print("\n");
}

// --- figures ---------------------------------------------------------------------------------------------------------

/// A file name of a problem's name.
std::string slug(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (plain) out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!plain && !out.empty() && out.back() != '_') out += '_';
  }
  return out;
}

/// The outcome whose mean error is the median of all.
const Outcome* typical(std::vector<const Outcome*> outcomes) {
  std::erase_if(outcomes, [](const Outcome* o) { return o->failed(); });
  if (outcomes.empty()) return nullptr;
  std::stable_sort(outcomes.begin(), outcomes.end(),
                   [](const Outcome* a, const Outcome* b) { return a->mean < b->mean; });
  return outcomes[(outcomes.size() - 1) / 2];
}

std::vector<std::string> draw(const Grid& grid, const Plan& plan, const vn::MatrixX& cases,
                              const std::filesystem::path& folder) {
  std::vector<std::string> files;
  const auto keep = [&](bool drawn, const std::filesystem::path& path) {
    if (drawn) files.push_back(path.string());
  };
  const auto plot = [&](const std::string& file, const std::string& title, const char* x, const char* y,
                        std::vector<Series> series, const FigureOptions& options) {
    // what no logarithmic axis shows, e.g. errors of nothing at all
    std::erase_if(series, [&](const Series& s) {
      for (std::size_t i = 0; i < s.x.size(); ++i)
        if ((s.x[i] > 0 || !options.log_x) && (s.y[i] > 0 || !options.log_y)) return false;
      return true;
    });
    if (!series.empty()) keep(plot_svg(folder / file, title, x, y, series, options), folder / file);
  };
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const std::string& name = plan.problems[p].name;
    std::vector<Series> learning, distribution;
    std::map<std::string, std::array<std::vector<Series>, 2>> convergence;  // by learner: each has a fitness of its own
    for (std::size_t m = 0; m < plan.methods.size(); ++m) {
      const std::string& method = plan.methods[m].text;
      Series curve{.name = method, .x = {}, .y = {}};
      for (const vn::Index poses : plan.poses) {
        const auto outcomes = grid.of(p, m, poses);
        const auto median = [&](const auto& of) { return vn::quantile(values(outcomes, of), 0.5); };
        const double error = median([](const Outcome& o) { return o.mean; });
        if (!std::isfinite(error)) continue;
        curve.x.push_back(median([](const Outcome& o) { return o.learned_from; }));
        curve.y.push_back(error);
      }
      if (!curve.x.empty() && plan.poses.size() > 1) learning.push_back(curve);
      const Outcome* one = typical(grid.of(p, m, plan.poses.back()));
      if (one == nullptr) continue;
      Series shares{.name = method, .x = one->quantiles, .y = {}};
      for (std::size_t k = 0; k < shares.x.size(); ++k) shares.y.push_back(5.0 * static_cast<double>(k));
      if (!shares.x.empty()) distribution.push_back(shares);
      if (one->convergence.best.empty()) continue;
      const Method& searched = plan.methods[m];
      auto& [by_evaluations, by_seconds] =
          convergence[(searched.base.empty() ? "" : searched.base + "+") + searched.learner +
                      (searched.map.empty() ? "" : "@" + searched.map)];
      by_evaluations.push_back({.name = method, .x = one->convergence.evaluations, .y = one->convergence.best});
      by_seconds.push_back({.name = method, .x = one->convergence.seconds, .y = one->convergence.best});
    }
    const std::string at = slug(name);
    plot("learning_" + at + ".svg", name + ": error by number of poses, median of seeds", "poses to learn from",
         "mean error [mm]", learning, {.log_x = true, .log_y = true});
    plot("errors_" + at + ".svg", name + ": distribution of the error, " + poses_words(plan.poses.back()),
         "position error [mm]", "share of poses [%]", distribution, {.log_x = true});
    for (const auto& [learner, curves] : convergence) {
      const std::string words = ", " + learner + ", " + poses_words(plan.poses.back());
      plot("convergence_" + at + "_" + slug(learner) + ".svg", name + ": convergence" + words, "evaluations",
           "best fitness [-]", curves[0], {.log_x = true, .log_y = true});
      plot("seconds_" + at + "_" + slug(learner) + ".svg", name + ": convergence in time" + words, "seconds",
           "best fitness [-]", curves[1], {.log_x = true, .log_y = true});
    }
  }
  if (plan.methods.size() > 1) {
    std::vector<Interval> ranks;
    const vn::VectorX average = vn::average_ranks(cases);
    for (const vn::Index m : vn::argsort(average))
      ranks.push_back({plan.methods[static_cast<std::size_t>(m)].text, average(m),
                       vn::critical_difference(cases.cols(), cases.rows()) / 2});
    const auto path = folder / "ranks.svg";
    keep(intervals_svg(path, fmt::format("Average ranks over {} cases: bars that do not overlap differ", cases.rows()),
                       "average rank, 1 is best", ranks),
         path);
  }
  return files;
}

/// All figures but times, which are never the same twice.
Json json(const Grid& grid, const Plan& plan, const vn::MatrixX& cases) {
  Json out{{"evaluations", plan.evaluations}, {"seeds", plan.seeds}, {"problems", Json::array()}};
  for (std::size_t p = 0; p < plan.problems.size(); ++p)
    for (const vn::Index poses : plan.poses) {
      Json table{{"problem", plan.problems[p].name}, {"poses", poses}, {"methods", Json::object()}};
      for (const Row& row : ranked(grid, plan, p, poses))
        table["methods"][plan.methods[row.method].text] = {
            {"median_mm", row.median},
            {"lower_quartile_mm", row.lower},
            {"upper_quartile_mm", row.upper},
            {"p95_mm", row.p95},
            {"max_mm", row.max},
            {"p", row.p_value},
            {"failures", row.failures},
            {"means_mm", std::vector<double>(row.mean.begin(), row.mean.end())}};
      out["problems"].push_back(table);
    }
  if (plan.methods.size() > 1) {
    const vn::VectorX average = vn::average_ranks(cases);
    for (std::size_t m = 0; m < plan.methods.size(); ++m)
      out["average_ranks"][plan.methods[m].text] = average(static_cast<vn::Index>(m));
    out["critical_difference"] = vn::critical_difference(cases.cols(), cases.rows());
  }
  return out;
}

// --- command line ----------------------------------------------------------------------------------------------------

void list() {
  const auto print = [](const char* title, const std::vector<Named>& names) {
    fmt::print("{}\n", title);
    for (const Named& n : names) fmt::print("  {:<18}{}\n", n.name, n.title);
  };
  print("classical methods", classical_names());
  print("learners: [geometry+|jointwise+][SEARCH:]LEARNER[@MAP]; MAP is raw, sincos or products", learner_names());
  print("searches, for elm, ridge_elm and var_pro_elm", search_names());
}

/// What is asked for.
struct Request {
  Plan plan;
  bool planned = false, listed = false;
  std::vector<std::filesystem::path> merged;
  std::filesystem::path results;
};

Request read_command_line(Program& program) {
  Request out;
  Problem problem;
  Plan& plan = out.plan;
  std::string plan_file;
  std::vector<std::string> methods;
  program.add_option("plan", plan_file, "the whole grid as a JSON file, in place of the options up to --nodes",
                     "PLAN.json");
  program.add_flag("--list", out.listed, "print all methods, and how they are written");
  program.add_option("--methods", methods, "what to compare, see --list", "M,...").delimiter(',');
  program.add_setting("--robot", problem.robot, "an arm of the catalogue, or a JSON file", "R");
  program.add_setting("--errors", problem.errors, "errors of a simulated arm; full: joint errors too",
                      "geometric|full");
  program.add_option(
      "--region", problem.region,
      "joint ranges of simulated poses: operating (of the abb_irb120, and its default) or full, the joint limits",
      "operating|full");
  program.add_setting("--noise-mm", problem.noise_mm, "standard deviation of simulated positions, per component", "S");
  program.add_option("--data", problem.data, "measured poses instead", "FILE");
  problem.csv.add_to(program, "", "--data");
  program.group(support::Group::validation);
  program.add_setting("--split", problem.split, "which fifth of the measured poses is held out", "random|region|time");
  program.group(support::Group::input);
  program.add_setting("--poses", plan.poses, "to learn from; 0: all measured ones", "N,...").delimiter(',');
  program.add_setting("--seeds", plan.seeds, "seeds of data and fits", "S,...").delimiter(',');
  program.group(support::Group::model);
  program.add_setting("--evaluations", plan.evaluations, "evaluations that each search has", "E");
  program.add_setting("--seconds", plan.seconds,
                      "seconds that each search and iterative fit has instead; 0: by evaluations", "T");
  program.add_setting("--nodes", plan.nodes, "nodes of hidden layers", "H");
  program.group(support::Group::output);
  program
      .add_option("--results", out.results, "file that keeps every cell; a run goes on where another one stopped",
                  "FILE")
      .default_text("OUT/results.jsonl");
  program.add_option("--merge", out.merged, "add the cells of these results files first; without a plan that is all",
                     "FILE");
  program.parse("compare_out");
  if (!plan_file.empty() && !methods.empty()) throw UsageError("a plan and --methods exclude each other");
  out.planned = !plan_file.empty() || !methods.empty();
  if (out.listed) return out;
  if (!out.planned && out.merged.empty()) throw UsageError("--methods or a plan is needed; --list names all methods");
  if (!plan_file.empty()) {
    plan = Plan::read(plan_file);
  } else {
    for (const std::string& m : methods) plan.methods.push_back(Method::parse(m));
    problem.name = problem.measured() ? problem.data.stem().string() : problem.robot;
    plan.problems.push_back(problem);
  }
  if (out.results == "-") throw UsageError("--results takes a file that grows, which cannot be standard output");
  if (out.planned || out.results.empty()) program.require_output_folder();
  if (out.planned) plan.prepare();
  if (out.results.empty()) out.results = program.output_folder() / "results.jsonl";
  return out;
}

int compare(Program& program, const Ranks& ranks) {
  Request request;
  std::optional<Results> opened;
  ranks.together([&] { request = read_command_line(program); });
  if (request.listed) {
    list();
    return 0;
  }
  // the first rank takes in what others left, before these begin anew
  ranks.together([&] {
    if (!ranks.first()) return;
    if (!request.merged.empty()) {
      for (const std::string& sentence : merge_results(request.merged, request.results)) fmt::print("{}\n", sentence);
    }
    if (request.planned) opened.emplace(request.results);
  });
  if (!request.planned) return 0;
  ranks.together([&] {
    if (!ranks.first()) opened.emplace(request.results, ranks.rank());
  });
  const Plan& plan = request.plan;
  Results& results = *opened;
  Grid grid(plan, results, ranks);
  if (const std::size_t here = grid.cells() - grid.missing(); !request.merged.empty() && results.size() > here)
    fmt::print("{} of the cells in it belong to other plans\n", results.size() - here);
  fmt::print("{} cells, {} of them to be computed{}\n\n", grid.cells(), grid.missing(),
             ranks.many() ? fmt::format(" by {} ranks", ranks.count()) : "");
  std::fflush(stdout);
  // a rank is a processor, unless it is said otherwise
  const bool alone = !ranks.many() || program.given("--threads");
  grid.compute_missing(results, alone ? program.common().threads : 1);
  if (!ranks.first()) return 0;

  const std::filesystem::path folder = program.output_folder();
  for (std::size_t p = 0; p < plan.problems.size(); ++p)
    for (const vn::Index poses : plan.poses) print_table(grid, plan, p, poses);
  fmt::print(
      "Methods in the order of their median over seeds. p: Wilcoxon's signed-rank test against the first, over the "
      "same\n"
      "seeds, corrected by Holm for the number of methods. p95, max and seconds are medians over seeds.\n\n");
  const vn::MatrixX cases = all_cases(grid, plan);
  if (plan.methods.size() > 1) print_ranks(plan, cases);
  if (!program.common().json.empty()) write_json(program.common().json, json(grid, plan, cases));
  const auto files = draw(grid, plan, cases, folder);
  if (!files.empty()) fmt::print("Figures: {}\n", fmt::join(files, ", "));
  if (grid.failed() > 0)
    throw std::runtime_error(
        fmt::format("{} of {} cells failed; the same command tries them again", grid.failed(), grid.cells()));
  return 0;
}

int body(Program& program) {
  const Ranks ranks;
  try {
    return compare(program, ranks);
  } catch (...) {
    if (ranks.first()) throw;
    return 0;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{"compare",
                             "Compares learners and searches on equal terms: the same poses, budget and seeds for all.",
                             {"compare --methods geometry,geometry+elm,pso:elm --seeds 1,2,3 --out comparison",
                              "compare --data measured.csv --robot ur10 --methods jointwise,jointwise+pso:elm"},
                             "done; a run that was stopped goes on where it was"};
  return support::run_program(about, argc, argv, body);
}
