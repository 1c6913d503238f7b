// SPDX-License-Identifier: BSD-3-Clause
// Calibrations that a few poor poses could lead astray, on simulated arms: what is deployed, beside the arm as designed
// in its best frames. `trust_study [SITUATION [SEEDS]]`; every figure is a mean error at fresh poses [mm].

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace {

namespace vn = vernier;
using vn::Index;

vn::Isometry3 drawn_frame(vn::Rng& rng, double position, double rotation) {
  vn::Vector6 frame;
  for (int k = 0; k < 6; ++k) frame(k) = rng.uniform(-1, 1) * (k < 3 ? position : rotation);
  return vn::FrameParameters(frame).isometry();
}

/// An arm with errors of links and joints, its sensor and its probe somewhere.
template <int N>
auto made(const vn::DhChain<N>& nominal, const vn::GeometricErrors& links, const vn::JointErrorSizes& joints,
          std::uint64_t seed) {
  const auto chain = vn::with_geometric_errors(nominal, links, vn::child_seed(seed, 0));
  const vn::JointErrors errors = vn::draw_joint_errors(chain, joints, vn::child_seed(seed, 1));
  vn::Rng rng(vn::child_seed(seed, 2));
  const vn::Isometry3 base = drawn_frame(rng, 2, 1), tool = drawn_frame(rng, 0.1, 1);
  return vn::Framed<vn::WithJointErrors<vn::DhChain<N>>>({chain, errors}, base, tool);
}

constexpr vn::GeometricErrors exact{.length_min = 0, .length_max = 0, .angle_min = 0, .angle_max = 0};
const vn::JointErrorSizes rigid{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0};

/// Mean error of a model at poses, and the largest [mm].
struct Error {
  double mean = 0, worst = 0;
};

template <class Model, class Actual, int N>
Error off(const Model& model, const Actual& actual, const vn::JointRows<N>& joints) {
  Error out;
  for (Index i = 0; i < joints.rows(); ++i) {
    const vn::JointVector<N> q = joints.row(i).transpose();
    const double e = 1e3 * (model.position(q) - actual.position(q)).norm();
    out.mean += e / static_cast<double>(joints.rows());
    out.worst = (std::max)(out.worst, e);
  }
  return out;
}

/// Calibrates and prints a line: the arm as designed in registered frames, each stage, and what is deployed.
template <int N, class Actual>
void study(const char* name, std::uint64_t seed, const vn::DhChain<N>& chain, const Actual& actual,
           const std::vector<vn::Dataset<N>>& data, const vn::JointRows<N>& fresh, vn::CalibrateOptions options = {}) {
  try {
    const auto found = vn::calibrate(chain, data, options);
    const Error nominal =
        off<vn::ErrorModel<vn::DhChain<N>>, Actual, N>(found.errors.stages.front().models.front(), actual, fresh);
    const vn::ErrorModel<vn::DhChain<N>>& model = found.errors.models(found.chosen().stage).front();
    Error deployed = off<vn::ErrorModel<vn::DhChain<N>>, Actual, N>(model, actual, fresh);
    if (found.deployed())
      deployed = off<vn::CartesianCorrected<vn::ErrorModel<vn::DhChain<N>>, vn::LearnedError<N>>, Actual, N>(
          {found.model(), found.deployed()->predictor, found.deployed()->coverage}, actual, fresh);
    const double saved = off<vn::Framed<vn::DhChain<N>>, Actual, N>(model.nominal(), actual, fresh).mean;
    std::printf("%s %llu: nominal %.3f (%.2f), deployed %.3f (%.2f) %s, in its frames %.2f, condition %.1e%s;", name,
                static_cast<unsigned long long>(seed), nominal.mean, nominal.worst, deployed.mean, deployed.worst,
                found.chosen().key().c_str(), saved, found.geometry.condition,
                found.geometry.converged() ? "" : " UNDETERMINED");
    for (const auto& staged : found.errors.stages)
      if (staged.stage != vn::Stage::frames && staged.included)
        std::printf(" %s %.3f", vn::traits_of(staged.stage).key,
                    off<vn::ErrorModel<vn::DhChain<N>>, Actual, N>(staged.models.front(), actual, fresh).mean);
    std::printf("\n");
  } catch (const std::exception& error) {
    std::printf("%s %llu: refused: %s\n", name, static_cast<unsigned long long>(seed), error.what());
  }
  std::fflush(stdout);
}

vn::DhChain<8> mobile_manipulator() {
  constexpr double quarter = 1.5707963267948966;
  std::array<vn::DhRow, 8> rows;
  rows[0] = {.alpha = quarter, .d = 0, .joint = vn::JointType::prismatic};  // along a rail
  rows[1] = {.a = 0.2, .alpha = 0, .d = 0.3, .theta = 0};
  const auto ur = vn::robots::ur5().chain;
  for (int j = 0; j < 6; ++j) rows[static_cast<std::size_t>(j) + 2] = ur.row(j);
  rows[0].alpha = quarter;
  rows[1].alpha = -quarter;
  return vn::DhChain<8>::from_rows(rows);
}

vn::DhChain<7> seven_joints() {
  constexpr double quarter = 1.5707963267948966;
  return vn::DhChain<7>::from_rows({{{.alpha = -quarter, .d = 0.333},
                                     {.alpha = quarter},
                                     {.a = 0.0825, .alpha = quarter, .d = 0.316},
                                     {.a = -0.0825, .alpha = -quarter},
                                     {.alpha = quarter, .d = 0.384},
                                     {.a = 0.088, .alpha = quarter},
                                     {.d = 0.107}}});
}

template <int N>
vn::JointLimits<N> all_round(double reach) {
  return {vn::JointVector<N>::Constant(-reach), vn::JointVector<N>::Constant(reach)};
}

/// Joint values at positions of a grid about a middle pose, orientation nearly constant.
template <int N>
vn::JointRows<N> on_a_grid(const vn::DhChain<N>& chain, const vn::JointVector<N>& middle, int per_side, double side,
                           double turn, std::uint64_t seed) {
  vn::Rng rng(seed);
  const vn::Isometry3 centre = chain.pose(middle);
  std::vector<vn::JointVector<N>> out;
  for (int x = 0; x < per_side; ++x)
    for (int y = 0; y < per_side; ++y)
      for (int z = 0; z < per_side; ++z) {
        const auto at = [&](int k) { return side * (static_cast<double>(k) / (per_side - 1) - 0.5); };
        vn::Isometry3 pose = centre;
        pose.translation() += vn::Vector3(at(x), at(y), at(z));
        const vn::Vector3 tilt{rng.uniform(-turn, turn), rng.uniform(-turn, turn), rng.uniform(-turn, turn)};
        pose.linear() = pose.linear() * vn::exp_so3(tilt);
        const auto found = vn::inverse_kinematics(chain, pose, middle);
        if (found.status == vn::IkStatus::converged) out.push_back(found.joints);
      }
  vn::JointRows<N> rows(static_cast<Index>(out.size()), N);
  for (Index i = 0; i < rows.rows(); ++i) rows.row(i) = out[static_cast<std::size_t>(i)].transpose();
  return rows;
}

/// An ordered session: small steps from pose to pose.
template <int N>
vn::JointRows<N> in_small_steps(const vn::JointLimits<N>& limits, Index n, double step, std::uint64_t seed) {
  vn::Rng rng(seed);
  vn::JointRows<N> out(n, N);
  vn::JointVector<N> q = 0.5 * (limits.lower + limits.upper);
  for (Index i = 0; i < n; ++i) {
    for (int j = 0; j < N; ++j) {
      const double range = limits.upper(j) - limits.lower(j);
      q(j) += step * range * rng.normal();
      if (q(j) > limits.upper(j)) q(j) = 2 * limits.upper(j) - q(j);
      if (q(j) < limits.lower(j)) q(j) = 2 * limits.lower(j) - q(j);
    }
    out.row(i) = q.transpose();
  }
  return out;
}

bool wanted(int argc, char** argv, const char* name) { return argc < 2 || std::strcmp(argv[1], name) == 0; }

}  // namespace

int main(int argc, char** argv) {
  const auto seeds = static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 5);
  const auto irb = vn::robots::abb_irb120();
  const auto ur10 = vn::robots::ur10();
  vn::JointLimits<6> ranges;
  ranges.lower = vn::JointVector<6>(-2.5, -2.6, 0.3, -2.5, -2, -2.5);
  ranges.upper = vn::JointVector<6>(2.5, -0.6, 2.4, 2.5, 2, 2.5);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    if (wanted(argc, argv, "exact")) {
      const auto actual = made(irb.chain, exact, rigid, seed);
      const auto data = vn::measure(actual, vn::sample_joints(irb.limits, 20, seed),
                                    {.position = 2e-3, .with_orientations = false}, seed);
      study<6>("exact", seed, irb.chain, actual, {data}, vn::sample_joints(irb.limits, 200, 1000 + seed));
    }
    if (wanted(argc, argv, "exact-oriented")) {
      const auto actual = made(irb.chain, exact, rigid, seed);
      const auto data =
          vn::measure(actual, vn::sample_joints(irb.limits, 20, seed), {.position = 2e-3, .orientation = 2e-3}, seed);
      study<6>("exact-oriented", seed, irb.chain, actual, {data}, vn::sample_joints(irb.limits, 200, 1000 + seed));
    }
    if (wanted(argc, argv, "mobile")) {
      const auto chain = mobile_manipulator();
      auto limits = all_round<8>(2.5);
      limits.lower(0) = 0, limits.upper(0) = 1;
      const auto actual = made(chain, {.length_min = 0, .angle_min = 0, .angle_max = 1e-3}, rigid, seed);
      for (const bool oriented : {false, true}) {
        const auto data = vn::measure(actual, vn::sample_joints(limits, 34, seed),
                                      {.position = 2e-3, .orientation = 2e-3, .with_orientations = oriented}, seed);
        study<8>(oriented ? "mobile-oriented" : "mobile", seed, chain, actual, {data},
                 vn::sample_joints(limits, 200, 1000 + seed));
      }
    }
    if (wanted(argc, argv, "grid")) {
      const auto actual = made(ur10.chain, {.length_min = 0, .length_max = 0.5e-3, .angle_min = 0, .angle_max = 0.5e-3},
                               {.harmonic = 0.03e-3}, seed);
      const vn::JointVector<6> middle(0.3, -1.5, 1.6, -0.4, 1.2, 0.2);
      for (const bool oriented : {false, true}) {
        const auto data = vn::measure(actual, on_a_grid<6>(ur10.chain, middle, 4, 0.12, 0.05, seed),
                                      {.position = 0.1e-3, .orientation = 0.1e-3, .with_orientations = oriented}, seed);
        study<6>(oriented ? "grid-oriented" : "grid", seed, ur10.chain, actual, {data},
                 vn::sample_joints(ranges, 300, 1000 + seed));
      }
    }
    if (wanted(argc, argv, "path")) {
      const auto actual =
          made(ur10.chain, {.length_min = 0, .angle_min = 0, .angle_max = 1e-3}, {.harmonic = 0.03e-3}, seed);
      const vn::JointVector<6> middle(0.3, -1.5, 1.6, -0.4, 1.2, 0.2);
      const auto grid = on_a_grid<6>(ur10.chain, middle, 12, 0.5, 1e-4, seed);
      vn::JointRows<6> path(120, 6);
      for (Index i = 0; i < 120; ++i) path.row(i) = grid.row((i / 12) * 144 % grid.rows() + i % 12);
      for (const bool oriented : {false, true}) {
        const auto data = vn::measure(
            actual, path, {.position = 0.05e-3, .orientation = 0.1e-3, .with_orientations = oriented}, seed);
        study<6>(oriented ? "path-oriented" : "path", seed, ur10.chain, actual, {data}, path);
      }
    }
    if (wanted(argc, argv, "gears")) {
      const auto actual = made(ur10.chain, {.length_min = 0, .angle_min = 0, .angle_max = 1e-3},
                               {.gear_ratio = 3e-4, .coupling = 0, .compliance = 0, .harmonic = 0}, seed);
      const auto data =
          vn::measure(actual, vn::sample_joints(ranges, 100, seed), {.position = 0.1e-3, .orientation = 0.1e-3}, seed);
      study<6>("gears", seed, ur10.chain, actual, {data}, vn::sample_joints(ranges, 300, 1000 + seed));
    }
    if (wanted(argc, argv, "no-harmonics")) {
      vn::CalibrateOptions options;
      options.errors.harmonics = 0;
      const auto actual =
          made(ur10.chain, {.length_min = 0, .angle_min = 0, .angle_max = 1e-3}, {.harmonic = 0.2e-3}, seed);
      for (const Index poses : {60, 400}) {
        const auto data = vn::measure(actual, vn::sample_joints(ranges, poses, seed),
                                      {.position = 0.1e-3, .orientation = 0.1e-3}, seed);
        study<6>("no-harmonics", seed, ur10.chain, actual, {data}, vn::sample_joints(ranges, 300, 1000 + seed),
                 options);
      }
    }
    if (wanted(argc, argv, "line")) {
      const auto actual =
          made(ur10.chain, {.length_min = 0, .angle_min = 0, .angle_max = 1e-3}, {.harmonic = 0.03e-3}, seed);
      const vn::JointVector<6> middle(0.3, -1.5, 1.6, -0.4, 1.2, 0.2);
      const auto grid = on_a_grid<6>(ur10.chain, middle, 6, 0.5, 0, seed);
      for (const bool oriented : {false, true}) {
        const auto data = vn::measure(
            actual, grid, {.position = 0.05e-3, .orientation = 0.1e-3, .with_orientations = oriented}, seed);
        study<6>(oriented ? "line-oriented" : "line", seed, ur10.chain, actual, {data}, grid);
      }
    }
    if (wanted(argc, argv, "ordered")) {
      const auto chain = seven_joints();
      const auto limits = all_round<7>(1.5);
      const auto actual = made(chain, {.length_min = 0, .angle_min = 0, .angle_max = 2e-3}, {.harmonic = 0.1e-3}, seed);
      for (const bool oriented : {false, true}) {
        const auto data = vn::measure(actual, in_small_steps(limits, 150, 0.08, seed),
                                      {.position = 1e-3, .orientation = 2e-3, .with_orientations = oriented}, seed);
        study<7>(oriented ? "ordered-oriented" : "ordered", seed, chain, actual, {data},
                 vn::sample_joints(limits, 300, 1000 + seed));
      }
    }
  }
}
