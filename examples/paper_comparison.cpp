// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Repeats the experiment of Feng, Dong and Jin on a simulated ABB IRB 120: four learned compensations and the
/// classical identification, evaluated by sending the actual arm to the corrected joints.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "figures.hpp"
#include "json_file.hpp"
#include "progress.hpp"
#include "vernier/ceres.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/joint_space.hpp"
#include "vernier/core/argsort.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/var_pro_elm.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace {

namespace vn = vernier;
using support::Json;
using Chain = vn::DhChain<6>;
using Joints = vn::JointRows<6>;

/// One row of the tables.
struct Method {
  const char* name;                ///< in JSON
  const char* title;               ///< for people
  std::optional<double> paper[2];  ///< what the paper reports as reduction of the mean error: test set, random set [%]
};

constexpr std::array<Method, 8> methods{{
    {"uncompensated", "uncompensated", {}},
    {"joint_ga_elm", "joint-space GA-ELM", {69.48, 69.17}},
    {"joint_pso_elm", "joint-space PSO-ELM", {72.57, 71.58}},
    {"cartesian_ga_elm", "Cartesian GA-ELM", {92.60, 91.69}},
    {"cartesian_pso_elm", "Cartesian PSO-ELM", {95.06, 94.88}},
    {"cartesian_var_pro_elm", "Cartesian VarProElm", {}},
    {"cartesian_var_pro_elm_sin_cos", "  on sines and cosines", {}},
    {"identification", "identification", {}},
}};
/// A space, and the two searches that are compared in it.
struct Pair {
  const char* space;
  std::size_t ga, pso;
};
constexpr std::array<Pair, 2> pso_against_ga{{{"joint_space", 1, 2}, {"cartesian", 3, 4}}};
constexpr std::size_t trained = 5, identified_method = 7;  // the two from `trained` on are optional

/// The methods of a comparison, in order.
std::vector<std::size_t> methods_of(bool var_pro) {
  return var_pro ? std::vector<std::size_t>{0, 1, 2, 3, 4, trained, trained + 1, identified_method}
                 : std::vector<std::size_t>{0, 1, 2, 3, 4, identified_method};
}

struct PoseSet {
  const char* name;   ///< in JSON
  const char* title;  ///< for people
};
constexpr std::array<PoseSet, 2> sets{{{"test", "test set"}, {"random", "random set"}}};

enum class Region { operating, full };

struct Settings {
  vn::Index train = 5000, test = 400, fresh = 200, search_samples = 0;
  double budget = 1;  ///< factor of the paper's generations and iterations
  int runs = 1;
  Region region = Region::operating;
  vn::PositionRule positions = vn::PositionRule::unbounded;
  double noise = 0;  ///< of the measured positions [m]
  bool quick = false, var_pro = false;
  std::string poses_file;
};

/// Best fitness after a number of evaluations.
struct Convergence {
  std::vector<double> evaluations, best;
};

/// What one run found; index: set, method.
struct Run {
  std::uint64_t seed = 0;
  std::vector<std::size_t> ran;  ///< methods, in order
  std::array<std::array<vn::PositioningErrors, methods.size()>, sets.size()> errors;
  std::array<vn::PositioningErrors, sets.size()> full_pose;  ///< identification, aimed at the full pose
  std::array<double, methods.size()> seconds{};
  std::array<Convergence, methods.size()> convergence;
  vn::Index failed_labels = 0;
  std::string identification_remark;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

vn::Index scaled(vn::Index generations, double factor) {
  return std::max<vn::Index>(1, std::llround(static_cast<double>(generations) * factor));
}

// --- the experiment --------------------------------------------------------------------------------------------------

/// The joint combinations of a run: uniform in the region, each purpose with a stream of its own.
Joints sample(const vn::Robot<6>& robot, Region region, vn::Index n, std::uint64_t seed) {
  if (region == Region::full) return vn::sample_joints(robot.limits, n, seed);
  return vn::abb_irb120_operating_region().sample(robot.chain, n, seed);
}

enum Stream : std::uint64_t {
  joints_stream,
  fresh_stream,
  noise_stream,
  search_stream,
  poses_stream,
  run_stream = 1000
};

class Experiment {
 public:
  Experiment(const vn::Robot<6>& robot, const Settings& settings, std::uint64_t seed, int threads, std::string prefix)
      : settings_(settings),
        nominal_(robot.chain),
        actual_(vn::with_geometric_errors(robot.chain, {}, seed)),
        executor_(threads),
        prefix_(std::move(prefix)) {
    run_.seed = seed;
    run_.ran = methods_of(settings.var_pro);
    const Joints all =
        sample(robot, settings.region, settings.train + settings.test, vn::child_seed(seed, joints_stream));
    train_ = all.topRows(settings.train);  // the rows are independent draws: the first ones are a random choice
    targets_ = {all.bottomRows(settings.test),
                sample(robot, settings.region, settings.fresh, vn::child_seed(seed, fresh_stream))};
    measured_ = vn::measure(actual_, train_, {.position = settings.noise, .with_orientations = false},
                            vn::child_seed(seed, noise_stream));
  }

  Run run() {
    for (std::size_t set = 0; set < sets.size(); ++set)
      run_.errors[set][0] = vn::positioning_errors(actual_, nominal_, targets_[set], targets_[set]);

    // The paper's constants: hidden nodes; individuals and generations, or particles and iterations.
    const auto ga = [&](int individuals, vn::Index generations) {
      return vn::GeneticAlgorithm{.individuals = individuals, .generations = scaled(generations, settings_.budget)};
    };
    const auto pso = [&](int particles, vn::Index iterations) {
      return vn::Pso{
          .particles = particles, .iterations = scaled(iterations, settings_.budget), .positions = settings_.positions};
    };
    const auto tuned = [&](int nodes, const auto& algorithm) {
      return vn::Tuned{vn::Elm{.hidden_nodes = nodes}, algorithm, vn::StoppingCriteria{}, settings_.search_samples};
    };
    joint_space(1, tuned(58, ga(100, 350)), scaled(350, settings_.budget));
    joint_space(2, tuned(68, pso(40, 300)), scaled(300, settings_.budget));
    cartesian(3, tuned(73, ga(80, 400)), scaled(400, settings_.budget));
    cartesian(4, tuned(65, pso(50, 300)), scaled(300, settings_.budget));
    if (settings_.var_pro) {  // as many nodes as PSO-ELM, and no search
      const vn::VarProElm raw{.hidden_nodes = 65, .input_map = vn::InputMap::raw};
      cartesian(trained, raw, raw.iterations);
      cartesian(trained + 1, vn::VarProElm{.hidden_nodes = 65}, raw.iterations);
    }
    identification(identified_method);
    return run_;
  }

 private:
  /// The paper corrects the position, with the first three joints.
  static constexpr vn::CorrectionOptions paper_correction{.target = vn::CorrectionTarget::position, .moving_joints = 3};

  /// Learns with a progress bar, a record of the convergence and a stop watch.
  template <class Fit>
  auto learn(std::size_t method, vn::Index generations, Fit&& fit) {
    support::ProgressBar bar(prefix_ + methods[method].title, generations);
    Convergence& record = run_.convergence[method];
    const auto observer = [&](const vn::Progress& progress) {
      record.evaluations.push_back(static_cast<double>(progress.evaluations));
      record.best.push_back(progress.best);
      bar(progress);
    };
    const auto start = std::chrono::steady_clock::now();
    auto fitted = fit(vn::FitOptions{
        .seed = vn::child_seed(run_.seed, search_stream + 100 * method), .executor = executor_, .observer = observer});
    run_.seconds[method] = seconds_since(start);
    return fitted;
  }

  template <class Regressor>
  void joint_space(std::size_t method, const Regressor& regressor, vn::Index generations) {
    judge(method, learn(method, generations, [&](const vn::FitOptions& options) {
            const auto labels = vn::joint_error_labels(nominal_, actual_, train_);
            run_.failed_labels = labels.failed;
            return vn::JointCompensation{regressor}.fit(nominal_, labels, options);
          }));
  }

  template <class Regressor>
  void cartesian(std::size_t method, const Regressor& regressor, vn::Index generations) {
    judge(method, learn(method, generations, [&](const vn::FitOptions& options) {
            return vn::CartesianCompensation{regressor, paper_correction}.fit(nominal_, measured_, options);
          }));
  }

  void identification(std::size_t method) {
    const auto identified = learn(method, 0, [&](const vn::FitOptions&) {
      return vn::identify(nominal_, measured_, {.frames = vn::Frames::none});
    });
    if (!identified.converged()) run_.identification_remark = identified.message;
    judge(method, vn::compensate(identified.model, paper_correction));
    const auto full = vn::compensate(identified.model, {.target = vn::CorrectionTarget::pose});
    for (std::size_t set = 0; set < sets.size(); ++set) run_.full_pose[set] = errors(full, targets_[set]);
  }

  template <vn::Compensator C>
  vn::PositioningErrors errors(const C& compensator, const Joints& targets) const {
    return vn::positioning_errors(actual_, nominal_, vn::corrected_commands(compensator, targets), targets);
  }

  template <vn::Compensator C>
  void judge(std::size_t method, const C& compensator) {
    for (std::size_t set = 0; set < sets.size(); ++set) run_.errors[set][method] = errors(compensator, targets_[set]);
  }

  const Settings& settings_;
  Chain nominal_, actual_;
  vn::ThreadExecutor executor_;
  std::string prefix_;
  Joints train_;
  std::array<Joints, sets.size()> targets_;
  vn::Dataset<6> measured_;
  Run run_;
};

/// Poses of the actual arm as a laser tracker would see them: in the tracker's frame, with a tool in the hand.
void write_poses(const vn::Robot<6>& robot, const Settings& settings, std::uint64_t seed) {
  const vn::Vector6 base{1.9, -0.7, 0.4, 0.2, -0.1, 1.1}, tool{0.025, -0.04, 0.12, 0.3, 0.1, -0.5};
  const vn::Framed<Chain> arm(vn::with_geometric_errors(robot.chain, {}, seed), vn::FrameParameters(base),
                              vn::FrameParameters(tool));
  const Joints joints = sample(robot, settings.region, 300, vn::child_seed(seed, poses_stream));
  const vn::MeasurementNoise noise{.position = 0.03e-3, .orientation = 0.05e-3};
  vn::write_dataset(settings.poses_file, vn::measure(arm, joints, noise, vn::child_seed(seed, poses_stream + 1)),
                    robot.chain.joint_types());
  fmt::print("{}: 300 simulated measured poses (0.03 mm, 0.05 mrad), in a tracker's frame, with a tool\n\n",
             support::shown(settings.poses_file));
}

// --- tables ----------------------------------------------------------------------------------------------------------

double reduction(const Run& run, std::size_t set, std::size_t method) {
  const double before = run.errors[set][0].position.mean();
  return before > 0 ? 100 * (1 - run.errors[set][method].position.mean() / before) : 0;
}

void print_row(const char* title, const vn::PositioningErrors& errors, const std::string& reductions) {
  const auto mm = vn::ErrorStatistics::of(errors.position * 1e3), mrad = vn::ErrorStatistics::of(errors.rotation * 1e3);
  fmt::print("  {:<22}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}{:>11.2f}{:>9.2f}{}\n", title, mm.max, mm.min, mm.mean,
             mm.rms, mm.p95, mrad.mean, mrad.max, reductions);
}

void print_tables(const Run& run) {
  for (std::size_t set = 0; set < sets.size(); ++set) {
    const std::string title = fmt::format("{}, {} poses", sets[set].title, run.errors[set][0].position.size());
    fmt::print("{:<24}{:^45}{:^20}{:^22}\n", title, "position error [mm]", "orientation [mrad]",
               "reduction of mean [%]");
    fmt::print("  {:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{:>11}{:>9}{:>11}{:>9}\n", "", "max", "min", "mean", "rms", "p95",
               "mean", "max", "here", "paper");
    for (const std::size_t m : run.ran) {
      const auto paper = methods[m].paper[set];
      print_row(
          methods[m].title, run.errors[set][m],
          m == 0 ? std::string()
                 : fmt::format("{:>11.2f}{:>9}", reduction(run, set, m), paper ? fmt::format("{:.2f}", *paper) : "-"));
    }
    print_row("  and full pose", run.full_pose[set], "");
    fmt::print("\n");
  }
  fmt::print(
      "Every correction aims at the position and moves joints 1 to 3, as in the paper, and lets the orientation\n"
      "fall; so does the identification, to compare like with like. Its last row aims at position and\n"
      "orientation with all joints; it has seen positions alone, which leave the hand's own turn unknown.\n"
      "Joint-space methods move all six joints.\n"
      "The paper states neither its joint ranges nor its error tables; both decide the percentages.\n");
  if (run.failed_labels > 0)
    fmt::print(
        "Inverse kinematics found no joint label for {} training poses; joint-space learning goes without them.\n",
        run.failed_labels);
  if (!run.identification_remark.empty()) fmt::print("Identification: {}\n", run.identification_remark);
}

/// Reductions of the mean error by a method, one a run [%].
vn::VectorX reductions(const std::vector<Run>& runs, std::size_t set, std::size_t method) {
  vn::VectorX values(static_cast<vn::Index>(runs.size()));
  for (std::size_t r = 0; r < runs.size(); ++r) values(static_cast<vn::Index>(r)) = reduction(runs[r], set, method);
  return values;
}

/// By how much PSO reduces the error more than GA, one a run [points].
vn::VectorX leads_of_pso(const std::vector<Run>& runs, std::size_t set, std::size_t ga, std::size_t pso) {
  return reductions(runs, set, pso) - reductions(runs, set, ga);
}

/// Wilcoxon's signed-rank test of that, two-sided.
double p_value_of_pso(const std::vector<Run>& runs, std::size_t set, std::size_t ga, std::size_t pso) {
  return vn::signed_rank_test(reductions(runs, set, pso), reductions(runs, set, ga)).p_value;
}

void print_spread(const std::vector<Run>& runs) {
  fmt::print("\nReduction of the mean error over {} error tables and seeds [%]: median and range\n", runs.size());
  fmt::print("  {:<22}", "");
  for (const PoseSet& set : sets) fmt::print("{:>9}  {:<18}{:>7}", set.name, "[min, max]", "paper");
  fmt::print("\n");
  for (const std::size_t m : runs.front().ran) {
    if (m == 0) continue;
    fmt::print("  {:<22}", methods[m].title);
    for (std::size_t set = 0; set < sets.size(); ++set) {
      const vn::VectorX values = reductions(runs, set, m);
      const auto paper = methods[m].paper[set];
      fmt::print("{:>9.2f}  {:<18}{:>7}", vn::quantile(values, 0.5),
                 fmt::format("[{:.2f}, {:.2f}]", values.minCoeff(), values.maxCoeff()),
                 paper ? fmt::format("{:.2f}", *paper) : "-");
    }
    fmt::print("\n");
  }
  for (const auto& [space, ga, pso] : pso_against_ga) {
    for (std::size_t set = 0; set < sets.size(); ++set) {
      const vn::VectorX lead = leads_of_pso(runs, set, ga, pso);
      fmt::print(
          "  PSO against GA, {}, {} set: better in {} of {} runs, by {:.2f} points in the median; signed-rank p "
          "{:.3g}\n",
          space, sets[set].name, (lead.array() > 0).count(), runs.size(), vn::quantile(lead, 0.5),
          p_value_of_pso(runs, set, ga, pso));
    }
  }
}

Json set_json(const Run& run, std::size_t set) {
  Json document{{"n", run.errors[set][0].position.size()}, {"methods", Json::object()}};
  for (const std::size_t m : run.ran) {
    const auto mm = vn::ErrorStatistics::of(run.errors[set][m].position * 1e3),
               mrad = vn::ErrorStatistics::of(run.errors[set][m].rotation * 1e3);
    document["methods"][methods[m].name] = {{"mean_mm", mm.mean},     {"max_mm", mm.max},
                                            {"min_mm", mm.min},       {"rms_mm", mm.rms},
                                            {"p95_mm", mm.p95},       {"reduction_percent", reduction(run, set, m)},
                                            {"mean_mrad", mrad.mean}, {"max_mrad", mrad.max}};
  }
  return document;
}

Json sets_json(const Run& run) {
  Json document;
  for (std::size_t set = 0; set < sets.size(); ++set) document[sets[set].name] = set_json(run, set);
  return document;
}

Json json(const vn::Robot<6>& robot, const Settings& settings, const std::vector<Run>& runs) {
  Json document{{"robot", robot.name},
                {"seed", runs.front().seed},
                {"region", settings.region == Region::full ? "full" : "operating"},
                {"positions", settings.positions == vn::PositionRule::clamped ? "clamped" : "unbounded"},
                {"train", settings.train},
                {"budget", settings.budget},
                {"search_samples", settings.search_samples},
                {"noise_mm", settings.noise * 1e3},
                {"sets", sets_json(runs.front())}};
  for (const std::size_t m : runs.front().ran)
    if (m > 0) document["seconds"][methods[m].name] = runs.front().seconds[m];
  Json& repeated = document["runs"];
  repeated["count"] = runs.size();
  for (std::size_t set = 0; set < sets.size(); ++set)
    for (const std::size_t m : runs.front().ran) {
      if (m == 0) continue;
      const vn::VectorX values = reductions(runs, set, m);
      const double sd =
          runs.size() > 1
              ? std::sqrt((values.array() - values.mean()).square().sum() / static_cast<double>(runs.size() - 1))
              : 0;
      repeated["reduction_percent"][sets[set].name][methods[m].name] = {{"mean", values.mean()},
                                                                        {"sd", sd},
                                                                        {"median", vn::quantile(values, 0.5)},
                                                                        {"min", values.minCoeff()},
                                                                        {"max", values.maxCoeff()}};
    }
  if (runs.size() > 1)
    for (const auto& [space, ga, pso] : pso_against_ga)
      for (std::size_t set = 0; set < sets.size(); ++set)
        repeated["signed_rank_p_pso_against_ga"][sets[set].name][space] = p_value_of_pso(runs, set, ga, pso);
  for (const Run& run : runs) repeated["each"].push_back({{"seed", run.seed}, {"sets", sets_json(run)}});
  return document;
}

// --- figures ---------------------------------------------------------------------------------------------------------

std::vector<double> values(const vn::VectorX& column) { return {column.begin(), column.end()}; }

/// Errors below this do not show [mm].
constexpr double smallest_shown = 1e-3;

/// Series colours, alike in all figures; 0 is black.
int colour(std::size_t method) {
  constexpr std::array<int, methods.size()> colours{0, 1, 4, 2, 5, 0, 6, 3};
  return colours[method];
}

std::vector<std::string> draw_figures(const Run& run, const std::filesystem::path& folder) {
  std::vector<std::string> files;
  const auto keep = [&](bool drawn, const std::filesystem::path& path) {
    if (drawn) files.push_back(path.string());
  };
  for (std::size_t set = 0; set < sets.size(); ++set) {
    const vn::VectorX before = run.errors[set][0].position;
    const auto order = vn::argsort(before);
    const auto shown = [&](std::size_t m) {
      return vn::VectorX((run.errors[set][m].position * 1e3).cwiseMax(smallest_shown));
    };
    const auto curve = [&](std::size_t m, const char* name, support::Style style, int of_colour) {
      support::Series series{name, {}, {}, style, of_colour};
      const vn::VectorX mm = shown(m);
      for (std::size_t i = 0; i < order.size(); ++i) {
        series.x.push_back(static_cast<double>(i + 1));
        series.y.push_back(mm(order[i]));
      }
      return series;
    };
    std::vector<support::Panel> panels;
    std::vector<support::Sample> samples;
    std::string below;
    for (const std::size_t m : run.ran) {
      if (m == trained) continue;  // the palette has a colour for one of the two
      const vn::VectorX mm = run.errors[set][m].position * 1e3;
      if (mm.maxCoeff() < smallest_shown) {
        below += fmt::format(" ({}: below {} mm)", methods[m].title, smallest_shown);
        continue;
      }
      samples.push_back({methods[m].title, values(shown(m)), colour(m)});
      if (m > 0)
        panels.push_back({methods[m].title,
                          {curve(m, "after compensation", support::Style::points, 5),
                           curve(0, "before", support::Style::lines, 0)}});
    }
    const auto errors_file = folder / fmt::format("errors_{}.svg", sets[set].name);
    keep(support::panels_svg(errors_file, fmt::format("Error of each pose, {}{}", sets[set].title, below),
                             "pose, in order of its error before compensation", "position error [mm]", panels,
                             {.log_y = true}),
         errors_file);
    const auto distribution_file = folder / fmt::format("distribution_{}.svg", sets[set].name);
    keep(support::plot_svg(distribution_file, fmt::format("Distribution of the error, {}{}", sets[set].title, below),
                           "position error [mm]", "share of the poses [%]", support::cumulative(samples),
                           {.log_x = true}),
         distribution_file);
  }
  std::vector<support::Series> convergence;
  for (std::size_t m = 1; m < trained; ++m)
    convergence.push_back(
        {methods[m].title, run.convergence[m].evaluations, run.convergence[m].best, support::Style::lines, colour(m)});
  const auto convergence_file = folder / "convergence.svg";
  keep(support::plot_svg(convergence_file, "Convergence of the searches", "evaluations of the fitness",
                         "training error, scaled [-]", convergence, {.log_y = true}),
       convergence_file);
  return files;
}

// --- command line ----------------------------------------------------------------------------------------------------

int body(support::Program& program) {
  Settings settings;
  std::optional<vn::Index> train, test, fresh;
  std::optional<double> budget;
  double noise_mm = 0;
  std::string region = "operating", positions = "unbounded";
  program.group(support::Group::model);
  program.add_flag("--quick", settings.quick,
                   "1000 poses to learn from, 200 test, a quarter of the generations: under a minute");
  program.add_flag("--varpro", settings.var_pro,
                   "also train the hidden layer by gradients (VarProElm); --scale-budget does not shorten it");
  program
      .add_setting("--runs", settings.runs, "repeat over K error tables and seeds; medians, ranges, paired tests", "K")
      .within(1, 1000);
  program.group(support::Group::input);
  program.add_setting("--region", region, "joint ranges of all poses", "operating|full").one_of({"operating", "full"});
  program.group(support::Group::model);
  program
      .add_setting("--positions", positions, "whether PSO's particles may leave [-1, 1]; the paper lets them",
                   "unbounded|clamped")
      .one_of({"unbounded", "clamped"});
  program.group(support::Group::input);
  program.add_option("--train", train, "poses to learn from; the paper has 5000", "N").within(1, 1000000);
  program.add_option("--test", test, "poses of the test set; the paper has 400", "N").within(1, 1000000);
  program.add_option("--fresh", fresh, "poses of the random set; the paper has 200", "N").within(1, 1000000);
  program.group(support::Group::model);
  program.add_option("--scale-budget", budget, "factor of the paper's generations and iterations", "F")
      .within(1e-4, 100.0);
  program
      .add_setting("--search-samples", settings.search_samples,
                   "poses on which the searches evaluate, the fit has all; 0: all", "N")
      .within(0, 1000000);
  program.add_setting("--noise-mm", noise_mm, "standard deviation of the measured positions, per component", "S")
      .within(0.0, 100.0);
  program.group(support::Group::output);
  program.add_output("--write-poses", settings.poses_file, "write simulated measured poses, for `calibrate`");
  program.parse("paper_comparison_out");
  settings.train = train.value_or(settings.quick ? 1000 : 5000);
  settings.test = test.value_or(settings.quick ? 200 : 400);
  settings.fresh = fresh.value_or(200);
  settings.budget = budget.value_or(settings.quick ? 0.25 : 1);
  settings.noise = noise_mm / 1e3;
  settings.region = region == "full" ? Region::full : Region::operating;
  settings.positions = positions == "clamped" ? vn::PositionRule::clamped : vn::PositionRule::unbounded;
  program.require_output_folder();
  const std::filesystem::path folder = program.output_folder();
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const std::uint64_t seed = program.common().seed;
  const int threads = program.common().threads;

  if (!settings.poses_file.empty()) write_poses(robot, settings, seed);
  fmt::print("Simulated ABB IRB 120; parameters off by 0.5 to 1 mm and 1 to 3 mrad, seed {}.\n", seed);
  fmt::print(
      "Poses: uniform in {}.\n",
      settings.region == Region::full
          ? "the full joint limits"
          : "q1 +-90, q2 +-60, q3 -60..50, q4 +-90, q5 20..110, q6 +-180 deg, wrist centre 120 mm or more off axis 1");
  fmt::print("{} to learn from, {} of the same draw to test, {} fresh; positions measured {}.\n", settings.train,
             settings.test, settings.fresh,
             settings.noise > 0 ? fmt::format("with {} mm noise (joint labels without)", noise_mm) : "without noise");
  if (settings.budget != 1 || settings.train != 5000)
    fmt::print(
        "REDUCED: the paper has 5000 poses to learn from and its full number of generations; here {} and {:g} times "
        "those.\n",
        settings.train, settings.budget);
  if (settings.search_samples > 0)
    fmt::print("The searches judge by {} of the poses to learn from.\n", settings.search_samples);
  if (settings.positions == vn::PositionRule::clamped) fmt::print("PSO's particles are kept in [-1, 1].\n");
  fmt::print("\n");
  std::fflush(stdout);

  std::vector<Run> runs;
  for (int r = 0; r < settings.runs; ++r) {
    const std::uint64_t run_seed = r == 0 ? seed : vn::child_seed(seed, run_stream + static_cast<std::uint64_t>(r));
    const std::string prefix = settings.runs > 1 ? fmt::format("run {} of {}, ", r + 1, settings.runs) : "";
    runs.push_back(Experiment(robot, settings, run_seed, threads, prefix).run());
    if (r == 0) print_tables(runs.front());
  }
  if (runs.size() > 1) print_spread(runs);

  fmt::print("\nSeconds on {} thread{}:", threads, threads == 1 ? "" : "s");
  for (const std::size_t m : runs.front().ran)
    if (m > 0) {
      const std::string title = methods[m].title;
      fmt::print("{} {} {:.1f}", m == 1 ? "" : ",", title.substr(title.find_first_not_of(' ')),
                 runs.front().seconds[m]);
    }
  fmt::print("\n");
  if (!program.common().json.empty()) support::write_json(program.common().json, json(robot, settings, runs));
  const auto files = draw_figures(runs.front(), folder);
  if (!files.empty()) fmt::print("Figures: {}\n", fmt::join(files, ", "));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{
      "paper_comparison",
      "Repeats the experiment of Feng, Dong and Jin on a simulated ABB IRB 120, beside the classical identification.",
      {"paper_comparison --quick", "paper_comparison --runs 20 --seed 1 --out figures --json results.json"}};
  return support::run_program(about, argc, argv, body);
}
