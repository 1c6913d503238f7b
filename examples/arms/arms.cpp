// SPDX-License-Identifier: BSD-3-Clause
// From a number of joints known at run time to the instances of each number.

#include <string>

#include "calibrated_arm.hpp"
#include "calibration_task.hpp"
#include "dispatch.hpp"
#include "nominal_arm.hpp"
#include "vernier/core/data_error.hpp"

namespace support {

std::shared_ptr<const NominalArm> nominal_arm(const vernier::RobotDescription& description) {
  return dispatch_dof(description.dof(), [&](auto n) { return nominal_arm_of<n()>(description); });
}

std::shared_ptr<const CalibratedArm> calibrated_arm(const vernier::SavedModel& model) {
  return dispatch_dof(model.dof(), [&](auto n) { return calibrated_arm_of<n()>(model); });
}

CalibrationOutcome calibrate(const CalibrationTask& task, const vernier::FitOptions& fit) {
  const int joints = task.robot.controller_joints();
  const auto fits = [&](const vernier::MatrixX& rows) {
    vernier::demand(rows.cols() == joints, "calibrate: measurements of ", rows.cols(), " joints, ", task.robot.name,
                    " has ", joints);
  };
  for (const MeasuredPoses& poses : task.train.stations) fits(poses.joints);
  for (const MeasuredDistances& distances : task.train.distances) fits(distances.joints);
  if (task.test)
    for (const MeasuredPoses& poses : task.test->stations) fits(poses.joints);
  return dispatch_dof(task.robot.dof(), [&](auto n) { return calibrate_of<n()>(task, fit); });
}

}  // namespace support
