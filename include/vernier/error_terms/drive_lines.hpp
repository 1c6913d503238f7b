// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Lines in the spectrum of a joint's errors: narrow bands of orders that its gear and its encoder cause.

#include <string>

#include "vernier/error_terms/fourier.hpp"
#include "vernier/kinematics/joint_drive.hpp"

namespace vernier {

/// The bands of orders in which a drive causes errors, with their expected sizes: those of an encoder of n periods
/// around n and 2 n, those of a strain-wave gear around 2, 4, 5, 8, 10, 12, 20 and 24 times its ratio, where that is
/// above 140 (lower orders belong to `typical_spectrum`) and at most 2,500. None for what is unknown.
/// @cite Heydemann 1981; Tuttle and Seering 1996
VERNIER_API HarmonicSpectrum lines_of(const JointDrive& drive);

/// The probable cause of errors at an order, in words: "4 a turn of a 101:1 gear", which is 4 periods a turn of the
/// gear's input. Empty where there is none. Orders 1 and 2 are those of eccentric and oval parts. Where gear or encoder
/// is unknown, one of 101:1, or of 128 periods, is assumed, and the words begin with "probably".
VERNIER_API std::string cause_of(int order, const JointDrive& drive = {});

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/drive_lines.ipp"
#endif
