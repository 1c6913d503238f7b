// SPDX-License-Identifier: BSD-3-Clause
// Data of seven joints, added to measurements of an arm of six.
// expect: the data have another number of joints than the arm
#include <vernier/measurements/measurements.hpp>

#ifdef MISTAKE
using Data = vernier::Dataset<7>;
#else
using Data = vernier::Dataset<6>;
#endif

void add(vernier::Measurements<6>& measured, const Data& data) { measured.add(data, "second.csv"); }
