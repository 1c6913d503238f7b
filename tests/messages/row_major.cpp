// SPDX-License-Identifier: BSD-3-Clause
// Matrices of Eigen are stored by rows.
// expect: Vernier stores matrices by columns: compile without EIGEN_DEFAULT_TO_ROW_MAJOR
// flags: -DEIGEN_DEFAULT_TO_ROW_MAJOR
#ifdef MISTAKE
#include <vernier/kinematics/robots.hpp>
#endif
