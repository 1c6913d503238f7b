// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What `calibrate` does with a saved model: it is registered again, or is the prior of another calibration.

#include <string>

#include "calibration_options.hpp"
#include "cli.hpp"
#include "vernier/error_model/arm_prior.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

/// An earlier calibration, of the same arm or of another of its type.
/// @param joints number that is expected
/// @throws UsageError for another arm, or a model without its covariance
vernier::ArmPrior prior_of(const vernier::SavedModel& model, int joints);

/// `calibrate --model --free`: estimates again how the arm stands, keeps everything else, and prints and saves the
/// model in its new frames.
/// @return exit code
/// @throws UsageError for unknown words in `--free`
/// @throws vernier::DataError on a malformed file
/// @throws vernier::CalibrationFailure for poses that do not determine it, or are not of this arm
int reregister_model(Program& program, const CalibrationOptions& options);

}  // namespace support
