// SPDX-License-Identifier: BSD-3-Clause
// Data of seven joints, with which an arm of six is to be calibrated. The data set of a `Robot` is right.
// expect: the data have another number of joints than the arm
#include <vernier/calibration/calibrate.hpp>
#include <vernier/kinematics/robots.hpp>

#ifdef MISTAKE
using Data = vernier::Dataset<7>;
#else
using Data = vernier::Dataset<6>;
#endif

double seconds(const Data& data) { return vernier::calibrate(vernier::robots::ur10(), data).fit_seconds; }
