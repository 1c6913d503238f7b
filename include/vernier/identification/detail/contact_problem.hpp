// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An arm and the objects that it touched, as one calibration problem.

#include <span>
#include <utility>
#include <vector>

#include "vernier/data/contacts.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/identification/known_geometry.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier::detail {

/// What touches determine: independent unknowns, and what absorbs the others.
struct ContactSelection {
  std::vector<GeometricUnknown> base;
  std::vector<std::pair<GeometricUnknown, std::vector<GeometricUnknown>>> dependent;
};

/// An arm in the frames of the objects that it touched, one station an object; refers to its arguments. The links that
/// are called nominal are those of an earlier calibration where there is one.
class ContactProblem {
 public:
  VERNIER_API ContactProblem(const ArmGeometry& nominal_arm, std::span<const Contact> touched,
                             const IdentifyOptions& identify_options, const SensorModel& sensor_model);

  const IdentifyOptions& options;
  const SensorModel& sensors;
  std::span<const Contact> contacts;
  IdentificationPlan plan;
  ArmGeometry nominal;
  CalibrationProblem problem;
  const KnownGeometry* known = nullptr;  ///< an earlier calibration; null for none
  double known_change = 0.15;            ///< how much of it has changed since, in expected sizes of errors
  double variance = 1;                   ///< of the whitened noise, to which the earlier calibration's is relative
  bool scale_observable = true;          ///< whether touches determine the size of arm and objects together

  static constexpr double tool_precision = 1e-2;  ///< 0.1 m, so that it stays finite where little was touched
  const Contact& contact(int station) const { return contacts[static_cast<std::size_t>(station)]; }
  /// The first touch of an object.
  VERNIER_API Index first_block(int station) const;

  /// Every contact in the frame of its object, by nominal links and a tool point.
  VERNIER_API CalibrationProblem registered(const Vector3& tool_point) const;
  VERNIER_API std::vector<GeometricUnknown> unknowns_of_objects() const;
  /// The tool's point first, so that the ends of the chain yield to it.
  VERNIER_API std::vector<GeometricUnknown> unknowns_of_arm() const;
  /// Names what is estimated; chain parameters that no earlier calibration knows have priors of some precision.
  VERNIER_API void estimate(std::vector<GeometricUnknown> unknowns, double precision);
  /// Covariance of the prior of those unknowns that an earlier calibration knows, in steps, and which these are.
  struct KnownUnknowns {
    std::vector<Index> unknowns;
    MatrixX covariance;
  };
  VERNIER_API KnownUnknowns known_unknowns() const;
  /// The prior that holds what touches do not: an earlier calibration, or else the scale where they do not show it.
  VERNIER_API void hold();
  /// Separates independent from dependent unknowns at the present values, the scale aside.
  VERNIER_API ContactSelection select(const std::vector<GeometricUnknown>& candidates);

  /// The step of the unknowns that scales the arm and all objects, or the links alone.
  VERNIER_API VectorX scale_direction(bool links_alone) const;
  /// The Jacobian of touches that lie on their objects exactly: residuals, by noise alone, hide what is unobservable.
  VERNIER_API MatrixX touching_jacobian(const ArmParameterisation& arm) const;
  /// Of the residuals of a problem, per measured value, of one contact or of all [m].
  VERNIER_API static double residual_rms(const CalibrationProblem& of, int station = -1);
  VERNIER_API double residual_rms() const { return residual_rms(problem); }
};

/// Adds a row below a matrix.
VERNIER_API inline void append_row(MatrixX& matrix, const VectorX& row) {
  matrix.conservativeResize(matrix.rows() + 1, Eigen::NoChange);
  for (Index k = 0; k < row.size(); ++k) matrix(matrix.rows() - 1, k) = row(k);
}

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/contact_problem.ipp"
#endif
