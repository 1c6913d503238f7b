// SPDX-License-Identifier: BSD-3-Clause
// How good a calibration is by the choice of its poses: at random, D-optimal for the geometry alone, and D-optimal for
// all unknowns of the error model, as `plan_poses --choose` takes them. All three choose from the training rows of
// measured files by their joints alone, and are calibrated in the same way.
//
//   pose_planning_study FOLDER [SEEDS [FIGURE_FOLDER]]
//
// FOLDER has ur10_random_poses.csv and ur5_grid.csv. SEEDS (20) random choices for each number of poses. Half as many
// plans, each from a different nine tenths of the training rows, show how much a single plan owes to chance.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "figures.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/planning/plan_measurements.hpp"

namespace vn = vernier;
using vn::Index;

namespace {

using Robot = vn::Robot<6, vn::StandardDh>;
using Data = vn::Dataset<6>;

const std::vector<Index> sizes{30, 50, 100, 200};

/// Mean error of held-out poses after the stage that the calibration chose [mm]; infinite where it was refused.
double held_out_mean(const Robot& robot, const Data& chosen, const Data& held_out) try {
  vn::CalibrateOptions options;
  options.errors.drives.assign(robot.drives.begin(), robot.drives.end());
  const std::vector<Data> train{chosen}, test{held_out};
  const auto calibration = vn::calibrate(robot.chain, train, options);
  const vn::CalibrationReport report = vn::evaluate(calibration, test, robot.limits);
  return 1e3 * report.stage(report.chosen).position.mean();
} catch (const vn::CalibrationFailure&) {
  return std::numeric_limits<double>::infinity();
}

/// Rows of a plan in the order of the file.
Data planned(const Robot& robot, const Data& from, Index count, bool geometry_alone) {
  vn::PlanOptions options{.count = count, .oriented = from.has_orientations()};
  options.errors.drives.assign(robot.drives.begin(), robot.drives.end());
  if (geometry_alone) {
    options.errors.harmonics = 0;
    options.errors.compliance = options.errors.gear_ratio = options.errors.coupling = options.errors.hysteresis =
        options.errors.tilt = false;
  }
  std::vector<Index> rows = vn::plan_measurements(robot.chain, {from.joints(), from.previous(), {}}, options).chosen;
  std::sort(rows.begin(), rows.end());
  return from.rows(rows);
}

struct Errors {
  std::vector<double> random{}, plans{};
  double geometry_plan = 0, plan = 0;
};

/// "median [least, most]"
std::string spread(const std::vector<double>& errors) {
  const vn::VectorX e = Eigen::Map<const vn::VectorX>(errors.data(), static_cast<Index>(errors.size()));
  char text[64];
  std::snprintf(text, sizeof text, "%.4f [%.4f, %.4f]", vn::quantile(e, 0.5), e.minCoeff(), e.maxCoeff());
  return text;
}

/// One number of poses from the training rows of a split.
Errors compare(const Robot& robot, const vn::Split<6>& split, Index count, int seeds) {
  Errors out;
  out.random.resize(static_cast<std::size_t>(seeds));
  out.plans.resize((out.random.size() + 1) / 2);
  const int tasks = seeds + 2 + static_cast<int>(out.plans.size());
  std::atomic<int> next = 0;
  std::exception_ptr broken;
  std::atomic<bool> stopped = false;
  const auto work = [&] {
    for (int k; (k = next++) < tasks && !stopped;) try {
        const auto seed = static_cast<std::uint64_t>(k + 1);
        if (k < seeds) {
          out.random[static_cast<std::size_t>(k)] =
              held_out_mean(robot, vn::random_subset(split.train, count, seed), split.test);
        } else if (k < seeds + 2) {
          const bool geometry_alone = k == seeds;
          (geometry_alone ? out.geometry_plan : out.plan) =
              held_out_mean(robot, planned(robot, split.train, count, geometry_alone), split.test);
        } else {
          const Data some = vn::random_subset(split.train, split.train.size() * 9 / 10, seed);
          out.plans[static_cast<std::size_t>(k - seeds - 2)] =
              held_out_mean(robot, planned(robot, some, count, false), split.test);
        }
      } catch (...) {
        if (!stopped.exchange(true)) broken = std::current_exception();
      }
  };
  std::vector<std::thread> others;
  for (unsigned t = 1; t < std::thread::hardware_concurrency(); ++t) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (broken) std::rethrow_exception(broken);
  return out;
}

void study(const char* name, const Robot& robot, const Data& data, int seeds, const std::filesystem::path& figures) {
  using vn::Face;
  const std::pair<const char*, vn::Split<6>> splits[] = {
      {"every fifth row held out", vn::split_every(data, 5)},
      {"largest x held out", vn::split_region(data, {.test_fraction = 0.2, .face = Face::x_high})},
      {"smallest x held out", vn::split_region(data, {.test_fraction = 0.2, .face = Face::x_low})}};
  for (const auto& [rule, split] : splits) {
    std::printf("%s, %s: mean error of the held-out poses [mm]\n", name, rule);
    std::printf("  %5s  %-28s %14s %14s %16s  %s\n", "poses", "random: median [least, most]", "D, geometry", "D, all",
                "D, all / random", "D, all, of nine tenths of the rows");
    support::Series least{"random, least of all", {}, {}, support::Style::dashed, 0};
    support::Series most{"random, most", {}, {}, support::Style::dashed, 0};
    support::Series median{"random, median", {}, {}, support::Style::lines, 0};
    support::Series geometry{"D-optimal for the geometry", {}, {}, support::Style::lines, 1};
    support::Series all{"D-optimal for all unknowns", {}, {}, support::Style::lines, 2};
    for (const Index count : sizes) {
      if (count > split.train.size()) break;
      const Errors errors = compare(robot, split, count, seeds);
      const vn::VectorX random = Eigen::Map<const vn::VectorX>(errors.random.data(), seeds);
      const double middle = vn::quantile(random, 0.5);
      std::printf("  %5d  %-28s %14.4f %14.4f %16.2f  %s\n", static_cast<int>(count), spread(errors.random).c_str(),
                  errors.geometry_plan, errors.plan, errors.plan / middle, spread(errors.plans).c_str());
      std::fflush(stdout);
      const std::pair<support::Series*, double> points[] = {{&least, random.minCoeff()},
                                                            {&most, random.maxCoeff()},
                                                            {&median, middle},
                                                            {&geometry, errors.geometry_plan},
                                                            {&all, errors.plan}};
      for (const auto& [series, value] : points) {
        series->x.push_back(static_cast<double>(count));
        series->y.push_back(value);
      }
    }
    std::printf("\n");
    if (!figures.empty() && &split == &splits[0].second)
      support::plot_svg(figures / (std::string("pose_planning_") + name + ".svg"),
                        std::string(name) + ": calibrated from few poses", "number of poses",
                        "mean error of held-out poses [mm]", {median, least, most, geometry, all},
                        {.log_x = true, .log_y = true});
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: pose_planning_study FOLDER [SEEDS [FIGURE_FOLDER]]\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1], figures = argc > 3 ? argv[3] : "";
  if (!figures.empty()) std::filesystem::create_directories(figures);
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 20;
  const auto read = [&](const char* file, const Robot& robot) {
    return vn::read_dataset<6>((folder / file).string(), robot.chain.joint_types());
  };
  study("ur5", vn::robots::ur5(), read("ur5_grid.csv", vn::robots::ur5()), seeds, figures);
  study("ur10", vn::robots::ur10(), read("ur10_random_poses.csv", vn::robots::ur10()), seeds, figures);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "pose_planning_study: %s\n", error.what());
  return 1;
}
