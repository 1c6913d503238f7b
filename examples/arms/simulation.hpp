// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A virtual arm that is measured: links, gears, compliance and backlash err, drawn from a seed.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "measured_data.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/simulation/error_sources.hpp"

namespace support {

/// Sizes of what errs.
struct SimulationSettings {
  double position_noise = 0.03e-3;     ///< standard deviation of a position, per component [m]
  double orientation_noise = 0.05e-3;  ///< of an orientation [rad]
  double backlash = 0.02e-3;           ///< half the play of every gear [rad]
  double gears = 200e-6;               ///< standard deviation of errors of gears and encoders once a turn [rad]
  bool orientations = true;            ///< whether orientations are measured
};

/// A number of some joint values: other poses have other noise, the same ones the same.
inline std::uint64_t digest(const vernier::MatrixX& joints) {
  std::uint64_t out = 0;
  for (vernier::Index k = 0; k < joints.size(); ++k)
    out = vernier::child_seed(out, std::bit_cast<std::uint64_t>(joints.data()[k]));
  return out;
}

/// An arm whose poses are computed a few at a time, and are reported.
template <class Arm>
struct ObservedArm : Arm {
  vernier::ObserverRef observer;  ///< told how many poses are done

  ObservedArm(const Arm& arm, const vernier::ObserverRef& who) : Arm(arm), observer(who) {}

  /// base_T_tool at n configurations.
  /// @throws std::runtime_error where the observer requests a stop
  std::vector<vernier::Isometry3> poses(const vernier::JointRows<Arm::dof>& joints) const {
    constexpr vernier::Index block = 1024;
    std::vector<vernier::Isometry3> out;
    for (vernier::Index done = 0; done < joints.rows(); done += block) {
      if (!observer({done, done, 0})) throw std::runtime_error("the simulation was stopped");
      const vernier::JointRows<Arm::dof> some = joints.middleRows(done, std::min(block, joints.rows() - done));
      const auto found = vernier::poses(static_cast<const Arm&>(*this), some);
      out.insert(out.end(), found.begin(), found.end());
    }
    return out;
  }
};

/// Measures the virtual arm of a seed.
/// @param joints of the chain, visited in their order
/// @param points reflectors on the flange, the first in its place for any number of them; several measure no
/// orientation
/// @param observer told of the poses of each reflector
/// @return       the rows of each reflector
/// @throws std::runtime_error where the observer requests a stop
template <int N>
std::vector<vernier::Dataset<N>> simulated(const vernier::DescribedRobot<N>& robot, const vernier::JointRows<N>& joints,
                                           const SimulationSettings& settings, std::uint64_t seed, int points = 1,
                                           const vernier::ObserverRef& observer = {}) {
  namespace vn = vernier;
  const auto types = robot.arm.model().joint_types();
  const auto chain = vn::with_geometric_errors(robot.arm.model(), {}, vn::child_seed(seed, 0));
  vn::JointErrorSizes sizes{.harmonic = settings.gears, .harmonics = 30, .ripple = settings.gears / 20};
  sizes.down = robot.down;
  const auto errors = vn::draw_joint_errors(chain, sizes, vn::child_seed(seed, 1));
  // the sensor stands somewhere, the reflectors are somewhere on the flange
  vn::Rng rng(vn::child_seed(seed, 2));
  const auto drawn = [&](double position, double rotation) {
    vn::Isometry3 frame = vn::Isometry3::Identity();
    for (int k = 0; k < 3; ++k) frame.translation()(k) = rng.uniform(-position, position);
    frame.linear() = vn::exp_so3(vn::Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)) * rotation);
    return frame;
  };
  const vn::Isometry3 base = drawn(3, 1.5) * robot.arm.base();
  vn::JointVector<N> backlash = vn::JointVector<N>::Zero();
  for (int j = 0; j < N; ++j)
    if (types[static_cast<std::size_t>(j)] == vn::JointType::revolute) backlash(j) = settings.backlash;
  const vn::MeasurementNoise noise{settings.position_noise, settings.orientation_noise,
                                   settings.orientations && points == 1};
  std::vector<vn::Dataset<N>> out;
  for (int point = 0; point < points; ++point) {
    using Arm = vn::Framed<vn::WithJointErrors<vn::DhChain<N>>>;
    const ObservedArm<Arm> arm(
        Arm(vn::WithJointErrors<vn::DhChain<N>>(chain, errors), base, robot.arm.tool() * drawn(0.1, 1)), observer);
    out.push_back(vn::measure_with_backlash(arm, joints, backlash, vn::approach_directions<N>(joints), noise,
                                            vn::child_seed(seed, digest(joints) + static_cast<std::uint64_t>(point))));
  }
  return out;
}

/// Measures the virtual arm of a seed, whatever its number of joints.
/// @param joints n x joints of the controller, visited in their order [rad, m]
/// @param points   reflectors, see above; each pose is measured with all of them
/// @throws std::invalid_argument for another number of joints
/// @throws std::runtime_error where the observer requests a stop
MeasuredPoses simulate_poses(const vernier::RobotDescription& robot, const vernier::MatrixX& joints,
                             const SimulationSettings& settings, std::uint64_t seed, int points = 1,
                             const vernier::ObserverRef& observer = {});

}  // namespace support
