// SPDX-License-Identifier: BSD-3-Clause
// Measurements of seven joints, with which a fitted arm of six is to be registered again.
// expect: the data have another number of joints than the arm
#include <vernier/registration/reregister.hpp>

#ifdef MISTAKE
using Data = vernier::Measurements<7>;
#else
using Data = vernier::Measurements<6>;
#endif

double error(const vernier::ErrorModel<vernier::DhChain<6>>& model, const Data& data) {
  return vernier::reregister(model, data).rms_after;
}
