// SPDX-License-Identifier: BSD-3-Clause
// A camera against a tracker on simulated arms whose gears err: `camera_gear_study [ARMS] [PLACES]`. 300 planned
// views of 9 x 12 corners at 0.2 px, some places of the board, intrinsics unknown, against 300 poses of 0.03 mm and
// 0.05 mrad. Figures are mean position errors at random configurations inside the joint ranges that both measured,
// after registration of base and tool point [mm].

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "simulated_views.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/joints_by_camera.hpp"
#include "vernier/core/detail/steady_seconds.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/planning/plan_measurements.hpp"
#include "vernier/registration/reregister.hpp"
#include "vernier/simulation/error_sources.hpp"

namespace {

namespace vn = vernier;
using Chain = vn::DhChain<6>;
using Actual = vn::WithJointErrors<Chain>;

/// Mean error at poses of the arm as made, with another tool point, after registration [mm].
template <class Model>
double registered_error(const Model& model, const vn::Dataset<6>& fresh) {
  constexpr double any = std::numeric_limits<double>::infinity();
  const auto found = vn::reregister(model, fresh, {.tool = true, .tool_position_prior_std = any});
  double sum = 0;
  for (vn::Index i = 0; i < fresh.size(); ++i)
    sum += (found.model.position(fresh.joints(i)) - fresh.position(i)).norm();
  return 1e3 * sum / static_cast<double>(fresh.size());
}

vn::ErrorModel<Chain> as_designed(const Chain& chain) { return {chain, vn::Framed<Actual>(Actual(chain), {}, {})}; }

/// Configurations inside the joint ranges of two sets of measurements.
vn::JointRows<6> inside(const vn::JointCoverage<6>& one, const vn::JointCoverage<6>& other, vn::Index n,
                        std::uint64_t seed) {
  vn::Rng rng(seed);
  vn::JointRows<6> out(n, 6);
  for (vn::Index i = 0; i < n;) {
    vn::JointVector<6> q;
    for (int j = 0; j < 6; ++j) q(j) = rng.uniform(-3, 3);
    if (one(q) >= 1 && other(q) >= 1) out.row(i++) = q.transpose();
  }
  return out;
}

/// 300 of many views, chosen as the poses of an arm as designed: those that tell most of geometry and joint errors.
vernier_test::SimulatedViews planned(const vernier_test::SimulatedViews& all, const vn::ErrorModelOptions& errors) {
  const vn::Framed<Chain> designed(vn::robots::ur10().chain, {}, all.tool);
  vn::MeasurementCandidates<6> candidates;
  candidates.joints = all.rows.joints;
  const auto plan = vn::plan_measurements(designed, candidates, {.count = 300, .errors = errors, .oriented = true});
  vernier_test::SimulatedViews out{all.views, {}, all.bases, all.tool};
  out.views.views.clear();
  out.rows.joints.resize(300, 6);
  for (std::size_t k = 0; k < plan.chosen.size(); ++k) {
    const auto of = static_cast<std::size_t>(plan.chosen[k]);
    out.views.views.push_back(all.views.views[of]);
    out.rows.images.push_back(all.rows.images[of]);
    out.rows.joints.row(static_cast<vn::Index>(k)) = all.rows.joints.row(plan.chosen[k]);
  }
  return out;
}

void study(std::uint64_t seed, int places) {
  const vn::Robot<6> robot = vn::robots::ur10();
  const vn::JointErrorSizes sizes{.harmonics = 5, .ripple = 0.02e-3};
  const Actual actual(vn::with_geometric_errors(robot.chain, {}, 100 + seed),
                      vn::draw_joint_errors(robot.chain, sizes, 200 + seed));
  vn::CalibrateOptions options;
  options.errors.tilt = options.errors.drift = options.errors.hysteresis = false;
  options.remainder.on_error_model = false;

  vernier_test::ViewSetup setup;
  setup.images = 1500;  // candidates
  setup.places = places;
  const auto simulated = planned(vernier_test::simulated_views(actual, robot.limits, setup, seed + 1), options.errors);
  const double began = vn::detail::steady_seconds();
  const auto found = vn::calibrate_joints_by_camera(
      robot, setup.board, simulated.views, simulated.rows, {.left_out = false}, [&](const vn::Measurements<6>& poses) {
        return vn::JointFit{vn::calibrate(robot.chain, poses, options).errors};
      });
  const auto by_camera = vn::calibrate(robot.chain, found.poses, options);
  const double seconds = vn::detail::steady_seconds() - began;

  const vn::Framed<Actual> with_probe(actual, {}, vn::Isometry3(Eigen::Translation3d(0.02, 0.03, 0.12)));
  vn::JointLimits<6> finite;
  finite.lower.setConstant(-3);
  finite.upper.setConstant(3);
  const auto tracked = vn::measure(with_probe, vn::sample_joints(finite, 300, seed + 7),
                                   {.position = 0.03e-3, .orientation = 0.05e-3}, seed + 8);
  vn::CalibrateOptions of_tracker = options;
  of_tracker.sensors.position_sigma = 0.03e-3;
  of_tracker.sensors.orientation_sigma = 0.05e-3;
  const auto by_tracker = vn::calibrate(robot.chain, tracked.without_approach(), of_tracker);

  const vn::Dataset<6> fresh = vn::measure(with_probe, inside(by_camera.coverage, by_tracker.coverage, 1000, seed + 9),
                                           {.position = 0, .with_orientations = false});
  const double camera = registered_error(by_camera.model(), fresh),
               tracker = registered_error(by_tracker.model(), fresh);
  std::printf("%3d   %7.3f   %8.4f   %7.4f   %7.4f   %5.2f   %6zu   %5.0f\n", static_cast<int>(seed),
              registered_error(as_designed(robot.chain), fresh),
              registered_error(by_camera.errors.models(vn::Stage::geometry).front(), fresh), camera, tracker,
              camera / tracker, found.moved.size(), seconds);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int arms = argc > 1 ? (std::max)(1, std::atoi(argv[1])) : 3;
  const int places = argc > 2 ? (std::max)(1, std::atoi(argv[2])) : 4;
  std::printf("arm   nominal   geometry    camera   tracker   ratio   rounds   s\n");
  for (int arm = 1; arm <= arms; ++arm) study(static_cast<std::uint64_t>(arm), places);
  return 0;
}
