// SPDX-License-Identifier: BSD-3-Clause
// An option of the joint errors among those of `calibrate`.
// expect: harmonics
#include <vernier/calibration/calibrate.hpp>
#include <vernier/kinematics/robots.hpp>

#ifdef MISTAKE
const vernier::CalibrateOptions options{.harmonics = 20};
#else
const vernier::CalibrateOptions options{.errors = {.harmonics = 20}};
#endif
