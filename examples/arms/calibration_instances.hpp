// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Calibrations, for all numbers of joints: declared here, and compiled once, in the library `vernier_instances`.

#include "dispatch.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/io/identified_robot.hpp"

/// These functions, as instances that are declared (`extern template`) or defined (`template`).
#define VERNIER_CALIBRATION_INSTANCES(keyword, N)                                                                     \
  keyword Calibration<DhChain<N>> calibrate<Framed<DhChain<N>>>(const Framed<DhChain<N>>&, const Measurements<N>&,    \
                                                                const CalibrateOptions&);                             \
  keyword CalibrationReport evaluate<DhChain<N>>(const Calibration<DhChain<N>>&, const Measurements<N>&,              \
                                                 const JointLimits<N>&, const ControllerMap&);                        \
  keyword VerificationReport verify_calibration<DhChain<N>>(const ErrorModel<DhChain<N>>&, const ErrorModelEstimate&, \
                                                            const Measurements<N>&, const VerifyOptions&,             \
                                                            const PointRows&);                                        \
  keyword CalibratedRobot<N> calibrated_robot<N, StandardDh>(const Calibration<DhChain<N>>&, const RobotInfo<N>&,     \
                                                             std::size_t);

namespace vernier {

#define VERNIER_DECLARE(N) VERNIER_CALIBRATION_INSTANCES(extern template, N)
VERNIER_FOR_ALL_DOF(VERNIER_DECLARE)
#undef VERNIER_DECLARE

}  // namespace vernier
