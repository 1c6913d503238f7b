// SPDX-License-Identifier: BSD-3-Clause
// Several stations of seven joints, on which the calibration of an arm of six is to be evaluated.
// expect: the data have another number of joints than the arm
#include <vernier/calibration/evaluate.hpp>

#ifdef MISTAKE
using Data = vernier::Dataset<7>;
#else
using Data = vernier::Dataset<6>;
#endif

double error(const vernier::Calibration<vernier::DhChain<6>>& calibration, const std::vector<Data>& data) {
  return vernier::evaluate(calibration, data).max_degradation;
}
