// SPDX-License-Identifier: BSD-3-Clause
// What a camera and a printed board make of simulated arms whose intrinsics are unknown: `camera_study [ARMS]`. 60
// views of 9 x 12 corners, 0.2 px; the camera on the flange with two places of the board, or standing still. Figures
// are mean position errors at 1,000 random configurations after registration of base and tool point [mm].

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "simulated_views.hpp"
#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/core/detail/steady_seconds.hpp"
#include "vernier/kinematics/robots.hpp"

namespace {

namespace vn = vernier;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void study(const vn::Robot<6>& robot, bool on_flange, int arms) {
  std::vector<double> nominal, identified, seconds;
  for (int arm = 0; arm < arms; ++arm) {
    const auto seed = static_cast<std::uint64_t>(arm);
    const auto actual = vn::with_geometric_errors(robot.chain, {}, 100 + seed);
    vernier_test::ViewSetup setup;
    setup.on_flange = on_flange;
    const auto simulated = vernier_test::simulated_views(actual, robot.limits, setup, seed + 1);
    const double began = vn::detail::steady_seconds();
    const auto found = vn::calibrate_by_camera(
        robot, setup.board, simulated.views, simulated.rows,
        {.mount = on_flange ? vn::CameraMount::flange : vn::CameraMount::fixed, .left_out = false});
    seconds.push_back(vn::detail::steady_seconds() - began);
    const auto error = [&](const vn::DhChain<6>& chain) {
      return 1e3 * vernier_test::error_after_registration(chain, actual, robot.limits, 7);
    };
    nominal.push_back(error(robot.chain));
    identified.push_back(error(found.model.identified().model()));
  }
  std::printf("%-12s %-7s nominal %.2f   median %.4f   worst %.4f   %.1f s an arm\n", std::string(robot.name).c_str(),
              on_flange ? "flange" : "fixed", median(nominal), median(identified),
              *std::max_element(identified.begin(), identified.end()), median(seconds));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int arms = argc > 1 ? (std::max)(1, std::atoi(argv[1])) : 20;
  for (const bool on_flange : {true, false}) {
    study(vn::robots::ur10(), on_flange, arms);
    study(vn::robots::abb_irb120(), on_flange, arms);
  }
  return 0;
}
