// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/measurements/pose_sensor.hpp"
#include "vernier/planning/detail/expected_rows.hpp"

namespace vernier::detail {

VERNIER_IMPL CandidateRows expected_candidate_rows(const PlannedCalibration& planned, const ConstMatrixRef& joints,
                                                   const ConstMatrixRef& previous, const ObserverRef& observer) {
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
  const VectorX precisions = problem.arm.precisions();
  const Index few = problem.arm.num_dense(), n = joints.rows();
  CandidateRows out{planned.oriented ? 6 : 3, {}, {}, {}, problem.arm.group_sizes()};
  out.dense.resize(few, n * out.block);
  out.functions.resize(precisions.size() - few, n);
  out.factors.resize(static_cast<Index>(out.groups.size()), n * out.block);
  visit_blocks(problem.system(), 0, 1, n, [&](Index c, const RowBlock& rows) {
    if (c % 64 == 0) report_planning(observer, {});
    for (Index r = 0; r < out.block; ++r) {
      const Index column = c * out.block + r;
      for (Index k = 0; k < few; ++k) out.dense(k, column) = rows.dense(r, k) / std::sqrt(precisions(k));
      for (Index j = 0; j < out.factors.rows(); ++j)
        out.factors(j, column) = j < rows.factor.cols() ? rows.factor(r, j) : 0;
    }
    for (Index k = 0; k < out.functions.rows(); ++k)
      out.functions(k, c) = rows.functions(k) / std::sqrt(precisions(few + k));
  });
  return out;
}

VERNIER_IMPL MatrixX expected_rows(const PlannedCalibration& planned, const ConstMatrixRef& joints,
                                   const ConstMatrixRef& previous, const ObserverRef& observer) {
  const CandidateRows rows = expected_candidate_rows(planned, joints, previous, observer);
  return VERNIER_LATER(rows.columns(0, rows.size())).transpose();
}

}  // namespace vernier::detail
