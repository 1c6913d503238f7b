// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What is held out of measurements that are no poses: touched objects, measured distances.

#include <cstdint>
#include <string>
#include <vector>

#include "calibration_options.hpp"
#include "vernier/data/split.hpp"

namespace support {

/// Which of n things are held out, as the command line says.
/// @param seed of random choices
/// @param file for messages
/// @param what a thing in a word: "object"
/// @param rule becomes the choice in words
/// @throws UsageError for regions, which only positions have
/// @throws vernier::CalibrationFailure where nothing would be held out, or left to learn from
vernier::detail::SplitRows held_out_rows(vernier::Index n, const CalibrationOptions& options, std::uint64_t seed,
                                         const std::string& file, const char* what, std::string& rule);

/// Which of n things `--train` leaves to learn from; all of them without it.
/// @param what several things in a word: "objects"
/// @throws vernier::CalibrationFailure for fewer than are asked for
std::vector<vernier::Index> training_rows(vernier::Index n, const CalibrationOptions& options, std::uint64_t seed,
                                          const std::string& file, const char* what);

}  // namespace support
