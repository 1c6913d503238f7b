// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The functions that take longest to compile, as a list: `instances.hpp` declares their instances, the files of
/// `vernier_arms` define them.

#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/calibration/verify_calibration.hpp"

/// The functions, as instances that are declared (`extern template`) or defined (`template`).
#define VERNIER_CALIBRATION_INSTANCES(keyword, N)                                                                  \
  keyword Calibration<DhChain<N>> calibrate<Framed<DhChain<N>>>(const Framed<DhChain<N>>&, const Measurements<N>&, \
                                                                const CalibrateOptions&);                          \
  keyword CalibrationReport evaluate<DhChain<N>>(const Calibration<DhChain<N>>&, const Measurements<N>&,           \
                                                 const JointLimits<N>&, const ControllerMap&);
#define VERNIER_VERIFICATION_INSTANCES(keyword, N)                                                                    \
  keyword VerificationReport verify_calibration<DhChain<N>>(const ErrorModel<DhChain<N>>&, const ErrorModelEstimate&, \
                                                            const Measurements<N>&, const VerifyOptions&,             \
                                                            const PointRows&);
