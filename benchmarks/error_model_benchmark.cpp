// SPDX-License-Identifier: BSD-3-Clause
// Error models: normal equations of all blocks against plain dense rows, and whole calibrations with their memory.

#include <sys/resource.h>

#include <chrono>

#include "program.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace {

namespace vn = vernier;
using Chain = vn::DhChain<6>;

constexpr const char* about =
    "Error models of a simulated UR10 from 6-DoF poses: geometry, frames, gravity compliance and 60 harmonics a "
    "joint.\n"
    "Normal equations against the same from plain dense rows; then whole calibrations, once each, with peak memory.\n";

vn::Dataset<6> measured(vn::Index n, const vn::Vector6& base, std::uint64_t seed) {
  const auto robot = vn::robots::ur10();
  const vn::WithJointErrors<Chain> off(
      vn::with_geometric_errors(robot.chain, {.length_min = 0.2e-3, .angle_min = 0.3e-3, .angle_max = 1e-3}, 4),
      vn::draw_joint_errors(robot.chain, {.harmonics = 20}, 5));
  vn::JointLimits<6> region;
  region.lower.setConstant(-2.5);
  region.upper.setConstant(2.5);
  return vn::measure(
      vn::Framed(off, vn::FrameParameters(base), vn::FrameParameters(vn::Vector6{0.02, 0, 0.1, 0, 0, 0})),
      vn::sample_joints(region, n, seed), {.position = 0.03e-3, .orientation = 0.1e-3}, seed);
}

/// Nothing learned on top of the error model.
const vn::CalibrateOptions model_alone{.remainder = {.on_error_model = false}};

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void whole(const char* what, const std::vector<vn::Dataset<6>>& stations) {
  const auto began = std::chrono::steady_clock::now();
  const auto found = vn::calibrate(vn::robots::ur10().chain, stations, model_alone);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
  std::printf("%-40s %8.2f s %10.0f MB at the peak so far %s\n", what, seconds.count(), peak_megabytes(),
              found.errors.converged ? "" : "(NOT CONVERGED)");
}

int work(bench::Program& program, int argc, char** argv) {
  const vn::Vector6 here{2, 1, 0, 0, 0, 1};
  const vn::Dataset<6> data = measured(2218, here, 1);
  const Chain nominal = vn::robots::ur10().chain;
  const vn::ArmParameterisation arm = vn::calibrate(nominal, data, model_alone).errors.arm;
  const vn::detail::CalibrationProblem problem(arm, {vn::Measurements<6>(data).sets().front()}, vn::Loss::squared);
  const vn::BlockSystem system = problem.system();
  const auto ours = [&](std::size_t) { return vn::NormalEquations(system).matrix; };
  const auto dense = [&](std::size_t) {
    vn::MatrixX rows(6 * data.size(), arm.size());
    vn::RowBlock pose;
    vn::Rows6 expanded(6, arm.size());
    for (vn::Index i = 0; i < data.size(); ++i) {
      problem(i, 1, &pose);
      pose.expand(system.group_sizes, expanded);
      rows.middleRows(6 * i, 6) = expanded;
    }
    vn::MatrixX gram = vn::MatrixX::Zero(rows.cols(), rows.cols());
    gram.selfadjointView<Eigen::Upper>().rankUpdate(rows.transpose());
    gram.triangularView<Eigen::StrictlyLower>() = gram.transpose();
    return gram;
  };
  const vn::MatrixX a = ours(0), b = dense(0);
  bench::require_agreement("normal equations", (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(), 1e-10);
  program.measure("normal equations", "vernier", ours);
  program.measure("normal equations", "dense rows, Eigen", dense);
  if (const int status = program.run(argc, argv); status != 0) return status;

  std::printf("\n%ld unknowns; one run each, search for priors included\n", static_cast<long>(arm.size()));
  whole("1,000 poses", {measured(1000, here, 2)});
  whole("2,218 poses", {data});
  whole("15,000 poses in three stations", {measured(5000, here, 3), measured(5000, {-2, 1, 0.5, 0, 0.1, 2}, 4),
                                           measured(5000, {0, 3, -0.5, 0.1, 0, -1}, 5)});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
