// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Objects around a virtual IRB 120 that it can touch.

#include <cmath>
#include <cstdint>
#include <vector>

#include "vernier/core/register_points.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/identification/contact_report.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/touches.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier_test {

using IrbArm = vernier::Framed<vernier::DhChain<6>>;

/// As designed; the tip of its probe is only known to some millimetres.
inline IrbArm nominal_arm() {
  return IrbArm(vernier::robots::abb_irb120().chain, {},
                vernier::FrameParameters(vernier::Vector6{0.04, -0.02, 0.1, 0, 0, 0}));
}

/// As made.
inline IrbArm actual_arm(std::uint64_t seed = 5) {
  return IrbArm(vernier::with_geometric_errors(vernier::robots::abb_irb120().chain, {}, seed), {},
                vernier::FrameParameters(vernier::Vector6{0.043, -0.021, 0.104, 0, 0, 0}));
}

/// Mean distance from it at fresh joints, the base registered [m].
template <class Arm>
double registered_mean(const Arm& arm) {
  using namespace vernier;
  const JointRows<6> joints = sample_joints(abb_irb120_operating_region().limits, 100, 78);
  PointRows points(100, 3), actual(100, 3);
  for (Index i = 0; i < 100; ++i) {
    set_point(points, i, arm.position(configuration(joints, i)));
    set_point(actual, i, actual_arm().position(configuration(joints, i)));
  }
  const Isometry3 base = register_points(points, actual);
  double out = 0;
  for (Index i = 0; i < 100; ++i) out += (transformed(base, point(points, i)) - point(actual, i)).norm() / 100;
  return out;
}

/// Touches of an object by the arm as made.
inline vernier::Contact touched(const vernier::VirtualObject& object, const char* name, const vernier::VectorX& known,
                                double sigma = 0, std::uint64_t seed = 1) {
  return vernier::touch(actual_arm(), object, name, known, vernier::abb_irb120_operating_region().limits, sigma, seed);
}

/// n zeros, the last m of them another value.
inline vernier::VectorX lengths(vernier::Index n, vernier::Index m = 0, double value = 0) {
  vernier::VectorX out = vernier::VectorX::Zero(n);
  for (vernier::Index k = n - m; k < n; ++k) out(k) = value;
  return out;
}

inline const vernier::VirtualObject table{vernier::ContactKind::plane, {0.35, 0, 0.25}, {0, 0, 1}, 0.3};
inline const vernier::VirtualObject front{vernier::ContactKind::plane, {0.45, 0, 0.4}, {1, 0, 0}, 0.3};
inline const vernier::VirtualObject side{vernier::ContactKind::plane, {0.3, 0.3, 0.4}, {0, 1, 0}, 0.3};

/// Touches of three planes; with a gauge block on the first, or without.
inline std::vector<vernier::Contact> three_planes(bool with_length, vernier::Index each = 20, double sigma = 0) {
  return {touched(table, "table", lengths(each, with_length ? each / 2 : 0, 0.1), sigma, 1),
          touched(front, "front", lengths(each), sigma, 2), touched(side, "side", lengths(each), sigma, 3)};
}

/// The variance of touches in units of the sensor's, by what is left of them and the degrees of freedom: a parameter
/// with a prior takes away as much of one as the touches add to the prior, places of objects take away one each.
inline double variance_of_touches(const vernier::ContactReport& found, vernier::Index values, vernier::Index of_objects,
                                  double sigma) {
  double freedom = static_cast<double>(values - of_objects);
  for (std::size_t i = 0; i < found.free.size(); ++i) {
    const vernier::ParameterEstimate& p = found.parameters[static_cast<std::size_t>(found.free[i])];
    const auto at = static_cast<vernier::Index>(i);
    freedom -= 1 - found.independent_covariance(at, at) / std::pow(p.prior_std, 2);
  }
  return std::pow(found.rms_after / sigma, 2) * static_cast<double>(values) / freedom;
}

}  // namespace vernier_test
