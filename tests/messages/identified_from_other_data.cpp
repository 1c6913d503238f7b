// SPDX-License-Identifier: BSD-3-Clause
// Data of seven joints, from which an arm of six is to be identified.
// expect: the data have another number of joints than the arm
#include <vernier/identification/identify.hpp>
#include <vernier/kinematics/dh_chain.hpp>

#ifdef MISTAKE
using Data = vernier::Distances<7>;
#else
using Data = vernier::Distances<6>;
#endif

double error(const vernier::DhChain<6>& arm, const Data& data) { return vernier::identify(arm, data).rms_after; }
