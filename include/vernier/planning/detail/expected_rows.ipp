#pragma once

#include <cmath>
#include <utility>

#include "vernier/error_model/detail/expected_terms.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
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

  const MatrixX at = joints, from = previous;  // a station refers to contiguous columns
  const std::vector<Isometry3> poses = arm.poses(0, at);
  PointRows positions(at.rows(), 3);
  Station station{.joint_values = at.data(),
                  .samples = at.rows(),
                  .dof = nominal.joints(),
                  .previous_values = from.rows() > 0 ? from.data() : nullptr,
                  .positions = &positions,
                  .position_sigma = planned.sensors.position_sigma,
                  .orientation_sigma = planned.sensors.orientation_sigma,
                  .joint_sigma = planned.sensors.joint_sigma};
  for (Index i = 0; i < at.rows(); ++i) {
    const Isometry3& pose = poses[static_cast<std::size_t>(i)];
    set_point(positions, i, translation(pose));
    if (planned.oriented) station.orientations.push_back(rotation(pose));
  }
  const CalibrationProblem problem(std::move(arm), {std::move(station)}, Loss::squared);
  MatrixX out = problem.stacked(true).jacobian;
  const VectorX precisions = problem.arm.precisions();
  for (Index k = 0; k < out.cols(); ++k) out.col(k) /= std::sqrt(precisions(k));
  return out;
}

}  // namespace vernier::detail
