// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a fit of an error model estimated, whatever the arm: unknowns, their covariance, and what was decided on the
/// way.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "vernier/error_model/existence.hpp"
#include "vernier/error_model/stage.hpp"
#include "vernier/identification/arm_parameterisation.hpp"
#include "vernier/identification/fitted_arm.hpp"
#include "vernier/identification/session_drift.hpp"
#include "vernier/kinematics/joint_drive.hpp"

namespace vernier {

/// Decision on a block of unknowns. It is in the model if it exists, and if left-out poses are not predicted worse with
/// it by more than a standard error.
struct BlockChoice {
  Block block{};          ///< which unknowns
  double without = 0;     ///< mean leave-one-pose-out error without the block [m]
  double with = 0;        ///< with it, sized by evidence [m]
  bool used = false;      ///< whether it is in the model
  double precision = 1;   ///< of its prior: 1 for the expected sizes, t for sizes divided by sqrt(t); of joint-wise
                          ///< terms that of the lowest band of orders, of drift that of its random walk
  Existence existence{};  ///< whether it exists; untested where that is no question about the arm
};

/// What a transmission adds over some angles beyond its mean, which is the joint's zero; one value an angle [rad].
struct JointFunction {
  VectorX value;  ///< mean subtracted
  VectorX std;    ///< standard deviations of that
};

/// How much of an earlier calibration holds, see `ArmPrior`.
struct PriorTransfer {
  std::string name;     ///< of the earlier calibration
  double geometry = 0;  ///< kappa of the geometry: change relative to the expected sizes of its errors
  double joints = 0;    ///< kappa of the joint errors
  bool used = false;    ///< whether left-out poses are predicted better with it
};

namespace detail {

/// An arm of one station with some unknowns, at its values.
/// @param coefficient_scales     of its terms
/// @param coefficient_precisions of its terms
/// @param thermal_rates          of each parameter; empty for none
VERNIER_API ArmParameterisation parameterised(const FittedArm& arm, std::vector<GeometricUnknown> unknowns,
                                              const VectorX& coefficient_scales, const VectorX& coefficient_precisions,
                                              const VectorX& thermal_rates);

}  // namespace detail

/// A fitted error model without its typed arms.
struct ErrorModelEstimate {
  bool converged = false;             ///< whether every solve converged
  std::vector<BlockChoice> blocks{};  ///< decisions, in order
  double position_sigma = 0;  ///< of a visit, per component: sensor, and what the model lacks [m]; of a distance where
                              ///< nothing else was measured
  double joint_sigma = 0;     ///< of a visit, repeatability of the joints [rad]
  double orientation_sigma = 0;          ///< of a visit, per component [rad]; 0 for positions alone
  double fallback_error = 0;             ///< mean leave-one-pose-out position error without transmissions and tilts [m]
  std::vector<SessionDrift> drift{};     ///< of each station's base; empty where the data do not support it
  std::optional<PriorTransfer> prior{};  ///< of an earlier calibration, where there was one
  std::vector<JointDrive> drives{};      ///< gears and encoders, one a joint, as given; empty where unknown
  ArmParameterisation arm;               ///< the unknowns and their estimates
  double mean_temperature = 0;       ///< of the measurements [deg C], for which the parameters hold; 0 where the model
                                     ///< does not change with temperature
  double temperature_std = 0;        ///< standard deviation of the measured temperatures [K]; likewise
  double down_std = 0;               ///< standard deviation of the direction of gravity [rad]; 0 where that was given
  double leave_one_out_seconds = 0;  ///< time that leave-one-pose-out errors took
  VectorX left_out_errors{};         ///< of some poses, each predicted by the model without it, drift not known [m]
  std::vector<Index> left_out_rows{};  ///< which poses, counted over the stations
  VectorX geometry_left_out_errors{};  ///< of the same poses, by geometry and frames alone [m]
  double block_error = 0;              ///< mean error of blocks of neighbours left out, if poses follow a path; else 0
  MatrixX covariance{};                ///< of all unknowns, in units of their scales
  double variance_factor = 1;          ///< covariance divided by the inverse of the normal equations' matrix
  double residual_variance = 1;        ///< of the whitened residuals: that factor as far as the residuals alone tell

  /// What it says of a station, from 0.
  VERNIER_API ErrorModelEstimate of_station(int station) const;
  /// What it says of the first station.
  VERNIER_API ErrorModelEstimate first_station() const { return of_station(0); }
  /// This estimate at other values of the unknowns: of the arm in other frames, with other joint zeros.
  /// @param now with the same terms
  VERNIER_API ErrorModelEstimate of_arm(const FittedArm& now) const;

  /// The transmission error of a joint with its standard deviation, at some angles.
  /// @param joint  from 0
  /// @param angles n >= 1 values [rad]
  VERNIER_API JointFunction transmission(int joint, const std::vector<double>& angles) const;

  /// Covariance of the modelled pose at q, by the estimated unknowns alone. Position [m^2], then orientation [rad^2],
  /// base frame.
  /// @param q       one value a joint
  /// @param station from 0
  /// @complexity O(unknowns^2); allocates
  VERNIER_API Matrix6 model_covariance(const ConstVectorRef& q, int station = 0) const;

  /// Covariance of one visit at q: of parameters, joint-wise coefficients and repeatability. Position [m^2], then
  /// orientation [rad^2], base frame.
  /// @param q        one value a joint
  /// @param gate     share of transmissions and tilts in the prediction, in [0, 1]
  /// @param station  from 0
  /// @param previous joint values from which q was approached; empty, or not finite, where unknown: then hysteresis
  ///                 adds its half loops
  /// @param temperature of the arm [deg C]; not finite where unknown: then the effect of a standard deviation of the
  ///                 measured temperatures is added
  /// @complexity O(unknowns^2); allocates
  VERNIER_API Matrix6 visit_covariance(const ConstVectorRef& q, double gate, int station = 0,
                                       const ConstVectorRef& previous = VectorX(),
                                       double temperature = std::numeric_limits<double>::quiet_NaN()) const;
  /// Covariances of n visits, in a quarter of the time each.
  /// @param joints       n x joints
  /// @param gates        n
  /// @param station      from 0
  /// @param previous     n x joints; no rows where unknown
  /// @param temperatures n; none where unknown
  /// @param payloads     n x 4, see `Dataset::payloads`; no rows for the mean one of the measurements
  /// @param of_unknowns  whether that of the unknowns is part of them, which takes nearly all of the time
  VERNIER_API std::vector<Matrix6> visit_covariances(const ConstMatrixRef& joints, const ConstVectorRef& gates,
                                                     int station, const ConstMatrixRef& previous,
                                                     const ConstVectorRef& temperatures,
                                                     const ConstMatrixRef& payloads = MatrixX(),
                                                     bool of_unknowns = true) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/error_model_estimate.ipp"
#endif
