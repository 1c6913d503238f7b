// SPDX-License-Identifier: BSD-3-Clause
#include "comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "cli.hpp"
#include "dispatch.hpp"
#include "learners.hpp"
#include "robot_choice.hpp"
#include "vernier/ceres.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace support {

namespace {

namespace vn = vernier;
using vn::Index;

/// Independent streams of a seed.
enum Stream : std::uint64_t { train_stream = 1, test_stream, noise_stream, error_stream, subset_stream, fit_stream };

/// Poses to learn from and to judge by, and the arm as designed.
template <int N>
struct Samples {
  vn::DhChain<N> nominal;
  vn::Dataset<N> train, test;
  bool framed = false;  ///< the sensor's frame and the tool are unknown
};

template <int N>
Samples<N> simulate(const Problem& problem, const vn::DescribedRobot<N>& robot, Index poses, std::uint64_t seed) {
  const vn::DhChain<N>& nominal = robot.arm.chain();
  const auto sample = [&](Index n, std::uint64_t stream) -> vn::JointRows<N> {
    if constexpr (N == 6)
      if (problem.region == "operating")
        return vn::abb_irb120_operating_region().sample(nominal, n, vn::child_seed(seed, stream));
    const vn::JointRows<N> drawn = vn::sample_joints(robot.limits, n, vn::child_seed(seed, stream));
    return robot.controller.to_chain(drawn.leftCols(robot.controller.joints(N)));
  };
  const vn::JointRows<N> train = sample(poses, train_stream), test = sample(1000, test_stream);
  const vn::DhChain<N> actual = vn::with_geometric_errors(nominal, {}, seed);
  const vn::MeasurementNoise noise{.position = problem.noise_mm * 1e-3, .with_orientations = false};
  const std::uint64_t noise_seed = vn::child_seed(seed, noise_stream);
  const vn::MeasurementNoise none{.with_orientations = false};
  if (problem.errors == "geometric")
    return {nominal, vn::measure(actual, train, noise, noise_seed), vn::measure(actual, test, none)};
  const vn::WithJointErrors<vn::DhChain<N>> full(actual,
                                                 vn::draw_joint_errors(actual, {}, vn::child_seed(seed, error_stream)));
  return {nominal, vn::measure(full, train, noise, noise_seed), vn::measure(full, test, none)};
}

/// All measured positions.
template <int N>
const vn::Dataset<N>& positions(const Problem& problem) {
  return *std::any_cast<vn::Dataset<N>>(&problem.poses);
}

/// The fifth of measured poses that a seed holds out, and the others.
template <int N>
vn::Split<N> split(const Problem& problem, const vn::Dataset<N>& data, std::uint64_t seed) {
  if (problem.split == "random") return vn::split(data, {.seed = seed});
  if (problem.split == "time") return vn::split_time(data);
  constexpr vn::Face faces[] = {vn::Face::x_high, vn::Face::x_low, vn::Face::z_high, vn::Face::z_low};
  return vn::split_region(data, {.face = faces[(seed + 3) % 4]});
}

template <int N>
Samples<N> measured(const Problem& problem, const vn::DescribedRobot<N>& robot, Index poses, std::uint64_t seed) {
  vn::Split<N> parts = split<N>(problem, positions<N>(problem), seed);
  if (poses > 0) {
    const auto order = vn::Rng(vn::child_seed(seed, subset_stream)).permutation(parts.train.size());
    parts.train = parts.train.rows(std::span<const Index>(order).first(static_cast<std::size_t>(poses)));
  }
  return {robot.arm.chain(), parts.train, parts.test, true};
}

/// Reads measured poses, and makes sure that every split has as many as the plan asks for.
/// @return their file
template <int N>
vn::SourceFile read_positions(const Plan& plan, Problem& problem, const vn::DescribedRobot<N>& robot) {
  vn::CsvFormat format = problem.csv.format();
  format.controller = robot.controller;
  const vn::Dataset<N> data =
      vn::read_dataset<N>(problem.data, robot.arm.chain().joint_types(), format).without_orientations();
  problem.poses = data;
  const Index most = *std::max_element(plan.poses.begin(), plan.poses.end());
  for (const std::uint64_t seed : plan.seeds)
    if (const Index there = split<N>(problem, data, seed).train.size(); most > there)
      throw UsageError(
          vn::message(problem.data.string(), ": ", most, " poses are asked for, there are ", there, " to learn from"));
  return {problem.data.string(), data.origin().hashes.front()};
}

/// Calls with the arm of a robot.
template <class Work>
decltype(auto) with_arm(const vn::RobotDescription& robot, Work&& work) {
  return dispatch_dof(robot.dof(), [&](auto n) -> decltype(auto) { return work(robot.arm<n()>()); });
}

/// Sixteen digits that differ between files of different contents: Fowler, Noll and Vo's hash, as results files have
/// it; of what cannot be read again, the first ones of its SHA-256.
/// @throws std::runtime_error where the file is no longer what was read
std::string fingerprint(const vn::SourceFile& file) {
  if (!std::filesystem::is_regular_file(file.name)) return file.hash.substr(0, 16);
  const std::string content = vn::read_file(file.name);
  if (vn::sha256(content) != file.hash) throw std::runtime_error(file.name + ": changed while it was read");
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : content) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

/// A cell of an arm with N joints.
template <int N>
class Computation {
 public:
  Computation(const Plan& plan, const Cell& cell, const vn::DescribedRobot<N>& robot, vn::ObserverRef observer)
      : plan_(plan),
        method_(plan.methods[cell.method]),
        seed_(cell.seed),
        observer_(observer),
        samples_(plan.problems[cell.problem].measured()
                     ? measured(plan.problems[cell.problem], robot, cell.poses, cell.seed)
                     : simulate(plan.problems[cell.problem], robot, cell.poses, cell.seed)) {}

  Outcome run() const {
    Outcome out;
    // the arm as designed, brought into the sensor's frame: the same start for all
    const auto registered = identify(false);
    out.before = 1e3 * vn::position_errors(registered.model, samples_.test).mean();
    const auto start = std::chrono::steady_clock::now();
    const vn::VectorX errors = 1e3 * errors_after(registered, out.convergence);
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!errors.allFinite()) {
      out.failure = "predictions are not finite";
      return out;
    }
    const auto statistics = vn::ErrorStatistics::of(errors);
    out.mean = statistics.mean;
    out.median = statistics.median;
    out.rms = statistics.rms;
    out.p95 = statistics.p95;
    out.max = statistics.max;
    out.learned_from = static_cast<double>(samples_.train.size());
    for (int k = 0; k <= 20; ++k) out.quantiles.push_back(vn::quantile(errors, k / 20.0));
    return out;
  }

 private:
  using Identified = vn::Identified<vn::DhChain<N>>;

  Identified identify(bool geometry) const {
    vn::IdentifyOptions options;
    options.frames = samples_.framed ? vn::Frames::base_and_tool : vn::Frames::none;
    options.geometry = geometry;
    return vn::identify(samples_.nominal, samples_.train, options, sensors_);
  }

  vn::VectorX errors_after(const Identified& registered, Convergence& record) const {
    const bool alone = method_.classical();
    const std::string& base = alone ? method_.learner : method_.base;
    const auto errors = [&](const auto& model) {
      return alone ? vn::position_errors(model, samples_.test) : errors_after_learning(model, record);
    };
    if (base == "geometry") return errors(identify(true).model);
    if (base == "jointwise")
      return errors(vn::fit_error_model(identify(true), samples_.train,
                                        {.hysteresis = false, .temperature = false, .drift = false}, sensors_)
                        .model());
    if (base == "approach")
      return errors(vn::fit_error_model(identify(true), samples_.train, vn::ErrorModelOptions{}, sensors_).model());
    return errors(registered.model);
  }

  template <class Model>
  vn::VectorX errors_after_learning(const Model& base, Convergence& record) const {
    const vn::PointRows left = samples_.train.positions() - vn::positions(base, samples_.train.joints());
    const vn::FitOptions options{.seed = vn::child_seed(seed_, fit_stream), .observer = observer_};
    const LearnedErrors<N> learned = learn<N>(method_, plan_, samples_.train.joints(), left, options, record);
    const vn::PointRows after =
        samples_.test.positions() - vn::positions(base, samples_.test.joints()) - learned(samples_.test.joints());
    return after.rowwise().norm();
  }

  const Plan& plan_;
  const Method& method_;
  std::uint64_t seed_;
  vn::ObserverRef observer_;
  Samples<N> samples_;
  vn::SensorModel sensors_{.loss = samples_.framed ? vn::Loss::huber : vn::Loss::squared};
};

}  // namespace

void Plan::prepare() {
  const auto check = [](bool holds, const auto&... parts) {
    if (!holds) throw UsageError(vn::message(parts...));
  };
  check(!problems.empty() && !methods.empty() && !poses.empty() && !seeds.empty(),
        "a plan needs problems, methods, numbers of poses and seeds");
  for (Problem& p : problems) {
    p.arm = choose_robot(p.robot);
    with_arm(p.arm, [](const auto&) {});
    check(p.errors == "geometric" || p.errors == "full", p.name, ": errors are '", p.errors,
          "', must be geometric or full");
    if (p.region.empty()) p.region = p.robot == "abb_irb120" ? "operating" : "full";
    check(p.region == "operating" || p.region == "full", p.name, ": the region is '", p.region,
          "', must be operating or full");
    check(p.split == "random" || p.split == "region" || p.split == "time", p.name, ": the split is '", p.split,
          "', must be random, region or time");
    check(p.noise_mm >= 0 && p.noise_mm <= 100, p.name, ": noise_mm is ", p.noise_mm, ", must lie in 0..100");
    check(p.measured() || p.region == "full" || p.robot == "abb_irb120", p.name,
          ": only the abb_irb120 has an operating region; leave --region out");
    for (std::size_t j = 0; j < p.arm.limits.size() && !p.measured(); ++j) {
      const auto [lower, upper] = p.arm.limits[j];
      const auto types = p.arm.controller.types(p.arm.joint_types());
      const char* const unit = types[j] == vn::JointType::revolute ? "deg" : "mm";
      check(p.region == "operating" || (std::isfinite(lower) && std::isfinite(upper)), p.robot, ": joint ", j + 1,
            " has no lower_", unit, " or no upper_", unit, "; simulated poses need limits");
    }
  }
  const double cells = static_cast<double>(problems.size() * methods.size()) * static_cast<double>(poses.size()) *
                       static_cast<double>(seeds.size());
  check(cells <= 1e7, "the grid has more than ten million cells");
  for (const Index n : poses) check(n >= 0 && n <= 1000000, "poses: ", n, " is none (0 stands for all measured ones)");
  for (const Problem& p : problems)
    check(p.measured() || std::find(poses.begin(), poses.end(), 0) == poses.end(), p.name,
          ": simulated poses need a number");
  check(evaluations >= 100 && evaluations <= 100000000, "evaluations is ", evaluations, ", must be 100 or more");
  check(seconds >= 0 && seconds < 1e6, "seconds is ", seconds, ", must be 0 or more");
  check(nodes >= 1 && nodes <= 5000, "nodes is ", nodes, ", must lie in 1..5000");
  for (Problem& p : problems) {
    p.fingerprint.clear();
    std::vector<vn::SourceFile> files = p.arm.files;
    if (p.measured()) with_arm(p.arm, [&](const auto& robot) { files.push_back(read_positions(*this, p, robot)); });
    for (const vn::SourceFile& file : files) p.fingerprint += fingerprint(file);
  }
}

Outcome compute(const Plan& plan, const Cell& cell, vn::ObserverRef observer) {
  return with_arm(plan.problems[cell.problem].arm, [&]<int N>(const vn::DescribedRobot<N>& robot) {
    return Computation<N>(plan, cell, robot, observer).run();
  });
}

}  // namespace support
