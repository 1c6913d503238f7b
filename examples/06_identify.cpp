// SPDX-License-Identifier: BSD-3-Clause
// Find out how the real arm differs from its drawing: classical identification with Ceres.

#include <cstdio>
#include <vernier/ceres/identify.hpp>
#include <vernier/compensation/compensated.hpp>
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>

namespace vn = vernier;
using namespace vernier::literals;

int main() {
  // The actual arm stands somewhere else than we think and holds a probe: frames are unknown too.
  const auto nominal = vn::robots::abb_irb120().chain;
  vn::Isometry3 base = vn::Isometry3::Identity(), tool = vn::Isometry3::Identity();
  base.translation() << 2.1, -0.4, 0.3;
  base.linear() = vn::exp_so3(vn::Vector3(0.01, -0.02, 1.2));
  tool.translation() << 5_mm, -3_mm, 109_mm;
  const vn::Framed actual(vn::with_geometric_errors(nominal, {}, /*seed=*/1), base, tool);

  // 100 positions from a tracker with 0.03 mm noise, and held-out ones without noise.
  const auto region = vn::abb_irb120_operating_region();
  const auto train =
      vn::measure(actual, region.sample(nominal, 100, 1), {.position = 0.03_mm, .with_orientations = false});
  const auto test = vn::measure(actual, region.sample(nominal, 500, 2));

  const auto identified = vn::identify(nominal, train, {.frames = vn::Frames::base_and_tool});
  std::printf("%s\n", identified.summary().c_str());

  std::printf("Mean error on 500 fresh poses: frames alone %.3f mm, with geometry %.4f mm\n\n",
              vn::prediction_error(identified.model.nominal(), test).mean * 1e3,
              vn::prediction_error(identified.model, test).mean * 1e3);

  // Some of the parameters: as drawn, as built, and as found with its standard deviation.
  const vn::VectorX built = actual.parameters();  // base, links, tool: the order of identified.parameters too
  for (vn::Index k = 0; k < built.size(); ++k) {
    const auto& p = identified.parameters[static_cast<std::size_t>(k)];
    if (p.name != "a2" && p.name != "a3" && p.name != "d4") continue;
    std::printf("  %s: drawn %.3f mm, built %.3f mm, found %.3f +- %.3f mm\n", p.name.c_str(), p.nominal * 1e3,
                built(k) * 1e3, p.identified * 1e3, p.std * 1e3);
  }

  // The identified model is a kinematic model like any other, so commands can be corrected with it.
  const auto compensated = vn::compensate(identified.model);
  const vn::JointVector<6> target = test.joints(0), command = compensated.correct(target).command;
  const vn::Vector3 wanted = compensated.nominal().position(target);
  std::printf("\none target: %.3f mm off as commanded, %.4f mm corrected\n",
              (actual.position(target) - wanted).norm() * 1e3, (actual.position(command) - wanted).norm() * 1e3);
}
