// SPDX-License-Identifier: BSD-3-Clause
#include "simulation.hpp"

#include "dispatch.hpp"

namespace support {

MeasuredPoses simulate_poses(const vernier::RobotDescription& robot, const vernier::MatrixX& joints,
                             const SimulationSettings& settings, std::uint64_t seed) {
  vernier::demand(joints.cols() == robot.controller_joints(), "simulate: joint values of ", joints.cols(), " joints, ",
                  robot.name, " has ", robot.controller_joints());
  const vernier::MatrixX chain = robot.controller.same() ? joints : robot.controller.to_chain(joints);
  return dispatch_dof(robot.dof(), [&](auto n) {
    constexpr int N = n();
    const vernier::Dataset<N> measured = simulated(robot.arm<N>(), vernier::JointRows<N>(chain), settings, seed).front();
    MeasuredPoses out;
    out.joints = joints;
    out.positions = measured.positions();
    out.orientations = measured.orientations();
    return out;
  });
}

}  // namespace support
