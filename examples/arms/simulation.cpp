// SPDX-License-Identifier: BSD-3-Clause
#include "simulation.hpp"

#include <string>

#include "dispatch.hpp"

namespace support {

MeasuredPoses simulate_poses(const vernier::RobotDescription& robot, const vernier::MatrixX& joints,
                             const SimulationSettings& settings, std::uint64_t seed, int points,
                             const vernier::ObserverRef& observer) {
  vernier::demand(joints.cols() == robot.controller_joints(), "simulate: joint values of ", joints.cols(), " joints, ",
                  robot.name, " has ", robot.controller_joints());
  const vernier::MatrixX chain = robot.controller.same() ? joints : robot.controller.to_chain(joints);
  return dispatch_dof(robot.dof(), [&](auto n) {
    constexpr int N = n();
    const auto measured = simulated(robot.arm<N>(), vernier::JointRows<N>(chain), settings, seed, points, {}, observer);
    MeasuredPoses out;
    if (points == 1) {
      out.joints = joints;
      out.positions = measured.front().positions();
      out.orientations = measured.front().orientations();
      return out;
    }
    out.joints.resize(joints.rows() * points, joints.cols());
    out.positions.resize(out.joints.rows(), 3);
    vernier::Index row = 0;
    for (vernier::Index i = 0; i < joints.rows(); ++i)
      for (int point = 0; point < points; ++point, ++row) {
        out.joints.row(row) = joints.row(i);
        out.positions.row(row) = measured[static_cast<std::size_t>(point)].positions().row(i);
        out.points.push_back(std::to_string(point + 1));
      }
    return out;
  });
}

}  // namespace support
