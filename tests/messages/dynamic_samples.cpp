// SPDX-License-Identifier: BSD-3-Clause
// Samples whose numbers of columns are known at run time only.
// expect: the numbers of inputs and outputs are compile-time constants: pass matrices with fixed numbers of columns
#include <vernier/regression/elm.hpp>

#ifdef MISTAKE
using Inputs = Eigen::MatrixXd;
#else
using Inputs = Eigen::Matrix<double, Eigen::Dynamic, 6>;
#endif

auto fitted(const Inputs& x, const Eigen::Matrix<double, Eigen::Dynamic, 3>& y) { return vernier::Elm{}.fit(x, y); }
