// SPDX-License-Identifier: BSD-3-Clause
// Data of seven joints and a model of six.
// expect: the data have another number of joints than the model
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/kinematics/dh_chain.hpp>

#ifdef MISTAKE
using Data = vernier::Dataset<7>;
#else
using Data = vernier::Dataset<6>;
#endif

double error(const vernier::DhChain<6>& arm, const Data& data) { return vernier::prediction_error(arm, data).mean; }
