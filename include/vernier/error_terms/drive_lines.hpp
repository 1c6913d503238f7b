#pragma once

/// @file
/// Lines in the spectrum of a joint's errors: the orders at which gears and encoders err.

#include <string>

#include "vernier/error_terms/fourier.hpp"
#include "vernier/kinematics/joint_drive.hpp"

namespace vernier {

/// The orders at which a drive is expected to err, and by how much: an encoder at its period and half of it, a
/// strain-wave gear at multiples of its ratio. Nothing for what is not known.
VERNIER_API HarmonicSpectrum lines_of(const JointDrive& drive);

/// What errs at an order, in words: "4 a turn of a 101:1 gear". Empty where nothing known does. Where the drive is not
/// stated, an encoder of 128 periods and a gear of 101:1 are tried, "as of" which a line is.
VERNIER_API std::string cause_of(int order, const JointDrive& drive = {});

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/drive_lines.ipp"
#endif
