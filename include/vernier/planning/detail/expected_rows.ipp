// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/measurements/pose_sensor.hpp"
#include "vernier/planning/detail/expected_rows.hpp"

namespace vernier::detail {

VERNIER_IMPL MatrixX expected_rows(const PlannedCalibration& planned, const ConstMatrixRef& joints,
                                   const ConstMatrixRef& previous) {
  const ArmGeometry& nominal = planned.nominal;
  const IdentificationPlan parameters(nominal, planned.geometry);
  std::vector<GeometricUnknown> unknowns;
  for (const Index k : parameters.candidates) {
    const double deviation = parameters.in_chain(k) ? 1 : 30;
    unknowns.push_back({k, -1, parameters.scales(k), 1 / (deviation * deviation)});
  }
  ArmParameterisation arm({nominal}, std::move(unknowns));
  const JointTerms terms = allowed_terms(nominal.chain(), planned.errors, planned.measurements);
  arm.set_terms(terms, expected_sizes(terms, planned.errors, spectra_of(planned.errors, nominal.joints())),
                VectorX::Ones(terms.size()));

  const std::vector<Isometry3> poses = arm.poses(0, joints);
  std::vector<Matrix3> orientations;
  for (const Isometry3& pose : poses)
    if (planned.oriented) orientations.push_back(rotation(pose));
  MeasuredSet set("planned poses", joints,
                  PoseSensor(positions_of(poses), std::move(orientations),
                             {planned.sensors.position_sigma, planned.sensors.orientation_sigma}));
  set.previous = previous;
  const CalibrationProblem problem(std::move(arm), {std::move(set)}, Loss::squared, planned.sensors.joint_sigma);
  MatrixX out = problem.stacked(true).jacobian;
  const VectorX precisions = problem.arm.precisions();
  for (Index k = 0; k < out.cols(); ++k) VERNIER_LATER(out).col(k) /= std::sqrt(precisions(k));
  return out;
}

}  // namespace vernier::detail
