// SPDX-License-Identifier: BSD-3-Clause
// Which effects a calibration claims on simulated arms: false claims on arms that have none, and the power, intervals
// and limits of arms that have one.
//
//   effects_study [ARMS [EFFECT [SIZE [POSES...]]]]
//
// EFFECT is none (the default), compliance, gears, coupling, harmonics, ripple or all; SIZE (1) multiplies its usual
// size. Three effects are none of the arm: tails (noise of Student's distribution with 3 degrees of freedom), sigma
// (the stated standard deviations are SIZE times the true ones) and ordered (poses along a path). Each of ARMS (20)
// UR10 and as many IRB 120 has other geometric errors. POSES are 60 120 300. The sensor's noise is 0.03 mm and 0.05
// mrad. Columns:
//
//   false claims    arms with a claim of hysteresis, tilt or drift; of any effect, if they have none
//   found           arms with a claim of the effect that they have
//   stand-ins       arms with a claim of another error of joints, which stands in for theirs or for a part of it
//   open            arms with an error of joints of which the report says that it may be another one
//   ratio           noise-free error of the deployed model, over that of the geometry
//   intervals       95 % intervals of the effect's size that hold it, whether found or not, at arms whose model has
//                   nothing else
//   size            that geometry and frames leave of the effect, median
//   poses           that would find as much with 80 %, by the reports, median

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/evaluation/quantile.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vn = vernier;
using vn::Index;

namespace {

struct Cell {
  int arms = 0, with_false_claims = 0, found = 0, with_stand_ins = 0, open = 0, truths = 0, covered = 0;
  std::map<std::string, int> claims;
  std::vector<double> ratios;           // noise-free error of the deployed model to that of the geometry
  std::vector<double> decisive, sizes;  // poses that would decide; true sizes [mm]
};

/// Joint errors of one kind.
vn::JointErrorSizes sizes_of(const std::string& effect, double size) {
  vn::JointErrorSizes out{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0};
  if (effect == "gears") out.gear_ratio = 1e-4 * size;
  if (effect == "coupling") out.coupling = 1e-4 * size;
  if (effect == "compliance") out.compliance = 0.2e-3 * size;
  if (effect == "harmonics") out.harmonic = 0.02e-3 * size;
  if (effect == "ripple") out.ripple = 0.05e-3 * size;
  if (effect == "all")
    out = {
        .gear_ratio = 1e-5 * size, .coupling = 1e-5 * size, .compliance = 0.05e-3 * size, .harmonic = 0.02e-3 * size};
  return out;
}

/// Whether the arm has an effect.
bool errs(const std::string& effect) {
  return effect != "none" && effect != "tails" && effect != "sigma" && effect != "ordered";
}

/// Whether a claim is of the effect that the arm has.
bool is_of(vn::Block block, const std::string& effect) {
  if (effect == "all") return block != vn::Block::drift && block != vn::Block::approach && block != vn::Block::tilt;
  if (block == vn::Block::elastic || block == vn::Block::elastic_again) return effect == "compliance";
  if (block == vn::Block::jointwise) return effect == "harmonics" || effect == "ripple";
  return block == vn::Block::gears && (effect == "gears" || effect == "coupling");
}

/// Whether a block has errors of joints, which may look like others of these.
bool may_stand_in(vn::Block block) {
  return block == vn::Block::elastic || block == vn::Block::elastic_again || block == vn::Block::jointwise ||
         block == vn::Block::gears;
}

/// Whether a block would have all of the effect, beside what is tested before it.
bool alone(vn::Block block, const std::string& effect) {
  if (block == vn::Block::elastic_again && effect == "compliance") return true;
  return (block == vn::Block::elastic && effect == "compliance") ||
         (block == vn::Block::gears && (effect == "gears" || effect == "coupling")) ||
         (block == vn::Block::jointwise && effect == "harmonics");
}

/// Poses along a path through random ones, 15 from one to the next.
vn::JointRows<6> along_path(const vn::JointLimits<6>& limits, Index poses, std::uint64_t seed) {
  constexpr Index steps = 15;
  const auto corners = vn::sample_joints(limits, poses / steps + 2, seed);
  vn::JointRows<6> out(poses, 6);
  for (Index i = 0; i < poses; ++i) {
    const double share = static_cast<double>(i % steps) / steps;
    out.row(i) = (1 - share) * corners.row(i / steps) + share * corners.row(i / steps + 1);
  }
  return out;
}

/// Measurements whose noise has long tails: normal, divided by the root of a third of a chi-square of 3 degrees of
/// freedom.
vn::Dataset<6> with_tails(const vn::Dataset<6>& exact, const vn::Dataset<6>& noisy, std::uint64_t seed) {
  vn::Rng rng(seed);
  vn::PointRows positions = exact.positions(), orientations = exact.orientations();
  for (Index i = 0; i < exact.size(); ++i) {
    const auto [a, b] = rng.normal_pair();
    const double c = rng.normal_pair()[0], factor = 1 / std::sqrt((a * a + b * b + c * c) / 3);
    positions.row(i) += factor * (noisy.positions().row(i) - positions.row(i));
    const vn::Matrix3 from = vn::exp_so3(orientations.row(i).transpose());
    const vn::Matrix3 to = vn::exp_so3(noisy.orientations().row(i).transpose());
    const vn::Vector3 turn = factor * vn::log_so3(to * from.transpose());
    orientations.row(i) = vn::log_so3(vn::exp_so3(turn) * from).transpose();
  }
  return {exact.joints(), positions, orientations};
}

double error_of(const auto& model, const auto& actual, const vn::JointRows<6>& joints) {
  double sum = 0;
  for (Index i = 0; i < joints.rows(); ++i) {
    const vn::JointVector<6> q = joints.row(i).transpose();
    sum += (model.pose(q).translation() - actual.pose(q).translation()).norm();
  }
  return sum / static_cast<double>(joints.rows());
}

void run_arm(const vn::Robot<6>& robot, const std::string& effect, double size, Index poses, std::uint64_t seed,
             Cell& cell) {
  const vn::JointLimits<6> limits{robot.limits.lower.cwiseMax(-3), robot.limits.upper.cwiseMin(3)};
  const auto chain = vn::with_geometric_errors(robot.chain, {}, seed);
  const vn::WithJointErrors<vn::DhChain<6>> actual(
      chain, vn::draw_joint_errors(robot.chain, sizes_of(effect, size), seed + 1));
  const auto joints =
      effect == "ordered" ? along_path(limits, poses, seed + 2) : vn::sample_joints(limits, poses, seed + 2);
  const auto fresh = vn::sample_joints(limits, 500, seed + 3);
  const vn::MeasurementNoise noise{.position = 0.03e-3, .orientation = 0.05e-3};
  const vn::Dataset<6> exact_rows = vn::measure(actual, joints, {}, 0);
  const vn::Dataset<6> noisy = vn::measure(actual, joints, noise, seed + 4);
  const vn::Measurements<6> measured(effect == "tails" ? with_tails(exact_rows, noisy, seed + 5) : noisy);
  vn::SensorModel sensors;
  if (effect == "sigma") sensors = {.position_sigma = 0.03e-3 * size, .orientation_sigma = 0.05e-3 * size};
  double size_mm = 0;  // what geometry and frames leave of the effect
  vn::ErrorModelOptions options;
  if (errs(effect)) {
    const vn::Measurements<6> exact(exact_rows);
    options.relevant_size = vn::identify(robot.chain, exact, {}, {}, vn::own_solver).rms_after;
    size_mm = 1e3 * options.relevant_size;
    cell.sizes.push_back(size_mm);
  }
  const auto geometry = vn::identify(robot.chain, measured, {}, sensors, vn::own_solver);
  const auto found = vn::fit_error_model(geometry, measured, options, sensors);
  const double of_geometry = error_of(found.models(vn::Stage::geometry).front(), actual, fresh);
  ++cell.arms;
  cell.ratios.push_back(error_of(found.model(), actual, fresh) / of_geometry);
  bool false_claim = false, its_own = false, stands_in = false, open = false, other = false;
  const bool again = std::any_of(found.blocks.begin(), found.blocks.end(),
                                 [](const vn::BlockChoice& block) { return block.block == vn::Block::elastic_again; });
  for (const vn::BlockChoice& block : found.blocks) {
    const vn::Existence& answer = block.existence;
    if (again && block.block == vn::Block::elastic) continue;
    open = open || answer.look_alike;
    other = other || (answer.look_alike && block.used && !alone(block.block, effect));
    if (answer.answer != vn::Answer::found) continue;
    ++cell.claims[vn::traits_of(block.block).key];
    if (is_of(block.block, effect))
      its_own = true;
    else
      (errs(effect) && may_stand_in(block.block) ? stands_in : false_claim) = true;
    other = other || !alone(block.block, effect);
  }
  cell.with_false_claims += false_claim;
  cell.found += its_own;
  cell.with_stand_ins += stands_in;
  cell.open += open;
  if (other) return;  // it leaves less of the effect
  for (const vn::BlockChoice& block : found.blocks) {
    const vn::Existence& answer = block.existence;
    if (!alone(block.block, effect) || answer.answer == vn::Answer::untested) continue;
    if (again && block.block == vn::Block::elastic) continue;
    ++cell.truths;
    cell.covered += 1e3 * answer.interval[0] <= size_mm && size_mm <= 1e3 * answer.interval[1];
    if (answer.poses > 0) cell.decisive.push_back(static_cast<double>(answer.poses));
  }
}

double median(const std::vector<double>& values) {
  return values.empty()
             ? 0
             : vn::quantile(Eigen::Map<const vn::VectorX>(values.data(), static_cast<Index>(values.size())), 0.5);
}

}  // namespace

int main(int argc, char** argv) try {
  const int arms = argc > 1 ? std::atoi(argv[1]) : 20;
  const std::string effect = argc > 2 ? argv[2] : "none";
  const double size = argc > 3 ? std::atof(argv[3]) : 1;
  std::vector<Index> poses;
  for (int k = 4; k < argc; ++k) poses.push_back(std::atoi(argv[k]));
  if (poses.empty()) poses = {60, 120, 300};
  std::printf("%-10s %5s | %5s %12s %5s %9s %4s | %12s %11s | %9s %9s %6s | claims\n", "arm", "poses", "arms",
              "false claims", "found", "stand-ins", "open", "median ratio", "worst ratio", "intervals", "size [mm]",
              "poses");
  for (const auto& [name, robot] :
       {std::pair{"UR10", vn::robots::ur10()}, std::pair{"IRB 120", vn::robots::abb_irb120()}})
    for (const Index n : poses) {
      Cell cell;
      for (int arm = 0; arm < arms; ++arm)
        run_arm(robot, effect, size, n, 1000003 * static_cast<std::uint64_t>(n) + 10 * static_cast<std::uint64_t>(arm),
                cell);
      std::printf("%-10s %5ld | %5d %12d %5d %9d %4d | %12.4f %11.4f | %2d of %-3d %9.4f %6.0f |", name,
                  static_cast<long>(n), cell.arms, cell.with_false_claims, cell.found, cell.with_stand_ins, cell.open,
                  median(cell.ratios), *std::max_element(cell.ratios.begin(), cell.ratios.end()), cell.covered,
                  cell.truths, median(cell.sizes), median(cell.decisive));
      for (const auto& [key, count] : cell.claims) std::printf(" %s %d", key.c_str(), count);
      std::printf("\n");
      std::fflush(stdout);
    }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "effects_study: %s\n", error.what());
  return 1;
}
