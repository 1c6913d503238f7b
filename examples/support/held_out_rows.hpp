// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which measurements are held out: rows of poses or distances, touched objects.

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
/// @throws UsageError for regions, which are of measured positions
/// @throws vernier::CalibrationFailure where nothing would be held out, or left to learn from
vernier::detail::SplitRows held_out_rows(vernier::Index n, const CalibrationOptions& options, std::uint64_t seed,
                                         const std::string& file, const char* what, std::string& rule);

/// Held-out rows with all others at their poses, which would tell the answer.
/// @param joints n x joints [rad, m]
/// @param same   within which joint values rows are one pose
/// @param rule   the choice in words; says how many rows are added
/// @throws std::invalid_argument where none would be left to learn from
vernier::detail::SplitRows whole_poses(const vernier::detail::SplitRows& rows, const vernier::ConstMatrixRef& joints,
                                       const vernier::SamePose& same, std::string& rule);

/// Which of n things `--train` leaves to learn from; all of them without it.
/// @param what several things in a word: "objects"
/// @throws vernier::CalibrationFailure for fewer than are asked for
std::vector<vernier::Index> training_rows(vernier::Index n, const CalibrationOptions& options, std::uint64_t seed,
                                          const std::string& file, const char* what);

}  // namespace support
