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

/// An arm with the errors of a seed.
template <int N>
class VirtualArm {
 public:
  /// @param loaded whether joints give way to payloads
  VirtualArm(const vernier::DescribedRobot<N>& robot, const SimulationSettings& settings, std::uint64_t seed,
             bool loaded = false)
      : chain_(vernier::with_geometric_errors(robot.arm.model(), {}, vernier::child_seed(seed, 0))),
        errors_(vernier::draw_joint_errors(chain_, sizes(robot, settings, loaded), vernier::child_seed(seed, 1))),
        motors_(robot.controller),
        backlash_(settings.backlash) {}

  /// Poses of the tool at joint values of the chain that are visited in their order.
  /// @param payloads n x 4, as `Dataset::payloads` has them; no rows: nothing
  /// @param observer told of the poses
  /// @throws std::runtime_error where the observer requests a stop
  std::vector<vernier::Isometry3> poses(const vernier::JointRows<N>& joints, const vernier::Isometry3& base,
                                        const vernier::Isometry3& tool, const vernier::MatrixX& payloads = {},
                                        const vernier::Vector3& load_at = vernier::Vector3::Zero(),
                                        const vernier::ObserverRef& observer = {}) const {
    namespace vn = vernier;
    const vn::JointRows<N> effective = lagging(joints);
    std::vector<vn::Isometry3> out;
    constexpr vn::Index block = 1024;
    for (vn::Index i = 0, end = 0; i < joints.rows(); i = end) {  // rows under one payload, a few at a time
      if (!observer({i, i, 0})) throw std::runtime_error("the simulation was stopped");
      for (end = i + 1; end < joints.rows() && end < i + block && same_payload(payloads, i, end);) ++end;
      const vn::Payload carried = payloads.rows() > 0 ? vn::Payload::of(payloads, i).at(load_at) : vn::Payload{};
      const vn::Framed<vn::WithJointErrors<vn::DhChain<N>>> arm(
          vn::WithJointErrors<vn::DhChain<N>>(chain_, errors_.carrying(carried)), base, tool);
      const auto now = arm.poses(effective.middleRows(i, end - i));
      out.insert(out.end(), now.begin(), now.end());
    }
    return out;
  }

 private:
  static vernier::JointErrorSizes sizes(const vernier::DescribedRobot<N>& robot, const SimulationSettings& settings,
                                        bool loaded) {
    vernier::JointErrorSizes out{.harmonic = settings.gears, .harmonics = 30, .ripple = settings.gears / 20};
    if (loaded) out.payload = settings.springs;
    out.down = robot.down;
    out.controller = robot.controller;
    return out;
  }
  /// Where the joints stand: gears, or motors that err, lag behind.
  vernier::JointRows<N> lagging(const vernier::JointRows<N>& joints) const {
    namespace vn = vernier;
    const auto types = chain_.joint_types();
    const vn::JointRows<N> approach = vn::approach_directions<N>(vn::JointRows<N>(motors_.angles(joints)));
    vn::JointRows<N> out = joints;
    for (int j = 0; j < N; ++j) {
      if (types[static_cast<std::size_t>(motors_.row_of(j))] != vn::JointType::revolute) continue;
      for (int row = 0; row < N; ++row)
        if (const double moved = motors_.none() ? (row == j ? 1 : 0) : motors_.moved(row, j); moved != 0)
          for (vn::Index i = 0; i < joints.rows(); ++i) out(i, row) -= moved * approach(i, j) * backlash_;
    }
    return out;
  }

  vernier::DhChain<N> chain_;
  vernier::JointErrors errors_;
  vernier::MotorAngles motors_;
  double backlash_;
};

/// A frame somewhere: within `position` [m] in each component, and turned by up to `rotation` [rad] about each axis.
inline vernier::Isometry3 drawn_frame(double position, double rotation, vernier::Rng& rng) {
  vernier::Isometry3 frame = vernier::Isometry3::Identity();
  for (int k = 0; k < 3; ++k) frame.translation()(k) = rng.uniform(-position, position);
  frame.linear() =
      vernier::exp_so3(vernier::Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)) * rotation);
  return frame;
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
  const VirtualArm<N> arm(robot, settings, seed, payloads.rows() > 0);
  // the sensor stands somewhere, the reflectors are somewhere on the flange
  vn::Rng rng(vn::child_seed(seed, 2));
  const vn::Isometry3 base = drawn_frame(3, 1.5, rng) * robot.arm.base();
  const vn::MeasurementNoise noise{settings.position_noise, settings.orientation_noise,
                                   settings.orientations && points == 1};
  std::vector<vn::Dataset<N>> out;
  vn::Vector3 tool_point;  // where a payload is whose centre is not stated
  for (int point = 0; point < points; ++point) {
    const vn::Isometry3 tool = robot.arm.tool() * drawn_frame(0.1, 1, rng);
    if (point == 0) tool_point = tool.translation();
    const vn::detail::MeasuredPoses seen =
        vn::detail::measured_poses(arm.poses(joints, base, tool, payloads, tool_point, observer), noise,
                                   vn::child_seed(seed, digest(joints) + static_cast<std::uint64_t>(point)));
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
