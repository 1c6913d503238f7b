// SPDX-License-Identifier: BSD-3-Clause
// Which effects a calibration claims on simulated arms: false claims on arms that have none, and the power, intervals
// and limits of arms that have one.
//
//   effects_study [ARMS [EFFECT [SIZE [POSES...]]]]
//
// EFFECT is none (the default), compliance, gears, coupling, harmonics or all; SIZE (1) multiplies its usual size. Each
// of ARMS (20) UR10 and as many IRB 120 has other geometric errors. POSES are 60 120 300. The sensor's noise is 0.03 mm
// and 0.05 mrad.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <vector>

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
  int arms = 0, with_false_claims = 0, truths = 0, covered = 0;
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
  if (effect == "all")
    out = {
        .gear_ratio = 1e-5 * size, .coupling = 1e-5 * size, .compliance = 0.05e-3 * size, .harmonic = 0.02e-3 * size};
  return out;
}

/// Whether a claim is of the effect that the arm has.
bool is_of(vn::Block block, const std::string& effect) {
  if (effect == "all") return block != vn::Block::drift && block != vn::Block::approach && block != vn::Block::tilt;
  if (block == vn::Block::elastic || block == vn::Block::elastic_again) return effect == "compliance";
  if (block == vn::Block::jointwise) return effect != "none" && effect != "compliance";
  return block == vn::Block::gears && (effect == "gears" || effect == "coupling");
}

/// Whether a block would have all of the effect, beside what is tested before it.
bool alone(vn::Block block, const std::string& effect) {
  return (block == vn::Block::elastic && effect == "compliance") || (block == vn::Block::gears && effect == "gears") ||
         (block == vn::Block::jointwise && effect == "harmonics");
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
  const auto joints = vn::sample_joints(limits, poses, seed + 2);
  const auto fresh = vn::sample_joints(limits, 500, seed + 3);
  const vn::MeasurementNoise noise{.position = 0.03e-3, .orientation = 0.05e-3};
  const vn::Measurements<6> measured(vn::measure(actual, joints, noise, seed + 4));
  const auto geometry = vn::identify(robot.chain, measured, {}, {}, vn::own_solver);
  const auto found = vn::fit_error_model(geometry, measured);
  const double of_geometry = error_of(found.models(vn::Stage::geometry).front(), actual, fresh);
  ++cell.arms;
  cell.ratios.push_back(error_of(found.model(), actual, fresh) / of_geometry);
  bool false_claim = false;
  const bool again = std::any_of(found.blocks.begin(), found.blocks.end(),
                                 [](const vn::BlockChoice& block) { return block.block == vn::Block::elastic_again; });
  for (const vn::BlockChoice& block : found.blocks) {
    if (again && block.block == vn::Block::elastic) continue;
    const vn::Existence& answer = block.existence;
    if (answer.answer == vn::Answer::found) {
      ++cell.claims[vn::traits_of(block.block).key];
      false_claim = false_claim || !is_of(block.block, effect);
    }
    double truth = 0;  // what geometry and frames leave of the effect
    const bool its_own = is_of(block.block, effect);
    if (its_own) {
      const vn::Measurements<6> exact(vn::measure(actual, joints, {}, 0));
      truth = vn::identify(robot.chain, exact, {}, {}, vn::own_solver).rms_after;
      cell.sizes.push_back(truth * 1e3);
      if (answer.poses > 0) cell.decisive.push_back(static_cast<double>(answer.poses));
    }
    if (answer.answer == vn::Answer::untested || (its_own && !alone(block.block, effect))) continue;
    ++cell.truths;
    cell.covered += answer.interval[0] <= truth && truth <= answer.interval[1];
  }
  cell.with_false_claims += false_claim;
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
  std::printf("%-10s %5s | %5s %12s | %13s %13s | %9s | claims\n", "arm", "poses", "arms", "false claims",
              "median ratio", "worst ratio", "intervals");
  for (const auto& [name, robot] :
       {std::pair{"UR10", vn::robots::ur10()}, std::pair{"IRB 120", vn::robots::abb_irb120()}})
    for (const Index n : poses) {
      Cell cell;
      for (int arm = 0; arm < arms; ++arm)
        run_arm(robot, effect, size, n, 1000003 * static_cast<std::uint64_t>(n) + 10 * static_cast<std::uint64_t>(arm),
                cell);
      std::printf("%-10s %5ld | %5d %12d | %13.4f %13.4f | %7.1f %% |", name, static_cast<long>(n), cell.arms,
                  cell.with_false_claims, median(cell.ratios),
                  *std::max_element(cell.ratios.begin(), cell.ratios.end()),
                  100.0 * cell.covered / std::max(1, cell.truths));
      for (const auto& [key, count] : cell.claims) std::printf(" %s %d", key.c_str(), count);
      if (!cell.sizes.empty())
        std::printf(" | size %.4f mm, decisive poses %.0f", median(cell.sizes), median(cell.decisive));
      std::printf("\n");
      std::fflush(stdout);
    }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "effects_study: %s\n", error.what());
  return 1;
}
