// SPDX-License-Identifier: BSD-3-Clause
#include "plan_task.hpp"

#include "dispatch.hpp"

namespace support {

namespace {

namespace vn = vernier;

template <int N>
PlanOutcome plan_of(const PlanTask& task, std::uint64_t seed, const vn::ObserverRef& observer) {
  const vn::DescribedRobot<N> robot = task.robot.arm<N>();
  vn::PlanOptions options{.count = task.count, .oriented = task.oriented, .observer = observer};
  options.errors.drives = robot.drives;
  options.errors.down = robot.down;
  options.errors.controller = robot.controller;
  vn::MeasurementConstraints constraints{.controller = robot.controller};
  if (task.box) constraints.tool_box = *task.box;
  if (task.tracker) constraints.tracker = vn::Tracker{.position = *task.tracker, .acceptance = task.acceptance};
  if (task.link_radius > 0) constraints.link_radii.assign(N, task.link_radius);
  vn::Measurements<N> measured;
  for (const MeasuredPoses& poses : task.measured) measured.add(dataset_of<N>(poses, robot.controller));
  vn::MeasurementCandidates<N> candidates{vn::JointRows<N>(0, N)};
  if (task.given.rows() > 0) {
    const vn::MatrixX chain = robot.controller.same() ? task.given : robot.controller.to_chain(task.given);
    candidates.joints = chain;
    candidates.previous = candidates.joints;
    for (vn::Index i = 1; i < candidates.joints.rows(); ++i) candidates.previous.row(i) = candidates.joints.row(i - 1);
  } else {
    candidates = vn::sample_candidates(robot.arm, robot.limits, constraints, task.candidates, seed, observer);
    if (candidates.joints.rows() < task.candidates) return {};  // stopped
  }
  const vn::MeasurementPlan<N> found = vn::plan_measurements(robot.arm, candidates, options, measured);
  const vn::MatrixX joints = found.joints;
  return {robot.controller.same() ? joints : robot.controller.to_controller(joints), found};
}

}  // namespace

PlanOutcome plan(const PlanTask& task, std::uint64_t seed, const vn::ObserverRef& observer) {
  const int joints = task.robot.controller_joints();
  vn::demand(task.given.rows() == 0 || task.given.cols() == joints, "plan: candidates of ", task.given.cols(),
             " joints, ", task.robot.name, " has ", joints);
  for (const MeasuredPoses& poses : task.measured)
    vn::demand(poses.joints.cols() == joints, "plan: measurements of ", poses.joints.cols(), " joints, ",
               task.robot.name, " has ", joints);
  return dispatch_dof(task.robot.dof(), [&](auto n) { return plan_of<n()>(task, seed, observer); });
}

}  // namespace support
