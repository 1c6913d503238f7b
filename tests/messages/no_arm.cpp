// SPDX-License-Identifier: BSD-3-Clause
// Something that is no arm, calibrated.
// expect: calibrate takes an arm as designed: a Robot, a DhChain, or a Framed DhChain
#include <vernier/calibration/calibrate.hpp>
#include <vernier/kinematics/robots.hpp>

#ifdef MISTAKE
struct Arm {};
#else
using Arm = vernier::Robot<6>;
#endif

auto calibrated(const Arm& arm, const vernier::Dataset<6>& data) { return vernier::calibrate(arm, data); }
