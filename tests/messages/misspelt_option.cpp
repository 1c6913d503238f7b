// SPDX-License-Identifier: BSD-3-Clause
// A misspelt option of the joint errors.
// expect: 'vernier::ErrorModelOptions'
// expect: harmonic
#include <vernier/calibration/calibrate.hpp>
#include <vernier/kinematics/robots.hpp>

#ifdef MISTAKE
#define HARMONICS harmonic
#else
#define HARMONICS harmonics
#endif

double seconds(const vernier::Dataset<6>& data) {
  return vernier::calibrate(vernier::robots::ur10(), data, vernier::CalibrateOptions{.errors = {.HARMONICS = 20}})
      .fit_seconds;
}
