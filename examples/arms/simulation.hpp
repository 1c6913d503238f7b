// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A virtual arm that is measured: links, gears, compliance and backlash err, drawn from a seed.

#include <algorithm>
#include <bit>
#include <cmath>
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
  double springs = 5e-6;               ///< standard deviation of the joints' compliances to payload [rad/(N m)]
};

/// A number of some joint values: other poses have other noise, the same ones the same.
inline std::uint64_t digest(const vernier::MatrixX& joints) {
  std::uint64_t out = 0;
  for (vernier::Index k = 0; k < joints.size(); ++k)
    out = vernier::child_seed(out, std::bit_cast<std::uint64_t>(joints.data()[k]));
  return out;
}

/// Whether two rows are under one payload.
inline bool same_payload(const vernier::MatrixX& payloads, vernier::Index row, vernier::Index other) {
  for (vernier::Index k = 0; k < payloads.cols(); ++k)
    if (std::isfinite(payloads(row, k)) && payloads(row, k) != payloads(other, k)) return false;
  return true;
}

/// Measures the virtual arm of a seed.
/// @param joints   of the chain, visited in their order
/// @param points   reflectors on the flange, the first in its place for any number of them; several measure no
///                 orientation
/// @param payloads what the arm carries, n x 4 as `Dataset::payloads` has them; no rows: nothing
/// @param observer told of the poses of each reflector
/// @return         the rows of each reflector
/// @throws std::runtime_error where the observer requests a stop
template <int N>
std::vector<vernier::Dataset<N>> simulated(const vernier::DescribedRobot<N>& robot, const vernier::JointRows<N>& joints,
                                           const SimulationSettings& settings, std::uint64_t seed, int points = 1,
                                           const vernier::MatrixX& payloads = {},
                                           const vernier::ObserverRef& observer = {}) {
  namespace vn = vernier;
  const auto types = robot.arm.model().joint_types();
  const auto chain = vn::with_geometric_errors(robot.arm.model(), {}, vn::child_seed(seed, 0));
  vn::JointErrorSizes sizes{.harmonic = settings.gears, .harmonics = 30, .ripple = settings.gears / 20};
  if (payloads.rows() > 0) sizes.payload = settings.springs;
  sizes.down = robot.down;
  sizes.controller = robot.controller;
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
  // gears, or motors that err, lag behind
  const vn::MotorAngles motors(robot.controller);
  const vn::JointRows<N> approach = vn::approach_directions<N>(vn::JointRows<N>(motors.angles(joints)));
  vn::JointRows<N> effective = joints;
  for (int j = 0; j < N; ++j) {
    if (types[static_cast<std::size_t>(motors.row_of(j))] != vn::JointType::revolute) continue;
    for (int row = 0; row < N; ++row)
      if (const double moved = motors.none() ? (row == j ? 1 : 0) : motors.moved(row, j); moved != 0)
        for (vn::Index i = 0; i < joints.rows(); ++i) effective(i, row) -= moved * approach(i, j) * settings.backlash;
  }
  const vn::MeasurementNoise noise{settings.position_noise, settings.orientation_noise,
                                   settings.orientations && points == 1};
  std::vector<vn::Dataset<N>> out;
  vn::Vector3 tool_point;  // where a payload is whose centre is not stated
  for (int point = 0; point < points; ++point) {
    const vn::Isometry3 tool = robot.arm.tool() * drawn(0.1, 1);
    if (point == 0) tool_point = tool.translation();
    std::vector<vn::Isometry3> poses;
    constexpr vn::Index block = 1024;
    for (vn::Index i = 0, end = 0; i < joints.rows(); i = end) {  // rows under one payload, a few at a time
      if (!observer({i, i, 0})) throw std::runtime_error("the simulation was stopped");
      for (end = i + 1; end < joints.rows() && end < i + block && same_payload(payloads, i, end);) ++end;
      const vn::Payload carried = payloads.rows() > 0 ? vn::Payload::of(payloads, i).at(tool_point) : vn::Payload{};
      const vn::Framed<vn::WithJointErrors<vn::DhChain<N>>> arm(
          vn::WithJointErrors<vn::DhChain<N>>(chain, errors.carrying(carried)), base, tool);
      const auto now = arm.poses(effective.middleRows(i, end - i));
      poses.insert(poses.end(), now.begin(), now.end());
    }
    const vn::detail::MeasuredPoses seen = vn::detail::measured_poses(
        poses, noise, vn::child_seed(seed, digest(joints) + static_cast<std::uint64_t>(point)));
    out.push_back(vn::Dataset<N>(joints, seen.positions, seen.orientations).carrying(payloads));
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
