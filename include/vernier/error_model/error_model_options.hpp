// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which joint errors an error model may have, and their expected sizes.

#include <optional>
#include <vector>

#include "vernier/core/controller_map.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/error_terms/joint_terms.hpp"
#include "vernier/kinematics/joint_drive.hpp"

namespace vernier {

struct ArmPrior;

/// Number of steps of `fit_error_model`, of which an observer is told.
inline constexpr Index fit_steps = 10;

/// Options of `fit_error_model`. The defaults serve every robot: evidence scales the expected sizes, and
/// leave-one-pose-out errors decide which blocks of joint errors the data support.
struct ErrorModelOptions {
  bool compliance = true;  ///< elastic deflection of joints under gravity
  bool gear_ratio = true;  ///< joint errors proportional to the joint value; beside harmonics, or in their place
  bool coupling = true;    ///< joint errors proportional to the value of the joint before; likewise
  int harmonics = 500;     ///< highest order of the harmonics of each joint, at most 60 below 400 measurements; 0: none
  HarmonicSpectrum spectrum = typical_spectrum();  ///< orders of the Fourier terms, and their expected sizes
  std::vector<JointDrive> drives{};      ///< gears and encoders, one a joint: adds their orders up to `harmonics`
  ControllerMap controller{};            ///< says whether gears err at motors, see `ControllerMap::motor_errors`
  bool find_lines = true;                ///< search for further orders up to 2,500, from 400 measurements on
  bool tool_per_station = false;         ///< every station has its own tool frame, not only its own base frame
  Vector3 down{0, 0, -1};                ///< direction of gravity in the arm's base frame
  bool estimate_down = false;            ///< whether that is only where a search for it starts, if compliance is found
  double compliance_prior_std = 1e-3;    ///< expected product of compliance and weight [rad/m]
  double payload_prior_std = 3e-5;       ///< expected compliance of a joint to payload [rad/(N m), m/N]
  double gear_ratio_prior_std = 1e-4;    ///< expected relative error of a gear ratio
  double coupling_prior_std = 1e-4;      ///< expected coupling
  bool hysteresis = true;                ///< joint errors that depend on the direction of approach
  double hysteresis_prior_std = 60e-6;   ///< expected half width of a hysteresis loop [rad, m]
  bool tilt = true;                      ///< tilts of the joints' frames under gravity
  double tilt_prior_std = 2e-3;          ///< expected tilt by each component of gravity's direction [rad]
  bool straightness = true;              ///< departures of prismatic joints from a straight motion
  double straightness_prior_std = 3e-4;  ///< expected size of their first functions [m, rad]
  bool temperature = true;               ///< change of the geometry with temperature, where temperatures were measured
  double thermal_prior_std = 2e-5;       ///< expected relative change of a length [1/K], and change of an angle [rad/K]
  bool drift = true;                     ///< motion of the bases during a session
  const ArmPrior* prior = nullptr;       ///< an earlier calibration, which must outlive the fit; null for none
  double relevant_size = 0;          ///< from which an effect matters: displacement of the tool point [m]; 0: a tenth
                                     ///< of the left-out error, at least the sensor's standard deviation
  Index num_validation_poses = 200;  ///< approximate number of poses left out, one at a time, to validate a block
  /// Who watches; must outlive the call. Told after each of `fit_steps` steps (`Progress::generation`). It cannot stop
  /// the fit; an executor that throws does.
  ObserverRef observer{};

  /// The parameters of a block that the options allow, for `JointTerms::add`; none where they do not allow it, or where
  /// the parameters follow from the measurements.
  VERNIER_API std::optional<std::vector<double>> parameters(JointTermBlock::Kind kind, const Vector3& gravity) const;
  /// Expected size of a coefficient of a block, from 0. Those of a transmission follow the spectrum instead.
  VERNIER_API double expected_size(const JointTerms& terms, const JointTermBlock& block, Index coefficient) const;
  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/error_model_options.ipp"
#endif
