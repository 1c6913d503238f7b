// SPDX-License-Identifier: BSD-3-Clause
// Calibration without a tracker: 60 touches on three planes, one of them with a gauge block, against as many positions
// measured by a tracker with the same noise per component.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "vernier/ceres/identify.hpp"
#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/touches.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace {

namespace vn = vernier;
using vn::Index;
using vn::Vector3;
using Arm = vn::Framed<vn::WithJointErrors<vn::DhChain<6>>>;

constexpr double noise = 0.03e-3;

/// Mean position error of a model at measured poses, its base registered on them: contacts do not observe the base.
template <class Model>
double registered_error(const Model& model, const vn::Dataset<6>& data) {
  vn::PointRows points(data.size(), 3);
  for (Index i = 0; i < data.size(); ++i) points.row(i) = model.position(data.joints(i)).transpose();
  const vn::Isometry3 base = vn::register_points(points, data.positions());
  double sum = 0;
  for (Index i = 0; i < data.size(); ++i) sum += (base * Vector3(points.row(i).transpose()) - data.position(i)).norm();
  return sum / static_cast<double>(data.size());
}

struct Errors {
  double nominal, contacts, tracker, ratio;
};

Errors compare(std::uint64_t seed, double length, bool joint_errors, bool verbose) {
  const auto robot = vn::robots::abb_irb120();
  const auto region = vn::abb_irb120_operating_region();
  vn::JointErrorSizes sizes;
  if (!joint_errors) sizes = {.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0};
  const auto chain = vn::with_geometric_errors(robot.chain, {}, vn::child_seed(seed, 0));
  const Arm actual(vn::WithJointErrors<vn::DhChain<6>>(chain, vn::draw_joint_errors(chain, sizes, seed)), {},
                   vn::FrameParameters(vn::Vector6{0.043, -0.021, 0.104, 0, 0, 0}));
  const vn::Framed<vn::DhChain<6>> nominal(robot.chain, {},
                                           vn::FrameParameters(vn::Vector6{0.04, -0.02, 0.1, 0, 0, 0}));

  vn::VectorX heights = vn::VectorX::Zero(20);
  heights.tail(10).setConstant(length);
  const auto touch = [&](const vn::VirtualObject& plane, const char* name, const vn::VectorX& known, std::uint64_t k) {
    return vn::touch(actual, plane, name, known, region.limits, noise, vn::child_seed(seed, k));
  };
  using enum vn::ContactKind;
  const std::vector contacts{touch({plane, {0.35, 0, 0.25}, Vector3::UnitZ(), 0.3}, "table", heights, 1),
                             touch({plane, {0.45, 0, 0.4}, Vector3::UnitX(), 0.3}, "front", vn::VectorX::Zero(20), 2),
                             touch({plane, {0.3, 0.3, 0.4}, Vector3::UnitY(), 0.3}, "side", vn::VectorX::Zero(20), 3)};
  const auto by_contacts = vn::identify_by_contacts(nominal, contacts);
  if (verbose) std::printf("%s\n", by_contacts.summary().c_str());

  const auto measured = vn::measure(actual, region.sample(chain, 60, vn::child_seed(seed, 4)),
                                    {.position = noise, .with_orientations = false}, vn::child_seed(seed, 5));
  const auto by_tracker = vn::identify(nominal, measured, {.frames = vn::Frames::base_and_tool});
  const auto fresh =
      vn::measure(actual, region.sample(chain, 500, vn::child_seed(seed, 6)), {.with_orientations = false});
  const auto frames = vn::identify(nominal, fresh, {.frames = vn::Frames::base_and_tool, .geometry = false});
  Errors out{registered_error(frames.model, fresh), registered_error(by_contacts.model, fresh),
             registered_error(by_tracker.model, fresh), 0};
  out.ratio = (out.nominal - out.contacts) / (out.nominal - out.tracker);
  return out;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

}  // namespace

int main(int argc, char** argv) try {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 20;
  std::printf(
      "IRB 120, simulated; 60 touches of three planes, 10 of them on a gauge block of 100 mm, against 60 positions\n"
      "of a tracker; noise %.2f mm per component. Mean errors at 500 fresh poses, base registered [mm]; the\n"
      "nominal arm has its tool registered, too.\n",
      noise * 1e3);
  for (const bool joint_errors : {false, true}) {
    std::printf("\n%s\n  seed  nominal  contacts  tracker  (nominal - contacts) / (nominal - tracker)\n",
                joint_errors ? "Geometric and joint errors" : "Geometric errors");
    std::vector<double> columns[4];
    for (int seed = 1; seed <= seeds; ++seed) {
      const Errors e = compare(static_cast<std::uint64_t>(seed), 0.1, joint_errors, seed == 1 && !joint_errors);
      std::printf("  %4d  %7.4f  %8.4f  %7.4f  %5.3f\n", seed, e.nominal * 1e3, e.contacts * 1e3, e.tracker * 1e3,
                  e.ratio);
      int k = 0;
      for (const double value : {e.nominal, e.contacts, e.tracker, e.ratio}) columns[k++].push_back(value);
    }
    std::printf("  median %6.4f  %8.4f  %7.4f  %5.3f\n", median(columns[0]) * 1e3, median(columns[1]) * 1e3,
                median(columns[2]) * 1e3, median(columns[3]));
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "contact_study: %s\n", error.what());
  return 1;
}
