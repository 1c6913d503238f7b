// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Poses that would determine weakly determined parameters.

#include <vector>

#include "vernier/calibration/calibration_report.hpp"
#include "vernier/core/controller_map.hpp"
#include "vernier/error_model/fitted_error_model.hpp"
#include "vernier/kinematics/joint_limits.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

namespace detail {

/// `vernier::pose_advice` for an arm whose number of joints is known at run time.
/// @param lower,upper limits of the controller's joints, at least as many
VERNIER_API std::vector<PoseAdvice> pose_advice(const ErrorModelEstimate& estimate,
                                                const IdentificationReport& identification, const VectorX& lower,
                                                const VectorX& upper, const SensorModel& sensors, bool oriented,
                                                std::size_t max_parameters, int poses,
                                                const ControllerMap& controller = {});

}  // namespace detail

/// For weakly determined parameters, which of 200 random poses within joint limits would determine them best.
/// @param fitted         an error model
/// @param identification of the same arm: names the weak parameters
/// @param limits         of the controller's joints; half a turn to either side (0.5 m) where there are none
/// @param sensors        that would measure
/// @param oriented       whether orientations would be measured too
/// @param max_parameters number of parameters
/// @param poses          number of poses for each
/// @param controller     in whose joints the poses are
template <class Chain>
std::vector<PoseAdvice> pose_advice(const FittedErrorModel<Chain>& fitted, const IdentificationReport& identification,
                                    const JointLimits<Chain::dof>& limits, const SensorModel& sensors, bool oriented,
                                    std::size_t max_parameters = 3, int poses = 3,
                                    const ControllerMap& controller = {}) {
  return detail::pose_advice(fitted, identification, limits.lower, limits.upper, sensors, oriented, max_parameters,
                             poses, controller);
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/pose_advice.ipp"
#endif
