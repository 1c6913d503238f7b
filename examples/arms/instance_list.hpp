// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The functions that take longest to compile, as a list: `instances.hpp` declares their instances, the library
/// `vernier_instances` defines them.

#include "model_instances.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/calibration/verify_calibration.hpp"

/// The functions, as instances that are declared (`extern template`) or defined (`template`).
#define VERNIER_INSTANCES(keyword, N)                                                                                 \
  keyword Calibration<DhChain<N>> calibrate<Framed<DhChain<N>>>(const Framed<DhChain<N>>&, const Measurements<N>&,    \
                                                                const CalibrateOptions&);                             \
  keyword CalibrationReport evaluate<DhChain<N>>(const Calibration<DhChain<N>>&, const Measurements<N>&,              \
                                                 const JointLimits<N>&, const ControllerMap&);                        \
  keyword VerificationReport verify_calibration<DhChain<N>>(const ErrorModel<DhChain<N>>&, const ErrorModelEstimate&, \
                                                            const Measurements<N>&, const VerifyOptions&,             \
                                                            const PointRows&);                                        \
  VERNIER_MODEL_INSTANCES(keyword, N)
